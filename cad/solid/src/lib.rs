//! Exact solids of lines and arcs at heights, their meshes, what makes a mesh valid, and the files of any solid.
//!
//! It knows nothing of switches, friction or configurations, and does no input or output: numbers and text go in, and
//! meshes, bytes and findings come out.
//!
//! [`profile`] → [`solid`] → [`mesh`] → [`validity`] → [`files`]: an exact contour of lines and arcs becomes contours at
//! heights with walls and caps, these a mesh within a chord tolerance, and the mesh is examined before it is written.
//! STEP and DXF come from the exact solid.
//!
//! ```
//! use pinswitch_solid::files::{StepPart, step_part, stl_bytes};
//! use pinswitch_solid::profile::{ChordTolerance, Contour, Point2};
//! use pinswitch_solid::solid::Solid;
//! use pinswitch_solid::validity::{Expectation, examine};
//!
//! // A washer: material lies to the left of every contour, so the hole runs clockwise.
//! let outline = Contour::circle(Point2::origin(), 8.0);
//! let hole = Contour::circle(Point2::origin(), 4.2).reversed();
//! let washer = Solid::prism(&outline, &[hole], 0.0, 1.6, 0.0)?;
//! let mesh = washer.mesh(ChordTolerance::new(0.01)?)?;
//!
//! // Flattened arcs keep their area: the mesh has the exact volume.
//! let exact_mm3 = std::f64::consts::PI * (8.0 * 8.0 - 4.2 * 4.2) * 1.6;
//! let expected =
//!     Expectation { bodies: Some(1), volume_mm3: Some((exact_mm3, 1e-6)), ..Expectation::default() };
//! assert!(examine(&mesh, &expected).is_valid());
//!
//! let stl = stl_bytes(&mesh)?;
//! assert_eq!(stl.len(), 84 + 50 * mesh.triangles.len());
//! assert!(step_part(StepPart { name: "washer", solid: &washer }).contains("CYLINDRICAL_SURFACE"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! `cad/doc/meshes.md` explains why a mesh is valid, and what each check proves; `cad/examples/own_part.rs` and
//! `cad/examples/check_stl.rs` are programs to start from.

#![warn(clippy::disallowed_methods)]

pub mod files;
pub mod mesh;
mod parallel;
pub mod pose;
pub mod profile;
pub mod render;
pub mod solid;
pub mod validity;
