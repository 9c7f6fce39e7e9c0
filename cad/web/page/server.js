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
    if (!started?.file) return;
    this.file = started.file;
    byId('save').textContent = WORDS.saveTo(this.file);
    byId('save').hidden = false;
    if (started.trouble) showNotice(started.trouble);
    this.follow(started.version);
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
          showNotice(next.trouble ?? '');
          if (next.values && !next.trouble && !sameValue(this.state.withoutDefaults(next.values), this.state.now.values)) {
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

  async save() {
    try {
      const response = await fetch('save', { method: 'POST', headers: { 'content-type': 'application/json' }, body: JSON.stringify({ values: this.state.now.values }) });
      const { saved, error } = await response.json();
      if (saved) say(WORDS.savedTo(saved)); else showNotice(WORDS.notSaved(this.file) + error);
    } catch {
      showNotice(WORDS.notSaved(this.file) + WORDS.serverGone);
    }
  }
}
