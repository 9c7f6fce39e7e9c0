//! From a pin configuration to printable parts with their predicted friction curve.

pub mod batch;
pub mod calibration_page;
pub mod cli;
pub mod config;
pub mod design;
pub mod formats;
pub mod inverse;
pub mod mesh;
pub mod output;
pub mod page;
pub mod parts;
pub mod profile;
pub mod render;
pub mod scene;
pub mod solid;
pub mod templates;
pub mod validity;
