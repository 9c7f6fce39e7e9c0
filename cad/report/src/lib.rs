//! Figures of friction curves, layouts and calibrations, and the HTML pages of a calibration.
//!
//! The crate does no input or output and uses no solids: each function returns the text of an SVG
//! or HTML file. A figure has the same bytes on every platform.
//!
//! | function | result |
//! | --- | --- |
//! | [`friction_svg`] | friction over load with band, limits, other laws and published measurements |
//! | [`contact_svg`] | gap between tendon and silicone along the wrap |
//! | [`finger_svg`] | force difference of a finger over load and joint angle |
//! | [`pareto_svg`] | threshold and friction of searched layouts, with the Pareto front |
//! | [`log_svg`] | a raw log with its moves and plateaus |
//! | [`plots`], [`page`] | figures and page of a [calibration](pinswitch_calibration::Calibration) |
//! | [`friction_words`], [`reported_clause`], [`effect_clause`], [`constants_words`] | friction and effects in words |
//! | [`published_plot`], [`published_page`] | figure and page of the calibration with the paper's seven maxima |
//! | [`run_sheet`] | the runs of a proposed experiment, to print |
//! | [`rig`] | bill, files, run sheet and wiring of a test rig |
//!
//! [`html`] contains the parts of pages that other crates share: templates, escapes and the
//! Content-Security-Policy.
//!
//! # Examples
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
//!
//! Layouts of a design search, with the Pareto front and the target region:
//!
//! ```
//! use pinswitch_friction::layout_search::LayoutCandidate;
//! use pinswitch_report::{TargetRegion, pareto_svg};
//!
//! let layout = |threshold_n: f64, friction_n| LayoutCandidate {
//!     pins: vec![5, 8],
//!     threshold_n: Some(threshold_n),
//!     friction_n,
//! };
//! let layouts = [layout(10.0, 5.0), layout(20.0, 4.0)];
//! let region = TargetRegion { threshold_n: (15.0, f64::INFINITY), friction_n: (0.0, 6.0) };
//! let svg = pareto_svg(&layouts, &layouts[1..], Some(region))?;
//! assert!(svg.contains("higher threshold, less friction"));
//! # Ok::<(), pinswitch_report::PlotError>(())
//! ```

#![warn(clippy::disallowed_methods)]

mod calibration;
mod calibration_files;
mod calibration_page;
mod contact;
mod data_package;
mod effect_words;
mod finger;
mod friction;
pub mod html;
mod legend;
mod log;
mod pareto;
mod pareto_front;
mod plot_error;
mod published_page;
pub mod rig;
mod run_sheet;
mod scale;
mod text_size;

pub use calibration::{Plot, plots};
pub use calibration_files::{FORM_FILE, FORM_HEADER, calibration_files};
pub use calibration_page::page;
pub use contact::contact_svg;
pub use data_package::{DATA_PACKAGE, data_package};
pub use effect_words::{
    constants_words, effect_clause, estimate_words, friction_words, other_probabilities, parameters_words,
    reported_clause,
};
pub use finger::{FingerLayout, finger_svg};
pub use friction::friction_svg;
pub use log::log_svg;
pub use pareto::{TargetRegion, pareto_svg};
pub use plot_error::PlotError;
pub use published_page::{UNEXPLAINED, published_page, published_plot};
pub use run_sheet::run_sheet;
pub use scale::{drawable, drawn_size, fine, shown_at_size};
