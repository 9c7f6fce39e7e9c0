// What is asked of the switch, as marks on the plot: pulled with the pointer or moved with arrow keys.

class Handles {
  constructor(curve, state) {
    this.curve = curve;
    this.state = state;
    curve.handles = this;
    this.threshold = this.grip('threshold', WORDS.thresholdHandle, (e) => this.pullThreshold(e), (d) => this.nudgeThreshold(d));
    this.line = make('i', undefined, { class: 'threshold-line', 'aria-hidden': 'true' });
    // Where it switches now, once another load is asked for.
    this.own = make('i', undefined, { class: 'threshold-line own', 'aria-hidden': 'true' });
    this.diamonds = [];
    state.addEventListener('change', () => curve.draw());
  }

  attach(over) {
    this.over = over;
    over.append(this.own, this.line, this.threshold, ...this.diamonds);
  }

  grip(kind, name, pull, nudge) {
    const element = make('div', undefined, { class: `grip ${kind}`, role: 'slider', tabindex: 0, 'aria-label': name, 'aria-valuemin': 0 });
    draggable(element, { start: (e) => { e.stopPropagation(); element.focus(); return true; }, move: pull });
    element.addEventListener('keydown', (event) => {
      const by = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1], PageUp: [0, 10], PageDown: [0, -10] }[event.key];
      if (!by || event.ctrlKey || event.metaKey || event.altKey) return;
      nudge(by.map((v) => v * (event.shiftKey ? 10 : 1)));
      event.preventDefault();
    });
    return element;
  }

  // Where the pointer is, in newtons of load and of friction, to what one can mean.
  values(event) {
    const box = this.over.getBoundingClientRect();
    const { chart, ends } = this.curve;
    const load = chart.posToVal(event.clientX - box.left, 'x');
    const friction = chart.posToVal(event.clientY - box.top, 'y');
    return { load_n: Number(clamp(load, 0.2, ends.load).toFixed(1)), friction_n: Number(clamp(friction, 0.01, ends.friction).toFixed(2)) };
  }

  ask(parts, what) { this.state.change({ ask: { ...this.state.now.ask, ...parts } }, what); }

  ownThreshold() { return this.curve.data?.manifest.friction.threshold_n ?? null; }
  pullThreshold(event) { this.ask({ threshold_n: this.values(event).load_n }, 'ask.threshold'); }
  nudgeThreshold([along, up]) {
    const from = this.state.now.ask.threshold_n ?? this.ownThreshold();
    this.ask({ threshold_n: Number(clamp(from + (along || up) * 0.5, 0.5, 1000).toFixed(1)) }, 'ask.threshold');
  }

  // Frictions that are asked for; without one, a mark on the curve that can become one.
  frictions() {
    const { friction } = this.state.now.ask;
    if (friction.length || !this.curve.data) return friction;
    const { load_n, friction_n } = this.curve.data.curve;
    const load = Number((0.8 * load_n.at(-1)).toFixed(1));
    return [{ load_n: load, friction_n: Number(at(load_n, friction_n, load).toFixed(2)) }];
  }

  setFriction(i, value) { this.ask({ friction: this.frictions().map((f, k) => (k === i ? value : f)) }, `ask.friction.${i}`); }
  nudgeFriction(i, [along, up]) {
    const { load_n, friction_n } = this.frictions()[i];
    this.setFriction(i, { load_n: Number(clamp(load_n + along * 0.5, 0.2, 1000).toFixed(1)), friction_n: Number(clamp(friction_n + up * 0.1, 0.01, 1000).toFixed(2)) });
  }

  place() {
    const { chart, data, ends } = this.curve;
    if (!chart || !data || !this.over) return;
    const { ask } = this.state.now;
    const load = ask.threshold_n ?? this.ownThreshold();
    this.threshold.hidden = this.line.hidden = load === null;
    if (load !== null) {
      const x = chart.valToPos(load, 'x');
      const words = ask.threshold_n === null ? WORDS.thresholdNow(WORDS.newtons(load)) : WORDS.thresholdAsked(WORDS.newtons(load));
      this.line.style.left = `${x}px`;
      this.tell(this.threshold, { x, y: 0, label: words, value: load, most: ends.load, isAsked: ask.threshold_n !== null });
      // The words stay on the plot, wherever the mark is.
      this.threshold.style.setProperty('--aside', `${clamp(0, 32 - x, chart.bbox.width / devicePixelRatio - x - 48)}px`);
    }
    this.line.classList.toggle('asked', ask.threshold_n !== null);
    const own = this.ownThreshold();
    this.own.hidden = own === null || ask.threshold_n === null;
    if (!this.own.hidden) {
      this.own.style.left = `${chart.valToPos(own, 'x')}px`;
      this.own.dataset.label = WORDS.thresholdOwn(WORDS.newtons(own));
    }
    const wanted = this.frictions();
    while (this.diamonds.length > wanted.length) this.diamonds.pop().remove();
    while (this.diamonds.length < wanted.length) {
      const i = this.diamonds.length;
      const diamond = this.grip('diamond', WORDS.frictionHandle(i + 1), (e) => this.setFriction(i, this.values(e)), (d) => this.nudgeFriction(i, d));
      this.diamonds.push(diamond);
      this.over.append(diamond);
    }
    wanted.forEach((f, i) => {
      const isAsked = ask.friction.length > 0;
      const words = WORDS.loadText(plain(f.load_n), plain(f.friction_n));
      const label = isAsked ? WORDS.frictionAsked(WORDS.newtons(f.friction_n)) : '';
      const [x, y] = [chart.valToPos(f.load_n, 'x'), chart.valToPos(f.friction_n, 'y')];
      this.tell(this.diamonds[i], { x, y, label, value: f.friction_n, most: ends.friction, isAsked, words });
    });
  }

  tell(element, { x, y, label, value, most, isAsked, words = label }) {
    element.style.left = `${x}px`;
    element.style.top = `${y}px`;
    element.dataset.label = label;
    element.classList.toggle('asked', isAsked);
    element.setAttribute('aria-valuenow', plain(value));
    element.setAttribute('aria-valuemax', plain(most));
    element.setAttribute('aria-valuetext', words);
  }
}
