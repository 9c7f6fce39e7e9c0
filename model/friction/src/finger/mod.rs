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

/// The extra holding `F/T_e - 1` that belongs to a force difference, if both directions have one friction exponent `x`:
/// `exp(x) - 1` with `2 sinh(x)` the difference.
///
/// ```
/// use pinswitch_friction::finger::extra_holding_of;
/// use pinswitch_friction::published;
///
/// let (low, high) = published::HUMAN_FORCE_DIFFERENCE;
/// let extra = [low, high].map(|d| format!("{:.1} %", 100.0 * extra_holding_of(d)));
/// assert_eq!(extra, ["4.6 %", "6.2 %"], "half of 9 to 12 %");
/// ```
pub fn extra_holding_of(force_difference: f64) -> f64 {
    libm::expm1((force_difference / 2.0).asinh())
}
