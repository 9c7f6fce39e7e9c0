// The joint in the 3D view: a slider and an animation that turn the distal link between its stops.

// Time of the animation from one stop to the other.
const FLEX_MS = 2500;

class JointView {
  // `bend` gets a flexion in degrees.
  constructor(bend) {
    this.bend = bend;
    this.still = matchMedia('(prefers-reduced-motion: reduce)');
    byId('flexion').addEventListener('input', () => { this.stop(); this.turn(Number(byId('flexion').value)); });
    byId('flex').addEventListener('click', () => (this.frame ? this.stop() : this.play()));
    this.still.addEventListener('change', () => this.offer());
    // The animation does not go on where no one sees it.
    document.addEventListener('visibilitychange', () => { if (document.hidden) this.stop(); });
  }

  // Shows the controls for a design with a joint. A chosen flexion is kept for a joint with the same stops.
  show({ joint }) {
    const before = this.joint;
    this.joint = joint;
    byId('joint-tools').hidden = !joint;
    if (!joint) { this.stop(); return; }
    const [low, high] = [joint.flexion_deg[0], joint.flexion_deg.at(-1)];
    Object.assign(byId('flexion'), { min: low, max: high });
    this.offer();
    const keeps = before && ['assembled_deg', 'flexion_deg'].every((key) => sameValue(before[key], joint[key]));
    if (!keeps) this.stop();
    if (!this.frame) this.turn(keeps ? this.flexion : joint.assembled_deg);
  }

  // With reduced motion only the slider turns the link.
  offer() {
    byId('flex').hidden = this.still.matches;
    if (this.still.matches) this.stop();
  }

  turn(flexion) {
    this.flexion = flexion;
    byId('flexion').value = flexion;
    const text = TEXT.flexionText(flexion.toFixed(0), at(this.joint.flexion_deg, this.joint.wrap_deg, flexion).toFixed(0));
    byId('flexion-value').textContent = text;
    byId('flexion').setAttribute('aria-valuetext', text);
    this.bend(flexion);
  }

  // Starts at the present flexion, towards the second stop, and turns back at each stop.
  play() {
    const [low, high] = [this.joint.flexion_deg[0], this.joint.flexion_deg.at(-1)];
    const phase = Math.acos(clamp((low + high - 2 * this.flexion) / (high - low), -1, 1));
    let start;
    const step = (now) => {
      start ??= now;
      const angle = phase + Math.PI * (now - start) / FLEX_MS;
      this.turn((low + high) / 2 - (high - low) / 2 * Math.cos(angle));
      this.frame = requestAnimationFrame(step);
    };
    this.frame = requestAnimationFrame(step);
    byId('flex').setAttribute('aria-pressed', 'true');
  }

  stop() {
    cancelAnimationFrame(this.frame);
    this.frame = undefined;
    byId('flex').setAttribute('aria-pressed', 'false');
  }
}
