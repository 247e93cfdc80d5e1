// Targets, variables and constraints of the study, changed on the page. An edit is a value and a path; the server writes
// it into the study's text and keeps the comments.
import { AXES, brief, fill, fitted, html, parsed, quantity, scroller } from './draw.js';
import { placeAfter, state, takeOverview } from './design.js';
import { markNumber, question, refuse, retract } from './dialog.js';
import { endsOf } from './runs.js';
import { post } from './server.js';

export const words = (text) => text.replaceAll(/[_.]/g, ' ');
export const optimise = () => state.overview.written.optimise;
// Degrees on a chart per unit of a target's drive value. A study may write the angles of a motion in radians.
export const degreesPerDrive = (motion) => {
  const { motion: own, motions } = state.overview.written;
  const section = motion ? motions?.[motion] : own;
  return (section?.drive ?? 'travel') !== 'travel' && section.angle_unit === 'rad' ? 180 / Math.PI : 1;
};
export const writtenTarget = (k) => optimise()?.targets?.[k];

// Sends edits to the server, and loads the edited study. Returns the reason of a refusal, or null.
let busy = Promise.resolve();
export const tried = (edits, label) => {
  busy = busy.then(async () => {
    try {
      const overview = await post('edit', { digest: state.overview.digest, edits });
      takeOverview(overview, label, edits);
      retract();
      return null;
    } catch (refused) {
      return refused.message;
    }
  });
  return busy;
};
// Sends edits like `tried`, and shows a refusal as a message over the page. Returns true if the study has changed.
export const edit = async (edits, label) => {
  const refused = await tried(edits, label);
  if (refused !== null) refuse(`Not changed: ${refused}`);
  return refused === null;
};
export const at = (...path) => ['optimise', ...path];
const nameOf = (k) => (state.overview.is_car ? goalName(writtenTarget(k) ?? {}) : quantity(state.overview.targets[k]?.column ?? `target ${k + 1}`));
// Name of a target or a constraint of a car in the study. The page lists targets of load cases before targets of a single axle.
export const goalName = (own) => words([own.characteristic ?? own.load ?? 'target', own.case ? `in ${[].concat(own.case).join(', ')}` : `of the ${own.axle} axle`].join(' '));
// `between` has two limits, so the name depends on the index of the limit.
const endOf = ([key, end]) => (key === 'between' ? LIMITS.between[end] : words(key));
export const setTarget = (k, path, value) => edit([{ path: at('targets', k, ...path), value }], `Target ${nameOf(k)}: ${endOf(path)} ${brief(value)}`);

// A field for one number of the study. An optional number is null while the field is empty. `change` returns false if the study
// refuses the number; the field then has the number of the study again.
const field = (label, value, change, isOptional = false) => {
  const written = value === null ? '' : String(value);
  const input = fitted(html('input', { type: 'text', inputmode: 'decimal', value: written, 'aria-label': label, title: label, autocomplete: 'off' }));
  input.addEventListener('change', () => {
    const number = parsed(input.value);
    const isWrong = number === null && !(isOptional && input.value.trim() === '');
    markNumber(input, isWrong, label);
    if (isWrong || number === value) return;
    input.blur();
    Promise.resolve(change(number)).then((isTaken) => { if (isTaken === false) fill(input, written); });
  });
  input.addEventListener('keydown', (event) => { if (event.key === 'Escape') { fill(input, written); markNumber(input, false, label); input.blur(); } });
  return input;
};
export const remover = (label, path, name) => html('button', { class: 'small', text: '✕', title: label, 'aria-label': label, on: { click: () => edit([{ path, value: null }], `Removed ${name}`) } });
export const headed = (title, head, rows, ...more) => html('div', { class: head.length > 5 ? 'panel form wide' : 'panel form' }, html('h2', { text: title }), scroller(title,
  html('table', {}, html('thead', {}, html('tr', {}, ...head.map((text) => html(text ? 'th' : 'td', { text })))), html('tbody', {}, ...rows))), ...more);

// Keys of limits and target values, with labels. `limitFields` makes a field for each number under these keys in a table of the
// study.
const LIMITS = { between: ['from', 'to'], at_least: 'at least', at_most: 'at most', clearance: 'clearance', value: 'value', at: 'at' };
export const limitFields = (entry, path, name) => Object.entries(LIMITS).flatMap(([key, label]) => {
  const value = entry[key];
  const one = (text, number, ...step) => html('label', { class: 'limit' }, `${text} `, field(`${name}: ${text}`, number, (to) => edit([{ path: [...path, key, ...step], value: to }], `${name}: ${text} ${brief(to)}`)), ' ');
  if (Number.isFinite(value)) return [one(label, value)];
  if (Array.isArray(value) && value.every(Number.isFinite)) return value.map((number, k) => one(label[k] ?? key, number, k));
  return [];
});

const targetRow = (target, k) => {
  const name = nameOf(k);
  const number = (key, usual) => field(`${name}: ${key}`, target[key] ?? usual, (value) => setTarget(k, [key], value));
  const wanted = limitFields(target, at('targets', k), name);
  const bent = [target.between?.[0], target.at_least, target.at_most].find(Array.isArray);
  const curve = bent ? `limits from ${brief(bent[0][0])} to ${brief(bent.at(-1)[0])}` : target.points ? `curve of ${target.points.length} points` : target.file ? `curve in ${target.file}` : '';
  return html('tr', { 'data-target': k }, html('th', { scope: 'row', text: name }), html('td', {}, ...(wanted.length ? wanted : [curve])), html('td', {}, number('tolerance', '')), html('td', {}, number('weight', 1)),
    html('td', {}, remover(`Remove target ${name}`, at('targets', k), `target ${name}`)));
};

// Parts with a `rate`. Other parts have a stiffness.
const RATED = ['spring', 'anti_roll_bar', 'heave_spring', 't_bar', 'heave_bar', 'tyre'];
// Name of a variable: its point and axis, or its part.
const variableName = (variable) => {
  const part = variable.bushing ?? variable.link;
  if (variable.rate !== undefined) return words([[].concat(variable.axle ?? []).join(' and '), variable.rate, RATED.includes(variable.rate) ? 'rate' : 'stiffness', variable.relative ? '(factor)' : ''].filter(Boolean).join(' '));
  if (variable.car !== undefined) return words(`car ${variable.car}`);
  if (part !== undefined) return words([part, 'stiffness', variable.stiffness, variable.relative ? '(factor)' : ''].filter(Boolean).join(' '));
  const own = variable.hardpoint ?? variable.name ?? (variable.hardpoints ?? []).join(', ');
  return words([...[].concat(variable.axle ?? []), own, variable.axis].filter(Boolean).join(' ')) || 'variable';
};
// The range of a single coordinate in the study's axes.
const placeOf = ({ hardpoint, axis, axle }, ends) => {
  const p = state.overview.points.findIndex(({ name, axle: own }) => (own ? own[0] === axle && own[1] === hardpoint : name === hardpoint));
  const at = AXES.indexOf(axis);
  return p < 0 || at < 0 ? '' : ends.map((by) => brief(placeAfter(p, at, by), 6)).join(' … ');
};
const variableRow = (variable, k) => {
  const name = variableName(variable);
  const ends = Array.isArray(variable.range) && variable.range.every(Number.isFinite) ? variable.range : null;
  const end = (which, text) => (ends ? field(`${name}: ${text}`, ends[which], (value) => edit([{ path: at('variables', k, 'range', which), value }], `Range of ${name}: ${text} ${brief(value)}`)) : '');
  return html('tr', { 'data-variable': k }, html('th', { scope: 'row', text: name }), html('td', {}, end(0, 'lowest')), html('td', {}, end(1, 'highest')), html('td', { class: 'number', text: ends ? placeOf(variable, ends) : '' }),
    html('td', {}, remover(`Remove variable ${name}`, at('variables', k), `variable ${name}`)));
};
const variableAdder = () => {
  const { points, unit } = state.overview;
  const choice = (label, names) => html('select', { 'aria-label': label }, ...names.map((text) => html('option', { value: text, text: words(text) })));
  const point = choice('point of the new variable', points.filter(({ follows }) => !follows).map(({ name }) => name));
  if (state.selected !== null) point.value = points[state.selected].name;
  const axis = choice('axis of the new variable', AXES);
  const range = fitted(html('input', { type: 'text', value: String(lengthOf(10)), 'aria-label': 'range of the new variable in both directions' }));
  const add = () => {
    const by = parsed(range.value);
    markNumber(range, by === null, range.getAttribute('aria-label'));
    if (by === null) return;
    edit([{ path: at('variables', optimise().variables.length), value: newVariable(point.value, axis.value, by) }], `Added variable ${words(point.value)} ${axis.value}`);
  };
  return html('div', { class: 'add' }, 'Let', point, axis, 'move ±', range, unit, html('button', { text: 'Add variable', on: { click: add } }));
};
const newVariable = (name, axis, by) => {
  const { axle } = state.overview.points.find((point) => point.name === name);
  return { ...(axle ? { axle: axle[0], hardpoint: axle[1] } : { hardpoint: name }), axis, range: [-Math.abs(by), Math.abs(by)] };
};

// Forms of the Targets tab.
export const targetForms = () => {
  if (!optimise()) return [];
  const { targets = [], variables = [] } = optimise();
  return [headed('Change targets', ['target', 'wanted', 'tolerance', 'weight', ''], targets.map(targetRow)),
    headed('Variables', ['variable', ...['lowest', 'highest'].map((end) => (state.overview.is_car ? end : `${end} [${state.overview.unit}]`)), 'coordinate', ''], variables.map(variableRow), variableAdder(),
      html('p', { class: 'hint', text: `Ranges ${state.overview.is_car ? 'of hardpoints ' : ''}are relative to the design in the file, not to the present positions. If a point is outside its range, Tune extends the range to the present position. After saving, ranges are relative to the saved design.` }))];
};
// Data of the vehicle by key. A number has its unit (`length`: the study's unit of length), a choice has its texts.
const VEHICLE = {
  wheelbase: 'length', cg_height: 'length', position: ['front', 'rear'], brakes: ['outboard', 'inboard'], brake_share_front: '0 to 1', drive_torque: ['shafts', 'carrier'], drive_share_front: '0 to 1',
  sprung_mass: 'mass', unsprung_mass: 'mass',
};
const vehicleForm = () => {
  const { vehicle = {} } = state.overview.written;
  const put = (key, value) => edit([{ path: ['vehicle', key], value }], value === null ? `Removed ${words(key)}` : `${words(key)} ${Number.isFinite(value) ? brief(value) : value}`);
  const entry = (key, kind) => {
    const now = vehicle[key];
    if (Array.isArray(kind)) {
      const select = html('select', { 'aria-label': words(key) }, ...['', ...kind].map((value) => html('option', { value, text: value || '–' })));
      select.value = now ?? '';
      select.addEventListener('change', () => put(key, select.value || null));
      return select;
    }
    return field(words(key), now ?? null, (value) => put(key, value), true);
  };
  const unitOf = (kind) => (Array.isArray(kind) ? '' : ` [${{ length: state.overview.unit, mass: state.overview.written.mass_unit }[kind] ?? kind}]`);
  const rows = Object.entries(VEHICLE).map(([key, kind]) => html('tr', { 'data-vehicle-key': key }, html('th', { scope: 'row', text: words(key) + unitOf(kind) }), html('td', {}, entry(key, kind))));
  const needy = state.overview.characteristics.filter(({ available }) => !available).map(({ name }) => words(name));
  const hint = needy.length ? [html('p', { class: 'hint', text: `Without further data there are no curves of: ${needy.join(', ')}.` })] : [];
  return headed('Vehicle', ['value', ''], rows, ...hint);
};
// Forms of the Vehicle tab: data of the vehicle, and rates of bushings, links, springs and the anti-roll bar.
const RATE_AXES = ['x', 'y', 'z', 'about x', 'about y', 'about z'];
const rateField = (name, path, value) => (Number.isFinite(value) ? field(name, value, (to) => edit([{ path, value: to }], `${name} ${brief(to)}`)) : '');
export const partForms = () => {
  if (state.overview.is_car) return carForms();
  const { bushings = {}, links = {}, spring = {}, anti_roll_bar: bar = {}, steering = {} } = state.overview.written;
  const rows = Object.entries(bushings).flatMap(([name, own]) => ['stiffness', 'scale'].filter((key) => Array.isArray(own[key])).map((key) => html('tr', { 'data-bushing': name },
    html('th', { scope: 'row', text: words(`${name} ${key}`) }), ...own[key].map((value, k) => html('td', {}, rateField(`${words(name)}: ${key} ${RATE_AXES[k]}`, ['bushings', name, key, k], value))))));
  const single = [...Object.entries(links).flatMap(([name, own]) => Object.entries(own).map(([key, value]) => [`${name} ${key}`, ['links', name, key], value])),
    ['spring rate', ['spring', 'rate'], spring.rate], ['anti-roll bar rate', ['anti_roll_bar', 'rate'], bar.rate],
    ...['rack_stiffness', 'column_stiffness'].map((key) => [key, ['steering', key], steering[key]])].filter(([, , value]) => Number.isFinite(value));
  const { unit } = state.overview;
  return [vehicleForm(), ...(rows.length ? [headed(`Bushings, N/${unit} and N ${unit}/rad`, ['bushing', ...RATE_AXES], rows)] : []),
    ...(single.length ? [headed('Links and springs', ['part', 'rate'], single.map(([name, path, value]) => html('tr', {}, html('th', { scope: 'row', text: words(name) }), html('td', {}, rateField(words(name), path, value)))))] : [])];
};
// Forms of a car: its masses and shares, the rates of its axles, and its load cases.
const CAR_KEYS = ['mass', 'cg', 'sprung_mass', 'sprung_cg', 'wheelbase', 'rear_offset', 'brake_share_front', 'drive_share_front', 'yaw_inertia', 'pitch_inertia'];
const AXLE_KEYS = [['spring', 'rate'], ['spring', 'force'], ['anti_roll_bar', 'rate'], ['heave_spring', 'rate'], ['heave_spring', 'force'], ['t_bar', 'rate'], ['heave_bar', 'rate'], ['heave_bar', 'torque'], ['tyre', 'rate'], ['vehicle', 'unsprung_mass']];
const CASE_KEYS = ['ax', 'ay', 'az', 'speed', 'yaw_acceleration', 'rack', 'steering_wheel_angle'];
const carForms = () => {
  const { car, cases = [], units } = state.overview.written;
  const ends = ['front', 'rear'].map((end) => state.overview.written[end]);
  const unitOf = (name) => (units[name] ? ` [${units[name]}]` : '');
  const row = (name, ...cells) => html('tr', {}, html('th', { scope: 'row', text: words(name) + unitOf(name) }), ...cells.map((cell) => html('td', {}, cell)));
  const values = CAR_KEYS.filter((key) => car[key] !== undefined).map((key) => row(key, html('span', {}, ...[].concat(car[key]).map((value, k) => rateField(
    words(Array.isArray(car[key]) ? `${key} ${AXES[k]}` : key), Array.isArray(car[key]) ? ['car', key, k] : ['car', key], value)))));
  const rates = AXLE_KEYS.filter(([section, key]) => ends.some((own) => Number.isFinite(own[section]?.[key]))).map(([section, key]) => row(`${section}.${key}`,
    ...['front', 'rear'].map((end, k) => rateField(words(`${end} ${section} ${key}`), [end, section, key], ends[k][section]?.[key]))));
  const used = CASE_KEYS.filter((key) => cases.some((own) => Number.isFinite(own[key])));
  const loads = cases.map((own, k) => row(own.name, ...used.map((key) => rateField(words(`${own.name} ${key}`), ['cases', k, key], own[key]))));
  return [headed('Car', ['value', ''], values), headed('Axles', ['value', 'front', 'rear'], rates), ...(loads.length ? [headed('Load cases', ['case', ...used.map((key) => words(key) + unitOf(key))], loads)] : [])];
};
// Adds a constraint. Returns the reason of a refusal, or null.
export const addConstraint = (constraint, name) => {
  const { constraints } = optimise();
  const change = constraints ? { path: at('constraints', constraints.length), value: constraint } : { path: at('constraints'), value: [constraint] };
  return tried([change], `Added constraint ${name}`);
};

// Converts a length in millimetres to the study's unit, rounded to a usual value (1 mm counts as 0.04 in).
export const lengthOf = (millimetres) => Number((millimetres * { mm: 1, m: 0.001, in: 0.04 }[state.overview.unit]).toPrecision(3));
// A field with a list of texts. Its value is the index of the chosen text.
export const select = (options, chosen = 0) => {
  const made = html('select', {}, ...options.map((text, k) => html('option', { value: k, text })));
  made.value = String(chosen);
  return made;
};
// True if constraints apply to the design position only: for a car, for a study with elastic parts, and for a solid axle.
export const isOfDesign = () => state.overview.is_car || state.overview.written.compliance !== undefined || state.overview.points.some(({ follows }) => follows);
// The part of the motion to which a new constraint applies: a field, and the keys of its choice. An axle needs a named motion.
export const placeField = (hasDesign = true) => {
  const { is_axle: isAxle, motions } = state.overview;
  const named = isOfDesign() ? [] : motions.filter(({ name }) => name !== null).map(({ name }) => [`motion ${name}`, { motion: name }]);
  const whole = isAxle || isOfDesign() ? [] : [['the whole motion', {}]];
  const all = [...whole, ...named, ...(hasDesign ? [['the design position', { at: 'design' }]] : [])];
  if (!all.length) return null;
  const shown = all.findIndex(([, keys]) => keys.motion === state.motion && state.motion !== null);
  const field = select(all.map(([text]) => text), Math.max(0, shown));
  return { row: labelled('Applies to', field), keys: () => all[Number(field.value)][1] };
};

// The keys by which a study names a column of the curves.
const subjectOf = (column, others) => {
  const [, side] = /^(left|right)_/.exec(column) ?? [];
  const plain = side ? column.replace(/^(left|right)_/, '') : column;
  const known = state.overview.characteristics.map(({ name }) => name).sort((a, b) => b.length - a.length);
  const characteristic = known.find((name) => plain === name || plain.startsWith(`${name}_`));
  if (!characteristic) return null;
  const own = { characteristic };
  if (side && others < 2) own.side = side;
  if (state.motion !== null) own.motion = state.motion;
  if (state.overview.is_axle && !state.overview.is_car) own.over = state.overview.sliders[state.over].key;
  return own;
};
export const labelled = (text, input) => html('label', { class: 'direction' }, html('span', { text }), input);
export const number = (value) => html('input', { type: 'text', inputmode: 'decimal', value: String(value), autocomplete: 'off' });

// Fields of a new target on a chart: a band, over a part of the motion if both ends are given, or a value at one position.
const placesOnChart = () => {
  const slider = state.overview.sliders[state.over];
  const place = number(Number(state.at[state.over].toPrecision(4)));
  const ends = [number(''), number('')];
  return {
    always: [],
    onBand: ends.map((end, k) => labelled(`${k ? 'To' : 'From'} ${slider.name} [${slider.unit}] (empty: whole motion)`, end)),
    onValue: [labelled(`Position, ${slider.name} [${slider.unit}]`, place)],
    words: ['stays between two limits', 'has a value at one position'],
    limits: (low, high) => ({ between: [low, high] }),
    // The keys of the target; null if a field has no number.
    keys: (isBand, low, high) => {
      const drive = ({ value }) => (parsed(value) === null ? null : parsed(value) / degreesPerDrive(state.motion));
      if (!isBand) return drive(place) === null ? null : { at: drive(place), value: low };
      if (ends.every(({ value }) => value.trim() === '')) return { between: [low, high] };
      const [first, last] = ends.map(drive);
      if (first === null || last === null) return null;
      return { between: [low, high].map((limit) => [[first, limit], [last, limit]]) };
    },
  };
};
// Fields of a new target of a load case.
const placesInCases = (values, put) => {
  const { names } = state.overview.sliders[0];
  const own = html('select', { 'aria-label': 'load case' }, ...names.map((text, k) => html('option', { value: k, text: words(text) })));
  own.value = String(state.at[0]);
  const offer = () => put(values[Number(own.value)]);
  own.addEventListener('change', offer);
  offer();
  return {
    always: [labelled('Load case', own)],
    onBand: [],
    onValue: [],
    words: ['lies between two limits', 'has a value'],
    limits: (low, high) => ({ case: names[Number(own.value)], between: [low, high] }),
    keys: (isBand, low, high) => ({ case: names[Number(own.value)], ...(isBand ? { between: [low, high] } : { value: low }) }),
  };
};
export const rounded = (value) => Number(value.toPrecision(3));
// Rounds a limit outwards to three digits, so that the present values stay inside.
const outward = (value, round) => {
  if (value === 0) return 0;
  const step = 10 ** (Math.floor(Math.log10(Math.abs(value))) - 2);
  return Number((round(value / step) * step).toPrecision(3));
};
// A point that is usually moved for a quantity: the inner joint of the tie rod or toe link for toe and steer.
const usualPoint = (column) => (/toe|steer/.test(column) ? state.overview.points.find(({ name }) => /(tie_rod|toe_link)_inner$/.test(name)) : undefined);

// Asks for the band or value of a new target of a chart, or of a result in a load case, and adds it.
export const askForTarget = async (series, answer) => {
  const columns = series.map(({ column }) => answer.columns.find((c) => c.column === column));
  const [{ column, title, unit }] = columns;
  const subject = subjectOf(column, series.length);
  if (!subject) return refuse(`${title} cannot have a target here.`);
  const values = columns.flatMap((c) => c.values).filter((v) => v !== null);
  const [lowest, highest] = values.length ? endsOf(values) : [0, 1];
  const [low, high] = [outward(lowest, Math.floor), outward(highest, Math.ceil)];
  const wide = Math.max(high - low, 1e-2);
  const fields = { low: number(low), high: number(high), tolerance: number(Number((wide / 10).toPrecision(1))) };
  // The default band of a new target of a load case is around the present value.
  const around = (value) => [fields.low, fields.high].forEach((field, k) => { if (value !== null) field.value = String(rounded(value + (k - 0.5) * 0.1 * Math.max(Math.abs(value), 1e-2))); });
  const places = state.overview.is_car ? placesInCases(columns[0].values, around) : placesOnChart();
  const isFirst = !optimise();
  // A constraint of an axle limits a quantity of a wheel, unless the axle has elastic parts.
  const { is_axle: isAxle, is_car: isCar, written } = state.overview;
  const canLimit = !isFirst && (!isAxle || isCar || written.compliance !== undefined || subject.side !== undefined || series.length > 1);
  const where = canLimit && !isCar ? placeField() : null;
  const kinds = canLimit ? ['band', 'value', 'limit'] : ['band', 'value'];
  const kind = html('select', {}, ...kinds.map((value, k) => html('option', { value, text: places.words[k] ?? 'must stay between two limits: a constraint' })));
  const [lower, upper] = [labelled('', fields.low), labelled(`Upper limit [${unit}]`, fields.high)];
  const tolerated = labelled(`Tolerance [${unit}]`, fields.tolerance);
  const arrange = () => {
    const isValue = kind.value === 'value';
    upper.hidden = isValue;
    for (const row of places.onBand) row.hidden = kind.value !== 'band';
    for (const row of places.onValue) row.hidden = !isValue;
    tolerated.hidden = kind.value === 'limit';
    if (where) where.row.hidden = kind.value !== 'limit';
    lower.querySelector('span').textContent = isValue ? `Value [${unit}]` : `Lower limit [${unit}]`;
  };
  kind.addEventListener('change', arrange);
  arrange();
  const point = html('select', {}, ...state.overview.points.filter(({ follows }) => !follows).map(({ name }) => html('option', { value: name, text: words(name) })));
  if (isFirst) point.value = (state.overview.points[state.selected] ?? usualPoint(column) ?? state.overview.points[0]).name;
  const add = () => {
    const isBand = kind.value === 'band';
    const [lowest, highest, tolerance] = ['low', 'high', 'tolerance'].map((key) => parsed(fields[key].value));
    if (kind.value === 'limit') {
      if (lowest === null || highest === null) return 'A field has no number.';
      const { over, motion, ...own } = subject;
      return addConstraint({ ...own, ...places.limits(lowest, highest), ...where?.keys() }, title);
    }
    const wanted = lowest === null || tolerance === null || (isBand && highest === null) ? null : places.keys(isBand, lowest, highest);
    if (!wanted) return 'A field has no number.';
    const target = { ...subject, ...wanted, tolerance };
    return tried(isFirst ? firstTarget(target, point.value) : [{ path: at('targets', optimise().targets?.length ?? 0), value: target }], `Added target ${title}`);
  };
  await question(canLimit ? `Add a target or a constraint for ${title}` : `Add a target for ${title}`, isFirst ? 'The study has no variables yet. Tune may move the point that you choose, in y and z.' : 'Limits and values can be changed afterwards.', [['add', canLimit ? 'Add' : 'Add target', add], ['', 'Cancel']],
    labelled('The quantity', kind), ...places.always, lower, upper, ...places.onBand, ...places.onValue, tolerated, ...(where ? [where.row] : []), ...(isFirst ? [labelled('Point that may move', point)] : []));
};
const firstTarget = (target, point) => {
  const by = lengthOf(10);
  return [{ path: at('variables'), value: ['y', 'z'].map((axis) => newVariable(point, axis, by)) }, { path: at('targets'), value: [target] }];
};
