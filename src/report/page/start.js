// Controls of a run's page, and the first drawing.
for (const abscissa of document.querySelectorAll('select.abscissa')) {
  const plots = byId(abscissa.dataset.plots);
  abscissa.addEventListener('change', () => {
    for (const { figure } of charts) {
      if (figure.dataset.over && plots.contains(figure)) figure.hidden = abscissa.value === 'usual' ? !('usual' in figure.dataset) : figure.dataset.over !== abscissa.value;
    }
  });
}
setUpStage();
for (const output of influenced) option(byId('influence-output'), output.column, output.title);
byId('influence-output').addEventListener('change', drawInfluences);
byId('measure').addEventListener('change', drawInfluences);
byId('sensitivities').hidden = influenced.length === 0;
drawInfluences();
setUpFront();
root.dataset.plotsExpected = charts.length + (stations ? 1 : 0) + (hasTurn ? 1 : 0) + (influenced.length ? 2 : 0);
ready();
