// The 3D view and its sliders: load, exploded view, section, rotation, visible bodies.

class View {
  constructor() {
    this.hidden = new Set();
    try {
      // Checked first: three.js would log errors.
      if (!document.createElement('canvas').getContext('webgl2')) throw new Error('no WebGL');
      this.assembly = new Assembly(byId('view'));
      this.assembly.turned = (turn, tilt) => {
        byId('turn').value = turn * 180 / Math.PI;
        byId('tilt').value = tilt * 180 / Math.PI;
      };
      this.assembly.renderer.domElement.addEventListener('webglcontextlost', () => { this.showNoWebgl(); this.lost?.(); });
    } catch {
      this.showNoWebgl();
    }
    this.joint = new JointView((flexion) => this.assembly?.bend(flexion));
    for (const id of ['explode', 'turn', 'tilt', 'section', 'section-position']) byId(id).addEventListener('input', () => this.apply(id));
    matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => { this.assembly?.edges(); this.load(this.load_n); });
  }

  showNoWebgl() {
    this.assembly = undefined;
    delete byId('view').dataset.drawn;
    byId('view').replaceChildren(make('p', TEXT.noWebgl, { class: 'no-webgl' }));
    byId('view').setAttribute('aria-label', TEXT.pictureName);
    byId('view-tools').hidden = true;
    document.body.dataset.noWebgl = 'true';
  }

  show(data) {
    if (!this.assembly) return;
    const isFirst = !this.assembly.bodies;
    this.assembly.load(data, this.hidden);
    this.listBodies(data);
    this.apply('section');
    this.load(this.load_n ?? data.curve.load_n.at(-1));
    this.joint.show(data);
    if (isFirst) this.apply('turn');
  }

  // Without WebGL, shows a picture of the parts, which is one of the design's files.
  async showPicture(engine, design) {
    if (this.assembly) return;
    const number = this.pictureNumber = (this.pictureNumber ?? 0) + 1;
    let png;
    try {
      png = await engine.request({ command: 'file', name: 'assembly.png', ...design });
    } catch (problem) {
      // The reason is shown with the design.
      if (problem instanceof EngineError || problem instanceof Superseded) return;
      throw problem;
    }
    if (number !== this.pictureNumber) return;
    const image = make('img', undefined, { src: URL.createObjectURL(new Blob([png], { type: 'image/png' })), alt: '' });
    image.addEventListener('load', () => URL.revokeObjectURL(image.src));
    byId('view').querySelector('img')?.remove();
    byId('view').append(image);
  }

  load(load_n) {
    this.load_n = load_n;
    this.assembly?.bodies && this.assembly.pose(load_n, Number(byId('explode').value));
  }

  apply(id) {
    if (!this.assembly?.bodies) return;
    if (id === 'explode') this.load(this.load_n);
    if (id === 'turn' || id === 'tilt') this.assembly.aim(Number(byId('turn').value), Number(byId('tilt').value));
    if (id === 'section-position') byId('section').checked = true;
    if (id === 'section' || id === 'section-position') this.assembly.cut(byId('section').checked, Number(byId('section-position').value));
  }

  listBodies(data) {
    const names = [...new Set(data.bodies.map((b) => groupOf(b.name)))].concat(data.contact.angle_rad.length ? ['tendon'] : []);
    if (sameValue(names, this.bodyNames)) return;
    this.bodyNames = names;
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
    byId('bodies').replaceChildren(make('legend', TEXT.show), ...rows);
  }
}
