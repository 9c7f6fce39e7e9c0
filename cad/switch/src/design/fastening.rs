//! Screws, nuts, heads, inserts and dowels: what fits this design, and where (cad/doc/dimensions.md, "Fasteners").

use super::Dimensions;
use crate::config::{FastenerKind, MountKind};

/// Wall left around a fastener hole or a recess (cad/doc/print-limits.md, "Fasteners").
pub(super) const HOLE_EDGE_MM: f64 = 0.5;
/// What a recess is wider than nut or head, mm.
const RECESS_PLAY_MM: f64 = 0.2;
/// What a counterbore is wider than the head, mm: a printed hole comes out small.
const HEAD_PLAY_MM: f64 = 0.5;
/// Least plate that carries nut or head beyond its recess, mm.
const LEAST_SEAT_MM: f64 = 1.0;
/// Wall between a dowel and the fastener beside it, mm.
const DOWEL_WALL_MM: f64 = 1.5;
/// What a dowel's hole is wider than the dowel, mm.
const DOWEL_PLAY_MM: f64 = 0.1;
/// What closes a hole above a recess, in layers, and no less than [`LEAST_MEMBRANE_MM`].
const MEMBRANE_LAYERS: f64 = 2.0;
/// Thinnest of such a membrane, mm: what every printer lays down.
const LEAST_MEMBRANE_MM: f64 = 0.4;
/// Room for the tip of a screw between two inserts, mm.
pub(super) const INSERT_TIP_MM: f64 = 1.0;

/// A metric thread with the hardware that fits it. Sources: cad/doc/print-limits.md, "Fasteners".
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Thread {
    /// Name, such as `M3`.
    pub name: &'static str,
    /// Narrowest hole that it passes, mm.
    pub least_hole_mm: f64,
    /// Nut across its flats and its height (ISO 4032), mm.
    pub nut_mm: [f64; 2],
    /// Head of a socket screw: diameter and height (ISO 4762), mm.
    pub head_mm: [f64; 2],
    /// Heat-set insert: hole and length, mm; `None` where none is sold for prints.
    pub insert_mm: Option<[f64; 2]>,
}

/// Threads, the narrowest first.
const THREADS: [Thread; 6] = [
    thread("M1.6", 1.8, [3.2, 1.3], [3.0, 1.6], None),
    thread("M2", 2.2, [4.0, 1.6], [3.8, 2.0], Some([3.2, 4.0])),
    thread("M2.5", 2.7, [5.0, 2.0], [4.5, 2.5], Some([4.0, 5.7])),
    thread("M3", 3.2, [5.5, 2.4], [5.5, 3.0], Some([4.0, 5.7])),
    thread("M4", 4.3, [7.0, 3.2], [7.0, 4.0], Some([5.6, 8.1])),
    thread("M5", 5.3, [8.0, 4.7], [8.5, 5.0], None),
];

const fn thread(
    name: &'static str,
    least_hole_mm: f64,
    nut_mm: [f64; 2],
    head_mm: [f64; 2],
    insert_mm: Option<[f64; 2]>,
) -> Thread {
    Thread { name, least_hole_mm, nut_mm, head_mm, insert_mm }
}

/// A recess in an outer face: hexagonal for nuts, round for heads.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Recess {
    /// Half of its width across the radius: half across flats, or the radius.
    pub radial_mm: f64,
    /// Half of its width along the arc: to a corner, or the radius.
    pub along_mm: f64,
    /// Depth.
    pub depth_mm: f64,
    /// Whether it is a hexagon.
    pub is_hexagon: bool,
}

/// What joins shell and supports.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fastening {
    /// The largest thread that the holes take; `None` for holes under M1.6.
    pub thread: Option<Thread>,
    /// Nut traps in the right support's outer face, if they are wanted and fit.
    pub nut_trap: Option<Recess>,
    /// Counterbores for the heads, if they are wanted and fit: in the outer face of the left support, or of the mounting
    /// plate; with inserts in that of the right support as well.
    pub counterbore: Option<Recess>,
    /// Hole and length of the inserts at both ends of the shell's holes.
    pub insert_mm: Option<[f64; 2]>,
}

impl Fastening {
    /// The recess in the outer face of a plate: where the screws' heads are, or their nuts.
    pub const fn recess(&self, has_heads: bool) -> Option<Recess> {
        if has_heads { self.counterbore } else { self.nut_trap }
    }
}

impl Dimensions {
    /// The hardware of this design: what is wanted, as far as it fits.
    pub fn fastening(&self) -> Fastening {
        let c = self.configuration();
        let f = &c.fasteners;
        let thread = THREADS.into_iter().rev().find(|t| t.least_hole_mm <= f.hole_diameter_mm);
        let plate = |has_heads: bool| {
            if has_heads && c.mount.kind != MountKind::None { c.mount.plate_mm } else { c.support.plate_mm }
        };
        let fits = |recess: Recess, plate_mm: f64| {
            let seat = plate_mm - recess.depth_mm - self.membrane_mm();
            (recess.depth_mm > 0.0 && f.count > 0 && seat >= LEAST_SEAT_MM && self.recess_fits(&recess))
                .then_some(recess)
        };
        let nut_trap = thread.filter(|_| f.kind == FastenerKind::NutTrap).and_then(|t| {
            let flats = (t.nut_mm[0] + RECESS_PLAY_MM) / 2.0;
            let along_mm = flats / std::f64::consts::FRAC_PI_6.cos();
            let recess = Recess { radial_mm: flats, along_mm, depth_mm: f.nut_recess_mm, is_hexagon: true };
            fits(recess, plate(false))
        });
        let counterbore = thread.and_then(|t| {
            let radius = (t.head_mm[0] + HEAD_PLAY_MM) / 2.0;
            let depth_mm = f.head_recess_mm;
            let recess = Recess { radial_mm: radius, along_mm: radius, depth_mm, is_hexagon: false };
            // With inserts there are heads on both sides.
            let thinner =
                if f.kind == FastenerKind::Insert { plate(true).min(plate(false)) } else { plate(true) };
            fits(recess, thinner)
        });
        let insert_mm =
            thread.filter(|_| f.kind == FastenerKind::Insert && f.count > 0).and_then(|t| t.insert_mm);
        Fastening { thread, nut_trap, counterbore, insert_mm }
    }

    /// Thickness of what closes a hole above a recess: the printer bridges it, and the screw breaks it.
    pub fn membrane_mm(&self) -> f64 {
        (MEMBRANE_LAYERS * self.configuration().print.layer_mm).max(LEAST_MEMBRANE_MM)
    }

    /// Wall that must stay around a fastener.
    fn rim_mm(&self) -> f64 {
        let p = &self.configuration().print;
        HOLE_EDGE_MM.max(p.least_wall_mm)
    }

    /// Whether walls stay between a recess and the inner face, the slots, the ends, and its neighbours.
    fn recess_fits(&self, recess: &Recess) -> bool {
        let c = self.configuration();
        let (middle, rim) = (self.fastener_radius_mm(), self.rim_mm());
        let inside = middle - recess.radial_mm - self.inner_radius_mm() >= rim;
        let under_slots = self.slot().inner_edge_mm() - middle - recess.along_mm.max(recess.radial_mm) >= rim;
        let at_ends = c.fasteners.count < 2
            || c.fasteners.end_distance_mm + self.shell_end_shift_mm() - recess.along_mm >= rim;
        let apart = |w: &[f64]| 2.0 * middle * ((w[1] - w[0]) / 2.0).sin() >= 2.0 * recess.along_mm + rim;
        inside && under_slots && at_ends && self.fastener_angles_rad().windows(2).all(apart)
    }

    /// Half of what a fastener takes of the arc of the shell.
    pub(crate) fn shell_hole_mm(&self) -> f64 {
        let hole = self.configuration().fasteners.hole_diameter_mm;
        self.fastening().insert_mm.map_or(hole, |[bore, _]| bore.max(hole)) / 2.0
    }

    /// Half of what a fastener takes of the arc, in the widest of all parts.
    pub(crate) fn fastener_along_mm(&self) -> f64 {
        let f = self.fastening();
        let hole = self.configuration().fasteners.hole_diameter_mm / 2.0;
        let recesses = [f.nut_trap, f.counterbore].into_iter().flatten().map(|r| r.along_mm);
        recesses.chain(f.insert_mm.map(|[hole, _]| hole / 2.0)).fold(hole, f64::max)
    }

    /// Radius of the holes for dowels; `None` without dowels.
    pub fn dowel_hole_radius_mm(&self) -> Option<f64> {
        let d = self.configuration().fasteners.dowel_diameter_mm;
        (d > 0.0).then_some((d + DOWEL_PLAY_MM) / 2.0)
    }

    /// Angles of the two dowels, beside the outermost fasteners; empty without dowels.
    pub fn dowel_angles_rad(&self) -> Vec<f64> {
        let Some(radius) = self.dowel_hole_radius_mm() else { return Vec::new() };
        let at = self.fastener_radius_mm();
        let angle = match self.fastener_angles_rad().last() {
            Some(outermost) if *outermost > 0.0 => {
                outermost - (self.fastener_along_mm() + radius + DOWEL_WALL_MM) / at
            }
            _ => self.half_span_rad() - self.configuration().fasteners.end_distance_mm / at,
        };
        vec![-angle, angle]
    }

    /// Depth of the dowels' holes in the supports.
    pub fn dowel_depth_mm(&self) -> f64 {
        self.configuration().support.plate_mm / 2.0
    }

    /// Length to which dowels are cut, mm: half a millimetre less than their room.
    pub fn dowel_length_mm(&self) -> f64 {
        let room = self.configuration().shell.width_mm + 2.0 * self.dowel_depth_mm();
        ((room - 0.5) * 2.0).floor() / 2.0
    }

    /// Whether the dowels have walls around them.
    pub(super) fn dowels_fit(&self) -> bool {
        let Some(radius) = self.dowel_hole_radius_mm() else { return true };
        let c = self.configuration();
        let (at, rim) = (self.fastener_radius_mm(), self.rim_mm());
        let radial = at - radius - self.inner_radius_mm() >= rim
            && self.shell_radius_mm() - c.segment.groove_radius_mm - at - radius >= rim
            && self.slot().inner_edge_mm() - at - radius >= rim;
        let angles = self.dowel_angles_rad();
        let (own, taken) = (angles[1], self.fastener_along_mm());
        let clear = |other: &f64| {
            let needed = if *other == -own { 2.0 * radius } else { radius + taken };
            2.0 * at * ((own - other).abs() / 2.0).sin() >= needed + rim
        };
        let within = own.cos() > 0.0 || own < self.half_span_rad();
        let in_sector =
            at * (self.half_span_rad() - own).min(1.5).sin() + self.shell_end_shift_mm() >= radius + rim;
        let deep = self.dowel_depth_mm() >= c.print.least_wall_mm;
        radial
            && within
            && in_sector
            && deep
            && own > 0.0
            && self.fastener_angles_rad().iter().chain([&-own]).all(clear)
    }
}
