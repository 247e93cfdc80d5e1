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
// Paper is light.
let before;
addEventListener('beforeprint', () => {
  before = root.dataset.theme;
  setTheme('light');
  drawAll();
});
addEventListener('afterprint', () => {
  setTheme(before);
  drawAll();
});
