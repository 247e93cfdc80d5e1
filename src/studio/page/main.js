// Starts all parts of the page, and contains code that belongs to no single part.
import { brief, byId, html, set } from './draw.js';
import { ask, askGhost, canRedo, canUndo, emit, isEdited, isSettled, on, put, redo, state, undo } from './design.js';
import { Refused, watchServer } from './server.js';
import { startViews } from './views.js';
import { drawnPlaces, drawnValues, startCurves } from './curves.js';
import { startCases } from './cases.js';
import { startTable } from './table.js';
import { startNotes } from './notes.js';
import { startPicking } from './picking.js';
import { startTuning } from './tuning.js';
import { hideMessage, say } from './dialog.js';
import { startSpeech } from './speech.js';
import { readStudy, startFiles } from './files.js';
import { startHistory } from './history.js';
import { openTab, startLayout } from './layout.js';

const root = document.documentElement;

// Chooses a light or a dark page: the stored choice, or else that of the system.
const prefersDark = matchMedia('(prefers-color-scheme: dark)');
const startTheme = () => {
  const put = (theme) => { if (theme) root.dataset.theme = theme; else delete root.dataset.theme; };
  try { put(localStorage.getItem('hardpoint theme') ?? ''); } catch { /* no storage */ }
  byId('theme').addEventListener('click', () => {
    const isDark = root.dataset.theme ? root.dataset.theme === 'dark' : prefersDark.matches;
    const theme = isDark ? 'light' : 'dark';
    put(theme);
    try { localStorage.setItem('hardpoint theme', theme); } catch { /* no storage */ }
    emit('answer', null);
  });
};

const STEPS = { mm: [0.01, 0.1, 1, 5], m: [0.00001, 0.0001, 0.001, 0.005], in: [0.001, 0.005, 0.05, 0.2] };
const startSliders = () => {
  const step = byId('step');
  let sliders = [];
  const show = () => sliders.forEach(({ input, output, unit }, k) => {
    input.value = state.at[k];
    if (!output) return;
    output.textContent = `${brief(state.at[k], 4)} ${unit}`;
    input.setAttribute('aria-valuetext', output.textContent);
  });
  const build = () => {
    const { sliders: wanted, unit } = state.overview;
    sliders = wanted.map(({ key, name, unit: own, low, high, names }, k) => {
      if (names.length) {
        const input = html('select', { id: key, on: { change: (event) => { state.at[k] = Number(input.value); emit('place', event); } } },
          ...names.map((text, value) => html('option', { value, text: text.replaceAll('_', ' ') })));
        return { input, label: html('label', { for: key }, html('span', { text: name }), input) };
      }
      const input = html('input', { id: key, type: 'range', min: low, max: high, step: 'any', on: { input: (event) => { state.at[k] = Number(input.value); emit('place', event); } } });
      const output = html('output', { for: key, 'aria-live': 'off' });
      const label = html('label', { for: key }, html('span', { text: name }), input, output);
      label.hidden = low === high;
      return { input, output, label, unit: own };
    });
    byId('sliders').replaceChildren(...sliders.map(({ label }) => label));
    byId('rack-curves-label').hidden = sliders.at(-1).label.hidden || state.overview.is_car;
    byId('home').hidden = state.overview.is_car;
    step.replaceChildren(...STEPS[unit].map((value) => html('option', { value, text: `${value} ${unit}` })));
    if (!STEPS[unit].includes(state.step)) [, state.step] = STEPS[unit];
    step.value = state.step;
    show();
  };
  on('study', () => { state.step = null; build(); });
  on('edited', () => {
    // If a list of names has become shorter, the slider moves to its last entry.
    state.overview.sliders.forEach(({ names, high }, k) => { if (names.length) state.at[k] = Math.min(state.at[k], high); });
    build();
  });
  on('motion', build);
  const place = (event) => {
    show();
    ask(event);
    if (state.curvesAtRack || isEdited()) askGhost();
  };
  byId('home').addEventListener('click', (event) => { state.at = state.overview.sliders.map((slider) => slider.home); emit('place', event); });
  byId('rack-curves').addEventListener('change', (event) => { state.curvesAtRack = event.target.checked; askGhost(); ask(event); });
  step.addEventListener('change', () => { state.step = Number(step.value); });
  byId('coupled').addEventListener('change', (event) => { state.coupled = event.target.checked; });
  on('place', place);
};

const startDeeds = () => {
  byId('undo').addEventListener('click', undo);
  byId('redo').addEventListener('click', redo);
  byId('back').addEventListener('click', () => put(state.opened, 'back'));
  document.addEventListener('keydown', (event) => {
    if (!(event.ctrlKey || event.metaKey) || byId('dialog').open || event.target.matches('input[type=text]')) return;
    const name = event.key.toLowerCase();
    if (name === 'z' && !event.shiftKey) undo();
    else if (name === 'y' || (name === 'z' && event.shiftKey)) redo();
    else return;
    event.preventDefault();
  });
  on('deed', () => {
    byId('undo').disabled = !canUndo();
    byId('redo').disabled = !canRedo();
  });
  document.addEventListener('keydown', (event) => {
    if (event.key !== 'Escape') return;
    const menus = document.querySelectorAll('details.menu[open]');
    for (const menu of menus) {
      menu.open = false;
      menu.querySelector('summary').focus();
    }
    if (!menus.length && !byId('dialog').open && !byId('banner').hidden) hideMessage();
  });
  document.addEventListener('click', (event) => {
    for (const menu of document.querySelectorAll('details.menu[open]')) if (!menu.contains(event.target)) menu.open = false;
  });
};

// F6 goes to the next part of the page, Shift+F6 to the one before.
const REGIONS = ['header .actions', '#stage', 'section.curves', '#drawer', '#banner'];
const startRegions = () => document.addEventListener('keydown', (event) => {
  if (event.key !== 'F6' || byId('dialog').open) return;
  event.preventDefault();
  const regions = REGIONS.map((name) => document.querySelector(name)).filter((region) => region.checkVisibility());
  const now = regions.findIndex((region) => region.contains(document.activeElement));
  const next = event.shiftKey ? (now <= 0 ? regions.length : now) - 1 : (now + 1) % regions.length;
  const controls = regions[next].querySelectorAll('button:enabled, select:enabled, input:enabled, summary, [tabindex="0"]');
  [...controls].find((control) => control.checkVisibility() && control.tabIndex >= 0)?.focus();
});

// If the server does not answer, the page asks again every second. The user can still move points, and the browser stores the
// moves.
let retry = null;
const startWatch = () => watchServer((there) => {
  clearInterval(retry);
  root.dataset.server = there;
  if (there === 'yes') {
    if (state.overview) {
      say('The server answers again');
      ask();
    }
  } else if (there === 'other') {
    say('Another server answers at this port. Open the address that it printed; this browser keeps unsaved moves and offers them at that address.', 'bad');
  } else {
    say('The server does not answer. The curves show its last answer; this browser keeps your moves.', 'bad');
    retry = setInterval(() => ask(), 1000);
  }
});

// While the answer for a moved design is late, the results of the earlier design are grey.
const startLate = () => {
  for (const event of ['late', 'answer', 'unanswered']) {
    on(event, () => {
      if (state.isLate) root.dataset.late = 'true';
      else delete root.dataset.late;
    });
  }
};

// Measures the time from an event that moves something until the page shows the result.
const startClock = () => {
  const times = [];
  on('answer', (since) => {
    root.dataset.answers = Number(root.dataset.answers ?? 0) + 1;
    if (since === null || since === undefined) return;
    requestAnimationFrame(() => {
      // A message posted now arrives after the browser has painted the picture.
      const { port1, port2 } = new MessageChannel();
      port1.onmessage = () => times.push([performance.now() - since, state.answer?.milliseconds ?? null]);
      port2.postMessage(null);
    });
  });
  return times;
};

const start = async () => {
  startTheme();
  startLayout();
  startHistory();
  startSpeech();
  startRegions();
  byId('skip').addEventListener('click', () => openTab('points'));
  startFiles();
  startSliders();
  startDeeds();
  startViews();
  startPicking();
  startCurves();
  startCases();
  startTable();
  startNotes();
  startTuning();
  startWatch();
  startLate();
  const times = startClock();
  on('study', () => {
    const { name, topology, files, points } = state.overview;
    // A long name may break after its underscores.
    set(byId('study-name'), { title: name }).replaceChildren(...name.split(/(?<=_)/).flatMap((part) => [part, html('wbr')]));
    byId('study-about').textContent = `${topology} · ${points.filter(({ follows }) => !follows).length} points · ${files.join(', ')}`;
    ask();
  });
  on('design', () => ask(window.event));
  // Access for tests: the shown values, and the computing times.
  window.studio = { state, times, isSettled, drawnValues, drawnPlaces };
  try {
    await readStudy();
    root.dataset.ready = 'true';
  } catch (refused) {
    if (!(refused instanceof Refused)) throw refused;
    say(refused.message, 'bad');
  }
};
start();
