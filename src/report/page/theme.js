// What every page's controls share; `drawAll` is the page's own. `#theme=dark&station=5` and the like set
// controls from the address.
const wishes = new URLSearchParams(location.hash.slice(1));
const option = (select, value, text) => select.add(new Option(text, value));

const prefersDark = matchMedia('(prefers-color-scheme: dark)');
const isDark = () => (root.dataset.theme ? root.dataset.theme === 'dark' : prefersDark.matches);
const setTheme = (theme) => {
  if (theme) root.dataset.theme = theme;
  else delete root.dataset.theme;
  byId('theme').textContent = isDark() ? 'light' : 'dark';
};
byId('theme').addEventListener('click', () => {
  setTheme(isDark() ? 'light' : 'dark');
  drawAll();
});
prefersDark.addEventListener('change', () => {
  setTheme(root.dataset.theme);
  drawAll();
});
// Paper is light, and has a width of its own.
let before;
const solid = byId('mechanism-plot');
const PAPER_WIDTH = 680;
addEventListener('beforeprint', () => {
  before = root.dataset.theme;
  if (solid) {
    const { clientWidth: width, clientHeight: height } = solid;
    Object.assign(solid.style, { width: `${width}px`, height: `${height}px`, zoom: PAPER_WIDTH / (width + 2) });
  }
  root.dataset.print = '';
  setTheme('light');
  drawAll();
});
addEventListener('afterprint', () => {
  delete root.dataset.print;
  if (solid) solid.removeAttribute('style');
  setTheme(before);
  drawAll();
});
