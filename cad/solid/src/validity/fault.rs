//! Faults of meshes.

use serde::Serialize;

use crate::mesh::Point3;

/// A reason why a mesh is invalid: its name, number of occurrences, place and extent.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Fault {
    /// Name of the check that failed.
    pub check: &'static str,
    /// Number of edges, facets, vertices or bodies concerned.
    pub count: usize,
    /// Place of the first or worst occurrence, mm; absent for a fault without a place.
    pub at_mm: Option<[f64; 3]>,
    /// What is wrong, and by how much.
    pub detail: String,
}

impl std::fmt::Display for Fault {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}: {}", self.check, self.detail)?;
        if let Some([x, y, z]) = self.at_mm {
            write!(f, " (at {x:.4} {y:.4} {z:.4} mm)")?;
        }
        Ok(())
    }
}

/// The place of a fault.
pub(super) fn place(point: Point3) -> Option<[f64; 3]> {
    Some(point.coords.into())
}
