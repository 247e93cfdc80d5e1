// Handles on targets: points of target curves and edges of bands. The user drags them or moves them by arrow keys.
import { brief, centred, heldByFinger, niceStep, placed, set, svg } from './draw.js';
import { state } from './design.js';
import { degreesPerDrive, setTarget, writtenTarget } from './targets.js';

// Largest number of handles per target. Longer curves can only be changed in the file.
const MOST = 16;

// Numbers of a target that have a handle: their path in the study, and their position and value in the chart.
const numbersOf = (target, k, [first, last]) => {
  const written = writtenTarget(k);
  if (!written) return [];
  const edge = first + 0.97 * (last - first);
  const isNumber = Number.isFinite;
  const onChart = (drive) => drive * degreesPerDrive(written.motion);
  if (isNumber(written.value) && isNumber(written.at)) return [{ path: ['value'], place: onChart(written.at), value: written.value, name: 'wanted value' }];
  if (Array.isArray(written.points) && written.points.length <= MOST) {
    return written.points.map(([drive, value], i) => ({ path: ['points', i, 1], place: onChart(drive), value, name: `target value at ${brief(onChart(drive))}` }));
  }
  const place = isNumber(written.at) ? onChart(written.at) : edge;
  const found = [];
  if (Array.isArray(written.between) && written.between.every(isNumber)) {
    found.push({ path: ['between', 0], place, value: written.between[0], name: 'lower limit', end: 1 }, { path: ['between', 1], place, value: written.between[1], name: 'upper limit', end: 2 });
  }
  if (isNumber(written.at_least)) found.push({ path: ['at_least'], place, value: written.at_least, name: 'lower limit', end: 1 });
  if (isNumber(written.at_most)) found.push({ path: ['at_most'], place, value: written.at_most, name: 'upper limit', end: 2 });
  return found;
};

export class EdgeHandles {
  constructor(chart) {
    this.chart = chart;
    this.layer = chart.parts.edges;
    this.shown = new Map();
    this.held = null;
  }

  // Moves each handle to the present value of its number. A handle of the same number stays the same element, so that a drag
  // continues and the focus stays.
  draw(targets, { x, y }, xs, unit) {
    const seen = new Set();
    for (const target of targets) {
      const k = state.overview.targets.indexOf(target);
      for (const number of numbersOf(target, k, xs)) {
        const key = `${k} ${number.path.join(' ')}`;
        seen.add(key);
        const handle = this.shown.get(key) ?? this.build(key);
        Object.assign(handle, number, { k, target });
        const value = this.held === key ? handle.dragged : number.value;
        const height = y(value);
        handle.group.style.display = Number.isFinite(height) && height > 8 && height < this.chart.inner[1] + 22 ? '' : 'none';
        const across = x(number.place);
        for (const circle of handle.circles) set(circle, centred(across, height));
        // The value is beside the handle, towards the middle of the chart.
        const isRight = across > (x(xs[0]) + x(xs[1])) / 2;
        set(handle.words, { ...placed(across + (isRight ? -9 : 9), height < 24 ? height + 13 : height - 6), 'text-anchor': isRight ? 'end' : 'start', text: `${brief(value)}${unit ? ` ${unit}` : ''}` });
        set(handle.group, { class: this.held === key ? 'edge held' : 'edge' });
        set(handle.group, {
          'aria-valuenow': value,
          'aria-label': `${target.column.replaceAll('_', ' ')}: ${number.name}`, 'aria-valuetext': `${brief(value)} ${unit}`.trim(),
        });
      }
    }
    for (const [key, { group }] of this.shown) {
      if (seen.has(key)) continue;
      group.remove();
      this.shown.delete(key);
    }
  }

  build(key) {
    const handle = { circles: [svg('circle', { class: 'hit', r: 12 }), svg('circle', { r: 4.5 })], words: svg('text') };
    handle.group = svg('g', {
      class: 'edge', tabindex: 0, role: 'slider', 'aria-orientation': 'vertical',
      on: { pointerdown: (event) => this.grab(event, key), keydown: (event) => this.key(event, handle) },
    }, ...handle.circles, handle.words);
    this.layer.append(heldByFinger(handle.group));
    this.shown.set(key, handle);
    return handle;
  }

  step() {
    const [low, high] = this.chart.ys;
    return niceStep(high - low, 100);
  }

  // Shows the target with a preliminary value.
  preview(handle, value) {
    handle.dragged = value;
    const { target, path, end } = handle;
    if (path[0] === 'points') Object.assign(target.points.find(([place]) => place === handle.place) ?? [], end ? {} : { 1: value, 2: value });
    else for (const point of target.points) for (const side of end ? [end] : [1, 2]) point[side] = value;
    this.chart.draw();
  }

  grab(event, key) {
    if (event.button !== 0) return;
    event.preventDefault();
    event.stopPropagation();
    const handle = this.shown.get(key);
    const [from, value, step] = [event.clientY, handle.value, this.step()];
    const perPixel = (this.chart.ys[1] - this.chart.ys[0]) / this.chart.inner[1];
    const before = handle.target.points.map((point) => [...point]);
    this.held = key;
    handle.dragged = value;
    handle.group.focus({ preventScroll: true });
    handle.group.setPointerCapture(event.pointerId);
    const move = (now) => {
      const wanted = value - perPixel * (now.clientY - from);
      this.preview(handle, Number((Math.round(wanted / step) * step).toPrecision(12)));
    };
    const end = (now) => {
      for (const name of ['pointermove', 'pointerup', 'pointercancel']) handle.group.removeEventListener(name, handlers[name]);
      this.held = null;
      handle.target.points.forEach((point, i) => Object.assign(point, before[i]));
      if (now.type === 'pointerup' && handle.dragged !== value) setTarget(handle.k, handle.path, handle.dragged);
      else this.chart.draw();
    };
    const handlers = { pointermove: move, pointerup: end, pointercancel: end };
    for (const [name, handler] of Object.entries(handlers)) handle.group.addEventListener(name, handler);
  }

  key(event, handle) {
    const by = { ArrowUp: 1, ArrowDown: -1 }[event.key];
    if (!by || event.ctrlKey || event.metaKey) return;
    event.preventDefault();
    const value = Number((handle.value + by * this.step() * (event.shiftKey ? 10 : 1)).toPrecision(12));
    setTarget(handle.k, handle.path, value);
  }
}
