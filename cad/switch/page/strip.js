// On a narrow screen: what the design does, pinned to the lower edge while the curve itself is out of view, or to the upper
// edge while the parameters are open.

const STRIP = { width: 132, height: 44 };

class Strip {
  constructor(curve, state) {
    Object.assign(this, { curve, state });
    this.host = byId('strip');
    this.isCurveSeen = true;
    new IntersectionObserver(([{ isIntersecting }]) => { this.isCurveSeen = isIntersecting; this.update(); }, { threshold: 0.35 }).observe(byId('chart'));
    this.host.addEventListener('click', () => byId('chart').scrollIntoView({ block: 'center' }));
    state.addEventListener('change', () => this.update());
  }

  // Whether the sheet of parameters covers the page.
  get isCovered() { return document.body.classList.contains('sheet'); }

  update() {
    const { data } = this.curve;
    this.host.hidden = !data || (this.isCurveSeen && !this.isCovered);
    if (this.host.hidden) return;
    const { curve, manifest: { friction: f } } = data;
    const { threshold_n: wanted } = this.state.now.targets;
    const drawing = svg('svg', { viewBox: `0 0 ${STRIP.width} ${STRIP.height}`, 'aria-hidden': 'true' });
    const [maxLoad, maxFriction] = [Math.max(curve.load_n.at(-1), wanted ?? 0), Math.max(...curve.band_high_n, 1e-9)];
    const at = (load, friction) => `${(STRIP.width * load / maxLoad).toFixed(1)},${(STRIP.height * (1 - friction / maxFriction)).toFixed(1)}`;
    const line = (column) => curve.load_n.map((load, i) => at(load, curve[column][i]));
    drawing.append(svg('polygon', { points: [...line('band_low_n'), ...line('band_high_n').reverse()].join(' '), class: 'band' }), svg('polyline', { points: line('friction_n').join(' ') }));
    const mark = (load, name) => drawing.append(svg('line', { x1: STRIP.width * load / maxLoad, x2: STRIP.width * load / maxLoad, y1: 0, y2: STRIP.height, class: name }));
    if (f.threshold_n !== null) mark(f.threshold_n, 'now');
    if (wanted !== null) mark(wanted, 'wanted');
    const text = make('span');
    text.append(make('b', TEXT.switchesAt(f.threshold_n)), make('span', TEXT.stripFriction(TEXT.newtons(f.friction_n, 2), TEXT.newtons(f.load_n))));
    const { friction: frictions } = this.state.now.targets;
    const targets = [...(wanted === null ? [] : [TEXT.newtons(wanted)]), ...frictions.map((t) => TEXT.stripFriction(TEXT.newtons(t.friction_n), TEXT.newtons(t.load_n)))];
    if (targets.length) text.append(make('span', TEXT.target(targets.join(', '))));
    this.host.replaceChildren(drawing, text);
  }
}
