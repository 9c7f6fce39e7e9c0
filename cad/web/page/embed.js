// Within another page: `?embed` leaves the header out and speaks messages.
//
// Out, to the page around, whenever a design was shown or refused:
//   {type: 'pinswitch-state', version: 1, hash, values, friction_n, load_n, threshold_n, trust, trouble, said}
//   `hash` and `values` are those that the frictions belong to; `said` is what of the last message could not be taken
// In, from the page around:
//   {type: 'pinswitch-set', values: {...}}   values by table.key, in place of the present ones
//   {type: 'pinswitch-set', hash: '#v=1&...'} the whole state, as in an address

class Embed {
  constructor(takeParts, state) {
    this.isOn = isEmbedded();
    document.body.classList.toggle('embed', this.isOn);
    if (!this.isOn) return;
    // The header is left out, and with it the name of the page, which a screen reader looks for.
    byId('main').prepend(make('h1', WORDS.brand, { class: 'unseen' }));
    // One after the other: an address with a model takes longer to be read than the next message to come.
    let turn = Promise.resolve();
    addEventListener('message', ({ source, data }) => {
      if (source !== parent || data?.type !== 'pinswitch-set') return;
      turn = turn.then(() => this.set(data, takeParts, state)).catch(() => this.took(WORDS.noMessage, true));
    });
  }

  set(data, takeParts, state) {
    if (typeof data.hash === 'string') return takeParts(data.hash);
    if (!data.values || typeof data.values !== 'object' || Array.isArray(data.values)) throw new TypeError('neither a hash nor values');
    // Through the address, so that what cannot be is told in the same words.
    return takeParts(encodeHash({ ...state.now, values: data.values }));
  }

  // A message of the page around was taken, but for what is `said`; where it changed nothing no design will tell.
  took(said, isUnchanged) {
    this.said = said || null;
    if (isUnchanged && this.told) this.send();
  }

  // Tells what the engine answered for the state that it was asked for.
  tell(asked, data, trouble) {
    const f = data?.manifest.friction;
    this.told = { hash: encodeHash(asked), values: asked.values, friction_n: f?.friction_n ?? null, load_n: f?.load_n ?? null,
      threshold_n: f?.threshold_n ?? null, trust: f?.trust ?? null, trouble: trouble ? troubleWords(trouble) : null };
    this.send();
  }

  send() {
    if (!this.isOn || parent === window) return;
    parent.postMessage({ type: 'pinswitch-state', version: 1, ...this.told, said: this.said ?? null }, '*');
  }
}
