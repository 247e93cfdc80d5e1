// Directions of the views, and circles in space.
import { along, cross, norm } from './draw.js';

// Number of corners of the polygon that represents a circle.
const ROUND = 64;

// Directions of the car in the study's axes. A positive product of the signs means a left wheel, a negative product a right
// wheel.
export const directions = ({ signs: [forward, outboard, up] }) => {
  const left = forward * outboard * up > 0;
  const carLeft = left ? outboard : -outboard;
  return { left, forward: [forward, 0, 0], outboard: [0, outboard, 0], carLeft: [0, carLeft, 0], up: [0, 0, up] };
};
export const negative = (v) => v.map((c) => -c);

export const flat = {
  front: (scene) => { const d = directions(scene); return { right: d.carLeft, up: d.up }; },
  side: (scene) => { const d = directions(scene); return { right: d.left ? negative(d.forward) : d.forward, up: d.up }; },
  top: (scene) => { const d = directions(scene); return { right: negative(d.carLeft), up: d.forward }; },
};
// View direction around the car: angle `turn` from the front towards outboard, angle `lift` above the ground.
export const inSpace = (scene, { turn, lift }) => {
  const d = directions(scene);
  const level = along([0, 0, 0].map((_, k) => d.forward[k] * Math.cos(turn)), d.outboard, Math.sin(turn));
  const eye = level.map((c, k) => c * Math.cos(lift) + d.up[k] * Math.sin(lift));
  const behind = negative(eye);
  // In left-handed axes the picture is mirrored, like the car.
  const right = cross(behind, d.up);
  const length = norm(right);
  const unit = right.map((c) => c / length);
  return { right: unit, up: cross(unit, behind) };
};

// A circle about a centre, normal to a direction.
export const circle = (centre, normal, radius) => {
  const reference = Math.abs(normal[2]) < 0.9 ? [0, 0, 1] : [1, 0, 0];
  const first = cross(normal, reference);
  const unit = first.map((c) => c / norm(first));
  const second = cross(normal, unit);
  return Array.from({ length: ROUND }, (_, i) => {
    const angle = (2 * Math.PI * i) / ROUND;
    return along(along(centre, unit, radius * Math.cos(angle)), second, radius * Math.sin(angle));
  });
};
// The wheel's rim: a circle about its centre, normal to the spin axis.
export const rim = (at, { wheel_centre: centre, wheel_radius: radius }) => (radius && at ? circle(at.points[centre], at.spin_axis, radius) : []);
// Rims of the wheels on one side: one rim, or for a car the rims of both axles.
export const rims = (at, scene) => (at?.spin_axes ? scene.wheels.map(({ centre, radius }, k) => circle(at.points[centre], at.spin_axes[k], radius)) : [rim(at, scene)]);
