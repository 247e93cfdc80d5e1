// View of a mechanism in the studio and in reports: camera, grid, bodies, wheels, and positions of names.
import { along, AXES, brief, dot, html, minus, niceStep, norm, set, svg, tenth, ticks } from './draw.js';
import { directions, flat, inSpace } from './space.js';

const HUES = 7;

export const hueOf = (bodies) => {
  let number = 0;
  const own = { knuckle: 'carrier', strut: 'strut', spring: 'strut', rocker: 'rocker' };
  return bodies.map(({ kind }) => own[kind] ?? `hue${number++ % HUES}`);
};

// Positions of names: each name takes the position of lowest cost around its point. Overlaps cost more than distance. A distant
// name has a line to its point. Each name is given as { text, at, kind }. The result has the left end and the baseline of each
// name's box, and the ends of the line.
const LETTER = 6.4;
const LINE = 12;
const DISTANCES = [9, 18, 30, 46, 66];
const AROUND = 12;
export const placeNames = (names, dots, [width, height]) => {
  const taken = [];
  const area = ([a, b, c, d], [e, f, g, h]) => Math.max(0, Math.min(c, g) - Math.max(a, e)) * Math.max(0, Math.min(d, h) - Math.max(b, f));
  return names.map(({ text, at: [x, y], kind }) => {
    const long = LETTER * text.length;
    let best = null;
    for (const far of DISTANCES) {
      for (let k = 0; k < AROUND; k += 1) {
        const angle = (2 * Math.PI * k) / AROUND - 0.5;
        const [c, s] = [Math.cos(angle), Math.sin(angle)];
        const middle = [x + far * c + (Math.abs(c) > 0.01 ? Math.sign(c) * long / 2 : 0), y + far * s + (LINE / 2) * s];
        const box = [middle[0] - long / 2, middle[1] - LINE / 2, middle[0] + long / 2, middle[1] + LINE / 2];
        const outside = box[0] < 3 || box[2] > width - 3 || box[1] < 3 || box[3] > height - 3;
        const names = taken.reduce((sum, other) => sum + area(box, other), 0) / 80;
        const points = dots.filter(([u, v]) => u > box[0] - 4 && u < box[2] + 4 && v > box[1] - 4 && v < box[3] + 4).length;
        const cost = (outside ? 1e6 : 0) + 50 * names + 30 * points + 0.5 * far;
        if (!best || cost < best.cost) best = { cost, box, far };
      }
    }
    taken.push(best.box);
    const [a, b, c, d] = best.box;
    const end = [Math.min(c, Math.max(a, x)), Math.min(d, Math.max(b, y))];
    return { text, kind, x: a, y: d - 2, leader: best.far > 12 ? [[x, y], end] : null };
  });
};

export class MechanismView {
  // `scene` gives the drawing; `basis` is null for a view in space.
  constructor({ name, title, basis, layers, scene }) {
    this.name = name;
    this.basis = basis;
    this.sceneOf = scene;
    this.orbit = { turn: 0.72, lift: 0.36 };
    this.focus = [0, 0, 0];
    this.scale = 1;
    this.svg = svg('svg', { class: 'view', role: 'group', 'aria-label': title });
    this.layers = Object.fromEntries(layers.map((layer) => [layer, this.svg.appendChild(svg('g', { class: layer }))]));
    this.listen();
    new ResizeObserver(() => { if (this.measure() && this.sceneOf()) { this.fit(); this.draw(); } }).observe(this.svg);
  }

  measure() {
    const { width, height } = this.svg.getBoundingClientRect();
    const is = width !== this.width || height !== this.height;
    [this.width, this.height] = [width, height];
    // The view box scales the picture if it is printed in another size.
    if (width > 0) set(this.svg, { viewBox: `0 0 ${width} ${height}` });
    return is && width > 0;
  }

  turned() {
    return this.basis ? this.basis(this.sceneOf()) : inSpace(this.sceneOf(), this.orbit);
  }

  // Place of a point on the screen.
  project(p) {
    const by = minus(p, this.focus);
    return [this.width / 2 + this.scale * dot(by, this.look.right), this.height / 2 - this.scale * dot(by, this.look.up)];
  }

  // Displacement in space of a displacement on the screen.
  unproject([x, y]) {
    return along(this.look.right.map((c) => (c * x) / this.scale), this.look.up, -y / this.scale);
  }

  // Moves and zooms the view so that all of these points are visible.
  fitTo(points) {
    if (!points.length || !this.width) return;
    this.look = this.turned();
    const spans = ['right', 'up'].map((way) => {
      const places = points.map((p) => dot(p, this.look[way]));
      return [Math.min(...places), Math.max(...places)];
    });
    const middle = spans.map(([low, high]) => (low + high) / 2);
    if (this.basis) {
      this.focus = along(this.look.right.map((c) => c * middle[0]), this.look.up, middle[1]);
    } else {
      const box = [0, 1, 2].map((k) => [Math.min(...points.map((p) => p[k])), Math.max(...points.map((p) => p[k]))]);
      this.focus = box.map(([low, high]) => (low + high) / 2);
    }
    const room = [this.width - 76, this.height - 60];
    this.scale = Math.max(1e-9, Math.min(...spans.map(([low, high], k) => room[k] / Math.max(high - low, 1e-6))));
    if (!this.basis) {
      const far = Math.max(...points.map((p) => norm(minus(p, this.focus))));
      this.scale = Math.min(this.width - 40, this.height - 30) / (2 * far) * 1.12;
    }
  }

  path(points, closed = false) {
    let d = '';
    for (const p of points) {
      const [x, y] = this.project(p);
      d += `${d ? 'L' : 'M'}${tenth(x)} ${tenth(y)}`;
    }
    return d && closed ? `${d}Z` : d;
  }

  // A path for each body of the drawing.
  linesIn(layer, classes) {
    const { bodies } = this.sceneOf();
    const hues = hueOf(bodies);
    return bodies.map((body, k) => this.layers[layer].appendChild(svg('path', { class: `${body.kind} ${classes ?? hues[k]}` })));
  }
  showBodies(paths, at, isShown = () => true) {
    this.sceneOf().bodies.forEach((body, k) => {
      set(paths[k], { d: at && isShown(body) ? body.lines.map((line) => this.path(line.map((i) => at.points[i]))).join('') : '' });
    });
  }

  // The ground under a wheel, or under both wheels.
  showGround(path, contacts) {
    const { wheel_radius: radius } = this.sceneOf();
    if (!contacts.length || !radius || this.name === 'top') {
      set(path, { d: '' });
      return;
    }
    const [contact] = contacts;
    const other = contacts.length > 2 ? contacts[2] : contacts[1];
    if (this.name === 'front' && other) {
      // In the axes of a body that rolls, the ground is tilted.
      const [a, b] = [contact, other].map((c) => this.project(c));
      const slope = (b[1] - a[1]) / (b[0] - a[0] || 1);
      set(path, { d: `M0 ${(a[1] - slope * a[0]).toFixed(1)}L${this.width} ${(a[1] + slope * (this.width - a[0])).toFixed(1)}` });
      return;
    }
    if (!this.basis && contacts.length > 2) {
      const [front, rear, right, back] = contacts;
      set(path, { d: this.path([front, right, back, rear], true) });
      return;
    }
    if (this.basis) {
      const [, y] = this.project(contact);
      set(path, { d: `M0 ${y.toFixed(1)}H${this.width}` });
      return;
    }
    const d = directions(this.sceneOf());
    const corner = (s, t) => along(along(contact, d.forward, s * 1.2 * radius), d.outboard, t * radius);
    set(path, { d: this.path([corner(-1, -1.6), corner(1, -1.6), corner(1, 0.5), corner(-1, 0.5)], true) });
  }

  drawGrid() {
    const key = [this.name, this.width, this.height, this.scale, ...this.focus].map((c) => (typeof c === 'string' ? c : c.toPrecision(8))).join();
    if (!this.basis) {
      const turned = `${key} ${this.orbit.turn} ${this.orbit.lift}`;
      if (turned === this.gridKey) return;
      this.gridKey = turned;
      this.drawTriad();
      return;
    }
    if (key === this.gridKey) return;
    this.gridKey = key;
    const { grid } = this.layers;
    grid.replaceChildren();
    const axisOf = (v) => v.findIndex((c) => c !== 0);
    const [h, v] = [axisOf(this.look.right), axisOf(this.look.up)];
    const reach = [this.width, this.height].map((c) => c / this.scale / 2);
    const step = niceStep(2 * reach[0], this.width / 90);
    for (const [axis, half, vertical] of [[h, reach[0], true], [v, reach[1], false]]) {
      const middle = this.focus[axis];
      for (const tick of ticks(middle - half, middle + half, (2 * half) / step)) {
        const p = [...this.focus];
        p[axis] = tick;
        const [x, y] = this.project(p);
        grid.append(svg('path', { class: tick === 0 ? 'zero' : null, d: vertical ? `M${x.toFixed(1)} 0V${this.height}` : `M0 ${y.toFixed(1)}H${this.width}` }));
        if (vertical ? x > 48 && x < this.width - 48 : y > 30 && y < this.height - 34) {
          grid.append(svg('text', vertical ? { x: x.toFixed(1), y: this.height - 5, 'text-anchor': 'middle', text: brief(tick) } : { x: 4, y: (y - 3).toFixed(1), text: brief(tick) }));
        }
      }
    }
    // Each axis name is at the end towards which its coordinate grows.
    const isRight = this.look.right[h] > 0;
    const isUp = this.look.up[v] > 0;
    grid.append(svg('text', { class: 'axis-name', x: isRight ? this.width - 6 : 6, y: this.height - 5, 'text-anchor': isRight ? 'end' : 'start', text: isRight ? `${AXES[h]} →` : `← ${AXES[h]}` }));
    grid.append(svg('text', { class: 'axis-name', x: 5, y: isUp ? 13 : this.height - 20, text: `${isUp ? '↑' : '↓'} ${AXES[v]}` }));
  }

  drawTriad() {
    const { grid } = this.layers;
    grid.replaceChildren();
    const [x, y] = [34, this.height - 32];
    AXES.forEach((name, k) => {
      const unit = [0, 0, 0];
      unit[k] = 1;
      const [dx, dy] = [22 * dot(unit, this.look.right), -22 * dot(unit, this.look.up)];
      grid.append(svg('path', { class: 'triad', d: `M${x} ${y}L${(x + dx).toFixed(1)} ${(y + dy).toFixed(1)}` }));
      grid.append(svg('text', { class: 'axis-name', x: (x + dx * 1.4).toFixed(1), y: (y + dy * 1.4 + 4).toFixed(1), 'text-anchor': 'middle', text: name }));
    });
  }

  // Handles drags, rotations and zooms of the picture. On a page that scrolls, the picture zooms only if it has the focus.
  listen() {
    const fingers = new Map();
    this.svg.addEventListener('pointerdown', (event) => {
      fingers.set(event.pointerId, [event.clientX, event.clientY]);
      this.svg.setPointerCapture(event.pointerId);
    });
    this.svg.addEventListener('pointermove', (event) => {
      const last = fingers.get(event.pointerId);
      if (!last) return;
      const now = [event.clientX, event.clientY];
      if (fingers.size === 2) {
        // The distance of the fingers zooms the picture. The point between them moves or turns it.
        const [other] = [...fingers].filter(([id]) => id !== event.pointerId).map(([, p]) => p);
        const spread = (p) => Math.hypot(p[0] - other[0], p[1] - other[1]) || 1;
        this.zoom(spread(now) / spread(last), [0, 1].map((k) => (now[k] + other[k]) / 2));
        this.drag((now[0] - last[0]) / 2, (now[1] - last[1]) / 2);
      } else this.drag(now[0] - last[0], now[1] - last[1]);
      fingers.set(event.pointerId, now);
      this.later();
    });
    for (const name of ['pointerup', 'pointercancel']) this.svg.addEventListener(name, (event) => fingers.delete(event.pointerId));
    this.svg.addEventListener('wheel', (event) => {
      if (this.isInPage && !event.ctrlKey && document.activeElement !== this.svg) return;
      event.preventDefault();
      this.zoom(Math.exp(-event.deltaY / 500), [event.clientX, event.clientY]);
      this.later();
    }, { passive: false });
    this.svg.addEventListener('dblclick', (event) => {
      if (event.target.closest('.handle')) return;
      this.fit();
      this.later();
    });
  }

  // Keys of the picture itself: arrows move or turn it, plus and minus zoom it, Home fits it.
  keyOfPicture(event) {
    const by = { ArrowLeft: [-12, 0], ArrowRight: [12, 0], ArrowUp: [0, -12], ArrowDown: [0, 12] }[event.key];
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const box = this.svg.getBoundingClientRect();
    const middle = [box.x + box.width / 2, box.y + box.height / 2];
    if (by) this.drag(...by);
    else if (event.key === '+') this.zoom(1.2, middle);
    else if (event.key === '-') this.zoom(1 / 1.2, middle);
    else if (event.key === 'Home') this.fit();
    else return;
    event.preventDefault();
    this.later();
  }

  // Moves a flat view, or turns the view in space, by this number of pixels.
  drag(right, down) {
    if (this.basis) {
      this.focus = minus(this.focus, this.unproject([right, down]));
      return;
    }
    this.orbit.turn -= (right / 160) * (directions(this.sceneOf()).left ? 1 : -1);
    this.orbit.lift = Math.max(-1.4, Math.min(1.5, this.orbit.lift + down / 160));
  }

  zoom(factor, [x, y]) {
    const box = this.svg.getBoundingClientRect();
    const off = [x - box.x - this.width / 2, y - box.y - this.height / 2];
    const before = this.unproject(off);
    this.scale *= factor;
    this.focus = along(this.focus, minus(before, this.unproject(off)), 1);
  }

  // Draws once per frame of the screen.
  later() {
    if (this.planned) return;
    this.planned = true;
    requestAnimationFrame(() => {
      this.planned = false;
      this.draw();
    });
  }
}
