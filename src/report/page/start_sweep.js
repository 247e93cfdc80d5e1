// Controls of a sweep's page, and the first drawing. `#design=310` chooses a design.
const [firstX, firstY] = first.deviations.length > 1 ? first.deviations : [0, first.misfit ?? Math.min(first.variables, columns.length - 1)];
const state = {
  x: firstX, y: firstY, colour: first.misfit ?? 'status', logarithmic: false, more: null, selected: null,
  ...(record && { abscissa: record.drive, upright: true, designs: [0], ...stageState() }),
  picked: (wishes.has('design') ? rowOf.get(Number(wishes.get('design'))) : undefined) ?? bestRows[0] ?? (allRows.length ? 0 : null),
};
// The chosen design beside the one as given, where its curves are on the page.
const drawPicked = () => {
  const place = record ? run.drawn.indexOf(shown.design[state.picked]) : -1;
  byId('picked-drawn').hidden = place < 0;
  byId('picked-not-drawn').hidden = place >= 0;
  if (place < 0) return Promise.resolve();
  state.designs = [0, place];
  return Promise.all([...curvePlots.map((plot) => plot(state)), drawStage(state)]);
};
const drawAll = () => Promise.all([drawScatter(state), drawParallel(state), drawEffects(), drawPicked()]);

const offerColumns = (select, before) => {
  for (const [name, text] of before) option(select, name, text);
  columns.forEach((column, k) => option(select, k, withUnit(column.title, column.unit)));
};
const chooser = (id, name, before, then) => {
  const select = byId(id);
  offerColumns(select, before);
  select.value = String(state[name] ?? '');
  select.addEventListener('change', () => {
    state[name] = select.value === '' ? null : Number.isNaN(Number(select.value)) ? select.value : Number(select.value);
    then(state);
  });
};
chooser('scatter-x', 'x', [], drawScatter);
chooser('scatter-y', 'y', [], drawScatter);
chooser('scatter-colour', 'colour', [['status', 'none']], () => Promise.all([drawScatter(state), drawParallel(state)]));
chooser('parallel-more', 'more', [['', 'nothing']], drawParallel);
byId('logarithmic').addEventListener('click', () => {
  state.logarithmic = !state.logarithmic;
  byId('logarithmic').setAttribute('aria-pressed', state.logarithmic);
  drawScatter(state);
});

const pick = (row) => {
  if (![...byId('picked').options].some((o) => o.value === String(row))) option(byId('picked'), row, `${shown.design[row]}`);
  state.picked = row;
  sayPicked(state);
  return Promise.all([drawScatter(state), drawParallel(state), drawPicked()]);
};
bestRows.forEach((row, i) => option(byId('picked'), row, `${shown.design[row]}, best${i ? ` but ${i}` : ''}`));
for (const row of frontRows.slice(0, 200)) if (!bestRows.includes(row)) option(byId('picked'), row, `${shown.design[row]}, on the front`);
byId('picked').addEventListener('change', (e) => pick(Number(e.target.value)));

for (const measure of offered) option(byId('effect-measure'), measure, measures[measure].name);
for (const k of moved) option(byId('effect-output'), k, columns[first.variables + k].title);
byId('effect-measure').addEventListener('change', drawEffects);
byId('effect-output').addEventListener('change', drawEffectRanking);
if (first.misfit !== null && moved.includes(first.misfit - first.variables)) byId('effect-output').value = first.misfit - first.variables;

if (record) setUpStage(state);
setTheme(wishes.get('theme'));
if (state.picked !== null) {
  pick(state.picked);
}
drawAll().then(() => {
  scatter.on('plotly_click', ({ points: [point] }) => rowOf.has(point.customdata) && pick(rowOf.get(point.customdata)));
  scatter.on('plotly_selected', (event) => {
    const rows = event?.points?.map((p) => rowOf.get(p.customdata)).filter((row) => row !== undefined);
    state.selected = rows?.length ? new Set(rows) : null;
    drawParallel(state);
  });
  scatter.on('plotly_deselect', () => {
    state.selected = null;
    drawParallel(state);
  });
  root.dataset.plotsExpected = 2 + (offered.length ? 2 : 0) + (byId('picked-drawn').hidden ? 0 : curvePlots.length + 1);
  root.dataset.ready = 'true';
});
