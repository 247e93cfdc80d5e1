// Labels at the right ends of lines, as in reports. Labels name the lines of both wheels, the lines of pinned designs, and the
// lines of a family. A family has one line for each other value of a slider.
import { brief, measured } from './draw.js';
import { state } from './design.js';

// Largest number of lines of a family that all have labels. In a larger family, only the first, the last and the present line
// have labels.
const MOST = 5;
// Size of a label, and the least distance between two, in pixels.
const SIZE = 10;
const APART = 11;

// Labels with the ends of their lines.
export const labelsOf = (lines) => {
  const found = [];
  const end = (pieces) => pieces.at(-1)?.at(-1);
  const isPair = lines.length > 1;
  for (const { side, pieces, family } of lines) {
    const unit = family.length ? state.overview.sliders[state.family].unit : '';
    const named = (value) => `${brief(value, 3)} ${unit}`;
    const place = family.length ? named(state.answer.group_places[state.answer.shown][state.family]) : null;
    const own = isPair && place !== null ? side[0].toUpperCase() : side;
    const text = [isPair ? own : null, place].filter(Boolean).join(' ');
    if (text) found.push({ end: end(pieces), text, kind: `strong ${side ?? ''}` });
    const known = family.filter((f) => end(f.pieces));
    const some = known.length <= MOST ? known : [known[0], known.at(-1)];
    for (const f of some) if (!isPair || side === 'left') found.push({ end: end(f.pieces), text: named(f.value), kind: side ?? '' });
  }
  for (const { pins } of lines) for (const [letter, pieces] of pins) found.push({ end: end(pieces), text: letter, kind: `pin pin-${letter}` });
  return found.filter((label) => label.end);
};
export const widest = (labels) => Math.ceil(Math.max(...labels.map(({ text }) => measured(text, SIZE, 700))));

// Vertical positions of labels between two ends, without overlaps. If there is not enough space, only labels of emphasised lines
// are shown.
export const spread = (labels, [top, bottom], y) => {
  const most = Math.max(1, Math.floor((bottom - top) / APART));
  const some = labels.length > most ? labels.filter(({ kind }) => kind.startsWith('strong')).slice(0, most) : labels;
  const found = some.map((label) => ({ ...label, at: y(label.end[1]) })).filter(({ at }) => at > top - 1 && at < bottom + 1);
  found.sort((a, b) => a.at - b.at);
  let free = top;
  for (const label of found) {
    label.to = Math.max(label.at, free);
    free = label.to + APART;
  }
  let last = bottom;
  for (const label of [...found].reverse()) {
    label.to = Math.min(label.to, last);
    last = label.to - APART;
  }
  return found;
};
