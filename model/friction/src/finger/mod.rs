//! Benefit of a switch in a tendon-driven finger: friction supports part of the load, so that the
//! motor can be smaller.
//!
//! In eccentric use (holding, yielding) friction supports part of the load: a motor with a tension
//! `T` supports a load `F > T`. In concentric use (pulling) the motor must overcome the friction. A
//! switch has little friction at light loads, where the finger moves, and much at heavy loads,
//! where it grips.
//!
//! Two quantities measure the benefit. The *force difference* `(T_c - T_e)/F` was measured on human
//! fingers. The *extra holding* `F/T_e - 1` is about half of it. `F` is the load, `T_e` the
//! eccentric and `T_c` the concentric tension. `model/doc/finger.md` has the definitions, the human
//! data and every assumption.

mod gains;
mod joint;
mod motor;

pub use gains::{FingerPoint, Gain, MeasuredGain, extra_holding_of, finger, measured_gains};
pub use joint::{FlexionWrap, JointCurve, JointPath, JointPathError, JointPoint, Wrap, over_joint};
pub use motor::MotorSizing;
