// Which variable moves which output.
const measures = {
  share: { name: 'share of the variance', say: (v) => `${Math.round(100 * v)}%`, least: 0.005 },
  total: { name: 'total index', say: (v) => `${Math.round(100 * v)}%`, least: 0.005 },
  change: { name: 'change over the range', say: (v) => `${v > 0 ? '+' : ''}${Number(v.toPrecision(3))}`, least: 0 },
};
const variableTitles = columns.slice(0, first.variables).map((_, k) => plain(columns[k].title));
const effectOf = (k, variable, measure) => run.effects[k].effects[variable]?.[measure] ?? null;
// What nothing moves has effects of rounding.
const moved = run.effects.map((_, k) => k).filter((k) => !run.unmoved.includes(k))
  .filter((k) => variableTitles.some((_, v) => effectOf(k, v, 'change') !== null));
const offered = Object.keys(measures).filter((m) => moved.some((k) => variableTitles.some((_, v) => effectOf(k, v, m) !== null)));

// A change is compared within its output, a share is a share.
const strengthOf = (k, variable, measure) => {
  const found = effectOf(k, variable, measure);
  if (found === null || measure !== 'change') return found;
  const largest = Math.max(...variableTitles.map((_, v) => Math.abs(effectOf(k, v, measure) ?? 0)));
  return largest > 0 ? found / largest : 0;
};

const drawEffects = async () => {
  if (!offered.length) return;
  const c = colours();
  const measure = byId('effect-measure').value;
  const { say, least } = measures[measure];
  const ranked = variableTitles.map((_, v) => v)
    .map((v) => [v, Math.max(0, ...moved.map((k) => Math.abs(strengthOf(k, v, measure) ?? 0)))])
    .sort((a, b) => b[1] - a[1] || a[0] - b[0]).slice(0, 24).map(([v]) => v);
  const cells = (f) => moved.map((k) => ranked.map((v) => f(k, v, effectOf(k, v, measure))));
  const element = byId('effects-map');
  element.style.height = `${150 + 23 * moved.length}px`;
  const signed = measure === 'change';
  await draw(element, [{
    type: 'heatmap', x: ranked.map((v) => variableTitles[v]), y: moved.map((k) => titled(first.variables + k)),
    z: cells((k, v) => strengthOf(k, v, measure)), zmin: signed ? -1 : 0, zmax: 1, showscale: false, xgap: 1, ygap: 1,
    colorscale: signed ? [[0, c.target], [0.5, c.panel], [1, c.strong]] : [[0, c.panel], [1, c.strong]],
    text: cells((k, v, found) => (found === null || Math.abs(found) < least ? '' : say(found))), texttemplate: '%{text}',
    hovertemplate: '%{x} on %{y}: %{text}<extra></extra>',
  }], layout(c, {
    xaxis: axis(c, { side: 'top', tickangle: -35, showgrid: false, fixedrange: true }),
    yaxis: axis(c, { autorange: 'reversed', showgrid: false, fixedrange: true }),
    margin: { l: 10, r: 70, t: 36, b: 10 },
  }), still);
  await drawEffectRanking();
};

const drawEffectRanking = async () => {
  const c = colours();
  const measure = byId('effect-measure').value;
  const k = Number(byId('effect-output').value);
  const ranked = variableTitles.map((title, v) => [title, effectOf(k, v, measure)]).filter(([, found]) => found !== null)
    .sort((a, b) => Math.abs(b[1]) - Math.abs(a[1])).slice(0, 20);
  const element = byId('effects-bars');
  element.style.height = `${120 + 26 * ranked.length}px`;
  const { column, r2 } = run.effects[k];
  const unit = columns[first.variables + k].unit;
  const title = measure === 'change'
    ? `${withUnit(`change of ${column}`, unit)}${r2 === null ? '' : `; the plane explains ${Math.round(100 * r2)}% of the variance`}`
    : `${measures[measure].name} of ${column}`;
  await draw(element, [{
    type: 'bar', orientation: 'h', x: ranked.map(([, found]) => found), y: ranked.map(([name]) => name),
    marker: { color: ranked.map(([, found]) => (found < 0 ? c.target : c.accent)) },
    hovertemplate: '%{y}: %{x:.4~g}<extra></extra>',
  }], layout(c, {
    xaxis: axis(c, { title: { text: plain(title), font: { size: 11 } }, rangemode: 'tozero', fixedrange: true, ...(measure !== 'change' && { tickformat: '.0%' }) }),
    yaxis: axis(c, { autorange: 'reversed', fixedrange: true }),
    margin: { l: 10, r: 16, t: 30, b: 44 },
  }), still);
};
