// Every output of several designs over the motion, each at its own stations, or their differences from the first at the
// stations that all of them have.
const byRackOf = (stations) => {
  const byRack = new Map();
  stations.forEach(([, rack], row) => {
    if (!byRack.has(rack)) byRack.set(rack, []);
    byRack.get(rack).push(row);
  });
  return byRack;
};
const common = byRackOf(run.stations);
const own = run.own_stations.map(byRackOf);

const dashes = ['solid', 'dash', 'dot', 'dashdot', 'longdash'];
const traceOf = (c, label, design, unit, stations, values) => ([rack, rows], number, all) => ({
  type: 'scatter', mode: 'lines', connectgaps: false, legendgroup: label, showlegend: number === 0,
  name: plain(label), hoverlabel: { namelength: -1 },
  hovertemplate: `%{x:.5~g} ${plain(unit)}<extra>${plain(all.length > 1 ? `${label}, rack ${brief(rack)}` : label)}</extra>`,
  x: rows.map((row) => values[row]), y: rows.map((row) => stations[row][0]),
  line: { color: c.hues[design % c.hues.length], dash: dashes[design % dashes.length], width: 2 },
  opacity: 0.35 + (0.65 * (number + 1)) / all.length,
});
const curveTraces = (c, output) => run.labels.flatMap((label, design) => {
  const values = output.values[design];
  return values ? [...own[design]].map(traceOf(c, label, design, output.unit, run.own_stations[design], values)) : [];
});
const differenceTraces = (c, output) => run.labels.flatMap((label, design) => {
  if (design === 0) return [];
  const less = (value, first) => (value === null || first === null ? null : value - first);
  const values = output.values[design].map((value, row) => less(value, output.values[0][row]));
  return [...common].map(traceOf(c, label, design, output.unit, run.stations, values));
});

const comparePlots = run.own_outputs.map((output) => {
  const shared = run.outputs.find(({ column }) => column === output.column);
  const figure = byId('curve-plots').appendChild(document.createElement('figure'));
  const caption = figure.appendChild(document.createElement('figcaption'));
  caption.append(withUnit(output.title, output.unit));
  const missing = run.labels.filter((_, design) => !output.values[design]);
  if (missing.length) caption.appendChild(document.createElement('small')).textContent = `not of ${missing.join(', ')}`;
  const element = figure.appendChild(document.createElement('div'));
  element.className = 'plot';
  return () => {
    const c = colours();
    const differences = byId('what').value === 'differences';
    figure.hidden = differences && !shared;
    if (figure.hidden) return Promise.resolve();
    const title = `${differences ? 'difference of ' : ''}${output.title}`;
    return draw(element, differences ? differenceTraces(c, shared) : curveTraces(c, output), layout(c, {
      xaxis: axis(c, { title: { text: plain(withUnit(title, output.unit)) }, hoverformat: '.5~g' }),
      yaxis: axis(c, { title: { text: axisTitle(run.drive) } }),
      hovermode: 'y unified',
      showlegend: true,
      legend: below,
    }));
  };
});
const drawAll = () => Promise.all(comparePlots.map((plot) => plot()));
byId('what').addEventListener('change', drawAll);

setTheme(wishes.get('theme'));
drawAll().then(() => {
  root.dataset.plotsExpected = comparePlots.length;
  root.dataset.ready = 'true';
});
