//! The hole table of a part whose holes are dimensioned from each other: names at the holes, and coordinates from the first.

use super::dimension::Dimension;
use super::features::Features;
use super::text::number;
use crate::view::Place;
use crate::{Label, Table};
use pinswitch_solid::profile::Point2;

/// Widths of the columns, mm.
const COLUMNS_MM: [f64; 3] = [14.0, 20.0, 20.0];

/// The letter of a bore, by its number; `None` without a table.
pub(super) fn letter(f: &Features, number: usize) -> Option<String> {
    f.has_hole_table().then(|| {
        let letter = char::from_u32('A' as u32 + number as u32 % 26).unwrap_or('A');
        // AA follows Z.
        letter.to_string().repeat(number / 26 + 1)
    })
}

/// A hole of the table.
struct Hole {
    name: String,
    centre: Point2,
    radius_mm: f64,
}

/// All holes, those of each bore from the left and from below.
fn holes(f: &Features) -> Vec<Hole> {
    let mut all = Vec::new();
    for (i, bore) in f.bores.iter().enumerate() {
        let Some(letter) = letter(f, i) else { continue };
        let mut centres = bore.centres.clone();
        centres.sort_by(|a, b| a.y.total_cmp(&b.y));
        centres.sort_by(|a, b| a.x.total_cmp(&b.x));
        for (k, centre) in centres.iter().enumerate() {
            let name = if centres.len() == 1 { letter.clone() } else { format!("{letter}{}", k + 1) };
            all.push(Hole { name, centre: *centre, radius_mm: bore.reach_mm() });
        }
    }
    all
}

/// The table: X to the right and Y up from the first hole. `None` for a part without one.
pub(super) fn table(f: &Features) -> Option<Table> {
    let all = holes(f);
    let Hole { name: first, centre: origin, .. } = all.first()?;
    let headings = ["Hole".to_owned(), format!("X from {first}"), format!("Y from {first}")];
    let row = |hole: &Hole| {
        vec![hole.name.clone(), number(hole.centre.x - origin.x), number(hole.centre.y - origin.y)]
    };
    Some(Table {
        key: "places of the holes".to_owned(),
        columns: headings.into_iter().zip(COLUMNS_MM).collect(),
        rows: all.iter().map(row).collect(),
        reads_down: true,
    })
}

/// The names next to the holes.
pub(super) fn names(f: &Features, place: &Place) -> Vec<Dimension> {
    holes(f)
        .into_iter()
        .map(|hole| {
            Dimension::label(Label {
                key: format!("name of hole {}", hole.name),
                text: hole.name,
                middle: place.at(hole.centre),
                reach_mm: hole.radius_mm * place.scale,
            })
        })
        .collect()
}
