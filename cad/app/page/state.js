// What the person has chosen: values that differ from the defaults, a calibrated model, an ask; its history; its address.

const HASH_VERSION = 1;
// Characters of a packed model: a calibration takes some five thousand.
const LONGEST_MODEL = 60000;
const STORE = 'pinswitch.configurator.1';
// Changes of one field in so short a time are one step back.
const ONE_STEP_MS = 700;
// Frictions that can be asked for at once, and loads and frictions that can, in newtons.
const MOST_FRICTIONS = 4;
const MOST_ASKED_N = 1000;
const LEAST_ASKED_N = 0.001;
const isAsked = (value) => Number.isFinite(value) && value > 0 && value <= MOST_ASKED_N;
const sameValue = (a, b) => JSON.stringify(a) === JSON.stringify(b);

class State extends EventTarget {
  constructor(facts) {
    super();
    this.fields = new Map(facts.fields.map((f) => [f.path, f]));
    this.now = { values: {}, model: null, ask: { threshold_n: null, friction: [] } };
    this.past = [];
    this.future = [];
    this.last = { what: null, when: 0 };
  }

  value(path) {
    const field = this.fields.get(path);
    return this.now.values[path] ?? field?.default;
  }

  isChanged(path) { return path in this.now.values; }

  // Replaces parts of the state; `what` names the step, and steps of one name in a row are one.
  change(parts, what) {
    const next = { ...this.now, ...parts };
    if (parts.values) next.values = this.withoutDefaults(parts.values);
    if (sameValue(next, this.now)) return;
    const when = performance.now();
    const goesOn = what && what === this.last.what && when - this.last.when < ONE_STEP_MS && this.past.length;
    if (!goesOn) this.past.push(this.now);
    if (this.past.length > 200) this.past.shift();
    this.future = [];
    this.last = { what, when };
    this.now = next;
    this.tell();
  }

  set(path, value) { this.change({ values: { ...this.now.values, [path]: value } }, path); }

  reset(path) {
    const { [path]: _, ...rest } = this.now.values;
    this.change({ values: rest });
  }

  withoutDefaults(values) {
    return Object.fromEntries(Object.entries(values).filter(([path, value]) => {
      const field = this.fields.get(path);
      return !field || !sameValue(field.default, value);
    }).sort(([a], [b]) => (a < b ? -1 : 1)));
  }

  // Takes a state without a step back to the one before: the first one.
  begin(parts) {
    this.now = { ...this.now, ...parts };
    this.now.values = this.withoutDefaults(this.now.values);
  }

  undo() { this.step(this.past, this.future); }
  redo() { this.step(this.future, this.past); }
  step(from, to) {
    if (!from.length) return;
    to.push(this.now);
    this.now = from.pop();
    this.last = { what: null, when: 0 };
    this.dispatchEvent(new Event('step'));
    this.tell();
  }

  tell() { this.dispatchEvent(new Event('change')); }
}

// ---- the address --------------------------------------------------------------------------------------------------
// #v=1&layout.pins=5,8,11&shell.wall_mm=9&ask.threshold_n=24&ask.friction=30:8.5&model=(deflated, base64url)

function encodeHash(now) {
  const pairs = [`v=${HASH_VERSION}`];
  const text = (value) => encodeURIComponent(Array.isArray(value) ? value.join(',') : String(value)).replaceAll('%2C', ',');
  for (const [path, value] of Object.entries(now.values)) pairs.push(`${encodeURIComponent(path)}=${text(value)}`);
  if (now.ask.threshold_n !== null) pairs.push(`ask.threshold_n=${now.ask.threshold_n}`);
  if (now.ask.friction.length) pairs.push(`ask.friction=${now.ask.friction.map((f) => `${f.load_n}:${f.friction_n}`).join(',')}`);
  if (now.model) pairs.push(`model=${now.model.packed}`);
  return `#${pairs.join('&')}`;
}

// Whole numbers of a list; undefined if one is none. What is typed and what an address holds are read alike, so that what
// the page has written comes back, with its error if it has one.
function wholeNumbers(texts) {
  const numbers = texts.map(Number);
  return texts.every((text) => text.trim() !== '') && numbers.every(Number.isSafeInteger) ? numbers : undefined;
}

// A value of the address as the field's kind wants it; undefined if it cannot be one. Ranges are the engine's affair.
function readValue(field, text) {
  if (field.kind === 'flag') return text === 'true' || (text === 'false' ? false : undefined);
  if (field.kind === 'list') {
    return wholeNumbers(text.trim() === '' ? [] : text.split(','));
  }
  if (field.kind === 'number' || field.kind === 'whole') {
    const value = text.trim() === '' ? NaN : Number(text);
    return Number.isFinite(value) && (field.kind === 'number' || Number.isInteger(value)) ? value : undefined;
  }
  if (field.kind === 'choice' && field.choices && !field.choices.includes(text)) return undefined;
  return text.length <= 200 ? text : undefined;
}

// What an address holds, and in words what of it could not be taken. Null without one.
async function decodeHash(hash, fields) {
  const text = hash.replace(/^#/, '');
  if (!text) return null;
  const pairs = text.split('&').map((pair) => pair.split(/=(.*)/s)).filter(([name]) => name);
  const given = new Map(pairs);
  const said = [];
  const twice = [...given.keys()].filter((name) => pairs.filter(([other]) => other === name).length > 1);
  if (!/^\d+$/.test(given.get('v') ?? '')) return { broken: true, said: [WORDS.hash.broken] };
  if (Number(given.get('v')) < 1) said.push(WORDS.hash.older(given.get('v')));
  if (Number(given.get('v')) > HASH_VERSION) said.push(WORDS.hash.newer(given.get('v')));
  given.delete('v');
  const parts = { values: {}, model: null, ask: { threshold_n: null, friction: [] } };
  const [unknown, wrong] = [[], []];
  for (const [name, raw] of given) {
    const isKnown = fields.has(name) || ['model', 'ask.threshold_n', 'ask.friction'].includes(name);
    let value;
    // A name alone has no value.
    if (raw === undefined) { (isKnown ? wrong : unknown).push(name.slice(0, 60)); continue; }
    try { value = decodeURIComponent(raw); } catch { (isKnown ? wrong : unknown).push(name.slice(0, 60)); continue; }
    if (name === 'model') {
      parts.model = await unpackModel(raw);
      if (!parts.model) said.push(WORDS.hash.model);
    } else if (name === 'ask.threshold_n' || name === 'ask.friction') {
      if (!readAsk(parts.ask, name, value)) wrong.push(name);
    } else if (!fields.has(name)) {
      unknown.push(name.slice(0, 60));
    } else {
      const read = readValue(fields.get(name), value);
      if (read === undefined) wrong.push(name); else parts.values[name] = read;
    }
  }
  if (parts.ask.friction.length > MOST_FRICTIONS) {
    said.push(WORDS.hash.manyFrictions(MOST_FRICTIONS));
    parts.ask.friction.length = MOST_FRICTIONS;
  }
  if (unknown.length) said.push(WORDS.hash.unknown(unknown.slice(0, 6)));
  if (wrong.length) said.push(WORDS.hash.wrong(wrong));
  if (said.length) said.push(WORDS.hash.rest);
  if (twice.length) said.push(WORDS.hash.twice(twice.map((name) => name.slice(0, 60))));
  return { parts, said };
}

function readAsk(ask, name, text) {
  const numbers = text.split(',').map((item) => item.split(':').map(Number));
  if (!numbers.flat().every(isAsked)) return false;
  if (name === 'ask.threshold_n') {
    if (numbers.flat().length !== 1) return false;
    [[ask.threshold_n]] = numbers;
    return true;
  }
  if (!numbers.every((pair) => pair.length === 2)) return false;
  ask.friction = numbers.map(([load_n, friction_n]) => ({ load_n, friction_n }));
  return true;
}

const throughStream = async (content, stream) => new Response(new Blob([content]).stream().pipeThrough(stream)).arrayBuffer();

// A model with the short form of it that the address carries.
async function packModel(name, toml) {
  const bytes = new Uint8Array(await throughStream(toml, new CompressionStream('deflate-raw')));
  let text = '';
  for (const byte of bytes) text += String.fromCharCode(byte);
  return { name, toml, packed: `${encodeURIComponent(name)}~${btoa(text).replaceAll('+', '-').replaceAll('/', '_').replace(/=+$/, '')}` };
}

async function unpackModel(packed) {
  try {
    if (packed.length > LONGEST_MODEL) return null;
    // A name may hold the sign itself, base64url does not.
    const end = packed.lastIndexOf('~');
    const [name, text] = [packed.slice(0, end), packed.slice(end + 1)];
    const bytes = bytesOf(text.replaceAll('-', '+').replaceAll('_', '/'));
    const toml = new TextDecoder('utf-8', { fatal: true }).decode(await throughStream(bytes, new DecompressionStream('deflate-raw')));
    return toml.length < 1e6 ? { name: decodeURIComponent(name), toml, packed } : null;
  } catch {
    return null;
  }
}

// ---- between visits -----------------------------------------------------------------------------------------------

// Storage may be forbidden; then nothing is remembered, and nothing breaks. Within another page, that page remembers.
const isEmbedded = () => new URLSearchParams(location.search).has('embed');
function remember(what) {
  if (isEmbedded()) return;
  try { localStorage.setItem(STORE, JSON.stringify(what)); } catch { /* Private windows, files: the address still holds it. */ }
}
function remembered() {
  if (isEmbedded()) return {};
  try {
    const { hash, kept, ...rest } = JSON.parse(localStorage.getItem(STORE)) ?? {};
    // Whatever was left there, by an earlier version or by somebody's hand, the page begins.
    const isCurve = (curve) => ['load_n', 'friction_n'].every((name) => Array.isArray(curve?.[name]));
    const isKept = kept && typeof kept.name === 'string' && kept.values && typeof kept.values === 'object' && isCurve(kept.curve);
    return { ...rest, ...(typeof hash === 'string' && { hash }), ...(isKept && { kept }) };
  } catch {
    return {};
  }
}
