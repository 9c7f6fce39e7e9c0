//! Examination of meshes: whether a mesh is a valid, printable solid, and if not, what is wrong,
//! where and by how much.
//!
//! The generator, the tests and `pinswitch check` all use [`examine`]. Nothing is repaired.

mod budget;
mod bvh;
mod closed_fan;
mod components;
mod connectivity;
mod cracks;
mod distance;
mod edge_manifold;
mod examine;
mod facets;
mod fault;
mod hub;
mod occurrences;
mod one_ring;
mod overlap;
mod plane;
mod self_intersection;
mod slivers;
mod triangle_intersection;
mod vertex_manifold;
mod wall_thickness;

pub use budget::Allowance;
pub(crate) use connectivity::is_closed;
pub(crate) use distance::largest_distance;
pub use examine::{Examination, Expectation, Incomplete, MeshFacts, examine, examine_within};
pub use fault::{Fault, Level};
pub use overlap::shared_place;

#[cfg(test)]
mod brute_force;
#[cfg(test)]
mod tests;
