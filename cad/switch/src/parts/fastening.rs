//! Holes for screws, nuts, heads, inserts and dowels in shell and plates (cad/doc/dimensions.md, "Fasteners").

use super::holes_at;
use crate::design::{Design, Recess};
use pinswitch_solid::profile::{Contour, OffsetError, Point2, Vector2, polar};
use pinswitch_solid::solid::{Facing, RingId, Solid};

/// Rings at the bottom and at the top of a part, which are holes in its caps.
pub(super) type Mouths = (Vec<RingId>, Vec<RingId>);

/// Clearance holes for the screws, clockwise.
fn clearance_holes(design: &Design) -> Vec<Contour> {
    let radius = design.configuration().fasteners.hole_diameter_mm / 2.0;
    holes_at(design.fastener_radius_mm(), &design.fastener_angles_rad(), radius)
}

/// Holes for dowels, clockwise.
pub(super) fn dowel_holes(design: &Design) -> Vec<Contour> {
    let radius = design.dowel_hole_radius_mm().unwrap_or_default();
    holes_at(design.fastener_radius_mm(), &design.dowel_angles_rad(), radius)
}

/// Adds the holes of the shell: clearance holes, or holes for inserts at both ends with a narrower hole for the tips of the
/// screws between them.
pub(super) fn shell_holes(solid: &mut Solid, design: &Design) -> Result<Mouths, OffsetError> {
    let c = design.configuration();
    let (width, chamfer) = (c.shell.width_mm, c.print.elephant_foot_mm);
    let narrow = clearance_holes(design);
    let Some([bore, length]) = design.fastening().insert_mm else {
        return solid.through_holes(&narrow, 0.0, width, chamfer);
    };
    let wide = holes_at(design.fastener_radius_mm(), &design.fastener_angles_rad(), bore / 2.0);
    let mut mouths = Mouths::default();
    for (wide, narrow) in wide.iter().zip(&narrow) {
        let (bottom, ceiling) = solid.extrude_chamfered(wide, 0.0, length, chamfer)?;
        let (foot, head) = solid.extrude(narrow, length, width - length);
        let (floor, top) = solid.extrude(wide, width - length, width);
        solid.cap(Facing::Down, ceiling, &[foot]);
        solid.cap(Facing::Up, floor, &[head]);
        mouths.0.push(bottom);
        mouths.1.push(top);
    }
    Ok(mouths)
}

/// Adds the holes of a plate with its outer face on the bed: clearance holes, or blind holes above a recess. The membrane
/// between both is printed as a bridge, and the screw breaks it.
pub(super) fn plate_holes(
    solid: &mut Solid,
    design: &Design,
    recess: Option<Recess>,
    plate_mm: f64,
) -> Result<Mouths, OffsetError> {
    let print = &design.configuration().print;
    let holes = clearance_holes(design);
    let Some(recess) = recess else {
        return solid.through_holes(&holes, 0.0, plate_mm, print.elephant_foot_mm);
    };
    let mut mouths = Mouths::default();
    for (angle, hole) in design.fastener_angles_rad().into_iter().zip(&holes) {
        // The right plate is a mirror image. Its holes are symmetric.
        let outline = outline(&recess, polar(design.fastener_radius_mm(), angle), angle);
        add_seated(&mut mouths, solid, design, [&outline, hole], recess.depth_mm, plate_mm);
    }
    Ok(mouths)
}

/// Adds a hole of a plate at `middle` above a recess in its outer face.
pub(super) fn seated_hole(
    mouths: &mut Mouths,
    solid: &mut Solid,
    design: &Design,
    hole: &Contour,
    (middle, recess): (Point2, Recess),
    plate_mm: f64,
) {
    let outline = outline(&recess, middle, 0.0);
    add_seated(mouths, solid, design, [&outline, hole], recess.depth_mm, plate_mm);
}

fn add_seated(
    mouths: &mut Mouths,
    solid: &mut Solid,
    design: &Design,
    [outline, hole]: [&Contour; 2],
    depth_mm: f64,
    plate_mm: f64,
) {
    mouths.0.push(solid.recess(outline, &[], 0.0, depth_mm));
    mouths.1.push(solid.pocket(hole, &[], depth_mm + design.membrane_mm(), plate_mm));
}

/// The outline of a recess, clockwise. A hexagon has two flats square to the direction at `angle_rad`.
fn outline(recess: &Recess, middle: Point2, angle_rad: f64) -> Contour {
    if !recess.is_hexagon {
        return Contour::circle(middle, recess.radial_mm).reversed();
    }
    let up = polar(1.0, angle_rad).coords;
    let right = Vector2::new(up.y, -up.x);
    let corner =
        |x: f64, y: f64| -> Point2 { middle + right * (x * recess.along_mm) + up * (y * recess.radial_mm) };
    Contour::polygon(
        [(1.0, 0.0), (0.5, -1.0), (-0.5, -1.0), (-1.0, 0.0), (-0.5, 1.0), (0.5, 1.0)]
            .map(|(x, y)| corner(x, y))
            .to_vec(),
    )
}
