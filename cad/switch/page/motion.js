// An animation that a button starts and stops: to and fro between the ends of a range.

// Time from one end to the other.
const MOTION_MS = 2500;

class Motion {
  // `set` gets a share of the range, `now` returns the present one.
  constructor(control, set, now) {
    Object.assign(this, { control, set, now, label: control.textContent });
    this.still = matchMedia('(prefers-reduced-motion: reduce)');
    control.addEventListener('click', () => (this.isOn ? this.stop() : this.start()));
    this.still.addEventListener('change', () => this.offer());
    // It does not go on where no one sees it.
    document.addEventListener('visibilitychange', () => { if (document.hidden) this.stop(); });
    this.offer();
  }

  get isOn() { return this.frame !== undefined; }

  // With reduced motion only the slider moves.
  offer() {
    this.control.hidden = this.still.matches;
    if (this.still.matches) this.stop();
  }

  // Moves from the present share toward the end, and turns at each end; for `duration_ms`, if given, and back to the share.
  start(duration_ms = Infinity) {
    if (this.still.matches) return;
    const share = this.now();
    const phase = Math.acos(clamp(1 - 2 * share, -1, 1));
    let begin;
    const step = (time) => {
      begin ??= time;
      if (time - begin >= duration_ms) { this.stop(); this.set(share); return; }
      this.set((1 - Math.cos(phase + Math.PI * (time - begin) / MOTION_MS)) / 2);
      this.frame = requestAnimationFrame(step);
    };
    this.frame = requestAnimationFrame(step);
    this.show();
  }

  stop() {
    cancelAnimationFrame(this.frame);
    this.frame = undefined;
    this.show();
  }

  show() {
    this.control.setAttribute('aria-pressed', String(this.isOn));
    this.control.textContent = this.isOn ? TEXT.stopMotion : this.label;
  }
}
