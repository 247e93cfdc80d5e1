// Controls that every page has. Parameters in the address set the controls, as in `#theme=dark&station=5`.
const wishes = new URLSearchParams(location.hash.slice(1));
const option = (select, value, text) => select.add(new Option(text, value));

const prefersDark = matchMedia('(prefers-color-scheme: dark)');
const isDark = () => (root.dataset.theme ? root.dataset.theme === 'dark' : prefersDark.matches);
const setTheme = (theme) => {
  if (theme) root.dataset.theme = theme;
  else delete root.dataset.theme;
  byId('theme').textContent = isDark() ? 'light' : 'dark';
};
byId('theme').addEventListener('click', () => setTheme(isDark() ? 'light' : 'dark'));
prefersDark.addEventListener('change', () => setTheme(root.dataset.theme));
const ready = () => {
  setTheme(wishes.get('theme'));
  root.dataset.ready = 'true';
};
