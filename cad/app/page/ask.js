// Asks backwards: what the switch shall do; the search; the best designs as cards.

class Ask {
  constructor(state, engine, curve, handles) {
    Object.assign(this, { state, engine, curve, handles });
    const threshold = byId('ask-threshold');
    this.box(threshold, (value) => this.handles.ask({ threshold_n: value }, 'ask.threshold'), () => this.state.now.ask.threshold_n);
    byId('ask-no-threshold').addEventListener('click', () => { this.handles.ask({ threshold_n: null }); threshold.focus(); });
    byId('add-friction').addEventListener('click', () => this.add());
    for (const id of ['search', 'search-here']) byId(id).addEventListener('click', () => this.search());
    byId('found-close').addEventListener('click', () => this.close());
    byId('stop').addEventListener('click', () => this.engine.stop('search'));
    state.addEventListener('change', () => this.show());
    this.show();
  }

  add() {
    const { friction } = this.state.now.ask;
    const load_n = friction.length ? friction.at(-1).load_n / 2 : this.handles.frictions()[0]?.load_n ?? 40;
    const curve = this.curve.data?.curve;
    const friction_n = curve ? at(curve.load_n, curve.friction_n, load_n) : 5;
    // As few digits as can be, and never so few that nothing is asked.
    const short = (value, digits) => Number(value.toFixed(digits)) || Math.max(Number(value.toPrecision(2)), LEAST_ASKED_N);
    this.handles.ask({ friction: [...friction, { load_n: short(load_n, 1), friction_n: short(friction_n, 2) }] });
  }

  // A box of newtons: what cannot be asked is told while it is written, and gone once the box is left.
  box(input, take, now) {
    const tell = (words) => {
      byId('ask-says').hidden = !words;
      byId('ask-says').textContent = words;
      if (words) input.setAttribute('aria-invalid', 'true'); else input.removeAttribute('aria-invalid');
    };
    input.addEventListener('input', () => {
      const [text, value] = [input.value.trim(), Number(input.value)];
      if (text !== '' && isAsked(value)) { tell(''); take(value); return; }
      // An empty box of the threshold asks for none; an empty friction waits for its number.
      if (text === '' && !input.validity.badInput && input.id === 'ask-threshold') { tell(''); take(null); return; }
      tell(WORDS.notAsked(MOST_ASKED_N));
    });
    input.addEventListener('blur', () => {
      if (!input.hasAttribute('aria-invalid')) return;
      tell('');
      input.value = now() ?? '';
    });
  }

  // Shows what is asked; not over the same number as somebody writes it.
  fill(input, value) {
    const written = input.value === '' ? null : Number(input.value);
    if (document.activeElement === input && written === value && !input.validity.badInput) return;
    input.value = value ?? '';
    if (!input.hasAttribute('aria-invalid')) return;
    input.removeAttribute('aria-invalid');
    byId('ask-says').hidden = true;
  }

  show() {
    this.age();
    const { threshold_n, friction } = this.state.now.ask;
    this.fill(byId('ask-threshold'), threshold_n);
    byId('ask-no-threshold').hidden = threshold_n === null;
    byId('add-friction').hidden = friction.length >= MOST_FRICTIONS;
    byId('search-here').hidden = threshold_n === null && !friction.length;
    const rows = byId('ask-frictions');
    while (rows.children.length > friction.length) rows.lastChild.remove();
    while (rows.children.length < friction.length) rows.append(this.row(rows.children.length));
    friction.forEach((f, i) => [...rows.children[i].querySelectorAll('input')].forEach((box, k) => this.fill(box, k ? f.load_n : f.friction_n)));
  }

  row(i) {
    const row = make('div', undefined, { class: 'ask-row' });
    const box = (word, key) => {
      const label = make('label', word);
      const input = make('input', undefined, { type: 'number', min: 0, step: key === 'load_n' ? 0.5 : 0.1, inputmode: 'decimal' });
      this.box(input, (value) => this.handles.setFriction(i, { ...this.state.now.ask.friction[i], [key]: value }), () => this.state.now.ask.friction[i]?.[key]);
      label.append(input, make('span', WORDS.units.n, { class: 'unit' }));
      return label;
    };
    const remove = button('×', () => this.handles.ask({ friction: this.state.now.ask.friction.filter((_, k) => k !== i) }), { class: 'tiny', 'aria-label': WORDS.removeFriction(i + 1) });
    row.append(box(WORDS.askFriction, 'friction_n'), box(WORDS.askLoad, 'load_n'), remove);
    return row;
  }

  async search() {
    const { ask, values, model } = this.state.now;
    const isEmpty = ask.threshold_n === null && !ask.friction.length;
    byId('ask-says').hidden = !isEmpty;
    byId('ask-says').textContent = isEmpty ? WORDS.searchNothing : '';
    if (isEmpty) return;
    byId('found').hidden = false;
    byId('found').scrollIntoView({ block: 'nearest', behavior: 'smooth' });
    byId('search').disabled = byId('search-here').disabled = true;
    byId('stop').hidden = false;
    this.searched = null;
    byId('found').classList.add('old');
    const endTime = tellTime((seconds) => { byId('search-says').textContent = WORDS.searching(seconds); });
    try {
      const answer = await this.engine.ask({ ask: 'search', values, threshold_n: ask.threshold_n, friction: ask.friction, most: 6, model: model?.toml ?? null });
      this.searched = { says: answer.words + (model ? WORDS.searchedWith(model.name) : ''), of: this.question(ask, values, model) };
      byId('likely-means').textContent = WORDS.likelyMeans(answer.within);
      this.found(answer.designs);
    } catch (problem) {
      byId('search-says').textContent = problem instanceof Stale ? WORDS.stopped : problem.message;
    } finally {
      endTime();
      byId('search').disabled = byId('search-here').disabled = false;
      byId('stop').hidden = true;
      this.age();
    }
  }

  // What a search was made for: all but the pins, which it looks for.
  question(ask, { 'layout.pins': _, ...values }, model) { return JSON.stringify([ask, values, model?.packed ?? null]); }

  // Says of cards whether they answer what is asked now.
  age() {
    if (!this.searched || byId('search').disabled) return;
    const { ask, values, model } = this.state.now;
    const isOld = this.searched.of !== this.question(ask, values, model);
    byId('found').classList.toggle('old', isOld);
    byId('search-says').textContent = isOld ? WORDS.searchedBefore : this.searched.says;
  }

  close() {
    this.engine.stop('search');
    this.searched = null;
    this.curve.further('preview', null);
    byId('found').hidden = true;
    byId('search').focus();
  }

  found(designs) {
    this.curve.further('preview', null);
    byId('designs').replaceChildren(...designs.map((design, i) => this.card(design, i)));
  }

  card(design, i) {
    const card = make('li', undefined, { class: 'design' });
    const percent = Math.round(100 * design.probability);
    const head = make('div', undefined, { class: 'design-head' });
    head.append(make('b', WORDS.likely(percent)), this.spark(design.curve));
    const bar = make('div', undefined, { class: 'bar', 'aria-hidden': 'true' });
    bar.append(make('i', undefined, { style: `width: ${percent}%` }));
    // What was asked, and once what was not.
    const answers = make('ul', undefined, { class: 'answers' });
    answers.append(...design.answers.map((answer) => make('li', WORDS.answer(answer), { class: answer.is_met ? undefined : 'missed' })));
    const asksThreshold = design.answers.some((answer) => answer.load_n === null);
    const rest = [...(asksThreshold ? [] : [WORDS.switchesAt(design.threshold_n)]), WORDS.heaviest(design.friction_n)].join(', ');
    const take = button(WORDS.take, () => {
      this.curve.further('preview', null);
      // What the search does not vary stays as it is now.
      const { 'layout.pins': _, ...values } = this.state.now.values;
      const pins = design.values['layout.pins'];
      this.state.change({ values: pins ? { ...values, 'layout.pins': pins } : values });
      say(WORDS.designTaken);
    }, { class: 'btn', 'aria-label': `${WORDS.take}: ${WORDS.designName(i + 1)}` });
    card.append(head, bar, make('p', WORDS.designPins(design.pins)), answers, make('p', rest, { class: 'dim' }), take);
    const preview = (on) => this.curve.further('preview', on ? { name: WORDS.previewCurve(i + 1), curve: design.curve } : null);
    for (const [event, on] of [['pointerenter', true], ['focusin', true], ['pointerleave', false], ['focusout', false]]) card.addEventListener(event, () => preview(on));
    return card;
  }

  spark({ load_n, friction_n }) {
    const [widest, highest] = [load_n.at(-1), Math.max(...friction_n, 1e-9)];
    const drawing = svg('svg', { viewBox: '0 0 64 24', class: 'spark', 'aria-hidden': 'true' });
    const points = load_n.map((x, i) => `${(62 * x / widest + 1).toFixed(1)},${(23 - 21 * friction_n[i] / highest).toFixed(1)}`);
    drawing.append(svg('polyline', { points: points.join(' ') }));
    return drawing;
  }
}
