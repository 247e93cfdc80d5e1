// Every output of several designs over the motion, or their differences from the first.
const byRack = new Map();
run.stations.forEach(([, rack], row) => {
  if (!byRack.has(rack)) byRack.set(rack, []);
  byRack.get(rack).push(row);
});

const dashes = ['solid', 'dash', 'dot', 'dashdot', 'longdash'];
const compareTraces = (c, output, differences) => run.labels.flatMap((label, design) => {
  if (differences && design === 0) return [];
  const values = output.values[design];
  const value = (row) => {
    if (!differences) return values[row];
    const first = output.values[0][row];
    return values[row] === null || first === null ? null : values[row] - first;
  };
  const { hues } = c;
  return [...byRack].map(([rack, rows], number) => ({
    type: 'scatter', mode: 'lines', connectgaps: false, legendgroup: label, showlegend: number === 0,
    name: plain(label), text: byRack.size > 1 ? rows.map(() => `rack ${brief(rack)}`) : undefined,
    x: rows.map(value), y: rows.map((row) => run.stations[row][0]),
    line: { color: hues[design % hues.length], dash: dashes[design % dashes.length], width: 2 },
    opacity: 0.35 + (0.65 * (number + 1)) / byRack.size,
  }));
});

const comparePlots = run.outputs.map((output) => {
  const figure = byId('curve-plots').appendChild(document.createElement('figure'));
  figure.appendChild(document.createElement('figcaption')).append(withUnit(output.title, output.unit));
  const element = figure.appendChild(document.createElement('div'));
  element.className = 'plot';
  return () => {
    const c = colours();
    const differences = byId('what').value === 'differences';
    const title = `${differences ? 'difference of ' : ''}${output.title}`;
    return draw(element, compareTraces(c, output, differences), layout(c, {
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
