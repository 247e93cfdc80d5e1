// Tuning on the page: progress, cancel, and the result as a proposal beside the present design.
import { AXES, brief, byId, html, inDegrees, renew, scroller, signed } from './draw.js';
import { askMisfit, askProposal, copy, described, isSame, of, on, put, snapped, state, takeOverview } from './design.js';
import { say } from './dialog.js';
import { openTab, tellTab } from './layout.js';
import { announce } from './speech.js';
import { post } from './server.js';

let job = null;
let proposal = null;
// Misfit of the proposal without rounding.
let exact = null;

const box = () => byId('proposal');
// Keeps the focus in the box when the control with the focus disappears.
const show = (...children) => {
  const held = box().contains(document.activeElement);
  box().replaceChildren(...children);
  if (held) byId('tab-proposal').focus({ preventScroll: true });
  box().hidden = children.length === 0;
  byId('no-proposal').hidden = children.length > 0;
};
const close = () => {
  proposal = null;
  exact = null;
  show();
  tellTab('proposal', '');
  askProposal(null);
};
// Steps to which accepted coordinates are rounded, by unit. The first step is the default. 0 keeps all digits.
const ROUNDINGS = { mm: [0.01, 0.001, 0.1, 0.5, 1, 0], m: [0.00001, 0.000001, 0.0001, 0.0005, 0.001, 0], in: [0.001, 0.0001, 0.005, 0.01, 0.05, 0] };
const rounded = (value, step) => (step ? snapped(value, step) : value);

export const hasProposal = () => proposal !== null;
export const isTuning = () => job !== null;
export const acceptProposal = async () => {
  await retune();
  if (!proposal) return;
  const design = taken();
  const tuned = ratesTaken();
  close();
  if (!tuned) return put(design, 'tune');
  const label = (before) => (isSame(before, design) ? 'Accepted proposal: tuned values' : `${described('tune', before)}, tuned values`);
  takeOverview(tuned.overview, label, tuned.edits, design);
};
// Study with the tuned values, if there are such values and the user has selected them.
const ratesTaken = () => (proposal.tuned?.overview && proposal.rates.checked ? proposal.tuned : null);
const digestTaken = () => ratesTaken()?.overview.digest;

// Value between the present and the tuned value, by linear interpolation. Lists are interpolated value by value.
const mixed = (from, to, share) => {
  if (share === 1) return to;
  if (Array.isArray(to)) return to.map((value, k) => mixed(from?.[k], value, share));
  return Number.isFinite(from) && Number.isFinite(to) ? Number((from + share * (to - from)).toPrecision(12)) : to;
};
// Asks for the study with the selected percentage of the tuned values. It sends one request at a time. If the percentage has
// changed in the meantime, it sends another request.
let retuning = null;
const retune = () => {
  clearTimeout(pause);
  const own = proposal;
  const follow = async () => {
    while (proposal === own && own.tuned && own.tuned.share !== own.share) {
      const { share } = own;
      const edits = own.edits.map(({ path, value }, k) => ({ path, value: mixed(own.origins[k], value, share) }));
      let overview = null;
      try {
        if (share > 0) overview = await post('edit', { digest: own.digest, edits });
      } catch (refused) {
        say(`The tuned values cannot be applied at ${Math.round(100 * share)} %: ${refused.message}`, 'bad');
      }
      own.tuned = { share, overview, edits };
    }
    retuning = null;
  };
  return retuning ??= follow();
};
// Delay of a request in milliseconds while the slider moves. The delay reduces the number of requests, because the server
// stores the text of each request.
const PAUSE = 150;
let pause = null;
const retuneSoon = () => {
  clearTimeout(pause);
  pause = setTimeout(() => retune().then(preview), PAUSE);
};
const wait = (milliseconds) => new Promise((done) => { setTimeout(done, milliseconds); });

const tune = async () => {
  if (job !== null) return;
  close();
  const base = copy(state.design);
  // A save changes the digest of this overview. Every other change of the study's text replaces the overview.
  const { overview } = state;
  const message = html('p', { text: 'Tuning …' });
  const bar = html('progress', { 'aria-label': 'starts that have begun', max: Math.max(1, state.overview.starts), value: 0 });
  const cancel = html('button', { text: 'Cancel', id: 'cancel', on: { click: () => { cancel.disabled = true; if (job !== null) post('cancel', { job }).catch(() => {}); } } });
  show(html('div', { class: 'heading' }, html('h2', { text: 'Tune' }), cancel), bar, message);
  openTab('proposal', document.activeElement === byId('tune'));
  announce('Tuning');
  byId('tune').disabled = true;
  try {
    let now = await post('tune', { of: of(base), locked: state.locked });
    job = now.job;
    while (!now.done) {
      await wait(120);
      now = await post('progress', { job });
      bar.value = now.starts;
      const { builds } = state.overview;
      const misfit = now.misfit === null ? '' : `, smallest misfit ${brief(now.misfit, 3)}${builds ? ` (root mean square of ${builds} builds)` : ''}`;
      message.textContent = `${now.iterations} iterations${misfit}`;
    }
    if (now.error) throw new Error(now.error);
    const checkText = () => { if (overview !== state.overview) throw new Error('the study was changed or read again in the meantime'); };
    checkText();
    const { edits } = now.proposal;
    const tuned = edits.length ? { share: 1, overview: await post('edit', { digest: overview.digest, edits }), edits } : null;
    checkText();
    propose(base, now.proposal, tuned);
  } catch (refused) {
    show(html('div', { class: 'heading' }, html('h2', { text: 'Tune' }), html('button', { text: 'Close', on: { click: close } })), html('p', { class: 'bad', text: refused.message }));
    announce(`No proposal: ${refused.message}`);
  } finally {
    job = null;
    byId('tune').disabled = !state.overview.tunes;
  }
};

// Selected part of a proposal: the ticked changes, multiplied by the selected percentage.
const taken = (step = proposal.step) => {
  const { base, found, changes, share } = proposal;
  const design = copy(state.design);
  for (const { p, axis, box: tick } of changes) {
    const whole = found[p][axis];
    if (tick.checked) design[p][axis] = rounded(share === 1 ? whole : Number((base[p][axis] + share * (whole - base[p][axis])).toPrecision(12)), step);
  }
  return design;
};
const preview = () => {
  if (!proposal) return;
  const design = taken();
  for (const { p, axis, box: tick, to, by } of proposal.changes) {
    const value = tick.checked ? design[p][axis] : proposal.base[p][axis];
    to.textContent = brief(value, 8);
    by.textContent = signed(value - proposal.base[p][axis]);
  }
  for (const { now, then, to } of proposal.values) {
    const isTaken = proposal.rates.checked;
    to.textContent = !isTaken ? now : proposal.share === 1 || now === '' ? then : brief(mixed(Number(now), Number(then), proposal.share), 6);
  }
  byId('proposal-note').textContent = isSame(proposal.base, state.design) ? '' : 'Points have moved since this proposal was made. “Now” and Apply refer to the earlier design.';
  askProposal(design, digestTaken());
  askExact();
};

// Asks for the misfit of the selected part without rounding. The misfit with rounding minus this misfit is the cost of rounding.
let asked = 0;
const askExact = async () => {
  const number = asked += 1;
  exact = null;
  if (!proposal?.step) return;
  const found = await askMisfit(taken(0), digestTaken());
  if (number !== asked || !proposal) return;
  exact = found;
  tellMisfit();
};
const tellMisfit = () => {
  const value = state.proposed?.misfit?.value;
  const words = byId('proposal-misfit');
  if (!words) return;
  const isKnown = value !== undefined && value !== null;
  const cost = isKnown && exact !== null ? ` (rounding ${value < exact ? 'lowers' : 'raises'} it by ${brief(Math.abs(value - exact), 2)})` : '';
  words.textContent = isKnown ? `${state.overview.builds ? 'nominal misfit' : 'misfit'} with these coordinates: ${brief(value, 4)}${cost}` : '';
};

// Margins of the constraints: of the present design, and of the selected part of the proposal.
const marginsTable = () => {
  const then = state.proposed?.misfit?.constraints ?? [];
  if (!then.length) return [];
  const now = state.answer?.misfit?.constraints ?? [];
  const words = (own) => (own ? `${brief(own.margin, 3)} ${inDegrees(own.unit)}` : '–');
  const rows = then.map((own, k) => html('tr', { class: own.is_violated ? 'violated' : null },
    html('th', { scope: 'row', text: inDegrees(own.is_violated ? `${own.name}, violated` : own.name) }), html('td', { class: 'number', text: words(now[k]) }), html('td', { class: `number ${own.is_violated ? 'bad' : ''}`, text: words(own) })));
  return [scroller('Margins of the constraints', html('table', { id: 'margins' },
    html('thead', {}, html('tr', {}, ...['constraint', 'margin now', 'margin with these coordinates'].map((text, k) => html('th', { text, class: k ? 'number' : null })))), html('tbody', {}, ...rows)))];
};
const tellMargins = () => {
  const place = byId('proposal-margins');
  if (place) renew(place, ...marginsTable());
};

// Changes that no target requests, flagged ones first.
const effectsTable = ({ header, rows, rest }) => [
  ...(rows.length
    ? [scroller('Side effects', html('table', { id: 'side-effects' },
      html('thead', {}, html('tr', {}, ...header.map((text) => html('th', { text })))),
      html('tbody', {}, ...rows.map(({ cells, is_flagged: flagged }) => html('tr', { class: flagged ? 'bad' : null },
        ...cells.map((text, k) => (k ? html('td', { class: /\d/.test(text) ? 'number' : null, text: text.replaceAll(/(^|\s)-(?=\d)/g, '$1−') }) : html('th', { scope: 'row', text: text.replaceAll('_', ' ') }))))))))]
    : []),
  ...rest.map((text) => html('p', { class: 'hint', text })),
];

// Yields of a robust tuning: of the present design, of the optimum without scatter, and of the proposal.
const yieldsTable = (yields) => (yields
  ? [html('p', { text: yields.headline.replace('->', '→') }), scroller('Yields', html('table', { id: 'yields' },
    html('thead', {}, html('tr', {}, ...yields.header.map((text, k) => html('th', { text, class: k ? 'number' : null })))),
    html('tbody', {}, ...yields.rows.map(([band, ...shares]) => html('tr', {}, html('th', { scope: 'row', text: band.replaceAll('_', ' ').replaceAll(/(^|\s)-(?=\d)/g, '$1−') }), ...shares.map((text) => html('td', { class: 'number', text })))))))]
  : []);

const propose = (base, { design, rates: changed, headline, side_effects: effects, yields, remarks, interrupted, edits, origins }, tuned) => {
  const changes = [];
  design.forEach((point, p) => point.forEach((c, axis) => { if (c !== base[p][axis]) changes.push({ p, axis }); }));
  const { points, unit } = state.overview;
  const [usual] = ROUNDINGS[unit];
  const rates = html('input', { type: 'checkbox', id: 'take-rates', 'aria-label': 'take the tuned rates', on: { change: preview } });
  rates.checked = true;
  const values = changed.map(([name, now, then]) => ({ name, now, then, to: html('td', { class: 'number' }) }));
  proposal = { base, found: design, changes, share: 1, step: usual, digest: state.overview.digest, tuned, edits, origins, rates, values };
  const rows = changes.map((change) => {
    const { p, axis } = change;
    const label = `${points[p].name} ${AXES[axis]}`;
    change.box = html('input', { type: 'checkbox', 'aria-label': `take ${label}`, on: { change: preview } });
    change.box.checked = true;
    return html('tr', {}, html('td', {}, change.box), html('th', { scope: 'row', text: label }), html('td', { class: 'number', text: brief(base[p][axis], 6) }),
      (change.to = html('td', { class: 'number' })), (change.by = html('td', { class: 'number' })));
  });
  const amount = html('output', { text: '100 %', 'aria-live': 'off' });
  const share = html('input', {
    type: 'range', min: 0, max: 100, value: 100, id: 'share', 'aria-label': 'Apply, percent',
    on: { input: () => { proposal.share = Number(share.value) / 100; amount.textContent = `${share.value} %`; preview(); retuneSoon(); } },
  });
  const rounding = html('select', { id: 'rounding', on: { change: () => { proposal.step = Number(rounding.value); preview(); } } },
    ...ROUNDINGS[unit].map((value) => html('option', { value, text: value ? `${value} ${unit}` : 'no rounding' })));
  const accept = html('button', { id: 'accept', class: 'strong', text: 'Accept', on: { click: acceptProposal } });
  accept.disabled = changes.length === 0 && !tuned;
  const reject = html('button', { id: 'reject', text: 'Reject', on: { click: close } });
  const result = html('span', { id: 'proposal-misfit' });
  show(
    html('div', { class: 'heading' }, html('h2', { text: interrupted ? 'Proposal, cancelled before its end' : 'Proposal' }), html('p', { text: `Full proposal: ${headline.replace('->', '→')}` }), result, html('span', { class: 'group' }, accept, reject)),
    html('p', { id: 'proposal-note', class: 'hint' }),
    html('label', { class: 'direction' }, html('span', { text: 'Apply' }), share, amount),
    html('label', { class: 'direction' }, html('span', { text: 'Round coordinates to' }), rounding),
    changes.length
      ? scroller('Coordinates of the proposal', html('table', {}, html('thead', {}, html('tr', {}, ...['take', 'coordinate', `now [${unit}]`, 'tuned', 'by'].map((text, k) => html('th', { text, class: k > 1 ? 'number' : null })))), html('tbody', {}, ...rows)))
      : html('p', { text: 'Nothing moves.' }),
    ...(tuned ? [scroller('Tuned values', html('table', { id: 'rates' },
      html('thead', {}, html('tr', {}, html('td', {}, rates), ...[state.overview.is_car ? 'value' : 'elastic part', 'now', 'tuned'].map((text, k) => html('th', { text, class: k ? 'number' : null })))),
      html('tbody', {}, ...values.map(({ name, now, to }) => html('tr', {}, html('td'), html('th', { scope: 'row', text: name.replaceAll('_', ' ') }), html('td', { class: 'number', text: now }), to)))))] : []),
    html('div', { id: 'proposal-margins' }),
    html('h3', { text: 'Results of the full proposal' }),
    ...effectsTable(effects),
    ...yieldsTable(yields),
    ...remarks.map((text) => html('p', { class: 'hint', text })),
  );
  preview();
  tellTab('proposal', '•');
  announce(`Proposal: ${headline.replace('->', 'to')}`);
};

export const startTuning = () => {
  byId('tune').addEventListener('click', tune);
  const allow = () => {
    close();
    // The result of a running tuning would belong to the former study.
    if (job !== null) post('cancel', { job }).catch(() => {});
    const { tunes } = state.overview;
    byId('tune').disabled = !tunes || job !== null;
    byId('tune').title = tunes ? 'Lower the misfit with the variables of the study' : state.overview.is_car ? 'The study has no [optimise] section' : 'The study has no targets yet: add one on a chart';
  };
  on('study', allow);
  on('motion', () => { state.proposed = null; preview(); });
  on('edited', () => {
    if (proposal) say('The proposal is closed: it belongs to the values before this change. Press Tune for a new one.', 'ask');
    allow();
  });
  on('deed', preview);
  on('chosen', preview);
  on('place', preview);
  on('proposed', tellMisfit);
  for (const event of ['proposed', 'answer']) on(event, tellMargins);
};
