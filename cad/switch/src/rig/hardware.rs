//! Bought bodies of the rig in the assembly: bolts, cell, drive, hook and weights, with the load lowered.

use std::f64::consts::TAU;

use super::RigBolts;
use super::bolts::M6_NUT_MM;
use crate::config::{CellKind, DriveKind};
use crate::design::rig::{
    CELL_PLATE_MM, CELL_ROOM_MM, CELL_WALL_MM, DRIVE_DEPTH_MM, DRUM_LENGTH_MM, EYE_MM, FOOT_DEPTH_MM,
    LOCK_MM, WASHER_MM, flats_mm,
};
use crate::design::{Design, RigLayout};
use crate::hardware::{HardwareKind, hexagon, prism, stepped};
use crate::parts::{RIG_END_MM, cell_bolts, cell_length_mm, front_mm, middle_mm};
use pinswitch_solid::profile::{Contour, Point2, Vector2};
use pinswitch_solid::solid::{Facing, Solid};

/// Half of the sides of a body with a lying axis: a polygon inside of its circle.
const HALF_SIDES: u32 = 6;
/// Radii of the eye of the eye bolt, mm.
const EYE_RADII_MM: [f64; 2] = [5.0, 9.0];
/// Height of the weights and of the rod of the hook above them, mm.
const WEIGHTS_MM: f64 = 50.0;
const HOOK_MM: f64 = 45.0;
/// Distance of the hook below the table at the highest point of the load, mm.
const BELOW_TABLE_MM: f64 = 15.0;
/// Radius of the rod of hook and eye bolt, of the actuator's rod, and of its eyes (PA-14: 0.59 in), mm.
const ROD_MM: f64 = 3.0;
const PISTON_MM: f64 = 7.0;
const DRIVE_EYE_MM: f64 = 15.0;

/// Receives a kind, whether the body is put in from the right side, and its solid.
type Add<'a> = &'a mut dyn FnMut(HardwareKind, bool, Option<Solid>);

/// Adds all bodies of the rig except the axles of its guide pulleys.
pub(crate) fn rig_hardware(design: &Design, add: Add<'_>) {
    let (Some(layout), Some(bolts)) = (design.rig_layout(), RigBolts::new(design)) else { return };
    stand(design, &layout, &bolts, add);
    cell(design, &layout, &bolts, add);
    drive(design, &layout, &bolts, add);
    load(design, &layout, add);
}

/// A hexagon bolt along the axis of the switch. A negative length points to smaller z.
fn bolt(at: Point2, thread_mm: f64, face_mm: f64, length_mm: f64) -> Solid {
    let head = hexagon(at, flats_mm(thread_mm), 0.0);
    let high = 0.65 * thread_mm;
    let span = if length_mm > 0.0 { [face_mm - high, face_mm] } else { [face_mm, face_mm + high] };
    stepped(&head, span, &Contour::circle(at, thread_mm / 2.0), length_mm)
}

fn ring(at: Point2, [inner, outer]: [f64; 2], span: [f64; 2]) -> Option<Solid> {
    prism(&Contour::circle(at, outer), Some(Contour::circle(at, inner).reversed()), span)
}

fn nut(at: Point2, thread_mm: f64, span: [f64; 2]) -> Option<Solid> {
    let bore = Contour::circle(at, thread_mm / 2.0).reversed();
    prism(&hexagon(at, flats_mm(thread_mm), 0.0), Some(bore), span)
}

/// A rod between two points of the plane of the tendon, at the height `z_mm`.
fn rod(from: Point2, to: Point2, radius_mm: f64, z_mm: f64) -> Option<Solid> {
    let along = (to - from).try_normalize(1e-9)?;
    let across = Vector2::new(-along.y, along.x);
    let mut solid = Solid::new();
    let mut below = None;
    for k in 0..HALF_SIDES {
        let angle = (f64::from(k) + 0.5) / f64::from(2 * HALF_SIDES) * TAU;
        let half = radius_mm * libm::sin(angle);
        let corners =
            vec![from - across * half, to - across * half, to + across * half, from + across * half];
        let ring = solid.ring(Contour::polygon(corners), z_mm - radius_mm * libm::cos(angle));
        match below {
            None => solid.cap(Facing::Down, ring, &[]),
            Some(below) => solid.wall(below, ring),
        }
        below = Some(ring);
    }
    solid.cap(Facing::Up, below?, &[]);
    Some(solid)
}

/// Bolts of the feet from the front, and of the splice.
fn stand(design: &Design, layout: &RigLayout, bolts: &RigBolts, add: Add<'_>) {
    let c = design.configuration();
    let front = -c.support.plate_mm;
    let back = front - c.mount.plate_mm;
    let washer = [3.2, 6.0];
    for hole in &layout.foot_bolts {
        let at = hole.centre;
        add(HardwareKind::FootBolt, true, Some(bolt(at, 6.0, front + WASHER_MM, -bolts.foot_mm)));
        let end = back - FOOT_DEPTH_MM;
        add(HardwareKind::FootWasher, true, ring(at, washer, [front, front + WASHER_MM]));
        add(HardwareKind::FootWasher, false, ring(at, washer, [end - WASHER_MM, end]));
        add(HardwareKind::FootNut, false, nut(at, 6.0, [end - WASHER_MM - M6_NUT_MM, end - WASHER_MM]));
    }
    if let (Some(joint), Some((thread, length))) = (&layout.joint, bolts.splice) {
        for hole in joint.left.iter().chain(&joint.right) {
            let end = back - c.mount.plate_mm;
            add(HardwareKind::SpliceBolt, true, Some(bolt(hole.centre, thread, front, -length)));
            add(HardwareKind::SpliceNut, false, nut(hole.centre, thread, [end - 0.8 * thread, end]));
        }
    }
}

/// The cell with its bolts and eye bolt, and the tendon to it.
fn cell(design: &Design, layout: &RigLayout, bolts: &RigBolts, add: Add<'_>) {
    let c = design.configuration();
    let rig = &c.rig;
    let (z, y) = (middle_mm(design), layout.line_y_mm);
    let wall = layout.pin_x_mm[0] - CELL_ROOM_MM;
    let right = wall - CELL_WALL_MM;
    let left = right - cell_length_mm(c);
    let at = |x: f64, up: f64| Point2::new(x, y + up);
    let (outline, half_z) = match rig.cell {
        CellKind::SBeam => {
            (s_beam(at(left, 0.0), rig.s_beam_length_mm, rig.s_beam_width_mm), rig.s_beam_thickness_mm / 2.0)
        }
        CellKind::Bar => {
            let (low, high) = (-rig.bar_hole_inset_mm, rig.bar_length_mm - rig.bar_hole_inset_mm);
            let outline =
                Contour::polygon(vec![at(left, low), at(right, low), at(right, high), at(left, high)]);
            (outline, rig.bar_side_mm / 2.0)
        }
    };
    add(HardwareKind::Cell, true, prism(&outline, None, [z - half_z, z + half_z]));
    let (thread, ..) = bolts.cell;
    for b in cell_bolts(c) {
        let head = at(wall + WASHER_MM, b.up_mm);
        // The tip in the cell is not drawn.
        add(HardwareKind::CellBolt, true, rod(at(right, b.up_mm), head, thread / 2.0, z));
        let high = 0.65 * thread;
        add(HardwareKind::CellBolt, true, rod(head, head + Vector2::x() * high, flats_mm(thread) / 2.0, z));
    }
    let eye = at(left - EYE_MM + EYE_RADII_MM[1], 0.0);
    add(HardwareKind::EyeBolt, true, ring(eye, EYE_RADII_MM, [z - ROD_MM, z + ROD_MM]));
    add(HardwareKind::EyeBolt, true, rod(at(eye.x + EYE_RADII_MM[1], 0.0), at(left, 0.0), ROD_MM, z));
    let from = if design.has_drive_pulley() { at(layout.drive_axle.x + RIG_END_MM, 0.0) } else { eye };
    let tendon = design.tendon_diameter_mm() / 2.0;
    add(HardwareKind::Line, true, rod(from, at(eye.x - EYE_RADII_MM[0], 0.0), tendon, z));
}

/// The outline of an S-beam from the middle of its left face: two slots across the tendon, from opposite sides.
fn s_beam(left: Point2, length_mm: f64, width_mm: f64) -> Contour {
    let (half, slot) = (width_mm / 2.0, 0.05 * length_mm);
    let reach = half - 0.22 * width_mm;
    let at = |x: f64, up: f64| Point2::new(left.x + x, left.y + up);
    let (a, b) = (0.25 * length_mm, 0.75 * length_mm);
    Contour::polygon(vec![
        at(0.0, -half),
        at(b - slot, -half),
        at(b - slot, reach),
        at(b + slot, reach),
        at(b + slot, -half),
        at(length_mm, -half),
        at(length_mm, half),
        at(a + slot, half),
        at(a + slot, -reach),
        at(a - slot, -reach),
        at(a - slot, half),
        at(0.0, half),
    ])
}

/// The actuator with its bolts, or the bolts of the crank and the tendon to its drum.
fn drive(design: &Design, layout: &RigLayout, bolts: &RigBolts, add: Add<'_>) {
    let c = design.configuration();
    let z = middle_mm(design);
    let pin = Point2::new(layout.pin_x_mm[0], layout.line_y_mm);
    let plate = z - layout.cell_height_mm - CELL_PLATE_MM;
    let thread = bolts.drive_thread_mm;
    let half_eye = c.rig.clevis_mm / 2.0;
    add(HardwareKind::DriveBolt, false, Some(bolt(pin, thread, plate, bolts.pin_mm)));
    match c.rig.drive {
        DriveKind::Actuator => {
            let rear = layout.drive;
            let foot = front_mm(design, false) - DRIVE_DEPTH_MM;
            add(HardwareKind::DriveBolt, false, Some(bolt(rear, thread, foot, bolts.axle_mm)));
            let inner = (thread + 0.35) / 2.0;
            for eye in [pin, rear] {
                let washer = z + half_eye + WASHER_MM;
                add(HardwareKind::DriveNut, true, nut(eye, thread, [washer, washer + thread]));
                add(
                    HardwareKind::Actuator,
                    true,
                    ring(eye, [inner, DRIVE_EYE_MM], [z - half_eye, z + half_eye]),
                );
            }
            let body = [rear.x - c.rig.retracted_mm + 2.0 * DRIVE_EYE_MM, rear.x - DRIVE_EYE_MM - 1.0];
            let on_line = |x: f64| Point2::new(x, layout.line_y_mm);
            add(
                HardwareKind::Actuator,
                true,
                rod(on_line(pin.x + DRIVE_EYE_MM), on_line(body[0]), PISTON_MM, z),
            );
            add(
                HardwareKind::Actuator,
                true,
                rod(on_line(body[0]), on_line(body[1]), c.rig.body_mm / 2.0, z),
            );
        }
        DriveKind::Crank => {
            let foot = front_mm(design, true) - DRIVE_DEPTH_MM;
            add(HardwareKind::DriveBolt, false, Some(bolt(layout.drive, 8.0, foot, bolts.axle_mm)));
            if let Some([lock, knob]) = bolts.crank_mm {
                let below = layout.drive - Vector2::y() * LOCK_MM;
                add(HardwareKind::DriveBolt, false, Some(bolt(below, 5.0, foot, lock)));
                let lever = layout.drive + Vector2::y() * design.lever_mm();
                let face = front_mm(design, true) + WASHER_MM;
                add(HardwareKind::DriveBolt, false, Some(bolt(lever, 6.0, face, knob)));
            }
            let top = front_mm(design, true) + WASHER_MM + DRUM_LENGTH_MM + WASHER_MM;
            add(HardwareKind::DriveNut, true, nut(layout.drive, 8.0, [top, top + 8.0]));
            let to = Point2::new(layout.drive.x, layout.line_y_mm);
            add(HardwareKind::Line, true, rod(pin, to, design.tendon_diameter_mm() / 2.0, z));
        }
    }
}

/// The hanging tendon, the hook and the weights, with the load lowered.
fn load(design: &Design, layout: &RigLayout, add: Add<'_>) {
    let c = design.configuration();
    let z = middle_mm(design);
    let at = |y: f64| Point2::new(layout.load_x_mm, y);
    let hook = lowered_mm(design, layout);
    let tendon = design.tendon_diameter_mm() / 2.0;
    add(HardwareKind::Line, true, rod(at(layout.load_axle.y - RIG_END_MM), at(hook), tendon, z));
    let weights = hook - HOOK_MM;
    add(HardwareKind::Hook, true, rod(at(hook), at(weights), ROD_MM, z));
    let radius = c.rig.weight_diameter_mm / 2.0;
    add(HardwareKind::Weight, true, rod(at(weights), at(weights - WEIGHTS_MM), radius, z));
}

/// Height of the hook with the load lowered.
fn lowered_mm(design: &Design, layout: &RigLayout) -> f64 {
    let pulley = layout.load_axle.y - RIG_END_MM;
    layout.table_y_mm.min(pulley) - BELOW_TABLE_MM - design.configuration().rig.stroke_mm
}
