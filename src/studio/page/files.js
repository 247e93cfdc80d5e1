// Save, save as, export, and the unsaved moves that the browser stores.
import { brief, byId, html, measured, svg, write } from './draw.js';
import { askGhost, copy, emit, forget, isEdited, isMoved, isOfFile, isSame, of, on, put, state, takeMotion, takeOverview } from './design.js';
import { dropHistory, resumeHistory } from './history.js';
import { edit } from './targets.js';
import { chartSvgs } from './curves.js';
import { viewSvgs } from './views.js';
import { post, postForText } from './server.js';
import { action, question, say } from './dialog.js';
import { writtenDiff } from './changes.js';
import { acceptProposal, hasProposal, isTuning } from './tuning.js';

// Reads the study from the file.
export const readStudy = async (overview = null) => {
  overview ??= await post('study', null);
  isOfFile(overview);
  takeMotion(overview);
  // Points that the file still has stay locked.
  const locks = new Map(state.overview?.points.map(({ name }, p) => [name, state.locked[p]]));
  state.overview = overview;
  state.opened = copy(overview.design);
  state.pins = {};
  state.design = copy(overview.design);
  state.locked = overview.points.map(({ name }) => locks.get(name) ?? [false, false, false]);
  state.at = overview.sliders.map((slider) => slider.home);
  state.arrows = null;
  state.selected = null;
  tellCompared('as opened');
  forget();
  await resumeHistory();
  emit('study');
  emit('design');
  emit('deed');
  askGhost();
};

// Writes into the legend to which state the page compares the design: "as opened" or "saved".
const tellCompared = (words) => write(byId('key-ghost'), words);
// Takes the answer to a save of a design with the text of `overview`. The user may have changed the design or the text since.
const saved = ({ digest, file }, design, overview) => {
  tellCompared('saved');
  overview.digest = digest;
  state.overview.base = overview.base = digest;
  isOfFile(overview);
  state.opened = design;
  dropDraft();
  keepDraft();
  askGhost();
  emit('saved');
  emit('design');
  if (!file) say(`No change was made to ${state.overview.files.join(', ')}.`);
  else say(isTuning() ? `${file} saved with the present points; the running tuning is not included.` : `${file} saved`);
};
// Asks what to do with an open proposal before a save, because it is not yet part of the design.
const settleProposal = async () => {
  if (!hasProposal()) return true;
  const chosen = await question('A proposal is open', 'Tune has proposed other points. The file gets the points as they are now, unless you accept the proposal first.', [
    ['accept', 'Accept it and save'], ['without', 'Save without it'], ['', 'Cancel'],
  ]);
  if (chosen?.answer === 'accept') await acceptProposal();
  return chosen !== null;
};
// Counts the starts and ends of this page's saves. The number is odd during a save.
let ownChanges = 0;
const save = async (isSure = false) => {
  if (!isSure && !await settleProposal()) return;
  const design = copy(state.design);
  // If values were edited, the page shows the changed lines and asks for confirmation before it saves. If another program has
  // changed the file in the meantime, the page asks how to resolve the conflict instead.
  if (isEdited() && !isSure) {
    const { base, file } = state.overview;
    const now = await post('digest', null).catch(() => base);
    if (now !== base) return settleConflict(`${file} has changed since it was opened`);
    const sure = await question('Save these changes?', `${state.overview.files.join(', ')}: lines that change.`, [['yes', 'Save'], ['', 'Cancel']], await writtenDiff());
    if (!sure) return;
  }
  ownChanges += 1;
  const { overview } = state;
  try {
    saved(await post('save', { of: of(design), name: null, anyway: false, base: state.file.digest }), design, overview);
  } catch (refused) {
    if (refused.status !== 409) return say(refused.message, 'bad');
    return settleConflict(refused.message);
  } finally { ownChanges += 1; }
};
// Saves, unless a save is in progress or a question is open. A second save at the same time would find the file changed.
let isSaving = false;
const saveOnce = async () => {
  if (isSaving || byId('dialog').open) return;
  isSaving = true;
  try {
    await save();
  } finally { isSaving = false; }
};
// Another program has changed the file since it was read.
const settleConflict = async (message) => {
  const chosen = await question('The file has changed', `${message}, by you or another program. Choose one:`, [
    ['merge', 'Put my changes into it'], ['as', 'Save as…'], ['reload', 'Reload it, drop my changes'], ['', 'Cancel'],
  ]);
  if (chosen?.answer === 'merge' && await rebase()) return save(true);
  if (chosen?.answer === 'as') return saveAs();
  if (chosen?.answer === 'reload') return reload();
};
// Unsaved moves and edits of this page. Moves are stored as coordinates, by the names of points.
const unsaved = () => {
  const { points, from, edits } = state.overview;
  const moves = points.flatMap(({ name }, p) => state.design[p].map((c, axis) => [name, axis, c, state.opened[p][axis]])).filter(([, , c, was]) => c !== was);
  return { moves, from, edits };
};
// Design of the file with these moves applied, and the points that are missing in the file.
const withMoves = ({ points, design: opened }, moves) => {
  const design = copy(opened);
  const missing = [];
  for (const [name, axis, value] of moves) {
    const p = points.findIndex((point) => point.name === name && !point.follows);
    if (p < 0) missing.push(name);
    else if (Number.isInteger(axis) && axis >= 0 && axis < 3 && Number.isFinite(value)) design[p][axis] = value;
  }
  return { design, missing };
};
// Reads the changed file, and applies the moves and edits of this page as one action. If the moves or edits do not fit the
// file, the page does not change. Returns true if the file was read.
const rebase = async () => {
  try {
    const { moves, from, edits } = unsaved();
    if (from !== state.file.digest) throw new Error('the file was changed after your last save, and you went back to a state before that save. Use “Save as”');
    const overview = await post('study', null);
    const { unit, axes } = state.overview;
    if (overview.unit !== unit || overview.axes.some((sign, k) => sign !== axes[k])) throw new Error('the file now has different axes or another unit');
    const edited = edits.length ? await post('edit', { digest: overview.digest, edits }) : null;
    const { design, missing } = withMoves(overview, moves);
    if (missing.length) throw new Error(`the file no longer has ${[...new Set(missing)].join(', ')}`);
    dropHistory();
    await readStudy(overview);
    if (edited) takeOverview(edited, 'Kept changes', edits, design);
    else put(design, 'kept');
    say(`${state.overview.file} read again. Your unsaved changes are kept.`);
    return true;
  } catch (refused) {
    say(`The file was not reloaded: ${refused.message}. The page still shows the earlier text with your changes.`, 'bad');
    return false;
  }
};
const reload = async () => {
  dropDraft();
  dropHistory();
  try {
    await readStudy();
    say(`${state.overview.file} read again`);
  } catch (refused) { say(refused.message, 'bad'); }
};
// Asks for a name and writes the study under it. A refusal of the name leaves the dialog open, with the name.
const saveAs = async () => {
  if (await settleProposal()) await askForName(state.overview.file.replace(/\.toml$/, '_2.toml'));
};
const askForName = async (wanted) => {
  const writeAs = async (text, anyway) => {
    const { file } = await post('save', { of: of(), name: text.trim(), anyway });
    say(`${file} written. This page still shows ${state.overview.file}.`);
  };
  let taken = null;
  const check = async (text) => {
    try {
      await writeAs(text, false);
    } catch (refused) {
      if (refused.status !== 409) return refused.message;
      taken = refused.message;
    }
    return null;
  };
  const chosen = await question('Save as', state.overview.is_car ? 'A new car beside this one, with its axles NAME_front.toml and NAME_rear.toml.' : 'A new study beside this one, with its comments.', [['ok', 'Save', check], ['', 'Cancel']], wanted);
  if (!chosen || taken === null) return;
  const sure = await question('Replace it?', `${taken}.`, [['yes', 'Replace', () => writeAs(chosen.text, true).then(() => null, ({ message }) => message)], ['', 'Another name']]);
  if (!sure) await askForName(chosen.text);
};

// Interval in milliseconds at which the page checks whether another program has changed the file.
const WATCH = 5000;
let told = null;
const watchFile = async () => {
  if (document.hidden || !state.overview || isTuning() || hasProposal()) return;
  const { digest, file } = state.overview;
  const own = ownChanges;
  const now = await post('digest', null).catch(() => null);
  // While this page saves, the file differs from the text that the page has read.
  if (own % 2 || own !== ownChanges) return;
  if (now === null || now === state.overview.base || now === told || digest !== state.overview.digest) return;
  told = now;
  say(`${state.overview.files.length > 1 ? `${file} or an axle of it` : file} was changed by another program. This page still shows the earlier text.`, 'ask',
    isMoved() || isEdited() ? action('Read it again, keep my changes', rebase) : action('Read it again', reload));
};

// The browser stores unsaved moves by point and edits of the text, so that they survive the end of the tab or the server. Each
// tab has its own draft, because a tab that saves must not drop the work of another tab.
const stem = () => `hardpoint studio ${state.overview.place} `;
const tabNumber = () => {
  let number = sessionStorage.getItem('hardpoint tab');
  if (number === null) {
    number = String(crypto.getRandomValues(new Uint32Array(1))[0]);
    sessionStorage.setItem('hardpoint tab', number);
  }
  return number;
};
const key = () => stem() + tabNumber();
const drop = (name) => { try { localStorage.removeItem(name()); } catch { /* no storage, so no draft */ } };
const dropDraft = () => drop(key);
let timer = null;
const keepDraft = () => {
  clearTimeout(timer);
  timer = setTimeout(() => {
    if (!isMoved() && !isEdited()) return dropDraft();
    try { localStorage.setItem(key(), JSON.stringify({ when: Date.now(), ...unsaved(), isEdited: isEdited() })); } catch { /* no storage */ }
  }, 200);
};
// The latest draft of the study, with the name under which the browser keeps it.
const latestDraft = () => {
  const read = (name) => { try { return [name, JSON.parse(localStorage.getItem(name))]; } catch { return [name, null]; } };
  const isOwn = (name) => name.startsWith(stem()) && /^\d+$/.test(name.slice(stem().length));
  try {
    const drafts = Object.keys(localStorage).filter(isOwn).map(read).filter(([, draft]) => Array.isArray(draft?.moves));
    return drafts.sort(([, a], [, b]) => b.when - a.when)[0] ?? [null, null];
  } catch { return [null, null]; }
};
// Offers the draft of another tab, if this tab has no draft.
let isOffered = false;
const offerDraft = () => {
  if (isOffered) return;
  isOffered = true;
  if (isMoved() || isEdited()) return;
  const [name, draft] = latestDraft();
  if (draft === null) return;
  const edits = Array.isArray(draft.edits) ? draft.edits : [];
  // Edits name a target or variable by its index, so they only fit the text of the study for which they were made.
  const hasEdits = edits.length > 0 && draft.from === state.overview.from;
  // After a save and an undo, the draft has no edits, although its text differs from the file.
  const isLost = !hasEdits && (edits.length > 0 || draft.isEdited === true);
  const { design } = withMoves(state.overview, draft.moves);
  const discard = () => drop(() => name);
  const when = new Date(draft.when).toLocaleTimeString([], { hour: '2-digit', minute: '2-digit' });
  if (isSame(design, state.design) && !hasEdits) {
    if (isLost) say(`Unsaved edits of values from ${when} cannot be restored: the file has changed since.`, 'bad', action('Discard', discard));
    return;
  }
  const restore = async () => {
    if (hasEdits) await edit(edits, 'Restored edits');
    put(design, 'draft');
    // From now on, the draft of this tab contains these changes.
    discard();
    if (isLost) say('The points are restored. Edits of targets and variables are not: the file has changed since.', 'bad');
  };
  say(`Unsaved changes from ${when}.`, 'ask', action('Restore', restore), action('Discard', discard));
};

// Style properties that an exported picture copies from the drawing on the screen.
const LOOKS = ['stroke', 'stroke-width', 'stroke-dasharray', 'stroke-linecap', 'stroke-linejoin', 'fill', 'fill-opacity', 'stroke-opacity', 'opacity', 'font-size', 'font-family', 'font-weight', 'paint-order', 'display'];
const still = (source) => {
  const image = source.cloneNode(true);
  const [from, to] = [source, image].map((element) => [element, ...element.querySelectorAll('*')]);
  from.forEach((element, i) => {
    const look = getComputedStyle(element);
    for (const name of LOOKS) to[i].setAttribute(name, look.getPropertyValue(name));
    for (const name of ['class', 'style', 'tabindex', 'role', 'aria-label']) to[i].removeAttribute(name);
  });
  // Marks of a handle that has the focus are no part of the picture.
  from.forEach((element, i) => { if (element.matches('.edge text, .edge .hit')) to[i].remove(); });
  return image;
};
// Entries of the legends of exported pictures: text, name of the colour, and attributes of the line.
const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
const PIN_COLOURS = { A: '--hue2', B: '--hue1', C: '--hue5' };
const COMPARED = (dashes) => [byId('key-ghost').textContent, '--ghost', { 'stroke-width': 2, 'stroke-dasharray': dashes }];
const others = () => [...(state.proposed ? [['proposal', '--proposal', { 'stroke-width': 2 }]] : []),
  ...Object.keys(state.pins).map((letter) => [`pinned ${letter}`, PIN_COLOURS[letter], { 'stroke-width': 1.75, 'stroke-dasharray': '9 3' }])];
const curvesKey = () => [['now', '--accent', { 'stroke-width': 2.25 }], COMPARED('5 4'), ...others(),
  ...(state.overview.targets.length ? [['wanted', '--want', { 'stroke-width': 8, 'stroke-opacity': 0.35 }], ['strip below: deviation / tolerance, band ±1', '--want', { 'stroke-width': 1.25 }]] : [])];
const viewsKey = () => {
  const aim = state.arrows === null ? 'the misfit' : state.overview.targets[state.arrows]?.column.replaceAll('_', ' ');
  return [COMPARED('3 3'), ...others(), ...(document.querySelector('.arrows .arrow') && state.arrows !== 'none' && state.answer?.misfit ? [[`direction that lowers ${aim}`, '--arrow', { 'stroke-width': 2 }]] : []),
    [state.overview.is_car ? 'cross: centre of gravity of the sprung mass' : 'cross: roll centre', '--proposal', { 'stroke-width': 1.75 }]];
};
// Sizes of a legend in pixels. `rowsOf` places the entries of the legend in rows of this width.
const KEY = { size: 12, line: 26, gap: 20, row: 18 };
const rowsOf = (entries, width) => {
  let [x, row] = [0, 0];
  const placed = entries.map((entry) => {
    const own = KEY.line + 6 + measured(entry[0], KEY.size, 400);
    if (x > 0 && x + own > width) [x, row] = [0, row + 1];
    const found = { entry, x, row };
    x += own + KEY.gap;
    return found;
  });
  return [placed, row + 1];
};
// A picture of drawings with their titles, below a line with the study's name and a legend.
const sheet = (pictures, across, heading, entries) => {
  const boxes = pictures.map(([, , source]) => source.getBoundingClientRect());
  const [width, height] = [Math.max(...boxes.map((b) => b.width)), Math.max(...boxes.map((b) => b.height))];
  const rows = Math.ceil(pictures.length / across);
  const all = across * (width + 16) + 16;
  const [key, keyRows] = rowsOf(entries, all - 40);
  const head = 36 + KEY.row * keyRows;
  const tall = head + rows * (height + 36) + 16;
  const look = getComputedStyle(document.body);
  const words = (x, y, size, weight, text) => svg('text', { x, y, fill: look.color, 'font-family': look.fontFamily, 'font-size': size, 'font-weight': weight, text });
  const page = svg('svg', { xmlns: 'http://www.w3.org/2000/svg', width: all, height: tall, viewBox: `0 0 ${all} ${tall}` },
    svg('rect', { width: all, height: tall, fill: look.backgroundColor }), words(20, 26, 15, 650, heading));
  for (const { entry: [text, name, stroke], x, row } of key) {
    const y = 44 + KEY.row * row;
    page.append(svg('path', { d: `M${20 + x} ${y}h${KEY.line}`, fill: 'none', stroke: colour(name), ...stroke }), words(20 + x + KEY.line + 6, y + 4, KEY.size, 400, text));
  }
  pictures.forEach(([, title, source], k) => {
    const [x, y] = [16 + (k % across) * (width + 16), head + Math.floor(k / across) * (height + 36)];
    const image = still(source);
    image.setAttribute('x', x);
    image.setAttribute('y', y + 24);
    image.setAttribute('width', boxes[k].width);
    image.setAttribute('height', boxes[k].height);
    page.append(words(x + 4, y + 18, 13, 600, title), image);
  });
  return new XMLSerializer().serializeToString(page);
};
// Heading of exported drawings: name of the study, and further texts such as slider positions.
const headingOf = (...more) => [state.overview.name, ...more].join(' · ');
// Positions of the sliders that move, as in "rack 0 mm".
const positions = () => state.overview.sliders.flatMap(({ name, unit, low, high, names }, k) => (names.length ? [names[state.at[k]].replaceAll('_', ' ')] : low === high ? [] : [`${name} ${brief(state.at[k], 4)} ${unit}`]));
const download = (name, blob) => {
  const link = html('a', { href: URL.createObjectURL(blob), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
};
const asPng = (text) => new Promise((done, failed) => {
  const image = new Image();
  image.onload = () => {
    const canvas = html('canvas', { width: image.width * 2, height: image.height * 2 });
    const context = canvas.getContext('2d');
    context.drawImage(image, 0, 0, canvas.width, canvas.height);
    canvas.toBlob((blob) => (blob ? done(blob) : failed(new Error('no picture'))), 'image/png');
  };
  image.onerror = () => failed(new Error('no picture'));
  image.src = `data:image/svg+xml;charset=utf-8,${encodeURIComponent(text)}`;
});
const sheets = {
  curves: () => sheet(chartSvgs(), 2, headingOf(...(state.motion === null ? [] : [state.motion]), ...positions()), curvesKey()),
  views: () => sheet(viewSvgs(), 2, headingOf(`lengths in ${state.overview.unit}`, ...positions()), viewsKey()),
};
const exported = async (what) => {
  const { name } = state.overview;
  const [of_, form] = what.split('-');
  const { motion } = state;
  if (what === 'print') window.print();
  else if (what === 'csv') download(`${motion === null ? name : `${name}_${motion}`}.csv`, new Blob([await postForText('csv', { ...of(), motion })], { type: 'text/csv' }));
  else if (what === 'points') download(`${name}_hardpoints.csv`, new Blob([await postForText('points', of())], { type: 'text/csv' }));
  else if (what === 'dxf') download(`${name}.dxf`, new Blob([await postForText('dxf', of())], { type: 'image/vnd.dxf' }));
  else if (what === 'report') {
    const place = await post('report', of());
    say('The report page is ready.', 'ask', html('a', { href: place, target: '_blank', rel: 'noopener', text: 'Open it' }));
  } else if (form === 'svg') download(`${name}_${of_}.svg`, new Blob([sheets[of_]()], { type: 'image/svg+xml' }));
  else download(`${name}_${of_}.png`, await asPng(sheets[of_]()));
};

export const startFiles = () => {
  byId('save').addEventListener('click', saveOnce);
  byId('save-as').addEventListener('click', saveAs);
  byId('export').addEventListener('click', (event) => {
    const what = event.target.dataset?.export;
    if (!what) return;
    byId('export').open = false;
    exported(what).catch((refused) => say(refused.message, 'bad'));
  });
  document.addEventListener('keydown', (event) => {
    if ((event.ctrlKey || event.metaKey) && event.key.toLowerCase() === 's') {
      event.preventDefault();
      saveOnce();
    }
  });
  setInterval(watchFile, WATCH);
  window.addEventListener('focus', watchFile);
  on('study', offerDraft);
  on('deed', keepDraft);
  on('design', () => {
    const moved = isMoved() || isEdited();
    byId('save').classList.toggle('strong', moved);
    const title = `${moved ? '• ' : ''}${state.overview.name} · hardpoint studio`;
    if (document.title !== title) document.title = title;
  });
};
