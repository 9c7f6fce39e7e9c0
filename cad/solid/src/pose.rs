//! How a body is turned from its own frame into an assembly, about the common axis z.

use crate::mesh::{Mesh, Vector3};

/// A half turn about the y axis, or none, and then a lift along z.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Whether the body is turned half round about the y axis.
    pub flipped: bool,
    /// Height of the body's origin in the assembly, mm.
    pub z_mm: f64,
}

impl Pose {
    /// Lifted by `z_mm`, not turned.
    pub const fn upright(z_mm: f64) -> Self {
        Self { flipped: false, z_mm }
    }

    /// `mesh`, brought from its own frame into the assembly.
    pub fn apply(&self, mesh: Mesh) -> Mesh {
        let turned = if self.flipped { mesh.flipped_about_y() } else { mesh };
        turned.translated(Vector3::new(0.0, 0.0, self.z_mm))
    }
}
