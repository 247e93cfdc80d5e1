// Curves of an answer: ordered stations, pieces without gaps, lines for the other values of a slider, and values between
// stations.
import { state } from './design.js';

// Data that all charts of an answer share, computed once: stations of each group in increasing order, range of their positions, and
// curves of each column. The stations of a group differ only in the value on the horizontal axis.
const known = new WeakMap();
export const knownOf = (answer) => {
  if (known.has(answer)) return known.get(answer);
  const order = new Map();
  answer.groups.forEach((group, i) => {
    if (!order.has(group)) order.set(group, []);
    if (answer.drive[i] !== null) order.get(group).push(i);
  });
  // If the motion is a table of rows, curves connect the stations in the order of the rows.
  if (!answer.has_rows) for (const places of order.values()) places.sort((a, b) => answer.drive[a] - answer.drive[b]);
  const own = { order, ends: endsOf(answer.drive.filter((x) => x !== null)), columns: new Map(answer.columns.map((c) => [c.column, c])), curves: new Map() };
  known.set(answer, own);
  return own;
};
// The curve of a column in a group.
export const curveOf = (answer, column, group) => {
  const { curves, columns } = knownOf(answer);
  const key = `${group} ${column}`;
  if (!curves.has(key)) curves.set(key, runs(answer, columns.get(column).values, group));
  return curves.get(key);
};
// Splits the stations of one group into runs without gaps, in the order of their positions.
export const runs = (answer, values, group) => {
  const places = knownOf(answer).order.get(group) ?? [];
  const found = [];
  let run = [];
  for (const i of places) {
    if (values[i] === null) {
      if (run.length) found.push(run);
      run = [];
    } else run.push([answer.drive[i], values[i]]);
  }
  if (run.length) found.push(run);
  return found;
};
const groupsOf = (answer) => [...knownOf(answer).order.keys()];

// Groups of stations that have the same slider values as the shown group, except for the slider that has one line per value.
export const familyOf = (answer, shown) => {
  const { family, over } = state;
  if (family === null || !answer?.group_places.length) return [];
  const own = answer.group_places[shown];
  const isOfFamily = (place) => place.every((v, k) => k === over || k === family || v === own[k]);
  const found = groupsOf(answer).filter((g) => g !== shown && isOfFamily(answer.group_places[g]));
  return found.sort((a, b) => answer.group_places[a][family] - answer.group_places[b][family]);
};
// Answer that also has the curves for the other values of a slider. While a point moves, this is an earlier answer, and the
// page draws these curves as stale.
export const wholeOf = (answer) => {
  if (!answer.is_partial) return answer;
  const { whole, over, overview } = state;
  return whole?.digest === overview.digest && whole.over === over ? whole.answer : null;
};

// Value of a curve at a position, interpolated linearly between stations.
export const at = (pieces, x) => {
  for (const piece of pieces) {
    for (let i = 1; i < piece.length; i += 1) {
      const [[x0, y0], [x1, y1]] = [piece[i - 1], piece[i]];
      if ((x - x0) * (x - x1) <= 0) return x1 === x0 ? y0 : y0 + ((y1 - y0) * (x - x0)) / (x1 - x0);
    }
    if (piece.length === 1 && piece[0][0] === x) return piece[0][1];
  }
  return null;
};
export const heights = (pieces) => pieces.flat().map(([, y]) => y);
export const endsOf = (values) => {
  let [low, high] = [Infinity, -Infinity];
  for (const value of values) {
    if (value < low) low = value;
    if (value > high) high = value;
  }
  return [low, high];
};
