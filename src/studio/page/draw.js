// Small helpers: elements, numbers, vectors.

const NAMESPACE = 'http://www.w3.org/2000/svg';

// Writes a text if it has changed, because browsers lay out and paint even an equal text again. The written text is stored here,
// because reading it from the element takes longer. So no other code may change texts and attributes that `write` and `set` set.
export const write = (element, text) => {
  const wanted = String(text);
  if (element.written === wanted) return;
  element.written = wanted;
  element.textContent = wanted;
};
// Sets attributes that have changed. Text is never interpreted as markup, because names come from the study.
export const set = (element, attributes) => {
  const sent = element.sent ??= {};
  for (const name in attributes) {
    const value = attributes[name];
    if (name === 'text') {
      if (value !== undefined && value !== null && value !== false) write(element, value);
    } else if (name === 'on') for (const [event, handler] of Object.entries(value)) element.addEventListener(event, handler);
    else {
      const wanted = value === undefined || value === null || value === false ? null : value === true ? '' : String(value);
      if (sent[name] === wanted) continue;
      sent[name] = wanted;
      if (wanted === null) element.removeAttribute(name);
      else element.setAttribute(name, wanted);
    }
  }
  return element;
};
export const svg = (tag, attributes = {}, ...children) => {
  const element = set(document.createElementNS(NAMESPACE, tag), attributes);
  element.append(...children);
  return element;
};
export const html = (tag, attributes = {}, ...children) => {
  const element = set(document.createElement(tag), attributes);
  element.append(...children);
  return element;
};
// Two functions that round a position on the screen in pixels: to a tenth, and to a hundredth.
export const tenth = (value) => Math.round(10 * value) / 10;
export const hundredth = (value) => Math.round(100 * value) / 100;
// Makes a finger drag this element instead of scrolling the page.
export const heldByFinger = (element) => {
  element.addEventListener('touchstart', (event) => event.preventDefault(), { passive: false });
  return element;
};
// Shows an element, or hides it.
export const show = (element, isShown) => {
  if (element.isHidden === !isShown) return;
  element.isHidden = !isShown;
  element.style.display = isShown ? '' : 'none';
};
// Attributes that set the position of an element. A transform would be slower: browsers treat each transformed element as a
// layer, and sort all layers again when one of them moves.
export const placed = (x, y) => ({ x: tenth(x), y: tenth(y) });
export const centred = (x, y) => ({ cx: tenth(x), cy: tenth(y) });
// Fills a group of a drawing with elements, given as pairs of tag and attributes. Existing elements are changed, not replaced. So
// elements with the same tag in a group must have the same attributes.
export const refill = (group, wanted) => {
  wanted.forEach(([tag, attributes], k) => {
    const present = group.children[k];
    if (present?.localName === tag) set(present, attributes);
    else if (present) present.replaceWith(svg(tag, attributes));
    else group.append(svg(tag, attributes));
  });
  while (group.children.length > wanted.length) group.lastElementChild.remove();
};
// Width of a text in the page's font, in pixels.
const ruler = document.createElement('canvas').getContext('2d');
let family = null;
export const measured = (text, size, weight) => {
  family ??= getComputedStyle(document.body).fontFamily;
  ruler.font = `${weight} ${size}px ${family}`;
  return ruler.measureText(text).width;
};
// Writes a text into a field. The field is as wide as its text.
export const fill = (input, text) => {
  input.value = text;
  input.style.setProperty('--letters', String(input.value.length));
};
export const fitted = (input) => {
  input.addEventListener('input', () => fill(input, input.value));
  fill(input, input.value);
  return input;
};
// Number in a typed text, with a decimal point or a decimal comma; null if the text is not a number. Other notations, such as
// hexadecimal digits, are not accepted.
const NUMBER = /^[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?$/i;
export const parsed = (text) => {
  const plain = text.trim().replaceAll('−', '-').replace(',', '.');
  const value = NUMBER.test(plain) ? Number(plain) : NaN;
  return Number.isFinite(value) ? value : null;
};
// Reason why a typed text is no number.
export const notANumber = (text) => `${text.trim() === '' ? 'the field is empty' : `“${text.trim()}” is not a number`}. Write a number such as 152.5 or -0.02`;
export const byId = (id) => document.getElementById(id);
// Replaces the content of an element. The focus stays on the control of the same name, or else on the control at the same index.
const CONTROLS = 'button, input, select, summary, a[href], [tabindex]';
const controlName = (control) => control.id || control.getAttribute('aria-label') || control.textContent;
export const renew = (element, ...children) => {
  const held = document.activeElement;
  const controls = () => [...element.querySelectorAll(CONTROLS)];
  const order = held && element.contains(held) && held !== element ? controls().indexOf(held) : -1;
  element.replaceChildren(...children);
  if (order < 0) return;
  const [after, name] = [controls(), controlName(held)];
  const nearest = after[Math.min(order, after.length - 1)];
  const isSame = (control) => controlName(control) === name;
  const next = nearest && isSame(nearest) ? nearest : after.find(isSame) ?? nearest;
  next?.focus({ preventScroll: true });
};
// Readable name of a column, with the unit in brackets.
const UNIT = '(?:mm|m|in|deg|rad|N|lbf|kg|g|Hz|percent)';
const UNIT_AT_END = new RegExp(`_(${UNIT}(?:_${UNIT})*(?:_per_${UNIT}(?:_${UNIT})*)?)$`);
export const quantity = (column) => column.replace(UNIT_AT_END, (_, unit) => ` [${inDegrees(unit.replace('_per_', '/').replaceAll('_', ' '))}]`).replaceAll('_', ' ');
// Replaces `deg` in a text by the degree sign, as in the labels of curves.
export const inDegrees = (text) => text.replace(/\bdeg\b/g, '°');
// A box that scrolls its content sideways. The keyboard can reach the box.
export const scroller = (label, ...children) => html('div', { class: 'scroll', tabindex: 0, role: 'group', 'aria-label': label }, ...children);

// Formats a number with at most this many significant digits.
export const brief = (value, digits = 5) => {
  if (value === null || value === undefined || !Number.isFinite(value)) return '–';
  const text = value !== 0 && Math.abs(value) < 1e-4 ? value.toExponential(1) : String(Number(value.toPrecision(digits)));
  return text.replaceAll('-', '−');
};
export const signed = (value, digits = 3) => (value > 0 ? '+' : '') + brief(value, digits);
// Steps of an axis: 1, 2 or 5 times a power of ten.
export const niceStep = (span, count) => {
  const rough = span / Math.max(1, count);
  const power = 10 ** Math.floor(Math.log10(rough));
  return [1, 2, 5, 10].find((m) => m * power >= rough * 0.999) * power;
};
export const ticks = (low, high, count) => {
  const step = niceStep(high - low, count);
  const first = Math.ceil(low / step - 1e-9);
  const last = Math.floor(high / step + 1e-9);
  return Array.from({ length: Math.max(0, last - first + 1) }, (_, i) => Number(((first + i) * step).toPrecision(12)));
};

export const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
export const norm = (a) => Math.hypot(...a);
export const along = (p, v, by) => [p[0] + v[0] * by, p[1] + v[1] * by, p[2] + v[2] * by];
export const minus = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];

export const AXES = ['x', 'y', 'z'];
