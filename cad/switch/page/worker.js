// The engine in a worker, after `xz-decompress.min.js`. The first message is `{module, texts}`,
// each other one `{request}`. Answers are `{json}`, `{bytes}`, `{trap}` if the module stopped, or
// `{failed}` if it does not start.

let ready = null;

// The module is packed with XZ, which keeps the page small.
async function unpacked(bytes) {
  const { XzReadableStream } = self['xz-decompress'];
  try {
    return await new Response(new XzReadableStream(new Blob([bytes]).stream())).arrayBuffer();
  } catch {
    throw new Error('the page is incomplete: load it again');
  }
}

// The module needs no imports: libraries in it declare functions of browsers that are never called.
function stubs(module) {
  const all = {};
  for (const { module: from, name, kind } of WebAssembly.Module.imports(module)) {
    if (kind !== 'function') continue;
    (all[from] ??= {})[name] = () => { throw new Error(`the module called ${from}.${name}`); };
  }
  return all;
}

async function instance(packed, texts) {
  if (typeof WebAssembly === 'undefined') throw new Error('no WebAssembly');
  const bytes = new Uint8Array(await unpacked(packed));
  // Texts of the page are left out of the packed module.
  for (const [offset, text] of texts) bytes.set(new TextEncoder().encode(text), offset);
  const module = await WebAssembly.compile(bytes);
  return (await WebAssembly.instantiate(module, stubs(module))).exports;
}

// `answer` returns the address of [kind u32][length u32][address u32], little-endian; kind 0 is
// JSON, 1 bytes.
function answerTo(request, { memory, room, answer, free }) {
  const text = new TextEncoder().encode(request);
  const address = room(text.length) >>> 0;
  new Uint8Array(memory.buffer, address, text.length).set(text);
  const header = answer(address, text.length) >>> 0;
  const view = new DataView(memory.buffer, header, 12);
  const [kind, length, start] = [0, 4, 8].map((offset) => view.getUint32(offset, true));
  const content = new Uint8Array(memory.buffer, start, length).slice();
  free(header);
  return kind === 1 ? { bytes: content.buffer } : { json: new TextDecoder().decode(content) };
}

onmessage = async ({ data }) => {
  if (data.module) {
    ready = instance(data.module, data.texts);
    // A failure is the answer to the first request.
    ready.catch(() => {});
    return;
  }
  let engine;
  try {
    engine = await ready;
  } catch (problem) {
    postMessage({ failed: String(problem?.message ?? problem) });
    return;
  }
  try {
    const answer = answerTo(data.request, engine);
    postMessage(answer, answer.bytes ? [answer.bytes] : []);
  } catch (problem) {
    postMessage({ trap: String(problem?.message ?? problem) });
  }
};
