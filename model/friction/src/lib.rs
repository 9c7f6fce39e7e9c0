//! Friction of a pin switch: what the tendon lies on, the laws that predict its friction, and the numbers published
//! about it. The crate knows contacts and forces; it must not know measured tables, effects, parts or files.
//!
//! A tendon runs over steel pins that lie in silicone on a rigid shell. At low load it touches the pins only; as load
//! grows they sink, it meets the silicone, and friction rises. A [`Contact`] says what the tendon lies on: a
//! [`Substrate`], a [`PinPattern`] and the wrap angle. A [`Law`] turns it into a [`FrictionCurve`], which always
//! carries its band, its law and a word on how far to trust it ([`PredictionStatus`]).
//!
//! ```
//! use pinswitch_friction::{Contact, PinPattern, Substrate, predict, published};
//!
//! // Three pins, 17.89 degrees apart, on silicone: the paper's "three double" layout.
//! let pitch_rad = 3.0 * published::GROOVE_PITCH_DEG.to_radians();
//! let pins = PinPattern::even(3, pitch_rad);
//! let contact = Contact::new(Substrate::Silicone, pins, published::wrap_angle_rad())?;
//! let curve = predict(&contact, &[published::heaviest_load_n()]);
//! let measured_n = published::LAYOUTS[1].device_max_n;
//! assert!(curve.band_low_n[0] < measured_n && measured_n < curve.band_high_n[0]);
//! # Ok::<(), pinswitch_friction::ContactError>(())
//! ```
//!
//! - [`predict`] takes the one default law, [`predict_by`] takes yours, [`other_laws`] shows the rest beside it; a [`Band`]
//!   says where the uncertainty comes from.
//! - [`Transition`] finds the load at which a curve switches; [`finger`] says what a switch buys in a tendon-driven finger.
//! - [`layout_search`] goes backwards, from a wanted curve to pins.
//! - [`physics`] is the model behind the law of that name; [`published`] holds the paper's numbers.
//!
//! Angles are radians, forces newtons, unless a name says otherwise. Nothing here reads files, clocks or the
//! environment; with the feature `parallel` the sweeps of [`layout_search`] run on all processors, with the same
//! results. `model/doc/friction-laws.md` and `model/doc/physics.md` explain the laws with their sources.

#![warn(clippy::disallowed_methods)]

mod band;
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
mod sort;
mod status;
mod substrate;
mod switch;
mod transfer;
mod transition;
pub mod validation;

pub use band::Band;
pub use band_source::BandSource;
pub use capstan::{Direction, capstan_friction_n, capstan_tension_n};
pub use contact::{Contact, ContactError};
pub use curve::{FrictionCurve, PublishedPoint, published_points};
pub use deviation::Deviation;
pub use law::layout::{LayoutLaw, ThresholdRule};
pub use law::{Law, LawError};
pub use pattern::PinPattern;
pub use plural::pluralise;
pub use prediction::{other_laws, predict, predict_by};
pub use sort::sort_by_number;
pub use status::PredictionStatus;
pub use substrate::Substrate;
pub use switch::{PaperSwitch, Switch, SwitchState};
pub use transfer::Transfer;
pub use transition::Transition;
