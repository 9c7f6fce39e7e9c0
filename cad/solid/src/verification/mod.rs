//! Verification of meshes by a second geometry kernel.
//!
//! A second kernel builds the same exact solid with its own curves, surfaces and tessellation.
//! [`verify`] compares its mesh with ours: both must be closed, and their volumes, areas, bounding
//! boxes and surfaces must agree within limits that follow from the chord tolerance
//! (`cad/doc/meshes.md`, "Second kernel"). It protects against errors in this crate's flattening,
//! walls and caps, which an examination of the mesh alone cannot detect.
//!
//! With the feature `truck`, [`second_kernel`] is truck-modeling.
//!
//! ```
//! use pinswitch_solid::profile::{ChordTolerance, Contour, Point2};
//! use pinswitch_solid::solid::Solid;
//! use pinswitch_solid::verification::{second_kernel, verify};
//!
//! let disc = Solid::prism(&Contour::circle(Point2::origin(), 5.0), &[], 0.0, 2.0, 0.0)?;
//! let tolerance = ChordTolerance::new(0.01)?;
//! let mesh = disc.mesh(tolerance)?;
//! // `None` in a build without the feature `truck`.
//! if let Some(kernel) = second_kernel() {
//!     let verification = verify(&disc, &mesh, tolerance, kernel)?;
//!     assert!(verification.closed && verification.volume_relative < verification.volume_limit);
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod compare;
mod kernel;
mod limits;
#[cfg(feature = "truck")]
mod truck;

pub use compare::{Quantity, Verification, VerificationError, verify};
pub use kernel::{Kernel, KernelError};

/// Returns the second kernel of this build: truck-modeling with the feature `truck`, otherwise
/// none.
pub const fn second_kernel() -> Option<Kernel> {
    #[cfg(feature = "truck")]
    return Some(Kernel::new("truck-modeling", truck::mesh));
    #[cfg(not(feature = "truck"))]
    return None;
}

#[cfg(test)]
mod tests;
