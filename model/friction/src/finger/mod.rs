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

pub use gains::{FingerPoint, Gain, MeasuredGain, extra_holding_of, finger, measured_gains};
pub use joint::{JointCurve, JointPath, JointPathError, JointPoint, over_joint};
pub use motor::MotorSizing;
