//! The rigid shell: a grooved sector of an annulus with fastener holes (cad/doc/dimensions.md, "Shell").

use super::label::{Zone, engrave};
use super::sector::Stops;
use super::{Part, Pose, Role, Sector, fastening, offset_error};
use crate::config::ConfigError;
use crate::design::Design;
use pinswitch_solid::profile::Contour;
use pinswitch_solid::solid::{Facing, Solid};

/// Largest fillet of a stop, as a share of its thickness and height: something of its top must stay.
const FILLET_SHARE: f64 = 0.45;

/// Least fillet of a stop on the bed, mm.
const LEAST_FILLET_MM: f64 = 0.05;

/// The shell's face between the layer's ends, without stops.
fn face_sector(design: &Design) -> Sector {
    Sector {
        inner_mm: design.inner_radius_mm(),
        outer_mm: design.shell_radius_mm(),
        half_span_rad: design.half_span_rad(),
        end_shift_mm: design.configuration().segment.end_margin_mm,
    }
}

/// Shell and supports between the axis and the grooves, stops included.
pub(super) fn wall_sector(design: &Design) -> Sector {
    Sector { end_shift_mm: design.shell_end_shift_mm(), ..face_sector(design) }
}

/// The stops that keep the layer from sliding; `None` without.
fn stops(design: &Design) -> Option<Stops> {
    let c = design.configuration();
    let [thickness_mm, height_mm] = design.stops_mm()?;
    let fillet_mm = c.tendon.entry_fillet_mm.min(FILLET_SHARE * thickness_mm.min(height_mm));
    // A chamfer must leave something of it at the bed.
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
    let zone = Zone::between_fasteners(design, design.shell_radius_mm() - c.segment.groove_radius_mm);
    let engraved = engrave(&mut solid, design, &zone, width);
    tops.extend(engraved.rings);
    solid.cap(Facing::Up, top, &tops);
    let mut part = Part::new("shell", Role::Shell, solid, Some(Pose::upright(0.0)));
    part.notes.extend(engraved.note);
    part.engraved = engraved.lines;
    if c.shell.stop_mm > 0.0 && design.stops_mm().is_none() {
        part.notes.push(
            "the stops do not fit and are left out: raise shell.stop_mm or silicone.thickness_mm".to_owned(),
        );
    }
    Ok(part)
}
