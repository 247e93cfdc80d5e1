// Scatter plot of the designs of a sweep over two columns. The data of the page contain the ticks and titles of the axes.
const { columns, shown, first, best, front: frontDesigns } = run;
const rowOf = new Map(shown.design.map((design, row) => [design, row]));
const rowsOf = (designs) => designs.map((design) => rowOf.get(design)).filter((row) => row !== undefined);
const [bestRows, frontRows] = [rowsOf(best), rowsOf(frontDesigns)];
const marked = new Set([...bestRows, ...frontRows]);
const titled = (k) => withUnit(columns[k].title, columns[k].unit);
const value = (k, row) => shown.columns[k][row];
const isWhole = (row) => shown.failing[row] === null;
const allRows = shown.design.map((_, row) => row);
// Rows of the designs that violate a constraint.
const outside = new Set(allRows.filter((row) => columns.some(({ least }, k) => least !== null && value(k, row) !== null && value(k, row) < least)));
const SHADES = 9;
const SCATTER = { size: [900, 520], box: [74, 52, 880, 462] };

const axisOf = (k, isLog) => (isLog && columns[k].log_axis) || columns[k].axis;
const shareOn = (axis, v) => (axis.is_log ? Math.log(v / axis.low) / Math.log(axis.high / axis.low) : (v - axis.low) / (axis.high - axis.low));

// Shade of each design by its value in a column. All shades have the same number of designs. So a few extreme values do not leave
// all other designs in one shade.
const shadesBy = (k) => {
  const known = allRows.filter((row) => value(k, row) !== null).sort((a, b) => value(k, a) - value(k, b));
  const shades = new Map();
  known.forEach((row, i) => shades.set(row, Math.floor((i * SHADES) / known.length)));
  return shades;
};
const shadesOf = (state) => (state.colour === 'status' ? null : shadesBy(state.colour));
// Groups of designs in the scatter plot, the most important ones last. Each group has a CSS class, rows and a name.
const groupsOf = (state) => {
  const selected = (row) => state.selected === null || state.selected.has(row);
  const plain = allRows.filter((row) => isWhole(row) && !marked.has(row) && !outside.has(row));
  const shades = shadesOf(state);
  const groups = shades
    ? Array.from({ length: SHADES }, (_, k) => [`shade${SHADES - 1 - k}`, plain.filter((row) => shades.get(row) === SHADES - 1 - k), k ? null : `designs, by ${titled(state.colour)}: low ochre, high blue`])
    : [['former', plain, 'designs']];
  groups.push(['bad', allRows.filter((row) => !isWhole(row)), 'not solved everywhere']);
  groups.push(['outside', allRows.filter((row) => isWhole(row) && outside.has(row)), 'outside the constraints']);
  groups.push(['target', frontRows, 'Pareto front'], ['main', bestRows, 'best']);
  return groups.map(([look, rows, name]) => ({ look, name, rows: rows.filter(selected), all: rows.length })).filter(({ all }) => all);
};

const legendOf = (groups, width) => {
  let x = 12;
  return groups.filter(({ name }) => name).flatMap(({ look, name }) => {
    const at = x;
    x += 26 + 6.6 * name.length;
    return x > width + 60 ? [] : [svg('path', { class: `dot ${look}`, d: `M${at + 5} 16h.01` }), svg('text', { class: 'note', x: at + 14, y: 20, text: name })];
  });
};

const scatter = byId('scatter-plot');
let scatterPlaces = [];
const drawScatter = (state) => {
  const [left, top, right, bottom] = SCATTER.box;
  const [x, y] = [state.x, state.y].map((k) => axisOf(k, state.logarithmic));
  const at = (row) => {
    const [a, b] = [value(state.x, row), value(state.y, row)];
    return a === null || b === null ? null : [left + shareOn(x, a) * (right - left), bottom - shareOn(y, b) * (bottom - top)];
  };
  const parts = [];
  for (const [share, text] of x.ticks) {
    const place = (left + share * (right - left)).toFixed(1);
    parts.push(svg('path', { class: 'grid', d: `M${place} ${top}V${bottom}` }), svg('text', { class: 'axis-text', x: place, y: bottom + 18, 'text-anchor': 'middle', text }));
  }
  for (const [share, text] of y.ticks) {
    const place = (bottom - share * (bottom - top)).toFixed(1);
    parts.push(svg('path', { class: 'grid', d: `M${left} ${place}H${right}` }), svg('text', { class: 'axis-text', x: left - 8, y: Number(place) + 4, 'text-anchor': 'end', text }));
  }
  parts.push(svg('text', { class: 'axis-text', x: (left + right) / 2, y: bottom + 42, 'text-anchor': 'middle', text: x.title }),
    svg('text', { class: 'axis-text', x: 18, y: (top + bottom) / 2, 'text-anchor': 'middle', transform: `rotate(-90 18 ${(top + bottom) / 2})`, text: y.title }));
  const groups = groupsOf({ ...state, selected: null });
  scatterPlaces = allRows.map(at);
  for (const { look, rows } of groups) {
    const d = rows.map((row) => scatterPlaces[row]).filter(Boolean).map(([a, b]) => `M${a.toFixed(1)} ${b.toFixed(1)}h.01`).join('');
    if (['target', 'main'].includes(look)) parts.push(svg('path', { class: 'dot around', d }));
    parts.push(svg('path', { class: `dot ${look}`, d }));
  }
  const given = [columns[state.x].at_design, columns[state.y].at_design];
  if (given.every((v) => v !== null)) {
    const [a, b] = [left + shareOn(x, given[0]) * (right - left), bottom - shareOn(y, given[1]) * (bottom - top)];
    parts.push(svg('path', { class: 'line ink', d: `M${(a - 6).toFixed(1)} ${b.toFixed(1)}h12m-6 -6v12` }), svg('text', { class: 'end name', x: (a + 8).toFixed(1), y: (b - 6).toFixed(1), text: 'as given' }));
  }
  const picked = state.picked === null ? null : scatterPlaces[state.picked];
  if (picked) parts.push(svg('path', { class: 'ring', d: `M${picked.map((c) => c.toFixed(1)).join(' ')}h.01` }));
  parts.push(...legendOf(groups, right), svg('rect', { class: 'brush', display: 'none' }));
  set(scatter, { viewBox: `0 0 ${SCATTER.size.join(' ')}`, tabindex: 0 });
  scatter.replaceChildren(...parts);
  noteDrawn(scatter);
  const absent = scatterPlaces.filter((place) => !place).length;
  byId('scatter-absent').textContent = absent ? `${absent} of the designs shown have no value in one of these columns and are omitted from this plot.` : '';
};

const placeIn = (element, size, event) => {
  const box = element.getBoundingClientRect();
  return [((event.clientX - box.x) * size[0]) / box.width, ((event.clientY - box.y) * size[1]) / box.height];
};
// A click picks the nearest design. A drag selects the designs in a box. A double click selects all designs again.
const listenToScatter = (state, pick, select) => {
  let start = null;
  scatter.addEventListener('pointerdown', (event) => { if (event.button === 0) start = placeIn(scatter, SCATTER.size, event); });
  const boxTo = (event) => {
    const now = placeIn(scatter, SCATTER.size, event);
    return [0, 1].map((k) => [Math.min(start[k], now[k]), Math.max(start[k], now[k])]);
  };
  scatter.addEventListener('pointermove', (event) => {
    if (!start) return;
    const [[a, b], [c, d]] = boxTo(event);
    if (b - a + d - c < 6) return;
    if (!scatter.hasPointerCapture(event.pointerId)) scatter.setPointerCapture(event.pointerId);
    set(scatter.querySelector('.brush'), { display: null, x: a, y: c, width: b - a, height: d - c });
  });
  scatter.addEventListener('pointerup', (event) => {
    if (!start) return;
    const [[a, b], [c, d]] = boxTo(event);
    const now = [b, d];
    start = null;
    set(scatter.querySelector('.brush'), { display: 'none' });
    if (b - a + d - c >= 6) {
      const rows = allRows.filter((row) => scatterPlaces[row] && scatterPlaces[row][0] >= a && scatterPlaces[row][0] <= b && scatterPlaces[row][1] >= c && scatterPlaces[row][1] <= d);
      select(rows.length ? new Set(rows) : null);
      return;
    }
    const far = (row) => (scatterPlaces[row] ? Math.hypot(scatterPlaces[row][0] - now[0], scatterPlaces[row][1] - now[1]) : Infinity);
    const nearest = allRows.reduce((found, row) => (far(row) < far(found) ? row : found), 0);
    if (far(nearest) < 14) pick(nearest);
  });
  scatter.addEventListener('dblclick', () => select(null));
};

// Shows the values of the chosen design beside the values of the given study.
const sayPicked = ({ picked }) => {
  const table = byId('picked-table');
  table.replaceChildren();
  if (picked === null) return;
  // Cells have six digits; their tooltips have all digits.
  const cell = (v) => html('td', { class: 'number', text: v === null ? '' : brief(v, 6), title: v === null ? null : String(v) });
  const exact = (v) => (v === null ? '' : String(v));
  const design = shown.design[picked];
  table.append(html('tr', {}, ...['column', `design ${design}`, 'as given'].map((text, i) => html('th', { text, class: i ? 'number' : null }))));
  columns.forEach((of, k) => table.append(html('tr', {}, html('td', { text: of.column }), cell(value(k, picked)), cell(of.at_design))));
  byId('picked-command').textContent = `hardpoint sweep STUDY --design ${design} > design_${design}.toml`;
  const failing = shown.failing[picked];
  const at = shown.failed_at[picked];
  byId('picked-status').textContent = failing === null ? `Solved everywhere.${outside.has(picked) ? ' Violates a constraint.' : ''}` : `Not solved everywhere: ${shown.reasons[failing].join(': ')}${at === null ? '' : `, ${run.failed_at} ${brief(at)}`}.`;
  byId('picked').value = String(picked);
  root.dataset.picked = design;
  root.dataset.pickedValues = columns.map((_, k) => exact(value(k, picked))).join(' ');
};
