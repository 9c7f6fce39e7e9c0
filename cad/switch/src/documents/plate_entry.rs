//! Plates in the manifest.

use schemars::JsonSchema;
use serde::Serialize;

use crate::built::Built;
use crate::plates::plates;

/// A plate to print.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct PlateEntry {
    /// 3MF file.
    pub file: String,
    /// Side of the square bed, mm.
    pub bed_mm: f64,
    /// Parts.
    pub parts: Vec<PlacedPart>,
}

/// A part on a plate.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct PlacedPart {
    /// Name.
    pub name: String,
    /// Distance of the middle of its bounding box from the left edge of the bed, mm.
    pub x_mm: f64,
    /// The same from the front edge, mm.
    pub y_mm: f64,
    /// Whether it is rotated by 90 degrees counter-clockwise from its STL.
    pub is_turned: bool,
}

/// Returns the entries of all plates of a set.
pub fn plate_entries(built: &Built) -> Vec<PlateEntry> {
    let bed_mm = built.design().configuration().print.bed_mm;
    plates(built)
        .iter()
        .map(|plate| PlateEntry {
            file: plate.package(),
            bed_mm,
            // The middle of a written part is over the origin, so its displacement is its position.
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
