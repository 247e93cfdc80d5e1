// History for undo and redo, and designs that are pinned beside the present design.
import { brief, byId, html, renew, scroller } from './draw.js';
import { askPins, copy, history, isEdited, isInGesture, isMoved, on, onRest, put, resume, state, travel } from './design.js';
import { action, question, say } from './dialog.js';
import { post } from './server.js';
import { writtenDiff } from './changes.js';
import { tellTab } from './layout.js';

const LETTERS = ['A', 'B', 'C'];

// When the page is reloaded, the tab keeps pinned designs and the history. Coordinates are stored by the names of points.
const key = (what) => `hardpoint ${what} ${state.overview.place}`;
const keep = (what, value) => { try { sessionStorage.setItem(key(what), JSON.stringify(value)); } catch { /* no storage */ } };
const kept = (what) => { try { return JSON.parse(sessionStorage.getItem(key(what))); } catch { return null; } };
const byName = (design) => state.overview.points.map(({ name }, p) => [name, design[p]]);
const isPlace = (place) => Array.isArray(place) && place.length === 3 && place.every(Number.isFinite);
// Design with these coordinates. Null if a point has no coordinates.
const designOf = (places) => {
  const found = new Map(Array.isArray(places) ? places : []);
  const design = state.overview.points.map(({ name }) => found.get(name));
  return design.every(isPlace) ? design : null;
};

let timer = null;
const keepHistory = () => {
  clearTimeout(timer);
  timer = setTimeout(() => {
    const { from } = state.overview;
    const { timeline, present } = history();
    // Actions before a save are not stored, because they refer to a text that the file no longer has.
    const own = timeline.filter(({ overview }) => overview.from === from);
    const deeds = own.map(({ label, design, overview }) => ({ label, places: byName(design), edits: overview.edits }));
    keep('history', { from, present: own.indexOf(timeline[present]), deeds });
  }, 200);
};
export const dropHistory = () => { clearTimeout(timer); try { sessionStorage.removeItem(key('history')); } catch { /* no storage */ } };
// Restores the history of this tab, if the file still has the text from which the history starts.
export const resumeHistory = async () => {
  const found = kept('history');
  const opened = state.overview;
  if (found?.from !== opened.digest || !Array.isArray(found.deeds) || !found.deeds[found.present]) return;
  const overviews = new Map([['[]', opened]]);
  const deeds = [];
  try {
    for (const { label, places, edits } of found.deeds) {
      const text = JSON.stringify(edits);
      if (!overviews.has(text)) overviews.set(text, { ...await post('edit', { digest: opened.digest, edits }), from: opened.from, edits });
      deeds.push({ label: String(label), design: designOf(places), overview: overviews.get(text) });
    }
  } catch { return; }
  if (deeds.some(({ design }) => design === null)) return;
  resume(deeds, found.present);
  if (isMoved() || isEdited()) say('Your unsaved changes are back, with their history.', 'ask', action('Back to the file', () => travel(0)));
};

const keepPins = () => keep('pins', Object.entries(state.pins).map(([letter, { design }]) => [letter, byName(design)]));
const restorePins = () => {
  const pins = kept('pins');
  for (const [letter, places] of Array.isArray(pins) ? pins : []) {
    const design = designOf(places);
    if (LETTERS.includes(letter) && design) state.pins[letter] = { design, answer: null };
  }
  // The request for the curves of pinned designs waits until the other parts of the page have chosen the curves.
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

// Table with the ranges of the curves of every pinned design and of the present design.
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
  return [scroller('Ranges of the curves', html('table', { id: 'comparison' },
    html('thead', {}, html('tr', {}, ...['lowest … highest', ...designs.map(([name]) => name)].map((text, k) => html('th', { text, class: k ? 'number' : null })))),
    html('tbody', {}, ...rows)))];
};

const draw = () => {
  if (!state.overview) return;
  const { timeline, present } = history();
  tellTab('history', timeline.length > 1 ? String(timeline.length - 1) : '');
  if (byId('pane-history').hidden) return;
  const deeds = timeline.map(({ label }, k) => html('li', {}, html('button', { class: k > present ? 'later' : null, 'aria-current': k === present ? 'true' : null, text: label, on: { click: () => travel(k) } })));
  const changes = html('button', { id: 'changes', text: 'Show lines that change', on: { click: async () => { await question('Changes', `${state.overview.files.join(', ')}: lines that saving would change.`, [['', 'Close']], await writtenDiff()); } } });
  renew(byId('pane-history'), html('div', { class: 'columns' },
    html('div', { class: 'panel' }, html('h2', { text: 'History' }), html('ol', { class: 'deeds' }, ...deeds.reverse())),
    html('div', { class: 'panel' }, html('h2', { text: 'Pinned designs' }), html('p', { class: 'hint', text: 'A pinned design stays in charts and views while you go on.' }), html('table', { id: 'pins' }, html('tbody', {}, ...LETTERS.map(pinRow))), ...comparison(),
      html('div', { class: 'add' }, changes))));
};

export const startHistory = () => {
  on('study', restorePins);
  on('deed', keepHistory);
  for (const event of ['study', 'edited', 'pins']) on(event, draw);
  onRest(draw);
  on('answer', () => { if (!isInGesture() || Object.keys(state.pins).length) draw(); });
  on('tab', (name) => { if (name === 'history') draw(); });
  for (const event of ['chosen', 'place', 'edited']) on(event, () => { if (Object.keys(state.pins).length) askPins(); });
};
