//! 3MF (core specification 1.4): packages of named meshes, written and read.

mod read;
mod vocabulary;
mod write;

pub use read::{PackagedMesh, ThreeMf, ThreeMfReadError, read_three_mf};
pub use write::{BaseMaterial, Object, Package, ThreeMfError, three_mf};

/// Namespace of the core specification.
const CORE: &str = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02";
/// Namespace of our own metadata.
const OWN: &str = "urn:pinswitch:configuration:1";
/// Relationship to the model.
const MODEL_TYPE: &str = "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel";
