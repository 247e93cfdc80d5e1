// Curves over the drive: now, as opened, wanted, and a proposal beside them.
import { brief, byId, html, set, signed, svg, ticks } from './draw.js';
import { ask, askGhost, emit, here as placeNow, isInGesture, on, state } from './design.js';

const MARGIN = { left: 46, right: 10, top: 8, bottom: 22 };
let charts = [];

// Stations of one group by rising drive value, in runs without gaps.
const runs = (answer, values, group) => {
  const places = answer.drive.map((x, i) => i).filter((i) => answer.groups[i] === group && answer.drive[i] !== null);
  places.sort((a, b) => answer.drive[a] - answer.drive[b]);
  const found = [];
  let run = [];
  for (const i of places) {
    if (values[i] === null) {
      if (run.length) found.push(run);
      run = [];
    } else run.push([answer.drive[i], values[i]]);
  }
  if (run.length) found.push(run);
  return found;
};
const groupsOf = (answer) => [...new Set(answer.groups)];

// The value of a curve at a drive value, by straight lines between stations.
const at = (pieces, x) => {
  for (const piece of pieces) {
    for (let i = 1; i < piece.length; i += 1) {
      const [[x0, y0], [x1, y1]] = [piece[i - 1], piece[i]];
      if (x >= x0 && x <= x1) return x1 === x0 ? y0 : y0 + ((y1 - y0) * (x - x0)) / (x1 - x0);
    }
    if (piece.length === 1 && piece[0][0] === x) return piece[0][1];
  }
  return null;
};

// Targets of a column in the study's own motion, for the rack that is shown.
const targetsOf = (column, rack) => state.overview.targets.filter((target) => target.columns.includes(column)
  && target.is_drawn && (!target.racks.length || target.racks.includes(rack)));

class Chart {
  constructor(column) {
    this.column = column;
    this.title = html('b');
    this.unit = html('span', { class: 'unit' });
    this.value = html('output');
    this.range = html('small');
    this.svg = svg('svg', { class: 'chart', role: 'img' });
    this.parts = Object.fromEntries(['axes', 'bands', 'ghosts', 'others', 'influence', 'proposal', 'now', 'gaps', 'cursor']
      .map((name) => [name, this.svg.appendChild(svg('g', { class: name }))]));
    this.now = this.parts.now.appendChild(svg('path'));
    this.old = this.parts.ghosts.appendChild(svg('path'));
    this.proposed = this.parts.proposal.appendChild(svg('path'));
    this.moved = this.parts.influence.appendChild(svg('path'));
    this.line = this.parts.cursor.appendChild(svg('path'));
    this.spot = this.parts.cursor.appendChild(svg('circle', { r: 3.5 }));
    this.figure = html('figure', { class: 'chartbox', 'data-column': column },
      html('figcaption', {}, this.title, this.unit, this.value, this.range), this.svg);
    const point = (event) => {
      const box = this.svg.getBoundingClientRect();
      const [low, high] = this.xs;
      const x = low + ((event.clientX - box.x - MARGIN.left) / this.inner[0]) * (high - low);
      state.at[state.overview.main] = Math.max(low, Math.min(high, x));
      emit('place', event);
    };
    this.svg.addEventListener('pointerdown', (event) => {
      this.svg.setPointerCapture(event.pointerId);
      this.held = true;
      point(event);
    });
    this.svg.addEventListener('pointermove', (event) => { if (this.held) point(event); });
    for (const name of ['pointerup', 'pointercancel']) this.svg.addEventListener(name, () => { this.held = false; });
    // Measured when it changes: to ask while drawing would lay the page out once for each chart.
    new ResizeObserver(([{ contentRect: { width, height } }]) => {
      this.size = { width, height };
      this.frame = null;
      this.draw();
    }).observe(this.svg);
  }

  // The frame holds everything; while a point is dragged it grows but does not shrink, so that curves move and
  // not their axes.
  fitted(values) {
    let [low, high] = [Math.min(...values), Math.max(...values)];
    if (!Number.isFinite(low)) [low, high] = [-1, 1];
    const least = Math.max(1e-9, 1e-6 * Math.max(Math.abs(low), Math.abs(high)));
    if (high - low < least) [low, high] = [low - Math.max(least, 0.05 * Math.abs(low), 0.05), high + Math.max(least, 0.05 * Math.abs(high), 0.05)];
    const room = 0.07 * (high - low);
    const wanted = [low - room, high + room];
    if (isInGesture() && this.ys) return [Math.min(this.ys[0], wanted[0]), Math.max(this.ys[1], wanted[1])];
    return wanted;
  }

  draw() {
    const { answer, ghost, proposed, influence } = state;
    const found = answer?.columns.find((c) => c.column === this.column);
    if (!found) return;
    const { width, height } = this.size ??= this.svg.getBoundingClientRect();
    if (width < 40) return;
    this.inner = [width - MARGIN.left - MARGIN.right, height - MARGIN.top - MARGIN.bottom];
    const group = answer.shown;
    this.values = found.values;
    const pieces = runs(answer, found.values, group);
    const of = (other) => {
      const column = other?.columns.find((c) => c.column === this.column);
      return column && groupsOf(other).includes(group) ? runs(other, column.values, group) : [];
    };
    const old = of(ghost);
    const next = of(proposed);
    const others = groupsOf(answer).filter((g) => g !== group).map((g) => runs(answer, found.values, g)).flat();
    const targets = targetsOf(this.column, answer.rack);
    const slopes = influence?.columns.get(this.column);
    // By one unit of length, or by a tenth where that is much.
    const far = influence ? 10 * state.step : 0;
    const bent = slopes ? runs(answer, found.values.map((v, i) => (v === null || slopes[i] === null ? null : v + slopes[i] * far)), group) : [];

    const drives = answer.drive.filter((x) => x !== null);
    const wantedAt = targets.flatMap((t) => t.points.map((p) => p[0]));
    const all = [...drives, ...state.overview.values, ...wantedAt];
    this.xs = [Math.min(...all), Math.max(...all)];
    if (this.xs[0] === this.xs[1]) this.xs = [this.xs[0] - 1, this.xs[1] + 1];
    const bands = targets.flatMap((t) => t.points.flatMap(([, low, high]) => [low, high].filter((v) => v !== null)));
    const heights = (p) => p.flat().map(([, y]) => y);
    this.ys = this.fitted([...heights(pieces), ...heights(others), ...heights(old), ...heights(next), ...bands]);
    const x = (v) => MARGIN.left + ((v - this.xs[0]) / (this.xs[1] - this.xs[0])) * this.inner[0];
    const y = (v) => MARGIN.top + (1 - (v - this.ys[0]) / (this.ys[1] - this.ys[0])) * this.inner[1];
    this.scales = { x, y };
    const path = (some) => some.map((piece) => (piece.length === 1
      ? `M${x(piece[0][0]) - 3} ${y(piece[0][1])}h6`
      : `M${piece.map(([a, b]) => `${x(a).toFixed(2)} ${y(b).toFixed(2)}`).join('L')}`)).join('');

    this.drawAxes(width, height, x, y);
    this.drawBands(targets, x, y);
    set(this.now, { d: path(pieces) });
    set(this.old, { d: path(old) });
    set(this.proposed, { d: path(next) });
    set(this.moved, { d: path(bent) });
    this.parts.others.replaceChildren(...others.map((piece) => svg('path', { d: path([piece]) })));
    this.drawGaps(answer, found.values, group, x, height);
    const now = placeNow();
    const here = at(pieces, now);
    const cursor = x(now);
    set(this.line, { d: `M${cursor.toFixed(1)} ${MARGIN.top}V${height - MARGIN.bottom}` });
    this.spot.style.display = here === null ? 'none' : '';
    if (here !== null) set(this.spot, { cx: cursor.toFixed(1), cy: y(here).toFixed(1) });
    this.say(found, here, at(old, now), pieces, slopes);
  }

  say(found, here, before, pieces, slopes) {
    // What rounding leaves of nothing is nothing.
    if (here !== null && Math.abs(here) < 1e-9 * (this.ys[1] - this.ys[0])) here = 0;
    this.title.textContent = found.title;
    this.unit.textContent = found.unit ? ` ${found.unit}` : '';
    const change = here !== null && before !== null && Math.abs(here - before) > 1e-12 ? ` (${signed(here - before)})` : '';
    this.value.textContent = brief(here, 4) + change;
    const values = pieces.flat().map(([, v]) => v);
    let text = values.length ? `${brief(Math.min(...values), 3)} … ${brief(Math.max(...values), 3)}` : 'no value';
    if (slopes) {
      const known = slopes.filter((s) => s !== null);
      const rms = Math.sqrt(known.reduce((sum, s) => sum + s * s, 0) / Math.max(1, known.length));
      text = `${brief(rms, 3)} per ${state.overview.unit}`;
    }
    this.range.textContent = text;
    this.svg.setAttribute('aria-label', `${found.title}: ${brief(here, 4)} ${found.unit} at ${brief(placeNow())}, ${text}${found.positive ? `; positive: ${found.positive}` : ''}`);
    this.figure.title = found.positive ? `positive: ${found.positive}` : '';
  }

  drawAxes(width, height, x, y) {
    const key = [width, height, ...this.xs, ...this.ys].join();
    if (key === this.frame) return;
    this.frame = key;
    const { axes } = this.parts;
    axes.replaceChildren();
    const bottom = height - MARGIN.bottom;
    for (const tick of ticks(...this.ys, this.inner[1] / 34)) {
      const at = y(tick).toFixed(1);
      axes.append(svg('path', { class: tick === 0 ? 'zero' : null, d: `M${MARGIN.left} ${at}H${width - MARGIN.right}` }));
      axes.append(svg('text', { x: MARGIN.left - 5, y: Number(at) + 3.5, 'text-anchor': 'end', text: brief(tick) }));
    }
    for (const tick of ticks(...this.xs, this.inner[0] / 62)) {
      const at = x(tick).toFixed(1);
      axes.append(svg('path', { class: tick === 0 ? 'zero' : null, d: `M${at} ${MARGIN.top}V${bottom}` }));
      axes.append(svg('text', { x: at, y: bottom + 14, 'text-anchor': 'middle', text: brief(tick) }));
    }
  }

  drawBands(targets, x, y) {
    const { bands } = this.parts;
    bands.replaceChildren();
    // Where there is no limit, the frame is one.
    const limit = (value, end, by) => (value === null ? this.ys[end] : value + by);
    for (const { points, tolerance, is_band: isBand } of targets) {
      if (!points.length) continue;
      const by = isBand ? 0 : tolerance;
      if (points.length === 1) {
        const [[at, low, high]] = points;
        const [a, b] = [y(limit(low, 0, -by)), y(limit(high, 1, by))];
        bands.append(svg('path', { class: 'line', d: `M${x(at)} ${a.toFixed(1)}V${b.toFixed(1)}M${x(at) - 4} ${a.toFixed(1)}h8M${x(at) - 4} ${b.toFixed(1)}h8` }));
        continue;
      }
      const upper = points.map(([at, , high]) => `${x(at).toFixed(1)} ${y(limit(high, 1, by)).toFixed(1)}`);
      const lower = points.map(([at, low]) => `${x(at).toFixed(1)} ${y(limit(low, 0, -by)).toFixed(1)}`).reverse();
      bands.append(svg('path', { class: 'area', d: `M${[...upper, ...lower].join('L')}Z` }));
      if (!isBand) bands.append(svg('path', { class: 'line', d: `M${points.map(([at, low]) => `${x(at).toFixed(1)} ${y(low).toFixed(1)}`).join('L')}` }));
    }
  }

  // Stations without a value, each with its reason.
  drawGaps(answer, values, group, x, height) {
    const { gaps } = this.parts;
    gaps.replaceChildren();
    values.forEach((value, i) => {
      if (value !== null || answer.groups[i] !== group || answer.drive[i] === null) return;
      const stretch = answer.failures.find((f) => i >= f.first && i <= f.last);
      const reason = stretch ? stretch.reason : answer.status[i] === 'ok' ? 'has no value here' : answer.status[i].replace('_', ' ');
      gaps.append(svg('rect', { x: (x(answer.drive[i]) - 2).toFixed(1), y: height - MARGIN.bottom - 5, width: 4, height: 5 }, svg('title', { text: `${brief(answer.drive[i])}: ${reason}` })));
    });
  }
}

export const chartSvgs = () => charts.map((chart) => [chart.column, chart.title.textContent + chart.unit.textContent, chart.svg]);
export const drawnValues = () => Object.fromEntries(charts.map((chart) => [chart.column, chart.values]));
export const drawnPlaces = (column) => {
  const chart = charts.find((c) => c.column === column);
  return { d: chart.now.getAttribute('d'), drive: state.answer.drive.map((v) => v !== null && chart.scales.x(v)), value: chart.values.map((v) => v !== null && chart.scales.y(v)) };
};

// One chart for each column of the answer.
const arrange = () => {
  const columns = state.answer?.columns.map((c) => c.column) ?? [];
  if (columns.join() === charts.map((c) => c.column).join()) return;
  const kept = new Map(charts.map((chart) => [chart.column, chart]));
  charts = columns.map((column) => kept.get(column) ?? new Chart(column));
  byId('charts').replaceChildren(...charts.map((chart) => chart.figure));
  lay();
};
// As many columns as there is room for, and charts as high as the window lets them be together.
const lay = () => {
  const box = byId('charts');
  const columns = Math.max(1, Math.floor((box.clientWidth + 12) / (304 + 12)));
  box.style.setProperty('--rows', Math.max(1, Math.ceil(charts.length / columns)));
};
const drawAll = () => charts.forEach((chart) => chart.draw());

const offer = () => {
  const choices = byId('choices');
  choices.replaceChildren();
  for (const { name, unit, positive, available } of state.overview.characteristics) {
    if (!available) continue;
    const box = html('input', { type: 'checkbox', value: name, on: { change: choose } });
    box.checked = state.chosen.includes(name);
    choices.append(html('label', { title: `positive: ${positive}` }, box, ` ${name.replaceAll('_', ' ')}`, html('small', { text: unit ? ` ${unit.replaceAll('_', ' ')}` : '' })));
  }
};
const choose = () => {
  state.chosen = [...byId('choices').querySelectorAll('input:checked')].map((box) => box.value);
  ask();
  askGhost();
  emit('chosen');
};

export const startCurves = () => {
  new ResizeObserver(lay).observe(byId('charts'));
  on('study', () => {
    state.chosen = state.overview.characteristics.filter((c) => c.asked && c.available).map((c) => c.name);
    charts = [];
    byId('charts').replaceChildren();
    offer();
  });
  on('answer', () => { arrange(); drawAll(); });
  on('ghost', drawAll);
  on('deed', drawAll);
  on('proposed', () => { byId('key-proposal').hidden = !state.proposed; drawAll(); });
  on('influence', () => {
    const { influence } = state;
    byId('key-influence').hidden = !influence;
    if (influence) {
      const name = state.overview.points[influence.point].name;
      byId('key-influence-text').textContent = `${name} ${'xyz'[influence.axis]} ${signed(10 * state.step)} ${state.overview.unit}`;
    }
    drawAll();
  });
};
