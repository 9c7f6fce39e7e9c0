//! The assembly, measured on exact sections of its bodies: screws and dowels pass, nothing overlaps, the layer cannot slide,
//! casts can be removed, and every wall can be printed.

use std::path::Path;

use super::sections::Section;
use super::{Part, Role, printed, reference_bodies, silicone_layer, touches};
use crate::config::{Configuration, MountKind, assign, read};
use crate::design::Design;
use pinswitch_solid::profile::{Contour, Point2, polar};

/// Chord tolerance of the polygons of sections, mm.
const FINE_MM: f64 = 5e-3;
/// Largest overlap of bodies that touch, mm: the error of the polygons.
pub(super) const TOUCHING_MM: f64 = 0.02;

pub(super) fn design(assignments: &[&str]) -> Design {
    let mut c = Configuration::default();
    assignments.iter().for_each(|a| assign(&mut c, a).unwrap());
    Design::new(c).unwrap()
}

/// Every design of `tests/corpus` whose file name starts with `hardware-`.
pub(super) fn corpus() -> Vec<(String, Design)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/corpus");
    let mut files: Vec<_> = std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()).collect();
    files.sort();
    let name = |p: &Path| p.file_name().unwrap().to_string_lossy().into_owned();
    let ours = files.into_iter().filter(|p| name(p).starts_with("hardware-"));
    let all: Vec<_> = ours
        .map(|path| {
            let (configuration, _) = read(&std::fs::read_to_string(&path).unwrap(), &name(&path)).unwrap();
            (name(&path), Design::new(configuration).unwrap())
        })
        .collect();
    assert!(all.len() >= 30, "{}", all.len());
    all
}

pub(super) fn section(part: &Part, z_mm: f64) -> Section {
    Section::new(&part.solid, part.pose.or(part.tool_pose).unwrap(), z_mm, FINE_MM)
}

/// Heights of the rings of a part in the assembly.
pub(super) fn heights_mm(part: &Part) -> Vec<f64> {
    let pose = part.pose.or(part.tool_pose).unwrap();
    let own = part.solid.heights_mm().into_iter();
    own.map(|z| if pose.flipped { pose.z_mm - z } else { pose.z_mm + z }).collect()
}

/// Middles of the intervals between all heights of the parts.
pub(super) fn levels_mm(parts: &[&Part]) -> Vec<f64> {
    let mut all: Vec<f64> = parts.iter().flat_map(|p| heights_mm(p)).collect();
    all.sort_by(f64::total_cmp);
    all.windows(2).filter(|w| w[1] - w[0] > 1e-6).map(|w| f64::midpoint(w[0], w[1])).collect()
}

pub(super) fn assembled(design: &Design) -> Vec<Part> {
    let all = [printed(design).unwrap(), reference_bodies(design).unwrap()].concat();
    let has_layer = all.iter().any(|p| p.role == Role::Layer);
    all.into_iter().filter(|p| p.pose.is_some() && !(has_layer && p.role == Role::Proxy)).collect()
}

/// An overlap of two of the bodies.
pub(super) fn overlap(parts: &[Part]) -> Option<String> {
    for (i, a) in parts.iter().enumerate() {
        for b in &parts[i + 1..] {
            for z in levels_mm(&[a, b]) {
                let (at_a, at_b) = (section(a, z), section(b, z));
                if at_a.exact.is_empty() || at_b.exact.is_empty() {
                    continue;
                }
                for (depth, place) in [at_a.depth_mm(&at_b), at_b.depth_mm(&at_a)] {
                    if depth > TOUCHING_MM {
                        return Some(format!(
                            "{} and {} overlap by {depth:.3} at {place} {z}",
                            a.name, b.name
                        ));
                    }
                }
            }
        }
    }
    None
}

#[test]
fn no_two_bodies_of_an_assembly_overlap() {
    for (name, design) in corpus() {
        assert_eq!(overlap(&assembled(&design)), None, "{name}");
    }
    assert_eq!(overlap(&assembled(&design(&["layout.pins=[5, 8, 11]"]))), None);
    // The test can fail: a body inside of the shell.
    let twice = printed(&design(&[])).unwrap().remove(0);
    let mut lifted = twice.clone();
    lifted.name.push('2');
    lifted.solid =
        pinswitch_solid::solid::Solid::prism(&Contour::circle(polar(18.0, 0.0), 1.0), &[], 0.0, 5.0, 0.0)
            .unwrap();
    assert!(overlap(&[twice, lifted]).is_some());
}

/// With wraps of more than 180 degrees, the ends of the tendon, the guide pulley and the sheath stop approach each other.
#[test]
fn wide_wraps_are_refused_or_clear() {
    let (mut made, mut refused) = (0, 0);
    for wrap in [200, 215, 230, 250, 280, 300] {
        for more in [
            &["mount.kind=none"][..],
            &["mount.kind=rig"],
            &["mount.kind=rig", "tendon.sheath_diameter_mm=4"],
            &["mount.kind=rig", "tendon.sheath_diameter_mm=5", "mount.pulley_distance_mm=110"],
            &["mount.kind=flange", "tendon.sheath_diameter_mm=3"],
        ] {
            let mut c = Configuration::default();
            let wide = [format!("segment.span_deg={}", wrap + 8), format!("layout.wrap_angle_deg={wrap}")];
            let all =
                wide.iter().map(String::as_str).chain(["segment.grooves=25"]).chain(more.iter().copied());
            all.for_each(|a| assign(&mut c, a).unwrap());
            match crate::feasibility::design(c) {
                Ok(design) => {
                    assert_eq!(overlap(&assembled(&design)), None, "{wrap} {more:?}");
                    made += 1;
                }
                Err(e) => {
                    assert!(!e.changes().is_empty(), "{wrap} {more:?}: {e}");
                    refused += 1;
                }
            }
        }
    }
    assert!(made >= 10 && refused >= 5, "{made} {refused}");
}

/// Every screw has a clear hole through shell, supports and plate, on one axis, except for the skin above a recess. Every
/// dowel has a hole that is closed outside.
#[test]
fn screws_and_dowels_pass_on_one_axis() {
    for (name, design) in corpus() {
        let c = design.configuration();
        let parts = assembled(&design);
        let joined: Vec<&Part> = parts
            .iter()
            .filter(|p| {
                matches!(p.role, Role::Shell | Role::Support { .. })
                    || ["base-flange", "link-proximal", "rig-plate"].contains(&p.name.as_str())
            })
            .collect();
        for part in &joined {
            for angle in design.fastener_angles_rad() {
                let axis = polar(design.fastener_radius_mm(), angle);
                let mut closed_mm = 0.0;
                let mut heights = heights_mm(part);
                heights.sort_by(f64::total_cmp);
                for w in heights.windows(2).filter(|w| w[1] - w[0] > 1e-6) {
                    let here = section(part, f64::midpoint(w[0], w[1]));
                    if here.contains(axis) {
                        closed_mm += w[1] - w[0];
                    } else {
                        let free = here.distance_mm(axis) - c.fasteners.hole_diameter_mm / 2.0;
                        assert!(free > -1e-9, "{name}: {} is off the axis by {free}", part.name);
                    }
                }
                assert!(
                    closed_mm < design.membrane_mm() + 1e-6,
                    "{name}: {} is closed for {closed_mm}",
                    part.name
                );
            }
        }
        for angle in design.dowel_angles_rad() {
            let axis = polar(design.fastener_radius_mm(), angle);
            let length = design.dowel_length_mm();
            let middle = c.shell.width_mm / 2.0;
            for share in [-0.499, -0.3, 0.0, 0.3, 0.499] {
                for part in &joined {
                    let here = section(part, middle + share * length);
                    let free = here.distance_mm(axis) - c.fasteners.dowel_diameter_mm / 2.0;
                    assert!(!here.contains(axis) && free > 0.0, "{name}: {} at {share}", part.name);
                }
            }
            let outside = c.shell.width_mm + c.support.plate_mm - 0.01;
            let right = joined.iter().find(|p| p.name == "support-right").unwrap();
            assert!(section(right, outside).contains(axis), "{name}");
        }
    }
}

/// Boards, feet and splice of rigs, in one part and in two.
const RIGS: [&[&str]; 6] = [
    &["mount.kind=rig", "layout.pins=[5, 8, 11]"],
    &["mount.kind=rig", "print.bed_mm=165", "rig.drive=crank"],
    &["mount.kind=rig", "rig.cell=bar", "rig.weight_diameter_mm=300", "print.bed_mm=350"],
    &[
        "mount.kind=rig",
        "rig.cell=bar",
        "rig.tendon_height_mm=45",
        "rig.drive=crank",
        "rig.weight_diameter_mm=10",
    ],
    &["mount.kind=rig", "layout.wrap_angle_deg=150", "segment.span_deg=160", "mount.pulley_distance_mm=90"],
    &["mount.kind=rig", "tendon.sheath_diameter_mm=4", "rig.tendon_height_mm=120"],
];

/// Axes of the bought bodies that pass through parts of a rig, with half of their width.
fn bolts(design: &Design) -> Vec<(Point2, f64, [f64; 2])> {
    use crate::hardware::{HardwareKind, hardware};
    let is_bolt = |kind| {
        matches!(
            kind,
            HardwareKind::FootBolt | HardwareKind::SpliceBolt | HardwareKind::DriveBolt | HardwareKind::Bolt
        )
    };
    let of = |body: crate::hardware::Hardware| {
        // The shank is the thinnest section.
        let (low, high) = body.solid.bounds().unwrap();
        let middle = nalgebra::center(&low, &high);
        let ends = [low.z + 1e-3, high.z - 1e-3].map(|z| {
            let section = body.solid.section(z);
            let (a, b) = section[0].bounds();
            (b.x - a.x) / 2.0
        });
        (middle.xy(), ends[0].min(ends[1]), [low.z, high.z])
    };
    hardware(design).into_iter().filter(|body| is_bolt(body.kind)).map(of).collect()
}

/// Every bolt of a rig passes through holes that are on its axis, in every part at its height.
#[test]
fn rig_bolts_pass_on_one_axis() {
    for set in RIGS {
        let design = design(set);
        let parts = assembled(&design);
        let bolts = bolts(&design);
        assert!(bolts.len() >= 7, "{set:?}: {}", bolts.len());
        for (axis, radius, [low, high]) in bolts {
            let mut passed = 0;
            for part in parts.iter().filter(|p| matches!(p.role, Role::Mount | Role::Stand | Role::Accessory))
            {
                let mut heights = heights_mm(part);
                heights.sort_by(f64::total_cmp);
                for w in heights.windows(2).filter(|w| w[1] - w[0] > 1e-6) {
                    let z = f64::midpoint(w[0], w[1]);
                    if z < low || z > high || w[1] - w[0] < design.membrane_mm() + 1e-6 {
                        continue;
                    }
                    let here = section(part, z);
                    let near = here.distance_mm(axis);
                    if here.contains(axis) {
                        panic!("{set:?}: {} blocks the bolt at {axis}, z = {z}", part.name);
                    }
                    // A hole around the bolt is round about its axis: its outline is near on all sides.
                    if near < 8.0 {
                        let hole =
                            here.exact.iter().find(|c| (c.distance_mm(axis) - near).abs() < 1e-9).unwrap();
                        let (a, b) = hole.bounds();
                        let is_round = hole.area_mm2() < 0.0;
                        assert!(near >= radius - 1e-9, "{set:?}: {} touches the bolt at {axis}", part.name);
                        if is_round {
                            let off = (nalgebra::center(&a, &b) - axis).norm();
                            assert!(off < 1e-9, "{set:?}: {} is off the axis by {off}", part.name);
                            passed += 1;
                        }
                    }
                }
            }
            assert!(passed >= 1, "{set:?}: the bolt at {axis} passes no hole");
        }
    }
}

/// The hanging tendon clears every body; the weights clear the table, and no body is below the table's top beyond its edge.
#[test]
fn the_load_of_a_rig_hangs_free() {
    use crate::hardware::{HardwareKind, hardware};
    for set in RIGS {
        let design = design(set);
        let layout = design.rig_layout().unwrap();
        let c = design.configuration();
        let half = c.rig.weight_diameter_mm / 2.0;
        assert!(layout.edge_x_mm - layout.load_x_mm >= half + 9.999, "{set:?}");
        assert!(layout.table_y_mm < layout.load_axle.y, "{set:?}");
        let z = c.shell.width_mm / 2.0;
        for part in assembled(&design).iter().filter(|p| p.role != Role::Tendon) {
            // Nothing is under the table's top, where the weights move.
            let (low, _) = part.solid.bounds().unwrap();
            assert!(low.y >= layout.table_y_mm - 1e-9, "{set:?}: {} at {}", part.name, low.y);
            let here = section(part, z);
            for step in 0..200 {
                let y = layout.load_axle.y - f64::from(step) * 0.5;
                let p = Point2::new(layout.load_x_mm, y);
                let air = if y > layout.load_axle.y - 0.1 { 0.8 } else { 0.849 };
                let free = here.exact.is_empty() || (!here.contains(p) && here.distance_mm(p) >= air);
                assert!(free, "{set:?}: {} touches the tendon at {p}", part.name);
            }
        }
        for body in hardware(&design) {
            let (low, high) = body.solid.bounds().unwrap();
            let is_load = matches!(body.kind, HardwareKind::Hook | HardwareKind::Weight | HardwareKind::Line);
            if is_load && low.y < layout.table_y_mm {
                assert!(high.x < layout.edge_x_mm - 9.999 + 1e-6, "{set:?}: {} at {}", body.name, high.x);
            } else {
                assert!(low.y >= layout.table_y_mm - 1e-9, "{set:?}: {} at {}", body.name, low.y);
            }
        }
    }
}

/// No two bodies of a rig overlap, bought ones included. Threads and rings that are put together are left out.
#[test]
fn bodies_of_a_rig_do_not_overlap() {
    use crate::hardware::hardware;
    for set in RIGS {
        let design = design(set);
        let parts = assembled(&design);
        assert_eq!(overlap(&parts), None, "{set:?}");
        let large =
            ["load-cell", "actuator", "weight", "eye-bolt", "foot-washer", "bolt-nut", "bearing", "line"];
        let bought =
            hardware(&design).into_iter().filter(|b| large.iter().any(|name| b.name.starts_with(name)));
        let stand: Vec<Part> =
            parts.into_iter().filter(|p| matches!(p.role, Role::Mount | Role::Stand)).collect();
        for body in bought {
            let twin = stand[0].with_solid(body.solid);
            let twin =
                Part { name: body.name, pose: Some(pinswitch_solid::pose::Pose::upright(0.0)), ..twin };
            for part in &stand {
                assert_eq!(overlap(&[part.clone(), twin.clone()]), None, "{set:?}");
            }
        }
    }
}

/// Nothing of a rig's stand needs support: each layer is on the one below it, except for skins over pockets and slopes.
#[test]
fn stands_print_without_support() {
    for set in RIGS {
        let design = design(set);
        for part in printed(&design).unwrap().iter().filter(|p| p.role == Role::Stand) {
            let mut levels = part.solid.heights_mm();
            levels.sort_by(f64::total_cmp);
            let upright = Part { pose: Some(pinswitch_solid::pose::Pose::upright(0.0)), ..part.clone() };
            let at: Vec<Section> = levels
                .windows(2)
                .filter(|w| w[1] - w[0] > 1e-6)
                .map(|w| section(&upright, f64::midpoint(w[0], w[1])))
                .collect();
            for pair in at.windows(2) {
                let [below, above] = pair else { continue };
                for p in above.polygons.iter().flatten() {
                    // A slope of 45 degrees reaches half of its height beyond the middle of the layer below.
                    let is_carried = below.contains(*p) || below.distance_mm(*p) < 3.01;
                    assert!(is_carried, "{set:?}: {} at {p}", part.name);
                }
            }
        }
    }
}

/// Both guide pulleys have the paper's radius, and the tendon leaves them horizontally and vertically.
#[test]
fn both_guide_pulleys_lead_the_tendon() {
    let design = design(RIGS[0]);
    let layout = design.rig_layout().unwrap();
    let parts = assembled(&design);
    let z = design.configuration().shell.width_mm / 2.0;
    for (name, axle) in [("guide-pulley", layout.load_axle), ("guide-pulley-2", layout.drive_axle)] {
        let pulley = parts.iter().find(|p| p.name == name).unwrap();
        let groove = section(pulley, z);
        let outline = groove.exact.iter().max_by(|a, b| a.area_mm2().total_cmp(&b.area_mm2())).unwrap();
        assert!(((outline.area_mm2() / std::f64::consts::PI).sqrt() - 22.0).abs() < 1e-9, "{name}");
        let (low, high) = outline.bounds();
        assert!((nalgebra::center(&low, &high) - axle).norm() < 1e-9, "{name}");
    }
    let outwards = polar(1.0, design.half_wrap_rad());
    let reach = layout.drive_axle.coords.dot(&outwards.coords);
    assert!((reach - design.tendon_axis_radius_mm() - 22.85).abs() < 1e-9);
    assert!((layout.drive_axle.y - layout.line_y_mm - 22.85).abs() < 1e-9);
    assert!((layout.load_axle.x - layout.load_x_mm - 22.85).abs() < 1e-9);
    let tendon = parts.iter().find(|p| p.role == Role::Tendon).unwrap();
    let (low, high) = tendon.solid.bounds().unwrap();
    assert!((low.x - (layout.load_x_mm - 0.85)).abs() < 0.03, "{}", low.x);
    assert!((high.x - (layout.drive_axle.x + 20.0)).abs() < 1e-9, "{}", high.x);
}

/// Nuts and heads fit into their recesses and cannot rotate; inserts have a hole at both ends of the shell.
#[test]
fn hardware_fits_its_recesses() {
    let nut = design(&["layout.pins=[5, 8, 11]"]);
    let trap = nut.fastening().nut_trap.unwrap();
    // ISO 4032: M3 is 5.5 mm across flats, and 6.01 mm across corners at the least.
    assert!(2.0 * trap.radial_mm > 5.5 && 2.0 * trap.radial_mm < 6.01, "{trap:?}");
    let head = design(&["fasteners.head_recess_mm=1.5"]).fastening().counterbore.unwrap();
    assert!(2.0 * head.radial_mm > 5.68, "{head:?}");
    // A plate on a table contains every head by default: M3 heads are 3 mm high, M4 heads 4 mm.
    for (assignments, least) in [
        (&["mount.kind=flange", "fasteners.head_recess_mm=3.6"][..], 3.6),
        (&["mount.kind=flange"], 3.0),
        (&["mount.kind=rig"], 3.0),
        (
            &[
                "mount.kind=rig",
                "fasteners.hole_diameter_mm=4.5",
                "shell.wall_mm=11",
                "fasteners.end_distance_mm=5",
            ],
            4.0,
        ),
    ] {
        let sunk = design(assignments);
        let depth = sunk.fastening().mount_counterbore.unwrap().depth_mm;
        assert!(depth >= least && depth < sunk.configuration().mount.plate_mm, "{assignments:?}: {depth}");
    }
    // It also contains the head of the bolt of the axle, 5.3 mm (ISO 4017), which cannot rotate, and those of the sheath stop.
    let rig = design(&["mount.kind=rig", "tendon.sheath_diameter_mm=3"]);
    let plate = printed(&rig).unwrap().into_iter().find(|p| p.name == "rig-plate").unwrap();
    let mounting = rig.mounting().unwrap();
    // From the face on the table.
    let outer = plate.pose.unwrap().z_mm;
    let open = |z: f64, at: Point2| section(&plate, outer + z).distance_mm(at);
    for z in [0.01, 5.29] {
        let half = open(z, mounting.axle.unwrap().centre);
        assert!(half > 6.5 && half < 13.0 / 3.0_f64.sqrt(), "{z}: {half}");
    }
    for screw in mounting.sheath.unwrap().screws {
        assert!(open(0.01, screw.centre) > 2.75 && open(2.99, screw.centre) > 2.75);
        assert!((open(6.9, screw.centre) - 1.7).abs() < 1e-9);
    }
    let insert = design(&["fasteners.kind=insert"]);
    let shell = printed(&insert).unwrap().remove(0);
    let axis = polar(insert.fastener_radius_mm(), insert.fastener_angles_rad()[0]);
    for (z, radius) in [(0.5, 2.0), (5.6, 2.0), (7.0, 1.7), (8.4, 2.0), (13.5, 2.0)] {
        assert!((section(&shell, z).distance_mm(axis) - radius).abs() < 1e-9, "{z}");
    }
    // Features that do not fit are left out, with a note.
    let thin = design(&["shell.wall_mm=5.5"]);
    assert!(thin.fastening().nut_trap.is_none());
    let right = printed(&thin).unwrap().into_iter().find(|p| p.name == "support-right").unwrap();
    let notes = right.notes(&thin);
    assert!(notes.iter().any(|n| n.contains("nut traps do not fit")), "{notes:?}");
}

/// The layer has its clearance to the stops at both ends, over its full width.
#[test]
fn stops_hold_the_layer() {
    for (name, design) in corpus() {
        let c = design.configuration();
        let Some([_, height]) = design.stops_mm() else { continue };
        let shell = printed(&design).unwrap().remove(0);
        let layer = silicone_layer(&design).unwrap();
        let z = c.shell.width_mm / 2.0;
        let (shell, layer) = (section(&shell, z), section(&layer, z));
        let radius = c.shell.outer_radius_mm + height / 2.0;
        for side in [-1.0, 1.0] {
            let shift = c.segment.end_margin_mm + c.silicone.side_clearance_mm;
            let beyond =
                |mm: f64| polar(radius, side * (design.half_span_rad() + libm::asin((shift + mm) / radius)));
            assert!(!shell.contains(beyond(-0.01)) && shell.contains(beyond(0.01)), "{name}");
            let gap = layer.distance_mm(beyond(0.0));
            assert!((gap - c.silicone.side_clearance_mm).abs() < 1e-6, "{name}: {gap}");
        }
        assert!(height < c.silicone.thickness_mm, "{name}");
    }
}

/// Openings of a mould stay open upward, so that the layer is removed along the axis.
#[test]
fn moulds_have_no_undercut() {
    let mut moulds = 0;
    for (name, design) in corpus() {
        for part in printed(&design).unwrap() {
            if !["mould-tray", "mould-core"].contains(&part.name.as_str()) {
                continue;
            }
            moulds += 1;
            let mut part = part;
            part.tool_pose = part.tool_pose.or(Some(pinswitch_solid::pose::Pose::upright(0.0)));
            let floor = design.configuration().mould.floor_mm;
            let levels: Vec<f64> = levels_mm(&[&part])
                .into_iter()
                .filter(|z| *z > floor && *z < floor + design.layer_width_mm())
                .collect();
            let all = levels_mm(&[&part]);
            for z in levels {
                let here = section(&part, z);
                for above in all.iter().filter(|a| **a > z) {
                    let over = section(&part, *above);
                    let outline: Vec<Point2> = over.polygons.iter().flatten().copied().collect();
                    for p in outline {
                        // Keys of the core are outside of the cavity.
                        let covers = over.distance_mm(p) < 1e-3
                            && !here.contains(p)
                            && here.distance_mm(p) > TOUCHING_MM;
                        assert!(!covers || part.name == "mould-core", "{name}: {p} at {above} covers {z}");
                    }
                }
            }
        }
        let tools: Vec<Part> =
            printed(&design).unwrap().into_iter().filter(|p| p.tool_pose.is_some()).collect();
        assert_eq!(overlap(&tools), None, "{name}");
    }
    assert!(moulds >= 20, "{moulds}");
}

/// The cavity of the tray is the layer, and its walls have their thickness.
#[test]
fn the_tray_has_the_cavity_of_the_layer() {
    let design = design(&["mould.kind=one-piece"]);
    let tray = printed(&design).unwrap().into_iter().find(|p| p.name == "mould-tray").unwrap();
    let cavities: Vec<Contour> = tray.solid.section(5.0).into_iter().filter(|c| c.area_mm2() < 0.0).collect();
    let layer = silicone_layer(&design).unwrap().solid.volume_mm3() / design.layer_width_mm();
    assert!(cavities.len() == 1 && (cavities[0].area_mm2() + layer).abs() < 1e-9);
    let thinnest = tray.solid.thin_places(design.configuration().mould.wall_mm - 1e-3);
    assert!(thinnest.is_empty(), "{thinnest:?}");
}

/// No part of a published layout has a thin place, with any mount.
#[test]
fn published_layouts_have_no_thin_places() {
    for mount in ["none", "flange", "joint", "rig"] {
        for kind in ["screw", "nut-trap", "insert"] {
            for mould in ["split", "one-piece"] {
                let set = [
                    format!("mount.kind={mount}"),
                    format!("fasteners.kind={kind}"),
                    format!("mould.kind={mould}"),
                    "layout.pins=[5, 8, 11]".to_owned(),
                ];
                let design = design(&set.iter().map(String::as_str).collect::<Vec<_>>());
                for part in printed(&design).unwrap() {
                    assert_eq!(part.thin_warning(&design), None, "{set:?}");
                }
            }
        }
    }
}

#[test]
fn thin_places_have_position_and_remedy() {
    // Without stops, the proxy has the end walls of the published layer, 0.64 mm, and plates are thin at their slots.
    let bare = design(&["shell.stop_mm=0"]);
    let warning = |name: &str| {
        let part = printed(&bare).unwrap().into_iter().find(|p| p.name == name).unwrap();
        part.thin_warning(&bare)
    };
    let proxy = warning("proxy").unwrap();
    assert!(proxy.starts_with("proxy: a wall of 0.64 mm") && proxy.contains("at radius 22.0 mm"), "{proxy}");
    assert!(proxy.contains("and one more place: raise segment.end_margin_mm"), "{proxy}");
    assert!(warning("support-left").unwrap().contains("a wall of 0.54 mm"));
    // A rule reports the end walls of the shell, so that the part does not.
    assert_eq!(warning("shell"), None);
    assert!(
        bare.warnings().iter().any(|w| w.text().contains("end walls are 0.54 mm")),
        "{:?}",
        bare.warnings()
    );
    // The wall between funnel and key hole was once 0.61 mm.
    let lid = printed(&design(&[])).unwrap().into_iter().find(|p| p.name == "mould-lid").unwrap();
    let thinnest = lid.solid.thin_places(3.0)[0].thickness_mm;
    assert!(thinnest >= 0.9 - 1e-6, "{thinnest}");
}

/// The tendon is taut over pins and silicone, in the middle of the width.
#[test]
fn the_tendon_touches_pins_and_silicone() {
    let design = design(&["layout.pins=[5, 8, 11]"]);
    let touching = touches(&design);
    let pins: Vec<_> = touching.iter().filter_map(|t| t.pin).collect();
    assert_eq!(pins, [0, 1, 2]);
    let on_silicone: Vec<_> = touching.iter().filter(|t| t.pin.is_none()).collect();
    assert_eq!(on_silicone.len(), 2);
    assert!((on_silicone[1].to_rad - design.half_wrap_rad()).abs() < 1e-9);
    assert!((on_silicone[0].from_rad + on_silicone[1].to_rad).abs() < 1e-9);
    // Tangents of the discs of pin and layer, from the law of cosines.
    let pin = design.pin_angles_rad()[2];
    let (far, near) = (22.0f64, 22.0 + 0.85);
    let turn = libm::acos((near - (0.47 + 0.85)) / far);
    assert!((on_silicone[1].from_rad - (pin + turn)).abs() < 1e-9, "{on_silicone:?}");
    let tendon = reference_bodies(&design).unwrap().pop().unwrap();
    assert_eq!(tendon.role, Role::Tendon);
    let (low, high) = tendon.solid.bounds().unwrap();
    assert!((low.z + high.z).abs() < 1e-9 && high.z < 0.85 && high.z > 0.8);
    // The section is a regular dodecagon.
    let area = 3.0 * 0.85f64.powi(2);
    let length = tendon.solid.volume_mm3() / area;
    assert!((60.0..70.0).contains(&length), "{length}");
    let bare = self::design(&[]);
    assert_eq!(touches(&bare).len(), 1);
}

/// The tendon of the rig is tangent to the guide pulley, at the same height.
#[test]
fn the_guide_pulley_is_tangent_to_the_tendon() {
    let design = design(&["mount.kind=rig", "layout.pins=[5, 8, 11]"]);
    assert_eq!(design.configuration().mount.kind, MountKind::Rig);
    let parts = assembled(&design);
    let pulley = parts.iter().find(|p| p.name == "guide-pulley").unwrap();
    let middle = design.configuration().shell.width_mm / 2.0;
    let groove = section(pulley, middle);
    let outline = groove.exact.iter().max_by(|a, b| a.area_mm2().total_cmp(&b.area_mm2())).unwrap();
    let radius = (outline.area_mm2() / std::f64::consts::PI).sqrt();
    assert!((radius - 22.0).abs() < 1e-9, "{radius}");
    let axle = design.mounting().unwrap().axle.unwrap().centre;
    let (low, high) = outline.bounds();
    assert!((nalgebra::center(&low, &high) - axle).norm() < 1e-9);
    // The straight part of the axis of the tendon is half a tendon outside of the groove.
    let leaves = polar(1.0, -design.half_wrap_rad());
    let reach = axle.coords.dot(&leaves.coords);
    assert!((design.tendon_axis_radius_mm() - reach - (22.0 + 0.85)).abs() < 1e-9);
}

/// The channel of the sheath stop is centred on the axis of the tendon, with a step for the end of the sheath.
#[test]
fn the_sheath_stop_is_centred_on_the_tendon() {
    let design = design(&["mount.kind=flange", "tendon.sheath_diameter_mm=3", "layout.pins=[5, 8, 11]"]);
    let parts = assembled(&design);
    let part = parts.iter().find(|p| p.name == "sheath-stop").unwrap();
    let stop = design.mounting().unwrap().sheath.unwrap();
    let middle = section(part, design.configuration().shell.width_mm / 2.0);
    for (along, free) in [(2.0, 0.85 + 0.2), (12.0, 1.5 + 0.2)] {
        let p = stop.start + stop.along * along;
        assert!(!middle.contains(p));
        assert!((middle.distance_mm(p) - free).abs() < 1e-9, "{along}: {}", middle.distance_mm(p));
    }
    // The sheath touches the base.
    let floor = design.sheath_floor_mm() - design.configuration().support.plate_mm;
    assert!((design.configuration().shell.width_mm / 2.0 - 1.5 - floor).abs() < 1e-9);
}
