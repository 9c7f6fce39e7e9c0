// The whole: starts the engine, shows each design that the state asks for, and keeps the address.

// So long nothing may change before the exact design is asked for, in place of the coarse one.
const CALM_MS = 450;
// The address is written no more often: browsers refuse a hundred in ten seconds.
const ADDRESS_MS = 250;
const FIRST = 'three-double';

let faults = 0;
function fault(message) {
  faults += 1;
  document.body.dataset.errors = faults;
  showNotice(WORDS.fault(message));
}
document.body.dataset.errors = 0;
document.body.dataset.generation = document.body.dataset.asked = document.body.dataset.answered = 0;
addEventListener('error', (event) => { if (!/ResizeObserver/.test(event.message)) fault(event.message); });
addEventListener('unhandledrejection', (event) => fault(String(event.reason?.message ?? event.reason)));

// A line over the picture: about an address, a file, the engine. `acts` are what could be done.
function showNotice(words, ...acts) {
  const host = byId('notice');
  host.hidden = !words;
  host.dataset.about = '';
  host.replaceChildren();
  if (!words) return;
  host.append(make('p', words));
  host.append(...acts);
  host.append(button('×', () => showNotice(''), { class: 'tiny', 'aria-label': WORDS.close }));
}

// Where the picture is out of sight, what is said of something else that a person did follows them there.
function followPicture() {
  const away = ([{ isIntersecting }]) => byId('notice').classList.toggle('away', !isIntersecting);
  new IntersectionObserver(away, { rootMargin: '-60px 0px 0px 0px' }).observe(document.querySelector('.picture'));
}

// The same about something that may pass: `forgetNotice` takes it away, and leaves any other.
function showNoticeAbout(about, words, ...acts) {
  showNotice(words, ...acts);
  byId('notice').dataset.about = about;
}
function forgetNotice(about) { if (byId('notice').dataset.about === about) showNotice(''); }

function fillWords() {
  document.title = WORDS.title;
  for (const element of document.querySelectorAll('[data-word]')) element.prepend(WORDS[element.dataset.word]);
  for (const element of document.querySelectorAll('[data-name]')) element.setAttribute('aria-label', WORDS[element.dataset.name]);
  for (const element of document.querySelectorAll('[data-hint]')) element.placeholder = WORDS[element.dataset.hint];
  for (const element of document.querySelectorAll('[data-tip]')) element.title = WORDS[element.dataset.tip];
}

class Page {
  async start() {
    fillWords();
    followPicture();
    new Focus();
    this.engine = new Engine();
    byId('busy').textContent = WORDS.starting;
    let facts;
    try {
      facts = await this.engine.ask({ ask: 'facts' });
    } catch (problem) {
      byId('busy').textContent = '';
      document.body.dataset.broken = 'true';
      showNotice(problem.message, button(WORDS.retry, () => location.reload()));
      return;
    }
    this.facts = facts;
    const state = this.state = new State(facts);
    const started = await Served.start();
    await this.first(started);
    this.view = new View();
    // The design is asked for once more, which brings a picture in its place.
    this.view.lost = () => this.design('exact');
    this.curve = new Curve(state);
    this.curve.moved = (load_n) => this.view.load(load_n);
    this.handles = new Handles(this.curve, state);
    this.controls = new Controls(byId('fields'), facts, state);
    this.pins = new Pins(byId('pins'), state);
    this.ask = new Ask(state, this.engine, this.curve, this.handles);
    this.measured = new Measured(state, this.engine, this.curve);
    this.downloads = new Downloads(state, this.engine);
    this.embed = new Embed((hash) => this.take(hash), state);
    const drop = new Drop({
      table: (text, file) => this.measured.calibrate(text, file),
      configuration: (text, file) => this.open(text, file),
      model: (text, file) => this.measured.takeModel(text, file),
      largestTable_mb: facts.largest_table_mb,
    });
    this.measured.chosen = (files) => drop.files(files);
    this.templates();
    this.buttons();
    this.exactly = later(() => this.design('exact'), CALM_MS);
    this.address = later(() => this.writeAddress(), ADDRESS_MS);
    state.addEventListener('change', () => { this.changed(); this.address(); });
    state.addEventListener('step', () => forgetNotice('address'));
    addEventListener('hashchange', () => this.addressChanged());
    byId('maker').textContent = facts.generator;
    this.changed();
    this.writeAddress();
    new Served(state).begin(started);
  }

  // The first state: of the address, of what the server was started with, of the last visit, or a published layout.
  async first(started) {
    const given = await decodeHash(location.hash, this.state.fields);
    if (given?.said.length) showNoticeAbout('address', given.said.join(' '));
    if (given?.parts) { this.state.begin(given.parts); return; }
    if (started?.begun.said && !started.trouble) { this.state.begin({ values: started.values }); return; }
    const last = given ? null : await decodeHash(remembered().hash ?? '', this.state.fields);
    if (last?.parts) { this.state.begin(last.parts); say(WORDS.welcomeBack); return; }
    this.state.begin({ values: { ...this.published()?.values } });
  }

  // One address after the other: one that holds a model takes longer to be read than the next one to come.
  take(hash) {
    const turn = (this.taking ?? Promise.resolve()).then(() => this.takeNow(hash));
    this.taking = turn.catch(() => {});
    return turn;
  }

  async takeNow(hash) {
    const given = await decodeHash(hash, this.state.fields);
    const said = [...(given?.said ?? []), ...(given?.broken ? [WORDS.hash.stays] : [])].join(' ');
    showNoticeAbout('address', said);
    const before = this.state.now;
    // Before the change, which may tell it.
    this.embed.said = said || null;
    if (given?.parts) this.state.change(given.parts);
    this.embed.took(said, this.state.now === before);
    this.address();
  }

  addressChanged() { if (location.hash !== this.written) this.take(location.hash); }

  writeAddress() {
    this.written = encodeHash(this.state.now);
    history.replaceState(null, '', this.written);
    remember({ ...remembered(), hash: this.written });
  }

  changed() {
    byId('undo').disabled = !this.state.past.length;
    byId('redo').disabled = !this.state.future.length;
    this.markTemplate();
    const asked = JSON.stringify([this.state.now.values, this.state.now.model?.packed]);
    // A mark of the ask changes no part.
    if (asked === this.asked) { this.embed.asked(this.state.now); return; }
    this.asked = asked;
    document.body.dataset.asked = Number(document.body.dataset.asked) + 1;
    this.design('coarse');
    this.exactly();
  }

  async design(quality) {
    const { now } = this.state;
    const { values, model } = now;
    const asked = this.asked;
    const question = document.body.dataset.asked;
    document.body.dataset.pending = 'true';
    const slow = setTimeout(() => { byId('busy').textContent = WORDS.working; }, 300);
    try {
      const answer = await this.engine.ask({ ask: 'design', values, quality, model: model?.toml ?? null });
      if (answer.data) { this.instead = null; this.show(answer, quality, now); }
      else if (!this.data) await this.showPublished();
      document.body.classList.remove('gone');
      showTrouble(answer.trouble, this.controls, this.state, this.instead);
      this.downloads.refresh();
      document.body.dataset.answered = question;
      this.embed.tell(now, this.state.now, answer.data, answer.trouble);
      if (quality === 'exact' && asked === this.asked) document.body.dataset.pending = 'false';
      if (this.isGone) { this.isGone = false; showNotice(''); }
    } catch (problem) {
      if (problem instanceof Stale) return;
      if (!(problem instanceof EngineError)) throw problem;
      this.isGone = problem.kind === 'gone';
      document.body.classList.add('stale');
      document.body.classList.toggle('gone', this.isGone);
      this.downloads.refresh();
      showNotice(problem.message, button(WORDS.retry, () => this.design('exact')));
      if (asked === this.asked) document.body.dataset.pending = 'false';
    } finally {
      clearTimeout(slow);
      byId('busy').textContent = '';
    }
  }

  // An address that cannot be built has no last good design: a published one stands there in grey.
  async showPublished() {
    const values = this.published()?.values ?? {};
    const answer = await this.engine.ask({ ask: 'design', values, quality: 'coarse', model: null, aside: true });
    if (!answer.data || this.data) return;
    this.instead = answer.data.manifest.name;
    this.show(answer, 'coarse', { values, model: null });
  }

  published() { return this.facts.templates.find((t) => t.name === FIRST) ?? this.facts.templates[0]; }

  show({ data }, quality, { values, model }) {
    this.data = data;
    this.markTemplate();
    this.view.show(data);
    this.curve.show(data, values, model?.name ?? null);
    showChecks(data);
    showBill(data);
    this.downloads.show(data);
    const { dataset } = document.body;
    dataset.generation = Number(dataset.generation) + 1;
    dataset.quality = quality;
    dataset.ready = 'true';
    if (quality !== 'exact') return;
    byId('heard').textContent = this.inWords(data);
    this.view.picture(this.engine, { values, model: model?.toml ?? null });
  }

  // What changed, for those who do not see it.
  inWords({ manifest: { friction: f } }) {
    const switches = f.threshold_n === null ? [] : [WORDS.thresholdNow(WORDS.newtons(f.threshold_n))];
    return [WORDS.loadText(f.load_n.toFixed(1), f.friction_n.toFixed(2)), ...switches, WORDS.trust[f.trust] ?? f.trust].join('; ');
  }

  async open(text, file) {
    try {
      const { values, trouble } = await this.engine.ask({ ask: 'open', toml: text, file });
      if (values) { this.state.change({ values }); say(WORDS.opened(file)); }
      else showNotice(WORDS.notOpened(file) + (trouble ? troubleWords(trouble) : ''));
    } catch (problem) {
      if (!(problem instanceof Stale)) showNotice(WORDS.notOpened(file) + problem.message);
    }
  }

  templates() {
    this.chips = [];
    const published = this.facts.templates.filter((t) => t.kind === 'published');
    const quick = published.filter((t) => !t.name.startsWith('proxy-'));
    quick.forEach((t) => {
      const chip = button(t.name, () => this.takeTemplate(t), { class: 'chip', 'aria-pressed': 'false', title: t.about });
      this.chips.push([chip, t]);
      byId('chips').append(chip);
    });
    const list = byId('template-list');
    const group = (title, templates) => {
      if (!templates.length) return;
      list.append(make('h2', title));
      for (const t of templates) {
        const item = button(t.name, () => { this.takeTemplate(t); byId('more').open = false; byId('more').querySelector('summary').focus(); }, { class: 'link' });
        item.append(make('span', t.about, { class: 'dim' }));
        list.append(item);
      }
    };
    list.append(button(WORDS.open, () => byId('open-file').click(), { class: 'link narrow' }));
    group(WORDS.published, published);
    group(WORDS.printers, this.facts.templates.filter((t) => t.kind === 'printer'));
  }

  takeTemplate(template) {
    const { values } = this.state.now;
    if (template.kind === 'printer') {
      // Under the design, as a preset of the command line: what a person has set stays. What another printer has set goes.
      const printers = this.facts.templates.filter((t) => t.kind === 'printer');
      const own = Object.fromEntries(Object.entries(values).filter(([path, value]) => !printers.some((t) => path in t.values && sameValue(t.values[path], value))));
      const kept = Object.keys(template.values).filter((path) => path in own);
      this.state.change({ values: { ...template.values, ...own } });
      say(WORDS.printerTaken(template.name, kept.map((path) => fieldName(this.state.fields.get(path)))));
      return;
    }
    const isOfTemplates = (path) => this.facts.templates.some((t) => t.kind === 'published' && path in t.values);
    const lost = Object.keys(values).filter((path) => !(path in template.values) && !isOfTemplates(path)).length;
    this.state.change({ values: { ...template.values } });
    say(WORDS.templateTaken(template.name, lost));
  }

  markTemplate() {
    const now = this.state.now.values;
    const isThis = (t) => sameValue(this.state.withoutDefaults(t.values), this.state.withoutDefaults(now));
    for (const [chip, t] of this.chips) chip.setAttribute('aria-pressed', String(isThis(t)));
    const name = this.data?.manifest.name ?? '';
    const template = this.facts.templates.find((t) => t.name === name);
    byId('name').textContent = template && !isThis(template) ? WORDS.changedFrom(name) : name;
  }

  buttons() {
    const { state } = this;
    // The address is that of the design, and none of a place on the page.
    document.querySelector('.skip').addEventListener('click', (event) => { event.preventDefault(); byId('main').focus(); });
    byId('undo').addEventListener('click', () => state.undo());
    byId('redo').addEventListener('click', () => state.redo());
    byId('share').addEventListener('click', () => this.share());
    byId('parameters').addEventListener('click', () => this.sheet(true));
    byId('sheet-close').addEventListener('click', () => this.sheet(false));
    byId('curve-table').addEventListener('toggle', () => this.curve.data && this.curve.words());
    addEventListener('keydown', (event) => {
      if (event.key === 'Escape') { this.sheet(false); this.closeMenus(); }
      if (!(event.ctrlKey || event.metaKey) || event.altKey || byId('files').open) return;
      const key = event.key.toLowerCase();
      // In a text that is being written, the browser's own undo.
      if (event.target.matches?.('input[type=text], input[type=search]')) return;
      if (key === 'z' && !event.shiftKey) state.undo();
      else if (key === 'y' || (key === 'z' && event.shiftKey)) state.redo();
      else return;
      event.preventDefault();
    });
    addEventListener('pointerdown', (event) => this.closeMenus(event.target));
  }

  // Closes what lies open over the page, but for that which holds `within`.
  closeMenus(within) {
    for (const menu of [byId('more'), byId('look')]) if (!menu.contains(within ?? null)) menu.open = false;
    const isWithin = [byId('reasons'), byId('trust')].some((e) => e.contains(within ?? null));
    if (!isWithin) this.curve.reasons(false);
  }

  sheet(open) {
    const was = document.body.classList.contains('sheet');
    document.body.classList.toggle('sheet', open);
    byId('parameters').setAttribute('aria-expanded', String(open));
    if (open) byId('find').focus();
    else if (was) byId('parameters').focus();
  }

  async share() {
    this.writeAddress();
    try {
      await navigator.clipboard.writeText(location.href);
      say(WORDS.shared);
    } catch {
      say(WORDS.shareByHand);
    }
  }
}

new Page().start();
