//! Print time and filament in the manifest of a sliced set.

use schemars::JsonSchema;
use serde::Serialize;

/// Time and filament to print a set, by a slicer.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct PrintEntry {
    /// `plates` if all plates were sliced, `parts` if each part was sliced alone.
    pub of: &'static str,
    /// Slicer and version.
    pub slicer: String,
    /// Print time, minutes.
    pub print_minutes: f64,
    /// Filament, g.
    pub filament_g: f64,
    /// Filament, m.
    pub filament_m: f64,
}
