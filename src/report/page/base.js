// Data and functions that several parts of the page use: the run's data, its errors, and common texts.
const root = document.documentElement;
const run = JSON.parse(byId('run').textContent);
// Curves and mechanism of the designs. Null if the page has no designs with a drawing.
const record = run.record ?? null;

// Writes an error into attributes of the page's root element, so that a test or a developer can find it.
const noteError = (message) => {
  root.dataset.errors = Number(root.dataset.errors || 0) + 1;
  root.dataset.lastError = message;
};
root.dataset.errors = 0;
addEventListener('error', (e) => noteError(e.message));
addEventListener('unhandledrejection', (e) => noteError(String(e.reason)));
document.addEventListener('securitypolicyviolation', (e) => noteError(`${e.violatedDirective} ${e.blockedURI}`));

const column = (table, name) => table.columns[table.header.indexOf(name)];
const axisName = (name) => {
  const [, words, unit] = /^(.*)_([^_]+)$/.exec(name) ?? [null, name, ''];
  return { name: { travel: 'wheel travel', roll: 'roll angle' }[words] ?? words.replace(/_/g, ' '), unit: unit === 'deg' ? '°' : unit };
};
const withUnit = (title, unit) => (unit ? `${title} [${unit}]` : title);

// Position on the motion at which the user points: value of each column. Charts and the mechanism show the same position.
const pointed = new Map();
const followers = new Set();
const point = (name, value, from) => {
  if (value === null) pointed.delete(name);
  else pointed.set(name, value);
  for (const follow of followers) follow(name, value, from);
};

// Writes the number of elements that the page has drawn into an attribute of the page, for tests and other programs.
const drawn = new Set();
const noteDrawn = (element) => {
  drawn.add(element);
  root.dataset.plotsDrawn = drawn.size;
};
const saveText = (name, text, type) => {
  const link = document.createElement('a');
  link.href = URL.createObjectURL(new Blob([text], { type }));
  link.download = name;
  link.click();
  URL.revokeObjectURL(link.href);
};
