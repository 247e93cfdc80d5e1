// Curves over one of the sliders: present design, opened design, targets, and a proposal.
import { brief, byId, html, hundredth, measured, placed, refill, set, show, signed, svg, tenth, ticks, write } from './draw.js';
import { ask, askGhost, chooseMotion, emit, here as placeNow, isInGesture, on, onRest, state } from './design.js';
import { framed } from './frame.js';
import { Deviation } from './deviation.js';
import { EdgeHandles } from './handles.js';
import { announce } from './speech.js';
import { at, curveOf, endsOf, familyOf, heights, knownOf, runs, wholeOf } from './runs.js';
import { askForTarget } from './targets.js';
import { labelsOf, spread, widest } from './labels.js';

const MARGIN = { left: 46, right: 10, top: 15, bottom: 33 };
// Distance of labels from the ends of their lines.
const GAP = 8;
// Largest number of letters of a range that fit into its box.
const MOST_OF_RANGE = 17;
// Width of a letter of an axis in pixels.
const LETTER = 5.5;
// Font sizes of a value in pixels, large and small, and the width of the range beside it.
const VALUE = { large: 13.12, small: 11.52 };
const RANGE = 125;
// Height of the strip of deviations.
const STRIP = 26;
let charts = [];
let clips = 0;

// Draws a curve, unless it is drawn already in these scales.
const drawCurve = (element, pieces, path, frame) => {
  if (element.pieces === pieces && element.frame === frame) return;
  Object.assign(element, { pieces, frame });
  set(element, { d: path(pieces) });
};
const NONE = [];

// Targets of columns over the chosen slider, for the shown rack displacement.
const targetsOf = (columns, rack) => state.overview.targets.filter((target) => target.columns.some((c) => columns.includes(c))
  && target.motion === state.motion && target.over === state.over && (!target.racks.length || target.racks.includes(rack)));

// Width of the shaded area beyond the limits of a target. For a target value it is the tolerance, for a band it is 0.
const bandOf = ({ tolerance, is_band: isBand }) => (isBand ? 0 : tolerance);

// The columns of both wheels share one chart.
const SIDE = /^(left|right)_/;
const partsOf = (columns) => {
  const byKey = new Map();
  for (const column of columns) {
    const [, side] = SIDE.exec(column) ?? [];
    const key = side ? column.replace(SIDE, '') : column;
    const name = side && columns.includes(`left_${key}`) && columns.includes(`right_${key}`) ? `both ${key}` : column;
    if (!byKey.has(name)) byKey.set(name, []);
    byKey.get(name).push({ column, side: name === column ? null : side });
  }
  return [...byKey];
};

// Ticks of an axis. At least two have labels, because a single label does not show the scale.
const several = (ends, count, isNamed) => [count, 2 * count, 4 * count].map((some) => ticks(...ends, Math.max(1, some))).find((found) => found.filter(isNamed).length > 1) ?? [];
// Text of the range of a curve. The text has enough digits to distinguish the two ends, if the digits fit.
const rangeOf = (low, high) => {
  const telling = high > low ? Math.ceil(Math.log10(Math.max(Math.abs(low), Math.abs(high)) / (high - low))) + 2 : 3;
  const most = Math.min(6, Math.max(3, telling));
  const between = (form) => `${form(low)}…${form(high)}`;
  for (let digits = most; digits >= 2; digits -= 1) {
    const text = between((v) => brief(v, digits));
    if (text.length <= MOST_OF_RANGE) return text;
  }
  return between((v) => v.toExponential(1).replaceAll('-', '−'));
};

const decimals = (text) => (text.includes('e') ? 0 : (text.split('.')[1] ?? '').length);

// Ticks at even distances whose labels do not touch. The tick at zero is one of them.
const apart = (all, x) => {
  if (all.length < 2) return all;
  const widest = LETTER * (1 + Math.max(...all.map((tick) => brief(tick).length)));
  const every = Math.ceil(widest / (x(all[1]) - x(all[0])));
  const from = Math.max(0, all.indexOf(0)) % every;
  const found = all.filter((_, k) => k % every === from);
  return found.length > 1 ? found : [all[0], all.at(-1)];
};

class Chart {
  constructor(key, parts) {
    this.key = key;
    this.title = html('b');
    this.unit = html('span', { class: 'unit' });
    this.value = html('output', { 'aria-live': 'off' });
    this.range = html('small');
    this.svg = svg('svg', { class: 'chart', role: 'group', tabindex: 0 });
    const id = `clip-${clips += 1}`;
    this.clip = svg('rect', { x: MARGIN.left, y: MARGIN.top });
    this.svg.append(svg('clipPath', { id }, this.clip));
    // All curves share one clip, because the browser makes a layer for each clip.
    const [axes, inside] = [svg('g', { class: 'axes' }), svg('g', { 'clip-path': `url(#${id})` })];
    this.svg.append(axes, inside);
    const groups = (parent, names) => names.map((name) => [name, parent.appendChild(svg('g', { class: name }))]);
    this.parts = { axes, ...Object.fromEntries([
      ...groups(inside, ['bands', 'ghosts', 'pins', 'others', 'influence', 'proposal', 'now']), ...groups(this.svg, ['gaps', 'cursor', 'labels', 'deviation', 'edges']),
    ]) };
    this.series = parts.map(({ column, side }) => ({
      column, side,
      now: this.parts.now.appendChild(svg('path', { class: side })),
      old: this.parts.ghosts.appendChild(svg('path')),
      proposed: this.parts.proposal.appendChild(svg('path')),
      moved: this.parts.influence.appendChild(svg('path')),
      spot: svg('circle', { r: 3.5, class: side }),
    }));
    this.line = this.parts.cursor.appendChild(svg('path'));
    this.parts.cursor.append(...this.series.map(({ spot }) => spot));
    this.edges = new EdgeHandles(this);
    this.deviation = new Deviation(this.parts.deviation);
    const adder = this.adder = html('button', { class: 'adder', text: '+ target', on: { click: () => askForTarget(this.series, state.answer) } });
    this.figure = html('figure', { class: 'chartbox', 'data-column': key },
      html('figcaption', {}, adder, html('span', { class: 'name' }, this.title, this.unit), html('span', { class: 'values' }, this.value, this.range)), html('div', { class: 'plot' }, this.svg));
    const point = (event) => {
      const box = this.svg.getBoundingClientRect();
      const [low, high] = this.xs;
      const x = low + ((event.clientX - box.x - MARGIN.left) / this.inner[0]) * (high - low);
      state.at[state.over] = Math.max(low, Math.min(high, x));
      emit('place', event);
    };
    this.svg.addEventListener('pointerdown', (event) => {
      this.svg.setPointerCapture(event.pointerId);
      this.held = true;
      point(event);
    });
    this.svg.addEventListener('pointermove', (event) => { if (this.held) point(event); });
    for (const name of ['pointerup', 'pointercancel']) this.svg.addEventListener(name, () => { this.held = false; });
    this.svg.addEventListener('keydown', (event) => {
      const by = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
      if (event.target !== this.svg || (!by && event.key !== 'Home')) return;
      event.preventDefault();
      const [low, high] = this.xs;
      const to = by ? placeNow() + by * (high - low) / (event.shiftKey ? 8 : 80) : state.overview.sliders[state.over].home;
      state.at[state.over] = Math.max(low, Math.min(high, Number(to.toPrecision(6))));
      emit('place', event);
      announce(() => this.svg.getAttribute('aria-label'), 500);
    });
    // The size is measured when it changes. If each chart read its size during drawing, the browser would have to lay out the page
    // once per chart. An invisible chart is drawn after the drag ends.
    this.isSeen = true;
    new IntersectionObserver(([{ isIntersecting }]) => {
      this.isSeen = isIntersecting;
      if (isIntersecting && this.isLate) this.draw(true);
    }).observe(this.figure);
    new ResizeObserver(([{ contentRect: { width, height } }]) => {
      this.size = { width, height };
      this.frame = null;
      this.draw();
    }).observe(this.svg);
  }

  draw(isWanted = false) {
    const { answer, ghost, proposed, influence } = state;
    this.isLate = !isWanted && !this.isSeen;
    if (this.isLate) {
      later();
      return;
    }
    const columns = answer && knownOf(answer).columns;
    const found = this.series.map(({ column }) => columns?.get(column));
    if (!found.every(Boolean)) return;
    const { width, height } = this.size ??= this.svg.getBoundingClientRect();
    if (width < 40) return;
    // The view box scales the picture if it is printed in another size.
    set(this.svg, { viewBox: `0 0 ${width} ${height}` });
    const targets = targetsOf(this.series.map(({ column }) => column), answer.rack);
    // A strip under curves with targets shows the deviations from the targets.
    this.bottom = MARGIN.bottom + (targets.length ? STRIP : 0);
    const group = answer.shown;
    const whole = wholeOf(answer);
    const family = familyOf(whole, group);
    const of = (other, column) => (other && knownOf(other).columns.has(column) ? curveOf(other, column, group) : NONE);
    // The line for the influence of a coordinate shows the curve after a move of the coordinate by ten steps.
    const far = influence ? 10 * state.step : 0;
    const lines = found.map(({ column, values }, k) => {
      // There is one slope for each station. The slopes cannot be used with an answer that has only some of the stations.
      const known = influence?.columns.get(column);
      const slopes = known?.length === values.length ? known : undefined;
      const bent = slopes ? runs(answer, values.map((v, i) => (v === null || slopes[i] === null ? null : v + slopes[i] * far)), group) : NONE;
      return {
        ...this.series[k], found: found[k], slopes, bent, pieces: curveOf(answer, column, group), old: of(ghost, column), next: of(proposed, column),
        pins: Object.entries(state.pins).map(([letter, pin]) => [letter, of(pin.answer, column)]),
        family: knownOf(whole ?? answer).columns.has(column) ? family.map((g) => ({ value: whole.group_places[g][state.family], pieces: curveOf(whole, column, g) })) : [],
      };
    });
    this.series.forEach((one, k) => { one.values = found[k].values; });
    const labels = labelsOf(lines);
    this.right = labels.length ? GAP + widest(labels) + 2 : MARGIN.right;
    this.inner = [width - MARGIN.left - this.right, height - MARGIN.top - this.bottom];
    set(this.clip, { width: this.inner[0] + Math.min(this.right, MARGIN.right), height: this.inner[1] });

    const wantedAt = targets.flatMap((t) => t.points.map((p) => p[0]));
    this.xs = endsOf([...knownOf(answer).ends, ...state.overview.sliders[state.over].values, ...wantedAt]);
    if (this.xs[0] === this.xs[1]) this.xs = [this.xs[0] - 1, this.xs[1] + 1];
    // The range of the axis includes target values with their tolerances, because the drawn bands include them.
    const bands = targets.flatMap((t) => t.points.flatMap(([, low, high]) => [[low, -1], [high, 1]].filter(([v]) => v !== null).map(([v, sign]) => v + sign * bandOf(t))));
    const still = [...lines.flatMap(({ old, next, pins }) => [...heights(old), ...heights(next), ...pins.flatMap(([, some]) => heights(some))]), ...bands];
    const moving = lines.flatMap(({ pieces, family: some }) => [...heights(pieces), ...some.flatMap((f) => heights(f.pieces))]);
    this.ys = framed(this, still, moving, isInGesture());
    const x = (v) => MARGIN.left + ((v - this.xs[0]) / (this.xs[1] - this.xs[0])) * this.inner[0];
    const y = (v) => MARGIN.top + (1 - (v - this.ys[0]) / (this.ys[1] - this.ys[0])) * this.inner[1];
    this.scales = { x, y };
    const [xScale, yScale] = [this.inner[0] / (this.xs[1] - this.xs[0]), this.inner[1] / (this.ys[1] - this.ys[0])];
    const [left, top] = [MARGIN.left - this.xs[0] * xScale, MARGIN.top + this.ys[1] * yScale];
    const path = (some) => {
      let d = '';
      for (const piece of some) {
        if (piece.length === 1) d += `M${x(piece[0][0]) - 3} ${y(piece[0][1])}h6`;
        else for (let i = 0; i < piece.length; i += 1) d += `${i ? 'L' : 'M'}${hundredth(left + piece[i][0] * xScale)} ${hundredth(top - piece[i][1] * yScale)}`;
      }
      return d;
    };

    this.drawAxes(width, height, x, y, found[0].unit);
    this.drawBands(targets, x, y);
    const now = placeNow();
    this.series.forEach((one, k) => {
      const { pieces, old, next, bent } = lines[k];
      for (const [element, some] of [[one.now, pieces], [one.old, old], [one.proposed, next], [one.moved, bent]]) drawCurve(element, some, path, this.frame);
      const here = at(pieces, now);
      lines[k].here = here;
      lines[k].before = at(old, now);
      show(one.spot, here !== null && here >= this.ys[0] && here <= this.ys[1]);
      if (here !== null) set(one.spot, { cx: tenth(x(now)), cy: tenth(y(here)) });
    });
    // All lines for the other values of a slider share one element. The layout of many elements would take longer than the rest
    // of the chart.
    refill(this.parts.others, lines.map(({ side, family: some }) => ['path', { class: side, d: some.map((f) => path(f.pieces)).join('') }]));
    set(this.parts.others, { class: whole === answer ? 'others' : 'others stale' });
    refill(this.parts.pins, lines.flatMap(({ pins }) => pins.map(([letter, some]) => ['path', { class: `pin-${letter}`, d: path(some) }])));
    this.drawLabels(labels, x, y);
    this.edges.draw(targets, this.scales, this.xs, found[0].unit);
    this.deviation.draw(targets, lines, { x, base: height - STRIP / 2, low: this.inner[0] + MARGIN.left, at, answer });
    this.drawGaps(answer, group, x, height);
    set(this.line, { d: `M${x(now).toFixed(1)} ${MARGIN.top}V${height - this.bottom}` });
    this.say(lines);
  }

  say(lines) {
    const [first] = lines;
    const { unit, positive } = first.found;
    const isPair = lines.length > 1;
    write(this.title, isPair ? first.found.title.replace(/^(left|right) /i, '') : first.found.title);
    write(this.unit, `${isPair ? ', both wheels' : ''}${unit ? ` [${unit}]` : ''}`);
    // Texts of the value, the longest first. The first one that fits is shown.
    const texts = isPair ? [lines.map(({ side, here }) => `${side ? `${side[0].toUpperCase()} ` : ''}${brief(this.shown(here), 3)}`).join('  ')] : this.changesOf(first);
    const fits = (text, size) => measured(text, size, 600) < this.size.width - RANGE;
    const large = isPair ? undefined : texts.find((text) => fits(text, VALUE.large));
    const small = texts.find((text) => fits(text, VALUE.small));
    const words = large ?? small ?? texts[0];
    set(this.value, { class: large !== undefined ? null : small !== undefined ? 'pair' : 'pair wide' });
    write(this.value, words);
    const values = lines.flatMap(({ pieces }) => heights(pieces));
    let text = values.length ? rangeOf(...endsOf(values)) : 'no value';
    if (first.slopes) {
      const known = lines.flatMap(({ slopes }) => slopes ?? []).filter((s) => s !== null);
      const rms = Math.sqrt(known.reduce((sum, s) => sum + s * s, 0) / Math.max(1, known.length));
      text = `${brief(rms, 3)} per ${state.overview.unit}`;
    }
    // A long value replaces the range, because the axis also shows the range.
    write(this.range, text);
    const { name: over, unit: own } = state.overview.sliders[state.over];
    const sign = positive && positive !== 'always' ? `positive: ${positive}` : '';
    set(this.svg, { 'aria-label': `${this.title.textContent}${isPair ? ', both wheels' : ''}: ${words.replace('  ', ', ')} ${unit} at ${over} ${brief(placeNow())} ${own}, ${first.slopes || !values.length ? '' : 'range '}${text}${sign ? `; ${sign}` : ''}` });
    set(this.figure, { title: sign || null });
    set(this.adder, { 'aria-label': `+ target for ${this.title.textContent}` });
  }

  // A value that is only rounding error is shown as 0.
  shown(value) {
    return value !== null && Math.abs(value) < 1e-9 * (this.ys[1] - this.ys[0]) ? 0 : value;
  }

  // Texts of a value with its change relative to the file, with more and with fewer digits of the change. The value has as many
  // digits as the former value.
  changesOf({ here, before }) {
    const is = this.shown(here);
    const text = brief(is, 4);
    if (is === null || before === null || Math.abs(is - before) <= 1e-12) return [text];
    const value = text.includes('e') ? text : is.toFixed(Math.max(...[is, before].map((own) => decimals(brief(own, 4))))).replace('-', '−');
    return [3, 2].map((digits) => `${value} (${signed(is - before, digits)})`);
  }

  drawAxes(width, height, x, y, unit) {
    const { name, unit: own } = state.overview.sliders[state.over];
    const key = [width, height, this.bottom, this.right, ...this.xs, ...this.ys, name].join();
    if (key === this.frame) return;
    this.frame = key;
    const [lines, words] = [[], []];
    const word = (x, y, anchor, text, kind = null) => words.push(['text', { class: kind, ...placed(x, y), 'text-anchor': anchor, text }]);
    const bottom = height - this.bottom;
    // The unit is near the top, so ticks there have no label.
    const isNamed = (tick) => y(tick) > MARGIN.top + 5;
    for (const tick of several(this.ys, this.inner[1] / 34, isNamed)) {
      const place = y(tick).toFixed(1);
      lines.push(['path', { class: tick === 0 ? 'zero' : null, d: `M${MARGIN.left} ${place}H${width - this.right}` }]);
      if (isNamed(tick)) word(MARGIN.left - 5, Number(place) + 3.5, 'end', brief(tick));
    }
    const across = several(this.xs, this.inner[0] / 62, () => true);
    const named = apart(across, x);
    for (const tick of across) {
      const place = x(tick).toFixed(1);
      lines.push(['path', { class: tick === 0 ? 'zero' : null, d: `M${place} ${MARGIN.top}V${bottom}` }]);
      if (named.includes(tick)) word(place, bottom + 13, 'middle', brief(tick));
    }
    word(MARGIN.left + this.inner[0] / 2, bottom + 29, 'middle', `${name} [${own}]`, 'axis-title');
    if (unit) word(MARGIN.left - 5, 9, 'end', `[${unit}]`, 'axis-title');
    refill(this.parts.axes, [...lines, ...words]);
  }

  drawLabels(labels, x, y) {
    const found = spread(labels, [MARGIN.top, MARGIN.top + this.inner[1]], y);
    const leader = ({ end, at: from, to }) => (Math.abs(to - from) > 4 ? `M${tenth(x(end[0]) + 1)} ${tenth(from)}L${tenth(x(end[0]) + GAP - 1)} ${tenth(to)}` : '');
    refill(this.parts.labels, [['path', { d: found.map(leader).join('') }],
      ...found.map(({ end, text, kind, to }) => ['text', { class: kind, ...placed(x(end[0]) + GAP, to + 3.5), text }])]);
  }

  drawBands(targets, x, y) {
    const bands = [];
    // A missing limit is drawn at the edge of the plot.
    const limit = (value, end, by) => (value === null ? this.ys[end] : value + by);
    for (const { points, tolerance, is_band: isBand } of targets) {
      if (!points.length) continue;
      const by = bandOf({ tolerance, is_band: isBand });
      if (points.length === 1) {
        const [[place, low, high]] = points;
        const [a, b] = [y(limit(low, 0, -by)), y(limit(high, 1, by))];
        bands.push(['path', { class: 'line', d: `M${x(place)} ${a.toFixed(1)}V${b.toFixed(1)}M${x(place) - 4} ${a.toFixed(1)}h8M${x(place) - 4} ${b.toFixed(1)}h8` }]);
        continue;
      }
      const upper = points.map(([place, , high]) => `${x(place).toFixed(1)} ${y(limit(high, 1, by)).toFixed(1)}`);
      const lower = points.map(([place, low]) => `${x(place).toFixed(1)} ${y(limit(low, 0, -by)).toFixed(1)}`).reverse();
      bands.push(['path', { class: 'area', d: `M${[...upper, ...lower].join('L')}Z` }]);
      if (!isBand) bands.push(['path', { class: 'line', d: `M${points.map(([place, low]) => `${x(place).toFixed(1)} ${y(low).toFixed(1)}`).join('L')}` }]);
    }
    refill(this.parts.bands, bands);
  }

  // Stations without a value, each with its reason.
  drawGaps(answer, group, x, height) {
    const { gaps } = this.parts;
    if (gaps.firstChild) gaps.replaceChildren();
    for (const { values } of this.series) {
      values.forEach((value, i) => {
        if (value !== null || answer.groups[i] !== group || answer.drive[i] === null) return;
        const stretch = answer.failures.find((f) => i >= f.first && i <= f.last);
        const reason = stretch ? stretch.reason : answer.status[i] === 'ok' ? 'has no value here' : answer.status[i].replaceAll('_', ' ');
        gaps.append(svg('rect', { x: (x(answer.drive[i]) - 2).toFixed(1), y: height - this.bottom - 5, width: 4, height: 5 }, svg('title', { text: `${brief(answer.drive[i])}: ${reason}` })));
      });
    }
  }
}

export const chartSvgs = () => {
  drawLate();
  return charts.map((chart) => [chart.key, chart.title.textContent + chart.unit.textContent, chart.svg]);
};
const everySeries = () => charts.flatMap((chart) => chart.series.map((one) => ({ chart, ...one })));
export const drawnValues = () => {
  drawLate();
  return Object.fromEntries(everySeries().map(({ column, values }) => [column, values]));
};
export const drawnPlaces = (wanted) => {
  drawLate();
  const { chart, now, values } = everySeries().find(({ column }) => column === wanted);
  return { d: now.getAttribute('d'), drive: state.answer.drive.map((v) => v !== null && chart.scales.x(v)), value: values.map((v) => v !== null && chart.scales.y(v)) };
};

// One chart for each column of the answer, or for the columns of both wheels.
const arrange = () => {
  const parts = partsOf(state.answer?.columns.map((c) => c.column) ?? []);
  if (parts.map(([key]) => key).join() === charts.map((c) => c.key).join()) return;
  const kept = new Map(charts.map((chart) => [chart.key, chart]));
  charts = parts.map(([key, own]) => kept.get(key) ?? new Chart(key, own));
  byId('charts').replaceChildren(...charts.map((chart) => chart.figure));
};
const drawAll = () => charts.forEach((chart) => chart.draw());
// Invisible charts are drawn when the page is idle, and before they are exported or printed.
const drawLate = () => charts.forEach((chart) => { if (chart.isLate) chart.draw(true); });
const REST = 300;
let timer = null;
const later = () => {
  clearTimeout(timer);
  timer = setTimeout(() => { if (!isInGesture()) drawLate(); }, REST);
};

// The menu is filled only while it is open, because browsers search all fields of a page after each answer.
const offer = () => {
  const choices = byId('choices');
  choices.replaceChildren();
  if (!byId('chooser').open) return;
  for (const { name, unit, positive, available } of state.overview.characteristics) {
    if (!available) continue;
    const box = html('input', { type: 'checkbox', value: name, on: { change: choose } });
    box.checked = state.chosen.includes(name);
    choices.append(html('label', { title: positive === 'always' ? null : `positive: ${positive}` }, box, ` ${name.replaceAll('_', ' ')}`, html('small', { text: unit ? ` ${unit.replaceAll('_', ' ')}` : '' })));
  }
  if (!state.overview.is_car && state.overview.characteristics.some(({ available }) => !available)) choices.append(html('p', { class: 'hint', text: 'Further curves need data in the tab Vehicle and parts.' }));
};
const choose = () => {
  state.chosen = [...byId('choices').querySelectorAll('input:checked')].map((box) => box.value);
  ask();
  askGhost();
  emit('chosen');
};

// Menus that choose the quantity on the horizontal axis, and the quantity that has one line per value. They offer only
// quantities that vary in the motion, and the main quantity.
const offerAxes = () => {
  const { sliders, is_car: isCar } = state.overview;
  if (isCar) return;
  const moving = sliders.map((slider, k) => [k, slider]).filter(([k, { values }]) => values.length > 1 || k === state.overview.main);
  const option = ([k, { name }]) => html('option', { value: k, text: name });
  const [axis, family] = ['over', 'family'].map(byId);
  axis.replaceChildren(...moving.map(option));
  axis.value = String(state.over);
  const rest = moving.filter(([k]) => k !== state.over);
  if (!rest.some(([k]) => k === state.family)) state.family = rest.at(-1)?.[0] ?? null;
  family.replaceChildren(...rest.map(option), html('option', { value: '', text: 'none' }));
  family.value = state.family === null ? '' : String(state.family);
  byId('over-label').hidden = moving.length < 2;
  byId('family-label').hidden = moving.length < 2;
  const { motions, targets } = state.overview;
  byId('motion').replaceChildren(...motions.map(({ name }) => html('option', { value: name ?? '', text: name ?? '[motion]' })));
  byId('motion').value = state.motion ?? '';
  byId('motion-label').hidden = motions.length < 2;
  const over = targets.filter((t) => t.motion === state.motion && t.over !== null && t.over !== state.over).map((t) => `over ${sliders[t.over].name}`);
  const others = targets.filter((t) => t.motion !== state.motion).map((t) => `in ${t.motion ?? '[motion]'}`);
  // Targets at rack displacements at which the motion has no stations.
  const { values, unit } = sliders.at(-1);
  const racks = targets.filter((t) => t.motion === state.motion && t.over === state.over).flatMap((t) => t.racks).filter((rack) => !values.includes(rack));
  const beside = racks.length ? [`at rack ${[...new Set(racks)].map((rack) => brief(rack)).join(', ')} ${unit}`] : [];
  const elsewhere = [...new Set([...over, ...beside, ...others])];
  byId('elsewhere').textContent = elsewhere.length ? `Targets ${elsewhere.join(', ')} are not shown here.` : '';
};
const clear = () => {
  charts = [];
  byId('charts').replaceChildren();
};

export const startCurves = () => {
  byId('chooser').addEventListener('toggle', offer);
  byId('over').addEventListener('change', (event) => {
    state.over = Number(event.target.value);
    offerAxes();
    ask();
    askGhost();
    emit('chosen');
  });
  byId('family').addEventListener('change', (event) => {
    state.family = event.target.value === '' ? null : Number(event.target.value);
    drawAll();
  });
  on('study', () => {
    state.chosen = state.overview.characteristics.filter((c) => c.asked && c.available).map((c) => c.name);
    state.over = state.overview.main;
    state.family = null;
    clear();
    offer();
    offerAxes();
  });
  byId('motion').addEventListener('change', (event) => chooseMotion(event.target.value || null));
  on('motion', () => {
    clear();
    offerAxes();
  });
  on('edited', () => {
    const asked = state.overview.characteristics.filter((c) => c.asked && c.available).map((c) => c.name);
    state.chosen = [...new Set([...state.chosen.filter((name) => state.overview.characteristics.some((c) => c.name === name && c.available)), ...asked])];
    offer();
    offerAxes();
    askGhost();
  });
  on('answer', () => {
    if (state.overview.is_car) return;
    if (state.answer?.has_rows) byId('family-label').hidden = true;
    arrange();
    drawAll();
  });
  on('pins', drawAll);
  on('ghost', drawAll);
  onRest(drawAll);
  addEventListener('beforeprint', drawLate);
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
