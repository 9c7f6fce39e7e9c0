// The assembly beside its sliders: load, pulling apart, cutting open, turning, which bodies are shown.

class View {
  constructor() {
    this.hidden = new Set();
    try {
      // Asked first, since three.js complains aloud.
      if (!document.createElement('canvas').getContext('webgl2')) throw new Error('no WebGL');
      this.assembly = new Assembly(byId('view'));
      this.assembly.turned = (turn, tilt) => {
        byId('turn').value = turn * 180 / Math.PI;
        byId('tilt').value = tilt * 180 / Math.PI;
      };
      this.assembly.renderer.domElement.addEventListener('webglcontextlost', () => { this.fail(); this.lost?.(); });
    } catch {
      this.fail();
    }
    for (const id of ['apart', 'turn', 'tilt', 'cut', 'cut-at']) byId(id).addEventListener('input', () => this.shape(id));
    matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => { this.assembly?.edges(); this.load(this.load_n); });
  }

  fail() {
    this.assembly = undefined;
    delete byId('view').dataset.drawn;
    byId('view').replaceChildren(make('p', WORDS.noWebgl, { class: 'instead' }));
    byId('view').setAttribute('aria-label', WORDS.stillName);
    byId('view-tools').hidden = true;
    document.body.dataset.still = 'true';
  }

  show(data) {
    if (!this.assembly) return;
    const isFirst = !this.assembly.bodies;
    this.assembly.load(data, this.hidden);
    this.names(data);
    this.shape('cut');
    this.load(this.load_n ?? data.curve.load_n.at(-1));
    if (isFirst) this.shape('turn');
  }

  // Without WebGL, a picture of the parts, which is one of the design's files; `asked` is that design.
  async picture(engine, asked) {
    if (this.assembly) return;
    const turn = this.turn = (this.turn ?? 0) + 1;
    let png;
    try {
      png = await engine.ask({ ask: 'file', name: 'assembly.png', ...asked });
    } catch (problem) {
      // Why there is none is told where the design is.
      if (problem instanceof EngineError || problem instanceof Stale) return;
      throw problem;
    }
    if (turn !== this.turn) return;
    const image = make('img', undefined, { src: URL.createObjectURL(new Blob([png], { type: 'image/png' })), alt: '' });
    image.addEventListener('load', () => URL.revokeObjectURL(image.src));
    byId('view').querySelector('img')?.remove();
    byId('view').append(image);
  }

  load(load_n) {
    this.load_n = load_n;
    this.assembly?.bodies && this.assembly.pose(load_n, Number(byId('apart').value));
  }

  shape(id) {
    if (!this.assembly?.bodies) return;
    if (id === 'apart') this.load(this.load_n);
    if (id === 'turn' || id === 'tilt') this.assembly.aim(Number(byId('turn').value), Number(byId('tilt').value));
    if (id === 'cut-at') byId('cut').checked = true;
    if (id === 'cut' || id === 'cut-at') this.assembly.cut(byId('cut').checked, Number(byId('cut-at').value));
  }

  names(data) {
    const names = [...new Set(data.bodies.map((b) => groupOf(b.name)))].concat(data.contact.angle_rad.length ? ['tendon'] : []);
    if (sameValue(names, this.named)) return;
    this.named = names;
    const rows = names.map((name) => {
      const label = make('label', undefined, { class: 'check' });
      const box = make('input', undefined, { type: 'checkbox' });
      box.checked = !this.hidden.has(name);
      box.addEventListener('change', () => {
        if (box.checked) this.hidden.delete(name); else this.hidden.add(name);
        this.assembly?.show(name, box.checked);
      });
      label.append(box, name.replaceAll('-', ' '));
      return label;
    });
    byId('bodies').replaceChildren(make('legend', WORDS.show), ...rows);
  }
}
