// Within another page: `?embed` leaves the header out and speaks messages.
//
// Out, to the page around, whenever a design was shown or refused, and when what is asked for changes:
//   {type: 'pinswitch-state', version: 1, hash, values, friction_n, load_n, threshold_n, trust, trouble, said}
//   `hash` and `values` are those that the frictions belong to; `said` is what of the last message could not be taken
// In, from the page around, from its `load` event on:
//   {type: 'pinswitch-set', values: {...}}   values by table.key, in place of the present ones
//   {type: 'pinswitch-set', hash: '#v=1&...'} the whole state, as in an address

// Messages that come before the engine is there: a page around may send when its frame is loaded.
const earlyMessages = [];
const keepEarly = (event) => earlyMessages.push(event);
if (isEmbedded()) addEventListener('message', keepEarly);

class Embed {
  constructor(takeParts, state) {
    this.isOn = isEmbedded();
    document.body.classList.toggle('embed', this.isOn);
    if (!this.isOn) return;
    // The header is left out, and with it the name of the page, which a screen reader looks for.
    byId('main').prepend(make('h1', WORDS.brand, { class: 'unseen' }));
    // One after the other: an address with a model takes longer to be read than the next message to come.
    let turn = Promise.resolve();
    const heard = ({ source, data }) => {
      if (source !== parent || data?.type !== 'pinswitch-set') return;
      turn = turn.then(() => this.set(data, takeParts, state)).catch(() => this.took(WORDS.noMessage, true));
    };
    removeEventListener('message', keepEarly);
    addEventListener('message', heard);
    earlyMessages.splice(0).forEach(heard);
  }

  set(data, takeParts, state) {
    if (typeof data.hash === 'string' && data.hash.replace(/^#/, '')) return takeParts(data.hash);
    if (!data.values || typeof data.values !== 'object' || Array.isArray(data.values)) throw new TypeError('neither a hash nor values');
    // Through the address, so that what cannot be is told in the same words.
    return takeParts(encodeHash({ ...state.now, values: data.values }));
  }

  // A message of the page around is taken, but for what is `said`; where it changes nothing no design will tell.
  took(said, isUnchanged) {
    this.said = said || null;
    if (isUnchanged && this.told) this.send();
  }

  // What is asked for has changed, and no part or curve with it.
  asked(now) {
    if (!this.told) return;
    this.told.hash = encodeHash({ ...now, values: this.told.values });
    this.send();
  }

  // Tells what the engine answered for the state that it was asked for; what is asked for may be newer.
  tell(asked, { ask }, data, trouble) {
    const f = data?.manifest.friction;
    this.told = { hash: encodeHash({ ...asked, ask }), values: asked.values, friction_n: f?.friction_n ?? null, load_n: f?.load_n ?? null,
      threshold_n: f?.threshold_n ?? null, trust: f?.trust ?? null, trouble: trouble ? troubleWords(trouble) : null };
    this.send();
  }

  send() {
    if (!this.isOn || parent === window) return;
    parent.postMessage({ type: 'pinswitch-state', version: 1, ...this.told, said: this.said ?? null }, '*');
  }
}
