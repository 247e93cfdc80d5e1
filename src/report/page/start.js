// Controls of a run's page, and the first drawing.
const nearestToDesign = () => {
  const drives = Array.from({ length: stations }, (_, station) => Math.abs(frameAt(0, { station, rack: 0 }).drive));
  return Math.max(0, drives.indexOf(Math.min(...drives)));
};
const wished = (name, most, otherwise) => {
  const number = parseInt(wishes.get(name), 10);
  return number >= 0 && number < most ? number : otherwise;
};
const state = {
  abscissa: record.abscissae.includes('time_s') ? 'time_s' : record.drive,
  upright: wishes.has('lying') ? false : !record.abscissae.includes('time_s'),
  view: views[wishes.get('view')] ? wishes.get('view') : 'oblique',
  place: {
    station: wished('station', stations, nearestToDesign()),
    rack: wished('rack', racks.length, Math.max(0, racks.indexOf(Math.min(...racks.map(Math.abs))))),
  },
};

const drawCurves = () => Promise.all(curvePlots.map((plot) => plot(state)));
const drawAll = () => Promise.all([drawCurves(), drawStage(state), drawHistory(), influenced.length && drawInfluences()]);

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

for (const [name, most] of [['station', stations], ['rack', racks.length]]) {
  const slider = byId(name);
  slider.max = Math.max(0, most - 1);
  slider.value = state.place[name];
  slider.addEventListener('input', () => {
    state.place[name] = Number(slider.value);
    moveStage(state);
  });
}
byId('rack-label').hidden = racks.length < 2;
for (const button of document.querySelectorAll('[data-view]')) {
  button.addEventListener('click', () => {
    state.view = button.dataset.view;
    Plotly.relayout(stage, { 'scene.camera': camera(state.view) });
  });
}

// Playing goes up and down the motion until it is stopped.
let playing = null;
let direction = 1;
byId('play').addEventListener('click', () => {
  if (playing) {
    clearInterval(playing);
    playing = null;
  } else if (stations > 1) {
    playing = setInterval(() => {
      if (!(state.place.station + direction in Array(stations).fill(0))) direction = -direction;
      state.place.station += direction;
      byId('station').value = state.place.station;
      moveStage(state);
    }, 60);
  }
  byId('play').textContent = playing ? 'stop' : 'play';
  byId('play').setAttribute('aria-pressed', playing !== null);
});

for (const output of influenced) option(byId('influence-output'), output.column, output.title);
byId('influence-output').addEventListener('change', drawRanking);
byId('measure').addEventListener('change', drawInfluences);
byId('sensitivities').hidden = influenced.length === 0;

setTheme(wishes.get('theme'));
sayUpright();
drawAll().then(() => {
  root.dataset.plotsExpected = curvePlots.length + (stations ? 1 : 0) + (run.history ? 1 : 0) + (influenced.length ? 2 : 0);
  root.dataset.ready = 'true';
});
