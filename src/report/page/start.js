// Controls of a run's page, and the first drawing.
const state = {
  abscissa: record.abscissae.includes('time_s') ? 'time_s' : Object.keys(run.natural).length ? 'natural' : record.drive,
  upright: wishes.has('lying') ? false : !record.abscissae.includes('time_s'),
  ...stageState(),
};

const drawCurves = () => Promise.all(curvePlots.map((plot) => plot(state)));
const drawAll = () => Promise.all([drawCurves(), drawStage(state), drawTurn(state), drawHistory(), drawFront(), drawPrices(), influenced.length && drawInfluences()]);

if (Object.keys(run.natural).length) option(byId('abscissa'), 'natural', 'the usual quantity of each');
for (const name of [record.drive, ...record.abscissae]) option(byId('abscissa'), name, axisTitle(name));
byId('abscissa').value = state.abscissa;
byId('abscissa').addEventListener('change', (e) => {
  state.abscissa = e.target.value;
  drawCurves();
});
const sayUpright = () => {
  byId('swap').setAttribute('aria-pressed', state.upright);
};
byId('swap').addEventListener('click', () => {
  state.upright = !state.upright;
  sayUpright();
  drawCurves();
});

setUpStage(state);
for (const output of influenced) option(byId('influence-output'), output.column, output.title);
byId('influence-output').addEventListener('change', drawRanking);
byId('measure').addEventListener('change', drawInfluences);
byId('sensitivities').hidden = influenced.length === 0;

setUpFront();
setTheme(wishes.get('theme'));
sayUpright();
drawAll().then(() => {
  root.dataset.plotsExpected = curvePlots.length + (stations ? 1 : 0) + (hasTurn ? 1 : 0) + (run.history ? 1 : 0) + (front?.points.length ? 1 : 0) + (run.prices.length ? 1 : 0) + (influenced.length ? 2 : 0);
  root.dataset.ready = 'true';
});
