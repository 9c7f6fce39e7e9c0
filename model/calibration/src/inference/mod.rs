//! From a table to the effects it shows: forward model, noise, fits, scores and selection.
//!
//! How the steps hang together, and how well they work, stands in `model/doc/naming-an-effect.md`.

mod against_scatter;
mod averaged_intervals;
mod baseline;
mod compaction;
mod correlation;
mod evidence;
mod explanation;
mod fit;
mod form_tolerance;
mod forward;
mod isolation;
mod lanes;
mod levels;
mod limits;
mod noise;
mod observations;
mod projection;
mod reliability;
mod rivals;
mod screening;
mod search;
mod selection;
mod sign_flips;
mod significance;
mod structure_scores;
mod structures;
mod unnamed;
mod variance_components;
mod visibility;
mod walk;
mod wandering;
mod weighed;

pub use averaged_intervals::averaged_intervals;
pub(crate) use compaction::MOST_ROWS;
pub(crate) use fit::jacobian;
pub use fit::{Fit, coordinate_covariance, fit, interval_half_widths, prediction_sd_n};
pub use forward::{Model, Term, UNATTRIBUTED};
pub(crate) use isolation::cell_deviation;
pub use levels::Levels;
pub use limits::{ALIKE, CONSEQUENCE, SizeLimit};
pub use noise::{Noise, Spread};
pub use observations::{Observations, Turn};
pub use reliability::NoiseFactors;
pub(crate) use reliability::Reliability;
pub(crate) use screening::{EffectScore, Screen};
pub(crate) use selection::selected_model;
pub use selection::{CandidateEffect, FoundEffect, Rival, Selection, select};
pub(crate) use significance::gain_at;
pub use significance::{degrees_of_freedom, family_p_value};
pub use unnamed::FoundStructure;
pub use visibility::{VISIBLE, expected_gain, probability_found, probability_structure_found};
pub use walk::Wandering;
pub use weighed::Weighed;
