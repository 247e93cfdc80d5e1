// Controls that every page has. `#theme=dark&station=5` and the like set them from the address.
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
