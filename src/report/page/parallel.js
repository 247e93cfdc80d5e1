// Designs as lines over several axes, each scaled to the designs drawn.
const parallel = byId('parallel-plot');
const MOST_AXES = 12;
const SHADES = 8;

// The variables that matter most, then the deviations from the targets, or else what the designs are.
const parallelAxes = (state) => {
  const strength = (k) => Math.max(0, ...run.effects.map((o) => o.effects[k]?.share ?? 0));
  const variables = columns.map((_, k) => k).slice(0, first.variables);
  const chosen = variables.sort((a, b) => strength(b) - strength(a) || a - b).slice(0, MOST_AXES - 4).sort((a, b) => a - b);
  const outputs = first.misfit === null
    ? columns.map((_, k) => k).slice(first.variables).filter((k) => columns[k].kind === 'gain')
    : [...first.deviations.slice(0, 3), first.misfit];
  const more = state.more === null || outputs.includes(state.more) ? [] : [state.more];
  return [...chosen, ...outputs.slice(0, MOST_AXES - chosen.length), ...more];
};

const drawParallel = async (state) => {
  const c = colours();
  const axes = parallelAxes(state);
  const ranges = axes.map((k) => {
    const values = shown.columns[k].filter((v) => v !== null);
    return values.length ? [quantile(values, 0), quantile(values, 1)] : [0, 1];
  });
  const height = (i, v) => {
    const [low, high] = ranges[i];
    if (v === null) return null;
    return high > low ? (v - low) / (high - low) : 0.5;
  };
  const trace = (rows, name, line, opacity) => ({
    type: 'scatter', mode: 'lines', name, opacity, line, connectgaps: false, hoverlabel: { namelength: -1 },
    x: rows.flatMap(() => [...axes.keys(), null]),
    y: rows.flatMap((row) => [...axes.map((k, i) => height(i, value(k, row))), null]),
    text: rows.flatMap((row) => [...axes.map((k) => `design ${shown.design[row]}<br>${titled(k)}: ${value(k, row) === null ? 'none' : brief(value(k, row))}`), '']),
    hovertemplate: '%{text}<extra></extra>',
  });
  const selected = (row) => state.selected === null || state.selected.has(row);
  const others = allRows.filter((row) => isWhole(row) && !marked.has(row) && selected(row));
  const failed = allRows.filter((row) => !isWhole(row) && selected(row));
  // In shades of the column that colours the points above, equally many designs in each, the strongest on top.
  const shades = () => {
    if (state.colour === 'status') return [trace(others, 'designs', { color: c.before, width: 1 }, 0.4)];
    const sorted = [...others].sort((a, b) => value(state.colour, b) - value(state.colour, a));
    return Array.from({ length: SHADES }, (_, shade) => {
      const rows = sorted.slice(...[shade, shade + 1].map((n) => Math.round((n * sorted.length) / SHADES)));
      const line = { color: along(scaleOf(c, state.colour), 1 - shade / (SHADES - 1)), width: 0.8 };
      return { ...trace(rows, 'designs', line, 0.3), legendgroup: 'designs', showlegend: shade === SHADES - 1 };
    });
  };
  const traces = [
    ...shades(),
    trace(failed, 'not solved everywhere', { color: c.bad, width: 1 }, Math.min(0.7, Math.max(0.1, 40 / (failed.length + 1)))),
    trace(frontRows.filter(selected), 'Pareto front', { color: c.target, width: 2 }, 1),
    trace(bestRows.filter(selected), 'best', { color: c.accent, width: 2.4 }, 1),
    trace(state.picked === null ? [] : [state.picked], 'chosen', { color: c.ink, width: 2.5, dash: 'dot' }, 1),
  ].filter((t) => t.x.length);
  const end = (i, y, v, yanchor) => ({
    x: i, y, text: plain(Number(v.toPrecision(3))), showarrow: false, yanchor, font: { size: 11, color: c.muted }, bgcolor: 'rgba(0,0,0,0)',
  });
  const ends = axes.flatMap((_, i) => [end(i, 1.01, ranges[i][1], 'bottom'), end(i, -0.01, ranges[i][0], 'top')]);
  await draw(parallel, traces, layout(c, {
    xaxis: axis(c, {
      tickvals: [...axes.keys()], ticktext: axes.map(titled), range: [-0.4, axes.length - 0.6], gridcolor: c.muted,
      zeroline: false, tickangle: axes.length * 150 > parallel.clientWidth ? -35 : 0, fixedrange: true,
    }),
    yaxis: { range: [-0.08, 1.08], visible: false, fixedrange: true },
    annotations: ends, hovermode: 'closest', dragmode: false, showlegend: true,
    legend: { orientation: 'h', y: 1.02, yanchor: 'bottom', x: 0 },
    margin: { l: 24, r: 24, t: 64, b: 48 },
  }), still);
  byId('parallel-selected').textContent = state.selected === null ? '' : `${state.selected.size} designs selected above; a double click there takes all again.`;
};
