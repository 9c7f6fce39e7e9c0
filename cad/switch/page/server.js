// The file of `pinswitch view`: followed while other programs edit it, and saved.

class ServerFile {
  constructor(state) {
    this.state = state;
    byId('save').addEventListener('click', () => this.save());
  }

  // What the server shows; null in a page with its own engine.
  static async start() {
    if (document.body.dataset.state !== 'served' || location.protocol === 'file:') return null;
    try {
      const response = await fetch('start');
      return response.ok && (response.headers.get('content-type') ?? '').includes('json') ? await response.json() : null;
    } catch {
      return null;
    }
  }

  begin(started) {
    if (!started?.source.file) return;
    this.file = started.source.file;
    byId('save').textContent = TEXT.saveTo(this.file);
    byId('save').hidden = !started.source.is_writable;
    const values = this.state.withoutDefaults(started.values);
    // The stamp of the file as the page last showed or wrote it, in this visit or the last one.
    const { seen } = remembered();
    const isSame = sameValue(values, this.state.now.values);
    this.stamp = isSame || (seen?.file === this.file && seen.stamp === started.stamp) ? started.stamp : '';
    this.setStamp(this.stamp);
    if (started.trouble) showNoticeAbout('file', started.trouble);
    // The design of another address does not come from the file: saving needs a confirmation.
    else if (!this.stamp && seen?.file === this.file) showNoticeAbout('file', TEXT.fileDiffers(this.file), this.showButton(values, started.stamp));
    this.follow(started.version);
  }

  // Records the file as shown or written. Saving a file with another stamp needs a confirmation.
  setStamp(stamp) {
    this.stamp = stamp;
    if (stamp) remember({ ...remembered(), seen: { file: this.file, stamp } });
  }

  showButton(values, stamp) {
    return button(TEXT.showFile(this.file), () => {
      this.state.change({ values });
      this.setStamp(stamp);
      showNotice('');
    });
  }

  // Applies the values of the file when another program changes it; Undo reverts them.
  async follow(version) {
    for (let pause_ms = 1000; ; pause_ms = Math.min(2 * pause_ms, 30000)) {
      try {
        for (;;) {
          const next = await (await fetch(`start?after=${version}`)).json();
          pause_ms = 1000;
          if (next.version === version) continue;
          version = next.version;
          if (next.trouble) showNoticeAbout('file', next.trouble); else clearNoticeAbout('file');
          if (next.trouble || !next.values || next.stamp === this.stamp) continue;
          this.setStamp(next.stamp);
          if (!sameValue(this.state.withoutDefaults(next.values), this.state.now.values)) {
            this.state.change({ values: next.values });
            showToast(TEXT.fileChanged(this.file));
          }
        }
      } catch {
        // The next request for a design reports the missing server.
        await new Promise((done) => setTimeout(done, pause_ms));
      }
    }
  }

  // Writes the file if it has this stamp; `create` writes a missing one.
  async save(stamp = this.stamp, create = false) {
    const { values, model } = this.state.now;
    try {
      const response = await fetch('save', { method: 'POST', headers: { 'content-type': 'application/json' }, body: JSON.stringify({ values, stamp, create }) });
      const { saved, stamp: written, overridden, changed, missing, error } = await response.json();
      if (saved) {
        this.setStamp(written);
        showNotice(overridden.length ? TEXT.savedOverridden(saved, overridden.map(([option, path]) => [option, fieldName(this.state.fields.get(path))])) : '');
        showToast(model ? TEXT.savedWithoutModel(saved) : TEXT.savedTo(saved));
      } else if (changed) {
        const names = [...this.state.fields.keys()].filter((path) => !sameValue(changed.values[path] ?? null, values[path] ?? null));
        if (!names.length) { await this.save(changed.stamp); return; }
        const overwrite = button(TEXT.overwrite, () => this.save(changed.stamp));
        showNoticeAbout('file', TEXT.fileNewer(this.file, names.slice(0, 6).map((path) => fieldName(this.state.fields.get(path)))), this.showButton(changed.values, changed.stamp), overwrite);
      } else if (missing) {
        showNoticeAbout('file', TEXT.fileMissing(this.file), button(TEXT.createFile, () => this.save(stamp, true)));
      } else {
        showNotice(TEXT.notSaved(this.file) + error);
      }
    } catch {
      showNotice(TEXT.notSaved(this.file) + TEXT.serverGone);
    }
  }
}
