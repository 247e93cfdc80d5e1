// Front view, side view, top view and a view in space. They show the mechanism at the positions of the sliders, with points that
// the user can drag.
import { along, AXES, brief, byId, centred, cross, dot, heldByFinger, html, minus, norm, placed, set, show, signed, svg, tenth, write } from './draw.js';
import { MechanismView } from './mechanism_view.js';
import { flat, rims } from './space.js';
import { MemberLines } from './picking.js';
import { announce } from './speech.js';
import { begin, emit, finish, gradient, grip, isEdited, moveTo, on, snapped, state, stepped } from './design.js';

// Distance in pixels below which points count as overlapping.
const STACKED = 9;

const views = [];
let others = false;
// Axle of a car that is drawn. Empty for both axles.
let part = '';
const isDrawn = (p) => part === '' || state.overview.points[p].axle?.[0] === part;

const mirrored = (p) => [p[0], -p[1], p[2]];
const placement = (frame) => frame?.pose?.Ok ?? null;
// Other wheel: the solved right wheel of an axle, or otherwise the mirror image.
const otherWheel = (frame) => {
  if (state.overview.is_axle) return placement(state.answer?.right);
  const { points, spin_axis: axis, contact } = frame;
  return { points: points.map(mirrored), spin_axis: mirrored(axis), contact: contact && mirrored(contact) };
};
// Circles of the wheels in a position of the mechanism. All views share them.
const circles = new WeakMap();
const circlesOf = (at, scene) => {
  if (!circles.has(at)) circles.set(at, rims(at, scene));
  return circles.get(at);
};
// Circles of the visible wheels.
const rimsOf = (at, scene) => circlesOf(at, scene).filter((_, k) => !at.spin_axes || isDrawn(scene.wheels[k].centre));
const contactsOf = (frame, other) => (frame?.contacts ? [...frame.contacts, ...(other?.contacts ?? [])] : [frame?.contact, frame?.contact && other?.contact].filter(Boolean));
// Converts a displacement in the drawing to the axes of the body, because the body of a car rolls and pitches relative to the
// drawing. In a flat view, two coordinates move, and the point stays under the pointer. In the view in space, the displacement is
// rotated.
const inBody = (way, { right, up }, isFlat) => {
  const { axes } = placement(state.answer?.frame) ?? {};
  if (!axes) return way;
  const column = (k) => axes.map((row) => row[k]);
  if (!isFlat) return [0, 1, 2].map((k) => dot(column(k), way));
  const plane = [0, 1, 2].filter((k) => right[k] !== 0 || up[k] !== 0);
  const [[a, b], [c, d]] = [right, up].map((look) => plane.map((k) => dot(look, column(k))));
  const [p, q] = [dot(way, right), dot(way, up)];
  const found = [0, 0, 0];
  found[plane[0]] = (p * d - q * b) / (a * d - b * c);
  found[plane[1]] = (q * a - p * c) / (a * d - b * c);
  return found;
};
const inDrawing = (way) => {
  const { axes } = placement(state.answer?.frame) ?? {};
  return axes ? axes.map((row) => dot(row, way)) : way;
};
// Position of a point in the drawing. Without a pose, it is the position in the design. While the answer is late, the moves
// since the last answer are added to the position in that answer. So the point stays under the pointer.
const placeIn = (frame, p) => {
  const at = frame?.points[p];
  if (!at) return along(state.design[p], state.overview.points[p].shift, 1);
  const [is, was] = [state.design[p], state.answered?.[p]];
  return !was || is.every((c, k) => c === was[k]) ? at : along(at, inDrawing(minus(is, was)), 1);
};
// Names of points with their coordinates, for all views; and the points that a variable moves.
let labels = [];
const labelOf = (p) => {
  const { points, unit } = state.overview;
  const [x, y, z] = state.design[p];
  const known = labels[p];
  if (known?.point === points[p] && known.x === x && known.y === y && known.z === z) return known.text;
  const text = `${points[p].name}: ${state.design[p].map((c, k) => `${AXES[k]} ${brief(c)}`).join(', ')} ${unit}`;
  labels[p] = { point: points[p], x, y, z, text };
  return text;
};
const movable = new WeakMap();
const movableOf = (overview) => {
  if (!movable.has(overview)) movable.set(overview, new Set(overview.variables.flatMap(({ moves }) => moves.map(([p]) => p))));
  return movable.get(overview);
};

// The locked axes of a point in words.
const lockedWords = (p) => {
  const axes = AXES.filter((_, k) => state.locked[p][k]);
  return axes.length === 3 ? ['locked (tab Points)'] : axes.length ? [`${axes.join(', ')} locked`] : [];
};

// Moves the circles of a handle to a position.
const put = (handle, x, y) => { for (const circle of handle.children) set(circle, centred(x, y)); };

class View extends MechanismView {
  constructor(name, title, basis) {
    super({
      name, basis,
      title: `${title}. Arrow keys ${basis ? 'move' : 'turn'} the picture, plus and minus zoom, Home fits. The points follow.`, scene: () => state.overview?.scene,
      layers: ['grid', 'ghost', 'pins', 'proposal', 'other', 'bodies', 'marks', 'arrows', 'handles', 'members', 'words'],
    });
    this.title = title;
    this.members = new MemberLines(this.layers.members);
    set(this.svg, { tabindex: 0 });
    this.svg.addEventListener('keydown', (event) => { if (event.target === this.svg) this.keyOfPicture(event); });
    const zoom = this.zoomButton = html('button', { class: 'zoom', 'aria-pressed': 'false', title: `${title} alone`, 'aria-label': `${title} alone`, text: '⤢', on: { click: () => this.enlarge() } });
    const fit = html('button', { class: 'zoom', title: 'Fit', 'aria-label': `Fit ${title}`, text: '⊡', on: { click: () => { this.fit(); this.draw(); } } });
    this.figure = html('figure', { class: 'viewbox', 'data-view': name }, html('figcaption', {}, title, html('span', { class: 'zooms' }, fit, zoom)), this.svg);
  }

  enlarge() {
    const parent = byId('views');
    const was = parent.dataset.alone === this.name;
    if (was) delete parent.dataset.alone;
    else parent.dataset.alone = this.name;
    for (const view of views) {
      view.figure.classList.toggle('alone', !was && view === this);
      set(view.zoomButton, { 'aria-pressed': String(!was && view === this) });
    }
  }

  fit() {
    const { scene } = state.overview;
    const frame = placement(state.answer?.frame) ?? placement(state.ghost?.frame);
    if (!frame || !this.width) return;
    const ofPart = (at) => [...at.points.filter((_, p) => isDrawn(p)), ...rimsOf(at, scene).flat()];
    let points = ofPart(frame);
    if (others) points = [...points, ...ofPart(otherWheel(frame))];
    this.fitTo(points);
  }

  build() {
    const { scene, points } = state.overview;
    for (const layer of Object.values(this.layers)) layer.replaceChildren();
    const lines = (layer, classes) => this.linesIn(layer, classes);
    this.ghost = [...lines('ghost', 'plain'), this.layers.ghost.appendChild(svg('path', { class: 'rim' }))];
    this.proposal = lines('proposal', 'plain');
    this.pins = Object.fromEntries(['A', 'B', 'C'].map((letter) => [letter, lines('pins', `plain pin-${letter}`)]));
    this.other = [...lines('other', 'plain'), this.layers.other.appendChild(svg('path', { class: 'rim' }))];
    this.ground = this.layers.bodies.appendChild(svg('path', { class: 'ground' }));
    this.wheel = this.layers.bodies.appendChild(svg('path', { class: 'rim' }));
    this.axis = this.layers.bodies.appendChild(svg('path', { class: 'axis' }));
    this.bodies = lines('bodies');
    this.bodies.forEach((path, k) => path.append(svg('title', { text: scene.bodies[k].name })));
    this.centre = this.layers.marks.appendChild(svg('path', { class: 'centre' }, svg('title', { text: state.overview.is_car ? 'centre of gravity of the sprung mass' : 'roll centre' })));
    this.arrows = points.map(() => {
      const hit = svg('path', { class: 'hit' });
      const line = svg('path', { class: 'arrow' });
      const title = svg('title');
      const arrow = { group: this.layers.arrows.appendChild(svg('g', {}, title, hit, line)), hit, line, words: () => '' };
      arrow.group.addEventListener('pointerenter', () => write(title, arrow.words()));
      return arrow;
    });
    this.members.build();
    // Circle of the selected point, above overlapping points.
    this.top = this.layers.words.appendChild(svg('circle', { class: 'top', r: 7 }));
    this.words = points.map(({ name }) => this.layers.words.appendChild(svg('text', { text: name })));
    const handle = (point, other) => {
      const circle = svg('circle', { r: 5.5 });
      const group = svg('g', {
        class: 'handle', tabindex: other ? -1 : 0, role: 'button', 'data-point': point, 'data-name': points[point].name, 'data-other': other || null,
        on: {
          pointerdown: (event) => this.grab(event, point, other),
          keydown: (event) => this.keyOfPoint(event, point),
          focus: () => select(point),
          pointerenter: () => hover(this, point),
          pointerleave: () => hover(this, null),
        },
      }, svg('circle', { class: 'hit', r: 13 }), circle);
      this.layers.handles.append(heldByFinger(group));
      return group;
    };
    this.mirrors = points.map((_, point) => handle(point, true));
    this.handles = points.map((_, point) => handle(point, false));
  }

  draw() {
    if (!this.width || !this.handles) return;
    const { scene, points } = state.overview;
    const free = movableOf(state.overview);
    const frame = placement(state.answer?.frame);
    this.look = this.turned();
    this.drawGrid();
    const bodies = (paths, at) => this.showBodies(paths, at, ({ lines }) => isDrawn(lines[0][0]));
    const round = (path, at) => set(path, { d: at ? rimsOf(at, scene).map((own) => this.path(own, true)).join('') : '' });
    bodies(this.bodies, frame);
    round(this.wheel, frame);
    // The server's answer contains the mechanism with the points of the file. After a change of values, the mechanism of the file
    // is different.
    const opened = placement(isEdited() ? state.ghost?.frame : state.answer?.opened);
    bodies(this.ghost, opened);
    round(this.ghost.at(-1), opened);
    bodies(this.proposal, placement(state.proposed?.frame));
    for (const [letter, paths] of Object.entries(this.pins)) bodies(paths, placement(state.pins[letter]?.answer?.frame));
    const other = others && frame ? otherWheel(frame) : null;
    bodies(this.other, other);
    round(this.other.at(-1), other);
    const axis = frame?.steering_axis;
    set(this.axis, { d: axis ? this.path([-0.35, 1.12].map((t) => along(axis[0], minus(axis[1], axis[0]), t))) : '' });
    this.showGround(this.ground, contactsOf(frame, other));
    const mark = frame?.sprung_cg ?? (this.name === 'front' ? frame?.roll_centre : null);
    const centre = mark ? this.project(mark) : null;
    const inside = centre && centre.every((c, k) => c > 4 && c < (k ? this.height : this.width) - 4);
    set(this.centre, { d: inside ? `M${centre[0] - 6} ${centre[1]}h12M${centre[0]} ${centre[1] - 6}v12` : '' });
    const slopes = gradient();
    const steepest = slopes ? Math.max(...slopes.map(norm), 1e-300) : 1;
    this.places = [];
    this.mirrorPlaces = [];
    points.forEach(({ name }, p) => {
      // Without a pose, handles stay at the design positions of their points, so that the user can move them back.
      const at = placeIn(frame, p);
      const [x, y] = this.project(at);
      const handle = this.handles[p];
      const kinds = [['locked', state.locked[p].every(Boolean)], ['moved', state.design[p].some((c, k) => c !== state.opened[p][k])], ['selected', state.selected === p], ['free', free.has(p)]];
      put(handle, x, y);
      set(handle, { 'aria-label': [labelOf(p), ...lockedWords(p)].join(', '), class: ['handle', ...kinds.flatMap(([kind, is]) => (is ? [kind] : []))].join(' ') });
      // Points of the right half of a solid axle are moved by the handles of the other side.
      const isHere = isDrawn(p) && !points[p].follows;
      show(handle, isHere);
      const mirror = this.mirrors[p];
      show(mirror, other && isHere);
      if (other) {
        const [mx, my] = this.project(other.points[p]);
        this.mirrorPlaces[p] = isHere ? [mx, my] : undefined;
        put(mirror, mx, my);
        set(mirror, { 'aria-label': `${name}, other side` });
      }
      // A point that is not drawn cannot be grabbed.
      this.places[p] = isHere ? [x, y] : undefined;
      this.drawArrow(p, [x, y], isHere ? slopes?.[p] : null, steepest);
    });
    const top = state.selected === null ? null : this.places[state.selected];
    show(this.top, top);
    if (top) set(this.top, centred(...top));
    this.members.draw(isDrawn, (ends) => this.path(ends.map((p) => placeIn(frame, p))));
    this.drawWords(frame);
  }

  // Draws each name at one of four positions: the first one with the fewest overlaps. A position that leaves the picture counts as
  // two overlaps.
  drawWords(frame) {
    const taken = [];
    const near = !this.places[this.hovered] ? [] : this.stack(this.places[this.hovered], this.places);
    const order = this.words.map((_, p) => p).sort((a, b) => (b === state.selected) - (a === state.selected));
    for (const p of order) {
      const word = this.words[p];
      const isNamed = isDrawn(p) && (named || state.selected === p || near.includes(p));
      show(word, isNamed);
      if (!isNamed) continue;
      write(word, this.wordOf(p));
      const [x, y] = this.project(placeIn(frame, p));
      const width = 6.2 * word.textContent.length;
      const places = [[11, -8, 'start'], [-11, -8, 'end'], [11, 15, 'start'], [-11, 15, 'end']];
      const boxes = places.map(([dx, dy, anchor]) => {
        const left = anchor === 'start' ? x + dx : x + dx - width;
        return [left, y + dy - 10, left + width, y + dy + 2];
      });
      const cost = ([a, b, c, d]) => taken.filter(([e, f, g, h]) => a < g && c > e && b < h && d > f).length
        + (a < 2 || c > this.width - 2 ? 2 : 0) + (b < 2 || d > this.height - 2 ? 2 : 0);
      const costs = boxes.map(cost);
      const best = costs.indexOf(Math.min(...costs));
      taken.push(boxes[best]);
      const [dx, dy, anchor] = places[best];
      // A name stays within the picture.
      const [left, , right] = boxes[best];
      const inward = Math.max(0, 2 - left) - Math.max(0, right - this.width + 2);
      set(word, { ...placed(x + dx + inward, y + dy), 'text-anchor': anchor, class: state.selected === p ? 'selected' : null });
    }
  }

  // Draws an arrow in the direction in which the misfit or target deviation falls. Its length grows with the square root of the
  // slope, so that gentle slopes are visible, too.
  drawArrow(p, [x, y], slope, steepest) {
    const { group, line, hit } = this.arrows[p];
    const steep = slope ? norm(slope) : 0;
    const drawn = slope && inDrawing(slope);
    const down = slope ? [-dot(drawn, this.look.right), dot(drawn, this.look.up)] : [0, 0];
    const flatness = Math.hypot(...down) / (steep || 1);
    if (steep < 1e-3 * steepest || steep < 1e-9 || flatness < 0.02) {
      show(group, false);
      return;
    }
    show(group, true);
    const length = (12 + 44 * Math.sqrt(steep / steepest)) * flatness;
    const [ux, uy] = down.map((c) => c / Math.hypot(...down));
    const from = [x + ux * 8, y + uy * 8];
    const tip = [x + ux * (8 + length), y + uy * (8 + length)];
    const barb = Math.min(7, 3 + length / 6);
    const at = (s, t) => `${tenth(tip[0] - ux * s - uy * t)} ${tenth(tip[1] - uy * s + ux * t)}`;
    const [a, b] = [from, tip].map((c) => c.map(tenth).join(' '));
    set(line, { d: `M${a}L${b}M${at(barb, barb * 0.55)}L${b}L${at(barb, -barb * 0.55)}` });
    set(hit, { d: `M${a}L${b}` });
    this.arrows[p].words = () => `${state.overview.points[p].name}: −${brief(steep, 3)} tolerances per ${state.overview.unit} in this direction (${slope.map((c, k) => `${AXES[k]} ${signed(-c, 2)}`).join(', ')})`;
  }

  // Overlapping points at a position, the nearest first.
  stack(place, places) {
    const far = (p) => (places[p] ? Math.hypot(places[p][0] - place[0], places[p][1] - place[1]) : Infinity);
    return places.map((_, p) => p).filter((p) => far(p) <= STACKED).sort((a, b) => far(a) - far(b) || a - b);
  }

  // The user drags a point in the plane of the picture. Among overlapping points, the selected point moves, or else the nearest.
  // A click without a move selects the next of these points.
  grab(event, hit, other) {
    if (event.button !== 0) return;
    event.preventDefault();
    event.stopPropagation();
    const box = this.svg.getBoundingClientRect();
    const stack = this.stack([event.clientX - box.x, event.clientY - box.y], other ? this.mirrorPlaces : this.places);
    const wasSelected = stack.includes(state.selected);
    const point = wasSelected ? state.selected : stack[0] ?? hit;
    this.handles[point].focus({ preventScroll: true });
    select(point);
    const start = grip();
    const from = [event.clientX, event.clientY];
    begin('drag');
    this.dragged = { point, start };
    const target = event.currentTarget;
    target.setPointerCapture(event.pointerId);
    this.svg.classList.add('dragging');
    this.drawWords(placement(state.answer?.frame));
    const move = (now) => {
      const way = inBody(this.unproject([now.clientX - from[0], now.clientY - from[1]]), this.look, this.basis !== null);
      if (other) way[1] = -way[1];
      if (now.shiftKey) {
        const most = way.map(Math.abs).indexOf(Math.max(...way.map(Math.abs)));
        way.forEach((_, k) => { if (k !== most) way[k] = 0; });
      }
      const step = now.altKey ? state.step / 100 : state.step;
      const to = way.map((by, k) => (Math.abs(by) < 1e-12 ? start[point][k] : snapped(start[point][k] + by, step)));
      moveTo(start, point, to);
    };
    const end = (now) => {
      for (const name of ['pointermove', 'pointerup', 'pointercancel']) target.removeEventListener(name, handlers[name]);
      this.svg.classList.remove('dragging');
      this.dragged = null;
      this.drawWords(placement(state.answer?.frame));
      if (now.type === 'pointercancel') { state.design = start; emit('design'); }
      const isClick = now.type === 'pointerup' && Math.hypot(now.clientX - from[0], now.clientY - from[1]) < 3;
      if (isClick && stack.length > 1) {
        const ring = [...stack].sort((a, b) => a - b);
        const next = wasSelected ? ring[(ring.indexOf(point) + 1) % ring.length] : point;
        this.handles[next].focus({ preventScroll: true });
        select(next);
      }
      finish();
    };
    const handlers = { pointermove: move, pointerup: end, pointercancel: end };
    for (const [name, handler] of Object.entries(handlers)) target.addEventListener(name, handler);
  }

  // Name of a point. While the point is dragged, the text also has the locked axes and the moved coordinates.
  wordOf(point) {
    const { name } = state.overview.points[point];
    const start = this.dragged?.point === point ? this.dragged.start[point] : [];
    const moved = start.flatMap((was, k) => {
      const is = state.design[point][k];
      return is === was ? [] : [`${AXES[k]} ${brief(is)} (${signed(is - was)})`];
    });
    const isDragged = this.dragged?.point === point;
    return [name, ...(isDragged ? lockedWords(point) : []), ...moved].join('  ');
  }

  keyOfPoint(event, point) {
    if (event.key === 'Enter' || event.key === ' ') {
      event.preventDefault();
      emit('fields', point);
      return;
    }
    const ways = { ArrowLeft: [-1, 0, 0], ArrowRight: [1, 0, 0], ArrowUp: [0, 1, 0], ArrowDown: [0, -1, 0], PageUp: [0, 0, 1], PageDown: [0, 0, -1] };
    const way = ways[event.key];
    if (!way || event.ctrlKey || event.metaKey) return;
    event.preventDefault();
    // In the view in space, keys move a point along the nearest axes.
    const nearest = (v) => { const k = v.map(Math.abs).indexOf(Math.max(...v.map(Math.abs))); return v.map((c, i) => (i === k ? Math.sign(c) : 0)); };
    const [right, up] = [nearest(this.look.right), nearest(this.look.up)];
    const through = cross(right, up);
    const length = state.step * (event.shiftKey ? 10 : 1) / (event.altKey ? 10 : 1);
    const by = [0, 1, 2].map((k) => length * (way[0] * right[k] + way[1] * up[k] + way[2] * through[k]));
    if (by.some((c, k) => c !== 0 && state.locked[point][k])) announce(`${state.overview.points[point].name}: ${lockedWords(point)}`);
    const start = grip();
    begin('key', point);
    moveTo(start, point, start[point].map((c, k) => (by[k] === 0 ? undefined : stepped(c, by[k]))));
    finish();
  }
}

let named = false;
export const select = (point) => {
  if (state.selected === point) return;
  state.selected = point;
  emit('selection');
};
const hover = (view, point) => {
  view.hovered = point;
  view.draw();
};
const drawAll = () => views.forEach((view) => view.draw());

export const viewSvgs = () => views.map((view) => [view.name, view.title, view.svg]);

export const startViews = () => {
  for (const [name, title, basis] of [['front', 'Front', flat.front], ['side', 'Side', flat.side], ['top', 'Top', flat.top], ['space', 'In space', null]]) {
    const view = new View(name, title, basis);
    views.push(view);
    byId('views').append(view.figure);
  }
  let fitted = false;
  on('study', () => {
    fitted = false;
    if (!state.overview.is_car) part = '';
    others = state.overview.is_axle || byId('mirror').checked;
    byId('mirror-label').hidden = state.overview.is_axle;
    views.forEach((view) => { view.gridKey = null; view.build(); });
  });
  on('answer', () => {
    if (!fitted && placement(state.answer?.frame)) {
      fitted = true;
      views.forEach((view) => { view.measure(); view.fit(); });
    }
    drawAll();
  });
  for (const event of ['selection', 'options', 'proposed', 'pins', 'unanswered', 'late']) on(event, drawAll);
  on('design', () => { if (state.isLate) drawAll(); });
  on('ghost', () => { if (isEdited()) drawAll(); });
  byId('part').addEventListener('change', (event) => {
    part = event.target.value;
    views.forEach((view) => view.fit());
    drawAll();
  });
  byId('names').addEventListener('change', (event) => { named = event.target.checked; drawAll(); });
  byId('mirror').addEventListener('change', (event) => {
    others = event.target.checked;
    views.forEach((view) => view.fit());
    drawAll();
  });
};
