// What every plot shares: the run's data, colours, labels, and the place they are drawn in.
const byId = (id) => document.getElementById(id);
const root = document.documentElement;
const run = JSON.parse(byId('run').textContent);
// Of a sweep: designs that are drawn with their curves, where there are any.
const record = run.record ?? null;

// Whatever goes wrong is written where a reader, or a test, can find it.
const noteError = (message) => {
  root.dataset.errors = Number(root.dataset.errors || 0) + 1;
  root.dataset.lastError = message;
};
root.dataset.errors = 0;
addEventListener('error', (e) => noteError(e.message));
addEventListener('unhandledrejection', (e) => noteError(String(e.reason)));
document.addEventListener('securitypolicyviolation', (e) => noteError(`${e.violatedDirective} ${e.blockedURI}`));

const colours = () => {
  const style = getComputedStyle(root);
  const names = [
    'paper', 'panel', 'ink', 'muted', 'rule', 'accent', 'before', 'target', 'bad', 'strong', 'sans',
    'carrier', 'strut', 'rocker', 'wheel', 'road', 'centre',
  ];
  const value = (name) => style.getPropertyValue(`--${name}`).trim();
  return { ...Object.fromEntries(names.map((name) => [name, value(name)])), hues: value('hues').split(' ') };
};
// #rrggbb with an opacity.
const faint = (colour, opacity) => {
  const [r, g, b] = [1, 3, 5].map((i) => parseInt(colour.slice(i, i + 2), 16));
  return `rgba(${r},${g},${b},${opacity})`;
};

// A colour between two.
const mixed = (from, to, part) => {
  const mix = [1, 3, 5].map((i) => {
    const [a, b] = [from, to].map((colour) => parseInt(colour.slice(i, i + 2), 16));
    return Math.round(a + part * (b - a)).toString(16).padStart(2, '0');
  });
  return `#${mix.join('')}`;
};

// Names from a study, as the plots' labels take them: they read a little markup, which a name is not.
const plain = (text) => String(text).replace(/&/g, '&amp;').replace(/</g, '&lt;').replace(/>/g, '&gt;');
const brief = (value) => String(Number(value.toPrecision(6)));
const axisTitle = (column) => {
  const [, name, unit] = /^(.*)_([^_]+)$/.exec(column);
  const long = { travel: 'wheel travel', roll: 'roll angle' }[name] ?? name.replace(/_/g, ' ');
  return `${long} [${unit === 'deg' ? '°' : unit}]`;
};
const withUnit = (title, unit) => (unit ? `${title} [${unit}]` : title);

// The designs that are drawn, the one that matters last.
const shownDesigns = (state) => state.designs ?? record.designs.map((_, design) => design);
const isMain = (state, design) => design === shownDesigns(state).at(-1);
const config = {
  responsive: true,
  displaylogo: false,
  modeBarButtonsToRemove: ['select2d', 'lasso2d'],
  toImageButtonOptions: { format: 'svg', filename: 'hardpoint' },
};
// Where there is nothing to zoom: the buttons would lie on the labels.
const still = { ...config, displayModeBar: true, modeBarButtons: [['toImage']] };
const axis = (c, more) => ({
  gridcolor: c.rule, zerolinecolor: c.muted, zerolinewidth: 1, linecolor: c.rule, automargin: true,
  // Powers of ten: a prefix such as the u of 600u would run into the unit.
  exponentformat: 'power', minexponent: 4,
  ...more,
});
const layout = (c, more) => ({
  font: { family: c.sans, size: 12, color: c.ink },
  paper_bgcolor: 'rgba(0,0,0,0)',
  plot_bgcolor: c.panel,
  hoverlabel: { bgcolor: c.paper, bordercolor: c.rule, font: { family: c.sans, size: 12, color: c.ink } },
  modebar: { bgcolor: 'rgba(0,0,0,0)', color: c.muted, activecolor: c.accent },
  margin: { l: 56, r: 16, t: 28, b: 44 },
  ...more,
});
// The legend of a curve, at the foot of its plot: above it would meet the buttons.
const below = { orientation: 'h', yref: 'container', y: 0, yanchor: 'bottom', x: 0 };

const drawn = new Set();
const draw = async (element, traces, figure, settings = config) => {
  // On paper nothing resizes a plot once it is drawn; a solid one would be drawn too late.
  const size = 'print' in root.dataset && !figure.scene ? { width: element.clientWidth, height: element.clientHeight } : {};
  await Plotly.react(element, traces, { ...figure, ...size }, settings);
  drawn.add(element);
  root.dataset.plotsDrawn = drawn.size;
};
