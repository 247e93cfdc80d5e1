// History for undo and redo, and designs that are pinned beside the present design.
import { brief, byId, html, renew, scroller } from './draw.js';
import { askPins, copy, history, isEdited, isInGesture, isMoved, isSame, on, onRest, put, resume, state, travel } from './design.js';
import { action, question, say } from './dialog.js';
import { endsOf } from './runs.js';
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
    const { timeline, present } = history();
    const deeds = timeline.map(({ label, design, overview: { from, edits } }) => ({ label, places: byName(design), from, edits }));
    keep('history', { file: state.file.digest, present, deeds });
  }, 200);
};
export const dropHistory = () => { clearTimeout(timer); try { sessionStorage.removeItem(key('history')); } catch { /* no storage */ } };
// Restores the history of this tab, if the file still has the text that this tab last read or saved. It leaves out actions whose
// text the server no longer has. These actions are from the time before a save.
export const resumeHistory = async () => {
  const found = kept('history');
  const opened = state.overview;
  if (found?.file !== opened.digest || !Array.isArray(found.deeds)) return;
  const overviewOf = ({ from, edits }) => post('edit', { digest: from, edits }).then((overview) => ({ ...overview, base: opened.base, from, edits }), () => null);
  const textOf = ({ from, edits }) => JSON.stringify([from, edits]);
  const overviews = new Map([[textOf(opened), opened]]);
  const deeds = [];
  let present = -1;
  for (const [k, deed] of found.deeds.entries()) {
    const text = textOf(deed);
    if (!overviews.has(text)) overviews.set(text, await overviewOf(deed));
    const [design, overview] = [designOf(deed.places), overviews.get(text)];
    if (!design || !overview) continue;
    if (k === found.present) present = deeds.length;
    deeds.push({ label: String(deed.label), design, overview });
  }
  if (present < 0) return;
  resume(deeds, present);
  // After a save, the first action is not the state of the file.
  const ofFile = deeds.findIndex(({ overview, design }) => overview.digest === opened.digest && isSame(design, state.opened));
  if (isMoved() || isEdited()) say('Your unsaved changes are back, with their history.', 'ask', ...(ofFile < 0 ? [] : [action('Back to the file', () => travel(ofFile))]));
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
    const [low, high] = endsOf(values);
    return values.length ? `${brief(low, 4)} … ${brief(high, 4)}` : '–';
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
  for (const event of ['deed', 'saved']) on(event, keepHistory);
  for (const event of ['study', 'edited', 'pins']) on(event, draw);
  onRest(draw);
  on('answer', () => { if (!isInGesture() || Object.keys(state.pins).length) draw(); });
  on('tab', (name) => { if (name === 'history') draw(); });
  for (const event of ['chosen', 'place', 'edited']) on(event, () => { if (Object.keys(state.pins).length) askPins(); });
};
