//! 3MF (core specification 1.4): packages of named meshes, written and read.

mod archive;
mod build;
mod core_spec;
mod document;
mod error;
mod findings;
mod materials;
mod model;
mod part_name;
mod read;
mod relationships;
mod transform;
mod triangle_sets;
mod value;
mod write;
mod xml;

pub use build::PlacedMesh;
pub use error::ThreeMfReadError;
pub use model::PackagedMesh;
pub use read::{ThreeMf, read_three_mf};
pub use write::{BaseMaterial, Object, Package, ThreeMfError, three_mf};

#[cfg(test)]
mod tests;
