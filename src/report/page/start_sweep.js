// Controls of a sweep's page, and the first drawing. `#design=310` chooses a design.
const [firstX, firstY] = first.deviations.length > 1 ? first.deviations : [0, first.misfit ?? Math.min(first.variables, columns.length - 1)];
const state = {
  x: firstX, y: firstY, colour: first.misfit ?? 'status', logarithmic: false, more: null, selected: null,
  picked: (wishes.has('design') ? rowOf.get(Number(wishes.get('design'))) : undefined) ?? bestRows[0] ?? (allRows.length ? 0 : null),
};
// Shows the chosen design beside the given design, if the page has its curves.
const drawPicked = () => {
  const place = record ? run.drawn.indexOf(shown.design[state.picked]) : -1;
  byId('picked-drawn').hidden = place < 0;
  byId('picked-not-drawn').hidden = place >= 0;
  if (place < 0) return;
  for (const { figure } of charts) {
    if (!('byDesign' in figure.dataset)) continue;
    figure.classList.forEach((name) => { if (name.startsWith('shows-')) figure.classList.remove(name); });
    figure.classList.add('shows-of-0', `shows-of-${place}`);
    for (const part of figure.querySelectorAll(':is(.inner, .strip) path[class*="of-"]')) {
      const [of] = /of-\d+/.exec(part.getAttribute('class'));
      part.style.display = figure.classList.contains(`shows-${of}`) ? '' : 'none';
    }
  }
  if (!stage) setUpStage();
  if (!stage) return;
  stage.designs = [0, place].filter((design, k, all) => record.designs[design].frames.length && all.indexOf(design) === k);
  stage.measure();
  stage.fit();
  moveStage();
};
const drawPlaces = () => { drawScatter(state); drawCounts(state); };
const drawAll = () => { drawPlaces(); drawParallel(state); };

const offerColumns = (select, before) => {
  for (const [name, text] of before) option(select, name, text);
  columns.forEach((_, k) => option(select, k, titled(k)));
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
chooser('scatter-x', 'x', [], drawPlaces);
chooser('scatter-y', 'y', [], drawScatter);
chooser('scatter-colour', 'colour', [['status', 'none']], drawAll);
chooser('parallel-more', 'more', [['', 'nothing']], drawParallel);
byId('logarithmic').addEventListener('click', () => {
  state.logarithmic = !state.logarithmic;
  byId('logarithmic').setAttribute('aria-pressed', state.logarithmic);
  drawPlaces();
});

const pick = (row) => {
  if (![...byId('picked').options].some((o) => o.value === String(row))) option(byId('picked'), row, `${shown.design[row]}`);
  state.picked = row;
  sayPicked(state);
  drawAll();
  drawPicked();
};
const select = (rows) => {
  state.selected = rows;
  drawCounts(state);
  drawParallel(state);
};
bestRows.forEach((row, i) => option(byId('picked'), row, `${shown.design[row]}, best${i ? ` but ${i}` : ''}`));
for (const row of frontRows.slice(0, 200)) if (!bestRows.includes(row)) option(byId('picked'), row, `${shown.design[row]}, on the Pareto front`);
byId('picked').addEventListener('change', (e) => pick(Number(e.target.value)));

for (const measure of offered) option(byId('effect-measure'), measure, measures[measure].name);
for (const k of moved) option(byId('effect-output'), k, titled(first.variables + k));
byId('effect-measure').addEventListener('change', drawEffects);
byId('effect-output').addEventListener('change', drawEffects);
if (first.misfit !== null && moved.includes(first.misfit - first.variables)) byId('effect-output').value = first.misfit - first.variables;

// A selection in the scatter plot replaces the selections on the parallel axes.
listenToScatter(state, pick, (rows) => { brushes.clear(); select(rows); });
listenToParallel(state, select);
if (state.picked === null) drawAll();
else pick(state.picked);
drawEffects();
root.dataset.plotsExpected = charts.length + 2 + (offered.length ? 2 : 0) + (stage ? 1 : 0);
ready();
