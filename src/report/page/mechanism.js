// The mechanism in three dimensions, at the solver's positions.
const { scene } = record;
const racks = [...new Set(record.designs.flatMap((d) => d.frames.map((f) => f.rack)))];
const stations = record.designs.length ? record.designs[0].frames.length / racks.length : 0;
const frameAt = (design, place) => record.designs[design].frames[place.rack * stations + place.station];
const [forward, outboard, up] = scene.signs;
const ROUND = 72;

// The wheel's rim: centre and a circle normal to the spin axis.
const rim = ({ points, spin_axis: n }) => {
  const centre = points[scene.wheel_centre];
  const across = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  const unit = (v) => v.map((x) => x / Math.hypot(...v));
  const first = unit(across(n, [0, 0, 1]));
  const second = across(n, first);
  return Array.from({ length: ROUND + 1 }, (_, i) => {
    const [cosine, sine] = [Math.cos((2 * Math.PI * i) / ROUND), Math.sin((2 * Math.PI * i) / ROUND)];
    return centre.map((p, k) => p + scene.wheel_radius * (cosine * first[k] + sine * second[k]));
  });
};

// Points as coordinates; null breaks a line.
const coordinates = (points) => ({
  x: points.map((p) => p && p[0]), y: points.map((p) => p && p[1]), z: points.map((p) => p && p[2]),
});
const lines = (placement, ...kinds) => {
  const members = scene.members.filter((m) => kinds.includes(m.kind));
  return coordinates(members.flatMap((m) => [...m.through.map((i) => placement.points[i]), null]));
};
const nothing = { x: [], y: [], z: [] };

// The parts of the drawing: each gives its coordinates in a placement and its looks.
const parts = [
  {
    at: (p) => coordinates(p.points),
    look: (c, colour) => ({
      mode: 'markers', marker: { size: 4, color: colour }, text: scene.points.map(plain),
      hovertemplate: '%{text}<br>%{x:.2f}, %{y:.2f}, %{z:.2f}',
    }),
  },
  { at: (p) => lines(p, 'arm', 'link', 'rocker'), look: (c, colour) => ({ mode: 'lines', line: { color: colour, width: 5 } }) },
  { at: (p) => lines(p, 'strut', 'spring'), look: (c, colour) => ({ mode: 'lines', line: { color: colour, width: 9 } }) },
  { at: (p) => lines(p, 'knuckle'), look: (c, colour) => ({ mode: 'lines', line: { color: colour, width: 2 } }) },
  {
    at: (p) => (scene.wheel_radius ? coordinates(rim(p)) : nothing),
    look: (c, colour) => ({ mode: 'lines', line: { color: colour, width: 4 } }),
  },
  {
    at: (p) => (scene.wheel_radius ? coordinates([...rim(p).slice(1), p.points[scene.wheel_centre]]) : nothing),
    look: (c, colour) => {
      const k = Array.from({ length: ROUND }, (_, i) => i);
      return { type: 'mesh3d', i: k, j: k.map((n) => (n + 1) % ROUND), k: k.map(() => ROUND), color: colour, opacity: 0.08, flatshading: true, lighting: { ambient: 1, diffuse: 0, specular: 0 } };
    },
  },
  {
    at: (p) => {
      if (!p.steering_axis) return nothing;
      const [a, b] = p.steering_axis;
      const along = (t) => a.map((v, k) => v + t * (b[k] - v));
      return coordinates([along(-0.3), along(1.1)]);
    },
    look: (c) => ({ mode: 'lines', line: { color: c.target, width: 3, dash: 'dash' } }),
  },
];

const placementTraces = (design, place) => {
  const { Ok: placement } = frameAt(design, place).pose;
  return parts.map((part) => (placement ? part.at(placement) : nothing));
};

const stageRanges = () => {
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  for (const frame of record.designs.flatMap((d) => d.frames)) {
    const placement = frame.pose.Ok;
    if (!placement) continue;
    for (const p of [...placement.points, ...(scene.wheel_radius ? rim(placement) : [])]) {
      for (let k = 0; k < 3; k += 1) {
        low[k] = Math.min(low[k], p[k]);
        high[k] = Math.max(high[k], p[k]);
      }
    }
  }
  const margin = 0.04 * Math.max(...high.map((h, k) => h - low[k]));
  return low.map((l, k) => [l - margin, high[k] + margin]);
};

const views = {
  oblique: { eye: { x: 1.1 * forward, y: 1.35 * outboard, z: 0.55 * up }, up: { x: 0, y: 0, z: up } },
  front: { eye: { x: 2 * forward, y: 0, z: 0 }, up: { x: 0, y: 0, z: up } },
  side: { eye: { x: 0, y: 2 * outboard, z: 0 }, up: { x: 0, y: 0, z: up } },
  top: { eye: { x: 0, y: 0, z: 2 * up }, up: { x: forward, y: 0, z: 0 } },
};
const camera = (view) => ({ ...views[view], center: { x: 0, y: 0, z: 0 }, projection: { type: 'orthographic' } });

const stage = byId('mechanism-plot');
const drawStage = async (state) => {
  if (!stations) return;
  const c = colours();
  const traces = record.designs.flatMap((design, d) => placementTraces(d, state.place).map((at, k) => ({
    type: 'scatter3d', name: design.label, legendgroup: design.label, showlegend: k === 1, hoverinfo: k ? 'skip' : 'all',
    opacity: isLast(d) ? 1 : 0.55, ...parts[k].look(c, isLast(d) ? c.accent : c.before), ...at,
  })));
  const ranges = stageRanges();
  const spans = ranges.map(([l, h]) => h - l);
  const scale = 1.6 / Math.max(...spans);
  const stageAxis = (name, k) => ({
    title: { text: `${name} [${record.length_unit}]` }, range: ranges[k], gridcolor: c.rule, zeroline: false,
    showbackground: false, color: c.muted, showspikes: false,
  });
  await draw(stage, traces, layout(c, {
    margin: { l: 0, r: 0, t: 0, b: 0 },
    legend: { x: 0.01, y: 0.99 },
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
const sayPlace = ({ place }) => {
  const frames = record.designs.map((_, design) => frameAt(design, place));
  const failed = frames.map((f, d) => (f.pose.Err ? `${record.designs[d].label} not solved: ${f.pose.Err}` : ''));
  const [name, unit] = axisTitle(record.drive).split(/ (?=\[)/);
  byId('station-text').textContent = [`${name} ${brief(frames[0].drive)} ${unit.slice(1, -1)}`, ...failed.filter(Boolean)].join('; ');
  byId('rack-text').textContent = `${brief(frames[0].rack)} ${record.length_unit}`;
  const shown = stage.data[(record.designs.length - 1) * parts.length];
  const centre = [shown.x, shown.y, shown.z].map((list) => list[scene.wheel_centre]);
  root.dataset.station = place.station;
  root.dataset.wheelCentre = centre.join(' ');
};

const moveStage = async (state) => {
  const at = record.designs.flatMap((_, design) => placementTraces(design, state.place));
  const each = (name) => at.map((p) => p[name]);
  await Plotly.restyle(stage, { x: each('x'), y: each('y'), z: each('z') });
  sayPlace(state);
};
