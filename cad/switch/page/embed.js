// Embedding: with `?embed` the page has no header and exchanges messages with the surrounding page.
//
// Sent whenever a design is shown or refused, and when targets change:
//   {type: 'pinswitch-state', version: 1, hash, values, friction_n, load_n, threshold_n, trust,
//    trouble, said}
// `hash` and `values` belong to the frictions; `said` is the part of the last message that could
// not be applied.
//
// Received, from the `load` event of the frame on:
//   {type: 'pinswitch-set', values: {...}}    values by table.key, which replace the present ones
//   {type: 'pinswitch-set', hash: '#v=1&...'} the whole state, as in an address

// Messages before the engine has started.
const earlyMessages = [];
const queueEarly = (event) => earlyMessages.push(event);
if (isEmbedded()) addEventListener('message', queueEarly);

class Embed {
  constructor(applyHash, state) {
    this.isOn = isEmbedded();
    document.body.classList.toggle('embed', this.isOn);
    if (!this.isOn) return;
    // Without the header the page needs another heading for screen readers.
    byId('main').prepend(make('h1', TEXT.brand, { class: 'visually-hidden' }));
    // In order: an address with a model takes longer to decode than the next message.
    let queue = Promise.resolve();
    const receive = ({ source, data }) => {
      if (source !== parent || data?.type !== 'pinswitch-set') return;
      queue = queue.then(() => this.set(data, applyHash, state)).catch(() => this.applied(TEXT.invalidMessage, true));
    };
    removeEventListener('message', queueEarly);
    addEventListener('message', receive);
    earlyMessages.splice(0).forEach(receive);
  }

  set(data, applyHash, state) {
    if (typeof data.hash === 'string' && data.hash.replace(/^#/, '')) return applyHash(data.hash);
    if (!data.values || typeof data.values !== 'object' || Array.isArray(data.values)) throw new TypeError('neither a hash nor values');
    // As an address, so that invalid values give the same messages.
    return applyHash(encodeHash({ ...state.now, values: data.values }));
  }

  // Records the part of a message that could not be applied; sends it if no design follows.
  applied(ignored, isUnchanged) {
    this.ignored = ignored || null;
    if (isUnchanged && this.sent) this.send();
  }

  // Sends new targets, which change neither parts nor curve.
  sendTargets(now) {
    if (!this.sent) return;
    this.sent.hash = encodeHash({ ...now, values: this.sent.values });
    this.send();
  }

  // Sends the answer of the engine for `requested`; the targets may be newer.
  sendDesign(requested, { targets }, data, trouble) {
    const f = data?.manifest.friction;
    this.sent = { hash: encodeHash({ ...requested, targets }), values: requested.values, friction_n: f?.friction_n ?? null, load_n: f?.load_n ?? null,
      threshold_n: f?.threshold_n ?? null, trust: f?.trust ?? null, trouble: trouble ? plainTrouble(trouble) : null };
    this.send();
  }

  send() {
    if (!this.isOn || parent === window) return;
    parent.postMessage({ type: 'pinswitch-state', version: 1, ...this.sent, said: this.ignored ?? null }, '*');
  }
}
