//! Scenes to render: the assembly, its exploded view, the pictures of steps, and the print plates.

mod annotated;
mod arrow;
mod bench;
mod illustration;
mod overlay;

use crate::built::{Built, BuiltPart};
use crate::config::MountKind;
use crate::design::Design;
use crate::hardware::hardware;
use crate::output::SetError;
use crate::plates::{Plate, plates};
use pinswitch_solid::files::Placement;
use pinswitch_solid::mesh::{Mesh, Point3, Vector3};
use pinswitch_solid::profile::{Contour, Point2};
use pinswitch_solid::render::{Body, Picture, View, render};
use pinswitch_solid::solid::Solid;

use annotated::{Annotated, Annotation};
pub(crate) use arrow::distance_to_mesh;
pub use bench::{Bench, Bodies, Item};
pub(crate) use bench::{COUPON, CUT_PIN, GUIDE_PULLEY};
pub use illustration::{Arrows, Illustration, Motion, Move, ToolArrow, Upright};

/// View of the switch with its grooves up, at which the outer face of the left support is visible.
pub const FROM_LEFT: View = View { turn_deg: 38.0, rise_deg: 32.0 };

/// The same from the side of the right support.
pub const FROM_RIGHT: View = View { turn_deg: -FROM_LEFT.turn_deg, ..FROM_LEFT };

/// The view of a rig with its table: from the front.
pub(crate) const RIG_VIEW: View = View { turn_deg: -66.0, rise_deg: 24.0 };

/// Returns the view of the complete switch: from the side of the left support, unless a large plate or link would hide it.
pub fn switch_view(design: &Design) -> View {
    match design.configuration().mount.kind {
        MountKind::None => FROM_LEFT,
        MountKind::Rig | MountKind::Flange | MountKind::Joint => FROM_RIGHT,
    }
}

/// Rotates a mesh of the assembly so that the pulley's axis is horizontal, from left to right, and the grooves are up.
fn grooves_up(mesh: Mesh) -> Mesh {
    let turned = mesh.positions.iter().map(|p| Point3::new(p.z, p.x, p.y)).collect();
    Mesh::new(turned, mesh.triangles)
}

/// Returns the bodies of the assembly, with the bought ones and the table of a rig, exploded by `explosion`, from 0 to 1.
/// The pulley's axis is horizontal and the grooves are up, so that engraved text is upright in the view of [`switch_view`].
pub fn assembled(built: &Built, explosion: f64) -> Vec<Body> {
    let parts = built.assembly().filter_map(|body| {
        let role = body.part.role;
        let placed = body.part.pose?.apply(body.mesh.clone());
        Some(Body {
            mesh: grooves_up(placed.translated(role.explode_offset_mm() * explosion)),
            colour: role.colour(),
        })
    });
    parts.chain(rig_surroundings(built)).collect()
}

/// Thickness of the table in pictures, its depth on both sides of the board, and its end beyond the drive, mm.
const TABLE_MM: f64 = 18.0;
const TABLE_DEPTH_MM: [f64; 2] = [-120.0, 70.0];
const TABLE_END_MM: f64 = 60.0;
/// Colour of the table.
const TABLE_COLOUR: [u8; 3] = [222, 210, 190];

/// Returns the bought bodies of a rig and its table.
fn rig_surroundings(built: &Built) -> Vec<Body> {
    let design = built.design();
    let Some(layout) = design.rig_layout() else { return Vec::new() };
    let mesh = |solid: &Solid| solid.mesh(design.tolerance()).ok().map(grooves_up);
    let bought = hardware(design);
    let bodies =
        bought.iter().filter_map(|body| Some(Body { mesh: mesh(&body.solid)?, colour: body.kind.colour() }));
    let (x, y) = ([layout.edge_x_mm, layout.drive.x + TABLE_END_MM], layout.table_y_mm);
    let corners = [(x[0], y - TABLE_MM), (x[1], y - TABLE_MM), (x[1], y), (x[0], y)];
    let top = Contour::polygon(corners.map(|(x, y)| Point2::new(x, y)).to_vec());
    let [back, front] = TABLE_DEPTH_MM;
    let table = Solid::prism(&top, &[], back, front, 0.0).ok();
    let table = table.as_ref().and_then(mesh).map(|mesh| Body { mesh, colour: TABLE_COLOUR });
    bodies.chain(table).collect()
}

/// Distance of beds, mm.
const BEDS_APART_MM: f64 = 20.0;
/// Colour of a bed.
const BED_COLOUR: [u8; 3] = [214, 216, 222];

/// Returns the parts of a plate in print orientation.
pub fn plate(plate: &Plate<'_>) -> Vec<Body> {
    let body = |(part, place): &(&BuiltPart, _)| Body {
        mesh: Placement::apply(place, part.print_mesh.clone()),
        colour: bench::colour(part.part().role),
    };
    plate.parts.iter().map(body).collect()
}

/// Draws a plate with the names of its parts.
pub(crate) fn labelled_plate(shown: &Plate<'_>, view: View, (width, height): (u32, u32)) -> Picture {
    let names = || shown.parts.iter().map(|(part, _)| part.part().name.clone());
    let annotations = names().map(|name| Annotation::Named { label: name.clone(), bodies: vec![name] });
    Annotated {
        bodies: plate(shown),
        names: names().collect(),
        annotations: annotations.collect(),
        arrows: Vec::new(),
        view,
    }
    .draw(width, height)
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
/// The same for the picture of a rig.
const RIG_PIXELS: (u32, u32) = (1600, 900);

/// Returns the exploded assembly, or the assembled rig, as PNG. It is rendered once for each [`Built`].
///
/// # Errors
/// [`SetError::Encoding`] if the picture cannot be encoded.
pub fn exploded_png(built: &Built) -> Result<&[u8], SetError> {
    if let Some(png) = built.exploded_png().get() {
        return Ok(png);
    }
    // The rig is shown assembled: its parts are far from each other.
    let is_rig = built.design().rig_layout().is_some();
    let usual = switch_view(built.design());
    let (view, (width, height), explosion) =
        if is_rig { (RIG_VIEW, RIG_PIXELS, 0.0) } else { (usual, EXPLODED_PIXELS, 1.0) };
    let png = render(&assembled(built, explosion), view, width, height).png().map_err(SetError::encoding)?;
    Ok(built.exploded_png().get_or_init(|| png))
}
