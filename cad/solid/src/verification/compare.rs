//! Comparison of our mesh with that of a second kernel.

use std::fmt;

use pinswitch_diagnostic::{Diagnostic, codes};
use schemars::JsonSchema;
use serde::Serialize;

use super::kernel::{Kernel, KernelError};
use super::limits::Limits;
use crate::mesh::{Mesh, Point3};
use crate::profile::ChordTolerance;
use crate::solid::Solid;
use crate::validity::{is_closed, largest_distance};

/// The agreement of a mesh with that of a second kernel: differences, and their limits.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Verification {
    /// Name of the kernel.
    pub kernel: &'static str,
    /// Chord tolerance of both meshes, mm.
    pub tolerance_mm: f64,
    /// Whether both meshes are closed and oriented.
    pub closed: bool,
    /// Difference of the volumes over that of the kernel.
    pub volume_relative: f64,
    /// Largest such difference that the chord tolerance allows.
    pub volume_limit: f64,
    /// Difference of the areas over that of the kernel.
    pub area_relative: f64,
    /// Largest such difference that the chord tolerance allows.
    pub area_limit: f64,
    /// Largest difference between coordinates of the bounding boxes, mm.
    pub bounds_mm: f64,
    /// Largest such difference that the chord tolerance allows, mm.
    pub bounds_limit_mm: f64,
    /// Largest distance from a vertex of our mesh to the kernel's surface, and from one of the
    /// kernel to ours, mm.
    pub distance_mm: [f64; 2],
    /// Largest such distances that the chord tolerance allows, mm.
    pub distance_limit_mm: [f64; 2],
}

/// A quantity in which two meshes are compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// Volume, mm³.
    Volume,
    /// Area of the surface, mm².
    Area,
    /// Lower bound of an axis (0 for x), mm.
    LowerBound(usize),
    /// Upper bound of an axis (0 for x), mm.
    UpperBound(usize),
}

impl fmt::Display for Quantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let axis = |i: &usize| ["x", "y", "z"].get(*i).copied().unwrap_or("?");
        match self {
            Self::Volume => f.write_str("volume"),
            Self::Area => f.write_str("surface"),
            Self::LowerBound(i) => write!(f, "lower bound of {}", axis(i)),
            Self::UpperBound(i) => write!(f, "upper bound of {}", axis(i)),
        }
    }
}

impl Quantity {
    const fn unit(self) -> &'static str {
        match self {
            Self::Volume => "mm3",
            Self::Area => "mm2",
            Self::LowerBound(_) | Self::UpperBound(_) => "mm",
        }
    }
}

/// A mesh that a second kernel does not confirm.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum VerificationError {
    /// The kernel cannot rebuild the solid.
    #[error(transparent)]
    Kernel(#[from] KernelError),
    /// A mesh is not closed and oriented, or is empty.
    #[error("the mesh of {of} is not closed")]
    Open {
        /// Name of the kernel, or `pinswitch`.
        of: &'static str,
    },
    /// A quantity differs by more than its limit.
    #[error(
        "{quantity} differs: {ours:.6} {unit} in the mesh, {kernels:.6} {unit} in {kernel}, at most {limit:.6} {unit} apart",
        unit = quantity.unit()
    )]
    Differs {
        /// Name of the kernel.
        kernel: &'static str,
        /// What differs.
        quantity: Quantity,
        /// Its value in our mesh.
        ours: f64,
        /// Its value in the mesh of the kernel.
        kernels: f64,
        /// Largest difference that the chord tolerance allows.
        limit: f64,
    },
    /// A vertex is too far from the surface of the other mesh.
    #[error(
        "surface differs: the vertex of {of} at {at_mm:.4?} mm is {distance_mm:.6} mm from the surface of {from}, at most \
         {limit_mm:.6} mm allowed"
    )]
    Distant {
        /// The mesh of the vertex: name of the kernel, or `pinswitch`.
        of: &'static str,
        /// The other mesh.
        from: &'static str,
        /// Position of the vertex, mm.
        at_mm: [f64; 3],
        /// Distance, mm.
        distance_mm: f64,
        /// Largest distance that the chord tolerance allows, mm.
        limit_mm: f64,
    },
}

impl From<VerificationError> for Diagnostic {
    fn from(error: VerificationError) -> Self {
        Self::new(codes::KERNELS_DISAGREE, error.to_string())
            .with_help("report the configuration: it is an error of pinswitch or of the kernel")
    }
}

/// Name of this program's own mesh in errors.
const OURS: &str = "pinswitch";

/// Rebuilds `solid` with `kernel` and compares its mesh with `mesh`, both within `tolerance`.
///
/// # Errors
/// [`VerificationError`] if the kernel refuses the solid, or if the meshes differ by more than the
/// chord tolerance allows.
pub fn verify(
    solid: &Solid,
    mesh: &Mesh,
    tolerance: ChordTolerance,
    kernel: Kernel,
) -> Result<Verification, VerificationError> {
    let theirs = kernel.mesh(solid, tolerance)?;
    let name = kernel.name();
    for (of, mesh) in [(OURS, mesh), (name, &theirs)] {
        if mesh.triangles.is_empty() || !is_closed(mesh) {
            return Err(VerificationError::Open { of });
        }
    }
    let limits = Limits::new(solid, mesh, tolerance);
    let check = |quantity, ours: f64, kernels: f64, limit: f64| {
        let difference = (ours - kernels).abs();
        // A NaN is a difference, too.
        if difference <= limit {
            Ok(difference)
        } else {
            Err(VerificationError::Differs { kernel: name, quantity, ours, kernels, limit })
        }
    };
    let (volume, area) = (theirs.volume_mm3(), theirs.surface_mm2());
    let volume_mm3 = check(Quantity::Volume, mesh.volume_mm3(), volume, limits.volume_mm3)?;
    let area_mm2 = check(Quantity::Area, mesh.surface_mm2(), area, limits.area_mm2)?;
    let corners = |m: &Mesh| m.bounds().unwrap_or_default();
    let ((low, high), (kernel_low, kernel_high)) = (corners(mesh), corners(&theirs));
    let mut bounds_mm: f64 = 0.0;
    for i in 0..3 {
        let lower = check(Quantity::LowerBound(i), low[i], kernel_low[i], limits.box_mm)?;
        let upper = check(Quantity::UpperBound(i), high[i], kernel_high[i], limits.box_mm)?;
        bounds_mm = bounds_mm.max(lower).max(upper);
    }
    let distance_mm = [
        distance((OURS, mesh), (name, &theirs), limits.ours_mm)?,
        distance((name, &theirs), (OURS, mesh), limits.kernels_mm)?,
    ];
    Ok(Verification {
        kernel: name,
        tolerance_mm: tolerance.mm(),
        closed: true,
        volume_relative: volume_mm3 / volume,
        volume_limit: limits.volume_mm3 / volume,
        area_relative: area_mm2 / area,
        area_limit: limits.area_mm2 / area,
        bounds_mm,
        bounds_limit_mm: limits.box_mm,
        distance_mm,
        distance_limit_mm: [limits.ours_mm, limits.kernels_mm],
    })
}

/// Largest distance from a vertex of one mesh to the surface of the other.
fn distance(
    (of, mesh): (&'static str, &Mesh),
    (from, other): (&'static str, &Mesh),
    limit_mm: f64,
) -> Result<f64, VerificationError> {
    let (distance_mm, at) = largest_distance(mesh, other, limit_mm).unwrap_or((f64::NAN, Point3::origin()));
    if distance_mm <= limit_mm {
        return Ok(distance_mm);
    }
    Err(VerificationError::Distant { of, from, at_mm: at.coords.into(), distance_mm, limit_mm })
}
