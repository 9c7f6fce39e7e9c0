//! Where the holes of a plate lie that has no axis of its own: named on the sheet, listed in a table, measured from the
//! first of them.

use pinswitch_friction::sort_by_number;

use super::dimensions::Wanted;
use super::features::Features;
use super::words::number;
use pinswitch_drafting::view::Place;
use pinswitch_drafting::{Label, Table};
use pinswitch_solid::profile::Point2;

/// Widths of the columns of the table, mm.
const COLUMNS_MM: [f64; 3] = [14.0, 20.0, 20.0];

/// Whether the holes stand in a table: places about an axis or from the sides of a block are said otherwise.
fn has_table(f: &Features) -> bool {
    f.axis_arcs.is_empty() && f.block.is_none() && !f.is_round_body() && !f.bores.is_empty()
}

/// The letter of the holes with this number among the bores; `None` where there is no table.
pub(super) fn letter(f: &Features, number: usize) -> Option<String> {
    has_table(f).then(|| {
        let letter = char::from_u32('A' as u32 + number as u32 % 26).unwrap_or('A');
        // After Z comes AA.
        letter.to_string().repeat(number / 26 + 1)
    })
}

/// Name and middle of every hole, those of one kind from the left and from below.
fn holes(f: &Features) -> Vec<(String, Point2, f64)> {
    let mut all = Vec::new();
    for (i, bore) in f.bores.iter().enumerate() {
        let Some(letter) = letter(f, i) else { continue };
        let mut centres = bore.centres.clone();
        sort_by_number(&mut centres, |c| c.y);
        sort_by_number(&mut centres, |c| c.x);
        for (k, centre) in centres.iter().enumerate() {
            let name = if centres.len() == 1 { letter.clone() } else { format!("{letter}{}", k + 1) };
            all.push((name, *centre, bore.reach_mm()));
        }
    }
    all
}

/// The table of the holes' places, X to the right and Y up from the first; `None` where they are said otherwise.
pub(super) fn table(f: &Features) -> Option<Table> {
    let all = holes(f);
    let (first, origin, _) = all.first()?;
    let headings = ["Hole".to_owned(), format!("X from {first}"), format!("Y from {first}")];
    let row = |(name, at, _): &(String, Point2, f64)| {
        vec![name.clone(), number(at.x - origin.x), number(at.y - origin.y)]
    };
    Some(Table {
        key: "places of the holes".to_owned(),
        columns: headings.into_iter().zip(COLUMNS_MM).collect(),
        rows: all.iter().map(row).collect(),
        reads_down: true,
    })
}

/// The names beside the holes.
pub(super) fn names(f: &Features, place: &Place) -> Vec<Wanted> {
    holes(f)
        .into_iter()
        .map(|(name, at, reach_mm)| {
            Wanted::label(Label {
                key: format!("name of hole {name}"),
                text: name,
                middle: place.at(at),
                reach_mm: reach_mm * place.scale,
            })
        })
        .collect()
}
