// The page: starts the engine, shows the design of each state, and writes the address.

// Time without a change after which the exact design replaces the coarse one.
const EXACT_DELAY_MS = 450;
// Interval of writes to the address; browsers refuse a hundred in ten seconds.
const ADDRESS_MS = 250;
const FIRST_TEMPLATE = 'three-double';

let errors = 0;
function reportError(message) {
  errors += 1;
  document.body.dataset.errors = errors;
  showNotice(TEXT.fault(message));
}
document.body.dataset.errors = 0;
document.body.dataset.generation = document.body.dataset.requested = document.body.dataset.answered = 0;
addEventListener('error', (event) => { if (!/ResizeObserver/.test(event.message)) reportError(event.message); });
addEventListener('unhandledrejection', (event) => reportError(String(event.reason?.message ?? event.reason)));

// Shows a notice over the picture: about an address, a file, or the engine. `actions` are buttons.
function showNotice(text, ...actions) {
  const host = byId('notice');
  host.hidden = !text;
  host.dataset.about = '';
  host.replaceChildren();
  if (!text) return;
  host.append(make('p', text));
  host.append(...actions);
  host.append(button('×', () => showNotice(''), { class: 'tiny', 'aria-label': TEXT.close }));
}

// Messages are over the picture; without room for them below the header, they float over the page.
const HEADER_PX = 66;
function floatNotice() {
  const [picture, banners] = [document.querySelector('.picture'), document.querySelector('.banners')];
  const update = () => banners.classList.toggle('floating-banners', picture.getBoundingClientRect().bottom < HEADER_PX + banners.scrollHeight);
  addEventListener('scroll', update, { passive: true });
  new ResizeObserver(update).observe(banners);
  new ResizeObserver(update).observe(picture);
}

// Shows a notice about a topic; `clearNoticeAbout` removes it, and no other.
function showNoticeAbout(about, text, ...actions) {
  showNotice(text, ...actions);
  byId('notice').dataset.about = about;
}
function clearNoticeAbout(about) { if (byId('notice').dataset.about === about) showNotice(''); }

function fillTexts() {
  if (!IS_REPORT) document.title = TEXT.title;
  // The steps, each a button that shows where it is taken.
  const places = { parameters: 'targets-title', curve: 'curve-title', download: 'materials-title' };
  byId('steps').append(...Object.entries(TEXT.steps).map(([step, text]) => {
    const item = make('li');
    item.append(button(text, () => byId(places[step]).scrollIntoView({ block: 'start', behavior: 'smooth' }), { class: 'link' }));
    return item;
  }));
  // The heading of a report is the name of the plot.
  if (IS_REPORT) byId('curve-title').dataset.text = 'curve';
  for (const element of document.querySelectorAll('[data-text]')) element.prepend(TEXT[element.dataset.text]);
  for (const element of document.querySelectorAll('[data-name]')) element.setAttribute('aria-label', TEXT[element.dataset.name]);
  for (const element of document.querySelectorAll('[data-placeholder]')) element.placeholder = TEXT[element.dataset.placeholder];
  for (const element of document.querySelectorAll('[data-title]')) element.title = TEXT[element.dataset.title];
}

class Page {
  async start() {
    fillTexts();
    nameApp();
    floatNotice();
    new Focus();
    this.engine = new Engine();
    byId('busy').textContent = TEXT.starting;
    let facts;
    try {
      facts = await this.engine.request({ command: 'facts' });
    } catch (problem) {
      byId('busy').textContent = '';
      document.body.dataset.engineFailed = 'true';
      showNotice(problem.message, button(TEXT.retry, () => location.reload()));
      return;
    }
    this.facts = facts;
    const state = this.state = new State(facts);
    FIELDS = state.fields;
    const started = await ServerFile.start();
    await this.begin(started);
    this.view = new View();
    // The exact design brings a picture in place of the view.
    this.view.lost = () => this.design('exact');
    this.curve = new Curve(state);
    this.curve.moved = (load_n) => { this.view.load(load_n); this.pins?.pose(load_n); };
    this.handles = new Handles(this.curve, state);
    this.strip = new Strip(this.curve, state);
    this.controls = new Controls(byId('fields'), facts, state, this.engine);
    this.pins = new Pins(byId('pins'), state);
    this.targets = new Targets(state, this.engine, this.curve, this.handles);
    this.targets.applied = () => { this.from = this.data?.manifest.friction; };
    this.measurements = new Measurements(state, this.engine, this.curve);
    this.measurements.applied = this.targets.applied;
    this.downloads = new Downloads(state, this.engine);
    this.embed = new Embed((hash) => this.applyHash(hash), state);
    const drop = new Drop({
      openTable: (bytes, file) => this.measurements.open(bytes, file),
      openConfiguration: (text, file) => this.open(text, file),
      openModel: (text, file) => this.measurements.openModel(text, file),
      openSession: (text, file) => this.openSession(text, file),
      maxTable_mb: facts.largest_table_mb,
    });
    this.measurements.onFiles = (files) => drop.open(files);
    this.addTemplates();
    this.listen();
    this.requestExact = debounce(() => this.design('exact'), EXACT_DELAY_MS);
    this.updateAddress = debounce(() => this.writeAddress(), ADDRESS_MS);
    state.addEventListener('change', () => { this.changed(); this.updateAddress(); });
    state.addEventListener('step', () => clearNoticeAbout('address'));
    addEventListener('hashchange', () => this.addressChanged());
    byId('generator').textContent = facts.generator;
    this.changed();
    this.writeAddress();
    new ServerFile(state).begin(started);
    this.introduce();
  }

  // On a first visit the switch moves once, until a person does something.
  introduce() {
    const isFirst = !IS_REPORT && !this.embed.isOn && !this.visited;
    if (!isFirst) return;
    const { motion } = this.curve;
    motion.start(2 * MOTION_MS);
    for (const name of ['pointerdown', 'keydown', 'wheel', 'hashchange']) addEventListener(name, () => motion.stop(), { once: true, capture: true, passive: true });
  }

  // Sets the first state: that of the address, of the server, of the last visit, or a published
  // layout.
  async begin(started) {
    this.visited = Boolean(remembered().hash || location.hash || started?.source.file);
    this.state.begin({ fit: remembered().fit ?? null });
    if (IS_REPORT) { this.state.begin(this.facts.state); return; }
    const decoded = await decodeHash(location.hash, this.state.fields);
    if (decoded?.messages.length) showNoticeAbout('address', decoded.messages.join(' '));
    if (decoded?.parts) { this.state.begin(decoded.parts); return; }
    if (started?.source.is_explicit && !started.trouble) { this.state.begin({ values: started.values }); return; }
    const last = decoded ? null : await decodeHash(remembered().hash ?? '', this.state.fields);
    if (last?.parts) { this.state.begin(last.parts); showToast(TEXT.restored); return; }
    this.state.begin({ values: { ...this.published()?.values } });
  }

  // Applies addresses in order: one with a model takes longer to decode than the next one.
  applyHash(hash) {
    if (IS_REPORT) return Promise.resolve();
    const result = (this.hashQueue ?? Promise.resolve()).then(() => this.applyNow(hash));
    this.hashQueue = result.catch(() => {});
    return result;
  }

  async applyNow(hash) {
    const decoded = await decodeHash(hash, this.state.fields);
    const messages = [...(decoded?.messages ?? []), ...(decoded?.isInvalid ? [TEXT.hash.unchanged] : [])].join(' ');
    showNoticeAbout('address', messages);
    const before = this.state.now;
    // Before the change, which may send it.
    this.embed.ignored = messages || null;
    if (decoded?.parts) this.state.change(decoded.parts);
    this.embed.applied(messages, this.state.now === before);
    this.updateAddress();
  }

  addressChanged() { if (location.hash !== this.written) this.applyHash(location.hash); }

  writeAddress() {
    if (IS_REPORT) return;
    this.written = encodeHash(this.state.now);
    history.replaceState(null, '', this.written);
    remember({ ...remembered(), hash: this.written });
  }

  changed() {
    byId('undo').disabled = !this.state.past.length;
    byId('redo').disabled = !this.state.future.length;
    this.markTemplate();
    const requested = JSON.stringify([this.state.now.values, this.state.now.model?.packed]);
    // Targets change neither parts nor curve.
    if (requested === this.requested) { this.embed.sendTargets(this.state.now); return; }
    this.requested = requested;
    document.body.dataset.requested = Number(document.body.dataset.requested) + 1;
    this.design('coarse');
    this.requestExact();
  }

  async design(quality) {
    const { now } = this.state;
    const { values, model } = now;
    const { requested } = this;
    const number = document.body.dataset.requested;
    document.body.dataset.pending = 'true';
    const slow = setTimeout(() => { byId('busy').textContent = TEXT.working; }, 300);
    try {
      const answer = await this.engine.request({ command: 'design', values, quality, model: model?.toml ?? null });
      if (answer.data) { this.instead = null; this.show(answer, quality, now); }
      else if (!this.data) await this.showPublished();
      document.body.classList.remove('disconnected');
      showTrouble(answer.trouble, this.controls, this.state, this.instead);
      this.downloads.refresh();
      document.body.dataset.answered = number;
      this.embed.sendDesign(now, this.state.now, answer.data, answer.trouble);
      if (quality === 'exact' && requested === this.requested) document.body.dataset.pending = 'false';
      if (this.isDisconnected) { this.isDisconnected = false; showNotice(''); }
    } catch (problem) {
      if (problem instanceof Superseded) return;
      if (!(problem instanceof EngineError)) throw problem;
      this.isDisconnected = problem.kind === 'gone';
      document.body.classList.add('stale');
      document.body.classList.toggle('disconnected', this.isDisconnected);
      this.downloads.refresh();
      showNotice(problem.message, button(TEXT.retry, () => this.design('exact')));
      if (requested === this.requested) document.body.dataset.pending = 'false';
    } finally {
      clearTimeout(slow);
      byId('busy').textContent = '';
    }
  }

  // If the first design cannot be built, a published one is shown in grey.
  async showPublished() {
    const values = this.published()?.values ?? {};
    const answer = await this.engine.request({ command: 'design', values, quality: 'coarse', model: null, extra: true });
    if (!answer.data || this.data) return;
    this.instead = answer.data.manifest.name;
    this.show(answer, 'coarse', { values, model: null });
  }

  published() { return this.facts.templates.find((t) => t.name === FIRST_TEMPLATE) ?? this.facts.templates[0]; }

  show({ data }, quality, { values, model }) {
    this.data = data;
    this.markTemplate();
    this.view.show(data);
    this.pins.show(data, values);
    this.curve.show(data, values, model?.name ?? null);
    this.measurements.countPoints();
    this.reportChange(data.manifest.friction);
    this.strip.update();
    showChecks(data);
    showMaterials(data);
    this.downloads.show(data);
    const { dataset } = document.body;
    dataset.generation = Number(dataset.generation) + 1;
    dataset.quality = quality;
    dataset.ready = 'true';
    if (quality !== 'exact') return;
    byId('announcement').textContent = this.announcement(data);
    this.view.showPicture(this.engine, { values, model: model?.toml ?? null });
  }

  // Reports what an applied design or model changed.
  reportChange(friction) {
    const { from } = this;
    this.from = null;
    if (from) showToast(TEXT.changeOf(from, friction));
  }

  // The change, for screen readers.
  announcement({ manifest: { friction: f } }) {
    const switches = f.threshold_n === null ? [] : [TEXT.switchesAtLoad(TEXT.newtons(f.threshold_n))];
    return [TEXT.loadText(f.load_n.toFixed(1), f.friction_n.toFixed(2)), ...switches, TEXT.trust[f.trust] ?? f.trust].join('; ');
  }

  async open(text, file) {
    if (IS_REPORT) { showNotice(TEXT.isReport); return; }
    try {
      const { values, trouble } = await this.engine.request({ command: 'open', toml: text, file });
      if (values) { this.state.change({ values }); showToast(TEXT.opened(file)); }
      else showNotice(TEXT.notOpened(file) + (trouble ? troubleText(trouble) : ''));
    } catch (problem) {
      if (!(problem instanceof Superseded)) showNotice(TEXT.notOpened(file) + problem.message);
    }
  }

  // Opens what a page has saved: design, targets, model and measurements.
  async openSession(text, file) {
    const parts = IS_REPORT ? null : await readSession(text, this.state.fields);
    if (!parts) { showNotice(IS_REPORT ? TEXT.isReport : TEXT.notSession(file)); return; }
    this.state.change(parts);
    showToast(TEXT.opened(file));
  }

  addTemplates() {
    this.chips = [];
    const published = this.facts.templates.filter((t) => t.kind === 'published');
    const shortcuts = published.filter((t) => !t.name.startsWith('proxy-'));
    shortcuts.forEach((t) => {
      const chip = button(t.name, () => this.applyTemplate(t), { class: 'chip', 'aria-pressed': 'false', title: t.about });
      this.chips.push([chip, t]);
      byId('chips').append(chip);
    });
    const [list, menu] = [byId('template-list'), byId('more')];
    const apply = (template) => { this.applyTemplate(template); menu.open = false; menu.querySelector('summary').focus(); };
    const templates = new TemplateList(this.engine, this.pins, apply);
    list.append(button(TEXT.open, () => byId('open-file').click(), { class: 'link narrow' }));
    templates.add(list, TEXT.published, published);
    const printers = this.facts.templates.filter((t) => t.kind === 'printer');
    templates.add(list, TEXT.printers, printers);
    const choice = byId('printer');
    choice.append(make('option', TEXT.ownPrinter, { value: '' }), ...printers.map((t) => make('option', t.about, { value: t.name })));
    choice.addEventListener('change', () => {
      const printer = printers.find((t) => t.name === choice.value);
      if (printer) this.applyTemplate(printer);
    });
    menu.addEventListener('toggle', () => menu.open && templates.drawCurves());
  }

  applyTemplate(template) {
    const { values } = this.state.now;
    if (template.kind === 'printer') {
      // As --preset: the user's values override it. Values of another printer are removed.
      const printers = this.facts.templates.filter((t) => t.kind === 'printer');
      const own = Object.fromEntries(Object.entries(values).filter(([path, value]) => !printers.some((t) => path in t.values && sameValue(t.values[path], value))));
      const kept = Object.keys(template.values).filter((path) => path in own);
      this.state.change({ values: { ...template.values, ...own } });
      showToast(TEXT.printerApplied(template.name, kept.map((path) => fieldName(this.state.fields.get(path)))));
      return;
    }
    // The printer stays, as with --preset.
    const printer = this.printer();
    const kept = Object.fromEntries(Object.keys(printer?.values ?? {}).filter((path) => path in values).map((path) => [path, values[path]]));
    const isOfTemplates = (path) => this.facts.templates.some((t) => t.kind === 'published' && path in t.values);
    const lost = Object.keys(values).filter((path) => !(path in template.values) && !(path in kept) && !isOfTemplates(path)).length;
    this.state.change({ values: { ...kept, ...template.values } });
    const { model, targets } = this.state.now;
    const others = [...(printer ? [printer.name] : []), ...(model ? [TEXT.modelName(model.name)] : []), ...(targets.threshold_n !== null || targets.friction.length ? [TEXT.yourTargets] : [])];
    const text = TEXT.templateApplied(template.name, lost, others);
    if (!model && others.length === (printer ? 1 : 0)) { showToast(text); return; }
    showNoticeAbout('template', text, button(TEXT.asPublished, () => {
      this.state.change({ model: null, targets: { threshold_n: null, friction: [] } });
      clearNoticeAbout('template');
    }));
  }

  // The printer whose values the design has; undefined without one.
  printer() {
    const { values } = this.state.now;
    return this.facts.templates.find((t) => t.kind === 'printer' && Object.entries(t.values).every(([path, value]) => sameValue(values[path], value)));
  }

  markTemplate() {
    const now = this.state.now.values;
    const printer = this.printer();
    byId('printer').value = printer?.name ?? '';
    const rest = Object.fromEntries(Object.entries(now).filter(([path]) => !(path in (printer?.values ?? {}))));
    const isThis = (t) => sameValue(this.state.withoutDefaults(t.values), this.state.withoutDefaults(rest));
    for (const [chip, t] of this.chips) chip.setAttribute('aria-pressed', String(isThis(t)));
    const name = this.data?.manifest.name ?? '';
    const template = this.facts.templates.find((t) => t.name === name);
    byId('name').textContent = template && !isThis(template) ? TEXT.changedFrom(name) : name;
  }

  listen() {
    const { state } = this;
    // Without changing the fragment of the address, which is the design.
    document.querySelector('.skip').addEventListener('click', (event) => { event.preventDefault(); byId('main').focus(); });
    byId('undo').addEventListener('click', () => state.undo());
    byId('redo').addEventListener('click', () => state.redo());
    byId('share').addEventListener('click', () => this.share());
    byId('download-here').addEventListener('click', () => this.downloads.open());
    byId('parameters').addEventListener('click', () => this.sheet(true));
    byId('sheet-close').addEventListener('click', () => this.sheet(false));
    byId('curve-table').addEventListener('toggle', () => this.curve.data && this.curve.describe());
    addEventListener('keydown', (event) => {
      if (event.key === 'Escape') { this.sheet(false); this.closeMenus(); }
      if (!(event.ctrlKey || event.metaKey) || event.altKey || byId('files').open) return;
      const key = event.key.toLowerCase();
      // In a text input the browser has its own undo.
      if (event.target.matches?.('input[type=text]:not(.number), input[type=search]')) return;
      if (key === 'z' && !event.shiftKey) state.undo();
      else if (key === 'y' || (key === 'z' && event.shiftKey)) state.redo();
      else return;
      event.preventDefault();
    });
    addEventListener('pointerdown', (event) => this.closeMenus(event.target));
    // A configuration as text, such as one that was shared.
    addEventListener('paste', (event) => {
      const text = event.clipboardData?.getData('text/plain') ?? '';
      if (event.target.matches?.('input, textarea, select') || !/^\s*(#.*\n\s*)*\[\w+\]/.test(text)) return;
      event.preventDefault();
      this.open(text, TEXT.clipboard);
    });
  }

  // Closes menus and reasons, except the one that contains `within`.
  closeMenus(within) {
    for (const menu of [byId('more'), byId('view-menu')]) if (!menu.contains(within ?? null)) menu.open = false;
    const isWithin = [byId('reasons'), byId('trust')].some((e) => e.contains(within ?? null));
    if (!isWithin) this.curve.showReasons(false);
  }

  sheet(open) {
    const was = document.body.classList.contains('sheet');
    document.body.classList.toggle('sheet', open);
    byId('parameters').setAttribute('aria-expanded', String(open));
    this.strip?.update();
    // Not the search field: it would open the keyboard of a phone over the sheet.
    if (open) byId('sheet-close').focus();
    else if (was) byId('parameters').focus();
  }

  async share() {
    this.writeAddress();
    // An address of this computer opens nowhere else: there the design itself is shared, as a text that the page opens.
    const isLocal = location.protocol === 'file:' || /^(localhost|.*\.localhost|127(\.\d+){3}|0\.0\.0\.0|\[::1?\])$/.test(location.hostname);
    const { model, fit, targets } = this.state.now;
    const lacks = isLocal ? Boolean(model || fit || targets.threshold_n !== null || targets.friction.length) : Boolean(fit);
    try {
      await navigator.clipboard.writeText(isLocal ? await this.configurationText() : location.href);
      showToast((isLocal ? TEXT.sharedText : TEXT.shared) + (lacks ? ` ${TEXT.sharedLacks(isLocal)}` : ''));
    } catch {
      showToast(isLocal ? TEXT.shareFileByHand : TEXT.shareByHand);
    }
  }

  // The configuration of the design as TOML.
  async configurationText() {
    const { values } = this.state.now;
    return (await this.engine.request({ command: 'design', values, quality: 'coarse', extra: true })).toml;
  }
}

new Page().start();
