// Designs as lines over several parallel axes. Each axis has its own scale. A drag along an axis selects the designs in that
// part of the axis.
const parallel = byId('parallel-plot');
const MOST_AXES = 12;
const PARALLEL = { size: [1180, 436], box: [50, 102, 1130, 396] };
// Largest length of a line in an axis title, relative to the distance of two axes.
const TITLE = 1.8;
const brushes = new Map();

// Columns of the axes: variables with the largest effects, then up to three deviations from targets and the misfit. Without
// targets, the gains follow the variables. The column that the user adds is last.
const parallelAxes = (state) => {
  const strength = (k) => Math.max(0, ...run.effects.map((o) => o.effects[k]?.share ?? 0));
  const variables = columns.map((_, k) => k).slice(0, first.variables);
  const chosen = variables.sort((a, b) => strength(b) - strength(a) || a - b).slice(0, MOST_AXES - 4).sort((a, b) => a - b);
  const outputs = first.misfit === null
    ? columns.map((_, k) => k).slice(first.variables).filter((k) => columns[k].kind === 'gain')
    : [...first.deviations.slice(0, 3), first.misfit];
  const axes = [...chosen, ...outputs.slice(0, MOST_AXES - chosen.length)];
  return state.more === null || axes.includes(state.more) ? axes : [...axes, state.more];
};
const placeOfAxis = (i, all) => PARALLEL.box[0] + (all > 1 ? (i * (PARALLEL.box[2] - PARALLEL.box[0])) / (all - 1) : 0);
const heightOn = (k, v) => PARALLEL.box[3] - shareOn(axisOf(k, false), v) * (PARALLEL.box[3] - PARALLEL.box[1]);

// Splits a title into up to two lines of at most `most` letters.
const linesOf = (words, most) => {
  if (words.length <= most) return [words];
  const at = words.lastIndexOf(' ', most) > 0 ? words.lastIndexOf(' ', most) : most;
  const rest = words.slice(at).trim();
  return [words.slice(0, at), rest.length > most ? `${rest.slice(0, most - 1)}…` : rest];
};

// Designs that are inside the selected part of every axis (brush).
const brushed = () => (brushes.size ? new Set(allRows.filter((row) => [...brushes].every(([k, [low, high]]) => value(k, row) !== null && value(k, row) >= low && value(k, row) <= high))) : null);

const drawParallel = (state) => {
  const axes = parallelAxes(state);
  const [, top, , bottom] = PARALLEL.box;
  const lines = (rows) => rows.map((row) => {
    let pen = 'M';
    return axes.map((k, i) => {
      const v = value(k, row);
      if (v === null) { pen = 'M'; return ''; }
      const step = `${pen}${placeOfAxis(i, axes.length).toFixed(1)} ${heightOn(k, v).toFixed(1)}`;
      pen = 'L';
      return step;
    }).join('');
  }).join('');
  const groups = groupsOf(state);
  const parts = groups.map(({ look, rows }) => svg('path', { class: `thread ${look}${['main', 'target'].includes(look) ? ' strong' : ''}`, d: lines(rows) }));
  if (state.picked !== null) parts.push(svg('path', { class: 'thread ink strong picked', d: lines([state.picked]) }));
  axes.forEach((k, i) => {
    const x = placeOfAxis(i, axes.length).toFixed(1);
    const { ticks: marks, title: words } = axisOf(k, false);
    const anchor = i === 0 ? 'start' : i === axes.length - 1 ? 'end' : 'middle';
    const shift = anchor === 'middle' ? 0 : anchor === 'start' ? -30 : 30;
    const most = Math.max(14, Math.floor((TITLE * (PARALLEL.box[2] - PARALLEL.box[0])) / Math.max(1, axes.length - 1) / 6.6));
    parts.push(svg('path', { class: 'frame', d: `M${x} ${top}V${bottom}` }));
    linesOf(words, most).forEach((text, line, all) => {
      parts.push(svg('text', { class: 'axis-text', x: Number(x) + shift, y: (i % 2 ? 92 : 62) - 13 * (all.length - 1 - line), 'text-anchor': anchor, text }, svg('title', { text: words })));
    });
    for (const [share, text] of marks) {
      const y = bottom - share * (bottom - top);
      parts.push(svg('text', { class: 'axis-text small', x: Number(x) + 4, y: (y + 3.5).toFixed(1), text }));
    }
    const range = brushes.get(k);
    if (range) {
      const [a, b] = range.map((v) => heightOn(k, v));
      parts.push(svg('rect', { class: 'brush', x: Number(x) - 7, y: b.toFixed(1), width: 14, height: Math.max(2, a - b).toFixed(1) }));
    }
  });
  parts.push(...legendOf(groups, PARALLEL.box[2]));
  set(parallel, { viewBox: `0 0 ${PARALLEL.size.join(' ')}`, tabindex: 0 });
  parallel.replaceChildren(...parts);
  noteDrawn(parallel);
  byId('parallel-selected').textContent = state.selected === null ? '' : `${state.selected.size} designs selected; a double click selects all again.`;
};

const listenToParallel = (state, select) => {
  let start = null;
  parallel.addEventListener('pointerdown', (event) => {
    if (event.button !== 0) return;
    const [x, y] = placeIn(parallel, PARALLEL.size, event);
    const axes = parallelAxes(state);
    const far = axes.map((_, i) => Math.abs(placeOfAxis(i, axes.length) - x));
    const i = far.indexOf(Math.min(...far));
    if (far[i] < 24) {
      start = { k: axes[i], y };
      parallel.setPointerCapture(event.pointerId);
    }
  });
  const valueOn = (k, y) => {
    const { low, high } = axisOf(k, false);
    return low + ((PARALLEL.box[3] - y) / (PARALLEL.box[3] - PARALLEL.box[1])) * (high - low);
  };
  parallel.addEventListener('pointermove', (event) => {
    if (!start) return;
    const [, y] = placeIn(parallel, PARALLEL.size, event);
    if (Math.abs(y - start.y) < 4) return;
    brushes.set(start.k, [Math.max(y, start.y), Math.min(y, start.y)].map((h) => valueOn(start.k, h)));
    select(brushed());
  });
  parallel.addEventListener('pointerup', (event) => {
    if (!start) return;
    const [, y] = placeIn(parallel, PARALLEL.size, event);
    if (Math.abs(y - start.y) < 4 && brushes.delete(start.k)) select(brushed());
    start = null;
  });
  parallel.addEventListener('dblclick', () => { brushes.clear(); select(null); });
};
