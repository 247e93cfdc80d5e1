// Panels beside the curves: targets, constraints, limits, directions that leave the targets unchanged, and warnings.
import { brief, byId, html, inDegrees, measured, quantity, renew, scroller, set, write } from './draw.js';
import { of, begin, copy, emit, finish, isInGesture, isSame, on, onRest, snapped, state } from './design.js';
import { openTab, tellTab } from './layout.js';
import { post } from './server.js';
import { constraintForms } from './constraints.js';
import { markMembersIn } from './picking.js';
import { partForms, targetForms } from './targets.js';
import { select } from './views.js';

let limits = null;
let free = [];

const words = (column) => column.replaceAll('_', ' ');
const panel = (title, ...children) => html('div', { class: 'panel', id: `panel-${title.toLowerCase().replaceAll(' ', '-')}` }, html('h2', { text: title }), ...children);
const table = (head, body, isNumber = (k) => k > 0) => html('table', {}, html('thead', {}, html('tr', {}, ...head.map((text, k) => html('th', { text, class: isNumber(k) ? 'number' : null })))), html('tbody', {}, ...body));

// Chips in the header: buttons with a name and a value. A chip can become wider, but never narrower, so that the header does
// not move. A click on a chip opens its panel.
let chips = new Map();
const buildChips = () => {
  const { tunes, builds, has_constraints: hasConstraints } = state.overview;
  const names = [...(tunes ? [['misfit', builds ? 'Nominal misfit' : 'Misfit', 'targets'], ['met', 'Targets met', 'targets']] : []),
    ...(hasConstraints ? [['constraints', 'Constraints', 'constraints']] : []), ['solved', 'Solved', 'warnings'], ['warnings', 'Warnings', 'warnings']];
  chips = new Map(names.map(([key, name, place]) => {
    const [value, note] = [html('b'), html('small')];
    const chip = html('button', { class: 'chip', 'data-chip': key, on: { click: () => lead(place) } }, html('span', { text: name }), html('span', { class: 'value' }, value, note));
    return [key, { chip, value, note, widest: {} }];
  }));
  // After the first move, the chip also shows the former misfit.
  widen('misfit', { note: ' from 00.0' });
  byId('figures').replaceChildren(...[...chips.values()].map(({ chip }) => chip));
};
// Opens the tab of a chip. For the constraints, it also selects a point that the first violated constraint names.
const lead = (place) => {
  openTab(place, true);
  const broken = place === 'constraints' && state.answer?.misfit?.constraints.find((c) => c.is_violated);
  if (broken) selectNamed(broken.name);
};
// Selects the first point whose name occurs in a text.
const selectNamed = (text) => {
  const { points } = state.overview;
  markMembersIn(text);
  const found = points.findIndex(({ name }) => text.includes(name));
  if (found >= 0) return select(found);
  const body = state.overview.scene.bodies.find(({ name }) => text.includes(name) || text.includes(name.replaceAll(' ', '_')));
  if (body) select(body.lines[0][0]);
};
// While a point moves, chips that need all stations keep their values and are grey.
const markStale = (isStale) => { for (const key of ['solved', 'warnings']) chips.get(key)?.chip.classList.toggle('stale', isStale); };
// Font sizes and weights of a chip, in pixels for the usual text size of the browser.
const SIZES = { value: [15.2, 700], note: [12, 400] };
const widen = (key, texts) => {
  const { chip, widest } = chips.get(key) ?? {};
  if (!chip) return;
  for (const [part, text] of Object.entries(texts)) {
    const width = Math.ceil(measured(text, ...SIZES[part]));
    if (width <= (widest[part] ?? 0)) continue;
    widest[part] = width;
    chip.style.setProperty(`--${part}`, `${width / 16}rem`);
  }
};
const tell = (key, value, note, bad, about = note) => {
  const found = chips.get(key);
  if (!found) return;
  write(found.value, value);
  write(found.note, note ? ` ${note}` : '');
  widen(key, { value, note: found.note.textContent });
  found.chip.classList.toggle('bad', Boolean(bad));
  set(found.chip, { title: about ? `${value} ${about}` : null });
};

// A target is met if the curve leaves it by no more than the tolerance anywhere, as in reports.
const isMet = (target) => Math.abs(target.worst) <= 1;

const figures = () => {
  const isPartial = !state.fault && Boolean(state.answer?.is_partial);
  markStale(isPartial);
  if (state.fault) {
    // Values of an earlier design do not apply to this design.
    for (const key of ['misfit', 'met', 'constraints', 'solved']) tell(key, '–', 'design not solved', true);
    tell('warnings', '1', '', true);
    return;
  }
  const misfit = state.answer?.misfit;
  if (misfit) {
    const before = state.ghost?.misfit?.value;
    const is = misfit.value === null ? 'none' : brief(misfit.value, 3);
    const changed = before !== null && before !== undefined && misfit.value !== null && Math.abs(before - misfit.value) > 5e-4;
    tell('misfit', is, changed ? `from ${brief(before, 3)}` : 'tol.', misfit.value === null, changed ? `tolerances, from ${brief(before, 3)}` : 'tolerances');
    const met = misfit.targets.filter(isMet).length;
    tell('met', misfit.value === null ? '–' : `${met} of ${misfit.targets.length}`, '', met < misfit.targets.length || misfit.value === null);
    const broken = misfit.constraints.filter((c) => c.is_violated);
    const [first, ...more] = broken;
    if (misfit.value === null) tell('constraints', '–', 'not known', true);
    else tell('constraints', first ? `${broken.length} violated:` : 'kept', first ? `${first.name}${more.length ? `, ${more.map((c) => c.name).join(', ')}` : ''}` : '', Boolean(first));
  }
  if (isPartial) return;
  if (state.answer) {
    const all = state.answer.status.length;
    const failed = state.answer.failures.reduce((sum, f) => sum + f.last - f.first + 1, 0);
    tell('solved', `${all - failed} of ${all}`, '', failed > 0, state.overview.is_car ? 'load cases' : 'stations');
  }
  const doubts = state.answer?.remarks.length ?? 0;
  tell('warnings', doubts ? String(doubts) : 'none', '', doubts > 0);
};

const targets = () => {
  const misfit = state.answer?.misfit;
  if (!misfit) return [panel('Targets', html('p', { class: 'hint', text: state.overview.is_car ? 'The study has no targets. Write [optimise] with variables and targets into the file; then every point shows the direction that lowers the misfit.' : 'The study has no targets. Press “+ target” on a chart to add one; then every point shows the direction that lowers the misfit.' }))];
  if (misfit.value === null) return [panel('Targets', html('p', { class: 'bad', text: `no misfit: ${misfit.reason}` }))];
  const body = misfit.targets.map((t, k) => html('tr', { class: state.arrows === k ? 'selected' : null },
    html('th', { scope: 'row' }, html('button', { class: 'name', text: quantity(t.column), title: 'Arrows for this target', 'aria-pressed': String(state.arrows === k), on: { click: () => { state.arrows = state.arrows === k ? null : k; emit('options'); } } })),
    html('td', { class: 'number', text: brief(t.rms, 3) }),
    html('td', { class: `number ${isMet(t) ? '' : 'bad'}`, text: brief(t.worst, 3) }), html('td', { class: 'number', text: t.worst_at === null ? words(t.worst_at_unit) : `${brief(t.worst_at, 4)} ${inDegrees(t.worst_at_unit)}` })));
  const { builds } = state.overview;
  const about = builds ? [html('p', { class: 'hint', text: `The page shows the misfit of the nominal design. Tune lowers the root mean square misfit of ${builds} builds.` })] : [];
  return [panel(builds ? 'Nominal deviations (multiples of the tolerance)' : 'Deviations (multiples of the tolerance)', table(['target', 'rms', 'largest', 'at'], body), ...about)];
};

const constraints = () => {
  const margins = state.answer?.misfit?.constraints ?? [];
  if (!margins.length) return [panel('Constraints', html('p', { class: 'hint', text: 'The study has no constraints.' }))];
  const rows = margins.map((c) => html('tr', { class: c.is_violated ? 'violated' : null },
    html('th', { scope: 'row' }, html('button', { class: 'name', text: inDegrees(c.is_violated ? `${c.name}, violated` : c.name), title: 'Show it in the views', on: { click: () => selectNamed(c.name) } })),
    html('td', { class: `number ${c.is_violated ? 'bad' : ''}`, text: `${brief(c.margin, 3)} ${inDegrees(c.unit)}` })));
  return [panel('Constraints', table(['constraint', 'margin'], rows))];
};

const freeDirections = () => {
  if (!free.length) return [];
  const { base, digest, directions } = free.at(-1);
  if (digest !== state.overview.digest || !directions.length) return [];
  const rows = directions.map(({ name, change, free: [low, high] }) => {
    const slider = html('input', { type: 'range', min: low, max: high, step: 'any', value: 0, 'aria-label': `along ${name}` });
    slider.addEventListener('pointerdown', () => { if (!slider.began) { begin('direction'); slider.began = true; } });
    slider.addEventListener('input', () => {
      if (!slider.began) { begin('direction'); slider.began = true; }
      const share = Number(slider.value);
      state.design = base.map((p, i) => p.map((c, k) => (change[i][k] === 0 || state.locked[i][k] ? c : snapped(c + share * change[i][k], state.step / 100))));
      emit('design');
    });
    slider.addEventListener('change', () => { slider.began = false; finish(); });
    return html('label', { class: 'direction' }, html('span', { text: name }), slider);
  });
  return [panel('Free directions', html('p', { class: 'hint', text: 'Each slider moves the points in a direction that leaves all targets unchanged to first order.' }), ...rows)];
};

const limitsPanel = () => {
  if (!limits) return [panel('Limits', html('p', { class: 'hint', text: 'Limits are being searched.' }))];
  const { title, header, rows, notes } = limits;
  const isNumber = (text) => text !== '' && Number.isFinite(Number(text));
  const cell = (text) => (isNumber(text) ? html('td', { class: 'number', text: text.replace('-', '−') }) : html('td', { class: 'words', text: words(text) }));
  const hasNumbers = (k) => k > 0 && rows.some((texts) => isNumber(texts[k]));
  const cells = rows.map(([first, ...others]) => html('tr', {}, html('th', { scope: 'row', text: quantity(first) || '–' }), ...others.map(cell)));
  const found = panel(title, scroller(title, table(header, cells, hasNumbers)), ...notes.map((text) => html('p', { class: 'hint', text })));
  found.classList.toggle('wide', header.length > 5);
  return [found];
};

const warnings = () => {
  const lines = [];
  if (state.fault) lines.push(['bad', state.fault]);
  for (const f of state.answer?.failures ?? []) lines.push(['bad', `not solved, ${f.place}: ${f.reason}`]);
  const frame = state.answer?.frame;
  if (frame?.pose?.Err) lines.push(['bad', state.overview.is_car ? `not drawn: ${frame.pose.Err}` : `no pose at the positions of the sliders: ${frame.pose.Err}`]);
  for (const remark of state.answer?.remarks ?? []) lines.push(['warn', remark]);
  if (!lines.length) lines.push(['hint', 'none']);
  return [panel('Warnings', html('ul', {}, ...lines.map(([kind, text]) => html('li', { class: kind, text }))))];
};

// Panes that are out of sight are filled when they are opened or printed.
const PANES = {
  targets: () => [...targets(), ...targetForms(), ...freeDirections()],
  constraints: () => [...constraints(), ...constraintForms(), ...limitsPanel()],
  parts: () => partForms(),
  warnings: () => warnings(),
};
const fill = (name, isWanted = false) => {
  const pane = byId(`pane-${name}`);
  // A slider or a field that is in use must stay.
  if ((pane.hidden && !isWanted) || pane.querySelector('input:active, input:focus')) return;
  renew(pane, html('div', { class: 'columns' }, ...PANES[name]()));
};
const draw = () => {
  figures();
  const misfit = state.answer?.misfit;
  tellTab('targets', misfit?.value === null || !misfit ? '' : `${misfit.targets.filter(isMet).length}/${misfit.targets.length}`);
  tellTab('constraints', misfit?.constraints.some((c) => c.is_violated) ? '!' : '');
  const isPartial = !state.fault && state.answer?.is_partial;
  if (!isPartial) tellTab('warnings', state.answer?.remarks.length || state.fault ? '!' : '');
  const select = byId('arrows');
  select.value = state.arrows === null ? 'all' : String(state.arrows);
  if (isInGesture() || isPartial) return;
  for (const name of Object.keys(PANES)) fill(name);
};

// Asks for the directions that leave all targets unchanged after the point has stopped moving, because they take longer to
// compute. Limits take longest: the page asks for limits only while it shows limits.
let timer = null;
const rest = () => {
  clearTimeout(timer);
  limits = null;
  timer = setTimeout(() => {
    const base = copy(state.design);
    const { digest } = state.overview;
    const isPresent = () => digest === state.overview.digest && isSame(base, state.design);
    post('directions', of(base)).catch(() => null).then((ways) => {
      if (digest !== state.overview.digest) return;
      free = ways ? [{ base, digest, directions: ways.directions }] : [];
      draw();
    });
    if (byId('pane-constraints').hidden) return;
    post('limits', of(base)).catch(({ message }) => ({ title: 'Limits', header: [], rows: [], notes: [message] })).then((found) => {
      if (!isPresent()) return;
      limits = found;
      draw();
    });
  }, 250);
};

export const startNotes = () => {
  const rebuild = () => {
    buildChips();
    free = [];
    const select = byId('arrows');
    const option = (value, text) => html('option', { value, text });
    select.replaceChildren(option('all', 'misfit'), ...state.overview.targets.map((t, k) => option(String(k), words(t.column))), option('none', 'none'));
    select.disabled = !state.overview.tunes;
    byId('tab-parts').firstChild.textContent = state.overview.is_car ? 'Car and cases' : 'Vehicle and parts';
    rest();
  };
  on('study', rebuild);
  on('edited', () => { state.arrows = null; rebuild(); });
  byId('arrows').addEventListener('change', (event) => {
    const { value } = event.target;
    state.arrows = value === 'all' ? null : value === 'none' ? 'none' : Number(value);
    emit('options');
  });
  for (const event of ['answer', 'ghost', 'options']) on(event, draw);
  onRest(draw);
  on('deed', rest);
  on('tab', (name) => {
    if (!state.overview) return;
    if (PANES[name]) fill(name);
    if (name === 'constraints' && !limits) rest();
  });
  addEventListener('beforeprint', () => { if (state.overview) for (const name of Object.keys(PANES)) fill(name, true); });
};
