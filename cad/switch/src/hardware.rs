//! Bought hardware of the assembly as exact solids: inserts, dowels, screws, nuts, and the hardware of a mounting plate.
//!
//! Lengths are those of the bill of materials. Threads are smooth: a shank has the nominal diameter.

use crate::config::MountKind;
use crate::design::{AXLE_HEAD_MM, Design, Hole, Recess, STOP_SCREW, Thread, axle_recess, stop_recess};
use crate::documents::{AXLE_NUT_MM, AXLE_WASHER_MM, BEARING_MM, bill_of_materials};
use crate::parts::spacer_mm;
use crate::rig::rig_hardware;
use pinswitch_solid::profile::{Contour, Point2, polar};
use pinswitch_solid::solid::{Facing, Solid};

/// Radii of the M8 bolt, its washer (ISO 7089) and the rings of a 608 bearing (ISO 15), mm.
const AXLE_MM: f64 = 4.0;
const WASHER_MM: [f64; 2] = [4.2, 8.0];
const BEARING_RING_MM: [f64; 2] = [4.0, 11.0];
/// Radius of an M3 shank, mm.
const STOP_SHANK_MM: f64 = 1.5;
/// Share of a hole that a screw without a metric thread fills.
const SHANK_SHARE: f64 = 0.92;

/// The kind of a bought body, which is the begin of its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HardwareKind {
    /// A heat-set insert.
    Insert,
    /// A dowel.
    Dowel,
    /// A socket screw through support and shell.
    Screw,
    /// Its nut.
    Nut,
    /// The bolt of the guide pulley.
    Bolt,
    /// A screw of the sheath stop.
    StopScrew,
    /// Its nut.
    StopNut,
    /// The bearing of the guide pulley.
    Bearing,
    /// The washer on its bolt.
    Washer,
    /// The nut on its bolt.
    BoltNut,
    /// A bolt through board and foot of the rig.
    FootBolt,
    /// Its washers.
    FootWasher,
    /// Its nut.
    FootNut,
    /// A bolt of the splice of the board.
    SpliceBolt,
    /// Its nut.
    SpliceNut,
    /// The load cell.
    Cell,
    /// A bolt between cell and cell mount.
    CellBolt,
    /// The eye bolt of the cell.
    EyeBolt,
    /// Tendon beyond the guide pulleys.
    Line,
    /// The linear actuator.
    Actuator,
    /// A bolt of the drive.
    DriveBolt,
    /// Its nut.
    DriveNut,
    /// The hook.
    Hook,
    /// The weights.
    Weight,
    /// The bolt on which the links of a joint turn.
    Axle,
    /// A washer on it.
    AxleWasher,
    /// The nut on it.
    AxleNut,
}

impl HardwareKind {
    const fn name(self) -> &'static str {
        match self {
            Self::Insert => "insert",
            Self::Dowel => "dowel",
            Self::Screw => "screw",
            Self::Nut => "nut",
            Self::Bolt => "bolt",
            Self::StopScrew => "stop-screw",
            Self::StopNut => "stop-nut",
            Self::Bearing => "bearing",
            Self::Washer => "washer",
            Self::BoltNut => "bolt-nut",
            Self::Axle => "axle",
            Self::AxleWasher => "axle-washer",
            Self::AxleNut => "axle-nut",
            Self::FootBolt => "foot-bolt",
            Self::FootWasher => "foot-washer",
            Self::FootNut => "foot-nut",
            Self::SpliceBolt => "splice-bolt",
            Self::SpliceNut => "splice-nut",
            Self::Cell => "load-cell",
            Self::CellBolt => "cell-bolt",
            Self::EyeBolt => "eye-bolt",
            Self::Line => "line",
            Self::Actuator => "actuator",
            Self::DriveBolt => "drive-bolt",
            Self::DriveNut => "drive-nut",
            Self::Hook => "hook",
            Self::Weight => "weight",
        }
    }

    /// Returns whether the body is a part of the rig outside of the switch: feet, cell, drive or load.
    pub(crate) const fn is_of_stand(self) -> bool {
        matches!(
            self,
            Self::FootBolt
                | Self::FootWasher
                | Self::FootNut
                | Self::Cell
                | Self::CellBolt
                | Self::EyeBolt
                | Self::Line
                | Self::Actuator
                | Self::DriveBolt
                | Self::DriveNut
                | Self::Hook
                | Self::Weight
        )
    }

    /// Returns the colour in pictures: red, green, blue.
    pub const fn colour(self) -> [u8; 3] {
        match self {
            Self::Line => [72, 82, 96],
            Self::Cell => [120, 160, 205],
            Self::Actuator => [92, 100, 112],
            Self::Weight => [196, 160, 84],
            Self::Insert => [204, 160, 60],
            _ => [104, 112, 126],
        }
    }
}

/// A bought body in its position in the assembly.
#[derive(Clone, Debug)]
pub struct Hardware {
    /// Kind.
    pub kind: HardwareKind,
    /// Kind and number, such as `screw-2`.
    pub name: String,
    /// Exact solid, in the frame of the assembly.
    pub solid: Solid,
    /// Whether it is put in from the right side, at larger z.
    pub from_right: bool,
}

/// Returns all bought bodies of the assembly except pins and tendon.
pub fn hardware(design: &Design) -> Vec<Hardware> {
    let mut all = Vec::new();
    let mut add = |kind: HardwareKind, from_right: bool, solid: Option<Solid>| {
        all.extend(solid.map(|solid| (kind, from_right, solid)));
    };
    fasteners(design, &mut add);
    dowels(design, &mut add);
    in_the_plate(design, &mut add);
    on_the_bolts(design, &mut add);
    on_the_axle(design, &mut add);
    rig_hardware(design, &mut add);
    let mut named: Vec<Hardware> = Vec::with_capacity(all.len());
    for (kind, from_right, solid) in all {
        let number = named.iter().filter(|body| body.kind == kind).count() + 1;
        named.push(Hardware { kind, name: format!("{}-{number}", kind.name()), solid, from_right });
    }
    named
}

/// Adds inserts, screws and nuts at every hole of the shell.
fn fasteners(design: &Design, add: &mut impl FnMut(HardwareKind, bool, Option<Solid>)) {
    let c = design.configuration();
    let fastening = design.fastening();
    let places: Vec<(f64, Point2)> = design
        .fastener_angles_rad()
        .into_iter()
        .map(|a| (a, polar(design.fastener_radius_mm(), a)))
        .collect();
    let width = c.shell.width_mm;
    for (_, at) in &places {
        if let Some([bore_mm, length_mm]) = fastening.insert_mm {
            let outline = Contour::circle(*at, bore_mm / 2.0);
            add(HardwareKind::Insert, false, prism(&outline, None, [0.0, length_mm]));
            add(HardwareKind::Insert, true, prism(&outline, None, [width - length_mm, width]));
        }
    }
    let Some(bill) = bill_of_materials(design).fasteners else { return };
    let hole = c.fasteners.hole_diameter_mm;
    let shank_mm = fastening.thread.as_ref().and_then(radius_mm).unwrap_or(hole / 2.0 * SHANK_SHARE);
    let [head_wide, head_high] = fastening.thread.map_or([1.8 * hole, hole], |t| t.head_mm);
    let [flats, nut_high] = fastening.thread.map_or([1.8 * hole, 0.8 * hole], |t| t.nut_mm);
    let depth = |recess: Option<Recess>| recess.map_or(0.0, |r| r.depth_mm);
    let left_face = if c.mount.kind == MountKind::None {
        -c.support.plate_mm + depth(fastening.counterbore)
    } else {
        -(c.support.plate_mm + c.mount.plate_mm) + depth(fastening.mount_counterbore)
    };
    let right_face = width + c.support.plate_mm;
    let radii = [shank_mm, head_wide / 2.0];
    for (angle, at) in places {
        add(HardwareKind::Screw, false, Some(screw(at, radii, left_face, bill.length_mm, head_high)));
        if bill.inserts > 0 {
            let length_mm = bill.right_length_mm.unwrap_or(bill.length_mm);
            let face = right_face - depth(fastening.counterbore);
            add(HardwareKind::Screw, true, Some(screw(at, radii, face, -length_mm, head_high)));
        } else {
            let seat = right_face - depth(fastening.nut_trap);
            let bore = Contour::circle(at, shank_mm).reversed();
            add(
                HardwareKind::Nut,
                true,
                prism(&hexagon(at, flats, angle), Some(bore), [seat, seat + nut_high]),
            );
        }
    }
}

fn dowels(design: &Design, add: &mut impl FnMut(HardwareKind, bool, Option<Solid>)) {
    let c = design.configuration();
    let (half, middle) = (design.dowel_length_mm() / 2.0, c.shell.width_mm / 2.0);
    for angle in design.dowel_angles_rad() {
        let at = polar(design.fastener_radius_mm(), angle);
        let outline = Contour::circle(at, c.fasteners.dowel_diameter_mm / 2.0);
        add(HardwareKind::Dowel, true, prism(&outline, None, [middle - half, middle + half]));
    }
}

/// Heights of the outer and the inner face of the mounting plate in the assembly.
fn faces_mm(design: &Design) -> [f64; 2] {
    let c = design.configuration();
    [-(c.support.plate_mm + c.mount.plate_mm), -c.support.plate_mm]
}

/// Adds the bolts of the axles, and screws and nuts of the sheath stop.
fn in_the_plate(design: &Design, add: &mut impl FnMut(HardwareKind, bool, Option<Solid>)) {
    let (Some(mounting), Some(bill)) = (design.mounting(), bill_of_materials(design).mount) else { return };
    let [outer, inner] = faces_mm(design);
    for (Hole { centre, .. }, length_mm) in mounting.axles().zip(std::iter::repeat(bill.axle_length_mm)) {
        let Some(length_mm) = length_mm else { continue };
        let [flats, high] = AXLE_HEAD_MM;
        let seat = outer + axle_recess().depth_mm;
        let head = hexagon(centre, flats, 0.0);
        add(
            HardwareKind::Bolt,
            false,
            Some(stepped(&head, [seat - high, seat], &Contour::circle(centre, AXLE_MM), length_mm)),
        );
    }
    let screws = mounting.sheath.into_iter().flat_map(|stop| stop.screws);
    for (Hole { centre, .. }, length_mm) in screws.zip(std::iter::repeat(bill.stop_screw_length_mm)) {
        let Some(length_mm) = length_mm else { continue };
        let ([wide, high], [flats, nut_high]) = (STOP_SCREW.head_mm, STOP_SCREW.nut_mm);
        let seat = outer + stop_recess().depth_mm;
        let floor = inner + design.sheath_floor_mm();
        let radii = [STOP_SHANK_MM, wide / 2.0];
        add(HardwareKind::StopScrew, false, Some(screw(centre, radii, seat, length_mm, high)));
        let bore = Contour::circle(centre, STOP_SHANK_MM).reversed();
        let span = [floor, floor + nut_high];
        add(HardwareKind::StopNut, false, prism(&hexagon(centre, flats, 0.0), Some(bore), span));
    }
}

/// Adds bearing, washer and nut on the bolt of each guide pulley.
fn on_the_bolts(design: &Design, add: &mut impl FnMut(HardwareKind, bool, Option<Solid>)) {
    for axle in design.mounting().iter().flat_map(|m| m.axles()) {
        on_the_bolt(design, axle, add);
    }
}

fn on_the_bolt(design: &Design, axle: Hole, add: &mut impl FnMut(HardwareKind, bool, Option<Solid>)) {
    let bearing = faces_mm(design)[1] + spacer_mm(design);
    let washer = bearing + BEARING_MM;
    let nut = washer + AXLE_WASHER_MM;
    let ring = |[inner, outer]: [f64; 2], span| {
        let bore = Contour::circle(axle.centre, inner).reversed();
        prism(&Contour::circle(axle.centre, outer), Some(bore), span)
    };
    add(HardwareKind::Bearing, true, ring(BEARING_RING_MM, [bearing, washer]));
    add(HardwareKind::Washer, true, ring(WASHER_MM, [washer, nut]));
    let bore = Contour::circle(axle.centre, AXLE_MM).reversed();
    let outline = hexagon(axle.centre, AXLE_HEAD_MM[0], 0.0);
    add(HardwareKind::BoltNut, true, prism(&outline, Some(bore), [nut, nut + AXLE_NUT_MM]));
}

/// Adds the axle of a joint, with washers on both sides of the distal link and a nut.
fn on_the_axle(design: &Design, add: &mut impl FnMut(HardwareKind, bool, Option<Solid>)) {
    let Some(joint) = design.joint() else { return };
    let Some(length_mm) = joint.axle_length_mm else { return };
    let (bolt, levels, middle) = (&joint.axle, &joint.levels, Point2::origin());
    let [flats, head_high] = bolt.head_mm;
    let plate_mm = design.configuration().mount.plate_mm;
    let seat = levels.proximal_mm - plate_mm + joint.head_recess().depth_mm;
    let shank = Contour::circle(middle, bolt.diameter_mm / 2.0);
    let head = hexagon(middle, flats, 0.0);
    add(HardwareKind::Axle, false, Some(stepped(&head, [seat - head_high, seat], &shank, length_mm)));
    let [inner_mm, outer_mm, washer_high] = bolt.washer_mm;
    let washer = |from: f64| {
        let bore = Contour::circle(middle, inner_mm / 2.0).reversed();
        prism(&Contour::circle(middle, outer_mm / 2.0), Some(bore), [from, from + washer_high])
    };
    let outer = levels.distal_mm + plate_mm;
    add(HardwareKind::AxleWasher, true, washer(levels.proximal_mm));
    add(HardwareKind::AxleWasher, true, washer(outer));
    let (bore, nut) = (shank.reversed(), outer + washer_high);
    let outline = hexagon(middle, flats, 0.0);
    add(HardwareKind::AxleNut, true, prism(&outline, Some(bore), [nut, nut + bolt.nut_mm]));
}

/// Radius of a metric thread, mm, from its name.
fn radius_mm(thread: &Thread) -> Option<f64> {
    thread.name.strip_prefix('M')?.parse::<f64>().ok().map(|diameter| diameter / 2.0)
}

/// A hexagon with a flat in the direction `angle_rad`, as the recesses of nuts and heads have it.
pub(crate) fn hexagon(middle: Point2, flats_mm: f64, angle_rad: f64) -> Contour {
    let first = angle_rad + std::f64::consts::FRAC_PI_6;
    let at = |i: u32| first + f64::from(i) * std::f64::consts::FRAC_PI_3;
    let corner = |i: u32| middle + polar(flats_mm / 3f64.sqrt(), at(i)).coords;
    // Angles of `polar` run clockwise.
    Contour::polygon((0..6).rev().map(corner).collect())
}

/// A body between two heights, with a bore or without; `None` for an outline without area.
pub(crate) fn prism(outline: &Contour, bore: Option<Contour>, [from_mm, to_mm]: [f64; 2]) -> Option<Solid> {
    let holes: Vec<Contour> = bore.into_iter().collect();
    Solid::prism(outline, &holes, from_mm, to_mm, 0.0).ok()
}

/// A screw with a round head on `face_mm`, whose shank of signed length points up or down.
fn screw(at: Point2, [shank_mm, head_mm]: [f64; 2], face_mm: f64, length_mm: f64, high_mm: f64) -> Solid {
    let (shank, head) = (Contour::circle(at, shank_mm), Contour::circle(at, head_mm));
    let head_span = if length_mm > 0.0 { [face_mm - high_mm, face_mm] } else { [face_mm, face_mm + high_mm] };
    stepped(&head, head_span, &shank, length_mm)
}

/// A head between two heights, and a thinner shank of signed length, up from its upper or down from its lower face.
pub(crate) fn stepped(head: &Contour, [low_mm, high_mm]: [f64; 2], shank: &Contour, length_mm: f64) -> Solid {
    let mut solid = Solid::new();
    let (bottom, top) = solid.extrude(head, low_mm, high_mm);
    if length_mm > 0.0 {
        let foot = solid.boss(shank, high_mm, high_mm + length_mm);
        solid.cap(Facing::Down, bottom, &[]);
        solid.cap(Facing::Up, top, &[foot]);
    } else {
        let (tip, root) = solid.extrude(shank, low_mm + length_mm, low_mm);
        solid.cap(Facing::Down, tip, &[]);
        solid.cap(Facing::Down, bottom, &[root]);
        solid.cap(Facing::Up, top, &[]);
    }
    solid
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::read;
    use pinswitch_solid::validity::{Expectation, examine};

    fn of(text: &str) -> (Design, Vec<Hardware>) {
        let design = Design::new(read(text, "x.toml").unwrap().0).unwrap();
        let all = hardware(&design);
        (design, all)
    }

    fn count(all: &[Hardware], kind: HardwareKind) -> usize {
        all.iter().filter(|body| body.kind == kind).count()
    }

    /// The assembly contains every bought body of the bill of materials, each as a valid solid.
    #[test]
    fn every_bought_body_is_there() {
        for text in [
            "",
            "[fasteners]\nkind = \"screw\"\n",
            "[fasteners]\nkind = \"insert\"\ndowel_diameter_mm = 2.0\n[mount]\nkind = \"rig\"\n[tendon]\nsheath_diameter_mm = 3.0\n",
            "[mount]\nkind = \"flange\"\n",
            "[mount]\nkind = \"joint\"\n",
            "[mount]\nkind = \"joint\"\naxle_mm = 6.0\n[fasteners]\nkind = \"insert\"\n",
        ] {
            let (design, all) = of(text);
            let bill = bill_of_materials(&design);
            let fasteners = bill.fasteners.unwrap();
            assert_eq!(count(&all, HardwareKind::Screw), fasteners.number, "{text}");
            assert_eq!(count(&all, HardwareKind::Nut), fasteners.nuts, "{text}");
            assert_eq!(count(&all, HardwareKind::Insert), fasteners.inserts, "{text}");
            assert_eq!(count(&all, HardwareKind::Dowel), bill.dowels.map_or(0, |d| d.number), "{text}");
            let mount = bill.mount;
            let bearings = mount.as_ref().map_or(0, |m| m.pulleys);
            for kind in
                [HardwareKind::Bearing, HardwareKind::Bolt, HardwareKind::Washer, HardwareKind::BoltNut]
            {
                assert_eq!(count(&all, kind), bearings, "{text} {kind:?}");
            }
            let axles = design.joint().iter().count();
            for (kind, each) in
                [(HardwareKind::Axle, 1), (HardwareKind::AxleWasher, 2), (HardwareKind::AxleNut, 1)]
            {
                assert_eq!(count(&all, kind), each * axles, "{text} {kind:?}");
            }
            assert!(
                axles == 0 || mount.as_ref().is_some_and(|m| m.axle.is_some() && m.crimp_sleeve.is_some())
            );
            let stops = mount.and_then(|m| m.stop_screw_length_mm).map_or(0, |_| 2);
            assert_eq!(count(&all, HardwareKind::StopScrew), stops, "{text}");
            assert_eq!(count(&all, HardwareKind::StopNut), stops, "{text}");
            for body in &all {
                let mesh = body.solid.mesh(design.tolerance()).unwrap();
                let report = examine(&mesh, &Expectation::default());
                assert!(report.faults.is_empty(), "{text} {}: {:?}", body.name, report.faults);
                let share = report.facts.volume_mm3 / body.solid.volume_mm3();
                assert!((share - 1.0).abs() < 0.02, "{text} {}: {share}", body.name);
            }
            let mut names: Vec<_> = all.iter().map(|body| &body.name).collect();
            names.sort();
            names.dedup();
            assert_eq!(names.len(), all.len());
        }
    }

    /// Screws start at the outer face. Their tips are beyond the nut, or in the shell between the inserts.
    #[test]
    fn screws_have_the_length_of_the_bill() {
        for (text, tips_meet) in [("", false), ("[fasteners]\nkind = \"insert\"\n", true)] {
            let (design, all) = of(text);
            let c = design.configuration();
            let fastening = design.fastening();
            let head_mm = fastening.thread.unwrap().head_mm[1];
            let length_mm = bill_of_materials(&design).fasteners.unwrap().length_mm;
            let screws: Vec<_> = all.iter().filter(|body| body.kind == HardwareKind::Screw).collect();
            assert_eq!(screws.len(), if tips_meet { 4 } else { 2 });
            for body in screws {
                let (low, high) = body.solid.bounds().map(|(low, high)| (low.z, high.z)).unwrap();
                assert!((high - low - head_mm - length_mm).abs() < 1e-9, "{low} to {high}");
                let outer = c.shell.width_mm + c.support.plate_mm;
                assert!(tips_meet || high > outer, "{high}");
                let middle = c.shell.width_mm / 2.0;
                assert!(!tips_meet || (if body.from_right { low > middle } else { high < middle }));
            }
        }
    }
}
