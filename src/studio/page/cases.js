// Load cases of a car. The table has a row for each result and a column for each case. Below each value is the change relative
// to the file, the value of a proposal, or the effect of a coordinate.
import { AXES, brief, byId, html, set, signed, write } from './draw.js';
import { emit, isInGesture, on, onRest, state } from './design.js';
import { askForTarget } from './targets.js';

let rows = new Map();
let heads = [];

const choose = (k, event) => {
  state.at = [k];
  emit('place', event);
};

// Targets of a result in a load case.
const targetsOf = (column, k) => state.overview.targets.filter(({ columns, points }) => columns.includes(column) && points[0]?.[0] === k);
const wanted = ({ points: [[, low, high]], tolerance, is_band: isBand }) => {
  if (!isBand) return `${brief(low, 4)} ± ${brief(tolerance, 3)}`;
  if (low === null) return `at most ${brief(high, 4)}`;
  return high === null ? `at least ${brief(low, 4)}` : `${brief(low, 4)} … ${brief(high, 4)}`;
};
const deviation = ({ points: [[, low, high]], tolerance }, value) => {
  if (low !== null && value < low) return (value - low) / tolerance;
  return high !== null && value > high ? (value - high) / tolerance : 0;
};

// A value that is only rounding error, compared with the other values of its row, is shown as 0.
const shown = (value, size) => (value !== null && Math.abs(value) < 1e-9 * size ? 0 : value);

// Pause in milliseconds before invisible rows are updated. A row that is scrolled into view is updated at once.
const PAUSE = 300;
let late = null;
const watch = new IntersectionObserver((found) => {
  for (const { target, isIntersecting } of found) target.isSeen = isIntersecting;
  if (found.some(({ target, isIntersecting }) => isIntersecting && target.isLate)) draw();
});

const build = () => {
  const { answer } = state;
  const { names } = state.overview.sliders[0];
  heads = names.map((name, k) => html('th', { scope: 'col', class: 'number' },
    html('button', { class: 'name', text: name.replaceAll('_', ' '), title: 'Draw the car in this case', on: { click: (event) => choose(k, event) } }), html('small')));
  rows = new Map(answer.columns.map(({ column, title, unit, positive }) => {
    const cells = names.map(() => {
      const [value, note] = [html('b'), html('small')];
      return { td: html('td', { class: 'number' }, value, note), value, note };
    });
    const sign = positive && positive !== 'always' ? `positive: ${positive}` : null;
    const adder = html('button', { class: 'adder', text: '+ target', 'aria-label': `+ target for ${title}`, on: { click: () => askForTarget([{ column }], state.answer) } });
    const th = html('th', { scope: 'row', title: sign }, adder, title, unit ? html('span', { class: 'unit', text: ` [${unit}]` }) : '');
    return [column, { tr: html('tr', { 'data-column': column }, th, ...cells.map(({ td }) => td)), cells }];
  }));
  watch.disconnect();
  for (const { tr } of rows.values()) {
    tr.isSeen = true;
    watch.observe(tr);
  }
  const table = html('table', { id: 'cases' }, html('thead', {}, html('tr', {}, html('th', { text: 'result' }), ...heads)), html('tbody', {}, ...[...rows.values()].map(({ tr }) => tr)));
  const box = html('div', { class: 'scroll', tabindex: 0, role: 'group', 'aria-label': 'Load cases' }, table);
  byId('charts').replaceChildren(box);
  const sizes = new ResizeObserver(() => table.classList.toggle('wide', box.scrollWidth > box.clientWidth));
  for (const element of [box, table]) sizes.observe(element);
};

const of = (answer, column) => answer?.columns.find((c) => c.column === column)?.values;

// Note under a value: the effect of a coordinate, the value of a proposal, or the change relative to the file.
const noteOf = (column, k, value, size) => {
  const slope = state.influence?.columns.get(column)?.[k];
  if (state.influence) return slope === null || slope === undefined ? '' : signed(shown(slope, 1e-3), 3);
  const next = of(state.proposed, column)?.[k] ?? null;
  if (state.proposed) return next === null ? '' : `→ ${brief(shown(next, size), 4)}`;
  const was = of(state.ghost, column)?.[k] ?? null;
  const by = was === null || value === null ? 0 : value - was;
  return Math.abs(by) > 1e-9 * size ? signed(by, 3) : '';
};

const draw = (isAll = false) => {
  const { answer } = state;
  if (!state.overview?.is_car || !answer) return;
  clearTimeout(late);
  if (answer.columns.map((c) => c.column).join() !== [...rows.keys()].join() || heads.length !== answer.status.length) build();
  heads.forEach((th, k) => {
    const isShown = state.at[0] === k;
    th.classList.toggle('selected', isShown);
    set(th.querySelector('button'), { 'aria-pressed': String(isShown) });
    const isSolved = answer.status[k] === 'ok';
    write(th.querySelector('small'), isSolved ? '' : answer.status[k].replaceAll('_', ' '));
    set(th, { title: isSolved ? null : answer.failures.find((f) => f.first === k)?.reason });
  });
  for (const { column, values } of answer.columns) {
    const { tr, cells } = rows.get(column);
    tr.isLate = !isAll && !tr.isSeen;
    if (tr.isLate) continue;
    const size = Math.max(1e-6, ...values.map((v) => Math.abs(v ?? 0)));
    cells.forEach(({ td, value, note }, k) => {
      const targets = targetsOf(column, k);
      write(value, brief(shown(values[k], size), 4));
      write(note, noteOf(column, k, values[k], size));
      const isMissed = targets.some((t) => values[k] === null || Math.abs(deviation(t, values[k])) > 1);
      td.classList.toggle('target', targets.length > 0);
      td.classList.toggle('bad', isMissed);
      td.classList.toggle('selected', state.at[0] === k);
      set(td, { title: targets.map((t) => `target: ${wanted(t)}${isMissed ? ', missed' : ''}`).join('; ') || null });
    });
  }
  if ([...rows.values()].some(({ tr }) => tr.isLate)) late = setTimeout(() => { if (!isInGesture()) draw(true); }, PAUSE);
};

const key = () => {
  if (!state.overview?.is_car) return;
  const { influence, proposed } = state;
  const axis = influence && `${state.overview.points[influence.point].name} ${AXES[influence.axis]}`;
  const below = influence ? `change by ${axis}, per ${state.overview.unit}` : proposed ? 'value of the proposal' : 'change against the file';
  write(byId('cases-key'), state.fault ? 'This design is not solved (see Warnings). The values are those of the last solved design.' : `Below each value: ${below}.`);
  document.getElementById('cases')?.classList.toggle('stale', Boolean(state.fault));
};

export const startCases = () => {
  on('study', () => {
    rows = new Map();
    const { is_car: isCar } = state.overview;
    document.documentElement.dataset.vehicle = isCar ? 'car' : 'suspension';
    byId('curves-title').textContent = isCar ? 'Load cases' : 'Curves';
    for (const own of document.querySelectorAll('[data-of]')) own.hidden = (own.dataset.of === 'car') !== isCar;
    key();
  });
  const renew = () => { key(); draw(); };
  for (const event of ['answer', 'ghost', 'proposed', 'influence', 'edited']) on(event, renew);
  onRest(renew);
  addEventListener('beforeprint', () => draw(true));
};
