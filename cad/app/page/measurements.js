// The user's measurements: a table of plateaus, its verdict, and its model in the design.

class Measurements {
  constructor(state, engine, curve) {
    Object.assign(this, { state, engine, curve });
    byId('table-file').addEventListener('change', (event) => { this.onFiles?.(event.target.files); event.target.value = ''; });
    byId('choose-table').addEventListener('click', () => byId('table-file').click());
    byId('use-model').addEventListener('click', () => this.useModel());
    byId('stop-fit').addEventListener('click', () => this.engine.stop('calibrate'));
    byId('remove-model').addEventListener('click', () => this.state.change({ model: null }));
    this.updatePreview = debounce(() => this.preview(), EXACT_DELAY_MS);
    state.addEventListener('change', () => this.show());
    this.show();
  }

  show() {
    const { model } = this.state.now;
    byId('model-used').hidden = !model;
    byId('model-text').textContent = model ? `${TEXT.modelName(model.name)}. ${TEXT.modelApplied}` : '';
    byId('use-model').hidden = !this.fitted || model?.toml === this.fitted.toml;
    // Not the curve of an earlier design.
    if (this.curve.calibrated && (!this.fitted || model || this.curve.calibrated.values !== this.state.now.values)) this.curve.setExtra('calibrated', null);
    if (this.fitted && !model) this.updatePreview();
  }

  // Removes everything about the last table, and ends its fit.
  begin() {
    this.engine.stop('calibrate');
    this.fitted = null;
    byId('model-error').hidden = true;
    this.show();
    this.fitNumber = (this.fitNumber ?? 0) + 1;
    return this.fitNumber;
  }

  // Shows what a file contains before it is used; a table of plateaus is used at once. `set` are
  // answers to questions about it, as `--set` of `pinswitch import` takes them.
  async open(bytes, file, set = []) {
    const number = this.begin();
    byId('measurements').scrollIntoView({ block: 'nearest', behavior: 'smooth' });
    let answer;
    try {
      answer = await this.engine.request({ ask: 'import', data: base64Of(bytes), file, set });
    } catch (problem) {
      if (number === this.fitNumber && problem instanceof EngineError) this.report([problem.message], undefined, true);
      if (problem instanceof EngineError || problem instanceof Superseded) return;
      throw problem;
    }
    if (number !== this.fitNumber) return;
    const { understood, questions, csv, is_log: isLog } = answer;
    if (!understood) return void this.calibrate(csv, file);
    this.report([], TEXT.understood(file));
    const box = byId('verdict');
    box.append(make('pre', understood, { class: 'understood', tabindex: 0 }));
    for (const { problem, answers } of questions) {
      box.append(make('p', problem, { class: 'error' }));
      const row = make('p', undefined, { class: 'row' });
      for (const { reading, options } of answers) {
        // An option with NAME or a sample value is for a person to complete.
        const isComplete = !options.some((option) => /\bNAME\b/.test(option));
        const choice = isComplete ? make('button', reading, { type: 'button', class: 'btn small' }) : make('span', `${reading}: --set ${options.join(' --set ')}`, { class: 'dim' });
        if (isComplete) choice.addEventListener('click', () => this.open(bytes, file, [...set, ...options]));
        row.append(choice);
      }
      box.append(row);
    }
    if (isLog) box.append(make('p', TEXT.logOf(file)));
    if (!csv) return;
    const use = make('button', TEXT.useTable, { type: 'button', class: 'btn small go', id: 'use-table' });
    use.addEventListener('click', () => this.calibrate(csv, file));
    box.append(use);
  }

  async calibrate(csv, file) {
    const number = this.begin();
    const endReports = reportElapsed((seconds) => this.report([TEXT.calibrating(file, seconds)]));
    byId('stop-fit').hidden = false;
    byId('measurements').scrollIntoView({ block: 'nearest', behavior: 'smooth' });
    try {
      const answer = await this.engine.request({ ask: 'calibrate', csv, file }).finally(endReports);
      if (number !== this.fitNumber) return;
      const digits = (v) => (v < 0.1 ? v.toFixed(4) : v.toFixed(2));
      const errors = answer.before_n === null || answer.after_n === null ? [] : [TEXT.heldOutErrors(digits(answer.before_n), digits(answer.after_n), digits(answer.promise_n ?? answer.after_n))];
      // `unattributed` is not an effect; it is the verdict.
      const effects = answer.effects.filter(([id]) => id !== 'unattributed');
      const detected = effects.length ? [TEXT.detectedEffects(effects)] : [];
      const open = answer.verdict === 'inconclusive' ? [TEXT.notExcluded(answer.not_excluded)] : [];
      const friction = answer.friction ? [`${answer.friction}.`] : [];
      this.report([...friction, ...detected, ...open, ...errors], TEXT.verdictOf(file, TEXT.verdicts[answer.verdict] ?? answer.verdict));
      this.fitted = answer.model ? { name: file, toml: answer.model } : null;
      this.show();
    } catch (problem) {
      if (number !== this.fitNumber) return;
      this.report([problem instanceof Superseded ? TEXT.stopped : problem.message], undefined, !(problem instanceof Superseded));
    } finally {
      // The fit of a later table can still be stopped.
      if (number === this.fitNumber) byId('stop-fit').hidden = true;
    }
  }

  // Shows the curve of the design by the fitted model next to the present one.
  async preview() {
    const { fitted } = this;
    const { values, model } = this.state.now;
    if (!fitted || model) return;
    let answer;
    try {
      answer = await this.engine.request({ ask: 'design', values, quality: 'coarse', model: fitted.toml, extra: true });
    } catch (problem) {
      // The request for the design itself reports a missing engine.
      if (problem instanceof EngineError || problem instanceof Superseded) return;
      throw problem;
    }
    if (fitted !== this.fitted || values !== this.state.now.values || this.state.now.model) return;
    const { data, trouble } = answer;
    if (data) this.curve.setExtra('calibrated', { curve: data.curve, values });
    byId('model-error').hidden = !trouble;
    byId('model-error').textContent = trouble ? troubleText(trouble) : '';
  }

  async useModel() {
    const model = await packModel(this.fitted.name, this.fitted.toml);
    // The address is the whole state: a longer model would be lost with the next visit.
    if (model.packed.length > MAX_MODEL_LENGTH) { showNotice(TEXT.modelTooLong(model.name, model.packed.length, MAX_MODEL_LENGTH)); return; }
    this.state.change({ model });
  }

  // Uses a model.toml of an earlier calibration.
  async openModel(toml, file) {
    try {
      const { trouble } = await this.engine.request({ ask: 'model', toml, file });
      if (trouble) throw new EngineError(troubleText(trouble), 'refused');
    } catch (problem) {
      if (problem instanceof EngineError) showNotice(TEXT.notOpened(file) + problem.message);
      else if (!(problem instanceof Superseded)) throw problem;
      return;
    }
    this.begin();
    byId('stop-fit').hidden = true;
    this.report([TEXT.opened(file)]);
    this.fitted = { name: file, toml };
    await this.useModel();
  }

  report(lines, head, isError = false) {
    byId('measurements-help').hidden = true;
    byId('verdict').replaceChildren(...(head ? [make('b', head)] : []), ...lines.map((line) => make('p', line, { class: isError ? 'error' : undefined })));
  }
}
