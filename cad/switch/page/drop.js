// Files that are dropped on the page or chosen: recognises their type and refuses others.

const MEGA = 1e6;
const MAX_CONFIGURATION_BYTES = MEGA;
// A session contains a table of measurements.
const MAX_SESSION_BYTES = 30 * MEGA;
const WORKBOOK = /\.(xlsx|xls|ods)$/i;

class Drop {
  // Opens a file of measurements of at most `maxTable_mb`, the bound of the engine, a configuration, or a model.
  constructor({ openTable, openConfiguration, openModel, openSession, maxTable_mb }) {
    Object.assign(this, { openTable, openConfiguration, openModel, openSession, maxTable_mb });
    byId('open').addEventListener('click', () => byId('open-file').click());
    byId('open-file').addEventListener('change', (event) => { this.open(event.target.files); event.target.value = ''; });
    let depth = 0;
    const hint = (on) => { byId('drop').hidden = !on || IS_REPORT; };
    const hasFiles = (event) => [...(event.dataTransfer?.types ?? [])].includes('Files');
    addEventListener('dragenter', (event) => { if (hasFiles(event)) { depth += 1; hint(true); event.preventDefault(); } });
    addEventListener('dragleave', (event) => { if (hasFiles(event)) { depth -= 1; hint(depth > 0); } });
    addEventListener('dragover', (event) => { if (hasFiles(event)) event.preventDefault(); });
    addEventListener('drop', (event) => {
      if (!hasFiles(event)) return;
      event.preventDefault();
      depth = 0;
      hint(false);
      this.open(event.dataTransfer.files);
    });
  }

  async open(files) {
    if (!files.length) return;
    // The dialog would cover messages about them.
    if (byId('files').open) byId('files').close();
    if (files.length > 1) showToast(TEXT.manyFiles);
    const [file] = files;
    const kind = /\.(csv|tsv|txt|dat|log|lvm|xlsx|xls|ods)$/i.test(file.name) ? 'table' : /\.toml$/i.test(file.name) ? 'toml' : /\.json$/i.test(file.name) ? 'session' : null;
    if (IS_REPORT) return this.refuse(TEXT.isReport);
    const mega = (file.size / MEGA).toFixed(1);
    if (!kind) return this.refuse(TEXT.unknownType(file.name));
    if (file.size === 0) return this.refuse(TEXT.empty(file.name));
    if (kind === 'table' && file.size > this.maxTable_mb * MEGA) return this.refuse(TEXT.tooLarge(file.name, mega, this.maxTable_mb));
    if (kind !== 'table' && file.size > (kind === 'toml' ? MAX_CONFIGURATION_BYTES : MAX_SESSION_BYTES)) return this.refuse(kind === 'toml' ? TEXT.tooLargeConfiguration(file.name, mega) : TEXT.notSession(file.name));
    let bytes;
    try { bytes = new Uint8Array(await file.arrayBuffer()); } catch { return this.refuse(TEXT.unreadable(file.name)); }
    const isUtf16 = (bytes[0] === 0xff && bytes[1] === 0xfe) || (bytes[0] === 0xfe && bytes[1] === 0xff);
    const isBinary = !isUtf16 && !WORKBOOK.test(file.name) && bytes.includes(0);
    if (isBinary) return this.refuse(TEXT.notText(file.name));
    if (kind === 'table') { showNotice(''); return this.openTable(bytes, file.name); }
    const text = new TextDecoder().decode(bytes);
    if (text.includes('\uFFFD')) return this.refuse(TEXT.notText(file.name));
    showNotice('');
    if (kind === 'session') return this.openSession(text, file.name);
    return /^\s*schema\s*=\s*"pinswitch\.model\//m.test(text) ? this.openModel(text, file.name) : this.openConfiguration(text, file.name);
  }

  refuse(text) { showNotice(text); }
}
