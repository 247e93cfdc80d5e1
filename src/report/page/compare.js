// Every output of several designs over the motion, each at its own stations, or their differences from the first at the
// stations that all of them have.
const movesIn = (stations, k) => stations.some((at) => at[k] !== stations[0][k]);
const moving = run.motion.flatMap((_, k) => (run.own_stations.some((stations) => movesIn(stations, k)) ? [k] : []));
if (moving.length === 0) moving.push(0);
const over = byId('over');
moving.forEach((k) => over.add(new Option(axisTitle(run.motion[k].column), k)));
over.value = moving.find((k) => run.motion[k].moves) ?? moving[0];
over.hidden = moving.length < 2;

// A curve for each value of the next number that moves; the others are where they are nearest to zero.
const curvesOver = (stations, k) => {
  const [apart, ...rest] = moving.filter((other) => other !== k);
  const least = rest.map((other) => stations.map((at) => at[other])
    .reduce((a, b) => (Math.abs(b) < Math.abs(a) ? b : a)));
  const groups = new Map();
  stations.forEach((at, row) => {
    if (rest.some((other, i) => at[other] !== least[i])) return;
    const key = apart === undefined ? 0 : at[apart];
    if (!groups.has(key)) groups.set(key, []);
    groups.get(key).push(row);
  });
  groups.forEach((rows) => rows.sort((a, b) => stations[a][k] - stations[b][k]));
  if (groups.size < 2) return [...groups.values()].map((rows) => ({ rows, place: '' }));
  const [, name, unit] = /^(.*) \[(.*)\]$/.exec(axisTitle(run.motion[apart].column));
  return [...groups].map(([place, rows]) => ({ rows, place: `, ${name} ${brief(place)} ${unit}` }));
};

const dashes = ['solid', 'dash', 'dot', 'dashdot', 'longdash'];
const tracesOf = (c, design, unit, stations, values, k) => curvesOver(stations, k).map(({ rows, place }, number, all) => ({
  type: 'scatter', mode: 'lines', connectgaps: false, legendgroup: run.labels[design], showlegend: number === 0,
  name: plain(run.labels[design]), hoverlabel: { namelength: -1 },
  hovertemplate: `%{x:.5~g} ${plain(unit)}<extra>${plain(run.labels[design] + place)}</extra>`,
  x: rows.map((row) => values[row]), y: rows.map((row) => stations[row][k]),
  line: { color: c.hues[design % c.hues.length], dash: dashes[design % dashes.length], width: 2 },
  opacity: 0.35 + (0.65 * (number + 1)) / all.length,
}));
const curveTraces = (c, output, k) => run.labels.flatMap((_, design) => {
  const values = output.values[design];
  return values ? tracesOf(c, design, output.unit, run.own_stations[design], values, k) : [];
});
const differenceTraces = (c, output, k) => run.labels.flatMap((_, design) => {
  if (design === 0) return [];
  const less = (value, first) => (value === null || first === null ? null : value - first);
  const values = output.values[design].map((value, row) => less(value, output.values[0][row]));
  return tracesOf(c, design, output.unit, run.stations, values, k);
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
    const k = Number(over.value);
    const differences = byId('what').value === 'differences';
    figure.hidden = differences && !shared;
    if (figure.hidden) return Promise.resolve();
    const title = `${differences ? 'difference of ' : ''}${output.title}`;
    return draw(element, differences ? differenceTraces(c, shared, k) : curveTraces(c, output, k), layout(c, {
      xaxis: axis(c, { title: { text: plain(withUnit(title, output.unit)) }, hoverformat: '.5~g' }),
      yaxis: axis(c, { title: { text: axisTitle(run.motion[k].column) } }),
      hovermode: 'y unified',
      showlegend: true,
      legend: below,
    }));
  };
});
const drawAll = () => Promise.all(comparePlots.map((plot) => plot()));
byId('what').addEventListener('change', drawAll);
over.addEventListener('change', drawAll);

setTheme(wishes.get('theme'));
drawAll().then(() => {
  root.dataset.plotsExpected = comparePlots.length;
  root.dataset.ready = 'true';
});
