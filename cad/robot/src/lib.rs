//! A friction switch for robot simulators.
//!
//! No simulator has friction of a tendon that depends on its tension and direction. This crate writes the tensions of
//! a switch as a table over load and wrap angle ([`Surface`]), and models that use it: a two-link [`Finger`] for
//! MuJoCo and as URDF, and a co-simulation unit of FMI 3.0 ([`fmu_sources`]). A host adds the friction of the table
//! to the simulation; `cad/doc/robots.md` describes the model, and `pinswitch.mujoco` of the Python package is the
//! host for MuJoCo.
//!
//! ```
//! use pinswitch_friction::{Contact, PinPattern, Substrate, predict, published};
//! use pinswitch_robot::{Finger, Surface};
//!
//! let pins = PinPattern::even(3, published::LAYOUTS[1].pitch_rad());
//! let contact = Contact::new(Substrate::Silicone, pins, published::wrap_angle_rad())?;
//! let curve = predict(&contact, &[5.0, 20.0, 49.671]);
//! let surface = Surface::new("three-double", vec![(contact.wrap_rad(), curve)])?;
//! assert!(surface.to_json()?.contains("\"concentric_n\""));
//! let finger = Finger::default();
//! assert!(finger.mjcf(&surface, "switch.json")?.starts_with("<mujoco"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

#![warn(clippy::disallowed_methods)]

mod finger;
mod fmu;
mod surface;

pub use finger::Finger;
pub use fmu::{FMU_LIBRARY, FMU_SOURCE, fmu_sources, zip_fmu};
pub use surface::Surface;
