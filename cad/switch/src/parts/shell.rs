//! The rigid shell: a grooved sector of an annulus with fastener holes (cad/doc/dimensions.md, "Shell").

use super::label::{Zone, engrave};
use super::{Part, Pose, Role, Sector, holes_at, offset_error};
use crate::config::ConfigError;
use crate::design::Design;
use pinswitch_solid::solid::{Facing, Solid};

/// Shell and supports between the axis and the grooves.
pub(super) fn wall_sector(design: &Design) -> Sector {
    Sector {
        inner_mm: design.inner_radius_mm(),
        outer_mm: design.shell_radius_mm(),
        half_span_rad: design.half_span_rad(),
        end_shift_mm: design.configuration().segment.end_margin_mm,
    }
}

pub(super) fn shell(design: &Design) -> Result<Part, ConfigError> {
    let c = design.configuration();
    let outline = wall_sector(design).grooved(&design.groove_angles_rad(), c.segment.groove_radius_mm);
    let holes = holes_at(
        design.fastener_radius_mm(),
        &design.fastener_angles_rad(),
        c.fasteners.hole_diameter_mm / 2.0,
    );
    let (width, chamfer) = (c.shell.width_mm, c.print.elephant_foot_mm);
    let foot = offset_error("print.elephant_foot_mm");
    let mut solid = Solid::new();
    let (bottom, top) = solid.extrude_chamfered(&outline, 0.0, width, chamfer).map_err(&foot)?;
    let (bottoms, mut tops) = solid.through_holes(&holes, 0.0, width, chamfer).map_err(&foot)?;
    solid.cap(Facing::Down, bottom, &bottoms);
    let zone = Zone::between_fasteners(design, design.shell_radius_mm() - c.segment.groove_radius_mm);
    let engraved = engrave(&mut solid, design, &zone, width);
    tops.extend(engraved.rings);
    solid.cap(Facing::Up, top, &tops);
    let mut part = Part::new("shell", Role::Shell, solid, Some(Pose::upright(0.0)));
    part.notes.extend(engraved.note);
    Ok(part)
}
