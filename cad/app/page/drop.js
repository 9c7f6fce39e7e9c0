// Files that are dropped on the page or chosen: what each is, and what cannot be read.

const MEGA = 1e6;
const LARGEST_CONFIGURATION = MEGA;

class Drop {
  // Tables of at most `largestTable_mb` are taken: the engine's bound.
  constructor({ table: takeTable, configuration, model, largestTable_mb }) {
    Object.assign(this, { takeTable, configuration, model, largestTable_mb });
    byId('open').addEventListener('click', () => byId('open-file').click());
    byId('open-file').addEventListener('change', (event) => { this.files(event.target.files); event.target.value = ''; });
    let depth = 0;
    const hint = (on) => { byId('drop').hidden = !on; };
    const hasFiles = (event) => [...(event.dataTransfer?.types ?? [])].includes('Files');
    addEventListener('dragenter', (event) => { if (hasFiles(event)) { depth += 1; hint(true); event.preventDefault(); } });
    addEventListener('dragleave', (event) => { if (hasFiles(event)) { depth -= 1; hint(depth > 0); } });
    addEventListener('dragover', (event) => { if (hasFiles(event)) event.preventDefault(); });
    addEventListener('drop', (event) => {
      if (!hasFiles(event)) return;
      event.preventDefault();
      depth = 0;
      hint(false);
      this.files(event.dataTransfer.files);
    });
  }

  async files(files) {
    if (!files.length) return;
    // What is said of them would lie behind it.
    if (byId('files').open) byId('files').close();
    if (files.length > 1) say(WORDS.manyFiles);
    const [file] = files;
    const kind = /\.(csv|tsv|txt)$/i.test(file.name) ? 'table' : /\.toml$/i.test(file.name) ? 'toml' : null;
    const mega = (file.size / MEGA).toFixed(1);
    if (!kind) return this.refuse(WORDS.foreign(file.name));
    if (file.size === 0) return this.refuse(WORDS.empty(file.name));
    if (kind === 'table' && file.size > this.largestTable_mb * MEGA) return this.refuse(WORDS.tooLarge(file.name, mega, this.largestTable_mb));
    if (kind === 'toml' && file.size > LARGEST_CONFIGURATION) return this.refuse(WORDS.tooLargeConfiguration(file.name, mega));
    let text;
    try { text = await file.text(); } catch { return this.refuse(WORDS.unreadable(file.name)); }
    if (text.includes('\0') || text.includes('\uFFFD')) return this.refuse(WORDS.notText(file.name));
    showNotice('');
    if (kind === 'table') return this.takeTable(text, file.name);
    return /^\s*schema\s*=\s*"pinswitch\.model\//m.test(text) ? this.model(text, file.name) : this.configuration(text, file.name);
  }

  refuse(words) { showNotice(words); }
}
