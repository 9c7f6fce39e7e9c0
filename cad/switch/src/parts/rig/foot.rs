//! The feet of the board: a base on the table with a web, through which two bolts pass to the board. They are printed upright,
//! with the bolts vertical.

use super::super::{Part, Pose, Role, offset_error};
use super::layout;
use crate::config::ConfigError;
use crate::design::Design;
use crate::design::rig::{FOOT_BASE_MM, FOOT_DEPTH_MM, FOOT_HEIGHT_MM, FOOT_WEB_MM, FOOT_WIDTH_MM};
use pinswitch_solid::profile::{Contour, Point2};
use pinswitch_solid::solid::Solid;

/// The foot on the side of the load.
pub(in crate::parts) fn left(design: &Design) -> Result<Part, ConfigError> {
    foot(design, 0)
}

/// The foot on the side of the drive.
pub(in crate::parts) fn right(design: &Design) -> Result<Part, ConfigError> {
    foot(design, 1)
}

fn foot(design: &Design, index: usize) -> Result<Part, ConfigError> {
    let c = design.configuration();
    let layout = layout(design)?;
    // Its pose rotates it by 180 degrees about y.
    let x = -layout.feet_x_mm[index];
    let centres: Vec<Point2> =
        layout.foot_bolts[2 * index..2 * index + 2].iter().map(|h| Point2::new(x, h.centre.y)).collect();
    let radius = layout.foot_bolts[0].radius_mm;
    let about = |x: f64, y: f64, centres: &[Point2]| {
        let holes: Vec<Contour> = centres.iter().map(|p| Contour::circle(*p, radius).reversed()).collect();
        Solid::prism(&outline(x, y), &holes, 0.0, FOOT_DEPTH_MM, c.print.elephant_foot_mm)
            .map_err(offset_error("print.elephant_foot_mm"))
    };
    let pose = Pose { flipped: true, z_mm: -c.support.plate_mm - c.mount.plate_mm };
    let name = if index == 0 { "rig-foot-left" } else { "rig-foot-right" };
    let part = Part::new(name, Role::Stand, about(x, layout.table_y_mm, &centres)?, Some(pose));
    let own: Vec<Point2> = centres.iter().map(|p| Point2::new(0.0, p.y - layout.table_y_mm)).collect();
    Ok(Part { drawn: Some(about(0.0, 0.0, &own)?), ..part })
}

/// The outline, with the middle of its lower edge at a point.
fn outline(x: f64, y: f64) -> Contour {
    let (half, web) = (FOOT_WIDTH_MM / 2.0, FOOT_WEB_MM / 2.0);
    let at = |across: f64, up: f64| Point2::new(x + across, y + up);
    Contour::polygon(vec![
        at(-half, 0.0),
        at(half, 0.0),
        at(half, FOOT_BASE_MM),
        at(web, FOOT_BASE_MM),
        at(web, FOOT_HEIGHT_MM),
        at(-web, FOOT_HEIGHT_MM),
        at(-web, FOOT_BASE_MM),
        at(-half, FOOT_BASE_MM),
    ])
}
