// Mechanism of a report at the positions from the solver. It uses the view of the studio, moves along the motion, and also shows
// centres, constraints and the other designs.
const scene = record ? record.scene : null;
const allFrames = record ? record.designs.flatMap((d) => d.frames) : [];
const racks = [...new Set(allFrames.map((f) => f.rack))];
// The last design always has frames (poses for the drawing). A design with the same mechanism as the last one has no frames.
const stations = record?.designs.length ? record.designs.at(-1).frames.length / racks.length : 0;
const frameAt = (design, place) => record.designs[design].frames[place.rack * stations + place.station];
const [forward, outboard, up] = scene ? scene.signs : [1, 1, 1];
const isAxle = scene?.right_wheel_centre != null;
const radius = scene?.wheel_radius ?? null;
// Radius of a dashed circle that marks the position of the wheel if the study gives no wheel radius.
const ASSUMED_RADIUS = { mm: 300, m: 0.3, in: 12 };
// Column of the second slider.
const secondColumn = record?.further?.[0] ?? record?.rack ?? null;

// Wheels of a placement: one wheel, or both wheels of an axle.
const wheelsOf = (p) => [
  { ...p, centre: p.points[scene.wheel_centre] },
  ...(p.right ? [{ ...p.right, centre: p.points[scene.right_wheel_centre] }] : []),
];
const rimOf = ({ centre, spin_axis: n }) => circle(centre, n, radius ?? ASSUMED_RADIUS[record.length_unit]);

const centreNames = [['roll_centre', 'roll centre'], ['front_view_centre', 'centre in front view'], ['side_view_centre', 'centre in side view']];
// Views in which a centre has a meaning.
const seenIn = { roll_centre: ['front', 'space'], front_view_centre: ['front', 'space'], side_view_centre: ['side', 'space'] };

// Nearest points of two members: the minimum of a quadratic function over the unit square.
const nearestOf = (p, [[a, b], [c, d]]) => {
  const [p1, q1, p2, q2] = [a, b, c, d].map((i) => p.points[i]);
  const [u, v, w] = [minus(q1, p1), minus(q2, p2), minus(p1, p2)];
  const [uu, uv, vv, uw, vw] = [dot(u, u), dot(u, v), dot(v, v), dot(u, w), dot(v, w)];
  const clamp = (t) => Math.min(1, Math.max(0, t));
  const under = uu * vv - uv * uv;
  let s = under > 1e-12 * uu * vv ? clamp((uv * vw - vv * uw) / under) : 0.5;
  const t = clamp((uv * s + vw) / vv);
  s = clamp((uv * t - uw) / uu);
  const [x, y] = [along(p1, u, s), along(p2, v, t)];
  return { x, y, gap: norm(minus(x, y)) };
};
const places = record?.places ?? { shapes: [], rims: [], clearances: [] };

class ReportView extends MechanismView {
  constructor(element) {
    super({ name: 'space', title: 'The mechanism. Drag to turn it, arrow keys turn it, plus and minus zoom.', basis: null, scene: () => scene, layers: ['grid', 'former', 'bodies', 'limits', 'marks', 'dots', 'words'] });
    this.isInPage = true;
    this.shows = { names: scene.bodies.length <= 12, centres: true };
    // The main design is the last one with a drawing.
    this.designs = record.designs.map((_, k) => k).filter((k) => record.designs[k].frames.length);
    this.place = { station: 0, rack: 0 };
    set(this.svg, { tabindex: 0 });
    this.svg.addEventListener('keydown', (event) => this.keyOfPicture(event));
    const layer = (name, kind) => this.layers[name].appendChild(svg('path', { class: kind }));
    this.former = this.designs.slice(0, -1).map(() => ({ bodies: this.linesIn('former', 'plain'), rim: layer('former', 'rim') }));
    this.ground = layer('bodies', 'ground');
    this.rims = [0, 1].map(() => layer('bodies', radius ? 'rim' : 'rim unknown'));
    this.axis = layer('bodies', 'axis');
    this.bodies = this.linesIn('bodies');
    this.bodies.forEach((path, k) => path.append(svg('title', { text: scene.bodies[k].name })));
    this.rollPath = layer('marks', 'roll-path');
    element.append(this.svg);
  }

  pose(design) { return frameAt(design, this.place).pose.Ok ?? null; }

  fit() {
    const all = this.designs.flatMap((design) => record.designs[design].frames).map((frame) => frame.pose.Ok).filter(Boolean);
    // All positions of the motion have the same scale.
    this.fitTo(all.flatMap((p) => [...p.points, ...wheelsOf(p).flatMap(rimOf)]));
    if (!this.basis) this.scale *= 0.86;
  }

  show(name) {
    this.name = name;
    this.basis = flat[name] ?? null;
    this.fit();
    this.draw();
  }

  draw() {
    if (!this.width || !this.designs.length) return;
    this.look = this.turned();
    this.drawGrid();
    const main = this.pose(this.designs.at(-1));
    const others = this.designs.slice(0, -1);
    this.former.forEach(({ bodies, rim: path }, k) => {
      const p = k < others.length ? this.pose(others[k]) : null;
      this.showBodies(bodies, p);
      path.setAttribute('d', p ? wheelsOf(p).map((wheel) => this.path(rimOf(wheel), true)).join('') : '');
    });
    this.showBodies(this.bodies, main);
    const wheels = main ? wheelsOf(main) : [];
    this.rims.forEach((path, k) => path.setAttribute('d', wheels[k] ? this.path(rimOf(wheels[k]), true) : ''));
    this.showGround(this.ground, wheels.map(({ contact }) => contact).filter(Boolean));
    const axis = main?.steering_axis;
    this.axis.setAttribute('d', axis ? this.path([-0.35, 1.12].map((t) => along(axis[0], minus(axis[1], axis[0]), t))) : '');
    this.layers.dots.replaceChildren(...(main?.points ?? []).map((p, k) => {
      const [x, y] = this.project(p);
      return svg('circle', { cx: x.toFixed(1), cy: y.toFixed(1), r: 3 }, svg('title', { text: `${scene.points[k]}: ${p.map((c) => brief(c)).join(', ')} ${record.length_unit}` }));
    }));
    this.drawLimits(main);
    this.drawMarks(main, wheels);
  }

  // Draws constraints: shapes that do not move, and gaps between members with their margins.
  drawLimits(main) {
    const { limits } = this.layers;
    limits.replaceChildren();
    this.gapWords = [];
    if (!main) return;
    for (const { name, lines } of places.shapes) limits.append(svg('path', { d: lines.map((line) => this.path(line)).join('') }, svg('title', { text: name })));
    const centre = main.points[scene.wheel_centre];
    const n = main.spin_axis.map((v) => v * Math.sign(main.spin_axis[1] * outboard || 1));
    for (const { name, radius: r, ends } of radius ? places.rims : []) {
      const rings = ends.map((end) => circle(along(centre, n, end), n, r));
      const posts = [0, 16, 32, 48].map((k) => this.path(rings.map((ring) => ring[k])));
      limits.append(svg('path', { d: rings.map((ring) => this.path(ring, true)).join('') + posts.join('') }, svg('title', { text: name })));
    }
    for (const { name, members, least } of places.clearances) {
      const { x, y, gap } = nearestOf(main, members);
      limits.append(svg('path', { class: gap < least ? 'gap violated' : 'gap', d: this.path([x, y]) }, svg('title', { text: name })));
      this.gapWords.push({ text: `margin ${brief(gap - least, 3)} ${record.length_unit}`, at: this.project(x), kind: gap < least ? 'violated' : 'limit' });
    }
  }

  // Draws instantaneous centres. For a centre outside the picture, an arrow at the edge points to the centre, with the distance
  // beside it.
  centres(main, wheels) {
    const found = [];
    wheels.forEach((wheel, side) => {
      for (const [key, name] of centreNames) {
        if (key === 'roll_centre' && side) continue;
        const centre = key === 'roll_centre' ? main.roll_centre : wheel[key];
        if (!centre || !wheel.contact || !seenIn[key].includes(this.name)) continue;
        const [from, to] = [wheel.contact, centre].map((p) => this.project(p));
        const room = 16;
        const shares = to.map((c, k) => {
          const most = (k ? this.height : this.width) - room;
          const way = c - from[k];
          return Math.abs(way) < 1e-9 ? 1 : Math.max(0, ((way > 0 ? most : room) - from[k]) / way);
        });
        const share = Math.min(1, ...shares);
        const end = from.map((c, k) => c + share * (to[k] - c));
        const far = `${Math.round(norm(minus(centre, wheel.contact)))} ${record.length_unit} away`;
        const called = side ? `right ${name}` : name;
        found.push({ from, end, isFar: share < 1, text: share < 1 ? `${called}, ${far}` : called });
      }
    });
    return found;
  }

  drawMarks(main, wheels) {
    const { marks, words } = this.layers;
    marks.replaceChildren(this.rollPath);
    const names = [];
    const inside = ([x, y]) => x > 0 && y > 0 && x < this.width && y < this.height;
    const shown = main && this.shows.centres ? this.centres(main, wheels) : [];
    for (const { from, end, isFar, text } of shown) {
      const [a, b] = [from, end].map((p) => p.map((c) => c.toFixed(1)).join(' '));
      marks.append(svg('path', { class: 'to-centre', d: `M${a}L${b}` }));
      if (isFar) {
        const way = end.map((c, k) => c - from[k]);
        const unit = way.map((c) => c / (Math.hypot(...way) || 1));
        const barb = (sign) => `${(end[0] - 9 * unit[0] - sign * 5 * unit[1]).toFixed(1)} ${(end[1] - 9 * unit[1] + sign * 5 * unit[0]).toFixed(1)}`;
        marks.append(svg('path', { class: 'centre', d: `M${barb(1)}L${b}L${barb(-1)}` }));
      } else marks.append(svg('path', { class: 'centre', d: `M${(end[0] - 6).toFixed(1)} ${end[1].toFixed(1)}h12m-6 -6v12` }));
      names.push({ text, at: end, kind: 'centre' });
    }
    const path = isAxle && this.shows.centres && this.name !== 'side' && this.name !== 'top' ? Array.from({ length: stations }, (_, station) => frameAt(this.designs.at(-1), { ...this.place, station }).pose.Ok?.roll_centre ?? null) : [];
    const inPicture = path.map((p) => p && this.project(p)).filter((p) => p && inside(p)).map((p) => p.map((c) => c.toFixed(1)).join(' '));
    this.rollPath.setAttribute('d', inPicture.length ? `M${inPicture.join('L')}` : '');
    names.push(...this.gapWords);
    if (main && this.shows.names) {
      const each = isAxle ? scene.bodies.slice(0, scene.bodies.length / 2) : scene.bodies;
      each.forEach(({ name, lines: [line] }, k) => {
        const [p, q] = line.map((i) => main.points[i]);
        names.push({ text: name, at: this.project(along(p, minus(q, p), k % 2 ? 0.62 : 0.36)), kind: 'body' });
      });
    }
    const dots = (main?.points ?? []).map((p) => this.project(p));
    words.replaceChildren(...placeNames(names, dots, [this.width, this.height]).flatMap(({ text, x, y, leader, kind }) => [
      ...(leader ? [svg('path', { class: 'leader', d: `M${leader.map((p) => p.map((c) => c.toFixed(1)).join(' ')).join('L')}` })] : []),
      svg('text', { class: kind, x: x.toFixed(1), y: y.toFixed(1), text }),
    ]));
  }
}

let stage = null;

// Tells screen readers the position of the slider and the positions in the drawing.
const sayPlace = () => {
  const { place } = stage;
  const frames = stage.designs.map((design) => [record.designs[design].label, frameAt(design, place)]);
  const failed = frames.filter(([, f]) => f.pose.Err).map(([label, f]) => `${label} not solved: ${f.pose.Err}`);
  const now = frames.at(-1)[1];
  const { name, unit } = axisName(record.drive);
  byId('station-text').textContent = [`${name} ${brief(now.drive)} ${unit}`, ...failed].join('; ');
  byId('rack-text').textContent = `${brief(now.rack)} ${secondColumn ? axisName(secondColumn).unit : record.length_unit}`;
  for (const [id, value] of [['station', place.station], ['rack', place.rack]]) {
    byId(id).value = value;
    set(byId(id), { 'aria-valuetext': byId(`${id}-text`).textContent });
  }
  root.dataset.station = place.station;
  if (now.pose.Ok) root.dataset.wheelCentre = now.pose.Ok.points[scene.wheel_centre].join(' ');
};
const moveStage = () => {
  stage.draw();
  sayPlace();
  if (typeof drawTurn === 'function') drawTurn(stage.place);
};
const placeOf = (name) => {
  const now = frameAt(stage.designs.at(-1), stage.place);
  return name === record.drive ? now.drive : now.rack;
};
// Values of a slider: drive values of the stations, or rack displacements.
const valuesOf = (name) => (name === record.drive
  ? Array.from({ length: stations }, (_, station) => frameAt(stage.designs.at(-1), { station, rack: 0 }).drive)
  : racks);
const nearestIn = (values, wanted) => values.reduce((best, v, k) => (Math.abs(v - wanted) < Math.abs(values[best] - wanted) ? k : best), 0);

// Station or rack displacement at the start. The address of the page can choose it, as in `#station=5`.
const wished = (name, most, otherwise) => {
  const number = parseInt(wishes.get(name), 10);
  return number >= 0 && number < most ? number : otherwise;
};

const setUpStage = () => {
  if (byId('mechanism')) byId('mechanism').hidden = !stations;
  if (!stations) return;
  stage = new ReportView(byId('mechanism-plot'));
  stage.place = { station: wished('station', stations, nearestIn(valuesOf(record.drive), 0)), rack: wished('rack', racks.length, nearestIn(racks, 0)) };
  stage.measure();
  stage.show(flat[wishes.get('view')] ? wishes.get('view') : 'space');
  noteDrawn(byId('mechanism-plot'));
  for (const [id, most, name] of [['station', stations, record.drive], ['rack', racks.length, secondColumn]]) {
    const slider = byId(id);
    slider.max = Math.max(0, most - 1);
    slider.addEventListener('input', () => {
      stage.place[id] = Number(slider.value);
      moveStage();
      if (name) point(name, placeOf(name), stage);
    });
  }
  byId('rack-label').hidden = racks.length < 2;
  if (secondColumn) byId('rack-name').textContent = axisName(secondColumn).name;
  // The mechanism moves to the position at which the user points in a chart.
  followers.add((name, value, from) => {
    if (value === null || from === stage || (name !== record.drive && name !== secondColumn)) return;
    stage.place[name === record.drive ? 'station' : 'rack'] = nearestIn(valuesOf(name), value);
    moveStage();
  });
  const views = document.querySelectorAll('[data-view]');
  const say = () => views.forEach((button) => button.setAttribute('aria-pressed', button.dataset.view === stage.name));
  for (const button of views) button.addEventListener('click', () => { stage.show(button.dataset.view); say(); });
  say();
  for (const button of document.querySelectorAll('[data-shows]')) {
    const name = button.dataset.shows;
    button.setAttribute('aria-pressed', stage.shows[name]);
    button.addEventListener('click', () => {
      stage.shows[name] = !stage.shows[name];
      button.setAttribute('aria-pressed', stage.shows[name]);
      stage.draw();
    });
  }
  // Playing moves the mechanism back and forth along the motion until the user stops it.
  let playing = null;
  let direction = 1;
  byId('play').addEventListener('click', () => {
    if (playing) {
      clearInterval(playing);
      playing = null;
    } else if (stations > 1) {
      playing = setInterval(() => {
        const next = stage.place.station + direction;
        if (next < 0 || next >= stations) direction = -direction;
        stage.place.station += direction;
        moveStage();
        point(record.drive, placeOf(record.drive), stage);
      }, 60);
    }
    byId('play').textContent = playing ? 'stop' : 'play';
    byId('play').setAttribute('aria-pressed', playing !== null);
  });
  moveStage();
};
