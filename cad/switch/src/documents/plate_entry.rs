//! What the manifest says of a plate: its file, and which part lies where.

use serde::Serialize;

use crate::built::Built;
use crate::plates::plates;

/// A plate to print.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PlateEntry {
    /// Its 3MF.
    pub file: String,
    /// Side of the square bed, mm.
    pub bed_mm: f64,
    /// Its parts.
    pub parts: Vec<PlacedPart>,
}

/// A part on a plate.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PlacedPart {
    /// Its name.
    pub name: String,
    /// The middle of its bounding box, from the bed's left edge, mm.
    pub x_mm: f64,
    /// The same from the bed's front edge, mm.
    pub y_mm: f64,
    /// Whether it is turned by a quarter, counter-clockwise, against its STL.
    pub is_turned: bool,
}

/// The entries of all plates of a set.
pub fn plate_entries(built: &Built) -> Vec<PlateEntry> {
    let bed_mm = built.design().configuration().print.bed_mm;
    plates(built)
        .iter()
        .map(|plate| PlateEntry {
            file: plate.package(),
            bed_mm,
            // The middle of a part as it is written lies over the origin: its displacement is its place.
            parts: plate
                .parts
                .iter()
                .map(|(part, place)| PlacedPart {
                    name: part.part().name.clone(),
                    x_mm: place.shift.x,
                    y_mm: place.shift.y,
                    is_turned: place.is_turned,
                })
                .collect(),
        })
        .collect()
}
