// The segment with its grooves, seen along the axis: pins are added, moved and removed here.

// Distance from the silicone below which the tendon is shown to touch it, in mm.
const TOUCHING_MM = 0.002;
// Enlargement of heights above the silicone.
const HEIGHT_SCALE = 3;
// Most grooves with a number each; of more, every fifth has one.
const MAX_NUMBERED = 24;

// A point of the drawing; angles are measured from the top, clockwise.
const point = (radius, angle) => [radius * Math.sin(angle), -radius * Math.cos(angle)];

class Pins {
  constructor(host, state) {
    this.host = host;
    this.state = state;
    this.focused = null;
    state.addEventListener('change', () => this.draw());
    byId('clear-pins').addEventListener('click', () => state.change({ values: { ...state.now.values, 'layout.pins': [] } }));
    byId('mirror-pins').addEventListener('click', () => this.set(this.pins().map((i) => this.grooves() + 1 - i)));
    this.draw();
    // A report's drawing is a picture.
    host.inert = IS_REPORT;
  }

  // Takes the shapes of the tendon of a design, for the drawing at a load.
  show({ contact }, values) {
    Object.assign(this, { contact, contactOf: values });
    this.pose(this.load_n ?? contact.load_n.at(-1));
  }

  // Moves tendon and pins to their places at a load. Heights above the silicone are enlarged; the pins follow the tendon.
  pose(load_n) {
    this.load_n = load_n;
    const { contact, s } = this;
    // Not the shapes of other pins.
    const isKnown = contact?.load_n.length && this.contactOf === this.state.now.values;
    byId('pins-scale').hidden = !contact?.load_n.length;
    // It keeps its place while a design is refused.
    byId('pins-scale').classList.toggle('unknown', !isKnown);
    if (!isKnown) return;
    const gaps = contact.angle_rad.map((_, i) => at(contact.load_n, contact.gap_mm.map((state) => state[i]), load_n));
    byId('pins-scale').textContent = TEXT.pinsScale(formatNumber(load_n, 1), HEIGHT_SCALE);
    const points = contact.angle_rad.map((angle, i) => point(s.contact + s.rope + HEIGHT_SCALE * gaps[i], angle));
    // The tendon leaves straight.
    const beyond = ([x, y], [inner_x, inner_y]) => {
      const share = 0.28 * s.contact / (Math.hypot(x - inner_x, y - inner_y) || 1);
      return [x + share * (x - inner_x), y + share * (y - inner_y)];
    };
    this.rope.setAttribute('d', `M${[beyond(points[0], points[1]), ...points, beyond(points.at(-1), points.at(-2))].join('L')}`);
    // Where the tendon lies on the silicone.
    const touching = contact.angle_rad.map((angle, i) => [angle, gaps[i] < TOUCHING_MM]);
    this.touch.setAttribute('d', touching.map(([angle, isOn], i) => (isOn ? `${touching[i - 1]?.[1] ? 'L' : 'M'}${point(s.contact, angle)}` : '')).join(''));
    for (const i of this.pins()) {
      const angle = this.angle(i, s);
      const [x, y] = point(HEIGHT_SCALE * at(contact.angle_rad, gaps, angle) - s.pin, angle);
      this.marks[i - 1]?.querySelector('.dot').setAttribute('transform', `translate(${x} ${y})`);
    }
  }

  grooves() { return clamp(Math.round(this.state.value('segment.grooves')) || 1, 1, 60); }
  pins() { return this.state.value('layout.pins').filter((i) => i >= 1); }
  // Each call is one step of the history, unless `step` joins several.
  set(pins, step) { this.state.change({ values: { ...this.state.now.values, 'layout.pins': [...new Set(pins)].sort((a, b) => a - b) } }, step); }

  toggle(i) {
    const pins = this.pins();
    this.set(pins.includes(i) ? pins.filter((p) => p !== i) : [...pins, i]);
  }

  move(from, to, step) {
    const pins = this.pins();
    if (from === to || !pins.includes(from) || pins.includes(to) || to < 1 || to > this.grooves()) return false;
    this.set(pins.map((p) => (p === from ? to : p)), step);
    return true;
  }

  // Dimensions of the drawing in millimetres, from the values of the part, or from those of a template.
  sizes(value = (path) => this.state.value(path)) {
    const v = (path, low, high) => clamp(Number(value(path)) || 0, low, high);
    const shell = v('shell.outer_radius_mm', 5, 150);
    const contact = shell + v('silicone.thickness_mm', 0.3, 10);
    const n = Math.round(v('segment.grooves', 1, 60));
    const span = v('segment.span_deg', 5, 340) * Math.PI / 180;
    const pitch = 2 * contact * Math.sin(span / n / 2);
    const pin = v('pins.diameter_mm', 0.1, 5) / 2;
    const rope = v('tendon.rope_diameter_mm', 0.1, 6) / 2 + v('tendon.coating_mm', 0, 2);
    // Large enough to see and click, whatever the pitch and the scale.
    const visiblePin = Math.max(pin, 0.42 * Math.min(pitch, Math.max(1.5, 0.045 * contact)));
    return { shell, contact, n, span, pin: visiblePin, rope, inner: shell - clamp(v('shell.wall_mm', 1, 60), 2, Math.max(4.5, 0.2 * shell)),
      wrap: v('layout.wrap_angle_deg', 1, 340) * Math.PI / 180 };
  }

  angle(i, { n, span }) { return (i - (n + 1) / 2) * span / n; }

  draw() {
    const s = this.s = this.sizes();
    const pins = this.pins();
    const drawing = this.segment(s);
    this.marks = [];
    for (let i = 1; i <= s.n; i += 1) drawing.append(this.groove(i, s, pins.includes(i)));
    this.draggedPin = svg('circle', { r: s.pin, class: 'dragged-pin', visibility: 'hidden' });
    drawing.append(this.draggedPin);
    this.listen(drawing);
    const hadFocus = this.host.contains(document.activeElement);
    this.host.replaceChildren(drawing);
    [this.rope, this.touch] = ['.tendon', '.touch'].map((name) => drawing.querySelector(name));
    if (this.load_n !== undefined) this.pose(this.load_n);
    if (hadFocus) this.marks[this.focused - 1]?.focus();
    byId('pins-title').textContent = TEXT.pinsIn(pins);
    byId('pins-count').textContent = pins.length ? TEXT.pinsCount(pins.length, s.n) : TEXT.noPinsNote;
    byId('clear-pins').disabled = !pins.length;
    // A pin beyond the last groove, which is refused, cannot be mirrored.
    byId('mirror-pins').disabled = !pins.length || pins.some((i) => i > this.grooves());
  }

  // Draws shell, layer and tendon.
  segment(s, substrate = this.state.value('layout.substrate')) {
    const sector = (low, high) => {
      const [a, b, c, d] = [point(high, -s.span / 2), point(high, s.span / 2), point(low, s.span / 2), point(low, -s.span / 2)];
      const large = s.span > Math.PI ? 1 : 0;
      return `M${a}A${high} ${high} 0 ${large} 1 ${b}L${c}A${low} ${low} 0 ${large} 0 ${d}Z`;
    };
    const axis = s.contact + s.pin * 1.1 + s.rope;
    const [l, r] = [point(axis, -s.wrap / 2), point(axis, s.wrap / 2)];
    // The tendon leaves the bed straight.
    const [along, down] = [0.28 * s.contact * Math.cos(s.wrap / 2), 0.28 * s.contact * Math.sin(s.wrap / 2)];
    const ends = [[l[0] - along, l[1] + down], [r[0] + along, r[1] + down]];
    const reach = s.span > Math.PI ? s.contact : s.contact * Math.sin(s.span / 2);
    const width = Math.max(reach, ends[1][0]) + 1.2;
    const lowest = Math.max(...[s.inner, s.contact].map((radius) => -radius * Math.cos(s.span / 2)), ends[0][1]) + 1;
    const top = -(axis + s.rope) - 0.6;
    const drawing = svg('svg', { viewBox: `${-width} ${top} ${2 * width} ${lowest - top}`, role: 'group', 'aria-label': TEXT.pinsName, class: s.span > Math.PI ? 'strip tall' : 'strip' });
    const bed = substrate === 'abs' ? 'shell' : 'layer';
    const rope = `M${ends[0]}L${l}A${axis} ${axis} 0 ${s.wrap > Math.PI ? 1 : 0} 1 ${r}L${ends[1]}`;
    drawing.append(svg('path', { d: sector(s.inner, s.shell), class: 'shell' }), svg('path', { d: sector(s.shell, s.contact), class: bed }),
      svg('path', { d: '', class: 'touch', 'stroke-width': 0.5 * s.rope }), svg('path', { d: rope, class: 'tendon', 'stroke-width': 2 * s.rope }));
    return drawing;
  }

  // A picture of the segment of a template.
  picture(values) {
    const value = (path) => values[path] ?? this.state.fields.get(path)?.default;
    const s = this.sizes(value);
    const picture = this.segment(s, value('layout.substrate'));
    for (const i of value('layout.pins')) {
      const [cx, cy] = point(s.contact, this.angle(i, s));
      picture.append(svg('circle', { cx, cy, r: 1.4 * s.pin, class: 'pin' }));
    }
    picture.setAttribute('aria-hidden', 'true');
    return picture;
  }

  groove(i, s, hasPin) {
    if (this.focused === null || this.focused > s.n) this.focused = this.pins()[0] ?? 1;
    const angle = this.angle(i, s);
    const [x, y] = point(s.contact, angle);
    const mark = svg('g', {
      class: hasPin ? 'groove on' : 'groove', 'data-groove': i, tabindex: i === this.focused ? 0 : -1,
      role: 'checkbox', 'aria-checked': hasPin, 'aria-label': TEXT.groove(i, hasPin),
    });
    mark.append(svg('circle', { cx: x, cy: y, r: s.pin * 1.75, class: 'halo' }), svg('circle', { cx: x, cy: y, r: s.pin, class: 'dot' }));
    if (s.n <= MAX_NUMBERED || i % 5 === 0 || i === 1) {
      const [tx, ty] = point((s.inner + s.shell) / 2, angle);
      mark.append(svg('text', { x: tx, y: ty, 'font-size': clamp(0.055 * s.contact, 0.5, Math.max(1.25, 0.45 * (s.shell - s.inner))), 'text-anchor': 'middle', 'dominant-baseline': 'central' }, i));
    }
    this.marks.push(mark);
    return mark;
  }

  // The groove nearest to the pointer, and the pointer's radial distance from the contact radius in
  // millimetres.
  nearest(drawing, event) {
    const { x, y } = new DOMPoint(event.clientX, event.clientY).matrixTransform(drawing.getScreenCTM().inverse());
    const s = this.s;
    const groove = clamp(Math.round(Math.atan2(x, -y) / (s.span / s.n) + (s.n + 1) / 2), 1, s.n);
    return { groove, offset: Math.hypot(x, y) - s.contact };
  }

  listen(drawing) {
    let from = null;
    let moved = false;
    draggable(drawing, {
      start: (event) => {
        const { groove, offset } = this.nearest(drawing, event);
        // Away from grooves and numbers a finger scrolls the page.
        if (offset > 4 * this.s.pin + 2 * this.s.rope || offset < this.s.inner - this.s.contact) return false;
        from = groove;
        moved = false;
        return true;
      },
      move: (event) => {
        const { groove } = this.nearest(drawing, event);
        moved ||= groove !== from;
        if (!moved || !this.pins().includes(from)) return;
        const [x, y] = point(this.s.contact, this.angle(groove, this.s));
        for (const [name, value] of Object.entries({ cx: x, cy: y, visibility: 'visible' })) this.draggedPin.setAttribute(name, value);
        this.marks[from - 1].classList.add('dragging');
      },
      end: (event, cancelled) => {
        this.draggedPin.setAttribute('visibility', 'hidden');
        this.marks[from - 1]?.classList.remove('dragging');
        const { groove, offset } = this.nearest(drawing, event);
        // A finger that leaves the grooves was a swipe.
        const isAway = Math.abs(offset) > 4 * this.s.pin + 2 * this.s.rope;
        if (cancelled || (event.pointerType === 'touch' && isAway)) return;
        this.focused = groove;
        if (!moved) this.toggle(groove); else this.move(from, groove);
      },
    });
    drawing.addEventListener('keydown', (event) => this.key(event));
  }

  key(event) {
    const i = Number(event.target.closest?.('[data-groove]')?.dataset.groove);
    if (!i || event.ctrlKey || event.metaKey || event.altKey) return;
    const step = { ArrowLeft: -1, ArrowDown: -1, ArrowRight: 1, ArrowUp: 1 }[event.key];
    const to = event.key === 'Home' ? 1 : event.key === 'End' ? this.grooves() : clamp(i + (step ?? 0), 1, this.grooves());
    if (event.key === ' ' || event.key === 'Enter') { this.focused = i; this.toggle(i); }
    else if ((event.key === 'Delete' || event.key === 'Backspace') && this.pins().includes(i)) this.toggle(i);
    else if (step && event.shiftKey) {
      if (!this.pins().includes(i)) return;
      // To the next empty groove.
      let free = i + step;
      while (this.pins().includes(free)) free += step;
      this.focused = free >= 1 && free <= this.grooves() ? free : i;
      this.move(i, free, 'pins.moved');
    } else if (step || event.key === 'Home' || event.key === 'End') {
      this.focused = to;
      this.marks.forEach((mark, k) => mark.setAttribute('tabindex', k + 1 === to ? 0 : -1));
      this.marks[to - 1].focus();
    } else return;
    event.preventDefault();
  }
}
