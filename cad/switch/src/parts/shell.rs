//! The rigid shell: a grooved sector of an annulus with fastener holes (cad/doc/dimensions.md, "Shell").

use super::label::{EDGE_MM, Zone, engrave, is_left_out};
use super::omission::LeftOut;
use super::sector::Stops;
use super::{Part, Pose, Role, Sector, fastening, offset_error};
use crate::config::ConfigError;
use crate::design::Design;
use pinswitch_solid::profile::Contour;
use pinswitch_solid::solid::{Facing, Solid};

/// Largest fillet of a stop as a share of its thickness and height, so that its top is not empty.
const FILLET_SHARE: f64 = 0.45;
/// Least fillet of a stop on the bed, mm.
const LEAST_FILLET_MM: f64 = 0.05;

/// The sector of the shell between the ends of the layer, without stops.
fn face_sector(design: &Design) -> Sector {
    Sector {
        inner_mm: design.inner_radius_mm(),
        outer_mm: design.shell_radius_mm(),
        half_span_rad: design.half_span_rad(),
        end_shift_mm: design.configuration().segment.end_margin_mm,
    }
}

/// The sector of shell and supports, with stops.
pub(super) fn wall_sector(design: &Design) -> Sector {
    Sector { end_shift_mm: design.shell_end_shift_mm(), ..face_sector(design) }
}

/// The stops at the ends of the layer, if there are any.
fn stops(design: &Design) -> Option<Stops> {
    let c = design.configuration();
    let [thickness_mm, height_mm] = design.stops_mm()?;
    let fillet_mm = c.tendon.entry_fillet_mm.min(FILLET_SHARE * thickness_mm.min(height_mm));
    // The bottom chamfer must not remove it.
    let survives = fillet_mm > c.print.elephant_foot_mm + LEAST_FILLET_MM;
    Some(Stops {
        gap_mm: c.silicone.side_clearance_mm,
        thickness_mm,
        height_mm,
        fillet_mm: if survives { fillet_mm } else { 0.0 },
    })
}

fn outline(design: &Design) -> Contour {
    let (angles, groove) = (design.groove_angles_rad(), design.configuration().segment.groove_radius_mm);
    match stops(design) {
        Some(stops) => face_sector(design).stopped(&angles, groove, &stops),
        None => face_sector(design).grooved(&angles, groove),
    }
}

/// Zones of the label: one line between the holes, or two lines, the outer one first.
fn label_zones(design: &Design) -> [Vec<Zone>; 2] {
    let groove_mm = design.configuration().segment.groove_radius_mm;
    let (inner, outer) = (design.inner_radius_mm(), design.shell_radius_mm() - groove_mm);
    let band = |from, to| Zone::between_holes(design, design.shell_hole_mm(), from, to);
    // Letters keep clear of the edges of their zone, so that two lines share the wall between them.
    let middle = f64::midpoint(inner, outer);
    let (above, below) = (middle - EDGE_MM / 2.0, middle + EDGE_MM / 2.0);
    [band(inner, outer), [band(above, outer), band(inner, below)].concat()]
}

pub(super) fn shell(design: &Design) -> Result<Part, ConfigError> {
    let c = design.configuration();
    let (width, chamfer) = (c.shell.width_mm, c.print.elephant_foot_mm);
    let foot = offset_error("print.elephant_foot_mm");
    let mut solid = Solid::new();
    let (bottom, top) = solid.extrude_chamfered(&outline(design), 0.0, width, chamfer).map_err(&foot)?;
    let (mut bottoms, mut tops) = fastening::shell_holes(&mut solid, design).map_err(&foot)?;
    let dowels = fastening::dowel_holes(design);
    let (dowel_bottoms, dowel_tops) = solid.through_holes(&dowels, 0.0, width, chamfer).map_err(&foot)?;
    bottoms.extend(dowel_bottoms);
    tops.extend(dowel_tops);
    solid.cap(Facing::Down, bottom, &bottoms);
    let engraved = engrave(&mut solid, design, &label_zones(design), width);
    tops.extend(engraved.rings);
    solid.cap(Facing::Up, top, &tops);
    let mut part = Part::new("shell", Role::Shell, solid, Some(Pose::upright(0.0)));
    part.left_out = engraved.left_out;
    part.engraved = engraved.lines;
    part.left_out.extend(has_lost_stops(design).then_some(LeftOut::Stops));
    Ok(part)
}

/// Returns the features that do not fit on the shell.
pub(super) fn left_out(design: &Design) -> Vec<LeftOut> {
    let label = is_left_out(design, &label_zones(design), design.configuration().shell.width_mm);
    let lost = [(label, LeftOut::Label), (has_lost_stops(design), LeftOut::Stops)];
    lost.into_iter().filter_map(|(is_lost, what)| is_lost.then_some(what)).collect()
}

fn has_lost_stops(design: &Design) -> bool {
    design.configuration().shell.stop_mm > 0.0 && design.stops_mm().is_none()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::built::Built;
    use crate::config::{Configuration, assign};
    use crate::parts::label::{broken, sizes_mm};

    /// Between wide holes, the label does not fit on one line.
    #[test]
    fn long_labels_have_two_lines() {
        let mut c = Configuration::default();
        let assignments = [
            "layout.pins=[5, 8, 11]",
            "shell.width_mm=20.0",
            "fasteners.kind=insert",
            "fasteners.hole_diameter_mm=4.5",
            "fasteners.end_distance_mm=4.0",
        ];
        assignments.iter().for_each(|a| assign(&mut c, a).unwrap());
        let design = Design::new(c).unwrap();
        let [one, two] = label_zones(&design);
        assert!(one.len() == 3 && two.len() >= 4, "{one:?}, {two:?}");
        let layout = |zones: &[Zone]| sizes_mm(&design).find_map(|mm| broken(&design, "3x3/5", zones, mm));
        assert!(layout(&one).is_none(), "letters of some size fit on one line");
        assert!(layout(&two).is_some_and(|pieces| pieces.len() > 1));
        let part = shell(&design).unwrap();
        assert_eq!(part.engraved, ["3x3/5"]);
        assert_eq!(part.left_out, []);
        let thin = part.thin_places(&design);
        assert!(thin.iter().all(|place| place.to_mm - place.from_mm > 2.0), "{thin:?}");
        Built::new(design).unwrap();
    }
}
