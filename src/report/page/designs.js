// The designs of a sweep by two of their columns.
const { columns, shown, first, best, front } = run;
const rowOf = new Map(shown.design.map((design, row) => [design, row]));
const rowsOf = (designs) => designs.map((design) => rowOf.get(design)).filter((row) => row !== undefined);
const [bestRows, frontRows] = [rowsOf(best), rowsOf(front)];
const marked = new Set([...bestRows, ...frontRows]);
const titled = (k) => plain(withUnit(columns[k].title, columns[k].unit));
const value = (k, row) => shown.columns[k][row];
const statusOf = (row) => (shown.failing[row] === null ? 'ok' : shown.reasons[shown.failing[row]][0]);
const isWhole = (row) => shown.failing[row] === null;
const allRows = shown.design.map((_, row) => row);

// Light to strong, or low to high.
const rising = (c) => [[0, c.accent], [1, mixed(c.rule, c.before, 0.4)]];
const eitherWay = (c) => [[0, c.target], [0.5, mixed(c.rule, c.before, 0.4)], [1, c.accent]];
const isDeviation = (k) => ['rms', 'misfit'].includes(columns[k].kind);
const scaleOf = (c, k) => (isDeviation(k) ? rising(c) : eitherWay(c));
// The colour at a part of a scale.
const along = (scale, part) => {
  const next = scale.findIndex(([stop]) => stop >= part);
  if (next <= 0) return scale[0][1];
  const [[before, from], [after, to]] = [scale[next - 1], scale[next]];
  return mixed(from, to, (part - before) / (after - before));
};
const quantile = (values, part) => [...values].sort((a, b) => a - b)[Math.floor(part * (values.length - 1))];

const scatter = byId('scatter-plot');
const isPositive = (k) => shown.columns[k].every((v) => v === null || v > 0);

const scatterTrace = (c, state, rows, name, marker, more) => ({
  type: 'scatter', mode: 'markers', name, marker,
  x: rows.map((row) => value(state.x, row)), y: rows.map((row) => value(state.y, row)),
  customdata: rows.map((row) => shown.design[row]),
  text: rows.map((row) => (first.misfit !== null && value(first.misfit, row) !== null ? `, misfit ${brief(value(first.misfit, row))}` : '')),
  hovertemplate: `design %{customdata}%{text}<br>${titled(state.x)}: %{x:.5~g}<br>${titled(state.y)}: %{y:.5~g}<extra></extra>`,
  ...more,
});

const drawScatter = async (state) => {
  const c = colours();
  const { x, y, colour } = state;
  const others = allRows.filter((row) => !marked.has(row) && isWhole(row));
  const failed = allRows.filter((row) => !isWhole(row));
  let looks = { size: 5, color: c.before, opacity: 0.7 };
  if (colour !== 'status') {
    const values = allRows.map((row) => value(colour, row)).filter((v) => v !== null);
    looks = {
      size: 5.5, color: others.map((row) => value(colour, row)), colorscale: scaleOf(c, colour),
      // A few bad designs would leave all others in one shade.
      ...(values.length && { cmin: quantile(values, 0), cmax: quantile(values, isDeviation(colour) ? 0.9 : 1) }),
      colorbar: { title: { text: titled(colour), side: 'right' }, thickness: 12, outlinewidth: 0, x: 1.01 },
    };
  }
  const traces = [
    scatterTrace(c, state, others, 'designs', looks),
    scatterTrace(c, state, failed, 'not solved everywhere', { symbol: 'x-thin', size: 7, line: { color: c.bad, width: 1.5 } }, {
      text: failed.map((row) => `<br>${plain(shown.reasons[shown.failing[row]].join(': '))}`),
    }),
    scatterTrace(c, state, frontRows, 'Pareto front', { symbol: 'diamond', size: 9, color: c.target, line: { color: c.paper, width: 1 } }),
    scatterTrace(c, state, bestRows, 'best', { symbol: 'circle-open', size: 13, color: c.accent, line: { color: c.accent, width: 2 } }),
    {
      type: 'scatter', mode: 'markers', name: 'as given', x: [columns[x].at_design], y: [columns[y].at_design],
      marker: { symbol: 'cross', size: 10, color: c.ink }, hovertemplate: 'the study as given<br>%{x:.5~g}, %{y:.5~g}<extra></extra>',
    },
    scatterTrace(c, state, state.picked === null ? [] : [state.picked], 'chosen', { symbol: 'square-open', size: 17, color: c.ink, line: { color: c.ink, width: 1.5 } }, { hoverinfo: 'skip', hovertemplate: null }),
  ].filter((trace) => trace.x.some((v, i) => v !== null && trace.y[i] !== null));
  const type = (k) => (state.logarithmic && isPositive(k) ? 'log' : 'linear');
  await draw(scatter, traces, layout(c, {
    xaxis: axis(c, { title: { text: titled(x) }, type: type(x) }),
    yaxis: axis(c, { title: { text: titled(y) }, type: type(y) }),
    hovermode: 'closest', dragmode: 'zoom', showlegend: true,
    legend: { orientation: 'h', y: 1.02, yanchor: 'bottom', x: 0 },
    margin: { l: 56, r: 16, t: 64, b: 48 },
    uirevision: `${x} ${y} ${state.logarithmic}`,
  }), { ...config, modeBarButtonsToRemove: [] });
  const absent = allRows.filter((row) => value(x, row) === null || value(y, row) === null).length;
  byId('scatter-absent').textContent = absent ? `${absent} of the designs drawn have no value in one of these columns and are not in this plot.` : '';
};

// The chosen design: its values beside those of the study as given.
const sayPicked = ({ picked }) => {
  const table = byId('picked-table');
  table.replaceChildren();
  if (picked === null) return;
  const line = (cells, tag) => {
    const tr = document.createElement('tr');
    cells.forEach((text, i) => {
      const cell = document.createElement(tag);
      cell.textContent = text;
      if (i) cell.className = 'number';
      tr.append(cell);
    });
    return tr;
  };
  // Six digits to read; the whole number where the pointer rests.
  const cell = (v) => (v === null ? '' : brief(v));
  const exact = (v) => (v === null ? '' : String(v));
  const design = shown.design[picked];
  table.append(line(['column', `design ${design}`, 'as given'], 'th'));
  columns.forEach((column, k) => {
    const values = [value(k, picked), column.at_design];
    const row = line([column.column, ...values.map(cell)], 'td');
    values.forEach((v, i) => { row.cells[i + 1].title = exact(v); });
    table.append(row);
  });
  byId('picked-command').textContent = `hardpoint sweep STUDY --design ${design} > design_${design}.toml`;
  const failing = shown.failing[picked];
  const at = shown.failed_at[picked];
  byId('picked-status').textContent = failing === null ? 'Solved at every station.' : `Not solved everywhere: ${shown.reasons[failing].join(': ')}${at === null ? '' : `, nearest at ${at}`}.`;
  byId('picked').value = String(picked);
  root.dataset.picked = design;
  root.dataset.pickedValues = columns.map((_, k) => exact(value(k, picked))).join(' ');
};
