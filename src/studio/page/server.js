// Requests to the server, and its state.

export class Refused extends Error {
  constructor(status, message) {
    super(message);
    this.status = status;
  }
}

const watchers = [];
let there = true;

// Registers a watcher of the server's state. The watcher is called when the state changes: 'yes' if the server answers, 'no' if
// not, 'other' if another server answers.
export const watchServer = (watcher) => watchers.push(watcher);
const tell = (state) => {
  if (state === there) return;
  there = state;
  for (const watcher of watchers) watcher(state);
};

// Longest message in bytes that the server reads. The browser could not show the server's refusal of a longer message, because the
// server closes the connection.
const LONGEST = 2 ** 20;
const send = async (what, message) => {
  const body = JSON.stringify(message);
  // A character has at most three bytes.
  if (body.length > LONGEST / 3 && new Blob([body]).size > LONGEST) throw new Refused(413, 'the text is longer than 1 MB, and the server reads at most 1 MB: use less text');
  let response;
  try {
    response = await fetch(what, {
      method: 'POST', headers: { 'content-type': 'application/json' }, body,
    });
  } catch {
    tell('no');
    throw new Refused(0, 'the server does not answer');
  }
  if (response.status === 403) {
    tell('other');
    throw new Refused(403, 'the server was started anew');
  }
  tell('yes');
  if (!response.ok) throw new Refused(response.status, (await response.text()).trim());
  return response;
};

const answered = async (what, message) => {
  const answer = await (await send(what, message)).json();
  if (answer?.refused) throw new Refused(answer.refused, answer.why);
  return answer;
};
const answeredInText = async (what, message) => {
  const response = await send(what, message);
  const text = await response.text();
  if (response.headers.get('content-type') === 'application/json') {
    const { refused, why } = JSON.parse(text);
    throw new Refused(refused, why);
  }
  return text;
};

// Status of a request about a text of the study that the server no longer stores.
const FORGOTTEN = 410;
let restore = () => Promise.reject();
// Registers a function that makes the server store the text with this digest again. Its second argument sends a request.
export const restoreTexts = (own) => { restore = own; };
// Sends a request. If the server no longer stores the text, restores the text and sends the request again.
const restored = (ask) => async (what, message) => {
  try {
    return await ask(what, message);
  } catch (refused) {
    if (refused.status !== FORGOTTEN) throw refused;
    await restore((message.of ?? message).digest, answered).catch(() => { throw refused; });
    return ask(what, message);
  }
};
export const post = restored(answered);
export const postForText = restored(answeredInText);
