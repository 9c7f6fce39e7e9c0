//! Figures of friction curves, layouts and calibrations, the page of a calibration, and technical drawings on paper.
//!
//! It knows the friction model, what a calibration found, and paper; it knows no solids, and does no input or output: figures,
//! pages and drawings are returned as text or bytes.
//!
//! ```
//! use pinswitch_friction::{Contact, PinPattern, Substrate, other_laws, predict, published};
//! use pinswitch_report::friction_svg;
//!
//! let pins = PinPattern::even(4, 14f64.to_radians());
//! let contact = Contact::new(Substrate::Silicone, pins, published::wrap_angle_rad())?;
//! let loads_n: Vec<f64> = (1..=10).map(|i| 5.0 * f64::from(i)).collect();
//! let curve = predict(&contact, &loads_n);
//! let others = other_laws(curve.law, &contact, &loads_n);
//! let svg = friction_svg("four pins", &contact, &curve, &others)?;
//! assert!(svg.starts_with("<svg") && svg.contains("four pins"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

#![warn(clippy::disallowed_methods)]

mod calibration;
mod calibration_page;
mod contact;
mod finger;
mod friction;
mod front;
pub mod html;
mod legend;
mod log;
mod pareto;
mod published_page;
mod run_sheet;
mod scale;
mod text_size;

pub use calibration::{Plot, PlotFailure, plots};
pub use calibration_page::page;
pub use contact::contact_svg;
pub use finger::{FingerLayout, finger_svg};
pub use friction::{PlotError, friction_svg};
pub use log::log_svg;
pub use pareto::{AskedRegion, pareto_svg};
pub use published_page::{UNEXPLAINED, published_page, published_plot};
pub use run_sheet::run_sheet;
pub use scale::{drawable, drawn_size, fine, shown_at_size};
