// Targets as marks on the plot, dragged with the pointer or moved with arrow keys.

class Handles {
  constructor(curve, state) {
    this.curve = curve;
    this.state = state;
    curve.handles = this;
    this.threshold = this.grip('threshold', TEXT.thresholdHandle, (e) => this.dragThreshold(e), (d) => this.nudgeThreshold(d));
    this.line = make('i', undefined, { class: 'threshold-line', 'aria-hidden': 'true' });
    // The present threshold, shown when there is a target.
    this.current = make('i', undefined, { class: 'threshold-line current', 'aria-hidden': 'true' });
    this.diamonds = [];
    state.addEventListener('change', () => curve.draw());
  }

  attach(over) {
    this.over = over;
    over.append(this.current, this.line, this.threshold, ...this.diamonds);
  }

  grip(kind, name, drag, nudge) {
    // In a report a mark, which is not moved.
    const element = make('div', undefined, { class: `grip ${kind}`, ...(IS_REPORT ? { inert: '' } : { role: 'slider', tabindex: 0 }), 'aria-label': name, 'aria-valuemin': 0 });
    // A swipe over a mark that scrolls the page sets no target.
    let before;
    draggable(element, {
      start: (e) => {
        e.stopPropagation();
        element.focus();
        before = { targets: this.state.now.targets, x: e.clientX, y: e.clientY, isTarget: element.classList.contains('target') };
        return true;
      },
      move: drag,
      // Of a finger, what is steeper than 45 degrees was a swipe, but for a target friction, which has both directions.
      end: (e, cancelled) => {
        const isSteep = e.pointerType === 'touch' && Math.abs(e.clientY - before.y) > Math.abs(e.clientX - before.x);
        if (cancelled || (isSteep && !(kind === 'diamond' && before.isTarget))) this.set(before.targets, kind === 'diamond' ? undefined : 'target.threshold');
      },
    });
    element.addEventListener('keydown', (event) => {
      const by = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1], PageUp: [0, 10], PageDown: [0, -10] }[event.key];
      if (!by || event.ctrlKey || event.metaKey || event.altKey) return;
      nudge(by.map((v) => v * (event.shiftKey ? 10 : 1)));
      event.preventDefault();
    });
    return element;
  }

  // The position of the pointer, in newtons of load and of friction.
  values(event) {
    const box = this.over.getBoundingClientRect();
    const { chart, ends } = this.curve;
    const load = chart.posToVal(event.clientX - box.left, 'x');
    const friction = chart.posToVal(event.clientY - box.top, 'y');
    return { load_n: Number(clamp(load, 0.2, ends.load).toFixed(1)), friction_n: Number(clamp(friction, 0.01, ends.friction).toFixed(2)) };
  }

  set(parts, step) { this.state.change({ targets: { ...this.state.now.targets, ...parts } }, step); }

  currentThreshold() { return this.curve.data?.manifest.friction.threshold_n ?? null; }
  dragThreshold(event) { this.set({ threshold_n: this.values(event).load_n }, 'target.threshold'); }
  nudgeThreshold([along, up]) {
    const from = this.state.now.targets.threshold_n ?? this.currentThreshold();
    this.set({ threshold_n: Number(clamp(from + (along || up) * 0.5, 0.5, MAX_TARGET_N).toFixed(1)) }, 'target.threshold');
  }

  // The target frictions; without one, a mark on the curve that becomes one when it is moved.
  frictions() {
    const { friction } = this.state.now.targets;
    if (friction.length || !this.curve.data || IS_REPORT) return friction;
    const { load_n, friction_n } = this.curve.data.curve;
    const load = Number((0.8 * load_n.at(-1)).toFixed(1));
    return [{ load_n: load, friction_n: Number(at(load_n, friction_n, load).toFixed(2)) }];
  }

  setFriction(i, value) { this.set({ friction: this.frictions().map((f, k) => (k === i ? value : f)) }, `target.friction.${i}`); }
  nudgeFriction(i, [along, up]) {
    const { load_n, friction_n } = this.frictions()[i];
    this.setFriction(i, { load_n: Number(clamp(load_n + along * 0.5, 0.2, MAX_TARGET_N).toFixed(1)), friction_n: Number(clamp(friction_n + up * 0.1, 0.01, MAX_TARGET_N).toFixed(2)) });
  }

  place() {
    const { chart, data, ends } = this.curve;
    if (!chart || !data || !this.over) return;
    const { targets } = this.state.now;
    const hasThreshold = targets.threshold_n !== null;
    const current = this.currentThreshold();
    const load = targets.threshold_n ?? current;
    this.threshold.hidden = this.line.hidden = load === null;
    if (load !== null) {
      const x = chart.valToPos(load, 'x');
      const label = (hasThreshold ? TEXT.target : TEXT.switchesAtLoad)(TEXT.newtons(load));
      this.line.style.left = `${x}px`;
      this.update(this.threshold, { x, y: 0, label, value: load, max: ends.load, isTarget: hasThreshold });
      // The label stays on the plot.
      this.threshold.style.setProperty('--label-shift', `${clamp(0, 32 - x, chart.bbox.width / devicePixelRatio - x - 48)}px`);
    }
    this.line.classList.toggle('target', hasThreshold);
    this.current.hidden = current === null || !hasThreshold;
    if (!this.current.hidden) {
      this.current.style.left = `${chart.valToPos(current, 'x')}px`;
      this.current.dataset.label = TEXT.thresholdCurrent(TEXT.newtons(current));
    }
    const frictions = this.frictions();
    while (this.diamonds.length > frictions.length) this.diamonds.pop().remove();
    while (this.diamonds.length < frictions.length) {
      const i = this.diamonds.length;
      const diamond = this.grip('diamond', TEXT.frictionHandle(i + 1), (e) => this.setFriction(i, this.values(e)), (d) => this.nudgeFriction(i, d));
      this.diamonds.push(diamond);
      this.over.append(diamond);
    }
    const isTarget = targets.friction.length > 0;
    frictions.forEach((f, i) => {
      const valueText = TEXT.loadText(formatNumber(f.load_n), formatNumber(f.friction_n));
      const label = isTarget ? TEXT.target(TEXT.newtons(f.friction_n)) : '';
      const [x, y] = [chart.valToPos(f.load_n, 'x'), chart.valToPos(f.friction_n, 'y')];
      this.update(this.diamonds[i], { x, y, label, value: f.friction_n, max: ends.friction, isTarget, valueText });
    });
  }

  update(element, { x, y, label, value, max, isTarget, valueText = label }) {
    element.style.left = `${x}px`;
    element.style.top = `${y}px`;
    element.dataset.label = label;
    element.classList.toggle('target', isTarget);
    element.setAttribute('aria-valuenow', formatNumber(value));
    element.setAttribute('aria-valuemax', formatNumber(max));
    element.setAttribute('aria-valuetext', valueText);
  }
}
