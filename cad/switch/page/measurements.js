// The user's measurements: a table of plateaus, its verdict, and its model in the design.

// Longest fit that is kept for the next visit, in characters.
const MAX_KEPT_FIT = 400_000;

class Measurements {
  constructor(state, engine, curve) {
    Object.assign(this, { state, engine, curve });
    byId('table-file').addEventListener('change', (event) => { this.onFiles?.(event.target.files); event.target.value = ''; });
    byId('choose-table').addEventListener('click', () => byId('table-file').click());
    byId('use-model').addEventListener('click', () => this.useModel());
    byId('sample-table').addEventListener('click', async () => {
      const { csv, file } = await this.engine.request({ command: 'sample' });
      this.calibrate(csv, file);
    });
    byId('plan-runs').addEventListener('click', () => this.plan());
    byId('stop-fit').addEventListener('click', () => this.engine.stop('calibrate'));
    byId('remove-model').addEventListener('click', () => this.state.change({ model: null }));
    this.updatePreview = debounce(() => this.preview(), EXACT_DELAY_MS);
    this.restore();
    state.addEventListener('change', () => this.show());
    this.show();
  }

  show() {
    const { model } = this.state.now;
    byId('model-used').hidden = !model;
    byId('model-text').textContent = model ? `${TEXT.modelName(model.name)}. ${TEXT.modelApplied}` : '';
    byId('use-model').hidden = !this.fitted || !this.predicts || model?.toml === this.fitted.toml;
    // Not the curve of an earlier design.
    if (this.curve.calibrated && (!this.fitted || model || this.curve.calibrated.values !== this.state.now.values)) this.curve.setExtra('calibrated', null);
    if (this.fitted && !model) this.updatePreview();
  }

  // Removes everything about the last table, and ends its fit.
  begin() {
    this.engine.stop('calibrate');
    this.fitted = null;
    // Whether the fitted model has a curve of the design, which the preview finds out.
    this.predicts = false;
    // The table, from which the next runs are planned.
    this.table = null;
    byId('next').hidden = true;
    byId('next-plan').replaceChildren();
    this.curve.setMeasured([]);
    byId('fit').hidden = true;
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
      answer = await this.engine.request({ command: 'import', data: base64Of(bytes), file, set });
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
    byId('sample-table').hidden = true;
    const endReports = reportElapsed((seconds) => this.report([TEXT.calibrating(file, seconds)]));
    byId('stop-fit').hidden = false;
    byId('measurements').scrollIntoView({ block: 'nearest', behavior: 'smooth' });
    try {
      const answer = await this.engine.request({ command: 'calibrate', csv, file }).finally(endReports);
      if (number !== this.fitNumber) return;
      const digits = (v) => (v < 0.1 ? v.toFixed(4) : v.toFixed(2));
      const errors = answer.before_n === null || answer.after_n === null ? [] : [TEXT.heldOutErrors(digits(answer.before_n), digits(answer.after_n), digits(answer.promise_n ?? answer.after_n))];
      // `unattributed` is not an effect; it is the verdict.
      const effects = answer.effects.filter(([id]) => id !== 'unattributed');
      const detected = effects.length ? [TEXT.detectedEffects(effects)] : [];
      const open = answer.verdict === 'inconclusive' ? [TEXT.notExcluded(answer.not_excluded)] : [];
      const friction = answer.friction ? [`${answer.friction}.`] : [];
      const { probabilities, sizes, points, residuals } = answer;
      this.table = { csv, file };
      byId('next').hidden = document.body.dataset.state !== 'served';
      this.keep({ file, model: answer.model, head: TEXT.verdictOf(file, TEXT.verdicts[answer.verdict] ?? answer.verdict), lines: [...friction, ...detected, ...open, ...errors], probabilities, sizes, points, residuals });
    } catch (problem) {
      if (number !== this.fitNumber) return;
      this.report([problem instanceof Superseded ? TEXT.stopped : problem.message], undefined, !(problem instanceof Superseded));
    } finally {
      // The fit of a later table can still be stopped.
      if (number === this.fitNumber) byId('stop-fit').hidden = true;
    }
  }

  // Plans the runs that answer most open questions of the last table.
  async plan() {
    const { table } = this;
    const box = byId('next-plan');
    const endReports = reportElapsed((seconds) => box.replaceChildren(make('p', TEXT.planning(seconds))));
    byId('plan-runs').disabled = true;
    try {
      const minutes = Number(byId('next-minutes').value.replace(',', '.'));
      const plan = await this.engine.request({ command: 'experiment', ...table, minutes }).finally(endReports);
      if (table !== this.table) return;
      const questions = make('ul');
      questions.append(...plan.questions.map(([between, p]) => make('li', `${TEXT.question(between)}: ${TEXT.percent(p)}`)));
      const files = make('p', undefined, { class: 'row' });
      files.append(button(TEXT.saveRuns, () => save('next-runs.csv', plan.csv, 'text/csv'), { class: 'btn small' }), button(TEXT.saveSheet, () => save('run-sheet.html', plan.sheet, 'text/html'), { class: 'btn small' }));
      box.replaceChildren(make('p', plan.questions.length ? TEXT.planned(plan.runs, plan.minutes) : TEXT.nothingOpen), questions, files);
    } catch (problem) {
      if (table !== this.table || problem instanceof Superseded) return;
      if (!(problem instanceof EngineError)) throw problem;
      box.replaceChildren(make('p', problem.message, { class: 'error' }));
    } finally {
      byId('plan-runs').disabled = false;
    }
  }

  // Keeps a fit for the next visit, if the browser has room for it, and shows it.
  keep(fit) {
    const text = JSON.stringify(fit);
    remember({ ...remembered(), fit: text.length <= MAX_KEPT_FIT ? fit : undefined });
    this.showFit(fit);
  }

  restore() {
    const { fit } = remembered();
    const isFit = fit && typeof fit.file === 'string' && ['lines', 'probabilities', 'sizes', 'points', 'residuals'].every((name) => Array.isArray(fit[name]));
    if (isFit) this.showFit(fit);
  }

  showFit({ file, model, head, lines, probabilities, sizes, points, residuals }) {
    this.report(lines, head);
    this.fitted = model ? { name: file, toml: model } : null;
    this.predicts = Boolean(model) && this.state.now.model?.toml === model;
    this.curve.setMeasured(points);
    const box = byId('fit');
    box.hidden = false;
    box.replaceChildren();
    if (probabilities.length) box.append(this.bars(probabilities));
    if (sizes.length) box.append(table(TEXT.sizeColumns, sizes.map((s) => [TEXT.effectNames[s.id] ?? s.id, `${s.name} = ${formatNumber(s.value, 4)} ${s.unit}`.trim(), `${formatNumber(s.ci95[0], 4)} … ${formatNumber(s.ci95[1], 4)}`])));
    if (residuals.length) box.append(this.residualPlot(residuals));
    box.append(make('p', TEXT.pointsOf(points.length), { class: 'dim' }));
    this.show();
  }

  // Probabilities of effects as bars.
  bars(probabilities) {
    const list = make('ul', undefined, { class: 'bars', 'aria-label': TEXT.probabilities });
    list.append(...probabilities.map(([id, p]) => {
      const item = make('li');
      const bar = make('div', undefined, { class: 'bar', 'aria-hidden': 'true' });
      bar.append(make('i', undefined, { style: `width: ${(100 * p).toFixed(1)}%` }));
      item.append(make('span', `${TEXT.effectNames[id] ?? id}: ${TEXT.percent(p)}`), bar);
      return item;
    }));
    return list;
  }

  // Residuals over the load: of the published model, and of the calibrated one.
  residualPlot(residuals) {
    const [width, height, pad] = [280, 120, 22];
    const most = Math.max(...residuals.flatMap((r) => [Math.abs(r.before_n), Math.abs(r.after_n)]), 1e-9);
    const heaviest = Math.max(...residuals.map((r) => r.load_n), 1e-9);
    const at = (load, n) => ({ cx: (pad + (width - pad - 4) * load / heaviest).toFixed(1), cy: (height / 2 - (height / 2 - 8) * n / most).toFixed(1) });
    const drawing = svg('svg', { viewBox: `0 0 ${width} ${height}`, class: 'residuals', role: 'img', 'aria-label': TEXT.residualsName(most.toFixed(2)) });
    drawing.append(svg('line', { x1: pad, x2: width, y1: height / 2, y2: height / 2, class: 'zero' }));
    for (const [column, name] of [['before_n', 'before'], ['after_n', 'after']]) drawing.append(...residuals.map((r) => svg('circle', { ...at(r.load_n, r[column]), r: 1.8, class: name })));
    drawing.append(svg('text', { x: 0, y: 12 }, `+${most.toFixed(2)} N`), svg('text', { x: 0, y: height - 4 }, `−${most.toFixed(2)} N`));
    const figure = make('figure');
    figure.append(drawing, make('figcaption', TEXT.residualsCaption, { class: 'dim' }));
    return figure;
  }

  // Shows the curve of the design by the fitted model next to the present one.
  async preview() {
    const { fitted } = this;
    const { values, model } = this.state.now;
    if (!fitted || model) return;
    let answer;
    try {
      answer = await this.engine.request({ command: 'design', values, quality: 'coarse', model: fitted.toml, extra: true });
    } catch (problem) {
      // The request for the design itself reports a missing engine.
      if (problem instanceof EngineError || problem instanceof Superseded) return;
      throw problem;
    }
    if (fitted !== this.fitted || values !== this.state.now.values || this.state.now.model) return;
    const { data, trouble } = answer;
    if (data) this.curve.setExtra('calibrated', { curve: data.curve, values });
    this.predicts = !trouble;
    byId('use-model').hidden = !this.predicts;
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
      const { trouble } = await this.engine.request({ command: 'model', toml, file });
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
    this.predicts = true;
    await this.useModel();
  }

  report(lines, head, isError = false) {
    byId('measurements-help').hidden = true;
    byId('verdict').replaceChildren(...(head ? [make('b', head)] : []), ...lines.map((line) => make('p', line, { class: isError ? 'error' : undefined })));
  }
}
