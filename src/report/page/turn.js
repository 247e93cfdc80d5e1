// A steered axle from above, in the body's axes: both wheels, their spin axes to the other axle's line, and the
// centre that the vehicle turns about. Where the stage's sliders are.
const turnPlot = byId('turn-plot');
const turnOf = (design, place) => frameAt(design, place).pose.Ok?.turn ?? null;
const hasTurn = allFrames.some((f) => f.pose.Ok?.turn?.centre);

const turnTraces = (c, state, design) => {
  const turn = turnOf(design, state.place);
  if (!turn) return [];
  const main = isMain(state, design);
  const { label } = record.designs[design];
  const colour = main ? c.accent : c.before;
  // Forward is up and left is left: x of the drawing is against the study's y.
  const seen = (points) => ({ x: points.map((p) => p && -p[1] * outboard), y: points.map((p) => p && p[0] * forward) });
  const line = (points, more) => ({ type: 'scatter', mode: 'lines', hoverinfo: 'skip', legendgroup: label, showlegend: false, ...seen(points), ...more });
  const wheels = turn.wheels.flatMap((ends) => [...ends, null]);
  const middles = turn.wheels.map(([a, b]) => a.map((v, k) => (v + b[k]) / 2));
  const half = Math.max(...turn.wheels.flat().map((end) => Math.abs(end[1])));
  const other = [[turn.other_axle, -half], [turn.other_axle, half]];
  const axes = turn.meets ? turn.meets.flatMap((meet, k) => [middles[k], meet, null]) : [];
  return [
    line(axes, { line: { color: colour, width: 1.2, dash: main ? 'solid' : 'dash' } }),
    line(other, { line: { color: c.muted, width: 3 } }),
    line(wheels, { name: plain(label), showlegend: true, line: { color: main ? c.wheel : c.before, width: 7 } }),
    ...(turn.centre ? [{
      type: 'scatter', mode: 'markers', name: plain(`${label}: centre of the turn`), legendgroup: label, showlegend: main,
      ...seen([turn.centre]), marker: { symbol: 'diamond', size: 9, color: colour },
      hovertemplate: `%{x:.0f}, %{y:.0f} ${record.length_unit}<extra>centre of the turn</extra>`,
    }] : []),
  ];
};

const drawTurn = async (state) => {
  byId('turn').hidden = !hasTurn;
  if (!hasTurn) return;
  const c = colours();
  const traces = shownDesigns(state).flatMap((design) => turnTraces(c, state, design));
  await draw(turnPlot, traces, layout(c, {
    xaxis: axis(c, { title: { text: `to the right [${record.length_unit}]` }, constrain: 'domain' }),
    yaxis: axis(c, { title: { text: `forward [${record.length_unit}]` }, scaleanchor: 'x', scaleratio: 1 }),
    hovermode: 'closest', showlegend: traces.filter((trace) => trace.showlegend).length > 1, legend: { orientation: 'h', y: 1.02, yanchor: 'bottom', x: 0 },
  }));
  const turn = turnOf(record.designs.length - 1, state.place);
  byId('turn-text').textContent = turn?.centre ? '' : 'Straight ahead: the spin axes are almost parallel to the other axle. Move the slider of the rack or steering wheel.';
};
