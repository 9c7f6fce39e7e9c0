// The plot of friction over load: curve, band, other laws, measured points, a curve for comparison,
// the present load.

const LOAD = 0, MAIN = 1, LOW = 2, HIGH = 3, OTHER = 4, COMPARISON = OTHER + MAX_OTHER_LAWS, PREVIEW = COMPARISON + 1, CALIBRATED = COMPARISON + 2, MEASURED = COMPARISON + 3, OWN = COMPARISON + 4, PROPOSAL = COMPARISON + 5;

// Lines differ in dashes and in colour.
const LINES = {
  [MAIN]: { colour: '--blue', width: 3 }, [OTHER]: { colour: '--green', width: 1.3, dash: [7, 4] }, [OTHER + 1]: { colour: '--violet', width: 1.3, dash: [2, 3] },
  [OTHER + 2]: { colour: '--red', width: 1.3, dash: [9, 3, 2, 3] }, [COMPARISON]: { colour: '--dim', width: 2, dash: [5, 4] }, [PREVIEW]: { colour: '--amber-ink', width: 2.5, dash: [10, 4] },
  [CALIBRATED]: { colour: '--green', width: 2.5, dash: [12, 3, 3, 3] },
  ...Object.fromEntries(Array.from({ length: MAX_PROPOSALS }, (_, i) => [PROPOSAL + i, { colour: '--amber-ink', width: 1 }])),
};

// Most differing fields in the name of the comparison.
const MAX_NAMED_FIELDS = 3;

class Curve {
  constructor(state) {
    this.state = state;
    this.host = byId('chart');
    this.load_n = null;
    this.proposals = [];
    this.showsOtherLaws = byId('other-laws').checked;
    byId('other-laws').addEventListener('change', () => { this.showsOtherLaws = byId('other-laws').checked; this.draw(); });
    byId('load').addEventListener('input', () => { this.motion.stop(); this.moveTo(Number(byId('load').value)); });
    this.motion = new Motion(byId('play'), (share) => this.moveToShare(share), () => this.share());
    byId('keep-curve').addEventListener('click', () => this.toggleComparison());
    byId('trust').addEventListener('click', () => this.showReasons(byId('reasons').hidden));
    matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => { this.chart?.destroy(); this.chart = undefined; this.draw(); });
    new ResizeObserver(() => this.resize()).observe(this.host);
    this.comparison = remembered().kept ?? null;
  }

  // Shows the curve of a design with these values and the name of its calibrated model, or null.
  show(data, values, model) {
    Object.assign(this, { data, values, model });
    const loads = data.curve.load_n;
    const slider = byId('load');
    [slider.min, slider.max] = [loads[0], loads.at(-1)];
    this.load_n = clamp(this.load_n ?? loads[0] + 0.62 * (loads.at(-1) - loads[0]), loads[0], loads.at(-1));
    this.draw();
    this.describe();
    this.moveTo(this.load_n);
  }

  // Shows a person's readings on the plot, for every design of their condition.
  setMeasured(points) {
    this.measured = points;
    if (this.data) this.draw();
  }

  // Readings of the condition of the design: substrate, pins and wrap angle.
  get ownPoints() {
    const value = (path) => this.values?.[path] ?? this.state.fields.get(path).default;
    const pins = [...value('layout.pins')].sort((a, b) => a - b);
    return (this.measured ?? []).filter((p) => p.substrate === value('layout.substrate') && sameValue(p.pins, pins) && Math.abs(p.wrap_angle_deg - value('layout.wrap_angle_deg')) < 0.5);
  }

  // Shows another curve, `preview` or `calibrated`; null removes it.
  setExtra(which, curve) {
    this[which] = curve;
    if (this.data) this.draw();
  }

  toggleComparison() {
    if (this.comparison) this.comparison = null;
    else if (this.data) this.comparison = { name: this.data.manifest.name, values: this.values, model: this.model, curve: this.data.curve };
    remember({ ...remembered(), kept: this.comparison });
    this.draw();
  }

  // The name of the comparison: its pins, and other differences from the present design.
  comparisonName() {
    const { name, values, model } = this.comparison;
    // From an earlier version of the page.
    if (!values) return name;
    const { fields } = this.state;
    const of = (all, path) => all[path] ?? fields.get(path)?.default;
    const differing = [...new Set([...Object.keys(values), ...Object.keys(this.values)])].filter((path) => fields.has(path) && !['layout.pins', 'switch.name'].includes(path) && !sameValue(of(values, path), of(this.values, path)));
    const names = differing.slice(0, MAX_NAMED_FIELDS).map((path) => `${fieldName(fields.get(path))} ${formatValue(of(values, path))} ${unitName(fields.get(path))}`.trim());
    if (differing.length > MAX_NAMED_FIELDS) names.push(TEXT.more(differing.length - MAX_NAMED_FIELDS));
    if (model !== this.model) names.push(model ? TEXT.modelName(model) : TEXT.publishedConstants);
    return [`${name} ${formatValue(of(values, 'layout.pins'))}`, ...names].join(', ');
  }

  draw() {
    byId('keep-curve').textContent = this.comparison ? TEXT.clearComparison : TEXT.keepCurve;
    if (!this.data) return;
    const columns = columnsOf(this);
    this.ends = endsOf(columns, this.state.now.targets);
    if (!this.chart) this.build(columns); else this.chart.setData(columns);
    this.legend();
  }

  build(columns) {
    const [ink, grid, card] = ['--dim', '--line', '--card'].map(colourOf);
    const series = columns.map((_, i) => {
      const line = LINES[i];
      if (i === LOAD) return {};
      if (i === MEASURED) return { paths: () => null, points: { show: true, size: 11, width: 2, stroke: card, fill: colourOf('--amber') } };
      if (i === OWN) return { paths: () => null, points: { show: true, size: 8, width: 1.5, stroke: colourOf('--ink'), fill: card } };
      return { spanGaps: true, pxAlign: 0, points: { show: false }, stroke: line ? colourOf(line.colour) : 'transparent', width: line?.width, dash: line?.dash };
    });
    const axis = (side) => ({
      side, stroke: ink, grid: { stroke: grid, width: 1, show: side === 3 }, ticks: { show: false },
      font: '12px system-ui, sans-serif', size: side === 3 ? 34 : 26, space: side === 3 ? 46 : 60, gap: 4,
    });
    this.chart = new uPlot({
      ...this.size(), series, legend: { show: false }, cursor: { show: false }, padding: [26, 14, 0, 0],
      scales: { x: { time: false, range: () => [0, this.ends.load] }, y: { range: () => [0, this.ends.friction] } },
      bands: [{ series: [HIGH, LOW], fill: colourOf('--band') }], axes: [axis(2), axis(3)], hooks: { draw: [(u) => this.drawLoad(u), () => this.handles?.place()] },
    }, columns, this.host);
    draggable(this.chart.over, { start: (e) => { if (e.target !== this.chart.over) return false; this.motion.stop(); this.moveToPointer(e); return true; }, move: (e) => this.moveToPointer(e) });
    this.chart.over.append(make('span', TEXT.axisLoad, { class: 'axis x', 'aria-hidden': 'true' }), make('span', TEXT.axisFriction, { class: 'axis y', 'aria-hidden': 'true' }));
    this.handles?.attach(this.chart.over);
  }

  size() { return { width: Math.max(this.host.clientWidth, 120), height: Math.max(this.host.clientHeight, 120) }; }
  resize() { this.chart?.setSize(this.size()); }

  // A drag on the plot moves the load.
  moveToPointer(event) {
    const left = event.clientX - this.chart.over.getBoundingClientRect().left;
    this.moveTo(this.chart.posToVal(left, 'x'));
  }

  // Draws the point at the present load, with a line down to the axis.
  drawLoad(u) {
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

  // The present load as a share of the range of loads, and the load of a share.
  share() {
    const loads = this.data?.curve.load_n ?? [0, 1];
    return (this.load_n - loads[0]) / (loads.at(-1) - loads[0]);
  }

  moveToShare(share) {
    const loads = this.data?.curve.load_n;
    if (loads) this.moveTo(loads[0] + share * (loads.at(-1) - loads[0]));
  }

  moveTo(load_n) {
    if (!this.data) return;
    const { curve } = this.data;
    this.load_n = clamp(load_n, curve.load_n[0], curve.load_n.at(-1));
    const value = (column) => at(curve.load_n, curve[column], this.load_n);
    const [friction, low, high] = ['friction_n', 'band_low_n', 'band_high_n'].map(value);
    byId('load').value = this.load_n;
    byId('load').setAttribute('aria-valuetext', TEXT.loadText(this.load_n.toFixed(1), friction.toFixed(2)));
    byId('load-value').textContent = TEXT.newtons(this.load_n);
    byId('friction-now').textContent = TEXT.newtons(friction, friction < 9.95 ? 2 : 1);
    byId('friction-text').textContent = `${TEXT.frictionAt(TEXT.newtons(this.load_n))}, ${TEXT.range(low.toFixed(2), high.toFixed(2))}`;
    this.chart?.redraw(false);
    this.moved?.(this.load_n);
  }

  describe() {
    const { curve, manifest } = this.data;
    const trust = TEXT.trust[curve.trust] ?? curve.trust;
    const status = this.model === null ? trust : TEXT.calibratedTrust(trust);
    byId('trust').textContent = `${TEXT.trustMark[curve.trust] ?? ''} ${status}`;
    byId('trust').className = `badge ${curve.trust}`;
    byId('trust').setAttribute('aria-label', TEXT.trustName(status));
    byId('reason-list').replaceChildren(...curve.reasons.map((r) => make('li', r)));
    byId('law').textContent = TEXT.law(curve.law, manifest.friction.source);
    const end = (column) => curve[column].at(-1).toFixed(2);
    this.host.setAttribute('aria-label', TEXT.curveName(curve.law, curve.load_n.at(-1).toFixed(1), end('friction_n'), end('band_low_n'), end('band_high_n')));
    const c = TEXT.columns;
    const columns = [curve.load_n, curve.eccentric_n, curve.concentric_n, curve.friction_n, curve.band_low_n, curve.band_high_n];
    if (byId('curve-table').open) byId('curve-rows').replaceChildren(table(Object.values(c), curve.load_n.map((_, i) => columns.map((column) => column[i].toFixed(3)))));
  }

  showReasons(open) {
    // The focus goes back to the button that opened them.
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
    const items = [item(sample(MAIN), TEXT.predicted(this.data.curve.law)), item(make('i', undefined, { class: 'swatch', 'aria-hidden': 'true' }), TEXT.band)];
    if (this.showsOtherLaws) this.data.other_laws.slice(0, MAX_OTHER_LAWS).forEach((o, i) => items.push(item(sample(OTHER + i), TEXT.lawNames[o.law] ?? o.law)));
    if (this.comparison) items.push(item(sample(COMPARISON), TEXT.comparison(this.comparisonName())));
    if (this.proposals.length) items.push(item(sample(PROPOSAL), TEXT.proposedCurves(this.proposals.length)));
    if (this.preview) items.push(item(sample(PREVIEW), this.preview.name));
    if (this.calibrated) items.push(item(sample(CALIBRATED), TEXT.calibratedCurve));
    if (this.ownPoints.length) items.push(item(make('i', undefined, { class: 'dotmark own', 'aria-hidden': 'true' }), TEXT.ownPoints(this.ownPoints.length)));
    if (this.data.published.length) items.push(item(make('i', undefined, { class: 'dotmark', 'aria-hidden': 'true' }), TEXT.measuredPoint));
    byId('legend').replaceChildren(...items);
  }
}
