// The design in progress: coordinates, locked coordinates, and history. All other parts of the page show this state.
import { signed } from './draw.js';
import { post, restoreTexts } from './server.js';

export const state = {
  overview: null,
  // The overview of the file, as opened or last saved.
  file: null,
  // Coordinates in the study's axes, by point.
  design: [],
  // Coordinates of the file.
  opened: [],
  locked: [],
  // Name of the motion whose curves are shown; null for the study's own motion.
  motion: null,
  // A value for each slider.
  at: [],
  // Index of the slider whose coordinate is on the horizontal axis, and index of the slider with one line per value.
  over: 0,
  family: null,
  step: 0.1,
  coupled: true,
  curvesAtRack: false,
  chosen: [],
  // Answer for the design. `ghost` is the answer for the design of the file, `proposed` the answer for a proposal.
  answer: null,
  // The last answer with all stations. While a point moves, an answer has only the stations of the shown curves.
  whole: null,
  // Coordinates to which the answer belongs. `isLate` is true while the answer for later coordinates is late.
  answered: null,
  isLate: false,
  ghost: null,
  proposed: null,
  fault: null,
  // Designs that are kept beside the present one, by letter.
  pins: {},
  selected: null,
  // Index of the target whose arrows are shown; null for the misfit, and 'none' for no arrows.
  arrows: null,
  influence: null,
};

const listeners = {};
export const on = (event, listener) => (listeners[event] ??= []).push(listener);
export const emit = (event, detail) => {
  for (const listener of listeners[event] ?? []) listener(detail);
};

export const copy = (design) => design.map((point) => [...point]);
export const isSame = (a, b) => a.length === b.length && a.every((p, i) => p.every((c, k) => c === b[i][k]));
// Coordinate after an offset. Offsets in a study are relative to the coordinates in the file.
export const placeAfter = (point, axis, by) => state.opened[point][axis] + by;
export const isMoved = () => !isSame(state.design, state.opened);

// Rounds a coordinate to a multiple of the step, without digits from rounding errors.
export const snapped = (value, step = state.step) => {
  const decimals = Math.max(0, Math.ceil(-Math.log10(step) - 1e-9));
  return Number((Math.round(value / step) * step).toFixed(Math.min(decimals, 12)));
};

// Moves a coordinate by exactly one step, without digits from rounding errors.
export const stepped = (value, by) => Number((value + by).toPrecision(14));

// Writes the sliders of the chosen motion into an overview. If the study has no such motion, the study's own motion is chosen.
export const takeMotion = (overview) => {
  // The first entry is the study's own motion.
  if (overview.motions[0]?.name !== null) overview.motions.unshift({ name: null, sliders: overview.sliders, main: overview.main });
  const { name, sliders, main } = overview.motions.find((motion) => motion.name === state.motion) ?? overview.motions[0];
  state.motion = name;
  Object.assign(overview, { sliders, main });
  if (state.at.length !== sliders.length) state.at = sliders.map(({ home }) => home);
};

// History: every state that undo and redo can reach, with the action before it. A gesture, such as a drag or a sequence of keys,
// is one action.
let timeline = [];
let present = 0;
let gesture = null;
// Longest time in milliseconds between two key presses on one point that count as one action.
const SOON = 1500;
let keys = null;
export const history = () => ({ timeline, present });
export const canUndo = () => present > 0;
export const canRedo = () => present < timeline.length - 1;

const DEEDS = { drag: 'Drag', key: 'Keys', coordinate: 'Typed', back: 'Back to the file', tune: 'Accepted proposal', draft: 'Restored', kept: 'Kept changes', direction: 'Free direction', pin: 'Pinned design' };
export const described = (name, before) => {
  const moved = state.overview.points.flatMap((point, p) => (before[p].every((c, k) => c === state.design[p][k]) ? [] : [p]));
  const deed = DEEDS[name] ?? name;
  if (moved.length !== 1) return `${deed}: ${moved.length} points`;
  const [p] = moved;
  const changes = before[p].flatMap((c, k) => (c === state.design[p][k] ? [] : [`${'xyz'[k]} ${signed(state.design[p][k] - c)}`]));
  return `${deed}: ${state.overview.points[p].name.replaceAll('_', ' ')} ${changes.join(', ')}`;
};
export const remember = (label) => {
  timeline.splice(present + 1);
  timeline.push({ label, design: copy(state.design), overview: state.overview });
  if (timeline.length > 500) timeline.shift();
  present = timeline.length - 1;
};
export const begin = (name, point = null) => {
  gesture = { name, point, before: copy(state.design) };
};
const rememberKeys = ({ name, point, before }) => {
  const now = performance.now();
  const goesOn = keys?.entry === timeline[present] && keys.point === point && now - keys.time < SOON;
  if (!goesOn) {
    remember(described(name, before));
    keys = { entry: timeline[present], point, before };
  } else if (isSame(keys.before, state.design)) {
    timeline.splice(present);
    present -= 1;
    keys = null;
    return;
  } else Object.assign(keys.entry, { label: described(name, keys.before), design: copy(state.design) });
  keys.time = now;
};
export const finish = () => {
  if (gesture && !isSame(gesture.before, state.design)) {
    if (gesture.name === 'key') rememberKeys(gesture);
    else remember(described(gesture.name, gesture.before));
  }
  gesture = null;
  emit('deed');
};
export const isInGesture = () => gesture !== null;
// Restores a state of the history.
export const travel = (to) => {
  const found = timeline[to];
  if (!found || to === present) return;
  present = to;
  state.design = copy(found.design);
  if (found.overview.digest !== state.overview.digest) {
    state.overview = { ...found.overview, base: state.overview.base };
    found.overview = state.overview;
    takeMotion(state.overview);
    emit('edited');
  }
  emit('design');
  emit('deed');
};
export const undo = () => travel(present - 1);
export const redo = () => travel(present + 1);
export const forget = () => {
  timeline = [{ label: 'As opened', design: copy(state.design), overview: state.overview }];
  present = 0;
};
// Restores a history that the browser has stored.
export const resume = (deeds, at) => {
  timeline = deeds;
  present = at;
  state.design = copy(timeline[at].design);
  state.overview = timeline[at].overview;
  takeMotion(state.overview);
};
// Records that the file contains the text of this overview. In every overview, `edits` change the text with the digest `from`
// to the text of the overview.
export const isOfFile = (overview) => {
  overview.from = overview.digest;
  overview.edits = [];
  state.file = overview;
};
// Accepts an edited study as one action. `overview` describes the study after `edits`. Without `design`, the design stays. The
// label is a text, or a function of the former design. The file keeps the text that it has: after a save and an undo, the server
// edits an earlier text.
export const takeOverview = (overview, label, edits, design = null) => {
  const before = state.design;
  if (design) state.design = copy(design);
  overview.from = state.overview.from;
  overview.base = state.overview.base;
  overview.edits = [...state.overview.edits, ...edits];
  takeMotion(overview);
  state.overview = overview;
  remember(typeof label === 'function' ? label(before) : label);
  emit('edited');
  emit('design');
  emit('deed');
};
// The server stores only the latest texts. To restore a text, it reads the file again and receives the edits of the text.
restoreTexts(async (digest, ask) => {
  const overviews = [state.overview, state.file, ...timeline.map(({ overview }) => overview)];
  const { from, edits } = overviews.find((own) => own?.digest === digest);
  await ask('study', null);
  if (edits.length) await ask('edit', { digest: from, edits });
});
// True if the study's text was changed, apart from coordinates.
export const isEdited = () => state.overview.digest !== state.overview.base;

// Sets all coordinates as one action.
export const put = (design, name) => {
  begin(name);
  state.design = copy(design);
  emit('design');
  finish();
};

// Other coordinates that move with this coordinate, each with its factor.
const companions = (point, axis) => {
  if (!state.coupled) return [];
  for (const { moves } of state.overview.variables) {
    const own = moves.find(([p, a]) => p === point && a === axis);
    if (own && moves.length > 1) {
      return moves.filter((move) => move !== own).map(([p, a, factor]) => [p, a, factor / own[2]]);
    }
  }
  return [];
};

// Coordinates from which a move starts.
export const grip = () => copy(state.design);

// Moves a point from its position at the start of a gesture. Locked coordinates stay, coupled coordinates follow.
export const moveTo = (start, point, target) => {
  const design = copy(state.design);
  for (let axis = 0; axis < 3; axis += 1) {
    if (target[axis] === undefined || state.locked[point][axis]) continue;
    const by = target[axis] - start[point][axis];
    design[point][axis] = target[axis];
    for (const [p, a, factor] of companions(point, axis)) {
      if (!state.locked[p][a]) design[p][a] = by === 0 ? start[p][a] : snapped(start[p][a] + by * factor, Math.min(state.step, 1e-6));
    }
  }
  if (isSame(design, state.design)) return;
  state.design = design;
  emit('design');
};

// Sets one coordinate as one action.
export const setCoordinate = (point, axis, value) => {
  begin('coordinate');
  const target = [undefined, undefined, undefined];
  target[axis] = value;
  moveTo(grip(), point, target);
  finish();
};

// Present value on the horizontal axis of the curves.
export const here = () => state.at[state.over];

export const of = (design = state.design, digest = state.overview.digest) => ({ digest, design });
// Rack displacement at which the user holds the curves; null for the displacements of the study.
const curvesRack = () => (state.curvesAtRack && !state.overview.is_car ? state.at.at(-1) : null);
const request = (design, digest) => ({
  of: of(design, digest),
  characteristics: state.chosen,
  at: state.at,
  curves_rack: curvesRack(),
  over: state.over,
  motion: state.motion,
});

// Asks for the latest design, one request at a time. Designs in between are never computed. An answer to an older text of the
// study is dropped. If a request takes longer than `patience` milliseconds and there is a later design, the page drops the
// request, and the server stops its search. `patience` is MULTIPLE times the duration of the last answer, within the limits
// PATIENCE.
const PATIENCE = [150, 1000];
const MULTIPLE = 3;
let patience = PATIENCE[0];
const [page] = crypto.getRandomValues(new Uint32Array(1));
let wanted = 0;
let answered = 0;
let running = null;
let cause = null;
export const ask = (event) => {
  wanted += 1;
  cause ??= event?.timeStamp ?? null;
  if (!running || running.isSlow || running.isRest) run();
};
// Pause in milliseconds after which the page asks for an answer that contains the curves for all values of the sliders.
const PAUSE = 60;
const isPartial = () => Boolean(state.answer?.is_partial) && !state.fault;
export const isSettled = () => !running && answered === wanted && !isPartial();
const askRest = () => setTimeout(() => { if (!running && answered === wanted && isPartial()) ask(); }, PAUSE);
// Pinned designs and the effect of a coordinate need all stations.
const isEnough = (own) => own.since !== null && !state.influence && !Object.keys(state.pins).length;
// Draws after an action. If an answer is expected, nothing is drawn now, because the arrival of the answer causes the same
// drawing.
export const onRest = (draw) => on('deed', () => { if (isSettled()) draw(); });
const tellLate = (isLate) => {
  if (state.isLate === isLate) return;
  state.isLate = isLate;
  emit('late');
};
const becomeSlow = (own) => {
  if (running !== own) return;
  own.isSlow = true;
  if (own.number < wanted) run();
  tellLate(true);
};
const run = async () => {
  const own = { number: wanted, since: running?.since ?? cause, isSlow: false };
  // The request after a partial answer stops if the user moves a point again.
  own.isRest = own.since === null && isPartial();
  running = own;
  cause = null;
  const { design, over, motion } = state;
  const { digest } = state.overview;
  const begun = performance.now();
  setTimeout(() => becomeSlow(own), patience);
  let answer = null;
  let fault = null;
  try {
    answer = await post('solve', { ...request(), shown_only: isEnough(own), turn: [page, own.number] });
  } catch (refused) {
    fault = refused;
  }
  // A later request has replaced this request.
  if (running !== own) return;
  running = null;
  state.isLate = false;
  // The time of a failed search does not predict the time of other searches.
  if (answer && !answer.failures.length) patience = Math.min(PATIENCE[1], Math.max(PATIENCE[0], MULTIPLE * (performance.now() - begun)));
  if (fault?.status === 0 || fault?.status === 403) {
    emit('unanswered');
    return;
  }
  answered = own.number;
  if (fault) state.fault = fault.message;
  else if (digest === state.overview.digest && motion === state.motion) {
    Object.assign(state, { answer, fault: null, answered: design });
    if (answer.is_partial) askRest();
    else state.whole = { answer, digest, over };
  }
  // The next request is sent first, so that the server works while the page draws.
  const isOfText = fault || (digest === state.overview.digest && motion === state.motion);
  if (answered < wanted) run();
  if (isOfText) emit('answer', own.since);
};

// Asks for the design and the values of the file, for comparison. It sends one request at a time.
let isGhostAsked = false;
let isGhostWanted = false;
export const askGhost = async () => {
  isGhostWanted = true;
  if (isGhostAsked) return;
  isGhostAsked = true;
  while (isGhostWanted) {
    isGhostWanted = false;
    const { motion, file } = state;
    const isKnown = (name) => file.characteristics.some((own) => own.name === name && own.available);
    const asked = { ...request(state.opened, file.digest), characteristics: state.chosen.filter(isKnown) };
    const ghost = await post('solve', asked).catch(() => null);
    if (file === state.file && motion === state.motion) {
      state.ghost = ghost;
      emit('ghost');
    }
  }
  isGhostAsked = false;
};
// Asks for the answers of pinned designs, with the same request as for the present design. It sends one request at a time, so an
// answer for earlier positions of the sliders cannot replace a later one.
let arePinsAsked = false;
let arePinsWanted = false;
export const askPins = async () => {
  arePinsWanted = true;
  if (arePinsAsked) return;
  arePinsAsked = true;
  while (arePinsWanted) {
    arePinsWanted = false;
    for (const pin of Object.values(state.pins)) pin.answer = await post('solve', request(pin.design)).catch(() => null);
    emit('pins');
  }
  arePinsAsked = false;
};
// Shows the curves over another motion. Positions of sliders begin at the design position.
export const chooseMotion = (name) => {
  state.motion = name;
  takeMotion(state.overview);
  const { sliders, main } = state.overview;
  Object.assign(state, { at: sliders.map(({ home }) => home), over: main, family: null, ghost: null, whole: null, influence: null });
  emit('motion');
  ask();
  askGhost();
  if (Object.keys(state.pins).length) askPins();
};
let proposals = 0;
export const askProposal = async (design, digest) => {
  const number = ++proposals;
  const answer = design ? await post('solve', request(design, digest)).catch(() => null) : null;
  if (number !== proposals) return;
  state.proposed = answer;
  emit('proposed');
};

// The misfit of a design; null if the design has no misfit.
export const askMisfit = async (design, digest) => {
  const answer = await post('solve', request(design, digest)).catch(() => null);
  return answer?.misfit?.value ?? null;
};

// Effect of one coordinate, requested when the user points at the coordinate.
let influences = 0;
export const askInfluence = async (point, axis) => {
  const number = ++influences;
  if (point === null) {
    state.influence = null;
    emit('influence');
    return;
  }
  const found = await post('influence', { of: of(), characteristics: state.chosen, point, axis, motion: state.motion, curves_rack: curvesRack() }).catch(() => null);
  if (number !== influences) return;
  state.influence = found && { point, axis, columns: new Map(found.columns.map((c) => [c.column, c.slopes])) };
  emit('influence');
};

// The gradient that the arrows show: of the misfit or of one target, by point.
export const gradient = () => {
  const misfit = state.answer?.misfit;
  if (!misfit || misfit.value === null || state.arrows === 'none') return null;
  const found = state.arrows === null ? misfit : misfit.targets[state.arrows];
  return found?.gradient.map((g, p) => g.map((c, k) => (state.locked[p][k] ? 0 : c))) ?? null;
};
