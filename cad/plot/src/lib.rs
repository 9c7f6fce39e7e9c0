//! Figures of friction curves, layouts and calibrations, and the page of a calibration.
//!
//! It knows the friction model and what a calibration found; it knows no geometry, and does no input or output: figures
//! and pages are returned as text.

mod calibration;
mod calibration_page;
mod contact;
mod friction;
mod log;
mod pareto;
mod published_page;
mod scale;

pub use calibration::{Plot, PlotFailure, plots};
pub use calibration_page::page;
pub use contact::contact_svg;
pub use friction::{PlotError, friction_svg};
pub use log::log_svg;
pub use pareto::pareto_svg;
pub use published_page::{UNEXPLAINED, published_page, published_plot};
pub use scale::{drawable, drawn_size, fine, shown_at_size};
