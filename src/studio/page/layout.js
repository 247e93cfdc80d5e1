// The window: splitters between views, curves and drawer, and the tabs of the drawer.
import { byId, html, write } from './draw.js';
import { emit } from './design.js';

const STEP = 24;
const STORED = 'hardpoint layout';
const isStacked = () => matchMedia('(max-width: 56rem)').matches;

const limits = {
  split: () => [0.25 * innerWidth, 0.75 * innerWidth],
  drawer: () => [38, 0.75 * innerHeight],
};
const sizes = {};
const store = () => { try { localStorage.setItem(STORED, JSON.stringify(sizes)); } catch { /* no storage */ } };
const within = (value, [low, high]) => Math.max(low, Math.min(high, value));
const measured = { split: () => byId('stage').offsetWidth, drawer: () => byId('drawer').offsetHeight };
// Tells a screen reader where a splitter is.
const tellSize = (name, size) => {
  const bar = byId(`${name}-bar`);
  const [low, high] = limits[name]().map(Math.round);
  for (const [what, value] of [['now', size], ['min', low], ['max', high]]) bar.setAttribute(`aria-value${what}`, String(value));
};
const put = (name, value) => {
  sizes[name] = Math.round(within(value, limits[name]()));
  document.documentElement.style.setProperty(`--${name}`, `${sizes[name]}px`);
  tellSize(name, sizes[name]);
};

// A splitter. The user drags it or moves it by arrow keys. A double click or Home resets it.
const splitter = (name, along, sign, keys) => {
  const bar = byId(`${name}-bar`);
  bar.addEventListener('pointerdown', (event) => {
    if (isStacked()) return;
    event.preventDefault();
    bar.focus();
    bar.setPointerCapture(event.pointerId);
    const [from, size] = [event[along], measured[name]()];
    const move = (now) => put(name, size + sign * (now[along] - from));
    const end = () => {
      bar.removeEventListener('pointermove', move);
      store();
    };
    bar.addEventListener('pointermove', move);
    for (const what of ['pointerup', 'pointercancel']) bar.addEventListener(what, end, { once: true });
  });
  const home = () => {
    delete sizes[name];
    document.documentElement.style.removeProperty(`--${name}`);
    store();
  };
  bar.addEventListener('dblclick', home);
  bar.addEventListener('keydown', (event) => {
    const by = keys[event.key];
    if (event.key === 'Home') home();
    else if (by) put(name, measured[name]() + by * STEP);
    else return;
    event.preventDefault();
    store();
  });
};

const tabs = () => [...byId('tabs').querySelectorAll('[role=tab]')];
export const openTab = (name, focus = false) => {
  for (const tab of tabs()) {
    const isOpen = tab.dataset.tab === name;
    tab.setAttribute('aria-selected', String(isOpen));
    tab.tabIndex = isOpen ? 0 : -1;
    byId(`pane-${tab.dataset.tab}`).hidden = !isOpen;
    if (isOpen && focus) tab.focus();
  }
  byId('drawer').classList.add('open');
  byId('fold').setAttribute('aria-expanded', 'true');
  if (!isStacked() && measured.drawer() < 120) put('drawer', 260);
  emit('tab', name);
};
export const tellTab = (name, note) => write(byId(`tab-${name}`).querySelector('small span'), note);

const fold = () => {
  const isOpen = isStacked() ? byId('drawer').classList.toggle('open') : measured.drawer() < 60;
  if (!isStacked()) put('drawer', isOpen ? 260 : 38);
  byId('fold').setAttribute('aria-expanded', String(isOpen));
  store();
};

export const startLayout = () => {
  const names = { points: 'Points', targets: 'Targets', constraints: 'Constraints', parts: 'Vehicle and parts', proposal: 'Proposal', history: 'History', warnings: 'Warnings' };
  byId('tabs').replaceChildren(...Object.entries(names).map(([name, text]) => html('button', {
    role: 'tab', id: `tab-${name}`, 'data-tab': name, 'aria-controls': `pane-${name}`, on: { click: () => openTab(name) },
  }, text, html('small', {}, html('span')))));
  byId('tabs').addEventListener('keydown', (event) => {
    const all = tabs().filter((tab) => !tab.hidden);
    const now = all.findIndex((tab) => tab.getAttribute('aria-selected') === 'true');
    const to = { ArrowLeft: now - 1, ArrowRight: now + 1, Home: 0, End: all.length - 1 }[event.key];
    if (to === undefined) return;
    event.preventDefault();
    openTab(all[(to + all.length) % all.length].dataset.tab, true);
  });
  byId('fold').addEventListener('click', fold);
  splitter('split', 'clientX', 1, { ArrowLeft: -1, ArrowRight: 1 });
  splitter('drawer', 'clientY', -1, { ArrowUp: 1, ArrowDown: -1 });
  try {
    for (const [name, value] of Object.entries(JSON.parse(localStorage.getItem(STORED)) ?? {})) if (limits[name] && Number.isFinite(value)) put(name, value);
  } catch { /* no storage */ }
  addEventListener('resize', () => { for (const name of Object.keys(sizes)) put(name, sizes[name]); });
  openTab('points');
  for (const name of Object.keys(limits)) tellSize(name, measured[name]());
  if (isStacked()) {
    byId('drawer').classList.remove('open');
    byId('fold').setAttribute('aria-expanded', 'false');
  }
};
