// The course of the optimisation, and which coordinate moves which curve.
const drawHistory = async () => {
  if (!run.history) return;
  const c = colours();
  const [start, iteration, misfit] = ['start', 'iteration', 'misfit'].map((name) => column(run.history, name));
  const traces = [...new Set(start)].map((number) => {
    const rows = start.map((_, row) => row).filter((row) => start[row] === number);
    const kept = number === run.kept_start;
    return {
      type: 'scatter', mode: 'lines+markers', name: kept ? `start ${number}, kept` : `start ${number}`,
      x: rows.map((row) => iteration[row]), y: rows.map((row) => misfit[row]),
      line: { color: kept ? c.accent : c.before, width: kept ? 2.2 : 1.2 }, marker: { size: kept ? 6 : 4 },
    };
  });
  await draw(byId('history-plot'), traces, layout(c, {
    xaxis: axis(c, { title: { text: 'iteration' }, tickformat: 'd' }),
    yaxis: axis(c, { title: { text: 'misfit [tolerances]' }, type: 'log', dtick: 1 }),
    showlegend: traces.length > 1 && traces.length < 12,
  }));
};

const measure = () => byId('measure').value;
const influenceOf = (output, coordinate) => record.influences.find((i) => i.output === output && i.coordinate === coordinate);
const influenced = record.outputs.filter((o) => record.influences.some((i) => i.output === o.column));
const perLength = (output) => `${output.unit || '1'} per ${record.length_unit}`;

const drawInfluences = async () => {
  const c = colours();
  const most = new Map(influenced.map((o) => [
    o.column,
    Math.max(...record.influences.filter((i) => i.output === o.column).map((i) => i[measure()])),
  ]));
  const share = (output, coordinate) => {
    const found = influenceOf(output, coordinate);
    return found && most.get(output) > 0 ? found[measure()] / most.get(output) : 0;
  };
  const strength = (coordinate) => Math.max(...influenced.map((o) => share(o.column, coordinate)));
  const coordinates = [...new Set(record.influences.map((i) => i.coordinate))]
    .sort((a, b) => strength(b) - strength(a))
    .slice(0, 24);
  const cells = (value) => coordinates.map((k) => influenced.map((o) => value(o, influenceOf(o.column, k), k)));
  const element = byId('influence-map');
  element.style.height = `${176 + 23 * coordinates.length}px`;
  await draw(element, [{
    type: 'heatmap', x: influenced.map((o) => plain(o.title)), y: coordinates.map(plain),
    z: cells((o, _, k) => share(o.column, k)), zmin: 0, zmax: 1, showscale: false, xgap: 1, ygap: 1,
    colorscale: [[0, c.panel], [1, c.strong]],
    text: cells((o, found, k) => (share(o.column, k) < 0.01 ? '' : found[measure()].toPrecision(2))), texttemplate: '%{text}',
    customdata: cells((o, found) => (found ? `moves ${brief(found.rms)}, bends ${brief(found.bend)}, at most ${brief(found.largest)} ${perLength(o)}` : 'none')),
    hovertemplate: '%{y} on %{x}<br>%{customdata}<extra></extra>',
  }], layout(c, {
    xaxis: axis(c, { side: 'top', tickangle: -35, showgrid: false, fixedrange: true }),
    yaxis: axis(c, { autorange: 'reversed', showgrid: false, fixedrange: true }),
    margin: { l: 10, r: 70, t: 36, b: 10 },
  }), still);
  await drawRanking();
};

const drawRanking = async () => {
  const c = colours();
  const output = influenced.find((o) => o.column === byId('influence-output').value);
  const ranked = record.influences.filter((i) => i.output === output.column).sort((a, b) => b[measure()] - a[measure()]).slice(0, 15);
  const element = byId('influence-bars');
  element.style.height = `${110 + 23 * ranked.length}px`;
  await draw(element, [{
    type: 'bar', orientation: 'h', x: ranked.map((i) => i[measure()]), y: ranked.map((i) => plain(i.coordinate)),
    marker: { color: c.accent }, customdata: ranked.map((i) => brief(i.largest)),
    hovertemplate: '%{y}: %{x:.4~g}, at most %{customdata}<extra></extra>',
  }], layout(c, {
    xaxis: axis(c, { title: { text: plain(`${output.title} [${perLength(output)}]`) }, rangemode: 'tozero', fixedrange: true }),
    yaxis: axis(c, { autorange: 'reversed', fixedrange: true }),
    margin: { l: 10, r: 16, t: 30, b: 44 },
  }), still);
};
