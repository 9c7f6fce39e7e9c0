//! The sheet of one part of a switch.

use super::fits::fits;
use super::words;
use crate::design::Design;
use crate::parts::{Part, Role, Substance};
use pinswitch_drafting::{Fits, Paper, PartDrawing, Sheet, Terms, TitleBlock};
use pinswitch_solid::profile::{Edge, Point2};
use pinswitch_solid::solid::Solid;

/// Angles that differ by less are equal, rad.
const SAME_RAD: f64 = 1e-9;

/// Returns the sheet of `part`, in the orientation of a workshop where that differs from the one in the set. `None` for a
/// part without extent.
pub(super) fn part_sheet(design: &Design, part: &Part, title: &TitleBlock, paper: Paper) -> Option<Sheet> {
    let (solid, turn_rad) = drawn_solid(part);
    let drawn = part.with_solid(solid);
    // The fits of a plate are in the frame of the assembly, and turn with it.
    let fits = rotated(fits(design, if turn_rad == 0.0 { &drawn } else { part }), turn_rad);
    let part = &drawn;
    let is_printed = part.material() == Substance::Plastic;
    let drawing = PartDrawing {
        chamfer_mm: if is_printed { design.configuration().print.elephant_foot_mm } else { 0.0 },
        half_span_rad: Some(design.half_span_rad()),
        is_cut: !matches!(part.role, Role::Pin { .. }),
        fits,
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

/// Returns the solid as its sheet shows it, with the angle in radians by which it is rotated about the axis: a plate is
/// square to the paper.
pub(super) fn drawn_solid(part: &Part) -> (Solid, f64) {
    if let Some(solid) = &part.drawn {
        return (solid.clone(), 0.0);
    }
    let turn_rad = if part.role == Role::Mount { inclination_rad(&part.solid) } else { 0.0 };
    if turn_rad.abs() < SAME_RAD {
        (part.solid.clone(), 0.0)
    } else {
        (part.solid.rotated(turn_rad), turn_rad)
    }
}

/// Returns the rotation after which the longest side of the outline is along x, from minus to plus a right angle.
fn inclination_rad(solid: &Solid) -> f64 {
    let outline =
        solid.rings().map(|(contour, _)| contour).max_by(|a, b| a.area_mm2().total_cmp(&b.area_mm2()));
    let sides = outline.into_iter().flat_map(|contour| {
        let is_line = |i: &usize| matches!(contour.edges()[*i], Edge::Line);
        (0..contour.edges().len()).filter(is_line).map(|i| contour.ends(i))
    });
    let longest = sides.max_by(|a, b| (a.1 - a.0).norm().total_cmp(&(b.1 - b.0).norm()));
    longest.map_or(0.0, |(from, to)| {
        let along = if to.x < from.x { from - to } else { to - from };
        -libm::atan2(along.y, along.x)
    })
}

/// Returns the fits of a part that is rotated about the axis.
fn rotated(mut fits: Fits, angle_rad: f64) -> Fits {
    if angle_rad == 0.0 {
        return fits;
    }
    let (c, s) = (libm::cos(angle_rad), libm::sin(angle_rad));
    let centres = fits.holes.iter_mut().chain(&mut fits.bosses).filter_map(|fit| fit.centre.as_mut());
    centres.for_each(|p| *p = Point2::new(c * p.x - s * p.y, s * p.x + c * p.y));
    fits
}
