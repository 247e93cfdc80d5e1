// Curves or differences, over the column that is chosen.
const choose = () => {
  const [kind, over] = ['what', 'over'].map((id) => byId(id).value);
  for (const { figure } of charts) figure.hidden = figure.dataset.kind !== kind || figure.dataset.over !== over;
};
for (const id of ['what', 'over']) byId(id).addEventListener('change', choose);
choose();
ready();
