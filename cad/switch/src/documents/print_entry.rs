//! What a slicer said of a set, in the manifest: only where one was asked.

use serde::Serialize;

/// Time and filament to print a set.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PrintEntry {
    /// What was sliced: `plates`, all of them, or `parts`, each alone.
    pub of: &'static str,
    /// The slicer and its version.
    pub slicer: String,
    /// Time, minutes.
    pub print_minutes: f64,
    /// Filament, g.
    pub filament_g: f64,
    /// Filament, m.
    pub filament_m: f64,
}
