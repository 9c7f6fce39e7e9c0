//! Scenes to render: the assembly, its exploded view, the pictures of steps, and the print plates.

mod bench;
mod illustration;
mod overlay;

use crate::built::{Built, BuiltPart};
use crate::config::MountKind;
use crate::design::Design;
use crate::output::SetError;
use crate::plates::{Plate, plates};
use pinswitch_solid::files::Placement;
use pinswitch_solid::mesh::{Mesh, Point3, Vector3};
use pinswitch_solid::render::{Body, View, render};

pub use bench::{Bench, Bodies, Item};
pub(crate) use bench::{COUPON, CUT_PIN, GUIDE_PULLEY};
pub use illustration::{Illustration, Motion, Move, ToolArrow, Upright};

/// View of the switch with its grooves up, at which the outer face of the left support is visible.
pub const FROM_LEFT: View = View { turn_deg: 38.0, rise_deg: 32.0 };

/// The same from the side of the right support.
pub const FROM_RIGHT: View = View { turn_deg: -FROM_LEFT.turn_deg, ..FROM_LEFT };

/// Returns the view of the complete switch: from the side of the left support, unless a large plate would hide it.
pub fn switch_view(design: &Design) -> View {
    let is_hidden = matches!(design.configuration().mount.kind, MountKind::Rig | MountKind::Flange);
    if is_hidden { FROM_RIGHT } else { FROM_LEFT }
}

/// Rotates a mesh of the assembly so that the pulley's axis is horizontal, from left to right, and the grooves are up.
fn grooves_up(mesh: Mesh) -> Mesh {
    let turned = mesh.positions.iter().map(|p| Point3::new(p.z, p.x, p.y)).collect();
    Mesh::new(turned, mesh.triangles)
}

/// Returns the bodies of the assembly, exploded by `explosion`, from 0 to 1. The pulley's axis is horizontal and the grooves are
/// up, so that engraved text is upright in the view of [`switch_view`].
pub fn assembled(built: &Built, explosion: f64) -> Vec<Body> {
    built
        .assembly()
        .filter_map(|body| {
            let role = body.part.role;
            let placed = body.part.pose?.apply(body.mesh.clone());
            Some(Body {
                mesh: grooves_up(placed.translated(role.explode_offset_mm() * explosion)),
                colour: role.colour(),
            })
        })
        .collect()
}

/// Distance of beds, mm.
const BEDS_APART_MM: f64 = 20.0;
/// Colour of a bed.
const BED_COLOUR: [u8; 3] = [214, 216, 222];

/// Returns the parts of a plate in print orientation.
pub fn plate(plate: &Plate<'_>) -> Vec<Body> {
    let body = |(part, place): &(&BuiltPart, _)| Body {
        mesh: Placement::apply(place, part.print_mesh.clone()),
        colour: part.part().role.colour(),
    };
    plate.parts.iter().map(body).collect()
}

/// Returns all printed parts in print orientation. Several plates are side by side, each on its bed.
pub fn all_plates(built: &Built) -> Vec<Body> {
    let plates = plates(built);
    if let [only] = plates.as_slice() {
        return plate(only);
    }
    let bed_mm = built.design().configuration().print.bed_mm;
    let with_bed = |(i, p): (usize, &Plate<'_>)| {
        let aside = Vector3::new(i as f64 * (bed_mm + BEDS_APART_MM), 0.0, 0.0);
        let bodies = plate(p).into_iter().chain([Body { mesh: bed(bed_mm), colour: BED_COLOUR }]);
        bodies.map(|b| Body { mesh: b.mesh.translated(aside), ..b }).collect::<Vec<_>>()
    };
    plates.iter().enumerate().flat_map(with_bed).collect()
}

/// The upper face of a bed.
fn bed(side_mm: f64) -> Mesh {
    let at = |x: f64, y: f64| Point3::new(x * side_mm, y * side_mm, 0.0);
    Mesh::new(vec![at(0.0, 0.0), at(1.0, 0.0), at(1.0, 1.0), at(0.0, 1.0)], vec![[0, 1, 2], [0, 2, 3]])
}

/// Pixels of the picture of the exploded assembly, across and up.
const EXPLODED_PIXELS: (u32, u32) = (900, 675);

/// Returns the exploded assembly as PNG. It is rendered once for each [`Built`].
///
/// # Errors
/// [`SetError::Encoding`] if the picture cannot be encoded.
pub fn exploded_png(built: &Built) -> Result<&[u8], SetError> {
    if let Some(png) = built.exploded_png().get() {
        return Ok(png);
    }
    let view = switch_view(built.design());
    let (width, height) = EXPLODED_PIXELS;
    let png = render(&assembled(built, 1.0), view, width, height).png().map_err(SetError::encoding)?;
    Ok(built.exploded_png().get_or_init(|| png))
}
