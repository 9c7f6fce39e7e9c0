//! From a table to the effects it shows: forward model, noise, fits, scores and selection.

mod catalogue;
mod correlation;
mod fit;
mod forward;
mod isolation;
mod noise;
mod observations;
mod own_form;
mod projection;
mod screening;
mod selection;
mod sign_flips;
mod significance;
mod unnamed;

pub use fit::{Fit, coordinate_covariance, fit, interval_half_widths, prediction_sd_n};
pub use forward::{Model, Term};
pub(crate) use isolation::cell_deviation;
pub use noise::{Noise, Spread};
pub use observations::Observations;
pub use selection::{Levels, Rival, Selection, select};
pub use significance::degrees_of_freedom;
pub use significance::family_p_value;
