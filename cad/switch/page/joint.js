// The joint in the 3D view: a slider and an animation that turn the distal link between its stops.

class JointView {
  // `bend` gets a flexion in degrees.
  constructor(bend) {
    this.bend = bend;
    const ends = () => [this.joint.flexion_deg[0], this.joint.flexion_deg.at(-1)];
    this.motion = new Motion(byId('flex'), (share) => this.turn(ends()[0] + share * (ends()[1] - ends()[0])), () => (this.flexion - ends()[0]) / (ends()[1] - ends()[0]));
    byId('flexion').addEventListener('input', () => { this.motion.stop(); this.turn(Number(byId('flexion').value)); });
  }

  // Shows the controls for a design with a joint. A chosen flexion is kept for a joint with the same stops.
  show({ joint }) {
    const before = this.joint;
    this.joint = joint;
    byId('joint-tools').hidden = !joint;
    if (!joint) { this.motion.stop(); return; }
    const [low, high] = [joint.flexion_deg[0], joint.flexion_deg.at(-1)];
    Object.assign(byId('flexion'), { min: low, max: high });
    const keeps = before && ['assembled_deg', 'flexion_deg'].every((key) => sameValue(before[key], joint[key]));
    if (!keeps) this.motion.stop();
    if (!this.motion.isOn) this.turn(keeps ? this.flexion : joint.assembled_deg);
  }

  turn(flexion) {
    this.flexion = flexion;
    byId('flexion').value = flexion;
    const text = TEXT.flexionText(flexion.toFixed(0), at(this.joint.flexion_deg, this.joint.wrap_deg, flexion).toFixed(0));
    byId('flexion-value').textContent = text;
    byId('flexion').setAttribute('aria-valuetext', text);
    this.bend(flexion);
  }
}
