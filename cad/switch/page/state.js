// The state of the page: values that differ from the defaults, a calibrated model, targets, the last
// fit; its history; its address.

// A report of a set shows one design.
const IS_REPORT = document.body.dataset.state === 'report';
const HASH_VERSION = 1;
// Most characters of a packed model; a calibration has some five thousand.
const MAX_MODEL_LENGTH = 60000;
const STORAGE_KEY = 'pinswitch.configurator.1';
// Changes of one field within this time are one step of the history.
const ONE_STEP_MS = 700;
// Bounds of targets: number of frictions; loads and frictions in newtons.
const MAX_FRICTIONS = 4;
const MAX_TARGET_N = 1000;
const MIN_TARGET_N = 0.001;
const isTarget = (value) => Number.isFinite(value) && value > 0 && value <= MAX_TARGET_N;
const sameValue = (a, b) => JSON.stringify(a) === JSON.stringify(b);
// A fit is long, and never changed.
const sameState = ({ fit, ...a }, { fit: other, ...b }) => fit === other && sameValue(a, b);

class State extends EventTarget {
  constructor(facts) {
    super();
    this.fields = new Map(facts.fields.map((f) => [f.path, f]));
    this.now = { values: {}, model: null, targets: { threshold_n: null, friction: [] }, fit: null };
    this.past = [];
    this.future = [];
    this.last = { name: null, time: 0 };
  }

  value(path) {
    const field = this.fields.get(path);
    return this.now.values[path] ?? field?.default;
  }

  isChanged(path) { return path in this.now.values; }

  // Replaces parts of the state. Consecutive steps with the same `name` are one.
  change(parts, name) {
    if (IS_REPORT) return;
    const next = { ...this.now, ...parts };
    if (parts.values) next.values = this.withoutDefaults(parts.values);
    if (sameState(next, this.now)) return;
    const time = performance.now();
    const continues = name && name === this.last.name && time - this.last.time < ONE_STEP_MS && this.past.length;
    if (!continues) this.past.push(this.now);
    if (this.past.length > 200) this.past.shift();
    this.future = [];
    this.last = { name, time };
    this.now = next;
    // A change that was taken back is no step.
    if (continues && sameState(this.past.at(-1), next)) this.past.pop();
    this.notify();
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

  // Sets the first state, without a step in the history.
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
    this.last = { name: null, time: 0 };
    this.dispatchEvent(new Event('step'));
    this.notify();
  }

  notify() { this.dispatchEvent(new Event('change')); }
}

// ---- the address --------------------------------------------------------------------------------------------------
// #v=1&layout.pins=5,8,11&shell.wall_mm=9&targets.threshold_n=24&targets.friction=30:8.5&model=(deflated, base64url)

function encodeHash(now) {
  const pairs = [`v=${HASH_VERSION}`];
  const text = (value) => encodeURIComponent(Array.isArray(value) ? value.join(',') : String(value)).replaceAll('%2C', ',');
  for (const [path, value] of Object.entries(now.values)) pairs.push(`${encodeURIComponent(path)}=${text(value)}`);
  if (now.targets.threshold_n !== null) pairs.push(`targets.threshold_n=${now.targets.threshold_n}`);
  if (now.targets.friction.length) pairs.push(`targets.friction=${now.targets.friction.map((f) => `${f.load_n}:${f.friction_n}`).join(',')}`);
  if (now.model) pairs.push(`model=${now.model.packed}`);
  return `#${pairs.join('&')}`;
}

// Parses a list of whole numbers; undefined if one is not. Typed text and addresses are parsed
// alike, so that the page reads what it has written, with the same error.
function wholeNumbers(texts) {
  const numbers = texts.map(Number);
  return texts.every((text) => /^\s*[-+]?\d+\s*$/.test(text)) && numbers.every(Number.isSafeInteger) ? numbers : undefined;
}

// Parses a value for a field; undefined if it is not of the field's kind. The engine checks ranges.
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

// Decodes an address. Returns its state, with messages about parts that are ignored; null for an
// empty address.
async function decodeHash(hash, fields) {
  const text = hash.replace(/^#/, '');
  if (!text) return null;
  const pairs = text.split('&').map((pair) => pair.split(/=(.*)/s)).filter(([name]) => name);
  const given = new Map(pairs);
  const messages = [];
  const duplicate = [...given.keys()].filter((name) => pairs.filter(([other]) => other === name).length > 1);
  if (!/^\d+$/.test(given.get('v') ?? '')) return { isInvalid: true, messages: [TEXT.hash.invalid] };
  if (Number(given.get('v')) < 1) messages.push(TEXT.hash.older(given.get('v')));
  if (Number(given.get('v')) > HASH_VERSION) messages.push(TEXT.hash.newer(given.get('v')));
  given.delete('v');
  const parts = { values: {}, model: null, targets: { threshold_n: null, friction: [] } };
  const [unknown, wrong] = [[], []];
  for (const [name, raw] of given) {
    const isKnown = fields.has(name) || ['model', 'targets.threshold_n', 'targets.friction'].includes(name);
    let value;
    // A name without `=`.
    if (raw === undefined) { (isKnown ? wrong : unknown).push(name.slice(0, 60)); continue; }
    try { value = decodeURIComponent(raw); } catch { (isKnown ? wrong : unknown).push(name.slice(0, 60)); continue; }
    if (name === 'model') {
      parts.model = await unpackModel(raw);
      if (!parts.model) messages.push(TEXT.hash.model);
    } else if (name === 'targets.threshold_n' || name === 'targets.friction') {
      if (!readTarget(parts.targets, name, value)) wrong.push(name);
    } else if (!fields.has(name)) {
      unknown.push(name.slice(0, 60));
    } else {
      const read = readValue(fields.get(name), value);
      if (read === undefined) wrong.push(name); else parts.values[name] = read;
    }
  }
  if (parts.targets.friction.length > MAX_FRICTIONS) {
    messages.push(TEXT.hash.manyFrictions(MAX_FRICTIONS));
    parts.targets.friction.length = MAX_FRICTIONS;
  }
  if (unknown.length) messages.push(TEXT.hash.unknown(unknown.slice(0, 6)));
  if (wrong.length) messages.push(TEXT.hash.wrong(wrong));
  if (messages.length) messages.push(TEXT.hash.rest);
  if (duplicate.length) messages.push(TEXT.hash.duplicate(duplicate.map((name) => name.slice(0, 60))));
  return { parts, messages };
}

// Reads a target of the address into `targets`; returns whether it is valid.
function readTarget(targets, name, text) {
  const numbers = text.split(',').map((item) => item.split(':').map(Number));
  if (!numbers.flat().every(isTarget)) return false;
  if (name === 'targets.threshold_n') {
    if (numbers.flat().length !== 1) return false;
    [[targets.threshold_n]] = numbers;
    return true;
  }
  if (!numbers.every((pair) => pair.length === 2)) return false;
  targets.friction = numbers.map(([load_n, friction_n]) => ({ load_n, friction_n }));
  return true;
}

const throughStream = async (content, stream) => new Response(new Blob([content]).stream().pipeThrough(stream)).arrayBuffer();

// Returns a model with its packed form for the address.
async function packModel(name, toml) {
  const bytes = new Uint8Array(await throughStream(toml, new CompressionStream('deflate-raw')));
  let text = '';
  for (const byte of bytes) text += String.fromCharCode(byte);
  return { name, toml, packed: `${encodeURIComponent(name)}~${btoa(text).replaceAll('+', '-').replaceAll('/', '_').replace(/=+$/, '')}` };
}

async function unpackModel(packed) {
  try {
    if (packed.length > MAX_MODEL_LENGTH) return null;
    // The name may contain `~`, base64url does not.
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

// Without access to storage nothing is remembered. An embedded page remembers nothing: the
// surrounding page does. A report has nothing to remember.
const isEmbedded = () => new URLSearchParams(location.search).has('embed');
// Returns whether it is kept.
function remember(what) {
  if (IS_REPORT || isEmbedded()) return true;
  try {
    localStorage.setItem(STORAGE_KEY, JSON.stringify(what));
    return true;
  } catch {
    // Not allowed in private windows and for files, or full; the design is in the address.
    return false;
  }
}
function remembered() {
  if (IS_REPORT || isEmbedded()) return {};
  try {
    const { hash, kept, fit, ...rest } = JSON.parse(localStorage.getItem(STORAGE_KEY)) ?? {};
    // Entries of earlier versions, and edited ones, may be invalid.
    const isCurve = (curve) => ['load_n', 'friction_n'].every((name) => Array.isArray(curve?.[name]));
    const isValid = kept && typeof kept.name === 'string' && kept.values && typeof kept.values === 'object' && isCurve(kept.curve);
    const knownFit = readFit(fit);
    return { ...rest, ...(typeof hash === 'string' && { hash }), ...(isValid && { kept }), ...(knownFit && { fit: knownFit }) };
  } catch {
    return {};
  }
}
