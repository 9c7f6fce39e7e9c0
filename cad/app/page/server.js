// Beside the server of `pinswitch view`: the file that it was started with, followed while others edit it, and saved.

class Served {
  constructor(state) {
    this.state = state;
    byId('save').addEventListener('click', () => this.save());
  }

  // What the server was started with; null in a page that holds its own engine.
  static async start() {
    if (byId('module').textContent.trim() || location.protocol === 'file:') return null;
    try {
      const response = await fetch('start');
      return response.ok && (response.headers.get('content-type') ?? '').includes('json') ? await response.json() : null;
    } catch {
      return null;
    }
  }

  begin(started) {
    byId('set-page').hidden = !started;
    if (!started?.begun.file) return;
    this.file = started.begun.file;
    byId('save').textContent = WORDS.saveTo(this.file);
    byId('save').hidden = !started.begun.saves;
    const values = this.state.withoutDefaults(started.values);
    // What the page knows of the file: its stamp, of this visit or of the last one.
    const { seen } = remembered();
    const isSame = sameValue(values, this.state.now.values);
    this.stamp = isSame || (seen?.file === this.file && seen.stamp === started.stamp) ? started.stamp : '';
    this.know(this.stamp);
    if (started.trouble) showNoticeAbout('file', started.trouble);
    // An address that somebody was given says nothing of the file: saving asks then.
    else if (!this.stamp && seen?.file === this.file) showNoticeAbout('file', WORDS.fileDiffers(this.file), this.showButton(values, started.stamp));
    this.follow(started.version);
  }

  // The file as the page has last shown or written it. Where it is another one by then, saving asks first.
  know(stamp) {
    this.stamp = stamp;
    if (stamp) remember({ ...remembered(), seen: { file: this.file, stamp } });
  }

  showButton(values, stamp) {
    return button(WORDS.showFile(this.file), () => {
      this.state.change({ values });
      this.know(stamp);
      showNotice('');
    });
  }

  // Takes the file's values whenever it was changed beside the page; Undo goes back to before.
  async follow(version) {
    for (let pause_ms = 1000; ; pause_ms = Math.min(2 * pause_ms, 30000)) {
      try {
        for (;;) {
          const next = await (await fetch(`start?after=${version}`)).json();
          pause_ms = 1000;
          if (next.version === version) continue;
          version = next.version;
          if (next.trouble) showNoticeAbout('file', next.trouble); else forgetNotice('file');
          if (next.trouble || !next.values || next.stamp === this.stamp) continue;
          this.know(next.stamp);
          if (!sameValue(this.state.withoutDefaults(next.values), this.state.now.values)) {
            this.state.change({ values: next.values });
            say(WORDS.fileChanged(this.file));
          }
        }
      } catch {
        // A server that is gone is told when a design is asked for.
        await new Promise((done) => setTimeout(done, pause_ms));
      }
    }
  }

  // Saves over the file with this stamp, and over no other; `anew` where it is gone.
  async save(stamp = this.stamp, anew = false) {
    const { values, model } = this.state.now;
    try {
      const response = await fetch('save', { method: 'POST', headers: { 'content-type': 'application/json' }, body: JSON.stringify({ values, stamp, anew }) });
      const { saved, stamp: written, hidden, differs, gone, error } = await response.json();
      if (saved) {
        this.know(written);
        showNotice(hidden.length ? WORDS.savedUnder(saved, hidden.map(([option, path]) => [option, fieldName(this.state.fields.get(path))])) : '');
        say(model ? WORDS.savedWithoutModel(saved) : WORDS.savedTo(saved));
      } else if (differs) {
        const names = [...this.state.fields.keys()].filter((path) => !sameValue(differs.values[path] ?? null, values[path] ?? null));
        if (!names.length) { await this.save(differs.stamp); return; }
        const over = button(WORDS.saveOver, () => this.save(differs.stamp));
        showNoticeAbout('file', WORDS.fileNewer(this.file, names.slice(0, 6).map((path) => fieldName(this.state.fields.get(path)))), this.showButton(differs.values, differs.stamp), over);
      } else if (gone) {
        showNoticeAbout('file', WORDS.fileGone(this.file), button(WORDS.writeAnew, () => this.save(stamp, true)));
      } else {
        showNotice(WORDS.notSaved(this.file) + error);
      }
    } catch {
      showNotice(WORDS.notSaved(this.file) + WORDS.serverGone);
    }
  }
}
