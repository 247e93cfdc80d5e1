// Every output of several designs over the motion, or their differences from the first.
const moving = run.motion.flatMap((column, k) => (column.moves ? [k] : []));
if (moving.length === 0) moving.push(0);
const over = byId('over');
moving.forEach((k) => over.add(new Option(axisTitle(run.motion[k].column), k)));
over.hidden = moving.length < 2;

// A curve for each value of the next number that moves; the others are where they are nearest to zero.
const curvesOver = (k) => {
  const [apart, ...rest] = moving.filter((other) => other !== k);
  const least = rest.map((other) => run.stations.map((at) => at[other])
    .reduce((a, b) => (Math.abs(b) < Math.abs(a) ? b : a)));
  const groups = new Map();
  run.stations.forEach((at, row) => {
    if (rest.some((other, i) => at[other] !== least[i])) return;
    const key = apart === undefined ? 0 : at[apart];
    if (!groups.has(key)) groups.set(key, []);
    groups.get(key).push(row);
  });
  groups.forEach((rows) => rows.sort((a, b) => run.stations[a][k] - run.stations[b][k]));
  return { groups, name: apart === undefined ? '' : axisTitle(run.motion[apart].column) };
};

const dashes = ['solid', 'dash', 'dot', 'dashdot', 'longdash'];
const compareTraces = (c, output, differences, k) => run.labels.flatMap((label, design) => {
  if (differences && design === 0) return [];
  const values = output.values[design];
  const value = (row) => {
    if (!differences) return values[row];
    const first = output.values[0][row];
    return values[row] === null || first === null ? null : values[row] - first;
  };
  const { hues } = c;
  const { groups, name } = curvesOver(k);
  return [...groups].map(([place, rows], number) => ({
    type: 'scatter', mode: 'lines', connectgaps: false, legendgroup: label, showlegend: number === 0,
    name: plain(label), text: groups.size > 1 ? rows.map(() => `${name} ${brief(place)}`) : undefined,
    x: rows.map(value), y: rows.map((row) => run.stations[row][k]),
    line: { color: hues[design % hues.length], dash: dashes[design % dashes.length], width: 2 },
    opacity: 0.35 + (0.65 * (number + 1)) / groups.size,
  }));
});

const comparePlots = run.outputs.map((output) => {
  const figure = byId('curve-plots').appendChild(document.createElement('figure'));
  figure.appendChild(document.createElement('figcaption')).append(withUnit(output.title, output.unit));
  const element = figure.appendChild(document.createElement('div'));
  element.className = 'plot';
  return () => {
    const c = colours();
    const k = Number(over.value);
    const differences = byId('what').value === 'differences';
    const title = `${differences ? 'difference of ' : ''}${output.title}`;
    return draw(element, compareTraces(c, output, differences, k), layout(c, {
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
