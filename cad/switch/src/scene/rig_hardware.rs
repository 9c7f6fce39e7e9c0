//! Bought hardware of a mounting plate in the assembly: bolt, bearing, washer and nut of the guide pulley, screws and nuts of
//! the sheath stop.

use super::stage::{Item, METAL_GREY, STEEL};
use crate::design::{AXLE_HEAD_MM, Design, Hole, STOP_SCREW, axle_recess, stop_recess};
use crate::documents::{AXLE_NUT_MM, BEARING_MM, MountHardware, bill_of_materials};
use crate::parts::spacer_mm;
use pinswitch_solid::mesh::Vector3;
use pinswitch_solid::profile::{Contour, Point2, polar};
use pinswitch_solid::solid::Solid;

/// Radii of the M8 bolt, its washer (ISO 7089) and the rings of a 608 bearing (ISO 15), mm.
const AXLE_MM: f64 = 4.0;
const WASHER_MM: [f64; 2] = [4.2, 8.0];
const BEARING_RING_MM: [f64; 2] = [4.0, 11.0];
/// Thickness of the washer, mm.
const WASHER_HIGH_MM: f64 = 1.6;
/// Radius of an M3 shank, mm.
const STOP_SHANK_MM: f64 = 1.5;

/// Heights of the outer and the inner face of the mounting plate in the assembly.
fn faces_mm(design: &Design) -> [f64; 2] {
    let c = design.configuration();
    [-(c.support.plate_mm + c.mount.plate_mm), -c.support.plate_mm]
}

fn hexagon(middle: Point2, flats_mm: f64) -> Contour {
    let corner =
        |i: u32| middle + polar(flats_mm / 3f64.sqrt(), f64::from(i) * std::f64::consts::FRAC_PI_3).coords;
    Contour::polygon((0..6).rev().map(corner).collect())
}

/// A body of steel between two heights, with a bore or without.
fn steel(
    design: &Design,
    outline: &Contour,
    bore: Option<Contour>,
    [from, to]: [f64; 2],
    apart_mm: f64,
) -> Option<Item> {
    let holes: Vec<Contour> = bore.into_iter().collect();
    let mesh = Solid::prism(outline, &holes, from, to, 0.0).ok()?.mesh(design.tolerance()).ok()?;
    Some(Item { mesh, grey: METAL_GREY, colour: STEEL, apart: Vector3::new(0.0, 0.0, apart_mm) })
}

fn ring(
    design: &Design,
    middle: Point2,
    [inner, outer]: [f64; 2],
    span: [f64; 2],
    apart_mm: f64,
) -> Option<Item> {
    let bore = Contour::circle(middle, inner).reversed();
    steel(design, &Contour::circle(middle, outer), Some(bore), span, apart_mm)
}

/// Returns the hardware in the plate: the bolt of the axle, and screws and nuts of the sheath stop.
pub(super) fn in_the_plate(design: &Design, apart_mm: f64) -> Vec<Item> {
    let (Some(mounting), Some(bill)) = (design.mounting(), bill_of_materials(design).mount) else {
        return Vec::new();
    };
    let bolt = mounting.axle.into_iter().flat_map(|hole| bolt(design, &hole, &bill, apart_mm));
    let screws = mounting.sheath.into_iter().flat_map(|stop| stop.screws);
    bolt.chain(screws.flat_map(|hole| stop_screw(design, &hole, &bill, apart_mm))).collect()
}

fn bolt(design: &Design, hole: &Hole, bill: &MountHardware, apart_mm: f64) -> Vec<Item> {
    let Some(length_mm) = bill.axle_length_mm else { return Vec::new() };
    let [flats, high] = AXLE_HEAD_MM;
    let seat = faces_mm(design)[0] + axle_recess().depth_mm;
    let head = steel(design, &hexagon(hole.centre, flats), None, [seat - high, seat], apart_mm);
    let shank = Contour::circle(hole.centre, AXLE_MM);
    [head, steel(design, &shank, None, [seat, seat + length_mm], apart_mm)].into_iter().flatten().collect()
}

fn stop_screw(design: &Design, hole: &Hole, bill: &MountHardware, apart_mm: f64) -> Vec<Item> {
    let Some(length_mm) = bill.stop_screw_length_mm else { return Vec::new() };
    let ([wide, high], [flats, nut_high]) = (STOP_SCREW.head_mm, STOP_SCREW.nut_mm);
    let [outer, inner] = faces_mm(design);
    let (seat, floor) = (outer + stop_recess().depth_mm, inner + design.sheath_floor_mm());
    let circle = |radius| Contour::circle(hole.centre, radius);
    let head = steel(design, &circle(wide / 2.0), None, [seat - high, seat], apart_mm);
    let shank = steel(design, &circle(STOP_SHANK_MM), None, [seat, seat + length_mm], apart_mm);
    let nut = steel(design, &hexagon(hole.centre, flats), None, [floor, floor + nut_high], apart_mm);
    [head, shank, nut].into_iter().flatten().collect()
}

/// Returns the hardware on the bolt: bearing, washer and nut, at their distances from their positions.
pub(super) fn on_the_bolt(design: &Design, [bearing_apart_mm, nut_apart_mm]: [f64; 2]) -> Vec<Item> {
    let Some(axle) = design.mounting().and_then(|m| m.axle) else { return Vec::new() };
    let bearing = faces_mm(design)[1] + spacer_mm(design);
    let washer = bearing + BEARING_MM;
    let nut = washer + WASHER_HIGH_MM;
    let flats = AXLE_HEAD_MM[0];
    let bore = Contour::circle(axle.centre, AXLE_MM).reversed();
    [
        ring(design, axle.centre, BEARING_RING_MM, [bearing, washer], bearing_apart_mm),
        ring(design, axle.centre, WASHER_MM, [washer, nut], nut_apart_mm),
        steel(design, &hexagon(axle.centre, flats), Some(bore), [nut, nut + AXLE_NUT_MM], nut_apart_mm),
    ]
    .into_iter()
    .flatten()
    .collect()
}
