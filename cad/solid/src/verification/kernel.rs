//! Geometry kernels.

use crate::mesh::Mesh;
use crate::profile::ChordTolerance;
use crate::solid::Solid;

/// A kernel that cannot rebuild a solid.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{kernel} cannot rebuild the solid: {problem}")]
pub struct KernelError {
    /// Name of the kernel.
    pub kernel: &'static str,
    /// The message of the kernel.
    pub problem: String,
}

/// Builds and tessellates a solid within a chord tolerance.
type Tessellate = fn(&Solid, ChordTolerance) -> Result<Mesh, KernelError>;

/// A geometry kernel that builds and tessellates solids independently of this crate.
///
/// Its curves must be within the chord tolerance of the exact ones where it measures them: in the
/// middle fifth of each chord. Its vertices must be on the exact surface.
#[derive(Clone, Copy, Debug)]
pub struct Kernel {
    name: &'static str,
    tessellate: Tessellate,
}

impl Kernel {
    /// A kernel by its name and its tessellation.
    pub const fn new(name: &'static str, tessellate: Tessellate) -> Self {
        Self { name, tessellate }
    }

    /// Name of the kernel.
    pub const fn name(&self) -> &'static str {
        self.name
    }

    /// Builds and tessellates `solid`.
    ///
    /// # Errors
    /// [`KernelError`] if the kernel refuses the solid or panics on it.
    pub fn mesh(&self, solid: &Solid, tolerance: ChordTolerance) -> Result<Mesh, KernelError> {
        let panicked = |_| KernelError { kernel: self.name, problem: "it panicked".to_owned() };
        std::panic::catch_unwind(|| (self.tessellate)(solid, tolerance)).map_err(panicked)?
    }
}
