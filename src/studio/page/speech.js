// Text for screen readers: the last action and its result, announced once when the page is at rest.
import { byId } from './draw.js';
import { history, on, state } from './design.js';

const REST = 900;
let timer = null;
export const announce = (text, wait = 0) => {
  clearTimeout(timer);
  timer = setTimeout(() => {
    const words = typeof text === 'function' ? text() : text;
    const said = byId('said');
    // A repeated text must differ, otherwise it is not read again.
    said.textContent = said.textContent === words ? `${words}\u00a0` : words;
  }, wait);
};

const result = () => {
  if (state.fault) return `The design cannot be solved: ${state.fault}`;
  if (state.isLate) return 'Results follow.';
  const chips = [...document.querySelectorAll('#figures .chip')];
  return chips.map((chip) => `${chip.firstChild.textContent} ${chip.querySelector('b').textContent}`).join(', ');
};

export const startSpeech = () => {
  let last = null;
  on('study', () => { last = null; });
  on('deed', () => {
    const { timeline, present } = history();
    const deed = timeline[present];
    const isFirst = last === null;
    const now = `${present} ${deed.label}`;
    if (now === last) return;
    last = now;
    if (!isFirst) announce(() => `${deed.label}. ${result()}`, REST);
  });
};
