// The design being worked on: coordinates, what is locked, what was done. Everything else follows it.
import { post } from './server.js';

export const state = {
  overview: null,
  // Coordinates in the study's axes, by point.
  design: [],
  // Those of the file.
  opened: [],
  locked: [],
  // A value for each slider.
  at: [],
  // Number of the slider that curves are drawn over, and of the one whose values each have a line.
  over: 0,
  family: null,
  step: 0.1,
  coupled: true,
  curvesAtRack: false,
  chosen: [],
  // What is said of the design, of the file's design, and of a proposal.
  answer: null,
  ghost: null,
  proposed: null,
  fault: null,
  selected: null,
  // Which target the arrows are for; null for the misfit.
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
export const isMoved = () => !isSame(state.design, state.opened);

// A coordinate on the grid of the step; without the digits that arithmetic adds.
export const snapped = (value, step = state.step) => {
  const decimals = Math.max(0, Math.ceil(-Math.log10(step) - 1e-9));
  return Number((Math.round(value / step) * step).toFixed(Math.min(decimals, 12)));
};

// Undo and redo. A gesture (a drag, keys in a row) is one deed.
const done = [];
let undone = [];
let gesture = null;
export const canUndo = () => done.length > 0;
export const canRedo = () => undone.length > 0;
export const begin = (name) => {
  gesture = { name, before: copy(state.design) };
};
export const finish = () => {
  if (gesture && !isSame(gesture.before, state.design)) {
    done.push(gesture.before);
    if (done.length > 500) done.shift();
    undone = [];
  }
  gesture = null;
  emit('deed');
};
export const isInGesture = () => gesture !== null;
const restore = (from, to) => {
  const design = from.pop();
  if (!design) return;
  to.push(copy(state.design));
  state.design = design;
  emit('design');
  emit('deed');
};
export const undo = () => restore(done, undone);
export const redo = () => restore(undone, done);
export const forget = () => {
  done.length = 0;
  undone = [];
};

// Puts coordinates in one deed.
export const put = (design, name) => {
  begin(name);
  state.design = copy(design);
  emit('design');
  finish();
};

// The other coordinates that move with one, each with its factor.
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

// Coordinates a move starts from.
export const grip = () => copy(state.design);

// Moves a point from where a gesture began; what is locked stays, what is coupled follows.
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

// One coordinate, as a deed of its own.
export const setCoordinate = (point, axis, value) => {
  begin('coordinate');
  const target = [undefined, undefined, undefined];
  target[axis] = value;
  moveTo(grip(), point, target);
  finish();
};

// The place on the number that curves are drawn over.
export const here = () => state.at[state.over];

export const of = (design = state.design) => ({ digest: state.overview.digest, design });
const request = (design) => ({
  of: of(design),
  characteristics: state.chosen,
  at: state.at,
  curves_rack: state.curvesAtRack ? state.at.at(-1) : null,
  over: state.over,
});

// Asks for the latest design, one request at a time: what was wanted in between is never computed, and an
// answer to an older text of the study is dropped.
let wanted = 0;
let answered = 0;
let busy = false;
let cause = null;
export const ask = (event) => {
  wanted += 1;
  cause ??= event?.timeStamp ?? null;
  if (!busy) run();
};
export const isSettled = () => !busy && answered === wanted;
const run = async () => {
  busy = true;
  while (answered < wanted) {
    const number = wanted;
    const since = cause;
    cause = null;
    const { digest } = state.overview;
    try {
      const answer = await post('solve', request());
      if (digest === state.overview.digest) {
        state.answer = answer;
        state.fault = null;
        emit('answer', since);
      }
    } catch (refused) {
      if (refused.status === 0 || refused.status === 403) {
        emit('unanswered');
        break;
      }
      state.fault = refused.message;
      emit('answer', since);
    }
    answered = number;
  }
  busy = false;
};

// The same for the design as it was opened, and for a proposal: for curves to compare with.
export const askGhost = async () => {
  const { digest } = state.overview;
  const ghost = await post('solve', request(state.opened)).catch(() => null);
  if (digest !== state.overview.digest) return;
  state.ghost = ghost;
  emit('ghost');
};
let proposals = 0;
export const askProposal = async (design) => {
  const number = ++proposals;
  const answer = design ? await post('solve', request(design)).catch(() => null) : null;
  if (number !== proposals) return;
  state.proposed = answer;
  emit('proposed');
};

// What one coordinate does, asked for when somebody points at it.
let influences = 0;
export const askInfluence = async (point, axis) => {
  const number = ++influences;
  if (point === null) {
    state.influence = null;
    emit('influence');
    return;
  }
  const found = await post('influence', { of: of(), characteristics: state.chosen, point, axis }).catch(() => null);
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
