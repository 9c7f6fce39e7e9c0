// Measurements of one's own: a table of plateaus, the verdict on it, and its model in the design.

class Measured {
  constructor(state, engine, curve) {
    Object.assign(this, { state, engine, curve });
    byId('table-file').addEventListener('change', (event) => { this.chosen?.(event.target.files); event.target.value = ''; });
    byId('choose-table').addEventListener('click', () => byId('table-file').click());
    byId('take-model').addEventListener('click', () => this.take());
    byId('stop-fit').addEventListener('click', () => this.engine.stop('calibrate'));
    byId('drop-model').addEventListener('click', () => this.state.change({ model: null }));
    this.again = later(() => this.preview(), CALM_MS);
    state.addEventListener('change', () => this.show());
    this.show();
  }

  show() {
    const { model } = this.state.now;
    byId('model-used').hidden = !model;
    byId('model-words').textContent = model ? `${WORDS.modelName(model.name)}. ${WORDS.modelTaken}` : '';
    byId('take-model').hidden = !this.found || model?.toml === this.found.toml;
    // The curve of another design would be none of this one's.
    if (this.curve.calibrated && (!this.found || model || this.curve.calibrated.of !== this.state.now.values)) this.curve.further('calibrated', null);
    if (this.found && !model) this.again();
  }

  // Nothing of the table before stands beside what is said of the next one, and no answer for it comes in between.
  begin() {
    this.engine.stop('calibrate');
    this.found = null;
    byId('model-not').hidden = true;
    this.show();
    this.turn = (this.turn ?? 0) + 1;
    return this.turn;
  }

  async calibrate(csv, file) {
    const turn = this.begin();
    const endTime = tellTime((seconds) => this.tell([WORDS.calibrating(file, seconds)]));
    byId('stop-fit').hidden = false;
    byId('measured').scrollIntoView({ block: 'nearest', behavior: 'smooth' });
    try {
      const answer = await this.engine.ask({ ask: 'calibrate', csv, file }).finally(endTime);
      if (turn !== this.turn) return;
      const digits = (v) => (v < 0.1 ? v.toFixed(4) : v.toFixed(2));
      const errors = answer.before_n === null || answer.after_n === null ? [] : [WORDS.calibrated(digits(answer.before_n), digits(answer.after_n), digits(answer.promise_n ?? answer.after_n))];
      // What no effect explains is no effect; the verdict says so.
      const effects = answer.effects.filter(([id]) => id !== 'unattributed');
      const found = effects.length ? [WORDS.foundEffects(effects)] : [];
      const open = answer.verdict === 'inconclusive' ? [WORDS.notExcluded(answer.not_excluded)] : [];
      this.tell([...found, ...open, ...errors], WORDS.verdictOf(file, WORDS.verdicts[answer.verdict] ?? answer.verdict));
      this.found = answer.model ? { name: file, toml: answer.model } : null;
      this.show();
    } catch (problem) {
      if (turn !== this.turn) return;
      this.tell([problem instanceof Stale ? WORDS.stopped : problem.message], undefined, !(problem instanceof Stale));
    } finally {
      // A table dropped meanwhile is fitted by now.
      if (turn === this.turn) byId('stop-fit').hidden = true;
    }
  }

  // The curve of the design by the model just found, beside the one that is shown.
  async preview() {
    const { found } = this;
    const { values, model } = this.state.now;
    if (!found || model) return;
    let answer;
    try {
      answer = await this.engine.ask({ ask: 'design', values, quality: 'coarse', model: found.toml, aside: true });
    } catch (problem) {
      // An engine that is gone is told where the design itself is asked for.
      if (problem instanceof EngineError || problem instanceof Stale) return;
      throw problem;
    }
    if (found !== this.found || values !== this.state.now.values || this.state.now.model) return;
    const { data, trouble } = answer;
    if (data) this.curve.further('calibrated', { curve: data.curve, of: values });
    byId('model-not').hidden = !trouble;
    byId('model-not').textContent = trouble ? troubleWords(trouble) : '';
  }

  async take() {
    const model = await packModel(this.found.name, this.found.toml);
    // The address holds the whole state: what it cannot hold would be gone with the next visit.
    if (model.packed.length > LONGEST_MODEL) { showNotice(WORDS.modelTooLong(model.name, model.packed.length, LONGEST_MODEL)); return; }
    this.state.change({ model });
  }

  // A model.toml of an earlier calibration.
  async takeModel(toml, file) {
    try {
      const { trouble } = await this.engine.ask({ ask: 'model', toml, file });
      if (trouble) throw new EngineError(troubleWords(trouble), 'refused');
    } catch (problem) {
      if (problem instanceof EngineError) showNotice(WORDS.notOpened(file) + problem.message);
      else if (!(problem instanceof Stale)) throw problem;
      return;
    }
    this.begin();
    byId('stop-fit').hidden = true;
    this.tell([WORDS.opened(file)]);
    this.found = { name: file, toml };
    await this.take();
  }

  tell(lines, head, isError = false) {
    byId('measured-help').hidden = true;
    byId('verdict').replaceChildren(...(head ? [make('b', head)] : []), ...lines.map((line) => make('p', line, { class: isError ? 'error' : undefined })));
  }
}
