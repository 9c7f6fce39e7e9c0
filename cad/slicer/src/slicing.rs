//! What a whole set takes: each part by itself, and each plate.

use std::fmt::Write as _;

use serde::Serialize;

use crate::estimate::PrintEstimate;
use crate::run::{PreparedSlicer, SlicerError};
use crate::settings::PrintSettings;
use pinswitch_switch::documents::PrintEntry;
use pinswitch_switch::output::OutputFile;

/// Name of the file of a set that holds a [`Slicing`].
pub const SLICING_FILE: &str = "slicing.json";
/// Name of the slicer's settings beside it.
pub const SETTINGS_FILE: &str = "settings.ini";

/// A file of a set with what it takes to print.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SlicedFile {
    /// The file.
    pub file: String,
    /// What it takes.
    #[serde(flatten)]
    pub estimate: PrintEstimate,
}

/// What a set takes to print.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Slicing {
    /// Name and version of this file's schema.
    pub schema: &'static str,
    /// The slicer and its version.
    pub slicer: String,
    /// Its settings, as it wrote them.
    pub settings_file: &'static str,
    /// What it was told of them; the rest is its own default.
    pub settings: PrintSettings,
    /// Each part, printed alone.
    pub parts: Vec<SlicedFile>,
    /// Each plate, printed as it is.
    pub plates: Vec<SlicedFile>,
    /// All plates.
    pub total: PrintEstimate,
}

impl Slicing {
    /// Slices the parts (STL) and plates (3MF) of a set; `settings` are those that `slicer` was prepared with, and `begun`
    /// hears of each file before it is sliced.
    ///
    /// # Errors
    /// [`SlicerError`] names the first file that was not sliced.
    pub fn new(
        slicer: &PreparedSlicer,
        settings: PrintSettings,
        files: &[OutputFile],
        begun: impl Fn(&str),
    ) -> Result<Self, SlicerError> {
        let sliced = |extension: &str| -> Result<Vec<SlicedFile>, SlicerError> {
            let wanted = files.iter().filter(|file| file.name.ends_with(extension));
            let each = wanted.map(|file| {
                begun(&file.name);
                let estimate = slicer.slice(&file.name, &file.bytes)?;
                Ok(SlicedFile { file: file.name.clone(), estimate })
            });
            each.collect()
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

    /// What a manifest says of it.
    pub fn entry(&self) -> PrintEntry {
        let PrintEstimate { print_minutes, filament_g, filament_m } = self.total;
        PrintEntry { of: "plates", slicer: self.slicer.clone(), print_minutes, filament_g, filament_m }
    }

    /// The table that a person reads.
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

/// A time in hours and minutes, rounded to minutes.
fn time(minutes: f64) -> String {
    let whole = minutes.round();
    let hours = (whole / 60.0).floor();
    if hours > 0.0 { format!("{hours} h {:02} min", whole - 60.0 * hours) } else { format!("{whole} min") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_hours_and_minutes() {
        for (minutes, text) in [(0.2, "0 min"), (59.4, "59 min"), (59.6, "1 h 00 min"), (137.2, "2 h 17 min")]
        {
            assert_eq!(time(minutes), text);
        }
    }
}
