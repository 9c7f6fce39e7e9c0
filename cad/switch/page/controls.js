// One control per parameter, in sections: slider and number, choice, switch, or text. Errors are
// shown at the control.

// Fields that are shown at first; the others are under "All parameters", found by the search, or shown where they differ.
const BASIC_FIELDS = ['layout.pins', 'layout.wrap_angle_deg', 'segment.grooves', 'silicone.thickness_mm', 'silicone.hardness_shore_a', 'shell.outer_radius_mm', 'pins.diameter_mm', 'tendon.rope_diameter_mm', 'print.bed_mm'];
// Sections that are open at first: those that are changed most.
const OPEN_SECTIONS = ['layout', 'segment', 'shell', 'silicone', 'pins', 'tendon', 'print'];
// Words that people use for those of the fields.
const SYNONYMS = { tendon: 'cable wire rope string', mould: 'mold cast', silicone: 'rubber elastomer', pins: 'rod dowel', fasteners: 'screw bolt nut', print: 'printer filament', shell: 'pulley body', label: 'text engraving', mesh: 'resolution quality', support: 'side plate cheek', friction: 'force load curve', mount: 'bracket holder', process: 'material plastic oven bake' };
// Words for single fields.
const FIELD_SYNONYMS = { 'silicone.hardness_shore_a': 'durometer softness', 'tendon.length_mm': 'spool', 'layout.wrap_angle_deg': 'bend turn', 'print.bed_mm': 'space size volume' };
// Sections whose fields have no effect on a design. Changed fields stay visible.
const NEEDLESS = {
  silicone: (value) => value('layout.substrate') === 'abs', mould: (value) => value('layout.substrate') === 'abs',
  pins: (value) => !value('layout.pins').length, mount: (value) => value('mount.kind') === 'none',
};
const SLIDER_STEPS = 1000;

// The step of a number, by its range.
function stepOf(field) {
  if (field.kind === 'whole') return 1;
  const [low, high] = field.ends ?? [0, 1];
  const span = high - low;
  if (span > 500) return 1;
  if (span > 60) return 0.1;
  if (span > 0.5) return 0.01;
  return 0.001;
}

// Conversion between slider positions and values; if the default is near the lower end, that end
// takes more of the slider.
function sliderScale(field) {
  const [low, high] = field.ends;
  const home = (field.default - low) / (high - low);
  const power = home > 0 && home < 0.2 ? clamp(Math.log(home) / Math.log(0.35), 1, 4) : 1;
  const step = stepOf(field);
  return {
    position: (value) => SLIDER_STEPS * (clamp((value - low) / (high - low), 0, 1) ** (1 / power)),
    value: (position) => {
      const exact = low + (high - low) * (position / SLIDER_STEPS) ** power;
      return clamp(Number((Math.round(exact / step) * step).toFixed(6)), low, high);
    },
  };
}

class Control {
  // `reachOf` returns the least and the largest value of a field for the other values of the design, or null.
  constructor(field, state, reachOf) {
    this.field = field;
    this.state = state;
    this.reachOf = reachOf;
    this.name = fieldName(field);
    this.id = `f-${field.path.replace('.', '-')}`;
    this.element = make('div', undefined, { class: `field ${field.kind}`, id: `${this.id}-field`, role: 'group', 'aria-label': this.name });
    this.label = make('label', this.name, { for: this.id });
    this.error = make('p', undefined, { class: 'error', id: `${this.id}-error` });
    this.error.hidden = true;
    this.about = make('p', TEXT.aboutField(field, `${formatValue(field.default)}${unitName(field) ? ` ${unitName(field)}` : ''}`), { class: 'about', id: `${this.id}-about` });
    this.about.hidden = true;
    this.help = button('?', () => this.explain(), { class: 'tiny', 'aria-expanded': 'false', 'aria-controls': this.about.id, 'aria-label': TEXT.about(this.name), title: TEXT.about(this.name) });
    this.resetButton = button('↺', () => { this.state.reset(field.path); this.input.focus(); }, { class: 'tiny', 'aria-label': TEXT.reset(this.name), title: TEXT.reset(this.name) });
    const row = make('div', undefined, { class: 'line' });
    this.build();
    this.input.dataset.focusTarget = '';
    row.append(this.label, this.resetButton, this.input);
    if (unitName(field) || field.ends) row.append(make('span', unitName(field), { class: 'unit' }));
    row.append(this.help);
    this.element.append(row);
    if (this.slider) this.element.append(this.slider, this.note);
    this.element.append(this.error, this.about);
    this.show();
  }

  build() {
    const { field } = this;
    const attributes = { id: this.id, 'aria-describedby': this.error.id };
    if (field.kind === 'choice') {
      this.input = make('select', undefined, attributes);
      field.choices.forEach((choice) => this.input.append(make('option', choice.replaceAll('-', ' '), { value: choice })));
      this.input.addEventListener('change', () => this.apply(this.input.value));
    } else if (field.kind === 'flag') {
      this.input = make('input', undefined, { ...attributes, type: 'checkbox', role: 'switch' });
      this.input.addEventListener('change', () => this.apply(this.input.checked));
    } else if (field.kind === 'number' || field.kind === 'whole') {
      this.input = make('input', undefined, { ...attributes, type: 'text', class: 'number', inputmode: 'decimal', autocomplete: 'off', spellcheck: 'false' });
      this.input.addEventListener('input', () => this.parse());
      stepByArrows(this.input, stepOf(field), field.unit, (value) => this.apply(value));
      if (field.ends) this.addSlider();
    } else {
      this.input = make('input', undefined, { ...attributes, type: 'text', maxlength: 200, spellcheck: 'false', autocomplete: 'off' });
      this.input.addEventListener('change', () => this.parse());
    }
    this.input.addEventListener('focus', () => { this.atFocus = this.state.value(field.path); });
    // Text that is not a value is replaced by the value of the design when the control loses the
    // focus.
    this.input.addEventListener('blur', () => {
      if (!this.hasInvalidText) { if (this.isNumber()) this.show(); return; }
      this.show();
      showToast(TEXT.unchanged(this.name, formatValue(this.state.value(this.field.path))));
    });
  }

  addSlider() {
    const scale = sliderScale(this.field);
    this.scale = scale;
    this.slider = make('input', undefined, { type: 'range', min: 0, max: SLIDER_STEPS, step: 'any', 'aria-label': TEXT.slider(this.name), tabindex: -1 });
    // Without a tab stop: the number input has the arrow keys, and ninety parameters would have
    // twice as many stops.
    listenToSlider(this.slider, () => this.slide(scale.value(Number(this.slider.value))), () => {
      const before = this.state.value(this.field.path);
      return () => { this.sliding = null; this.apply(before); this.show(); };
    });
    this.note = make('p', undefined, { class: 'about', role: 'status' });
    this.note.hidden = true;
    this.slider.addEventListener('blur', () => { this.note.hidden = true; });
  }

  // Applies a value of the slider within its reach, where no rule breaks while the other values stay. A typed value may go
  // beyond it, and is then offered changes of others.
  async slide(value) {
    this.sliding = value;
    const { [this.field.path]: _, ...others } = this.state.now.values;
    if (!sameValue(this.others, others)) {
      this.others = others;
      this.reach = this.reachOf(this.field.path);
    }
    const ends = await this.reach;
    // A later position of the slider counts.
    if (this.sliding !== value) return;
    const { [this.field.path]: _own, ...present } = this.state.now.values;
    if (!sameValue(this.others, present)) { await this.slide(value); return; }
    const [step, own] = [stepOf(this.field), this.state.value(this.field.path)];
    const inward = (end, round) => Number((round(end / step) * step).toFixed(6));
    const [low, high] = ends ? [Math.min(own, inward(ends[0] - 1e-9, Math.ceil)), Math.max(own, inward(ends[1] + 1e-9, Math.floor))] : this.field.ends;
    this.note.textContent = TEXT.reach(`${formatNumber(low)}`, `${formatNumber(high)} ${unitName(this.field)}`.trim());
    this.note.hidden = value >= low && value <= high;
    this.apply(clamp(value, low, high));
    // The slider goes back to the value.
    this.show();
  }

  isNumber() { return this.field.kind === 'number' || this.field.kind === 'whole'; }

  parse() {
    const { kind } = this.field;
    const text = this.input.value.trim();
    if (kind === 'text') { this.apply(this.input.value); return; }
    if (kind === 'list') {
      const items = wholeNumbers(text.replace(/^\[|\]$/g, '').split(/[\s,;]+/).filter(Boolean));
      if (items) this.apply([...new Set(items)].sort((a, b) => a - b)); else this.rejectText(TEXT.notList);
      return;
    }
    const { value, problem } = readQuantity(text, this.field.unit);
    if (problem) this.rejectText(problem);
    else if (kind === 'whole' && !Number.isInteger(value)) this.rejectText(TEXT.notWhole);
    else this.apply(value);
  }

  apply(value) {
    this.showError('');
    this.hasInvalidText = false;
    this.state.set(this.field.path, value);
  }

  // Reports text that is not a value; the state does not have it.
  rejectText(problem) {
    // Of 2,5,5 the part 2,5 was a value: the state goes back to the one before it was typed.
    const { path } = this.field;
    if (this.atFocus !== undefined && !sameValue(this.atFocus, this.state.value(path))) {
      this.isRestoring = true;
      this.state.set(path, this.atFocus);
      this.isRestoring = false;
    }
    this.showError(problem);
    // An answer about an earlier value does not remove this message.
    this.isRefused = false;
    this.hasInvalidText = true;
  }

  // Shows the value of the state, unless the focused input has the same number in another form.
  show() {
    if (this.hasInvalidText && !this.isRestoring) { this.hasInvalidText = false; this.showError(''); }
    const value = this.state.value(this.field.path);
    const changed = this.state.isChanged(this.field.path);
    this.element.classList.toggle('changed', changed);
    this.resetButton.hidden = !changed;
    // The text that is being typed stays.
    if (!this.isRestoring) this.showValue(value);
    if (this.slider) {
      this.slider.value = this.scale.position(value);
      this.slider.style.setProperty('--at', `${this.scale.position(value) / 10}%`);
      this.slider.setAttribute('aria-valuetext', `${formatNumber(value)} ${unitName(this.field)}`.trim());
    }
  }

  showValue(value) {
    if (this.field.kind === 'flag') this.input.checked = value;
    else if (this.field.kind === 'list') this.input.value = value.join(', ');
    else if (document.activeElement !== this.input || readQuantity(this.input.value, this.field.unit).value !== value) this.input.value = formatNumber(value, 6);
  }

  explain(open = this.about.hidden) {
    this.about.hidden = !open;
    this.help.setAttribute('aria-expanded', String(open));
  }

  hasError() { return !this.error.hidden; }

  // Shows an error at the control, with buttons that fix it.
  showError(text, fixes = []) {
    this.error.replaceChildren(text);
    for (const fix of fixes) this.error.append(' ', fix);
    this.error.hidden = !text;
    this.element.classList.toggle('wrong', Boolean(text));
    if (text) this.input.setAttribute('aria-invalid', 'true'); else this.input.removeAttribute('aria-invalid');
  }
}

class Controls {
  constructor(host, facts, state, engine) {
    this.state = state;
    this.templates = facts.templates;
    // Without an answer the slider has the range of its field.
    this.reachOf = (field) => engine.request({ command: 'reach', values: state.now.values, field }).then((answer) => answer.ends, () => null);
    this.controls = new Map();
    this.sections = [];
    const names = [...new Set(facts.fields.map((f) => f.section))];
    for (const name of names) host.append(this.section(name, facts.fields.filter((f) => f.section === name)));
    this.none = make('p', TEXT.noField, { class: 'dim' });
    this.none.hidden = true;
    host.append(this.none);
    byId('find').addEventListener('input', () => this.filter());
    byId('only-changed').addEventListener('change', () => this.filter());
    byId('all-parameters').checked = Boolean(remembered().showsAll);
    byId('all-parameters').addEventListener('change', () => { remember({ ...remembered(), showsAll: byId('all-parameters').checked }); this.filter(); });
    state.addEventListener('change', () => this.show());
    this.show();
    this.filter();
  }

  section(name, fields) {
    const element = make('details', undefined, { class: 'group' });
    element.open = OPEN_SECTIONS.includes(name);
    const count = make('span', '', { class: 'count' });
    const head = make('summary');
    head.append(make('h3', TEXT.groups[name] ?? name.replaceAll('_', ' ')), count);
    element.append(head);
    for (const field of fields) {
      const control = new Control(field, this.state, this.reachOf);
      this.controls.set(field.path, control);
      element.append(control.element);
    }
    this.sections.push({ element, count, fields, wasOpen: null });
    return element;
  }

  show() {
    for (const control of this.controls.values()) control.show();
    for (const { count, fields } of this.sections) {
      // Values of the open template do not count.
      const { values } = this.state.now;
      const template = this.templates.find((t) => t.name === values['switch.name']);
      const changed = fields.filter((f) => !sameValue(this.state.value(f.path), template?.values[f.path] ?? f.default)).length;
      count.textContent = changed ? TEXT.groupChanged(changed) : '';
    }
    this.filter();
  }

  // Whether the design does not depend on a field; the field that switches its section on does not count.
  isNeedless({ section, path }) { return path !== 'mount.kind' && Boolean(NEEDLESS[section]?.((other) => this.state.value(other))); }

  filter() {
    const words = byId('find').value.toLowerCase().split(/\s+/).filter(Boolean);
    const only = byId('only-changed').checked;
    const narrow = words.length > 0 || only;
    const isBasic = !narrow && !byId('all-parameters').checked;
    let matches = 0;
    for (const section of this.sections) {
      let any = false;
      for (const field of section.fields) {
        const text = `${field.path} ${fieldName(field)} ${TEXT.groups[field.section] ?? ''} ${SYNONYMS[field.section] ?? ''} ${FIELD_SYNONYMS[field.path] ?? ''} ${field.reason}`.toLowerCase();
        const control = this.controls.get(field.path);
        // Errors are shown, whatever the filter.
        const fits = control.hasError() || (words.every((w) => text.includes(w)) && (!only || this.state.isChanged(field.path)) && (!this.isNeedless(field) || this.state.isChanged(field.path)) && (!isBasic || BASIC_FIELDS.includes(field.path) || this.state.isChanged(field.path) || control.element.contains(document.activeElement)));
        control.element.hidden = !fits;
        any ||= fits;
        matches += fits;
      }
      section.element.hidden = !any;
      if (narrow && section.wasOpen === null) section.wasOpen = section.element.open;
      if (narrow) section.element.open = any;
      else if (section.wasOpen !== null) { section.element.open = section.wasOpen; section.wasOpen = null; }
    }
    this.none.hidden = matches > 0;
  }

  idOf(path) { return this.controls.get(path)?.id; }

  // Shows why a design is refused at the control of its field, and removes the message elsewhere.
  showTrouble(trouble, fixes) {
    const before = [...this.controls.values()].filter((c) => c.isRefused);
    for (const control of before) { control.showError(''); control.isRefused = false; }
    const control = trouble && this.controls.get(trouble.field);
    if (control && !control.hasInvalidText) {
      control.showError(`${troubleText(trouble, control.name)}.`, fixes);
      control.isRefused = true;
    }
    if (control || before.length) this.filter();
    if (control) control.element.closest('details').open = true;
  }
}
