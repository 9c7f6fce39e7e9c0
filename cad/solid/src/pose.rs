//! Poses of bodies in an assembly about the common axis z.

use crate::mesh::{Mesh, Vector3};

/// An optional half turn about the y axis, followed by a translation along z.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Whether the body is rotated by 180 degrees about the y axis.
    pub flipped: bool,
    /// Height of the body's origin in the assembly, mm.
    pub z_mm: f64,
}

impl Pose {
    /// Creates a pose at `z_mm` without rotation.
    pub const fn upright(z_mm: f64) -> Self {
        Self { flipped: false, z_mm }
    }

    /// Returns `mesh`, transformed from its own frame to that of the assembly.
    pub fn apply(&self, mesh: Mesh) -> Mesh {
        let turned = if self.flipped { mesh.flipped_about_y() } else { mesh };
        turned.translated(Vector3::new(0.0, 0.0, self.z_mm))
    }
}
