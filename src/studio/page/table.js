// Table of coordinates. The user can type and lock coordinates. The table shows the slope of the misfit for each coordinate.
// Pointing at a coordinate shows the effect on the curves.
import { AXES, brief, byId, html, parsed, set, write } from './draw.js';
import { askInfluence, emit, gradient, isInGesture, isMoved, on, onRest, placeAfter, put, setCoordinate, state, stepped } from './design.js';
import { select } from './views.js';
import { openTab } from './layout.js';
import { markNumber } from './dialog.js';

let rows = [];
let asked = null;
// The point in a view from which the user opened the fields. The focus returns to this point.
let origin = null;
let timer = null;

// Shows the effect of a coordinate after the pointer has rested on it, and hides the effect when the pointer leaves.
const point = (p, axis, wait = 90) => {
  clearTimeout(timer);
  timer = setTimeout(() => {
    asked = p === null ? null : [p, axis];
    askInfluence(p, axis);
  }, p === null ? 30 : wait);
};

// Shows all digits if they fit. Otherwise it shows as many as fit, and an ellipsis. A field with the focus shows all digits.
const MOST_DIGITS = 9;
const short = (value) => {
  const whole = String(value);
  if (whole.length <= MOST_DIGITS) return whole;
  const decimals = MOST_DIGITS - 2 - Math.trunc(value).toString().length;
  return whole.includes('e') || decimals < 0 ? `${value.toExponential(1)}…` : `${value.toFixed(decimals)}…`;
};

const putValue = (input, text) => { if (input.value !== text) input.value = text; };

// True while a field has typed text that is not yet accepted. Updates of the table do not change such text.
const hasOwnText = (input) => input.dataset.typed !== undefined;
const take = (input) => { delete input.dataset.typed; };
const unmark = (input) => {
  input.classList.remove('wrong');
  input.why = null;
  set(input, { 'aria-invalid': null });
};

const typed = (input, p, axis) => {
  const value = parsed(input.value);
  const isNumber = value !== null;
  if (isNumber) take(input);
  markNumber(input, !isNumber, input.getAttribute('aria-label'));
  if (isNumber && value !== state.design[p][axis]) setCoordinate(p, axis, value);
};

const range = (p, axis) => {
  const own = state.overview.variables.find(({ moves, is_turn: turn }) => !turn && moves.some(([q, a]) => q === p && a === axis));
  if (!own) return null;
  const [, , factor] = own.moves.find(([q, a]) => q === p && a === axis);
  return own.range.map((by) => placeAfter(p, axis, by * factor)).sort((a, b) => a - b);
};

const cell = (p, axis) => {
  const { name } = state.overview.points[p];
  const label = `${name} ${AXES[axis]}`;
  const input = html('input', {
    type: 'text', inputmode: 'decimal', size: 9, 'aria-label': label, 'data-point': p, 'data-axis': axis, autocomplete: 'off',
    on: {
      input: () => { input.dataset.typed = ''; },
      change: () => typed(input, p, axis),
      focus: () => { take(input); input.value = String(state.design[p][axis]); select(p); point(p, axis); },
      // If the text is not a number, the field shows the coordinate again. The message over the page stays.
      blur: () => { take(input); unmark(input); point(null); draw(); },
      keydown: (event) => {
        const by = { ArrowUp: 1, ArrowDown: -1 }[event.key];
        if (event.key === 'Escape') {
          take(input);
          unmark(input);
          input.value = String(state.design[p][axis]);
          if (origin?.isConnected) origin.focus();
          else input.blur();
          origin = null;
        }
        if (!by) return;
        event.preventDefault();
        take(input);
        const step = state.step * (event.shiftKey ? 10 : 1);
        setCoordinate(p, axis, stepped(state.design[p][axis], by * step));
      },
    },
  });
  const lock = html('button', {
    class: 'lock', 'aria-label': `lock ${label}`, 'aria-pressed': 'false', title: 'Lock: neither hand nor Tune moves it',
    on: { click: () => { state.locked[p][axis] = !state.locked[p][axis]; emit('options'); } },
  });
  const slope = html('span', { class: 'slope' });
  const bar = html('i', { class: 'bar' });
  const td = html('td', { on: { pointerenter: () => point(p, axis, 600), pointerleave: () => { if (document.activeElement !== input) point(null); } } },
    html('div', { class: 'cell' }, lock, html('span', { class: 'field' }, input, bar), html('span', { class: 'slope-box' }, slope)));
  return { td, input, lock, slope, bar, p, axis };
};

const build = () => {
  const { points, unit } = state.overview;
  const head = html('tr', {}, html('th', { text: 'point' }), ...AXES.map((a) => html('th', { class: 'number', text: `${a} [${unit}]` })), html('th', { class: 'number', text: `moved [${unit}]` }), html('td'));
  rows = points.map(({ name, about, follows }, p) => {
    const cells = AXES.map((_, axis) => cell(p, axis));
    const moved = html('span');
    const all = html('button', { class: 'small', text: '○', title: 'Lock the point', 'aria-label': `lock ${name}`, on: { click: () => { const to = !state.locked[p].every(Boolean); state.locked[p] = [to, to, to]; emit('options'); } } });
    const back = html('button', { class: 'small', text: '↺', title: 'Back to the file', 'aria-label': `reset ${name} to the file`, on: { click: () => put(state.design.map((c, q) => (q === p ? state.opened[p] : c)), 'back') } });
    const th = html('th', { scope: 'row', title: about }, html('button', { class: 'name', text: name, on: { click: () => select(p) } }));
    const tr = html('tr', { hidden: follows || null }, th, ...cells.map((c) => c.td), html('td', { class: 'number moved' }, moved), html('td', {}, html('span', { class: 'tools' }, all, back)));
    return { tr, cells, moved, all, back };
  });
  watch.disconnect();
  for (const { tr } of rows) watch.observe(tr);
  byId('coordinates').classList.toggle('tuned', state.overview.tunes);
  byId('coordinates').replaceChildren(html('thead', {}, head), html('tbody', {}, ...rows.map((r) => r.tr)));
};

// Range of a coordinate; computed again if the study or the file has changed.
const ends = (cell) => {
  const { overview, opened } = state;
  if (cell.known?.overview !== overview || cell.known.opened !== opened) cell.known = { overview, opened, ends: range(cell.p, cell.axis) };
  return cell.known.ends;
};

// Pause in milliseconds before invisible rows are updated. A row that is scrolled into view is updated at once.
const PAUSE = 300;
let late = null;
const watch = new IntersectionObserver((found) => {
  for (const { target, isIntersecting } of found) target.isSeen = isIntersecting;
  if (found.some(({ target, isIntersecting }) => isIntersecting && target.isLate)) draw();
});
const drawLate = () => { if (!isInGesture()) draw(true); };

const draw = (isAll = false) => {
  byId('back').disabled = !isMoved();
  clearTimeout(late);
  // A hidden table is not updated.
  if (!state.overview || byId('pane-points').hidden) return;
  const slopes = gradient();
  const steepest = slopes ? Math.max(...slopes.flat().map(Math.abs), 1e-300) : 1;
  rows.forEach(({ tr, cells, moved, all, back }, p) => {
    tr.classList.toggle('selected', state.selected === p);
    tr.isLate = !isAll && !tr.isSeen;
    if (tr.isLate) return;
    const way = Math.hypot(...state.design[p].map((c, k) => c - state.opened[p][k]));
    write(moved, way > 0 ? brief(way, 3) : '');
    back.style.visibility = way === 0 ? 'hidden' : '';
    set(all, { 'aria-pressed': String(state.locked[p].every(Boolean)), text: state.locked[p].every(Boolean) ? '●' : '○' });
    for (const one of cells) {
      const { input, lock, slope, bar, axis } = one;
      const value = state.design[p][axis];
      const changed = value !== state.opened[p][axis];
      if (document.activeElement !== input) putValue(input, short(value));
      else if (!hasOwnText(input) && Number(input.value) !== value) input.value = String(value);
      input.classList.toggle('changed', changed);
      const reach = ends(one);
      const outside = reach && (value < reach[0] || value > reach[1]);
      input.classList.toggle('outside', Boolean(outside));
      set(input, { title: input.why || [input.value.endsWith('…') ? String(value) : '', changed ? `file: ${state.opened[p][axis]}` : '', reach ? `range for Tune: ${brief(reach[0], 6)} … ${brief(reach[1], 6)}${outside ? ', outside' : ''}` : ''].filter(Boolean).join('; ') || null });
      set(lock, { 'aria-pressed': String(state.locked[p][axis]), text: state.locked[p][axis] ? '●' : '○' });
      input.readOnly = state.locked[p][axis];
      const g = slopes?.[p][axis] ?? 0;
      const shown = slopes && Math.abs(g) > 0.01 * steepest && Math.abs(g) > 1e-9;
      write(slope, shown ? `${g > 0 ? '↓' : '↑'}${brief(Math.abs(g), 2)}` : '');
      set(slope, { title: shown ? `${g > 0 ? 'lower' : 'raise'} it: −${brief(Math.abs(g), 3)} tolerances per ${state.overview.unit}` : null });
      const length = shown ? Math.round((1000 * Math.abs(g)) / steepest) / 10 : 0;
      if (one.length !== length) {
        one.length = length;
        bar.style.backgroundSize = `${length}% 100%`;
      }
    }
  });
  if (rows.some(({ tr }) => tr.isLate)) late = setTimeout(drawLate, PAUSE);
};

export const startTable = () => {
  on('study', () => { build(); draw(true); });
  for (const event of ['edited', 'answer', 'unanswered', 'late', 'options', 'selection']) on(event, () => draw());
  onRest(() => draw());
  on('tab', (name) => { if (name === 'points') draw(true); });
  on('fields', (p) => {
    const from = document.activeElement;
    openTab('points');
    rows[p].cells[0].input.focus();
    origin = from;
  });
  addEventListener('beforeprint', () => draw(true));
  // During a drag, the table is drawn after the curves, so that the browser lays out and paints only once.
  on('design', () => { if (!isInGesture()) draw(); });
  // The effect of a coordinate changes as points move.
  on('deed', () => { if (asked) askInfluence(...asked); });
};
