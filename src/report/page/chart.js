// Interactive parts of a chart: the crosshair that all charts share, the zoom to a rectangle (brush) that the user draws, and the
// buttons. The page contains the chart itself.
const ZOOMED_TICKS = [62, 34];
let clips = 0;

class LiveChart {
  constructor(figure) {
    this.figure = figure;
    this.layout = run.charts[Number(figure.dataset.chart)];
    this.svg = figure.querySelector('svg');
    this.readout = figure.querySelector('.readout');
    this.inner = this.svg.querySelector('.inner');
    const [left, top, right, bottom] = this.layout.plot;
    this.box = { left, top, width: right - left, height: bottom - top };
    this.home = [[this.layout.x.low, this.layout.x.high], [this.layout.y.low, this.layout.y.high]];
    this.view = this.home;
    this.lines = this.layout.lines.map((line) => {
      const table = run.curves[line.table];
      const [xs, ys] = [line.x, line.y].map((name) => column(table, name));
      const { x: { is_log: logX }, y: { is_log: logY } } = this.layout;
      const can = (v, isLog) => v !== null && (!isLog || v > 0);
      // A point without a value is a gap of the curve.
      const points = line.rows.map((row) => [xs[row], can(ys[row], logY) ? ys[row] : null]).filter(([x]) => can(x, logX));
      return { ...line, points: points.sort((a, b) => a[0] - b[0]), design: line.table };
    });
    this.cross = this.svg.appendChild(svg('g', { class: 'cross', 'aria-hidden': 'true' }));
    this.hair = this.cross.appendChild(svg('path', { class: 'hair' }));
    this.spots = this.lines.map(({ class: look }) => this.cross.appendChild(svg('path', { class: `dot ${look}`, display: 'none' })));
    this.brush = this.cross.appendChild(svg('rect', { class: 'brush', display: 'none' }));
    // A transparent background receives pointer events in the whole plot.
    this.svg.insertBefore(svg('rect', { class: 'ground', x: left, y: top, width: this.box.width, height: this.box.height }), this.svg.firstChild);
    this.places = [...new Set(this.lines.flatMap(({ points }) => points.filter(([, y]) => y !== null).map(([x]) => x)))].sort((a, b) => a - b);
    set(this.svg, { tabindex: 0 });
    this.addTools();
    this.listen();
    noteDrawn(figure);
  }

  addTools() {
    const button = (text, title, click) => html('button', { type: 'button', title, 'aria-label': title, text, on: { click } });
    this.figure.append(html('div', { class: 'tools drawn' },
      button('−', 'Zoom out', () => this.zoomBy(1.5)), button('+', 'Zoom in', () => this.zoomBy(1 / 1.5)),
      button('⟲', 'Whole chart', () => this.reset()), button('SVG', 'Save as SVG', () => this.save())));
  }

  // Converts a value to a fraction of its axis.
  share(axis, value) {
    const [low, high] = this.view[axis];
    return this.layout[axis ? 'y' : 'x'].is_log ? Math.log(value / low) / Math.log(high / low) : (value - low) / (high - low);
  }
  valueAt(axis, share) {
    const [low, high] = this.view[axis];
    return this.layout[axis ? 'y' : 'x'].is_log ? low * (high / low) ** share : low + share * (high - low);
  }
  at([x, y]) {
    const { left, top, width, height } = this.box;
    return [left + this.share(0, x) * width, top + (1 - this.share(1, y)) * height];
  }
  // Position of a pointer in picture units.
  pointer(event) {
    const box = this.svg.getBoundingClientRect();
    const [width, height] = this.layout.size;
    return [((event.clientX - box.x) * width) / box.width, ((event.clientY - box.y) * height) / box.height];
  }

  listen() {
    let start = null;
    const inside = ([x, y]) => {
      const { left, top, width, height } = this.box;
      return [Math.min(1, Math.max(0, (x - left) / width)), Math.min(1, Math.max(0, 1 - (y - top) / height))];
    };
    this.svg.addEventListener('pointerdown', (event) => {
      if (event.button !== 0 || event.pointerType === 'touch') return;
      start = this.pointer(event);
    });
    this.svg.addEventListener('pointermove', (event) => {
      const now = this.pointer(event);
      if (start && Math.hypot(now[0] - start[0], now[1] - start[1]) > 6) {
        if (!this.svg.hasPointerCapture(event.pointerId)) this.svg.setPointerCapture(event.pointerId);
        const [a, b] = [start, now].map(inside);
        const { left, top, width, height } = this.box;
        set(this.brush, {
          display: null, x: left + Math.min(a[0], b[0]) * width, y: top + (1 - Math.max(a[1], b[1])) * height,
          width: Math.abs(a[0] - b[0]) * width, height: Math.abs(a[1] - b[1]) * height,
        });
        return;
      }
      this.pointAt(this.valueAt(0, inside(now)[0]));
    });
    this.svg.addEventListener('pointerup', (event) => {
      if (!start) return;
      const [a, b] = [start, this.pointer(event)].map(inside);
      set(this.brush, { display: 'none' });
      start = null;
      const sides = [0, 1].map((k) => Math.abs(a[k] - b[k]));
      if (sides[0] < 0.02 && sides[1] < 0.02) return;
      // A brush that is narrow along one axis does not change the range of this axis.
      this.zoom([0, 1].map((k) => (sides[k] < 0.04 ? this.view[k] : [Math.min(a[k], b[k]), Math.max(a[k], b[k])].map((s) => this.valueAt(k, s)))));
    });
    this.svg.addEventListener('pointercancel', () => { start = null; set(this.brush, { display: 'none' }); });
    this.svg.addEventListener('pointerleave', () => { if (!start) this.leave(); });
    this.svg.addEventListener('dblclick', () => this.reset());
    // Screen readers read the values of the chart that has the focus.
    this.svg.addEventListener('focus', () => set(this.readout, { 'aria-live': 'polite' }));
    this.svg.addEventListener('blur', () => { set(this.readout, { 'aria-live': 'off' }); this.leave(); });
    this.svg.addEventListener('keydown', (event) => {
      const now = pointed.get(this.layout.x.column);
      const last = this.places.length - 1;
      const near = now === undefined ? -1 : this.nearest(now);
      const to = { ArrowLeft: near < 0 ? last : near - 1, ArrowRight: near + 1, Home: 0, End: last }[event.key];
      if (to !== undefined && last >= 0) this.pointAt(this.places[Math.min(last, Math.max(0, to))]);
      else if (event.key === '+') this.zoomBy(1 / 1.5);
      else if (event.key === '-') this.zoomBy(1.5);
      else if (event.key === 'Escape') { this.reset(); this.leave(); } else return;
      event.preventDefault();
    });
  }

  nearest(value) {
    let best = 0;
    this.places.forEach((place, k) => { if (Math.abs(place - value) < Math.abs(this.places[best] - value)) best = k; });
    return best;
  }
  pointAt(value) {
    if (this.places.length) point(this.layout.x.column, this.places[this.nearest(value)], this);
  }
  leave() { point(this.layout.x.column, null, this); }

  // Value of a line at a position, interpolated linearly between its points. Null outside the line and in its gaps.
  value({ points }, x) {
    const next = points.findIndex(([at]) => at >= x);
    if (next < 0) return null;
    const [x1, y1] = points[next];
    if (x1 === x) return y1;
    if (next === 0) return null;
    const [x0, y0] = points[next - 1];
    if (y0 === null || y1 === null) return null;
    return y0 + ((y1 - y0) * (x - x0)) / (x1 - x0);
  }
  isShown({ class: look }) {
    const of = /of-\d+/.exec(look);
    return !of || this.figure.classList.contains(`shows-${of[0]}`);
  }

  follow(name, value) {
    if (name !== this.layout.x.column) return;
    const { top, height } = this.box;
    const foot = this.layout.strip ? this.layout.strip[1] : top + height;
    const share = value === null ? -1 : this.share(0, value);
    const is = share >= -1e-9 && share <= 1 + 1e-9;
    this.cross.classList.toggle('on', is);
    if (!is) {
      this.spots.forEach((spot) => set(spot, { display: 'none' }));
      this.readout.textContent = '';
      return;
    }
    const [x] = this.at([value, this.view[1][0]]);
    set(this.hair, { d: `M${x.toFixed(1)} ${top}V${foot}` });
    const words = [];
    this.lines.forEach((line, k) => {
      const y = this.isShown(line) ? this.value(line, value) : null;
      const at = y === null ? null : this.at([value, y]);
      const inside = at && at[1] >= top - 1 && at[1] <= top + height + 1;
      set(this.spots[k], inside ? { display: null, d: `M${at[0].toFixed(1)} ${at[1].toFixed(1)}h.01` } : { display: 'none' });
      if (y !== null) words.push({ line, text: brief(y), order: line.is_main ? 0 : 1 });
    });
    words.sort((a, b) => a.order - b.order);
    const { x: over, y: of } = this.layout;
    const between = ([, low, high]) => (low === null ? `at most ${brief(high)}` : high === null ? `at least ${brief(low)}` : `${brief(low)} to ${brief(high)}`);
    const wanted = this.layout.wanted.flat().filter(([at, low, high]) => at === value && (low !== null || high !== null));
    const limits = new Set(wanted.map((limit) => `target ${between(limit)} ${of.unit}`));
    this.readout.replaceChildren(html('b', { text: `${over.name} ${brief(value)} ${over.unit}` }),
      ...words.slice(0, 6).map(({ line, text }) => html('span', { class: line.class.replace(/\b(strong|faint|fine)\b/g, '').trim() }, `${line.told} `, html('b', { text: `${text} ${of.unit}` }))),
      ...[...limits].map((text) => html('span', { class: 'wanted', text })));
  }

  zoomBy(factor) {
    this.zoom(this.view.map((_, axis) => [0.5 - factor / 2, 0.5 + factor / 2].map((share) => this.valueAt(axis, share))));
  }
  reset() { this.zoom(this.home); }

  zoom(view) {
    const kept = view.map(([low, high], axis) => {
      const [first, last] = this.home[axis];
      return [Math.max(first, low), Math.min(last, high)];
    });
    this.view = kept.map(([low, high], axis) => (high > low ? [low, high] : this.view[axis]));
    const is = this.view.some((ends, axis) => ends.some((end, k) => end !== this.home[axis][k]));
    this.figure.classList.toggle('zoomed', is);
    const { left, top, width, height } = this.box;
    if (!this.clip) {
      const id = `clip-${clips += 1}`;
      this.clip = svg('clipPath', { id }, svg('rect', { x: left, y: top, width, height }));
      this.svg.append(this.clip);
      // The group `holder` clips the curves. It does not move when the zoom moves the curves inside it.
      const holder = svg('g', { 'clip-path': `url(#${id})` });
      this.inner.replaceWith(holder);
      holder.append(this.inner);
      this.zoomedAxes = svg('g', { class: 'axes zoomed-axes' });
      this.svg.insertBefore(this.zoomedAxes, holder);
    }
    const scale = [0, 1].map((axis) => {
      const [a, b] = this.home[axis].map((end) => this.share(axis, end));
      return [b - a, a];
    });
    const [[sx, ox], [sy, oy]] = scale;
    // With scale s and offset o, fraction f of the whole chart becomes fraction o + s f of the visible part.
    const tx = left + ox * width - sx * left;
    const ty = top + height * (1 - oy) - sy * (top + height);
    set(this.inner, { transform: is ? `matrix(${sx} 0 0 ${sy} ${tx} ${ty})` : null });
    this.drawTicks(is);
    const value = pointed.get(this.layout.x.column);
    if (value !== undefined) this.follow(this.layout.x.column, value);
  }

  // Draws the ticks of the visible part. The ticks of the whole chart are part of the page. The title of the axis contains the
  // power of ten that the labels leave out.
  drawTicks(is) {
    this.zoomedAxes.replaceChildren();
    if (!is) return;
    const { left, top, width, height } = this.box;
    const foot = top + height;
    this.view.forEach(([low, high], axis) => {
      const { power, is_log: isLog } = this.layout[axis ? 'y' : 'x'];
      const all = isLog
        ? ticks(Math.log10(low), Math.log10(high), 4).map((power) => 10 ** power)
        : ticks(low, high, (axis ? height : width) / ZOOMED_TICKS[axis]);
      for (const tick of all) {
        const text = isLog ? brief(tick, 3) : brief(tick / 10 ** power, 9);
        const [x, y] = this.at(axis ? [this.view[0][0], tick] : [tick, this.view[1][0]]).map((v) => v.toFixed(1));
        this.zoomedAxes.append(
          svg('path', { class: 'grid', d: axis ? `M${left} ${y}h${width}` : `M${x} ${top}V${foot}` }),
          svg('text', axis
            ? { class: 'axis-text', x: left - 7, y: Number(y) + 4, 'text-anchor': 'end', text }
            : { class: 'axis-text', x, y: foot + 14, 'text-anchor': 'middle', text }));
      }
    });
  }

  // Saves the chart as an SVG with its own background and styles. The page's security policy allows no style attributes in markup,
  // so the script sets each property.
  save() {
    const copy = this.svg.cloneNode(true);
    copy.querySelectorAll('.cross, .ground').forEach((part) => part.remove());
    const [width, height] = this.layout.size;
    set(copy, { xmlns: 'http://www.w3.org/2000/svg', width, height, tabindex: null });
    const looks = ['color', 'fill', 'fill-opacity', 'stroke', 'stroke-width', 'stroke-dasharray', 'stroke-linecap', 'opacity', 'font', 'display', 'vector-effect'];
    const own = [...this.svg.querySelectorAll('g, path, text')].filter((part) => !part.closest('.cross'));
    [...copy.querySelectorAll('g, path, text')].forEach((part, k) => {
      const style = getComputedStyle(own[k]);
      for (const name of looks) part.style.setProperty(name, style.getPropertyValue(name));
    });
    copy.prepend(svg('rect', { width, height, fill: getComputedStyle(root).getPropertyValue('--paper').trim() }));
    saveText(`${this.layout.key.replace(/[^\w.-]/g, '_')}.svg`, new XMLSerializer().serializeToString(copy), 'image/svg+xml');
  }
}

const charts = [...document.querySelectorAll('figure.chart[data-chart]')].map((figure) => new LiveChart(figure));
followers.add((name, value) => charts.forEach((chart) => { if (!chart.figure.hidden) chart.follow(name, value); }));
