//! The sheet of one part of a switch.

use super::fits::fits;
use super::words;
use crate::design::Design;
use crate::parts::{Material, Part, Role};
use pinswitch_drafting::{Paper, PartDrawing, Sheet, Terms, TitleBlock};

/// Returns the sheet of `part`, in the orientation of a workshop where that differs from the one in the set. `None` for a
/// part without extent.
pub(super) fn part_sheet(design: &Design, part: &Part, title: &TitleBlock, paper: Paper) -> Option<Sheet> {
    let drawn = part.drawn.as_ref().map(|solid| part.with_solid(solid.clone()));
    let part = drawn.as_ref().unwrap_or(part);
    let is_printed = part.material() == Material::Abs;
    let drawing = PartDrawing {
        chamfer_mm: if is_printed { design.configuration().print.elephant_foot_mm } else { 0.0 },
        half_span_rad: Some(design.half_span_rad()),
        is_cut: !matches!(part.role, Role::Pin { .. }),
        fits: fits(design, part),
        terms: Terms {
            axis: "the pulley's axis".to_owned(),
            pocket: "basin".to_owned(),
            boss: "key".to_owned(),
        },
        engraving: words::engraving(design, part),
        notes: words::notes(design, part),
        legend: words::legend(design, part),
        ..PartDrawing::new(part.name.clone(), &part.solid)
    };
    drawing.sheet(title, paper)
}
