// Directions of the views, and circles in space.
import { along, cross, norm } from './draw.js';
import { state } from './design.js';

// Corners of a circle as it is drawn.
const ROUND = 64;

// Directions of the car in the study's axes. A product of the signs below zero is a right-hand wheel.
export const directions = () => {
  const [forward, outboard, up] = state.overview.scene.signs;
  const left = forward * outboard * up > 0;
  const carLeft = left ? outboard : -outboard;
  return { left, forward: [forward, 0, 0], outboard: [0, outboard, 0], carLeft: [0, carLeft, 0], up: [0, 0, up] };
};
export const negative = (v) => v.map((c) => -c);

export const flat = {
  front: () => { const d = directions(); return { right: d.carLeft, up: d.up }; },
  side: () => { const d = directions(); return { right: d.left ? negative(d.forward) : d.forward, up: d.up }; },
  top: () => { const d = directions(); return { right: negative(d.carLeft), up: d.forward }; },
};
// The eye goes round the car: `turn` from the front towards outboard, `lift` above the ground.
export const inSpace = ({ turn, lift }) => {
  const d = directions();
  const level = along([0, 0, 0].map((_, k) => d.forward[k] * Math.cos(turn)), d.outboard, Math.sin(turn));
  const eye = level.map((c, k) => c * Math.cos(lift) + d.up[k] * Math.sin(lift));
  const behind = negative(eye);
  // In a left-handed mirror image the picture is mirrored too, as the car is.
  const right = cross(behind, d.up);
  const length = norm(right);
  const unit = right.map((c) => c / length);
  return { right: unit, up: cross(unit, behind) };
};

// The wheel's rim: a circle about its centre, normal to the spin axis.
export const rim = (at, { wheel_centre: centre, wheel_radius: radius }) => {
  if (!radius || !at) return [];
  const { points, spin_axis: n } = at;
  const reference = Math.abs(n[2]) < 0.9 ? [0, 0, 1] : [1, 0, 0];
  const first = cross(n, reference);
  const unit = first.map((c) => c / norm(first));
  const second = cross(n, unit);
  return Array.from({ length: ROUND }, (_, i) => {
    const angle = (2 * Math.PI * i) / ROUND;
    return along(along(points[centre], unit, radius * Math.cos(angle)), second, radius * Math.sin(angle));
  });
};
