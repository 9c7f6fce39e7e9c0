//! From a pin configuration to printable parts with their predicted friction curve.

pub mod cli;
pub mod config;
pub mod design;
pub mod mesh;
pub mod parts;
pub mod profile;
pub mod solid;
pub mod validity;
