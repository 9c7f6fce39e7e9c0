// The engine in a worker, behind `xz-decompress.min.js`. First `{module, holes}`, then `{question}` after `{question}`; each is answered with `{json}` or
// `{bytes}`, with `{trap}` if the module stopped on it, or with `{fatal}` if there is no module that could answer.

let ready = null;

// The module comes packed with XZ, since the page is downloaded whole.
async function unpacked(bytes) {
  const { XzReadableStream } = self['xz-decompress'];
  try {
    return await new Response(new XzReadableStream(new Blob([bytes]).stream())).arrayBuffer();
  } catch {
    throw new Error('the page was not loaded whole: load it again');
  }
}

// What the module needs of a host is nothing. Libraries in it name functions of browsers that it never calls.
function stubs(module) {
  const all = {};
  for (const { module: from, name, kind } of WebAssembly.Module.imports(module)) {
    if (kind !== 'function') continue;
    (all[from] ??= {})[name] = () => { throw new Error(`the module called ${from}.${name}`); };
  }
  return all;
}

async function started(packed, holes) {
  if (typeof WebAssembly === 'undefined') throw new Error('it runs no WebAssembly');
  const bytes = new Uint8Array(await unpacked(packed));
  // What the page holds, too, was left out of the module.
  for (const [place, text] of holes) bytes.set(new TextEncoder().encode(text), place);
  const module = await WebAssembly.compile(bytes);
  return (await WebAssembly.instantiate(module, stubs(module))).exports;
}

// [kind u32][length u32][place u32], little-endian, at what `answer` returns; kind 0 is JSON, 1 bytes.
function ask({ memory, room, answer, free }, question) {
  const text = new TextEncoder().encode(question);
  const place = room(text.length) >>> 0;
  new Uint8Array(memory.buffer, place, text.length).set(text);
  const head = answer(place, text.length) >>> 0;
  const view = new DataView(memory.buffer, head, 12);
  const [kind, length, start] = [0, 4, 8].map((offset) => view.getUint32(offset, true));
  const content = new Uint8Array(memory.buffer, start, length).slice();
  free(head);
  return kind === 1 ? { bytes: content.buffer } : { json: new TextDecoder().decode(content) };
}

onmessage = async ({ data }) => {
  if (data.module) {
    ready = started(data.module, data.holes);
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
