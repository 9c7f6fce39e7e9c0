// One control per parameter, in sections: slider and number, choice, switch, text. An error stands at its control.

// Sections that are open at first: what most change.
const OPEN_SECTIONS = ['layout', 'segment', 'silicone', 'pins'];
const SLIDER_STEPS = 1000;

// Steps of a number: fine enough for what it measures.
function stepOf(field) {
  if (field.kind === 'whole') return 1;
  const [low, high] = field.ends ?? [0, 1];
  const span = high - low;
  if (span > 500) return 1;
  if (span > 60) return 0.1;
  if (span > 0.5) return 0.01;
  return 0.001;
}

// Where a slider stands for a value and back; wide ranges get more room where the default is.
function sliderScale(field) {
  const [low, high] = field.ends;
  const home = (field.default - low) / (high - low);
  const power = home > 0 && home < 0.2 ? clamp(Math.log(home) / Math.log(0.35), 1, 4) : 1;
  const step = stepOf(field);
  return {
    place: (value) => SLIDER_STEPS * (clamp((value - low) / (high - low), 0, 1) ** (1 / power)),
    value: (place) => {
      const exact = low + (high - low) * (place / SLIDER_STEPS) ** power;
      return clamp(Number((Math.round(exact / step) * step).toFixed(6)), low, high);
    },
  };
}

class Control {
  constructor(field, state) {
    this.field = field;
    this.state = state;
    this.name = fieldName(field);
    this.id = `f-${field.path.replace('.', '-')}`;
    this.element = make('div', undefined, { class: `field ${field.kind}`, id: `${this.id}-field`, role: 'group', 'aria-label': this.name });
    this.label = make('label', this.name, { for: this.id });
    this.error = make('p', undefined, { class: 'error', id: `${this.id}-error` });
    this.error.hidden = true;
    this.about = make('p', WORDS.aboutField(field, `${shownValue(field.default)}${unitName(field) ? ` ${unitName(field)}` : ''}`), { class: 'about', id: `${this.id}-about` });
    this.about.hidden = true;
    this.asks = button('?', () => this.explain(), { class: 'tiny', 'aria-expanded': 'false', 'aria-controls': this.about.id, 'aria-label': WORDS.about(this.name), title: WORDS.about(this.name) });
    this.back = button('↺', () => { this.state.reset(field.path); this.input.focus(); }, { class: 'tiny', 'aria-label': WORDS.reset(this.name), title: WORDS.reset(this.name) });
    const row = make('div', undefined, { class: 'line' });
    this.build();
    this.input.dataset.home = '';
    row.append(this.label, this.back, this.input);
    if (unitName(field) || field.ends) row.append(make('span', unitName(field), { class: 'unit' }));
    row.append(this.asks);
    this.element.append(row);
    if (this.slider) this.element.append(this.slider);
    this.element.append(this.error, this.about);
    this.show();
  }

  build() {
    const { field } = this;
    const own = { id: this.id, 'aria-describedby': this.error.id };
    if (field.kind === 'choice') {
      this.input = make('select', undefined, own);
      field.choices.forEach((choice) => this.input.append(make('option', choice.replaceAll('-', ' '), { value: choice })));
      this.input.addEventListener('change', () => this.take(this.input.value));
    } else if (field.kind === 'flag') {
      this.input = make('input', undefined, { ...own, type: 'checkbox', role: 'switch' });
      this.input.addEventListener('change', () => this.take(this.input.checked));
    } else if (field.kind === 'number' || field.kind === 'whole') {
      this.input = make('input', undefined, { ...own, type: 'number', step: stepOf(field), inputmode: field.kind === 'whole' ? 'numeric' : 'decimal' });
      this.input.addEventListener('input', () => this.typed());
      if (field.ends) this.addSlider();
    } else {
      this.input = make('input', undefined, { ...own, type: 'text', maxlength: 200, spellcheck: 'false', autocomplete: 'off' });
      this.input.addEventListener('change', () => this.typed());
    }
    // What is no value is gone once the box is left: the design has the former.
    this.input.addEventListener('blur', () => {
      if (!this.isOwn) return;
      this.show();
      say(WORDS.stays(this.name, shownValue(this.state.value(this.field.path))));
    });
  }

  addSlider() {
    const scale = sliderScale(this.field);
    this.scale = scale;
    this.slider = make('input', undefined, { type: 'range', min: 0, max: SLIDER_STEPS, step: 'any', 'aria-label': WORDS.slider(this.name), tabindex: -1 });
    // The number box takes the arrow keys; a second stop for each of ninety parameters would be a long way.
    this.slider.addEventListener('input', () => this.take(scale.value(Number(this.slider.value))));
  }

  typed() {
    const { kind } = this.field;
    const text = this.input.value.trim();
    if (kind === 'text') { this.take(this.input.value); return; }
    if (kind === 'list') {
      const items = wholeNumbers(text.replace(/^\[|\]$/g, '').split(/[\s,;]+/).filter(Boolean));
      if (items) this.take([...new Set(items)].sort((a, b) => a - b)); else this.complainOfText(WORDS.notList);
      return;
    }
    const value = Number(text);
    if (text === '' || !Number.isFinite(value)) this.complainOfText(WORDS.notNumber);
    else if (kind === 'whole' && !Number.isInteger(value)) this.complainOfText(WORDS.notWhole);
    else this.take(value);
  }

  take(value) {
    this.complain('');
    this.isOwn = false;
    this.state.set(this.field.path, value);
  }

  // Of what is written in the box and is no value, so that the state does not have it.
  complainOfText(words) {
    this.complain(words);
    this.isOwn = true;
  }

  // Shows what the state holds; not over what somebody is just writing.
  show() {
    if (this.isOwn) { this.isOwn = false; this.complain(''); }
    const value = this.state.value(this.field.path);
    const changed = this.state.isChanged(this.field.path);
    this.element.classList.toggle('changed', changed);
    this.back.hidden = !changed;
    if (this.field.kind === 'flag') this.input.checked = value;
    else if (this.field.kind === 'list') this.input.value = value.join(', ');
    else if (document.activeElement !== this.input || Number(this.input.value) !== value) this.input.value = plain(value, 6);
    if (this.slider) {
      this.slider.value = this.scale.place(value);
      this.slider.style.setProperty('--at', `${this.scale.place(value) / 10}%`);
      this.slider.setAttribute('aria-valuetext', `${plain(value)} ${unitName(this.field)}`.trim());
    }
  }

  explain(open = this.about.hidden) {
    this.about.hidden = !open;
    this.asks.setAttribute('aria-expanded', String(open));
  }

  isWrong() { return !this.error.hidden; }

  // Says at the control what is wrong, with a button that mends it.
  complain(text, mend) {
    this.error.replaceChildren(text);
    if (mend) this.error.append(' ', mend);
    this.error.hidden = !text;
    this.element.classList.toggle('wrong', Boolean(text));
    if (text) this.input.setAttribute('aria-invalid', 'true'); else this.input.removeAttribute('aria-invalid');
  }
}

class Controls {
  constructor(host, facts, state) {
    this.state = state;
    this.controls = new Map();
    this.sections = [];
    const names = [...new Set(facts.fields.map((f) => f.section))];
    for (const name of names) host.append(this.section(name, facts.fields.filter((f) => f.section === name)));
    this.none = make('p', WORDS.noField, { class: 'dim' });
    this.none.hidden = true;
    host.append(this.none);
    byId('find').addEventListener('input', () => this.filter());
    byId('only-changed').addEventListener('change', () => this.filter());
    state.addEventListener('change', () => this.show());
    this.show();
  }

  section(name, fields) {
    const element = make('details', undefined, { class: 'group' });
    element.open = OPEN_SECTIONS.includes(name);
    const count = make('span', '', { class: 'count' });
    const head = make('summary');
    head.append(make('h3', WORDS.groups[name] ?? name.replaceAll('_', ' ')), count);
    element.append(head);
    for (const field of fields) {
      const control = new Control(field, this.state);
      this.controls.set(field.path, control);
      element.append(control.element);
    }
    this.sections.push({ element, count, fields, wasOpen: null });
    return element;
  }

  show() {
    for (const control of this.controls.values()) control.show();
    for (const { count, fields } of this.sections) {
      const changed = fields.filter((f) => this.state.isChanged(f.path)).length;
      count.textContent = changed ? WORDS.groupChanged(changed) : '';
    }
    if (byId('only-changed').checked) this.filter();
  }

  filter() {
    const words = byId('find').value.toLowerCase().split(/\s+/).filter(Boolean);
    const only = byId('only-changed').checked;
    const narrow = words.length > 0 || only;
    let found = 0;
    for (const section of this.sections) {
      let any = false;
      for (const field of section.fields) {
        const text = `${field.path} ${fieldName(field)} ${WORDS.groups[field.section] ?? ''} ${field.reason}`.toLowerCase();
        const control = this.controls.get(field.path);
        // What is wrong is shown, whatever is looked for.
        const fits = control.isWrong() || (words.every((w) => text.includes(w)) && (!only || this.state.isChanged(field.path)));
        control.element.hidden = !fits;
        any ||= fits;
        found += fits;
      }
      section.element.hidden = !any;
      if (narrow && section.wasOpen === null) section.wasOpen = section.element.open;
      if (narrow) section.element.open = any;
      else if (section.wasOpen !== null) { section.element.open = section.wasOpen; section.wasOpen = null; }
    }
    this.none.hidden = found > 0;
  }

  idOf(path) { return this.controls.get(path)?.id; }

  // Shows trouble at its control, and nowhere else.
  trouble(trouble, mend) {
    const before = [...this.controls.values()].filter((c) => c.told);
    for (const control of before) { control.complain(''); control.told = false; }
    const control = trouble && this.controls.get(trouble.field);
    if (control) {
      control.complain(`${troubleWords(trouble, control.name)}.`, mend);
      control.told = true;
    }
    if (control || before.length) this.filter();
    if (control) control.element.closest('details').open = true;
  }
}
