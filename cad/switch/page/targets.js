// Targets of the design, the search, and the proposed designs as cards.

// Parameters that the search can change, and whether it does at first, as on the command line.
const VARIED = [['pattern', true], ['pitch_deg', true], ['layer_mm', true], ['hardness_shore_a', false], ['pin_diameter_mm', false], ['radius_mm', false], ['wrap_deg', false]];
// Height of the results that is enough to see that there are any.
const LEAST_SEEN_PX = 120;
const signed = (value) => `${value > 0 ? '+' : ''}${value.toFixed(2)} N`;

class Targets {
  constructor(state, engine, curve, handles) {
    Object.assign(this, { state, engine, curve, handles });
    const threshold = byId('target-threshold');
    this.listen(threshold, (value) => this.handles.set({ threshold_n: value }, 'target.threshold'), () => this.state.now.targets.threshold_n);
    byId('remove-threshold').addEventListener('click', () => { this.handles.set({ threshold_n: null }); threshold.focus(); });
    byId('add-friction').addEventListener('click', () => this.add());
    for (const id of ['search', 'search-here']) byId(id).addEventListener('click', (event) => this.search(event));
    byId('results-close').addEventListener('click', () => this.close());
    byId('stop').addEventListener('click', () => this.engine.stop('search'));
    state.addEventListener('change', () => this.show());
    for (const [name, isOn] of VARIED) {
      const label = make('label', undefined, { class: 'check' });
      const box = make('input', undefined, { type: 'checkbox', value: name });
      box.checked = isOn;
      label.append(box, TEXT.varied[name]);
      byId('vary').append(label);
    }
    byId('vary').addEventListener('change', () => { this.hasChosen = true; });
    this.show();
  }

  // With a calibrated model a curve takes so long that the search changes pins only, unless a person chooses more.
  suggest() {
    const { model } = this.state.now;
    if (this.hasChosen) return;
    for (const box of byId('vary').querySelectorAll('input')) box.checked = VARIED.some(([name, isOn]) => name === box.value && isOn && (!model || name === 'pattern'));
  }

  // Parameters that the search may change.
  get vary() { return [...byId('vary').querySelectorAll('input:checked')].map((box) => box.value); }

  add() {
    const { friction } = this.state.now.targets;
    const load_n = friction.length ? friction.at(-1).load_n / 2 : this.handles.frictions()[0]?.load_n ?? 40;
    const curve = this.curve.data?.curve;
    const friction_n = curve ? at(curve.load_n, curve.friction_n, load_n) : 5;
    // Few digits, but never zero.
    const rounded = (value, digits) => Number(value.toFixed(digits)) || Math.max(Number(value.toPrecision(2)), MIN_TARGET_N);
    this.handles.set({ friction: [...friction, { load_n: rounded(load_n, 1), friction_n: rounded(friction_n, 2) }] });
  }

  // An input in newtons. An invalid text is reported while it is typed, and replaced when the input
  // loses the focus.
  listen(input, apply, current) {
    let before = null;
    input.addEventListener('focus', () => { before = this.state.now; });
    const report = (text) => {
      byId('targets-status').hidden = !text;
      byId('targets-status').textContent = text;
      if (text) input.setAttribute('aria-invalid', 'true'); else input.removeAttribute('aria-invalid');
    };
    input.addEventListener('input', () => {
      const { value, problem } = readQuantity(input.value, 'N');
      if (isTarget(value)) { report(''); apply(value); return; }
      // An empty threshold removes the target; an empty friction is incomplete.
      if (input.value.trim() === '' && input.id === 'target-threshold') { report(''); apply(null); return; }
      report(value === undefined && problem !== TEXT.notNumber ? problem : TEXT.invalidTarget(MAX_TARGET_N));
      // Of 1.234,5 the part 1.234 was a target: the one before it was typed comes back.
      if (before && !sameValue(before.targets, this.state.now.targets)) { this.isRestoring = true; this.state.change({ targets: before.targets }); this.isRestoring = false; }
    });
    stepByArrows(input, 0.5, 'N', (value) => { if (isTarget(value)) apply(value); });
    input.addEventListener('keydown', (event) => { if (event.key === 'Enter' && !byId('search').disabled && !input.hasAttribute('aria-invalid')) this.search(); });
    input.addEventListener('blur', () => {
      if (input.hasAttribute('aria-invalid')) {
        report('');
        showToast(TEXT.targetUnchanged(current() ?? null));
      }
      input.value = current() ?? '';
    });
  }

  // Shows a target, unless the focused input has the same number in another form.
  fill(input, value) {
    const typed = input.value.trim() === '' ? null : readQuantity(input.value, 'N').value;
    if (document.activeElement === input && (typed === value || this.isRestoring)) return;
    input.value = value ?? '';
    if (!input.hasAttribute('aria-invalid')) return;
    input.removeAttribute('aria-invalid');
    byId('targets-status').hidden = true;
  }

  show() {
    this.suggest();
    this.markOutdated();
    const { threshold_n, friction } = this.state.now.targets;
    this.fill(byId('target-threshold'), threshold_n);
    byId('remove-threshold').hidden = threshold_n === null;
    byId('add-friction').hidden = friction.length >= MAX_FRICTIONS;
    byId('search-here').hidden = threshold_n === null && !friction.length;
    const rows = byId('target-frictions');
    while (rows.children.length > friction.length) rows.lastChild.remove();
    while (rows.children.length < friction.length) rows.append(this.row(rows.children.length));
    friction.forEach((f, i) => [...rows.children[i].querySelectorAll('input')].forEach((input, k) => this.fill(input, k ? f.load_n : f.friction_n)));
  }

  row(i) {
    const row = make('div', undefined, { class: 'target-row' });
    const labelled = (text, key) => {
      const label = make('label', text);
      const input = make('input', undefined, { type: 'text', class: 'number', inputmode: 'decimal', autocomplete: 'off' });
      this.listen(input, (value) => this.handles.setFriction(i, { ...this.state.now.targets.friction[i], [key]: value }), () => this.state.now.targets.friction[i]?.[key]);
      label.append(input, make('span', TEXT.units.n, { class: 'unit' }));
      return label;
    };
    const remove = button('×', () => this.handles.set({ friction: this.state.now.targets.friction.filter((_, k) => k !== i) }), { class: 'tiny', 'aria-label': TEXT.removeFriction(i + 1), 'data-focus-next': 'add-friction' });
    row.append(labelled(TEXT.targetFriction, 'friction_n'), labelled(TEXT.targetLoad, 'load_n'), remove);
    return row;
  }

  async search(event) {
    const { targets, values, model } = this.state.now;
    const isEmpty = targets.threshold_n === null && !targets.friction.length;
    byId('targets-status').hidden = !isEmpty;
    byId('targets-status').textContent = isEmpty ? TEXT.noTargets : '';
    if (isEmpty) return;
    byId('results').hidden = false;
    // The button itself stays where it is.
    if (event?.currentTarget === byId('search-here')) byId('results').scrollIntoView({ block: 'nearest', behavior: 'smooth' });
    byId('search').disabled = byId('search-here').disabled = true;
    byId('stop').hidden = false;
    this.lastSearch = null;
    byId('results').classList.add('outdated');
    const endReports = reportElapsed((seconds) => { byId('search-status').textContent = TEXT.searching(seconds); });
    try {
      const answer = await this.engine.request({ command: 'search', values, threshold_n: targets.threshold_n, friction: targets.friction, vary: this.vary, most: 6, model: model?.toml ?? null });
      this.lastSearch = { summary: answer.summary + (model ? TEXT.searchModel(model.name) : ''), varied: answer.varied, input: this.searchInput(targets, values, model, answer.varied) };
      this.showBlocked(answer.blocked);
      // Those that print without a review come first; within both groups, the most probable.
      const hasProblems = ({ problems }) => problems.length > 0;
      const designs = [...answer.designs.filter((design) => !hasProblems(design)), ...answer.designs.filter(hasProblems)];
      const printable = designs.filter((design) => !hasProblems(design)).length;
      byId('probability-note').textContent = `${TEXT.probabilityNote(answer.tolerance)} ${TEXT.printable(printable, designs.length)}`;
      this.showDesigns(designs, answer.varied);
      if (byId('results').getBoundingClientRect().top > innerHeight - LEAST_SEEN_PX) byId('results').scrollIntoView({ block: 'nearest', behavior: 'smooth' });
    } catch (problem) {
      byId('search-status').textContent = problem instanceof Superseded ? TEXT.stopped : problem.message;
    } finally {
      endReports();
      byId('search').disabled = byId('search-here').disabled = false;
      byId('stop').hidden = true;
      this.markOutdated();
    }
  }

  // Everything that the result of a search depends on: all but what it varies.
  searchInput(targets, values, model, varied) {
    const rest = Object.entries(values).filter(([path]) => !varied.includes(path));
    return JSON.stringify([targets, rest, model?.packed ?? null]);
  }

  // Marks designs of an earlier design or of earlier targets.
  markOutdated() {
    if (!this.lastSearch || byId('search').disabled) return;
    const { targets, values, model } = this.state.now;
    const isOutdated = this.lastSearch.input !== this.searchInput(targets, values, model, this.lastSearch.varied);
    byId('results').classList.toggle('outdated', isOutdated);
    if (isOutdated && this.curve.proposals.length) this.curve.setExtra('proposals', []);
    byId('search-status').textContent = isOutdated ? TEXT.searchOutdated : this.lastSearch.summary;
  }

  close() {
    this.engine.stop('search');
    this.lastSearch = null;
    this.curve.setExtra('preview', null);
    this.curve.setExtra('proposals', []);
    byId('results').hidden = true;
    byId('search').focus({ preventScroll: true });
  }

  showDesigns(designs, varied) {
    this.curve.setExtra('preview', null);
    this.curve.setExtra('proposals', designs.map((design) => design.curve));
    byId('designs').replaceChildren(...designs.map((design, i) => this.card(design, i, varied)));
  }

  card(design, i, varied) {
    const card = make('li', undefined, { class: 'design' });
    const percent = Math.round(100 * design.probability);
    const head = make('div', undefined, { class: 'design-head' });
    head.append(make('b', TEXT.probability(percent)), this.spark(design.curve));
    const bar = make('div', undefined, { class: 'bar', 'aria-hidden': 'true' });
    bar.append(make('i', undefined, { style: `width: ${percent}%` }));
    // First the targets, then the other properties.
    const targets = make('ul', undefined, { class: 'targets' });
    targets.append(...design.targets.map((target) => make('li', TEXT.targetResult(target), { class: target.is_met ? undefined : 'missed' })));
    const hasThreshold = design.targets.some((target) => target.load_n === null);
    const rest = [...(hasThreshold ? [] : [TEXT.switchesAt(design.threshold_n)]), TEXT.heaviest(design.friction_n)].join(', ');
    const use = button(TEXT.useDesign, () => {
      this.curve.setExtra('preview', null);
      // Everything that the search does not vary stays unchanged.
      const values = { ...this.state.now.values };
      for (const path of varied) { if (path in design.values) values[path] = design.values[path]; else delete values[path]; }
      const before = this.state.now;
      this.state.change({ values });
      if (this.state.now !== before) this.applied?.();
    }, { class: 'btn', 'aria-label': `${TEXT.useDesign}: ${TEXT.designName(i + 1)}` });
    const changes = this.changes(design.values, varied);
    const sources = design.uncertainty.filter((s) => s.share >= 0.01).map((s) => TEXT.sourceShare(s.source, Math.round(100 * s.share)));
    card.append(head, bar, make('p', TEXT.designPins(design.pins)), targets, make('p', rest, { class: 'dim' }));
    if (design.problems.length) card.append(make('p', TEXT.designProblems(design.problems.map(inWords)), { class: 'error' }));
    if (changes.length) card.append(make('p', changes.join(', '), { class: 'dim' }));
    const more = make('details');
    more.append(make('summary', TEXT.details));
    if (sources.length) more.append(make('p', TEXT.uncertain(sources), { class: 'dim' }));
    const gains = design.gains.map((gain) => ({ ...gain, field: this.state.fields.get(gain.field) })).filter((gain) => gain.field);
    if (gains.length) {
      more.append(table(TEXT.gainColumns, gains.map(({ field, threshold_n: threshold, friction_n: friction }) => {
        // A change that a part can have: the slopes hold near the design.
        const by = field.unit === 'mm' ? 0.1 : 1;
        return [`${fieldName(field)} +${by} ${unitName(field)}`.trim(), signed(by * threshold), signed(by * friction)];
      })));
    }
    card.append(more);
    card.append(use);
    const preview = (on) => this.curve.setExtra('preview', on ? { name: TEXT.previewCurve(i + 1), curve: design.curve } : null);
    for (const [event, on] of [['pointerenter', true], ['focusin', true], ['pointerleave', false], ['focusout', false]]) card.addEventListener(event, () => preview(on));
    return card;
  }

  // Varied fields other than the pins in which a proposed design differs from the present one.
  changes(values, varied) {
    const { fields } = this.state;
    const { values: now } = this.state.now;
    const of = (all, path) => all[path] ?? fields.get(path)?.default;
    return varied.filter((path) => path !== 'layout.pins' && !sameValue(of(values, path), of(now, path)))
      .map((path) => TEXT.changedTo(fieldName(fields.get(path)), `${formatValue(of(values, path))} ${unitName(fields.get(path))}`.trim()));
  }

  // Why no design reaches all targets, and what would.
  showBlocked(blocked) {
    const box = byId('blocked');
    box.hidden = !blocked;
    if (!blocked) return;
    const list = make('ul');
    list.append(...blocked.help.map((help) => make('li', inWords(help))));
    box.replaceChildren(make('p', `${inWords(blocked.problem)}.`, { class: 'error' }), list);
  }

  spark({ load_n, friction_n }) {
    const [maxLoad, maxFriction] = [load_n.at(-1), Math.max(...friction_n, 1e-9)];
    const drawing = svg('svg', { viewBox: '0 0 64 24', class: 'spark', 'aria-hidden': 'true' });
    const points = load_n.map((x, i) => `${(62 * x / maxLoad + 1).toFixed(1)},${(23 - 21 * friction_n[i] / maxFriction).toFixed(1)}`);
    drawing.append(svg('polyline', { points: points.join(' ') }));
    return drawing;
  }
}
