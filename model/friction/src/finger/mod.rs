//! What a switch buys at the system level, as the paper argues it: a finger holds more than its motor pulls.
//!
//! In eccentric use (holding, giving way) friction carries a part of the load: a motor of tension `T` holds `F > T`. In
//! concentric use (pulling) it must overcome the friction. A switch has little friction when light and much when heavy:
//! quick to move, strong to hold.
//!
//! Two quantities say how much, and must not be mixed: the *force difference* `(T_c - T_e)/F`, which is what was measured
//! on human fingers, and the *extra holding* `F/T_e - 1`, about half of it. `model/doc/finger.md` has the definitions, the
//! human figures and every assumption.

mod gains;
mod joint;
mod motor;

pub use gains::{FingerPoint, Gain, MeasuredGain, finger, measured_gains};
pub use joint::{JointCurve, JointPath, JointPathError, JointPoint, over_joint};
pub use motor::MotorSizing;

/// Post-eccentric minus post-concentric force of the human finger as a share of its output force: 9 to 12 % at high load
/// (arXiv:1401.5232, abstract). The reference that the paper names; to be set beside [`FingerPoint::force_difference`].
pub const HUMAN_FORCE_DIFFERENCE: (f64, f64) = (0.09, 0.12);

/// The flexion of the human middle joint at which its force difference is largest, in degrees (Schweizer et al., J.
/// Biomech. 42, 2009, 1856-1861: six cadaver fingers, 40 N on each flexor tendon).
pub const HUMAN_PEAK_JOINT_DEG: f64 = 83.0;

/// The mean force difference there, a fraction (same source).
pub const HUMAN_PEAK_DIFFERENCE: f64 = 0.11;

/// The extra holding `F/T_e - 1` that belongs to a force difference, if both directions have one friction exponent `x`:
/// `exp(x) - 1` with `2 sinh(x)` the difference.
///
/// ```
/// use pinswitch_friction::finger::{HUMAN_FORCE_DIFFERENCE, extra_holding_of};
///
/// let (low, high) = HUMAN_FORCE_DIFFERENCE;
/// let extra = [low, high].map(|d| format!("{:.1} %", 100.0 * extra_holding_of(d)));
/// assert_eq!(extra, ["4.6 %", "6.2 %"], "half of 9 to 12 %");
/// ```
pub fn extra_holding_of(force_difference: f64) -> f64 {
    (force_difference / 2.0).asinh().exp_m1()
}
