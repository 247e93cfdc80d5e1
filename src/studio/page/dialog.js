// Questions and messages over the page.
import { byId, html, notANumber, set } from './draw.js';

// Asks a question, and returns the chosen answer or null. An answer is a value, a label and optionally a check. The check carries
// out the answer. If it fails, it returns a text, and the dialog stays open with this text and the user's input.
const ask = (title, text, answers, ...fields) => new Promise((done) => {
  const dialog = byId('dialog');
  const form = dialog.querySelector('form');
  const inputs = fields.map((field) => (typeof field === 'string' ? html('input', { type: 'text', value: field, 'aria-label': title, name: 'name', autocomplete: 'off' }) : field));
  const input = inputs.find((one) => one.matches('input[type=text]'));
  const why = html('p', { class: 'bad', role: 'alert', hidden: true });
  const checked = (check, value) => async (event) => {
    event.preventDefault();
    const button = event.currentTarget;
    button.disabled = true;
    const refused = await check(input?.value ?? '');
    button.disabled = false;
    why.textContent = refused ?? '';
    why.hidden = refused === null;
    if (refused === null) dialog.close(value);
  };
  const buttons = answers.map(([value, label, check], k) => html('button', { value, text: label, class: k === 0 ? 'strong' : null, ...(check ? { on: { click: checked(check, value) } } : {}) }));
  form.replaceChildren(html('h2', { id: 'dialog-title', text: title }), html('p', { text }), ...inputs, why, html('div', { class: 'group' }, ...buttons));
  dialog.returnValue = '';
  dialog.addEventListener('close', () => done(dialog.returnValue ? { answer: dialog.returnValue, text: input?.value ?? '' } : null), { once: true });
  dialog.showModal();
  if (!inputs.some((one) => one.matches('input, label'))) buttons[0].focus();
  input?.select();
});
// A question waits until the previous question has closed, because the close event comes later than the close itself.
let last = Promise.resolve();
export const question = (...what) => {
  last = last.then(() => ask(...what));
  return last;
};
// A message over the page. It does not move other elements. When the message closes, the focus returns to the element that had
// it before.
let before = null;
export const hideMessage = () => {
  const banner = byId('banner');
  const held = banner.contains(document.activeElement);
  banner.hidden = true;
  if (held && before?.isConnected) before.focus({ preventScroll: true });
};
export const say = (text, kind = 'good', ...actions) => {
  const banner = byId('banner');
  banner.className = kind;
  const close = html('button', { class: 'close', text: '✕', 'aria-label': 'Close the message', on: { click: hideMessage } });
  if (!banner.contains(document.activeElement)) before = document.activeElement;
  // Screen readers read a region only if it is visible before its text is set.
  banner.hidden = false;
  banner.replaceChildren(html('span', { text }), ...actions, close);
  if (kind === 'good' && !actions.length) setTimeout(() => { if (banner.firstChild?.textContent === text) hideMessage(); }, 5000);
};
// Message for a refused change. The next accepted change removes it.
let refusal = null;
export const refuse = (text) => {
  say(text, 'bad');
  refusal = byId('banner').firstChild;
};
export const retract = () => { if (refusal?.isConnected) hideMessage(); };
// Marks a field whose text is not a number, and says why; or removes the mark. `label` names the field.
export const markNumber = (input, isWrong, label) => {
  const was = input.classList.contains('wrong');
  input.classList.toggle('wrong', isWrong);
  const why = isWrong ? `${label}: ${notANumber(input.value)}.` : null;
  input.why = why;
  set(input, { 'aria-invalid': isWrong ? 'true' : null, title: why ?? label });
  if (isWrong) refuse(why);
  else if (was) retract();
};
export const action = (text, handler) => html('button', { text, on: { click: () => { hideMessage(); handler(); } } });
