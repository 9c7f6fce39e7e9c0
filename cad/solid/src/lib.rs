//! Exact solids of lines and arcs at heights, their meshes, the examination of meshes, and files of
//! any solid.
//!
//! The crate does not depend on switches, friction or configurations, and does no input or output:
//! it computes meshes, bytes and faults from numbers and text.
//!
//! | module | content |
//! | --- | --- |
//! | [`profile`] | [`Contour`](profile::Contour): closed contours of exact lines and arcs, and their flattening |
//! | [`solid`] | [`Solid`](solid::Solid): contours at heights with walls and caps, its volume and its mesh |
//! | [`mesh`] | [`Mesh`](mesh::Mesh): indexed triangles |
//! | [`validity`] | [`examine`](validity::examine): faults of a mesh |
//! | [`verification`] | [`verify`](verification::verify): comparison of a mesh with that of a second kernel |
//! | [`files`] | STL, 3MF and GLB from meshes, STEP and DXF from exact solids |
//! | [`render`] | pictures of meshes |
//!
//! ```
//! use pinswitch_solid::files::{StepPart, step_part, stl_bytes};
//! use pinswitch_solid::mesh::Vector3;
//! use pinswitch_solid::profile::{ChordTolerance, Contour, Point2};
//! use pinswitch_solid::solid::Solid;
//! use pinswitch_solid::validity::{Expectation, examine};
//!
//! // A washer. Material is to the left of every contour, so that the hole runs clockwise.
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
//! assert!(step_part(StepPart { name: "washer", solid: &washer }, Vector3::zeros()).contains("CYLINDRICAL_SURFACE"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! `cad/doc/meshes.md` explains why a mesh is valid and what each check proves.
//! `cad/examples/own_part.rs` and `cad/examples/check_stl.rs` are example programs.

#![warn(clippy::disallowed_methods)]

pub mod file_check;
pub mod files;
pub mod mesh;
mod parallel;
pub mod pose;
pub mod profile;
pub mod render;
pub mod solid;
pub mod validity;
pub mod verification;
