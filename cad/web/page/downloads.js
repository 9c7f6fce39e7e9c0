// Files of the design: a list with sizes, one by one, or all in an archive.

class Downloads {
  constructor(state, engine) {
    Object.assign(this, { state, engine });
    this.dialog = byId('files');
    byId('download').addEventListener('click', () => this.open());
    byId('files-close').addEventListener('click', () => this.dialog.close());
    byId('zip').addEventListener('click', () => this.fetch({ ask: 'zip' }, `${this.name()}.zip`, 'application/zip'));
    byId('toml').addEventListener('click', () => save(`${this.name()}.toml`, this.toml, 'application/toml'));
  }

  // What the last design that can be built was: its name and its configuration.
  show(data, toml) {
    this.title = data.manifest.name;
    this.toml = toml;
  }

  name() { return this.title ?? 'switch'; }
  asked() { return { values: this.state.now.values, model: this.state.now.model?.toml ?? null }; }

  async open() {
    const cannot = document.body.classList.contains('stale') || !this.toml;
    this.dialog.showModal();
    byId('file-list').replaceChildren();
    byId('zip').disabled = byId('toml').disabled = cannot;
    byId('files-say').textContent = cannot ? WORDS.noFiles : WORDS.makingFiles;
    if (cannot) return;
    const turn = this.turn = (this.turn ?? 0) + 1;
    try {
      const { files } = await this.engine.ask({ ask: 'files', ...this.asked() });
      if (turn !== this.turn) return;
      this.list(files);
      byId('files-say').textContent = '';
    } catch (problem) {
      if (!(problem instanceof Stale)) byId('files-say').textContent = WORDS.filesFail + problem.message;
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
    byId('files-say').textContent = WORDS.saving(name);
    try {
      save(name, await this.engine.ask({ ...request, ...this.asked() }), type);
      byId('files-say').textContent = WORDS.saved(name);
    } catch (problem) {
      if (!(problem instanceof Stale)) byId('files-say').textContent = WORDS.filesFail + problem.message;
    }
  }
}
