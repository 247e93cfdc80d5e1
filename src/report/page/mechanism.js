// The mechanism in three dimensions, at the solver's positions: its bodies by name and colour, the wheel on
// the ground, the direction of travel, the steering axis, and the instantaneous centres with their lines.
const scene = record ? record.scene : null;
const allFrames = record ? record.designs.flatMap((d) => d.frames) : [];
const racks = [...new Set(allFrames.map((f) => f.rack))];
// The last design has frames; curves of the very same mechanism have none of their own.
const stations = record?.designs.length ? record.designs.at(-1).frames.length / racks.length : 0;
const standing = (state) => shownDesigns(state).filter((design) => record.designs[design].frames.length);
const frameAt = (design, place) => record.designs[design].frames[place.rack * stations + place.station];
// What the second slider moves, of an axle.
const [second] = record?.further ?? [];
const [forward, outboard, up] = scene ? scene.signs : [1, 1, 1];
const radius = scene?.wheel_radius ?? null;
// Where the study does not say how large the wheel is, a dashed circle shows only where it is.
const ASSUMED_RADIUS = { mm: 300, m: 0.3, in: 12 };
const drawnRadius = radius ?? ASSUMED_RADIUS[record?.length_unit];
const ROUND = 72;

// The wheels of a placement: one, or both of an axle.
const wheelsOf = (p) => [
  { ...p, centre: p.points[scene.wheel_centre], side: 1 },
  ...(p.right ? [{ ...p.right, centre: p.points[scene.right_wheel_centre], side: -1 }] : []),
];
const isAxle = scene?.right_wheel_centre != null;
// Bodies of the right wheel follow those of the left one and look like them.
const bodiesPerSide = scene ? scene.bodies.length / (isAxle ? 2 : 1) : 0;

// A wheel, or another circle about its centre, normal to the spin axis.
const rim = ({ centre, spin_axis: n }, r = drawnRadius) => {
  const across = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  const unit = (v) => v.map((x) => x / Math.hypot(...v));
  const first = unit(across(n, [0, 0, 1]));
  const second = across(n, first);
  return Array.from({ length: ROUND + 1 }, (_, i) => {
    const [cosine, sine] = [Math.cos((2 * Math.PI * i) / ROUND), Math.sin((2 * Math.PI * i) / ROUND)];
    return centre.map((p, k) => p + r * (cosine * first[k] + sine * second[k]));
  });
};

// Points as coordinates; null breaks a line.
const coordinates = (points) => ({
  x: points.map((p) => p && p[0]), y: points.map((p) => p && p[1]), z: points.map((p) => p && p[2]),
});
const nothing = { x: [], y: [], z: [] };
const linesOf = (placement, body) => body.lines.flatMap((line) => [...line.map((i) => placement.points[i]), null]);
const offset = (p, by) => p.map((v, k) => v + by[k]);

// The road under a wheel, from the car's centre plane on, and an arrow on it to where the car goes.
const road = ({ contact: c, side }) => {
  const [x0, x1, y1] = [c[0] - 1.25 * radius, c[0] + 1.25 * radius, c[1] + 0.45 * radius * outboard * side];
  return [[x0, 0, c[2]], [x1, 0, c[2]], [x1, y1, c[2]], [x0, y1, c[2]]];
};
const arrow = ({ contact: c }) => {
  const at = (x, y) => offset(c, [x * radius * forward, y * radius, 0]);
  return [at(1.1, 0), at(1.75, 0), at(1.6, 0.06), null, at(1.75, 0), at(1.6, -0.06)];
};

// Whether a centre is on the stage, and where: one that is not has no place there, only a direction.
const toCentre = (wheel, centre) => {
  const from = wheel.contact;
  const reach = Math.min(1, ...centre.map((v, k) => {
    const [low, high] = stageRanges()[k];
    const way = v - from[k];
    if (Math.abs(way) < 1e-9) return 1;
    return ((way > 0 ? high : low) - from[k]) / way;
  }));
  if (reach === 1) return { end: centre, barbs: [], isFar: false };
  // An arrow of fixed length from the contact point: it must not look like a place.
  const way = centre.map((v, k) => v - from[k]);
  const unit = way.map((v) => v / Math.hypot(...way));
  const across = Math.abs(unit[0]) > Math.abs(unit[1]) ? [0, 1, 0] : [1, 0, 0];
  const tip = offset(from, unit.map((v) => 0.8 * radius * v));
  const barb = (sign) => tip.map((v, k) => v - 0.12 * radius * unit[k] + sign * 0.06 * radius * across[k]);
  const barbUp = (sign) => tip.map((v, k) => v - 0.12 * radius * unit[k] + (k === 2 ? sign * 0.06 * radius : 0));
  return { end: tip, barbs: [null, barb(1), tip, barb(-1), null, barbUp(1), tip, barbUp(-1)], isFar: true };
};
const centreNames = [['roll_centre', 'roll centre'], ['front_view_centre', 'centre in front view'], ['side_view_centre', 'centre in side view']];
// Views in which the name of a centre is not upon others.
const seenIn = { roll_centre: ['front', 'oblique'], front_view_centre: ['front', 'oblique'], side_view_centre: ['side', 'oblique'] };
const centresOf = (placement, view) => wheelsOf(placement).flatMap((wheel) => centreNames.map(([key, name]) => {
  const centre = key === 'roll_centre' ? placement.roll_centre : wheel[key];
  // One at infinity has no place; its label keeps its number.
  if (!centre) return { from: wheel.contact, end: wheel.contact, barbs: [], isFar: true, text: '' };
  const { end, barbs, isFar } = toCentre(wheel, centre);
  const away = Math.hypot(...centre.map((v, k) => v - wheel.contact[k]));
  // Both wheels have one roll centre, and the names of the left one's centres are enough.
  const called = wheel.side < 0 || !seenIn[key].includes(view) ? '' : name;
  return { from: wheel.contact, end, barbs, isFar, text: isFar && called ? `to the ${called}, ${Math.round(away)} ${record.length_unit} away` : called };
}));

// Where the roll centre of an axle goes along the motion, as far as it stays on the stage.
const rollCentres = (design, place) => {
  const inside = (p) => p.every((v, k) => v >= stageRanges()[k][0] && v <= stageRanges()[k][1]);
  const path = Array.from({ length: stations }, (_, station) => frameAt(design, { ...place, station }).pose.Ok?.roll_centre ?? null);
  return path.map((p) => (p && inside(p) ? p : null));
};

// Colours of the bodies: links and arms in turn, the rest by what it is.
const bodyColours = (c) => {
  let number = 0;
  const own = { knuckle: c.carrier, strut: c.strut, spring: c.strut, rocker: c.rocker };
  const first = scene.bodies.findIndex(({ kind }) => kind === 'rocker');
  const hasOwn = (kind, k) => own[kind] && (kind !== 'rocker' || k === first);
  const left = scene.bodies.slice(0, bodiesPerSide).map(({ kind }, k) => (hasOwn(kind, k) ? own[kind] : c.hues[number++ % c.hues.length]));
  return scene.bodies.map((_, k) => left[k % bodiesPerSide]);
};
const widths = { arm: 7, link: 6, rocker: 6, strut: 10, spring: 10, knuckle: 4 };
// Names of what lies low stand below it, so that they do not meet those of links above.
const sides = { arm: 'bottom center', knuckle: 'middle right', strut: 'middle left', spring: 'middle right' };
// Where a body's name stands: about midway along its first line, further in or out by turns.
const middle = (placement, { lines: [line] }, number) => {
  const [a, b] = line.map((i) => placement.points[i]);
  const along = number % 2 ? 0.62 : 0.36;
  return a.map((v, k) => v + along * (b[k] - v));
};

// Constraints: shapes that stay, the inside of rims about the spin axis, and the gaps between members.
const places = record?.places ?? { shapes: [], rims: [], clearances: [] };
const rimLines = (p, { radius: r, ends }) => {
  const n = p.spin_axis.map((v) => v * Math.sign(p.spin_axis[1] * outboard || 1));
  const centre = p.points[scene.wheel_centre];
  const at = (end) => rim({ centre: offset(centre, n.map((v) => v * end)), spin_axis: n }, r);
  const [first, second] = ends.map(at);
  const posts = [0, ROUND / 4, ROUND / 2, (3 * ROUND) / 4].flatMap((i) => [first[i], second[i], null]);
  return [...first, null, ...second, null, ...posts];
};
// The nearest points of two members: the least of a quadratic in the unit square.
const nearest = (p, [[a, b], [c, d]]) => {
  const [p1, q1, p2, q2] = [a, b, c, d].map((i) => p.points[i]);
  const minus = (u, v) => u.map((x, k) => x - v[k]);
  const dot = (u, v) => u.reduce((sum, x, k) => sum + x * v[k], 0);
  const [u, v, w] = [minus(q1, p1), minus(q2, p2), minus(p1, p2)];
  const [uu, uv, vv, uw, vw] = [dot(u, u), dot(u, v), dot(v, v), dot(u, w), dot(v, w)];
  const clamp = (t) => Math.min(1, Math.max(0, t));
  const under = uu * vv - uv * uv;
  let s = under > 1e-12 * uu * vv ? clamp((uv * vw - vv * uw) / under) : 0.5;
  const t = clamp((uv * s + vw) / vv);
  s = clamp((uv * t - uw) / uu);
  const [x, y] = [p1.map((e, k) => e + s * u[k]), p2.map((e, k) => e + t * v[k])];
  return { x, y, gap: Math.hypot(...minus(x, y)) };
};
// Where in the motion of a design the gap of two members is smallest, by the frames there are.
const smallest = (design, { members }) => {
  const solved = record.designs[design].frames.filter((frame) => frame.pose.Ok);
  const found = solved.map((frame) => ({ frame, ...nearest(frame.pose.Ok, members) }));
  return found.reduce((least, one) => (!least || one.gap < least.gap ? one : least), null);
};
const roomOf = ({ least }, gap) => `${(gap - least).toFixed(1)} ${record.length_unit}`;
const constraintParts = (c, state) => {
  const main = shownDesigns(state).at(-1);
  const lows = places.clearances.map((clearance) => smallest(main, clearance));
  const has = places.shapes.length + places.rims.length + places.clearances.length > 0;
  if (!has) return [];
  const looks = { legendgroup: 'constraints', line: { color: c.target, width: 3 } };
  return [
    {
      at: (p) => coordinates([
        ...places.shapes.flatMap(({ lines }) => lines.flatMap((line) => [...line, null])),
        ...(radius ? places.rims.flatMap((r) => [...rimLines(p, r), null]) : []),
      ]),
      look: { mode: 'lines', name: 'constraints', showlegend: true, opacity: 0.7, ...looks, line: { ...looks.line, width: 2 } },
    },
    {
      at: (p) => coordinates(places.clearances.flatMap(({ members }) => {
        const { x, y } = nearest(p, members);
        return [x, y, null];
      })),
      look: { mode: 'lines', showlegend: false, ...looks, line: { ...looks.line, width: 6 } },
    },
    {
      at: () => ({
        ...coordinates(lows.flatMap((low) => (low ? [low.x, low.y, null] : []))),
        text: lows.flatMap((low, k) => (low ? [plain(`least room ${roomOf(places.clearances[k], low.gap)}`), '', ''] : [])),
        textfont: { color: c.target, size: 12 },
      }),
      look: { mode: 'lines+text', textposition: 'bottom center', ...looks, line: { color: c.target, width: 3, dash: 'dot' } },
    },
  ];
};

// The parts of the drawing of the design that matters: coordinates in a placement, and looks. A part without
// coordinates draws nothing.
const mainParts = (c, state) => {
  const hues = bodyColours(c);
  const words = (texts, points, colour) => ({ ...coordinates(points), text: texts.map(plain), textfont: { color: colour, size: 12 } });
  const hasWheel = (p) => radius && p.contact;
  const named = scene.bodies.slice(0, bodiesPerSide);
  const each = Array.from({ length: isAxle ? 2 : 1 }, (_, k) => k);
  // The corners of a plate for each wheel, of so many points.
  const plates = (corners, points) => each.flatMap((k) => corners.map((corner) => corner.map((i) => i + k * points)));
  return [
    {
      at: (p) => coordinates(p.points),
      look: {
        mode: 'markers', meta: 'points', marker: { size: 3.5, color: c.ink }, text: scene.points.map(plain), hoverinfo: 'all',
        hovertemplate: '%{text}<br>%{x:.2f}, %{y:.2f}, %{z:.2f}<extra></extra>',
      },
    },
    ...scene.bodies.map((body, k) => ({
      at: (p) => coordinates(linesOf(p, body)),
      look: { mode: 'lines', name: plain(body.name), legendgroup: body.name, showlegend: k < bodiesPerSide, line: { color: hues[k], width: widths[body.kind] } },
    })),
    {
      at: (p) => (state.names ? coordinates(named.map((body, number) => middle(p, body, number))) : nothing),
      look: { mode: 'text', text: named.map(({ name }) => plain(name)), textposition: named.map(({ kind }) => sides[kind] ?? 'top center'), textfont: { size: 12, color: hues } },
    },
    {
      at: (p) => coordinates(wheelsOf(p).flatMap((wheel) => [...rim(wheel), null])),
      look: {
        mode: 'lines', name: radius ? 'wheel' : 'wheel, its radius is not in the study', legendgroup: 'wheel', showlegend: true,
        line: radius ? { color: c.wheel, width: 5 } : { color: c.wheel, width: 2, dash: 'dash' },
      },
    },
    {
      at: (p) => (radius ? coordinates(wheelsOf(p).flatMap((wheel) => [...rim(wheel).slice(1), wheel.centre])) : nothing),
      look: { ...plate(plates(Array.from({ length: ROUND }, (_, i) => [i, (i + 1) % ROUND, ROUND]), ROUND + 1), c.wheel, 0.14), legendgroup: 'wheel' },
    },
    {
      at: (p) => (p.steering_axis ? coordinates(axisLine(p.steering_axis)) : nothing),
      look: {
        mode: 'lines', name: 'steering axis', showlegend: allFrames.some((f) => f.pose.Ok?.steering_axis),
        line: { color: c.target, width: 3, dash: 'dash' },
      },
    },
    {
      at: (p) => (hasWheel(p) ? coordinates(wheelsOf(p).flatMap(road)) : nothing),
      look: { ...plate(plates([[0, 1, 2], [0, 2, 3]], 4), c.road, 0.2), name: 'ground', showlegend: Boolean(radius), legendgroup: 'ground' },
    },
    { at: (p) => (hasWheel(p) ? coordinates(arrow(p)) : nothing), look: { mode: 'lines', legendgroup: 'ground', line: { color: c.ink, width: 5 } } },
    {
      at: (p) => (hasWheel(p) ? words(['forward'], [arrow(p)[1]], c.ink) : nothing),
      look: { mode: 'text', legendgroup: 'ground', textposition: 'top center' },
    },
    {
      at: (p) => (state.centres && hasWheel(p) ? coordinates(centresOf(p, state.view).flatMap(({ from, end, barbs }) => [from, end, ...barbs, null])) : nothing),
      look: { mode: 'lines', name: 'instantaneous centres', legendgroup: 'centres', showlegend: Boolean(radius && state.centres), line: { color: c.centre, width: 2.5, dash: 'dot' } },
    },
    {
      at: (p) => {
        if (!state.centres || !hasWheel(p)) return nothing;
        const found = centresOf(p, state.view);
        return { ...words(found.map(({ text }) => text), found.map(({ end }) => end), c.centre), marker: { symbol: 'diamond', color: c.centre, size: found.map(({ isFar }) => (isFar ? 0 : 5)) } };
      },
      look: { mode: 'markers+text', legendgroup: 'centres', textposition: each.flatMap(() => ['top center', 'bottom left', 'bottom right']) },
    },
    {
      at: (p, design, place) => (isAxle && state.centres ? coordinates(rollCentres(design, place)) : nothing),
      look: { mode: 'lines', name: 'path of the roll centre', legendgroup: 'centres', showlegend: Boolean(isAxle && radius && state.centres), line: { color: c.centre, width: 5 } },
    },
  ];
};
const plate = (corners, colour, opacity) => ({
  type: 'mesh3d', ...Object.fromEntries(['i', 'j', 'k'].map((name, n) => [name, corners.map((corner) => corner[n])])),
  color: colour, opacity, flatshading: true, lighting: { ambient: 1, diffuse: 0, specular: 0 },
});
const axisLine = ([a, b]) => [-0.3, 1.1].map((t) => a.map((v, k) => v + t * (b[k] - v)));

// A design to compare with: all of it in one colour.
const formerParts = (c) => [
  {
    at: (p) => coordinates(scene.bodies.flatMap((body) => linesOf(p, body))),
    look: { mode: 'lines', showlegend: true, line: { color: c.before, width: 3 }, opacity: 0.7 },
  },
  {
    at: (p) => (radius ? coordinates(wheelsOf(p).flatMap((wheel) => [...rim(wheel), null])) : nothing),
    look: { mode: 'lines', line: { color: c.before, width: 2 }, opacity: 0.7 },
  },
];

const stageParts = (c, state) => standing(state).flatMap((design) => {
  const { label } = record.designs[design];
  const [parts, prefix] = isMain(state, design) ? [[...mainParts(c, state), ...constraintParts(c, state)], ''] : [formerParts(c), label];
  return parts.map(({ at, look }) => ({ design, at, look: { type: 'scatter3d', hoverinfo: 'skip', showlegend: false, ...(prefix && { name: plain(prefix), legendgroup: prefix }), ...look } }));
});
const placed = ({ design, at }, place) => {
  const { Ok: placement } = frameAt(design, place).pose;
  return placement ? at(placement, design, place) : nothing;
};

// The part of space that everything stays in: the same for every place of the motion.
let knownRanges = null;
const stageRanges = () => {
  if (knownRanges) return knownRanges;
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  for (const frame of allFrames) {
    const placement = frame.pose.Ok;
    if (!placement) continue;
    const wheels = wheelsOf(placement);
    const ground = radius && placement.contact ? [...wheels.flatMap(road), ...arrow(placement).filter(Boolean)] : [];
    for (const p of [...placement.points, ...wheels.flatMap((wheel) => rim(wheel)), ...ground]) {
      for (let k = 0; k < 3; k += 1) {
        low[k] = Math.min(low[k], p[k]);
        high[k] = Math.max(high[k], p[k]);
      }
    }
  }
  const margin = 0.04 * Math.max(...high.map((h, k) => h - low[k]));
  knownRanges = low.map((l, k) => [l - margin, high[k] + margin]);
  return knownRanges;
};

const views = {
  oblique: { eye: { x: 1.1 * forward, y: 1.35 * outboard, z: 0.55 * up }, up: { x: 0, y: 0, z: up } },
  front: { eye: { x: 2 * forward, y: 0, z: 0 }, up: { x: 0, y: 0, z: up } },
  side: { eye: { x: 0, y: 2 * outboard, z: 0 }, up: { x: 0, y: 0, z: up } },
  top: { eye: { x: 0, y: 0, z: 2 * up }, up: { x: forward, y: 0, z: 0 } },
};
// The axis along which one looks would be a heap of numbers.
const hiddenAxis = { front: 'xaxis', side: 'yaxis', top: 'zaxis' };
const camera = (view) => ({ ...views[view], center: { x: 0, y: 0, z: 0 }, projection: { type: 'orthographic' } });

const stage = byId('mechanism-plot');
const drawStage = async (state) => {
  if (!stations) return;
  const c = colours();
  const traces = stageParts(c, state).map((part) => ({ ...part.look, ...placed(part, state.place) }));
  const ranges = stageRanges();
  const spans = ranges.map(([l, h]) => h - l);
  const scale = 1.75 / Math.max(...spans);
  const stageAxis = (name, k) => ({
    visible: hiddenAxis[state.view] !== `${name}axis`,
    title: { text: `${name} [${record.length_unit}]` }, range: ranges[k], gridcolor: c.rule, zeroline: false,
    showbackground: false, color: c.muted, showspikes: false, nticks: 6,
  });
  await draw(stage, traces, layout(c, {
    margin: { l: 0, r: 0, t: 0, b: 0 },
    legend: { x: 0.005, y: 0.995, itemsizing: 'constant', bgcolor: 'rgba(0,0,0,0)' },
    uirevision: 'stage',
    scene: {
      xaxis: stageAxis('x', 0), yaxis: stageAxis('y', 1), zaxis: stageAxis('z', 2), dragmode: 'orbit',
      aspectmode: 'manual', aspectratio: { x: spans[0] * scale, y: spans[1] * scale, z: spans[2] * scale },
      camera: camera(state.view),
    },
  }));
  sayPlace(state);
};

// Where the slider is, in words, and what the plot then shows, for those who cannot see it.
const sayPlace = (state) => {
  const { place } = state;
  const frames = standing(state).map((design) => [record.designs[design].label, frameAt(design, place)]);
  const failed = frames.map(([label, f]) => (f.pose.Err ? `${label} not solved: ${f.pose.Err}` : ''));
  const [name, unit] = axisTitle(record.drive).split(/ (?=\[)/);
  const [[, now]] = frames;
  byId('station-text').textContent = [`${name} ${brief(now.drive)} ${unit.slice(1, -1)}`, ...failed.filter(Boolean)].join('; ');
  byId('rack-text').textContent = `${brief(now.rack)} ${second ? axisTitle(second).slice(axisTitle(second).indexOf('[') + 1, -1) : record.length_unit}`;
  const shown = stage.data.findLast((trace) => trace.meta === 'points');
  const centre = [shown.x, shown.y, shown.z].map((list) => list[scene.wheel_centre]);
  root.dataset.station = place.station;
  root.dataset.wheelCentre = centre.join(' ');
};

const moveStage = async (state) => {
  const at = stageParts(colours(), state).map((part) => placed(part, state.place));
  const each = (name) => at.map((p) => p[name]);
  const marks = at.map((p, k) => [p, k]).filter(([p]) => p.text);
  await Plotly.restyle(stage, { x: each('x'), y: each('y'), z: each('z') });
  if (marks.length) {
    await Plotly.restyle(stage, { text: marks.map(([p]) => p.text), 'marker.size': marks.map(([p]) => p.marker?.size ?? 4) }, marks.map(([, k]) => k));
  }
  sayPlace(state);
};

// The controls of the stage.
const setUpStage = (state) => {
  for (const [name, most] of [['station', stations], ['rack', racks.length]]) {
    const slider = byId(name);
    slider.max = Math.max(0, most - 1);
    slider.value = state.place[name];
    slider.addEventListener('input', () => {
      state.place[name] = Number(slider.value);
      moveStage(state);
      if (isAxle) drawTurn(state);
    });
  }
  byId('rack-label').hidden = racks.length < 2;
  if (second) byId('rack-name').textContent = axisTitle(second).replace(/ \[.*$/, '');
  for (const button of document.querySelectorAll('[data-view]')) {
    button.addEventListener('click', () => {
      state.view = button.dataset.view;
      const seen = ['xaxis', 'yaxis', 'zaxis'].map((name) => [`scene.${name}.visible`, hiddenAxis[state.view] !== name]);
      Plotly.relayout(stage, { 'scene.camera': camera(state.view), ...Object.fromEntries(seen) }).then(() => moveStage(state));
    });
  }
  for (const button of document.querySelectorAll('[data-shows]')) {
    const name = button.dataset.shows;
    button.setAttribute('aria-pressed', state[name]);
    button.addEventListener('click', () => {
      state[name] = !state[name];
      button.setAttribute('aria-pressed', state[name]);
      drawStage(state);
    });
  }
  // Playing goes up and down the motion until it is stopped.
  let playing = null;
  let direction = 1;
  byId('play').addEventListener('click', () => {
    if (playing) {
      clearInterval(playing);
      playing = null;
    } else if (stations > 1) {
      playing = setInterval(() => {
        const next = state.place.station + direction;
        if (next < 0 || next >= stations) direction = -direction;
        state.place.station += direction;
        byId('station').value = state.place.station;
        moveStage(state);
      }, 60);
    }
    byId('play').textContent = playing ? 'stop' : 'play';
    byId('play').setAttribute('aria-pressed', playing !== null);
  });
};

// What the stage shows at first; `#station=5` and the like choose.
const wished = (name, most, otherwise) => {
  const number = parseInt(wishes.get(name), 10);
  return number >= 0 && number < most ? number : otherwise;
};
const nearestToDesign = () => {
  const drives = Array.from({ length: stations }, (_, station) => Math.abs(frameAt(record.designs.length - 1, { station, rack: 0 }).drive));
  return Math.max(0, drives.indexOf(Math.min(...drives)));
};
const stageState = () => ({
  view: views[wishes.get('view')] ? wishes.get('view') : 'oblique',
  // The legend names the bodies as well; where there are many their names lie on each other.
  names: bodiesPerSide <= 5,
  centres: true,
  place: {
    station: wished('station', stations, nearestToDesign()),
    rack: wished('rack', racks.length, Math.max(0, racks.indexOf(Math.min(...racks.map(Math.abs))))),
  },
});
