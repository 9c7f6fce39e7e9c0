'use strict';
// The engine in a worker. First `{module}`, then `{question}` after `{question}`; each is answered with `{json}` or
// `{bytes}`, with `{trap}` if the module stopped on it, or with `{fatal}` if there is no module that could answer.

let ready = null;

// [kind u32][length u32][place u32], little-endian, at what `answer` returns; kind 0 is JSON, 1 bytes.
function ask({ memory, room, answer, free }, question) {
  const text = new TextEncoder().encode(question);
  const place = room(text.length);
  new Uint8Array(memory.buffer, place, text.length).set(text);
  const head = answer(place, text.length);
  const view = new DataView(memory.buffer, head, 12);
  const [kind, length, start] = [0, 4, 8].map((offset) => view.getUint32(offset, true));
  const content = new Uint8Array(memory.buffer, start, length).slice();
  free(head);
  return kind === 1 ? { bytes: content.buffer } : { json: new TextDecoder().decode(content) };
}

onmessage = async ({ data }) => {
  if (data.module) {
    ready = WebAssembly.instantiate(data.module, {}).then(({ instance }) => instance.exports);
    // Told with the first question.
    ready.catch(() => {});
    return;
  }
  let engine;
  try {
    engine = await ready;
  } catch (problem) {
    postMessage({ fatal: String(problem?.message ?? problem) });
    return;
  }
  try {
    const answer = ask(engine, data.question);
    postMessage(answer, answer.bytes ? [answer.bytes] : []);
  } catch (problem) {
    postMessage({ trap: String(problem?.message ?? problem) });
  }
};
