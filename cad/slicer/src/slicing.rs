//! Estimates of a whole set: of each part, and of each plate.

use std::fmt::Write as _;

use schemars::JsonSchema;
use serde::Serialize;

use crate::estimate::PrintEstimate;
use crate::run::{PreparedSlicer, SlicerError};
use crate::settings::PrintSettings;
use pinswitch_switch::documents::PrintEntry;
use pinswitch_switch::output::OutputFile;

/// Name of the file of a set that contains a [`Slicing`].
pub const SLICING_FILE: &str = "slicing.json";
/// Name of the file with the slicer's settings.
pub const SETTINGS_FILE: &str = "settings.ini";

/// A file of a set with its estimate.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct SlicedFile {
    /// The file.
    pub file: String,
    /// Its estimate.
    #[serde(flatten)]
    pub estimate: PrintEstimate,
}

/// Time and filament of a set.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Slicing {
    /// Name and version of this file's schema.
    pub schema: &'static str,
    /// The slicer and its version.
    pub slicer: String,
    /// Name of the file with all settings.
    pub settings_file: &'static str,
    /// The settings that differ from the slicer's defaults.
    pub settings: PrintSettings,
    /// Each part, printed alone.
    pub parts: Vec<SlicedFile>,
    /// Each plate.
    pub plates: Vec<SlicedFile>,
    /// The sum over all plates.
    pub total: PrintEstimate,
}

impl Slicing {
    /// Slices the parts (STL) and plates (3MF) of a set. `settings` are those with which `slicer`
    /// was prepared; `before` is called with each file before it is sliced.
    ///
    /// # Errors
    /// The first file that cannot be sliced.
    pub fn new(
        slicer: &PreparedSlicer,
        settings: PrintSettings,
        files: &[OutputFile],
        before: impl Fn(&str),
    ) -> Result<Self, SlicerError> {
        let sliced = |extension: &str| -> Result<Vec<SlicedFile>, SlicerError> {
            let matching = files.iter().filter(|file| file.name.ends_with(extension));
            let estimates = matching.map(|file| {
                before(&file.name);
                let estimate = slicer.slice(&file.name, &file.bytes)?;
                Ok(SlicedFile { file: file.name.clone(), estimate })
            });
            estimates.collect()
        };
        let (parts, plates) = (sliced(".stl")?, sliced(".3mf")?);
        Ok(Self {
            schema: "pinswitch.slicing/1",
            slicer: slicer.version().to_owned(),
            settings_file: SETTINGS_FILE,
            settings,
            total: plates.iter().map(|p| p.estimate).sum(),
            parts,
            plates,
        })
    }

    /// Returns the entry of a manifest.
    pub fn entry(&self) -> PrintEntry {
        let PrintEstimate { print_minutes, filament_g, filament_m } = self.total;
        PrintEntry { of: "plates", slicer: self.slicer.clone(), print_minutes, filament_g, filament_m }
    }

    /// Returns the estimates as a table for a terminal.
    pub fn table(&self) -> String {
        let s = &self.settings;
        let mut text = format!(
            "{}: layers of {} mm, lines of {} mm, {} walls, {} % infill\n",
            self.slicer, s.layer_mm, s.line_mm, s.walls, s.infill_pct
        );
        let total = (self.plates.len() > 1)
            .then(|| SlicedFile { file: "all plates".to_owned(), estimate: self.total });
        for SlicedFile { file, estimate: e } in self.parts.iter().chain(&self.plates).chain(&total) {
            let time = time(e.print_minutes);
            let _ = writeln!(text, "{file:<20} {time:>10} {:>8.2} g {:>7.2} m", e.filament_g, e.filament_m);
        }
        text
    }
}

/// Formats a time in hours and minutes, rounded to minutes.
fn time(minutes: f64) -> String {
    let whole = minutes.round();
    let hours = (whole / 60.0).floor();
    if hours > 0.0 { format!("{hours} h {:02} min", whole - 60.0 * hours) } else { format!("{whole} min") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_rounded_to_minutes() {
        for (minutes, text) in [(0.2, "0 min"), (59.4, "59 min"), (59.6, "1 h 00 min"), (137.2, "2 h 17 min")]
        {
            assert_eq!(time(minutes), text);
        }
    }
}
