// Every output over the motion: the designs, the target with its tolerance, and what was not solved.
const column = (table, name) => table.columns[table.header.indexOf(name)];

// What curves are told apart by: the rack; of an axle the first of what else moves, the rest nearest to zero.
const others = ({ abscissa }) => (record.further?.length
  ? [record.drive, ...record.further].filter((name) => name !== abscissa)
  : record.rack ? [record.rack] : []);
const nearestToZero = (values) => values.reduce((best, v) => (Math.abs(v) < Math.abs(best) ? v : best));

// Rows of a table by rack displacement, each with the station it is.
const families = (table, design, state) => {
  const stations = record.designs[design].stations;
  const rows = table.status.length;
  const station = (row) => (rows === stations ? row : Math.floor((row * (stations - 1)) / (rows - 1)));
  const [apart, ...held] = others(state);
  const racks = apart ? column(table, apart) : null;
  const rest = held.map((name) => [column(table, name), nearestToZero(column(table, name))]);
  const byRack = new Map();
  for (let row = 0; row < rows; row += 1) {
    if (rest.some(([values, value]) => values[row] !== value)) continue;
    const rack = racks ? racks[row] : 0;
    if (!byRack.has(rack)) byRack.set(rack, []);
    byRack.get(rack).push({ row, station: station(row) });
  }
  return byRack;
};

// A trace with the motion upright, or lying.
const turned = (upright, trace) => {
  if (upright) return trace;
  const { x, y, xaxis, error_x: bar, ...rest } = trace;
  return { ...rest, x: y, y: x, ...(xaxis && { yaxis: 'y2' }), ...(bar && { error_y: bar }) };
};

// Designs beside the one that matters, which is the last: percentiles stand in pairs about it.
const dashes = ['dash', 'dot', 'dashdot', 'longdash'];
const besides = (design) => Math.max(0, Math.min(design, record.designs.length - 2 - design));

// Each rack has its colour, whichever the design.
const rackColour = (c, number, all) => {
  if (all <= c.hues.length) return c.hues[number];
  return mixed(c.target, c.accent, number / (all - 1));
};
const isSolved = (status) => ['ok', 'ill_conditioned', 'unsupported', 'toggle'].includes(status);

// Each wheel has its colour in a plot of both.
const sideOf = (output) => /^(left|right)_/.exec(output.column)?.[1];
const designTraces = (c, output, state, design, isPair) => {
  const table = run.curves[design];
  const values = column(table, output.column);
  const places = column(table, state.abscissa);
  const { label, failures } = record.designs[design];
  const byRack = families(table, design, state);
  const [apart] = others(state);
  const [, apartName, apartUnit] = /^(.*) \[(.*)\]$/.exec(axisTitle(apart ?? 'rack_mm'));
  const main = isMain(state, design);
  const only = shownDesigns(state).length === 1;
  const traces = [];
  const side = isPair ? sideOf(output) : null;
  const present = nearestToZero([...byRack.keys()]);
  let number = 0;
  for (const [rack, rows] of byRack) {
    const rackName = `${apartName} ${brief(rack)} ${apartUnit}`;
    const several = byRack.size > 1;
    const ofSide = side === 'right' ? c.hues[3] : c.accent;
    const colour = side ? (main ? ofSide : mixed(ofSide, c.before, 0.6)) : several ? rackColour(c, number, byRack.size) : main ? c.accent : c.before;
    // Of many racks the legend names the first, the last and one between.
    const named = byRack.size <= c.hues.length || [0, Math.floor(byRack.size / 2), byRack.size - 1].includes(number);
    const words = !several ? label : main ? rackName : `${label} (dashed)`;
    const name = !side ? words : main ? `${side}${several ? `, strong at ${apartName} ${brief(present)} ${apartUnit}` : ''}` : `${side}, ${label}`;
    traces.push({
      type: 'scatter', mode: 'lines+markers', connectgaps: false, name: plain(name),
      legendgroup: several && !main ? label : undefined, showlegend: side ? (main ? rack === present : number === 0) : several && !main ? number === 0 : named,
      legendrank: main ? 1000 : 1100,
      hovertemplate: `%{${state.upright ? 'x' : 'y'}:.5~g} ${plain(output.unit)}<extra>${plain([side, several ? (only ? rackName : `${label}, ${rackName}`) : only && side ? null : label].filter(Boolean).join(', '))}</extra>`,
      hoverlabel: { namelength: -1 },
      marker: { size: 6, color: 'rgba(0,0,0,0)' },
      x: rows.map(({ row }) => values[row]), y: rows.map(({ row }) => places[row]),
      line: { color: colour, width: main ? 2.2 : 1.6, dash: main ? 'solid' : dashes[besides(design) % dashes.length] },
      opacity: side && several && rack !== present ? 0.28 : several && !main ? 0.6 : 1,
    });
    number += 1;
    const failed = rows.filter(({ row }) => !isSolved(table.status[row]) && places[row] !== null);
    if (failed.length) {
      const reason = ({ station }) => failures.find((f) => f.first <= station && station <= f.last)?.reason ?? 'not solved';
      traces.push({
        type: 'scatter', mode: 'markers', name: plain(`${label}, not solved`), legendgroup: `${label}, not solved`,
        showlegend: !traces.some((t) => t.xaxis), xaxis: 'x2', legendrank: 1200,
        x: failed.map(() => (main ? 0.02 : 0.05)), y: failed.map(({ row }) => places[row]),
        text: failed.map((f) => plain(reason(f))), hovertemplate: `${several ? `${rackName}: ` : ''}%{text}<extra></extra>`,
        marker: { symbol: 'x-thin', size: 6, line: { color: main ? c.bad : c.before, width: 1.5 } },
      });
    }
  }
  return traces;
};

// Targets are given by drive value; over anything else they are where the last design has that value.
const targetTraces = (c, output, state) => {
  const { abscissa } = state;
  const table = run.curves[run.curves.length - 1];
  const place = (drive, over) => {
    if (abscissa === (over ?? record.drive)) return drive;
    if (over) return null;
    const row = column(table, record.drive).indexOf(drive);
    return row < 0 ? null : column(table, abscissa)[row];
  };
  return record.targets.filter((t) => t.column === output.column).flatMap((target) => {
    const points = target.points.map(([drive, value]) => [place(drive, target.over), value]).filter(([at]) => at !== null);
    const y = points.map(([at]) => at);
    const x = points.map(([, value]) => value);
    const shared = { type: 'scatter', legendgroup: 'target', name: 'target ± tolerance', hoverlabel: { namelength: -1 } };
    const said = `%{${state.upright ? 'x' : 'y'}:.5~g} ± ${brief(target.tolerance)} ${plain(output.unit)}<extra>target</extra>`;
    if (!points.length) return [];
    if (points.length === 1) {
      return [{
        ...shared, hovertemplate: said, mode: 'markers', x, y, marker: { color: c.target, size: 8, symbol: 'diamond' },
        error_x: { type: 'constant', value: target.tolerance, color: c.target, thickness: 2, width: 5 },
      }];
    }
    const band = [...x.map((v) => v + target.tolerance), ...x.map((v) => v - target.tolerance).reverse()];
    return [
      {
        ...shared, mode: 'lines', x: band, y: [...y, ...[...y].reverse()], fill: 'toself', showlegend: false,
        fillcolor: faint(c.target, 0.25), line: { width: 0 }, hoverinfo: 'skip',
      },
      { ...shared, hovertemplate: said, mode: 'lines', x, y, line: { color: c.target, width: 1.2, dash: 'dot' } },
    ];
  });
};

// Bands: limits are lines, and what lies between two of them is shaded.
const bandTraces = (c, output, { abscissa }) => {
  const table = run.curves[run.curves.length - 1];
  const place = (drive) => {
    if (abscissa === record.drive) return drive;
    const row = column(table, record.drive).indexOf(drive);
    return row < 0 ? null : column(table, abscissa)[row];
  };
  return (record.bands ?? []).filter((band) => band.column === output.column).flatMap(({ limits }) => {
    const at = limits.map(([drive, low, high]) => [place(drive), low, high]).filter(([y]) => y !== null);
    const shared = { type: 'scatter', legendgroup: 'band', name: 'wanted', hoverinfo: 'skip' };
    const edge = (k) => {
      const points = at.filter((limit) => limit[k] !== null);
      if (!points.length) return [];
      const looks = points.length === 1 ? { mode: 'markers', marker: { color: c.target, size: 9, symbol: 'line-ns-open', line: { width: 2, color: c.target } } } : { mode: 'lines', line: { color: c.target, width: 1.6 } };
      return [{ ...shared, ...looks, x: points.map((limit) => limit[k]), y: points.map(([y]) => y), showlegend: false }];
    };
    const both = at.filter(([, low, high]) => low !== null && high !== null);
    const fill = both.length > 1 ? [{
      ...shared, mode: 'lines', fill: 'toself', fillcolor: faint(c.target, 0.18), line: { width: 0 },
      x: [...both.map(([, low]) => low), ...both.map(([, , high]) => high).reverse()],
      y: [...both.map(([y]) => y), ...both.map(([y]) => y).reverse()],
    }] : [];
    return [...fill, ...edge(1), ...edge(2)].map((trace, k) => ({ ...trace, showlegend: k === 0 }));
  });
};

// Where the tuned design misses a target by more than its tolerance, with the rack straight ahead.
const missTraces = (c, output, { abscissa }) => {
  if (!run.missed?.length) return [];
  const table = run.curves[run.curves.length - 1];
  const racks = record.rack ? column(table, record.rack) : null;
  const [drives, values, places] = [record.drive, output.column, abscissa].map((name) => column(table, name));
  const own = (wanted) => wanted.column === output.column && !wanted.over;
  const targets = record.targets.filter(own).map(({ points, tolerance }) => ({ tolerance, limits: points.map(([drive, value]) => [drive, value, value]) }));
  const missed = [...targets, ...(record.bands ?? []).filter(own)].flatMap(({ limits, tolerance }) => limits.flatMap(([drive, low, high]) => {
    const row = drives.findIndex((d, i) => d === drive && (!racks || racks[i] === 0));
    const value = row < 0 ? null : values[row];
    const outside = value !== null && ((low !== null && value < low - tolerance) || (high !== null && value > high + tolerance));
    return outside ? [row] : [];
  }));
  if (!missed.length) return [];
  return [{
    type: 'scatter', mode: 'markers', name: 'missed', legendrank: 1150, hoverinfo: 'skip',
    x: missed.map((row) => values[row]), y: missed.map((row) => places[row]),
    marker: { symbol: 'circle-open', size: 9, color: c.bad, line: { width: 1.8 } },
  }];
};

// What an output is drawn over: what is chosen, or what is natural for it.
const over = (output, state) => (state.abscissa === 'natural' ? { ...state, abscissa: run.natural[output.column] ?? record.drive } : state);

const drawCurve = (element, outputs, chosen) => {
  const c = colours();
  const [output] = outputs;
  const state = over(output, chosen);
  const isPair = outputs.length > 1;
  const title = isPair ? titleOfBoth(output) : output.title;
  const traces = outputs.flatMap((one) => [
    ...bandTraces(c, one, state),
    ...targetTraces(c, one, state),
    ...shownDesigns(state).flatMap((design) => designTraces(c, one, state, design, isPair)),
    ...missTraces(c, one, state),
  ]).map((trace) => turned(state.upright, trace));
  // A single line needs no name: the caption has it.
  const named = traces.filter((trace) => trace.showlegend !== false && trace.x.length);
  const motion = axis(c, { title: { text: axisTitle(state.abscissa) } });
  const value = axis(c, { title: { text: plain(withUnit(title, output.unit)) }, hoverformat: '.5~g' });
  const edge = { range: [0, 1], visible: false, fixedrange: true };
  const axes = state.upright
    ? { xaxis: value, yaxis: motion, xaxis2: { ...edge, overlaying: 'x' } }
    : { xaxis: motion, yaxis: value, yaxis2: { ...edge, overlaying: 'y' } };
  return draw(element, traces, layout(c, {
    ...axes,
    hovermode: state.upright ? 'y unified' : 'x unified',
    showlegend: named.length > 1,
    legend: below,
    uirevision: `${state.abscissa} ${state.upright} ${shownDesigns(state)}`,
  }));
};

// Outputs of both wheels belong into one plot.
const titleOfBoth = ({ title }) => `${title.replace(/^(left|right) /, '')}, both wheels`;
const plotsOf = (outputs) => {
  const known = new Map(outputs.map((output) => [output.column, output]));
  return outputs.flatMap((output) => {
    const side = sideOf(output);
    const other = side && known.get(output.column.replace(/^(left|right)/, side === 'left' ? 'right' : 'left'));
    if (!other) return [[output]];
    return side === 'left' ? [[output, other]] : [];
  });
};

const curvePlots = plotsOf(record?.outputs ?? []).map((outputs) => {
  const [output] = outputs;
  const figure = byId('curve-plots').appendChild(document.createElement('figure'));
  const caption = figure.appendChild(document.createElement('figcaption'));
  caption.append(withUnit(outputs.length > 1 ? titleOfBoth(output) : output.title, output.unit));
  if (output.positive && output.positive !== 'always') {
    caption.appendChild(document.createElement('small')).textContent = `positive: ${output.positive}`;
  }
  for (const [missed, by] of run.missed ?? []) {
    if (!outputs.some(({ column: own }) => own === missed)) continue;
    const small = caption.appendChild(document.createElement('small'));
    small.className = 'unmet';
    small.textContent = `target missed by up to ${by}`;
  }
  const element = figure.appendChild(document.createElement('div'));
  element.className = 'plot';
  return (state) => drawCurve(element, outputs, state);
});
