// Constraints of the study, changed and added on the page.
import { brief, html, minus, norm, parsed } from './draw.js';
import { state } from './design.js';
import { question, say } from './dialog.js';
import { chooseMembers, clearMarks, memberName } from './picking.js';
import { addConstraint, at, goalName, headed, isOfDesign, labelled, lengthOf, limitFields, number, optimise, placeField, remover, select, words } from './targets.js';

// Keys that name the subject of a constraint.
const SUBJECTS = ['length', 'members', 'articulation', 'point', 'characteristic', 'plunge', 'angle', 'load'];
const constraintName = (constraint) => {
  const kind = SUBJECTS.find((key) => constraint[key] !== undefined);
  return kind ? words(`${kind} ${[].concat(constraint[kind]).join(', ')}`) : 'constraint';
};

const ofAxle = (axle) => (axle ? { axle } : {});
const NO_NUMBER = 'A field has no number.';

// Asks for the numbers of a clearance between two members, and adds the constraint.
const askForClearance = async () => {
  const chosen = await chooseMembers(2);
  if (!chosen) return;
  const { members, unit } = state.overview;
  // The first two members of one axle without a common joint.
  const isApart = (first, second) => first.axle === second.axle && !first.ends.some((end) => second.ends.includes(end));
  const usual = members.flatMap((first, k) => members.map((second, n) => [k, n]).filter(([, n]) => isApart(first, members[n])))[0] ?? [0, 1];
  const fields = [0, 1].map((k) => select(members.map(memberName), chosen[k] ?? usual[k]));
  const radii = [number(0), number(0)];
  const gap = number(lengthOf(5));
  const place = placeField();
  const add = () => {
    const [first, second] = fields.map((field) => members[Number(field.value)]);
    if (first === second) return 'Choose two different members.';
    if (first.axle !== second.axle) return 'The members belong to different axles.';
    const [clearance, ...radius] = [gap, ...radii].map(({ value }) => parsed(value));
    if ([clearance, ...radius].includes(null)) return NO_NUMBER;
    const own = { ...ofAxle(first.axle), members: [first.name, second.name], ...(radius.some((r) => r !== 0) ? { radii: radius } : {}), clearance, ...place.keys() };
    return addConstraint(own, `clearance of ${memberName(first)} and ${memberName(second)}`);
  };
  await question('Add a clearance', 'The clearance is the distance of the centre lines minus the two radii.', [['add', 'Add constraint', add], ['', 'Cancel']],
    ...fields.map((field, k) => labelled(`${k ? 'Second' : 'First'} member`, field)), labelled(`Smallest clearance [${unit}]`, gap),
    ...radii.map((field, k) => labelled(`Radius of the ${k ? 'second' : 'first'} member [${unit}]`, field)), place.row);
  clearMarks();
};
// Asks for the limits of a member's length, and adds the constraint.
const askForLength = async () => {
  const chosen = await chooseMembers(1);
  if (!chosen) return;
  const { members, unit } = state.overview;
  const field = select(members.map(memberName), chosen[0] ?? 0);
  const kind = select(['keeps its length', 'has a length between two limits']);
  const limits = [number(0), number(0)];
  const rows = limits.map((limit, k) => labelled(`${k ? 'Longest' : 'Shortest'} [${unit}]`, limit));
  const place = placeField();
  const offer = () => {
    const [a, b] = members[Number(field.value)].ends.map((end) => state.design[end]);
    limits.forEach((limit, k) => { limit.value = String(Number(((k ? 1.05 : 0.95) * norm(minus(a, b))).toPrecision(4))); });
  };
  const arrange = () => rows.forEach((row) => { row.hidden = kind.value === '0'; });
  field.addEventListener('change', offer);
  kind.addEventListener('change', arrange);
  offer();
  arrange();
  const add = () => {
    const { name, axle } = members[Number(field.value)];
    const between = limits.map(({ value }) => parsed(value));
    if (kind.value !== '0' && between.includes(null)) return NO_NUMBER;
    const own = { ...ofAxle(axle), length: name, ...(kind.value === '0' ? { kept: true } : { between }), ...place.keys() };
    return addConstraint(own, `length of ${memberName(members[Number(field.value)])}`);
  };
  await question('Add a limit of a length', 'A rod keeps its length over the motion; a strut and a spring change theirs.', [['add', 'Add constraint', add], ['', 'Cancel']],
    labelled('Member', field), labelled('The length', kind), ...rows, place.row);
  clearMarks();
};
// Asks for the largest angle of a joint, and adds the constraint.
const askForAngle = async () => {
  const { joints } = state.overview;
  if (!joints.length) return say('No joint of this suspension has an angle that can be limited.', 'bad');
  const field = select(joints.map(memberName), Math.max(0, joints.findIndex(({ point }) => point === state.selected)));
  const most = number(20);
  // In the design position the angle is 0.
  const place = placeField(false);
  if (!place) return say('A limit of a joint angle applies to a motion. Write a section [motions.NAME] into the file first.', 'bad');
  const add = () => {
    const { name, axle } = joints[Number(field.value)];
    const angle = parsed(most.value);
    if (angle === null) return NO_NUMBER;
    return addConstraint({ ...ofAxle(axle), articulation: name, at_most: angle, ...place.keys() }, `articulation of ${memberName(joints[Number(field.value)])} at most ${brief(angle)} °`);
  };
  await question('Add a limit of a joint angle', 'The angle between the stud and its direction in the design position. The housing moves with the arm or rod.', [['add', 'Add constraint', add], ['', 'Cancel']],
    labelled('Joint', field), labelled('Largest angle [°]', most), place.row);
};

const adder = () => {
  const title = html('h2', { text: 'Add a constraint' });
  if (!optimise()) return html('div', { class: 'panel' }, title, html('p', { class: 'hint', text: 'A constraint limits a tuning. Add a target first: press “+ target” on a chart.' }));
  const kinds = [['Clearance of two members…', askForClearance], ['Length of a member…', askForLength], ...(isOfDesign() ? [] : [['Angle of a joint…', askForAngle]])];
  return html('div', { class: 'panel' }, title, html('div', { class: 'add' }, ...kinds.map(([text, click]) => html('button', { text, on: { click } }))),
    html('p', { class: 'hint', text: 'Click the members in a view, or choose them from a list. To limit a quantity, press “+ target” on its chart. Regions for points and other constraints: write them into the file.' }));
};

// Forms of the Constraints tab.
export const constraintForms = () => {
  const rows = (optimise()?.constraints ?? []).map((constraint, k) => {
    const name = state.overview.is_car && constraint.characteristic ? goalName(constraint) : constraintName(constraint);
    return html('tr', {}, html('th', { scope: 'row', text: name }), html('td', {}, ...limitFields(constraint, at('constraints', k), name)), html('td', {}, remover(`Remove ${name}`, at('constraints', k), name)));
  });
  return [...(rows.length ? [headed('Change constraints', ['constraint', 'limit', ''], rows)] : []), adder()];
};
