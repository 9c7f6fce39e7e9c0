// Files of the design: a list with sizes, for download one by one or in an archive.

// Groups of files in their order.
const KINDS = [['print', /\.(stl|3mf|ini)$/i], ['drawing', /^drawing\.|\.dxf$/i], ['guide', /^(manual|printing|measured)\.|^run-sheet/i], ['step', /\.step$/i], ['glb', /\.(glb|html)$/i], ['curve', /^friction\./i], ['png', /\.png$/i], ['data', /\.(csv|json|toml|md)$/i], ['other', /./]];

class Downloads {
  constructor(state, engine) {
    Object.assign(this, { state, engine });
    this.dialog = byId('files');
    byId('download').addEventListener('click', () => this.open());
    byId('files-close').addEventListener('click', () => this.dialog.close());
    byId('zip').addEventListener('click', () => this.download({ command: 'zip' }, `${this.name()}.zip`, 'application/zip'));
    byId('toml').addEventListener('click', () => this.configuration());
    byId('session').addEventListener('click', () => {
      save(`${this.name()}.json`, writeSession(this.state.now), 'application/json');
      byId('files-status').textContent = TEXT.saved(`${this.name()}.json`);
    });
  }

  // Takes the name of the last valid design. While the dialog is open, its list follows the design.
  show(data) {
    this.title = data.manifest.name;
    this.refresh();
  }

  refresh() {
    const { values, model } = this.state.now;
    const isListed = this.listed && this.listed.values === values && this.listed.model === model && !this.isStale();
    if (this.dialog.open && !isListed) this.list();
  }

  // Adds the request for which files wait, if any.
  withWait(text) {
    const request = this.engine.longRequest();
    return request ? `${TEXT.waitsFor[request]} ${text}` : text;
  }

  isStale() { return document.body.classList.contains('stale') || !this.title; }
  name() { return this.title ?? 'switch'; }
  design() { return { values: this.state.now.values, model: this.state.now.model?.toml ?? null }; }

  async open() {
    this.dialog.showModal();
    await this.list();
  }

  async list() {
    const isStale = this.isStale();
    const { values, model } = this.state.now;
    this.listed = isStale ? null : { values, model };
    byId('file-list').replaceChildren();
    byId('zip').disabled = byId('toml').disabled = isStale;
    byId('files-status').textContent = isStale ? (document.body.classList.contains('disconnected') ? TEXT.serverGone : TEXT.noFiles) : this.withWait(TEXT.generatingFiles);
    const number = this.listNumber = (this.listNumber ?? 0) + 1;
    if (isStale) return;
    try {
      const { files } = await this.engine.request({ command: 'files', ...this.design() });
      if (number !== this.listNumber) return;
      this.showFiles(files);
      byId('files-status').textContent = '';
    } catch (problem) {
      if (!(problem instanceof Superseded) && number === this.listNumber) byId('files-status').textContent = TEXT.filesFailed + problem.message;
    }
  }

  // Saves the configuration of the present values; the page may still show the design before.
  async configuration() {
    try {
      const { toml, data, trouble } = await this.engine.request({ command: 'design', values: this.state.now.values, quality: 'coarse', extra: true });
      if (trouble) throw new EngineError(troubleText(trouble), 'refused');
      save(`${data.manifest.name}.toml`, toml, 'application/toml');
      byId('files-status').textContent = TEXT.saved(`${data.manifest.name}.toml`);
    } catch (problem) {
      if (!(problem instanceof EngineError)) throw problem;
      byId('files-status').textContent = TEXT.filesFailed + problem.message;
    }
  }

  showFiles(files) {
    byId('beside').hidden = !files.some((file) => file.isBeside);
    const groups = new Map();
    for (const file of files) {
      const kind = TEXT.kinds[KINDS.find(([, pattern]) => pattern.test(file.name))[0]];
      if (!groups.has(kind)) groups.set(kind, []);
      groups.get(kind).push(file);
    }
    const order = KINDS.map(([kind]) => TEXT.kinds[kind]);
    const sorted = [...groups].sort(([a], [b]) => order.indexOf(a) - order.indexOf(b));
    byId('file-list').replaceChildren(...sorted.map(([kind, members]) => {
      // Pictures are many, and parts of the guide.
      const isFolded = kind === TEXT.kinds.png;
      const group = make(isFolded ? 'details' : 'section');
      const list = make('ul');
      for (const { name, bytes, isBeside } of members) {
        const item = make('li');
        const act = isBeside ? make('a', name, { href: encodeURI(name), download: name, class: 'link' }) : button(name, () => this.download({ command: 'file', name }, name, 'application/octet-stream'), { class: 'link' });
        if (bytes !== undefined) act.append(make('span', TEXT.megabytes(bytes), { class: 'dim' }));
        item.append(act);
        list.append(item);
      }
      group.append(make(isFolded ? 'summary' : 'h3', isFolded ? `${kind} (${members.length})` : kind), list);
      return group;
    }));
  }

  async download(request, name, type) {
    byId('files-status').textContent = this.withWait(TEXT.generating(name));
    try {
      save(name, await this.engine.request({ ...request, ...this.design() }), type);
      byId('files-status').textContent = TEXT.saved(name);
    } catch (problem) {
      if (!(problem instanceof Superseded)) byId('files-status').textContent = TEXT.filesFailed + problem.message;
    }
  }
}
