// The lines of the study that saving would change.
import { html } from './draw.js';
import { of, state } from './design.js';
import { post } from './server.js';

// Number of unchanged lines that are shown around a change.
const AROUND = 2;

// Differences between two lists of lines, as pairs of kind and line. The kind is a blank for a common line, - for a removed line,
// and + for an added line.
export const difference = (before, after) => {
  // Common lines at both ends need no search, which takes memory for each pair of lines.
  const least = Math.min(before.length, after.length);
  let [first, last] = [0, 0];
  while (first < least && before[first] === after[first]) first += 1;
  while (last < least - first && before.at(-1 - last) === after.at(-1 - last)) last += 1;
  const common = (lines) => lines.map((line) => [' ', line]);
  const middle = [before, after].map((lines) => lines.slice(first, lines.length - last));
  return [...common(before.slice(0, first)), ...searched(...middle), ...common(before.slice(before.length - last))];
};
// The same for two lists whose common lines must be searched: they are a longest common subsequence.
const searched = (before, after) => {
  const [n, m] = [before.length, after.length];
  const longest = Array.from({ length: n + 1 }, () => new Uint32Array(m + 1));
  for (let i = n - 1; i >= 0; i -= 1) {
    for (let k = m - 1; k >= 0; k -= 1) {
      longest[i][k] = before[i] === after[k] ? longest[i + 1][k + 1] + 1 : Math.max(longest[i + 1][k], longest[i][k + 1]);
    }
  }
  const lines = [];
  let [i, k] = [0, 0];
  while (i < n || k < m) {
    if (i < n && k < m && before[i] === after[k]) {
      lines.push([' ', before[i]]);
      i += 1;
      k += 1;
    } else if (i < n && (k === m || longest[i + 1][k] >= longest[i][k + 1])) {
      lines.push(['-', before[i]]);
      i += 1;
    } else {
      lines.push(['+', after[k]]);
      k += 1;
    }
  }
  return lines;
};

// Lines that a save would change, compared with the present text of the file. After a save and an undo, the edits of the page refer
// to an earlier text, so this text is not used.
export const writtenDiff = async () => {
  const [files, present] = await Promise.all([post('texts', of()), post('texts', of(state.opened, state.file.digest))]);
  const shown = files.map((one, k) => ({ ...one, before: present[k].before })).flatMap((one) => {
    const lines = changedLines(one);
    return lines.length && files.length > 1 ? [html('div', { class: 'skip-lines', text: one.file }), ...lines] : lines;
  });
  return html('div', { class: 'diff', tabindex: 0, role: 'group', 'aria-label': 'Lines that change' }, ...(shown.length ? shown : [html('div', { text: 'No line changes.' })]));
};
// Lines of a file around its changes. Empty without changes.
const changedLines = ({ before, after }) => {
  const lines = difference(before.split('\n'), after.split('\n'));
  const isNear = (at) => lines.slice(Math.max(0, at - AROUND), at + AROUND + 1).some(([kind]) => kind !== ' ');
  const shown = [];
  lines.forEach(([kind, text], at) => {
    if (isNear(at)) shown.push(html('div', { class: { '-': 'gone', '+': 'come' }[kind] ?? null, text: `${kind} ${text}` }));
    else if (at === 0 || isNear(at - 1)) shown.push(html('div', { class: 'skip-lines', text: '  …' }));
  });
  return lines.every(([kind]) => kind === ' ') ? [] : shown;
};
