//! From a pin configuration to printable parts with their predicted friction curve.

pub mod cli;
