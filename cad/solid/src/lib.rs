//! Exact solids of lines and arcs at heights, their meshes, what makes a mesh valid, and the files of any solid.
//!
//! It knows nothing of switches, friction or configurations, and does no input or output: numbers and text go in, and
//! meshes, bytes and findings come out.

pub mod files;
pub mod mesh;
mod parallel;
pub mod pose;
pub mod profile;
pub mod render;
pub mod solid;
pub mod validity;
