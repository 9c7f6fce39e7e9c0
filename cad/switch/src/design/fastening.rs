//! Screws, nuts, heads, inserts and dowels: sizes and positions (cad/doc/dimensions.md,
//! "Fasteners").

use super::Dimensions;
use crate::config::{FastenerKind, MountKind};

/// Least wall around a fastener hole or a recess (cad/doc/print-limits.md, "Fasteners").
pub(super) const HOLE_EDGE_MM: f64 = 0.5;
/// Clearance of a recess around a nut or a head, mm.
pub(super) const RECESS_PLAY_MM: f64 = 0.2;
/// Clearance of a counterbore around a head, mm. Printed holes are smaller than drawn.
const HEAD_PLAY_MM: f64 = 0.5;
/// Least thickness of the plate under a recess that carries a nut or a head, mm.
const LEAST_SEAT_MM: f64 = 1.0;
/// Wall between a dowel and the adjacent fastener, mm.
const DOWEL_WALL_MM: f64 = 1.5;
/// Clearance of a dowel hole, mm.
const DOWEL_PLAY_MM: f64 = 0.1;
/// Thickness of the membrane that closes a hole above a recess, in layers; at least
/// [`LEAST_MEMBRANE_MM`].
const MEMBRANE_LAYERS: f64 = 2.0;
/// Least thickness of a membrane, mm: one that every printer can print.
const LEAST_MEMBRANE_MM: f64 = 0.4;
/// Space for the tips of the screws between two inserts, mm.
pub(super) const INSERT_TIP_MM: f64 = 1.0;
/// Width of the shoulder under an insert, above a narrower hole, mm.
pub(super) const INSERT_SHOULDER_MM: f64 = 0.1;
/// Distance of a head below a face that rests on a table, mm.
pub(super) const HEAD_BELOW_MM: f64 = 0.2;
/// Allowance for rounding errors in a wall, mm.
const ROUNDING_MM: f64 = 1e-9;
/// Lengths of socket screws, mm (ISO 4762). [`Thread::lengths_mm`] limits those of each thread.
const SCREW_LENGTHS_MM: [f64; 16] =
    [2.5, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0, 12.0, 16.0, 20.0, 25.0, 30.0, 35.0, 40.0, 45.0, 50.0];
/// Diameters of dowels, mm (ISO 2338).
pub(super) const DOWELS_MM: &[f64] = &[0.6, 0.8, 1.0, 1.2, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0];
/// Fine, medium and coarse clearance holes of M1.6 to M5, mm (ISO 273).
pub(super) const CLEARANCE_HOLES_MM: &[f64] =
    &[1.7, 1.8, 2.0, 2.2, 2.4, 2.6, 2.7, 2.9, 3.1, 3.2, 3.4, 3.6, 4.3, 4.5, 4.8, 5.3, 5.5, 5.8];
/// Protrusion of a screw from its nut: one turn of the thread, mm.
const SCREW_PROTRUSION_MM: f64 = 0.5;
/// Gap between the tips of two screws that meet in the shell, mm.
const SCREW_AIR_MM: f64 = 0.5;
/// Least engagement of a screw in an insert, in diameters of the hole.
const LEAST_GRIP: f64 = 0.6;
/// Thread of the socket screws and nuts of the sheath stop: M3.
pub(crate) const STOP_SCREW: Thread = THREADS[3];
/// Hexagon head of the M8 bolt of the axle: width across flats and height, mm (ISO 4017).
pub(crate) const AXLE_HEAD_MM: [f64; 2] = [13.0, 5.3];

/// A metric thread with the hardware that fits it. Sources: cad/doc/print-limits.md, "Fasteners".
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Thread {
    /// Name, such as `M3`.
    pub name: &'static str,
    /// Diameter of the narrowest clearance hole, mm.
    pub least_hole_mm: f64,
    /// Nut: width across flats and height (ISO 4032), mm.
    pub nut_mm: [f64; 2],
    /// Head of a socket screw: diameter and height (ISO 4762), mm.
    pub head_mm: [f64; 2],
    /// Heat-set insert: hole and length, mm; `None` where none is sold for printed parts.
    pub insert_mm: Option<[f64; 2]>,
    /// Shortest and longest socket screw (ISO 4762), mm.
    pub lengths_mm: [f64; 2],
}

impl Thread {
    /// Returns the shortest available screw of at least `least_mm`.
    pub fn at_least_mm(&self, least_mm: f64) -> Option<f64> {
        self.sold_mm().find(|l| *l >= least_mm - ROUNDING_MM)
    }

    /// Returns the longest available screw of at most `most_mm`.
    pub fn at_most_mm(&self, most_mm: f64) -> Option<f64> {
        self.sold_mm().filter(|l| *l <= most_mm + ROUNDING_MM).last()
    }

    fn sold_mm(&self) -> impl Iterator<Item = f64> {
        let [low, high] = self.lengths_mm;
        SCREW_LENGTHS_MM.into_iter().filter(move |l| (low..=high).contains(l))
    }
}

/// Threads, ascending.
const THREADS: [Thread; 6] = [
    thread("M1.6", 1.7, [3.2, 1.3], [3.0, 1.6], None, [2.5, 16.0]),
    thread("M2", 2.2, [4.0, 1.6], [3.8, 2.0], Some([3.2, 4.0]), [3.0, 20.0]),
    thread("M2.5", 2.7, [5.0, 2.0], [4.5, 2.5], Some([4.0, 5.7]), [4.0, 25.0]),
    thread("M3", 3.2, [5.5, 2.4], [5.5, 3.0], Some([4.0, 5.7]), [5.0, 30.0]),
    thread("M4", 4.3, [7.0, 3.2], [7.0, 4.0], Some([5.6, 8.1]), [6.0, 40.0]),
    thread("M5", 5.3, [8.0, 4.7], [8.5, 5.0], None, [8.0, 50.0]),
];

const fn thread(
    name: &'static str,
    least_hole_mm: f64,
    nut_mm: [f64; 2],
    head_mm: [f64; 2],
    insert_mm: Option<[f64; 2]>,
    lengths_mm: [f64; 2],
) -> Thread {
    Thread { name, least_hole_mm, nut_mm, head_mm, insert_mm, lengths_mm }
}

/// A recess in an outer face: hexagonal for nuts, round for heads.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Recess {
    /// Half of the radial width: half of the width across flats, or the radius.
    pub radial_mm: f64,
    /// Half of the width along the arc: the distance to a corner, or the radius.
    pub along_mm: f64,
    /// Depth.
    pub depth_mm: f64,
    /// Whether the recess is a hexagon.
    pub is_hexagon: bool,
}

/// The hardware that joins shell and supports.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fastening {
    /// The largest thread that fits the holes; `None` for holes below M1.6.
    pub thread: Option<Thread>,
    /// Nut traps in the outer face of the right support, if requested and if they fit.
    pub nut_trap: Option<Recess>,
    /// Counterbores for the heads in the outer faces of the supports, if requested and if they fit:
    /// in the left support unless a mounting plate covers it, and with inserts in the right one.
    pub counterbore: Option<Recess>,
    /// Counterbores for the heads in the outer face of the mounting plate, if requested and if they
    /// fit.
    pub mount_counterbore: Option<Recess>,
    /// Hole and length of the inserts at both ends of the holes in the shell.
    pub insert_mm: Option<[f64; 2]>,
}

impl Fastening {
    /// Returns the recess in the outer face of a support, for the heads of the screws or for their
    /// nuts.
    pub const fn recess(&self, has_heads: bool) -> Option<Recess> {
        if has_heads { self.counterbore } else { self.nut_trap }
    }
}

/// Returns the depth of a recess that contains a head of `head_mm`.
pub(super) const fn recess_below(head_mm: f64) -> f64 {
    head_mm + HEAD_BELOW_MM
}

/// Returns a counterbore for the heads of a thread.
fn head_recess(thread: &Thread, depth_mm: f64) -> Recess {
    let radius = (thread.head_mm[0] + HEAD_PLAY_MM) / 2.0;
    Recess { radial_mm: radius, along_mm: radius, depth_mm, is_hexagon: false }
}

/// Returns the counterbore in the mounting plate for a screw of the sheath stop.
pub(crate) fn stop_recess() -> Recess {
    head_recess(&STOP_SCREW, STOP_SCREW.head_mm[1] + HEAD_BELOW_MM)
}

/// Returns the pocket in the mounting plate for the head of the axle bolt. It prevents rotation of
/// the bolt.
pub(crate) fn axle_recess() -> Recess {
    let radial_mm = (AXLE_HEAD_MM[0] + RECESS_PLAY_MM) / 2.0;
    let along_mm = radial_mm / libm::cos(std::f64::consts::FRAC_PI_6);
    Recess { radial_mm, along_mm, depth_mm: AXLE_HEAD_MM[1] + HEAD_BELOW_MM, is_hexagon: true }
}

impl Dimensions {
    /// Returns the hardware of this design: the requested hardware, as far as it fits.
    pub fn fastening(&self) -> Fastening {
        let c = self.configuration();
        let f = &c.fasteners;
        let thread = THREADS.into_iter().rev().find(|t| t.least_hole_mm <= f.hole_diameter_mm);
        let fits = |recess: Recess| {
            (f.count > 0 && recess.depth_mm > 0.0 && self.recess_fits(&recess)).then_some(recess)
        };
        let nut_trap = thread.filter(|_| f.kind == FastenerKind::NutTrap).and_then(|t| {
            let flats = (t.nut_mm[0] + RECESS_PLAY_MM) / 2.0;
            let along_mm = flats / libm::cos(std::f64::consts::FRAC_PI_6);
            fits(Recess { radial_mm: flats, along_mm, depth_mm: f.nut_recess_mm, is_hexagon: true })
        });
        let has_mount = c.mount.kind != MountKind::None;
        let counterbore = thread
            .filter(|_| !has_mount || f.kind == FastenerKind::Insert)
            .and_then(|t| fits(head_recess(&t, f.head_recess_mm)));
        let mount_counterbore = thread.filter(|_| has_mount && f.count > 0).and_then(|t| {
            let depth = if self.rests_on_a_table() { t.head_mm[1] + HEAD_BELOW_MM } else { 0.0 };
            let recess = head_recess(&t, f.head_recess_mm.max(depth));
            let is_apart = self.fastener_angles_rad().windows(2).all(|w| self.are_apart(w, &recess));
            let fits = c.mount.plate_mm + ROUNDING_MM >= self.seated_mm(recess.depth_mm) && is_apart;
            (recess.depth_mm > 0.0 && fits).then_some(recess)
        });
        let insert_mm =
            thread.filter(|_| f.kind == FastenerKind::Insert && f.count > 0).and_then(|t| t.insert_mm);
        Fastening { thread, nut_trap, counterbore, mount_counterbore, insert_mm }
    }

    /// Returns the thickness of the membrane above a recess. It is printed as a bridge, and the
    /// screw breaks it.
    pub fn membrane_mm(&self) -> f64 {
        (MEMBRANE_LAYERS * self.configuration().print.layer_mm).max(LEAST_MEMBRANE_MM)
    }

    /// Returns the least wall around a fastener.
    fn rim_mm(&self) -> f64 {
        let p = &self.configuration().print;
        HOLE_EDGE_MM.max(p.least_wall_mm)
    }

    /// Returns whether the mounting plate rests on a flat surface, so that heads must not protrude.
    pub(crate) fn rests_on_a_table(&self) -> bool {
        matches!(self.configuration().mount.kind, MountKind::Flange | MountKind::Rig)
    }

    /// Returns the least thickness of a plate with a recess of `depth_mm`: recess, membrane, and
    /// the seat of the head.
    pub(crate) fn seated_mm(&self, depth_mm: f64) -> f64 {
        depth_mm + self.membrane_mm() + LEAST_SEAT_MM
    }

    /// Returns whether the wall between the recesses of two neighbours is thick enough.
    fn are_apart(&self, angles_rad: &[f64], recess: &Recess) -> bool {
        let chord = 2.0 * self.fastener_radius_mm() * libm::sin((angles_rad[1] - angles_rad[0]) / 2.0);
        chord + ROUNDING_MM >= 2.0 * recess.along_mm + self.rim_mm()
    }

    /// Returns whether a recess fits in the outer face of a support: above a seat, and with walls
    /// to the inner face, the slots, the ends and its neighbours.
    fn recess_fits(&self, recess: &Recess) -> bool {
        let c = self.configuration();
        let (middle, rim) = (self.fastener_radius_mm(), self.rim_mm());
        let inside = middle - recess.radial_mm - self.inner_radius_mm() - rim;
        let under_slots = self.slot().inner_edge_mm() - middle - recess.along_mm.max(recess.radial_mm) - rim;
        let at_ends = c.fasteners.end_distance_mm + self.shell_end_shift_mm() - recess.along_mm - rim;
        let seat = c.support.plate_mm - self.seated_mm(recess.depth_mm);
        let is_enough = |room: f64| room >= -ROUNDING_MM;
        [seat, inside, under_slots].into_iter().all(is_enough)
            && (c.fasteners.count < 2 || is_enough(at_ends))
            && self.fastener_angles_rad().windows(2).all(|w| self.are_apart(w, recess))
    }

    /// Returns whether nut traps in the right support are requested and do not fit.
    pub fn lacks_nut_traps(&self) -> bool {
        let f = &self.configuration().fasteners;
        let is_wanted = f.kind == FastenerKind::NutTrap && f.count > 0 && f.nut_recess_mm > 0.0;
        let fastening = self.fastening();
        is_wanted && fastening.thread.is_some() && fastening.nut_trap.is_none()
    }

    /// Returns whether counterbores in the supports are requested and do not fit.
    pub fn lacks_counterbores(&self) -> bool {
        let (c, fastening) = (self.configuration(), self.fastening());
        let f = &c.fasteners;
        let in_supports = c.mount.kind == MountKind::None || f.kind == FastenerKind::Insert;
        let is_wanted = in_supports && f.count > 0 && f.head_recess_mm > 0.0;
        is_wanted && fastening.thread.is_some() && fastening.counterbore.is_none()
    }

    /// Returns whether a recess in a support is requested and does not fit.
    pub(crate) fn lacks_recesses(&self) -> bool {
        self.lacks_nut_traps() || self.lacks_counterbores()
    }

    /// Returns the lengths of the screws from the left and, with inserts, from the right, mm.
    /// `None` if no screw of a suitable length is sold (ISO 4762).
    pub fn screw_lengths_mm(&self) -> Option<(f64, Option<f64>)> {
        let c = self.configuration();
        let fastening = self.fastening();
        let thread = fastening.thread?;
        let has_mount = c.mount.kind != MountKind::None;
        let depth = |recess: Option<Recess>| recess.map_or(0.0, |r| r.depth_mm);
        let in_support = c.support.plate_mm - depth(fastening.counterbore);
        let left_plates = if has_mount {
            c.support.plate_mm + c.mount.plate_mm - depth(fastening.mount_counterbore)
        } else {
            in_support
        };
        let hole = c.fasteners.hole_diameter_mm;
        if let Some([_, length]) = fastening.insert_mm {
            // The longest screw from each side is limited by the insert, and by its share of the
            // space between both inserts.
            let longest = |plates_mm: f64| {
                let most = plates_mm + length.max(c.shell.width_mm / 2.0 - SCREW_AIR_MM);
                thread.at_most_mm(most).filter(|l| *l >= plates_mm + LEAST_GRIP * hole)
            };
            return Some((longest(left_plates)?, Some(longest(in_support)?)));
        }
        let right = c.support.plate_mm - depth(fastening.nut_trap);
        let stack = left_plates + c.shell.width_mm + right + thread.nut_mm[1] + SCREW_PROTRUSION_MM;
        Some((thread.at_least_mm(stack)?, None))
    }

    /// Returns the distance by which heads, nuts and tips of the screws protrude from the outer face
    /// of the right support, mm. The left support has a mounting plate.
    pub(super) fn right_protrusion_mm(&self) -> f64 {
        let c = self.configuration();
        let fastening = self.fastening();
        let Some(thread) = fastening.thread.filter(|_| c.fasteners.count > 0) else { return 0.0 };
        let depth = |recess: Option<Recess>| recess.map_or(0.0, |r| r.depth_mm);
        if fastening.insert_mm.is_some() {
            return (thread.head_mm[1] - depth(fastening.counterbore)).max(0.0);
        }
        let nut = thread.nut_mm[1] - depth(fastening.nut_trap);
        let under_head = c.mount.plate_mm + c.shell.width_mm + 2.0 * c.support.plate_mm
            - depth(fastening.mount_counterbore);
        let tip = self.screw_lengths_mm().map_or(0.0, |(length, _)| length - under_head);
        nut.max(tip).max(0.0)
    }

    /// Returns half of the width of a fastener along the arc of the shell.
    pub(crate) fn shell_hole_mm(&self) -> f64 {
        let hole = self.configuration().fasteners.hole_diameter_mm;
        self.fastening().insert_mm.map_or(hole, |[bore, _]| bore.max(hole)) / 2.0
    }

    /// Returns half of the largest width of a fastener along the arc, over all parts.
    pub(crate) fn fastener_along_mm(&self) -> f64 {
        let f = self.fastening();
        let hole = self.configuration().fasteners.hole_diameter_mm / 2.0;
        let recesses = [f.nut_trap, f.counterbore].into_iter().flatten().map(|r| r.along_mm);
        recesses.chain(f.insert_mm.map(|[hole, _]| hole / 2.0)).fold(hole, f64::max)
    }

    /// Returns half of the width of a fastener in the mounting plate.
    pub(crate) fn mount_along_mm(&self) -> f64 {
        let hole = self.configuration().fasteners.hole_diameter_mm / 2.0;
        self.fastening().mount_counterbore.map_or(hole, |r| r.along_mm)
    }

    /// Returns the radius of the dowel holes; `None` without dowels.
    pub fn dowel_hole_radius_mm(&self) -> Option<f64> {
        let d = self.configuration().fasteners.dowel_diameter_mm;
        (d > 0.0).then_some((d + DOWEL_PLAY_MM) / 2.0)
    }

    /// Returns the angles of the two dowels, adjacent to the outermost fasteners; empty without
    /// dowels.
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

    /// Returns the depth of the dowel holes in the supports.
    pub fn dowel_depth_mm(&self) -> f64 {
        self.configuration().support.plate_mm / 2.0
    }

    /// Returns the length of the dowels, mm: at least half a millimetre less than the space for
    /// them.
    pub fn dowel_length_mm(&self) -> f64 {
        let room = self.configuration().shell.width_mm + 2.0 * self.dowel_depth_mm();
        ((room - 0.5) * 2.0).floor() / 2.0
    }

    /// Returns whether the walls around the dowels are thick enough.
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
            2.0 * at * libm::sin((own - other).abs() / 2.0) >= needed + rim
        };
        let within = libm::cos(own) > 0.0 || own < self.half_span_rad();
        let in_sector =
            at * libm::sin((self.half_span_rad() - own).min(1.5)) + self.shell_end_shift_mm() >= radius + rim;
        let deep = self.dowel_depth_mm() >= c.print.least_wall_mm;
        radial
            && within
            && in_sector
            && deep
            && own > 0.0
            && self.fastener_angles_rad().iter().chain([&-own]).all(clear)
    }
}
