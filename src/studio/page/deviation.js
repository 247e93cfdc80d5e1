// A strip under a chart: the deviation of the curve from its target, as a multiple of the tolerance.
import { refill } from './draw.js';
import { endsOf } from './runs.js';

const HALF = 11;
const MOST = 2;

// Deviation of a value from a target value or a band, divided by the tolerance. 0 inside a band.
const deviation = (value, low, high, tolerance) => {
  if (low !== null && value < low) return (value - low) / tolerance;
  if (high !== null && value > high) return (value - high) / tolerance;
  return 0;
};
const within = (value) => Math.max(-MOST, Math.min(MOST, value));

export class Deviation {
  constructor(layer) {
    this.layer = layer;
  }

  draw(targets, lines, { x, base, at }) {
    if (!targets.length) {
      refill(this.layer, []);
      return;
    }
    const scale = HALF / MOST;
    const ends = targets.flatMap(({ points }) => points.map(([place]) => x(place)));
    const [low, high] = endsOf(ends);
    const [left, right] = [low - 3, high + 3];
    const drawn = [['title', { text: `deviation as a multiple of the tolerance; the strip ends at ±${MOST}, the band shows ±1` }],
      ['rect', { x: left.toFixed(1), y: (base - scale).toFixed(1), width: (right - left).toFixed(1), height: (2 * scale).toFixed(1) }],
      ['path', { class: null, d: `M${left.toFixed(1)} ${base}H${right.toFixed(1)}`, 'stroke-opacity': 0.8 }]];
    for (const { points, tolerance, columns } of targets) {
      for (const { found, pieces } of lines) {
        if (!columns.includes(found.column)) continue;
        const steps = points.flatMap(([place, low, high]) => {
          const value = at(pieces, place);
          return value === null ? [] : [[x(place), deviation(value, low, high, tolerance)]];
        });
        if (!steps.length) continue;
        const isOver = steps.some(([, by]) => Math.abs(by) > 1);
        const places = steps.map(([a, by]) => `${a.toFixed(1)} ${(base - scale * within(by)).toFixed(1)}`);
        const d = places.length > 1 ? `M${places.join('L')}` : `M${(steps[0][0] - 3).toFixed(1)} ${(base - scale * within(steps[0][1])).toFixed(1)}h6`;
        drawn.push(['path', { class: isOver ? 'over' : null, d, 'stroke-opacity': null }]);
      }
    }
    refill(this.layer, drawn);
  }
}
