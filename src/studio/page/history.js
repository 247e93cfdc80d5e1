// The history that undo goes through, and designs that are pinned beside the present one.
import { brief, byId, html } from './draw.js';
import { askPins, copy, history, on, put, state, travel } from './design.js';
import { question } from './dialog.js';
import { writtenDiff } from './changes.js';
import { tellTab } from './layout.js';

const LETTERS = ['A', 'B', 'C'];

// The tab keeps pinned designs over a reload, by the names of points.
const key = () => `hardpoint pins ${state.overview.place}`;
const keepPins = () => {
  const { points } = state.overview;
  const kept = Object.entries(state.pins).map(([letter, { design }]) => [letter, points.map(({ name }, p) => [name, design[p]])]);
  try { sessionStorage.setItem(key(), JSON.stringify(kept)); } catch { /* no storage */ }
};
const restorePins = () => {
  const isPlace = (place) => Array.isArray(place) && place.length === 3 && place.every(Number.isFinite);
  try {
    for (const [letter, places] of JSON.parse(sessionStorage.getItem(key())) ?? []) {
      const byName = new Map(places);
      const design = state.overview.points.map(({ name }) => byName.get(name));
      if (LETTERS.includes(letter) && design.every(isPlace)) state.pins[letter] = { design, answer: null };
    }
  } catch { /* none that can be read */ }
  // Other parts of the page choose the curves first.
  if (Object.keys(state.pins).length) setTimeout(askPins);
};

const pin = (letter) => {
  state.pins[letter] = { design: copy(state.design), answer: state.answer };
  keepPins();
  draw();
  askPins();
};
const unpin = (letter) => {
  delete state.pins[letter];
  keepPins();
  draw();
  askPins();
};

const pinRow = (letter) => {
  const own = state.pins[letter];
  const misfit = own?.answer?.misfit?.value;
  const button = (text, handler) => html('button', { class: 'small', text, 'aria-label': `${text} ${letter}`, on: { click: handler } });
  const words = own ? (misfit === undefined || misfit === null ? 'no misfit' : `misfit ${brief(misfit, 4)}`) : 'empty';
  return html('tr', { class: `pin-${letter}`, 'data-pin': letter }, html('th', { scope: 'row' }, html('span', { class: 'letter', text: letter })), html('td', { text: words }),
    html('td', {}, ...(own ? [button('Go to', () => put(own.design, 'pin')), button('Replace', () => pin(letter)), button('Remove', () => unpin(letter))] : [button('Pin', () => pin(letter))])));
};

// Ranges of the curves of every pinned design beside those of the present one.
const comparison = () => {
  const pinned = LETTERS.filter((letter) => state.pins[letter]?.answer);
  if (!pinned.length || !state.answer) return [];
  const designs = [...pinned.map((letter) => [letter, state.pins[letter].answer]), ['now', state.answer]];
  const range = (answer, column) => {
    const values = answer.columns.find((c) => c.column === column)?.values.filter((v) => v !== null) ?? [];
    return values.length ? `${brief(Math.min(...values), 4)} … ${brief(Math.max(...values), 4)}` : '–';
  };
  const rows = state.answer.columns.map(({ column, title, unit }) => html('tr', {}, html('th', { scope: 'row', text: unit ? `${title} [${unit}]` : title }),
    ...designs.map(([, answer]) => html('td', { class: 'number', text: range(answer, column) }))));
  return [html('div', { class: 'scroll' }, html('table', { id: 'comparison' },
    html('thead', {}, html('tr', {}, ...['lowest … highest', ...designs.map(([name]) => name)].map((text, k) => html('th', { text, class: k ? 'number' : null })))),
    html('tbody', {}, ...rows)))];
};

const draw = () => {
  if (!state.overview) return;
  const { timeline, present } = history();
  tellTab('history', timeline.length > 1 ? String(timeline.length - 1) : '');
  const deeds = timeline.map(({ label }, k) => html('li', {}, html('button', { class: k > present ? 'later' : null, 'aria-current': k === present ? 'true' : null, text: label, on: { click: () => travel(k) } })));
  const changes = html('button', { id: 'changes', text: 'Show lines that change', on: { click: async () => { await question('Changes', `${state.overview.files.join(', ')}: lines that saving would change.`, [['', 'Close']], await writtenDiff()); } } });
  byId('pane-history').replaceChildren(html('div', { class: 'columns' },
    html('div', { class: 'panel' }, html('h2', { text: 'History' }), html('ol', { class: 'deeds' }, ...deeds.reverse())),
    html('div', { class: 'panel' }, html('h2', { text: 'Pinned designs' }), html('p', { class: 'hint', text: 'A pinned design stays in charts and views while you go on.' }), html('table', { id: 'pins' }, html('tbody', {}, ...LETTERS.map(pinRow))), ...comparison(),
      html('div', { class: 'add' }, changes))));
};

export const startHistory = () => {
  on('study', restorePins);
  for (const event of ['study', 'edited', 'deed', 'pins']) on(event, draw);
  on('answer', () => { if (Object.keys(state.pins).length && !byId('pane-history').hidden) draw(); });
  for (const event of ['chosen', 'place', 'edited']) on(event, () => { if (Object.keys(state.pins).length) askPins(); });
};
