//! From a table to the effects it shows: forward model, noise, fits, scores and selection.

mod catalogue;
mod fit;
mod forward;
mod noise;
mod observations;
mod projection;
mod screening;
mod selection;
mod sign_flips;

pub use fit::{Fit, coordinate_covariance, fit, interval_half_widths, prediction_sd_n};
pub use forward::{Model, Term};
pub use noise::{Noise, Spread};
pub use observations::Observations;
pub use selection::{Levels, Rival, Selection, select};
