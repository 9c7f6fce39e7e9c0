//! Friction of a pin switch: contacts, the laws that predict their friction, and the published
//! measurements.
//!
//! A pin switch is a pulley surface for a tendon: steel pins rest in a silicone layer on a rigid
//! shell. At a light load the tendon touches the pins only. As the load grows, the pins sink, the
//! tendon meets the silicone, and friction rises.
//!
//! # Vocabulary
//!
//! - [`Contact`]: the surface under the tendon: a [`Substrate`], a [`PinPattern`] and a wrap angle,
//!   with the dimensions of a [`physics::Bed`].
//! - [`Law`]: a model of friction. [`predict`] uses the default law, [`predict_by`] a chosen one,
//!   and [`other_laws`] all others for comparison.
//! - [`FrictionCurve`]: tension and friction over load, with the law, a 95 % band and a
//!   [`PredictionStatus`]: published, interpolated or extrapolated.
//! - [`Band`]: the uncertainty of a curve by source, among them each [`Deviation`] from the
//!   published rig.
//! - [`Transition`]: the load at which silicone carries half of the friction.
//! - [`Direction`]: eccentric (load released) or concentric (load pulled).
//!
//! [`finger`] computes the benefit of a switch in a tendon-driven finger, and [`layout_search`]
//! finds pins for a target curve. [`physics`] is the model behind the default law, [`published`]
//! has the numbers of the paper, and [`validation`] compares every law with the published maxima.
//!
//! # Equations
//!
//! All laws relate load and tension by the capstan equation:
//!
//! ```text
//! T_e = F exp(-x_e),    T_c = F exp(x_c),    D = (T_c - T_e)/2
//! ```
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | `F` | load | N |
//! | `T_e`, `T_c` | tension while the load is released, and while it is pulled | N |
//! | `x_e`, `x_c` | friction exponent of that direction; `mu a` on one uniform material | 1 |
//! | `D` | friction | N |
//!
//! The default law computes the exponents from the turn angles of the tendon at the pins and on the
//! silicone:
//!
//! ```text
//! x = sum_i kappa sqrt(T_i theta_i) theta_i + mu_s theta_s,    sum_i theta_i + theta_s = a
//! ```
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | `theta_i`, `T_i` | turn angle and local tension at pin `i` | rad, N |
//! | `theta_s` | turn angle on the silicone | rad |
//! | `a` | wrap angle | rad |
//! | `kappa` | ploughing coefficient of the coating: `mu = kappa sqrt(N)` at a force `N` | N^-0.5 |
//! | `mu_s` | friction coefficient of the tendon on silicone | 1 |
//!
//! # Examples
//!
//! The band of a published layout contains the measured maximum:
//!
//! ```
//! use pinswitch_friction::{Contact, PinPattern, Substrate, predict, published};
//!
//! // Three pins, 17.89 degrees apart, on silicone: the layout three-double of the paper.
//! let pitch_rad = 3.0 * published::GROOVE_PITCH_DEG.to_radians();
//! let pins = PinPattern::even(3, pitch_rad);
//! let contact = Contact::new(Substrate::Silicone, pins, published::wrap_angle_rad())?;
//! let curve = predict(&contact, &[published::heaviest_load_n()]);
//! let measured_n = published::LAYOUTS[1].device_max_n;
//! assert!(curve.band_low_n[0] < measured_n && measured_n < curve.band_high_n[0]);
//! # Ok::<(), pinswitch_friction::ContactError>(())
//! ```
//!
//! More pins support the tendon up to a higher load:
//!
//! ```
//! use pinswitch_friction::{Contact, PinPattern, Substrate, Transition, predict, published};
//!
//! let loads_n: Vec<f64> = (1..=50).map(f64::from).collect();
//! let threshold_n = |pins: PinPattern| {
//!     let contact = Contact::new(Substrate::Silicone, pins, published::wrap_angle_rad()).ok()?;
//!     Transition::of(&predict(&contact, &loads_n)).map(|transition| transition.threshold_n)
//! };
//! let three = threshold_n(PinPattern::even(3, 0.25)).ok_or("no transition")?;
//! let four = threshold_n(PinPattern::even(4, 0.25)).ok_or("no transition")?;
//! assert!(three < four);
//! # Ok::<(), &str>(())
//! ```
//!
//! # Conventions
//!
//! Angles are in radians and forces in newtons, unless a name has another unit. Every error
//! converts into a [`Diagnostic`](pinswitch_diagnostic::Diagnostic).
//!
//! Architecture invariant: the crate has contacts and forces, but does not depend on measured
//! tables, effects, parts or files. It does not read files, clocks or environment variables. With the feature `parallel`,
//! [`layout_search`] uses all processors and gives the same results. `model/doc/friction-laws.md`
//! and `model/doc/physics.md` explain the laws with their sources.

#![warn(clippy::disallowed_methods)]

mod band;
mod band_physics;
mod band_source;
mod bed;
mod capstan;
mod contact;
mod curve;
mod deviation;
pub mod finger;
mod law;
pub mod layout_search;
pub mod least_squares;
mod pattern;
pub mod physics;
mod plural;
mod prediction;
#[cfg(test)]
mod prediction_tests;
pub mod published;
mod reference;
mod sort;
mod status;
mod substrate;
mod switch;
mod transfer;
mod transition;
pub mod validation;

pub use band::Band;
pub use band_physics::BandPhysics;
pub use band_source::{BandSource, NORMAL_95};
pub use capstan::{Direction, capstan_friction_n, capstan_tension_n};
pub use contact::{Contact, ContactError};
pub use curve::{FrictionCurve, PublishedPoint, published_points};
pub use deviation::Deviation;
pub use law::layout::{LayoutLaw, ThresholdRule};
pub use law::{Law, LawError};
pub use pattern::PinPattern;
pub use plural::pluralise;
pub use prediction::{other_laws, other_laws_with_physics, predict, predict_by, predict_with_physics};
pub use sort::sort_by_number;
pub use status::PredictionStatus;
pub use substrate::Substrate;
pub use switch::{PaperSwitch, Switch, SwitchState};
pub use transfer::Transfer;
pub use transition::Transition;
