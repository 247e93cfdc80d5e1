// Effects of variables on outputs.
const measures = {
  share: { name: 'share of the variance', say: (v) => `${Math.round(100 * v)} %`, least: 0.005 },
  total: { name: 'total index', say: (v) => `${Math.round(100 * v)} %`, least: 0.005 },
  change: { name: 'change over the range', say: (v) => signed(v, 3), least: 0 },
};
const MOST_VARIABLES = 24;
const variableTitles = columns.slice(0, first.variables).map(({ title }) => title);
const effectOf = (k, variable, measure) => run.effects[k].effects[variable]?.[measure] ?? null;
// Outputs that no variable changes are left out, because the effects on them are only rounding errors.
const moved = run.effects.map((_, k) => k).filter((k) => !run.unmoved.includes(k))
  .filter((k) => variableTitles.some((_, v) => effectOf(k, v, 'change') !== null));
const offered = Object.keys(measures).filter((m) => moved.some((k) => variableTitles.some((_, v) => effectOf(k, v, m) !== null)));

// A change is divided by the largest change of the same output. A share is used as it is.
const strengthOf = (k, variable, measure) => {
  const found = effectOf(k, variable, measure);
  if (found === null || measure !== 'change') return found ?? 0;
  const largest = Math.max(...variableTitles.map((_, v) => Math.abs(effectOf(k, v, measure) ?? 0)));
  return largest > 0 ? found / largest : 0;
};

const drawEffects = () => {
  if (!offered.length) return;
  const measure = byId('effect-measure').value;
  const { say, least, name } = measures[measure];
  const ranked = variableTitles.map((_, v) => v)
    .map((v) => [v, Math.max(0, ...moved.map((k) => Math.abs(strengthOf(k, v, measure))))])
    .sort((a, b) => b[1] - a[1] || a[0] - b[0]).slice(0, MOST_VARIABLES).map(([v]) => v);
  const chosen = Number(byId('effect-output').value);
  // Each output is a row, because a sweep has more outputs than variables.
  drawShades(byId('effects-map'), {
    rows: moved.map((k) => titled(first.variables + k)), columns: ranked.map((v) => variableTitles[v]), picked: -1,
    pick: () => {},
    cell: (row, column) => {
      const found = effectOf(moved[row], ranked[column], measure);
      return {
        strength: strengthOf(moved[row], ranked[column], measure), text: found === null || Math.abs(found) < least ? '' : say(found),
        title: found === null ? null : `${variableTitles[ranked[column]]} on ${titled(first.variables + moved[row])}: ${say(found)}`,
      };
    },
  });
  const { column, r2 } = run.effects[chosen];
  const unit = columns[first.variables + chosen].unit;
  const title = measure === 'change'
    ? `${withUnit(`change of ${column}`, unit)}${r2 === null ? '' : `; the plane explains ${Math.round(100 * r2)} % of the variance`}`
    : `${name} of ${column}`;
  drawBars(byId('effects-bars'), title, variableTitles.map((of, v) => [of, effectOf(chosen, v, measure)]).filter(([, found]) => found !== null)
    .sort((a, b) => Math.abs(b[1]) - Math.abs(a[1])).slice(0, 20).map(([of, found]) => ({ name: of, value: found, text: say(found) })));
};
