// The front of an optimisation, where one was asked for, and what moving further buys.
const front = record.front;
const frontState = { picked: run.kept_point ?? 0 };

// The study of a point: that of the first one with the lines that differ.
const studyOf = (point) => {
  const lines = [...front.study];
  for (const [number, line] of front.points[point].lines) lines[number] = line;
  return `${lines.join('\n')}\n`;
};

const sayPoint = () => {
  const point = front.points[frontState.picked];
  byId('front-point').value = String(frontState.picked);
  byId('front-study').textContent = studyOf(frontState.picked);
  const [first, second] = point.weights;
  const rate = front.wishes.length === 2 && first > 0 && second > 0 ? `; a tolerance less of ${front.wishes[0]} costs ${brief(Number((first / second).toPrecision(3)))} of ${front.wishes[1]}` : '';
  byId('front-said').textContent = (frontState.picked === run.kept_point ? 'kept: ' : '') + front.wishes.map((name, k) => `${name} ${Number(point.misfits[k].toPrecision(3))}`).join(', ') + rate;
  const table = byId('front-table');
  table.replaceChildren();
  front.variables.forEach((name, k) => {
    const row = document.createElement('tr');
    [name, brief(point.offsets[k])].forEach((text, i) => {
      const cell = document.createElement('td');
      cell.textContent = text;
      if (i) cell.className = 'number';
      row.append(cell);
    });
    table.append(row);
  });
  root.dataset.frontPoint = frontState.picked + 1;
};

const drawFront = async () => {
  if (!front || !front.points.length) return;
  const c = colours();
  const amounts = front.wishes.map((_, k) => front.points.map((point) => point.misfits[k]));
  const numbers = front.points.map((_, k) => k);
  // A line from point to point, broken where the front is.
  const broken = (values) => values.flatMap((v, k) => (front.breaks.includes(k) ? [v, null] : [v]));
  const solid = front.wishes.length > 2;
  const label = front.wishes.map((name, k) => `${plain(name)} %{${'xyz'[k]}:.3~g}`).join('<br>');
  const place = (values) => ({ x: values[0], y: values[1], ...(solid && { z: values[2] }) });
  const at = (k) => amounts.map((values) => [values[k]]);
  const type = solid ? 'scatter3d' : 'scatter';
  const traces = [
    {
      type, mode: 'markers', ...place(amounts), customdata: numbers.map((k) => k + 1),
      marker: { size: solid ? 4 : 7, color: c.accent }, hovertemplate: `point %{customdata}<br>${label}<extra></extra>`,
    },
    {
      type, mode: 'markers', ...place(at(frontState.picked)), hoverinfo: 'skip',
      marker: { symbol: 'square-open', size: solid ? 8 : 15, color: c.ink, line: { color: c.ink, width: 1.5 } },
    },
  ];
  if (run.kept_point !== null) {
    traces.push({
      type, mode: 'markers+text', ...place(at(run.kept_point)), hoverinfo: 'skip', text: ['kept'], textposition: 'top right',
      textfont: { color: c.target }, marker: { symbol: 'circle-open', size: solid ? 9 : 18, color: c.target, line: { color: c.target, width: 2 } },
    });
  }
  if (!solid) traces.unshift({ type, mode: 'lines', ...place(amounts.map(broken)), hoverinfo: 'skip', line: { color: c.before, width: 1.2 } });
  const titles = front.wishes.map((name) => ({ title: { text: `misfit of ${plain(name)}` }, rangemode: 'tozero' }));
  const figure = solid
    ? { scene: { xaxis: axis(c, titles[0]), yaxis: axis(c, titles[1]), zaxis: axis(c, titles[2]) } }
    : { xaxis: axis(c, titles[0]), yaxis: axis(c, titles[1]) };
  await draw(byId('front-plot'), traces, layout(c, { ...figure, hovermode: 'closest', showlegend: false }));
  sayPoint();
};

const setUpFront = () => {
  if (!front || !front.points.length) return;
  front.points.forEach((_, k) => option(byId('front-point'), String(k), `${k + 1}${k === run.kept_point ? ', kept' : ''}`));
  const pick = (point) => {
    frontState.picked = point;
    drawFront();
  };
  byId('front-point').addEventListener('change', (e) => pick(Number(e.target.value)));
  byId('front-save').addEventListener('click', () => {
    const link = document.createElement('a');
    link.href = URL.createObjectURL(new Blob([studyOf(frontState.picked)], { type: 'text/plain' }));
    link.download = `${record.study}_front_${frontState.picked + 1}.toml`;
    link.click();
    URL.revokeObjectURL(link.href);
  });
  drawFront().then(() => byId('front-plot').on('plotly_click', ({ points: [clicked] }) => clicked.customdata && pick(clicked.customdata - 1)));
};

const drawPrices = async () => {
  if (!run.prices.length) return;
  const c = colours();
  const kept = run.prices.filter((step) => step.kept);
  const trace = (steps, more) => ({ type: 'scatter', x: steps.map((s) => s.moved), y: steps.map((s) => s.misfit), hovertemplate: 'moved %{x:.3~g}<br>misfit %{y:.3~g}<extra></extra>', ...more });
  await draw(byId('prices-plot'), [
    trace(run.prices, { mode: 'lines+markers', line: { color: c.accent, width: 2 }, marker: { size: 6 } }),
    trace(kept, { mode: 'markers', name: 'kept', marker: { symbol: 'circle-open', size: 14, color: c.target, line: { color: c.target, width: 2 } } }),
  ], layout(c, {
    xaxis: axis(c, { title: { text: 'move [ranges]' }, rangemode: 'tozero' }),
    yaxis: axis(c, { title: { text: 'misfit [tolerances]' }, rangemode: 'tozero' }),
    showlegend: false,
  }));
};
