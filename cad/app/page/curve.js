// Friction over load: the curve with its band, rival laws, what was measured, a kept curve; the load that is shown.

const LOAD = 0, MAIN = 1, LOW = 2, HIGH = 3, RIVAL = 4, KEPT = RIVAL + OTHERS, PREVIEW = KEPT + 1, CALIBRATED = KEPT + 2, MEASURED = KEPT + 3;

// Lines differ in dashes as well as in colour.
const LINES = {
  [MAIN]: { colour: '--blue', width: 3 }, [RIVAL]: { colour: '--green', width: 1.3, dash: [7, 4] }, [RIVAL + 1]: { colour: '--violet', width: 1.3, dash: [2, 3] },
  [RIVAL + 2]: { colour: '--red', width: 1.3, dash: [9, 3, 2, 3] }, [KEPT]: { colour: '--dim', width: 2, dash: [5, 4] }, [PREVIEW]: { colour: '--amber-ink', width: 2.5, dash: [10, 4] },
  [CALIBRATED]: { colour: '--green', width: 2.5, dash: [12, 3, 3, 3] },
};

// Fields that the name of a kept curve tells at the most.
const MOST_TOLD = 3;

class Curve {
  constructor(state) {
    this.state = state;
    this.host = byId('chart');
    this.load_n = null;
    this.rivals = byId('rivals').checked;
    byId('rivals').addEventListener('change', () => { this.rivals = byId('rivals').checked; this.draw(); });
    byId('load').addEventListener('input', () => this.moveTo(Number(byId('load').value)));
    byId('keep').addEventListener('click', () => this.keep());
    byId('trust').addEventListener('click', () => this.reasons(byId('reasons').hidden));
    matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => { this.chart?.destroy(); this.chart = undefined; this.draw(); });
    new ResizeObserver(() => this.resize()).observe(this.host);
    this.kept = remembered().kept ?? null;
  }

  // A design, with the values that it was asked for and the name of its calibrated model, if it has one.
  show(data, values, model) {
    Object.assign(this, { data, values, model });
    const loads = data.curve.load_n;
    const slider = byId('load');
    [slider.min, slider.max] = [loads[0], loads.at(-1)];
    this.load_n = clamp(this.load_n ?? loads[0] + 0.62 * (loads.at(-1) - loads[0]), loads[0], loads.at(-1));
    this.draw();
    this.words();
    this.moveTo(this.load_n);
  }

  // Shows a further curve: `kept`, `preview` or `calibrated`; null takes it away.
  further(which, curve) {
    this[which] = curve;
    if (this.data) this.draw();
  }

  keep() {
    if (this.kept) this.kept = null;
    else if (this.data) this.kept = { name: this.data.manifest.name, values: this.values, model: this.model, curve: this.data.curve };
    remember({ ...remembered(), kept: this.kept });
    this.draw();
  }

  // What the kept is called: its pins, and what else differs from what is shown.
  keptName() {
    const { name, values, model } = this.kept;
    // Kept by an earlier version of the page.
    if (!values) return name;
    const { fields } = this.state;
    const of = (all, path) => all[path] ?? fields.get(path)?.default;
    const differ = [...new Set([...Object.keys(values), ...Object.keys(this.values)])].filter((path) => fields.has(path) && !['layout.pins', 'switch.name'].includes(path) && !sameValue(of(values, path), of(this.values, path)));
    const told = differ.slice(0, MOST_TOLD).map((path) => `${fieldName(fields.get(path))} ${shownValue(of(values, path))} ${unitName(fields.get(path))}`.trim());
    if (differ.length > MOST_TOLD) told.push(WORDS.more(differ.length - MOST_TOLD));
    if (model !== this.model) told.push(model ? WORDS.modelName(model) : WORDS.publishedConstants);
    return [`${name} ${shownValue(of(values, 'layout.pins'))}`, ...told].join(', ');
  }

  draw() {
    byId('keep').textContent = this.kept ? WORDS.letGo : WORDS.keep;
    if (!this.data) return;
    const columns = columnsOf(this);
    this.ends = endsOf(columns, this.state.now.ask);
    if (!this.chart) this.build(columns); else this.chart.setData(columns);
    this.legend();
  }

  build(columns) {
    const [ink, grid, card] = ['--dim', '--line', '--card'].map(colourOf);
    const series = columns.map((_, i) => {
      const line = LINES[i];
      if (i === LOAD) return {};
      if (i === MEASURED) return { paths: () => null, points: { show: true, size: 11, width: 2, stroke: card, fill: colourOf('--amber') } };
      return { spanGaps: true, pxAlign: 0, points: { show: false }, stroke: line ? colourOf(line.colour) : 'transparent', width: line?.width, dash: line?.dash };
    });
    const axis = (side) => ({
      side, stroke: ink, grid: { stroke: grid, width: 1, show: side === 3 }, ticks: { show: false },
      font: '12px system-ui, sans-serif', size: side === 3 ? 34 : 26, space: side === 3 ? 46 : 60, gap: 4,
    });
    this.chart = new uPlot({
      ...this.room(), series, legend: { show: false }, cursor: { show: false }, padding: [26, 14, 0, 0],
      scales: { x: { time: false, range: () => [0, this.ends.load] }, y: { range: () => [0, this.ends.friction] } },
      bands: [{ series: [HIGH, LOW], fill: colourOf('--band') }], axes: [axis(2), axis(3)], hooks: { draw: [(u) => this.mark(u), () => this.handles?.place()] },
    }, columns, this.host);
    draggable(this.chart.over, { start: (e) => { if (e.target !== this.chart.over) return false; this.point(e); return true; }, move: (e) => this.point(e) });
    this.chart.over.append(make('span', WORDS.axisLoad, { class: 'axis x', 'aria-hidden': 'true' }), make('span', WORDS.axisFriction, { class: 'axis y', 'aria-hidden': 'true' }));
    this.handles?.attach(this.chart.over);
  }

  room() { return { width: Math.max(this.host.clientWidth, 120), height: Math.max(this.host.clientHeight, 120) }; }
  resize() { this.chart?.setSize(this.room()); }

  // A pull on the plot moves the load.
  point(event) {
    const left = event.clientX - this.chart.over.getBoundingClientRect().left;
    this.moveTo(this.chart.posToVal(left, 'x'));
  }

  // The point at the load that is shown, with a line down to its load.
  mark(u) {
    const { curve } = this.data;
    const [x, y, foot] = [u.valToPos(this.load_n, 'x', true), u.valToPos(at(curve.load_n, curve.friction_n, this.load_n), 'y', true), u.valToPos(0, 'y', true)];
    const { ctx } = u;
    ctx.save();
    ctx.strokeStyle = ctx.fillStyle = colourOf('--blue');
    ctx.lineWidth = devicePixelRatio;
    ctx.setLineDash([2 * devicePixelRatio, 3 * devicePixelRatio]);
    ctx.beginPath(); ctx.moveTo(x, y); ctx.lineTo(x, foot); ctx.stroke();
    ctx.setLineDash([]);
    ctx.beginPath(); ctx.arc(x, y, 6.5 * devicePixelRatio, 0, 2 * Math.PI); ctx.fill();
    ctx.lineWidth = 2.5 * devicePixelRatio;
    ctx.strokeStyle = colourOf('--card');
    ctx.stroke();
    ctx.restore();
  }

  moveTo(load_n) {
    if (!this.data) return;
    const { curve } = this.data;
    this.load_n = clamp(load_n, curve.load_n[0], curve.load_n.at(-1));
    const value = (column) => at(curve.load_n, curve[column], this.load_n);
    const [friction, low, high] = ['friction_n', 'band_low_n', 'band_high_n'].map(value);
    byId('load').value = this.load_n;
    byId('load').setAttribute('aria-valuetext', WORDS.loadText(this.load_n.toFixed(1), friction.toFixed(2)));
    byId('load-value').textContent = WORDS.newtons(this.load_n);
    byId('friction-now').textContent = WORDS.newtons(friction, friction < 9.95 ? 2 : 1);
    byId('friction-words').textContent = `${WORDS.frictionAt(WORDS.newtons(this.load_n))}, ${WORDS.range(low.toFixed(2), high.toFixed(2))}`;
    this.chart?.redraw(false);
    this.moved?.(this.load_n);
  }

  words() {
    const { curve, manifest } = this.data;
    const isOurs = this.model !== null;
    const trust = WORDS.trust[curve.trust] ?? curve.trust;
    const words = isOurs ? WORDS.calibratedTrust(trust) : trust;
    byId('trust').textContent = `${WORDS.trustMark[curve.trust] ?? ''} ${words}`;
    byId('trust').className = `badge ${curve.trust}`;
    byId('trust').setAttribute('aria-label', WORDS.trustOf(words));
    byId('reason-list').replaceChildren(...curve.reasons.map((r) => make('li', r)));
    byId('law').textContent = WORDS.law(curve.law, manifest.friction.source);
    const end = (column) => curve[column].at(-1).toFixed(2);
    this.host.setAttribute('aria-label', WORDS.curveName(curve.law, curve.load_n.at(-1).toFixed(1), end('friction_n'), end('band_low_n'), end('band_high_n')));
    const c = WORDS.columns;
    const columns = [curve.load_n, curve.eccentric_n, curve.concentric_n, curve.friction_n, curve.band_low_n, curve.band_high_n];
    if (byId('curve-table').open) byId('curve-rows').replaceChildren(table(Object.values(c), curve.load_n.map((_, i) => columns.map((column) => column[i].toFixed(3)))));
  }

  reasons(open) {
    // Who read them with the keyboard goes back to what opened them.
    if (!open && byId('reasons').contains(document.activeElement)) byId('trust').focus();
    byId('reasons').hidden = !open;
    byId('trust').setAttribute('aria-expanded', String(open));
  }

  legend() {
    const sample = (i) => {
      const line = LINES[i];
      const drawing = svg('svg', { width: 26, height: 8, 'aria-hidden': 'true' });
      drawing.append(svg('line', { x1: 1, x2: 25, y1: 4, y2: 4, 'stroke-width': line.width, 'stroke-dasharray': (line.dash ?? []).join(' '), style: `stroke: var(${line.colour})` }));
      return drawing;
    };
    const item = (mark, text) => { const li = make('li'); li.append(mark, text); return li; };
    const items = [item(sample(MAIN), this.data.curve.law), item(make('i', undefined, { class: 'swatch', 'aria-hidden': 'true' }), WORDS.band)];
    if (this.rivals) this.data.other_laws.slice(0, OTHERS).forEach((o, i) => items.push(item(sample(RIVAL + i), o.law)));
    if (this.kept) items.push(item(sample(KEPT), WORDS.kept(this.keptName())));
    if (this.preview) items.push(item(sample(PREVIEW), this.preview.name));
    if (this.calibrated) items.push(item(sample(CALIBRATED), WORDS.calibratedCurve));
    if (this.data.published.length) items.push(item(make('i', undefined, { class: 'dotmark', 'aria-hidden': 'true' }), WORDS.measuredPoint));
    byId('legend').replaceChildren(...items);
  }
}
