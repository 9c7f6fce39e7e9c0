// The user's measurements: a table of plateaus, its verdict, and its model in the design.

// Longest fit that is kept for the next visit, in characters.
const MAX_KEPT_FIT = 400_000;

class Measurements {
  constructor(state, engine, curve) {
    Object.assign(this, { state, engine, curve });
    // A model that was opened as a file, without a table.
    this.opened = null;
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
    byId('remove-fit').addEventListener('click', () => this.state.change({ fit: null }));
    byId('save-model').addEventListener('click', () => { save('model.toml', this.fitted.toml, 'application/toml'); showToast(TEXT.saved('model.toml')); });
    this.updatePreview = debounce(() => this.preview(), EXACT_DELAY_MS);
    state.addEventListener('change', () => this.show());
    this.show();
  }

  // The last fitted or opened model, which a design can use.
  get fitted() {
    const { fit } = this.state.now;
    return fit?.model ? { name: fit.file, toml: fit.model } : this.opened;
  }

  show() {
    const { model, fit } = this.state.now;
    if (fit !== this.shown) {
      this.shown = fit;
      this.showFit(fit);
      this.keep(fit);
    }
    byId('model-used').hidden = !model;
    byId('model-text').textContent = model ? `${TEXT.modelName(model.name)}. ${TEXT.modelApplied}` : '';
    byId('use-model').hidden = !this.fitted || !this.predicts || model?.toml === this.fitted.toml;
    byId('use-model').textContent = model && this.fitted ? TEXT.useOtherModel(this.fitted.name) : TEXT.useModel;
    byId('save-model').hidden = !this.fitted;
    byId('remove-fit').hidden = !fit;
    byId('sample-table').hidden = Boolean(fit);
    // Not the curve of an earlier design.
    const { calibrated } = this.curve;
    if (calibrated && (!this.fitted || model?.toml === this.fitted.toml || calibrated.values !== this.state.now.values)) this.curve.setExtra('calibrated', null);
    if (this.fitted && model?.toml !== this.fitted.toml) this.updatePreview();
  }

  // Ends work on an earlier table; its fit stays until another one replaces it.
  begin() {
    this.engine.stop('calibrate');
    this.engine.stop('experiment');
    byId('stop-fit').hidden = true;
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
    const { understood, columns, questions, csv, is_log: isLog } = answer;
    if (!understood) return void this.calibrate(csv, file);
    this.report([], TEXT.understood(file));
    const box = byId('verdict');
    box.append(make('pre', understood, { class: 'understood', tabindex: 0 }));
    for (const { problem, answers } of questions) {
      box.append(make('p', problem, { class: 'error' }));
      const row = make('p', undefined, { class: 'row' });
      for (const { reading, options } of answers) {
        // An option with NAME is for one of the columns.
        const needsColumn = options.some((option) => /\bNAME\b/.test(option));
        const column = make('select', undefined, { 'aria-label': reading });
        column.append(...columns.map((name) => make('option', name)));
        const answer = () => this.open(bytes, file, [...set, ...options.map((option) => option.replace(/\bNAME\b/, () => column.value))]);
        row.append(button(reading, answer, { class: 'btn small' }), ...(needsColumn ? [column] : []));
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
      const answer = await this.engine.request({ command: 'calibrate', csv, file }).finally(endReports);
      if (number !== this.fitNumber) return;
      const digits = (v) => (v < 0.1 ? v.toFixed(4) : v.toFixed(2));
      const { before_n: before, least_squares_n: plain, after_n: after, promise_n: expected } = answer;
      const errors = before === null || after === null ? [] : [TEXT.heldOutErrors(digits(before), plain === null ? null : digits(plain), digits(after), expected === null ? null : digits(expected))];
      // `unattributed` is not an effect; it is the verdict.
      const effects = answer.effects.filter(([id]) => id !== 'unattributed');
      const detected = effects.length ? [TEXT.detectedEffects(effects)] : [];
      const open = answer.verdict === 'inconclusive' && answer.not_excluded.length ? [TEXT.notExcluded(answer.not_excluded)] : [];
      const friction = answer.friction ? [`${answer.friction}.`] : [];
      const { probabilities, sizes, points, residuals } = answer;
      const fit = { file, csv, model: answer.model, head: TEXT.verdictOf(file, TEXT.verdicts[answer.verdict] ?? answer.verdict), lines: [...friction, ...detected, ...open, ...errors], probabilities, sizes, points, residuals };
      this.opened = null;
      this.state.change({ fit });
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
    const { fit } = this.state.now;
    const box = byId('next-plan');
    const { value: minutes, problem: wrong } = readQuantity(byId('next-minutes').value, 'min');
    if (wrong) { box.replaceChildren(make('p', wrong, { class: 'error' })); return; }
    // The button stays enabled, so that it keeps the focus.
    if (this.isPlanning) return;
    this.isPlanning = true;
    const endReports = reportElapsed((seconds) => box.replaceChildren(make('p', TEXT.planning(seconds))));
    try {
      const plan = await this.engine.request({ command: 'experiment', csv: fit.csv, file: fit.file, minutes }).finally(endReports);
      if (fit !== this.state.now.fit) return;
      const questions = make('ul');
      questions.append(...plan.questions.map(([between, p]) => make('li', `${TEXT.question(between)}: ${TEXT.percent(p)}`)));
      const files = make('p', undefined, { class: 'row' });
      files.append(button(TEXT.saveRuns, () => save('next-runs.csv', plan.csv, 'text/csv'), { class: 'btn small' }), button(TEXT.saveSheet, () => save('run-sheet.html', plan.sheet, 'text/html'), { class: 'btn small' }));
      const [head, ...rows] = plan.csv.trim().split('\n').map((line) => line.split(','));
      const runs = make('div', undefined, { class: 'scroll', tabindex: 0, role: 'group', 'aria-label': TEXT.planRuns });
      if (rows.length) runs.append(table(head.map((name) => name.replaceAll('_', ' ')), rows));
      box.replaceChildren(make('p', plan.questions.length ? TEXT.planned(plan.runs, plan.minutes) : TEXT.nothingOpen), questions, runs, files);
    } catch (problem) {
      if (fit !== this.state.now.fit) return;
      if (problem instanceof Superseded) { box.replaceChildren(make('p', TEXT.stopped)); return; }
      if (!(problem instanceof EngineError)) throw problem;
      box.replaceChildren(make('p', problem.message, { class: 'error' }));
    } finally {
      this.isPlanning = false;
    }
  }

  // Keeps a fit for the next visit, or reports that it is lost then.
  keep(fit) {
    if (sameValue(remembered().fit ?? null, fit)) return;
    const isShort = JSON.stringify(fit).length <= MAX_KEPT_FIT;
    const isKept = remember({ ...remembered(), fit: isShort ? fit ?? undefined : undefined });
    if (fit && !(isShort && isKept)) showToast(TEXT.notKept);
  }

  showFit(fit) {
    byId('next-plan').replaceChildren();
    byId('next').hidden = !fit?.csv;
    byId('fit').hidden = !fit;
    byId('model-error').hidden = true;
    // Whether the fitted model has a curve of the design, which the preview finds out.
    this.predicts = Boolean(fit?.model) && this.state.now.model?.toml === fit.model;
    this.curve.setMeasured(fit?.points ?? []);
    this.report([]);
    if (!fit) return;
    const { probabilities, sizes, points, residuals } = fit;
    const box = byId('fit');
    box.replaceChildren();
    if (probabilities.length) box.append(this.bars(probabilities));
    if (sizes.length) box.append(table(TEXT.sizeColumns, sizes.map((s) => [TEXT.effectNames[s.id] ?? s.id, `${s.name} = ${formatNumber(s.value, 4)} ${s.unit}`.trim(), s.ci95.map((end, i) => (end === null ? ['−∞', '∞'][i] : formatNumber(end, 4))).join(' … ')])));
    if (residuals.length) box.append(this.residualPlot(residuals));
    this.pointsLine = make('p', undefined, { class: 'dim' });
    box.append(this.pointsLine);
    this.countPoints();
  }

  // Shows how many of the points are on the curve of the shown design.
  countPoints() {
    const { fit } = this.state.now;
    if (fit) this.pointsLine.textContent = TEXT.pointsOf(fit.points.length, this.curve.ownPoints.length);
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
    if (!fitted || model?.toml === fitted.toml) return;
    let answer;
    try {
      answer = await this.engine.request({ command: 'design', values, quality: 'coarse', model: fitted.toml, extra: true });
    } catch (problem) {
      // The request for the design itself reports a missing engine.
      if (problem instanceof EngineError || problem instanceof Superseded) return;
      throw problem;
    }
    if (fitted.toml !== this.fitted?.toml || values !== this.state.now.values || this.state.now.model?.toml === fitted.toml) return;
    const { data, trouble } = answer;
    if (data) this.curve.setExtra('calibrated', { curve: data.curve, values });
    this.predicts = !trouble;
    byId('use-model').hidden = !this.predicts;
    byId('model-error').hidden = !trouble;
    byId('model-error').textContent = trouble ? troubleText(trouble) : '';
  }

  async useModel() {
    const model = await this.packed(this.fitted);
    if (!model) return;
    const before = this.state.now;
    this.state.change({ model });
    if (this.state.now !== before) this.applied?.();
  }

  // A model for the address, or null.
  async packed({ name, toml }) {
    const model = await packModel(name, toml);
    // The address is the design: a longer model would be lost with the next visit.
    if (model.packed.length <= MAX_MODEL_LENGTH) return model;
    showNotice(TEXT.modelTooLong(model.name, model.packed.length, MAX_MODEL_LENGTH));
    return null;
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
    this.opened = { name: file, toml };
    this.predicts = true;
    const model = await this.packed(this.opened);
    if (!model) return;
    this.state.change({ model, fit: null });
    this.report([TEXT.opened(file)]);
  }

  report(lines, head, isError = false) {
    const { fit } = this.state.now;
    byId('measurements-help').hidden = Boolean(head || lines.length || fit);
    // The last fit stays, below a message about another file.
    const earlier = fit && !head ? [make('b', fit.head), ...fit.lines.map((line) => make('p', line))] : [];
    byId('verdict').replaceChildren(...(head ? [make('b', head)] : []), ...lines.map((line) => make('p', line, { class: isError ? 'error' : undefined })), ...earlier);
  }
}
