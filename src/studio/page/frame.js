// The range of a chart's vertical axis.
import { endsOf } from './runs.js';

// Time in milliseconds after which a too wide axis shrinks during a drag.
const REST = 300;
// Largest ratio of the axis range to the curves' range, and of the curves' range to the range of most values.
const TOO_WIDE = 1.5;
const FAR_OUT = 4;

const span = ([low, high]) => high - low;

// Range of most values. With it, a bad pose at one station does not flatten the rest of the curve.
const robust = (values) => {
  const all = endsOf(values);
  if (values.length < 8) return all;
  const sorted = [...values].sort((a, b) => a - b);
  const at = (part) => sorted[Math.round(part * (sorted.length - 1))];
  const most = [at(0.05), at(0.95)];
  if (span(all) <= FAR_OUT * span(most)) return all;
  const by = 0.5 * span(most);
  return [Math.max(all[0], most[0] - by), Math.min(all[1], most[1] + by)];
};

// At rest, the axis contains all values. During a drag, the axis leaves out outliers. It grows at once and shrinks only after a
// pause, so that the curves move but the axis does not.
export const framed = (chart, still, moving, isInGesture) => {
  const own = isInGesture ? robust(moving) : endsOf(moving);
  const fixed = endsOf(still);
  let [low, high] = [Math.min(own[0], fixed[0]), Math.max(own[1], fixed[1])];
  if (!Number.isFinite(low)) [low, high] = [-1, 1];
  const least = Math.max(1e-9, 1e-6 * Math.max(Math.abs(low), Math.abs(high)));
  if (high - low < least) [low, high] = [low - Math.max(least, 0.05 * Math.abs(low), 0.05), high + Math.max(least, 0.05 * Math.abs(high), 0.05)];
  const room = 0.07 * (high - low);
  const wanted = [low - room, high + room];
  if (!isInGesture || !chart.ys) {
    chart.wideSince = null;
    return wanted;
  }
  // An axis that already contains all values does not grow.
  const fits = low >= chart.ys[0] && high <= chart.ys[1];
  const grown = fits ? chart.ys : [Math.min(chart.ys[0], wanted[0]), Math.max(chart.ys[1], wanted[1])];
  if (span(grown) <= TOO_WIDE * span(wanted)) {
    chart.wideSince = null;
    return grown;
  }
  const now = performance.now();
  if (chart.wideSince === null || chart.wideSince === undefined) {
    chart.wideSince = now;
    setTimeout(() => chart.draw(), REST + 10);
  }
  if (now - chart.wideSince < REST) return grown;
  chart.wideSince = null;
  return wanted;
};
