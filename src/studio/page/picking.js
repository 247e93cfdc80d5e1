// Members of the mechanism as lines in the views: the user clicks them to choose members, and a constraint marks its members.
import { byId, set, show, svg } from './draw.js';
import { emit, on, state } from './design.js';
import { action, hideMessage, say } from './dialog.js';

let marked = new Set();
// The choice in progress: number of members to choose, members chosen so far, and the function that receives them.
let choice = null;

export const memberName = ({ name, axle }) => [axle, name.replaceAll('_', ' ')].filter(Boolean).join(' ');

const redraw = () => emit('options');
const mark = (members) => {
  marked = new Set(members);
  redraw();
};
// Ends the choice. `members` is null if the user cancelled the choice.
const end = (members) => {
  if (!choice) return;
  const { done, shown } = choice;
  choice = null;
  delete document.documentElement.dataset.picking;
  if (byId('banner').firstChild === shown) hideMessage();
  mark(members ?? []);
  done(members);
};
const ask = () => {
  const left = choice.count - choice.members.length;
  const what = choice.members.length ? 'another member' : left > 1 ? `${left} members` : 'a member';
  say(`Click ${what} in a view, or press Tab and Enter. Escape cancels.`, 'good', action('Choose from a list', () => end([])), action('Cancel', () => end(null)));
  choice.shown = byId('banner').firstChild;
};
const choose = (k) => {
  const { members, count } = choice;
  if (members.includes(k)) members.splice(members.indexOf(k), 1);
  else members.push(k);
  if (members.length === count) return end(members);
  mark(members);
  ask();
};

// Lets the user choose members in the views. Returns their indices. Returns an empty list if the user wants to choose from a
// list instead, and null if the user cancels.
export const chooseMembers = (count) => new Promise((done) => {
  end(null);
  choice = { count, members: [], done };
  document.documentElement.dataset.picking = 'true';
  mark([]);
  ask();
  document.querySelector('.member:not([style*="none"])')?.focus({ preventScroll: true });
});
export const clearMarks = () => mark([]);

// Marks the members of the constraint with the displayed name `shown`. If the study gives the constraint a name, the members
// come from the keys of the constraint in the study. Otherwise they come from the displayed name.
export const markMembersIn = (shown) => {
  const written = (state.overview.written.optimise?.constraints ?? []).find(({ name }) => name && shown.startsWith(name));
  const of = written && Object.entries({ clearance: written.members, length: written.length, plunge: written.plunge }).find(([, members]) => members);
  const text = of ? [of[0], written.axle ?? '', ...[].concat(of[1])].join(' ') : written ? '' : shown;
  const parts = text.split(/[^\w]+/);
  // Displayed names of other kinds of constraint contain names of points, not of members.
  const isOfMembers = /^(clearance|length|plunge)$/.test(parts.find((part) => !/^(front|rear)$/.test(part))) || text.includes('rim');
  const { members } = state.overview;
  mark(!isOfMembers ? [] : members.flatMap(({ name, axle }, k) => (parts.includes(name) && (!axle || parts.includes(axle)) ? [k] : [])));
};

// Lines of the members in one view.
export class MemberLines {
  constructor(layer) { this.layer = layer; }

  build() {
    this.layer.replaceChildren();
    this.lines = state.overview.members.map((member, k) => {
      const paths = ['hit', 'line'].map((kind) => svg('path', { class: kind }));
      const pick = (event) => {
        event.preventDefault();
        event.stopPropagation();
        choose(k);
      };
      const group = svg('g', {
        class: 'member', role: 'button', 'aria-label': memberName(member), 'data-member': member.name,
        on: { pointerdown: pick, keydown: (event) => { if (event.key === 'Enter' || event.key === ' ') pick(event); } },
      }, svg('title', { text: memberName(member) }), ...paths);
      show(group, false);
      this.layer.append(group);
      return { group, paths, ends: member.ends };
    });
  }

  // Draws the members that can be chosen or that are marked. `lineOf` gives the line between two points.
  draw(isDrawn, lineOf) {
    this.lines.forEach(({ group, paths, ends }, k) => {
      const isHere = (choice || marked.has(k)) && isDrawn(ends[0]);
      show(group, isHere);
      if (!isHere) return;
      set(group, { class: marked.has(k) ? 'member marked' : 'member', tabindex: choice ? 0 : null });
      for (const path of paths) set(path, { d: lineOf(ends) });
    });
  }
}

export const startPicking = () => {
  document.addEventListener('keydown', (event) => { if (choice && event.key === 'Escape') end(null); }, true);
  for (const event of ['study', 'edited']) on(event, () => { end(null); marked = new Set(); });
  on('tab', () => { if (!choice && marked.size) mark([]); });
  // If the message is closed or replaced, the choice ends.
  const banner = byId('banner');
  new MutationObserver(() => { if (choice && (banner.hidden || banner.firstChild !== choice.shown)) end(null); }).observe(banner, { attributes: true, childList: true });
};
