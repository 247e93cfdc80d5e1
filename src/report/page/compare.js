// Shows the curves or their differences from the first design, over the chosen column.
const choose = () => {
  const [kind, over] = ['what', 'over'].map((id) => byId(id).value);
  for (const { figure } of charts) figure.hidden = figure.dataset.kind !== kind || figure.dataset.over !== over;
};
for (const id of ['what', 'over']) byId(id).addEventListener('change', choose);
choose();
if (record) setUpStage();
if (stage) {
  // Colour of a design in the drawing, equal to the colour of its curves.
  const hue = (design) => `var(--hue${design % 7})`;
  const paint = (paths, design) => paths.forEach((path) => { path.style.stroke = hue(design); });
  stage.former.forEach(({ bodies, rim: wheel }, k) => paint([...bodies, wheel], stage.designs[k]));
  paint([...stage.bodies, ...stage.rims], stage.designs.at(-1));
}
ready();
