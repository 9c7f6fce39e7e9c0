// Files of the design: a list with sizes, one by one, or all in an archive.

class Downloads {
  constructor(state, engine) {
    Object.assign(this, { state, engine });
    this.dialog = byId('files');
    byId('download').addEventListener('click', () => this.open());
    byId('files-close').addEventListener('click', () => this.dialog.close());
    byId('zip').addEventListener('click', () => this.fetch({ ask: 'zip' }, `${this.name()}.zip`, 'application/zip'));
    byId('toml').addEventListener('click', () => this.configuration());
  }

  // What the last design that can be built was called. Under the open dialog the list follows the design.
  show(data) {
    this.title = data.manifest.name;
    this.refresh();
  }

  refresh() {
    const { values, model } = this.state.now;
    const isListed = this.listed && this.listed.values === values && this.listed.model === model && !this.isStale();
    if (this.dialog.open && !isListed) this.ask();
  }

  // What is being made, and what it waits for.
  making(words) {
    const busy = this.engine.busyWith();
    return busy ? `${WORDS.waitsFor[busy]} ${words}` : words;
  }

  isStale() { return document.body.classList.contains('stale') || !this.title; }
  name() { return this.title ?? 'switch'; }
  asked() { return { values: this.state.now.values, model: this.state.now.model?.toml ?? null }; }

  async open() {
    this.dialog.showModal();
    await this.ask();
  }

  async ask() {
    const cannot = this.isStale();
    const { values, model } = this.state.now;
    this.listed = cannot ? null : { values, model };
    byId('file-list').replaceChildren();
    byId('zip').disabled = byId('toml').disabled = cannot;
    byId('files-say').textContent = cannot ? (document.body.classList.contains('gone') ? WORDS.serverGone : WORDS.noFiles) : this.making(WORDS.makingFiles);
    const turn = this.turn = (this.turn ?? 0) + 1;
    if (cannot) return;
    try {
      const { files } = await this.engine.ask({ ask: 'files', ...this.asked() });
      if (turn !== this.turn) return;
      this.list(files);
      byId('files-say').textContent = '';
    } catch (problem) {
      if (!(problem instanceof Stale) && turn === this.turn) byId('files-say').textContent = WORDS.filesFail + problem.message;
    }
  }

  // The configuration of the design as it is now, though the page may still be showing the one before.
  async configuration() {
    try {
      const { toml, data, trouble } = await this.engine.ask({ ask: 'design', values: this.state.now.values, quality: 'coarse', aside: true });
      if (trouble) throw new EngineError(troubleWords(trouble), 'refused');
      save(`${data.manifest.name}.toml`, toml, 'application/toml');
      byId('files-say').textContent = WORDS.saved(`${data.manifest.name}.toml`);
    } catch (problem) {
      if (!(problem instanceof EngineError)) throw problem;
      byId('files-say').textContent = WORDS.filesFail + problem.message;
    }
  }

  list(files) {
    const groups = new Map();
    for (const file of files) {
      const end = file.name.split('.').pop().toLowerCase();
      const kind = WORDS.kinds[end] ?? WORDS.kinds.other;
      if (!groups.has(kind)) groups.set(kind, []);
      groups.get(kind).push(file);
    }
    const order = [...new Set(Object.values(WORDS.kinds))];
    const sorted = [...groups].sort(([a], [b]) => order.indexOf(a) - order.indexOf(b));
    byId('file-list').replaceChildren(...sorted.map(([kind, members]) => {
      const group = make('section');
      const list = make('ul');
      for (const { name, bytes } of members) {
        const item = make('li');
        const act = button(name, () => this.fetch({ ask: 'file', name }, name, 'application/octet-stream'), { class: 'link' });
        act.append(make('span', WORDS.megabytes(bytes), { class: 'dim' }));
        item.append(act);
        list.append(item);
      }
      group.append(make('h3', kind), list);
      return group;
    }));
  }

  async fetch(request, name, type) {
    byId('files-say').textContent = this.making(WORDS.saving(name));
    try {
      save(name, await this.engine.ask({ ...request, ...this.asked() }), type);
      byId('files-say').textContent = WORDS.saved(name);
    } catch (problem) {
      if (!(problem instanceof Stale)) byId('files-say').textContent = WORDS.filesFail + problem.message;
    }
  }
}
