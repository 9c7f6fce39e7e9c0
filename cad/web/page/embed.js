// Within another page: `?embed` leaves the header out and speaks messages.
//
// Out, to the page around, whenever a design was shown or refused:
//   {type: 'pinswitch-state', version: 1, hash, values, friction_n, load_n, threshold_n, trust, trouble}
// In, from the page around:
//   {type: 'pinswitch-set', values: {...}}   values by table.key, in place of the present ones
//   {type: 'pinswitch-set', hash: '#v=1&...'} the whole state, as in an address

class Embed {
  constructor(takeParts, state) {
    this.isOn = isEmbedded();
    document.body.classList.toggle('embed', this.isOn);
    if (!this.isOn) return;
    addEventListener('message', async ({ source, data }) => {
      if (source !== parent || data?.type !== 'pinswitch-set') return;
      if (typeof data.hash === 'string') await takeParts(data.hash);
      else if (data.values && typeof data.values === 'object' && !Array.isArray(data.values)) {
        // Through the address, so that what cannot be is told in the same words.
        await takeParts(encodeHash({ ...state.now, values: data.values }));
      }
    });
  }

  tell(state, data, trouble) {
    if (!this.isOn || parent === window) return;
    const f = data?.manifest.friction;
    parent.postMessage({ type: 'pinswitch-state', version: 1, hash: encodeHash(state.now), values: state.now.values, friction_n: f?.friction_n ?? null, load_n: f?.load_n ?? null,
      threshold_n: f?.threshold_n ?? null, trust: f?.trust ?? null, trouble: trouble ? troubleWords(trouble) : null }, '*');
  }
}
