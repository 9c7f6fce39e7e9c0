//! The joint over its whole range of flexion: nothing overlaps, the stops meet the lug at both ends, the axle turns freely,
//! and the parts can be printed.

use super::sections::Section;
use std::f64::consts::FRAC_PI_2;

use super::assembly_tests::{
    TOUCHING_MM, assembled, corpus, design, heights_mm, levels_mm, overlap, section,
};
use super::{DISTAL, PROXIMAL, Part, Role, printed, tendon_at_flexion};
use crate::built::Built;
use crate::config::{Configuration, assign, read};
use crate::design::{Design, Joint};
use crate::feasibility;
use crate::hardware::{HardwareKind, hardware};
use pinswitch_friction::finger::FlexionWrap;
use pinswitch_solid::pose::Pose;
use pinswitch_solid::profile::{Point2, polar};
use pinswitch_solid::validity::{Expectation, examine};

/// Number of flexions at which overlaps are searched.
const FLEXIONS: u32 = 12;

/// Every joint of the corpus, and some with other pins and ranges.
fn joints() -> Vec<(String, Design)> {
    let corpus = corpus().into_iter().filter(|(_, design)| design.joint().is_some());
    let others = [
        &["layout.pins=[]"][..],
        &["layout.pins=[3, 5, 7, 9, 11, 13]", "mount.axle_mm=4", "mount.plate_mm=5", "shell.width_mm=12"],
        &["layout.pins=[1, 15]", "mount.flexion_min_deg=30", "mount.flexion_max_deg=70"],
    ];
    let of = |set: &[&str]| design(&[set, &["mount.kind=joint"]].concat());
    let all: Vec<_> = corpus.chain(others.iter().map(|set| (format!("{set:?}"), of(set)))).collect();
    assert_eq!(all.len(), 6);
    all
}

fn joint(design: &Design) -> Joint {
    design.joint().unwrap()
}

/// Flexions between the stops, with both ends.
fn flexions(joint: &Joint) -> impl Iterator<Item = f64> {
    let [low, high] = joint.flexion_deg;
    (0..=FLEXIONS).map(move |i| low + (high - low) * f64::from(i) / f64::from(FLEXIONS))
}

/// A section of a part of the distal link, turned about the axis.
fn turned(section: &Section, by_rad: f64) -> Section {
    let turn = |p: &Point2| {
        let angle = libm::atan2(p.x, p.y) - by_rad;
        polar(p.coords.norm(), angle)
    };
    let polygons: Vec<Vec<Point2>> =
        section.polygons.iter().map(|polygon| polygon.iter().map(turn).collect()).collect();
    let exact = polygons.iter().cloned().map(pinswitch_solid::profile::Contour::polygon).collect();
    Section { exact, polygons }
}

/// Bought bodies as parts of the assembly.
fn bought(design: &Design) -> Vec<Part> {
    let part = |body: crate::hardware::Hardware| {
        Part::new(body.name, Role::Accessory, body.solid, Some(Pose::upright(0.0)))
    };
    let is_fixed = |kind| {
        matches!(kind, HardwareKind::Axle | HardwareKind::AxleNut | HardwareKind::AxleWasher)
            || matches!(kind, HardwareKind::Screw | HardwareKind::Nut)
    };
    hardware(design).into_iter().filter(|body| is_fixed(body.kind)).map(part).collect()
}

/// Depth of the deepest overlap of a turned body with a fixed one.
fn overlap_mm(turning: &Part, by_rad: f64, fixed: &Part) -> f64 {
    let mut deepest = 0.0_f64;
    for z in levels_mm(&[turning, fixed]) {
        let (at_turning, at_fixed) = (section(turning, z), section(fixed, z));
        if at_turning.exact.is_empty() || at_fixed.exact.is_empty() {
            continue;
        }
        let at_turning = turned(&at_turning, by_rad);
        deepest = deepest.max(at_turning.depth_mm(&at_fixed).0).max(at_fixed.depth_mm(&at_turning).0);
    }
    deepest
}

#[test]
fn nothing_overlaps_at_any_flexion() {
    for (name, design) in joints() {
        assert_eq!(overlap(&assembled(&design)), None, "{name}");
        let joint = joint(&design);
        let all = [assembled(&design), bought(&design)].concat();
        let (distal, fixed): (Vec<_>, Vec<_>) = all.iter().partition(|part| part.name == DISTAL);
        let fixed: Vec<_> = fixed.into_iter().filter(|part| part.role != Role::Tendon).collect();
        for flexion_deg in flexions(&joint) {
            let turn = joint.turn_rad(flexion_deg);
            for part in &fixed {
                let depth = overlap_mm(distal[0], turn, part);
                assert!(depth < TOUCHING_MM, "{name}: {} at {flexion_deg}: {depth}", part.name);
            }
            let tendon = tendon_at_flexion(&design, flexion_deg).unwrap();
            assert!(overlap_mm(distal[0], turn, &tendon) < TOUCHING_MM, "{name}");
            for part in fixed.iter().filter(|part| !matches!(part.role, Role::Accessory)) {
                let depth = overlap_mm(part, 0.0, &tendon);
                assert!(depth < TOUCHING_MM, "{name}: tendon and {} at {flexion_deg}: {depth}", part.name);
            }
        }
        // Beyond both stops, the lug is inside of a stop.
        let proximal = fixed.iter().find(|part| part.name == PROXIMAL).unwrap();
        let [low, high] = joint.flexion_deg;
        for beyond in [low - 1.0, high + 1.0] {
            let depth = overlap_mm(distal[0], joint.turn_rad(beyond), proximal);
            assert!(depth > 0.1, "{name}: no stop at {beyond}");
        }
    }
}

/// The bore is a bearing: the axle is free in it over hub and link, with the switch in place.
#[test]
fn the_axle_turns_freely() {
    for (name, design) in joints() {
        let joint = joint(&design);
        let plate_mm = design.configuration().mount.plate_mm;
        let radius = joint.axle.diameter_mm / 2.0;
        let parts = assembled(&design);
        let of = |name: &str| parts.iter().find(|part| part.name == name).unwrap();
        let mut bearing_mm = 0.0;
        let mut heights = heights_mm(of(DISTAL));
        heights.sort_by(f64::total_cmp);
        for w in heights.windows(2).filter(|w| w[1] - w[0] > 1e-6) {
            let here = section(of(DISTAL), f64::midpoint(w[0], w[1]));
            let free = here.distance_mm(Point2::origin()) - radius;
            assert!(!here.contains(Point2::origin()) && free >= 0.05 - 1e-9, "{name}: {free}");
            if free < 0.1 {
                bearing_mm += w[1] - w[0];
            }
        }
        assert!((bearing_mm - joint.bearing_mm(plate_mm)).abs() < 0.5, "{name}: {bearing_mm}");
        assert!(bearing_mm > 3.0 * joint.axle.diameter_mm, "{name}");
        // No other body is in the way of the axle, except the skin over the pocket for its head.
        for part in parts.iter().filter(|part| part.name != DISTAL && part.name != PROXIMAL) {
            for z in levels_mm(&[part]) {
                let here = section(part, z);
                assert!(here.exact.is_empty() || here.distance_mm(Point2::origin()) > radius + 1.0);
                assert!(!here.contains(Point2::origin()), "{name}: {}", part.name);
            }
        }
        // The shank reaches beyond the middle of the bearing, and the nut is on the thread.
        let length = joint.axle_length_mm.unwrap();
        let head = joint.levels.proximal_mm - plate_mm + joint.head_recess().depth_mm;
        let shank_end = head + length - joint.axle.thread_mm;
        assert!(shank_end > f64::midpoint(joint.levels.hub_mm, joint.levels.distal_mm), "{name}");
        assert!(shank_end < joint.levels.distal_mm + plate_mm + joint.axle.washer_mm[2], "{name}");
    }
}

#[test]
fn links_are_valid_printable_meshes() {
    for (name, design) in joints() {
        for part in printed(&design)
            .unwrap()
            .iter()
            .filter(|part| matches!(part.role, Role::Mount | Role::DistalLink))
        {
            let mesh = part.print_mesh(&design).unwrap();
            let report = examine(&mesh, &Expectation { intersections: true, ..part.expectation(&design) });
            assert!(report.faults.is_empty(), "{name} {}: {:?}", part.name, report.faults);
            assert_eq!(part.thin_warning(&design), None, "{name} {}", part.name);
            // Only recesses and their skins are bridged.
            let pocket = 2.0 * joint(&design).head_recess().along_mm;
            assert!(part.widest_bridge_mm() <= pocket + 1e-9, "{name} {}", part.name);
        }
        Built::new(design).unwrap();
    }
}

/// The tendon of the assembly, which is constructed in the directions of the links, is the taut one at that flexion.
#[test]
fn the_assembly_is_a_flexion_of_the_joint() {
    for (name, design) in joints() {
        let joint = joint(&design);
        let contact = joint.contact(joint.assembled_deg);
        let half = design.half_wrap_rad();
        assert!((contact.to_rad - half).abs() < 1e-9 && (contact.from_rad + half).abs() < 1e-9, "{name}");
        let turns = [contact.guide_turn_rad, contact.anchor_turn_rad];
        assert!(turns.iter().all(|turn| *turn < 1e-9), "{name}: {turns:?}");
        let touching: Vec<usize> = contact.arcs.iter().map(|arc| arc.disc).collect();
        let mut expected: Vec<usize> =
            super::touches(&design).iter().map(|touch| touch.pin.map_or(0, |pin| pin + 1)).collect();
        expected.reverse();
        assert_eq!(touching, expected, "{name}");
        assert!(contact.arcs.iter().all(|arc| arc.from_rad >= FRAC_PI_2 - half - 1e-9));
    }
}

/// On bare silicone with guide and anchor on its tangents, the wrap is the flexion.
#[test]
fn bare_silicone_wraps_by_the_flexion() {
    let design = design(&["layout.pins=[]", "mount.kind=joint"]);
    let joint = joint(&design);
    for flexion_deg in flexions(&joint) {
        let wrap = joint.wrap(flexion_deg).unwrap();
        assert!((wrap.wrap_deg - flexion_deg).abs() < 1e-6, "{flexion_deg}: {}", wrap.wrap_deg);
        // It starts at the proximal end of the wrap of the layout, and grows on one side.
        let middle = 63.89 / 2.0 - flexion_deg / 2.0;
        assert!(flexion_deg == 0.0 || (wrap.middle_deg - middle).abs() < 1e-6, "{flexion_deg}");
        let arm = joint.contact(flexion_deg).moment_arm_mm;
        assert!((arm - design.tendon_axis_radius_mm()).abs() < 1e-6, "{arm}");
    }
    assert!(joint.largest_turns_rad().iter().all(|turn| *turn < 1e-9));
}

/// A single pin, with guide and anchor on its tangents: lines from a point to a disc.
#[test]
fn one_pin_deflects_the_tendon_as_computed() {
    // The pin is the only body that the tendon meets near the straight joint: the flexion is small.
    let design = design(&["layout.pins=[13]", "mount.kind=joint"]);
    let joint = joint(&design);
    let discs = design.tendon_discs();
    let pin = discs[1];
    for flexion_deg in [2.0, 3.0, 4.0] {
        let contact = joint.contact(flexion_deg);
        assert!(contact.arcs.iter().all(|arc| arc.disc == 1), "{flexion_deg}: {:?}", contact.arcs);
        // The angle between a line to the centre and a tangent is asin(r / distance).
        let tangent = |from: Point2, side: f64| {
            let to = pin.centre - from;
            libm::atan2(to.y, to.x) + side * libm::asin(pin.radius_mm / to.norm())
        };
        // From the guide the tendon passes above the pin, which is on the left of its direction.
        let incoming = tangent(joint.proximal.mouth(), -1.0);
        let outgoing = tangent(contact.anchor, 1.0) + std::f64::consts::PI;
        let turn = (outgoing - incoming).rem_euclid(std::f64::consts::TAU);
        assert!((contact.wrap_rad() - turn).abs() < 1e-9, "{flexion_deg}: {turn}");
    }
}

/// With the distance of the guide from the axis, the wrap at each flexion is that of the support functions, sampled.
#[test]
fn the_wrap_is_that_of_a_sampled_hull() {
    for (name, design) in joints() {
        let joint = joint(&design);
        let discs = design.tendon_discs();
        for flexion_deg in flexions(&joint) {
            let contact = joint.contact(flexion_deg);
            let points = [joint.proximal.mouth(), contact.anchor];
            let [first, last] = points.map(|p| libm::atan2(p.y, p.x));
            let arc_deg = (last - first).rem_euclid(std::f64::consts::TAU).to_degrees();
            // Directions between guide and anchor in which the switch is outermost.
            let switch_is_out = |direction: f64| {
                let u = pinswitch_solid::profile::Vector2::new(libm::cos(direction), libm::sin(direction));
                let switch = discs.iter().map(|disc| disc.centre.coords.dot(&u) + disc.radius_mm);
                let ends = points.iter().map(|p| p.coords.dot(&u));
                switch.fold(f64::NEG_INFINITY, f64::max) > ends.fold(f64::NEG_INFINITY, f64::max)
            };
            let samples = 20_000;
            let direction = |i: u32| first + (arc_deg * f64::from(i) / f64::from(samples)).to_radians();
            let count = (0..samples).filter(|i| switch_is_out(direction(*i))).count();
            let sampled_deg = arc_deg * count as f64 / f64::from(samples);
            let wrap_deg = contact.wrap_rad().to_degrees();
            assert!((wrap_deg - sampled_deg).abs() < 0.03, "{name} {flexion_deg}: {wrap_deg} {sampled_deg}");
        }
    }
}

#[test]
fn the_wrap_grows_with_flexion() {
    let mut made = 0;
    for pins in ["[]", "[8]", "[5, 8, 11]", "[1, 2, 3]", "[13, 14, 15]", "[1, 15]", "[3, 5, 7, 9, 11, 13]"] {
        for wrap in [20.0, 45.0, 63.89, 80.0] {
            for diameter in [0.6, 0.94] {
                let mut c = Configuration::default();
                let set = [
                    format!("layout.pins={pins}"),
                    format!("layout.wrap_angle_deg={wrap}"),
                    format!("pins.diameter_mm={diameter}"),
                    format!("mount.flexion_max_deg={}", (wrap / 2.0 + 43.0_f64).max(wrap)),
                    "mount.kind=joint".to_owned(),
                ];
                set.iter().for_each(|a| assign(&mut c, a).unwrap());
                let Ok(design) = Design::new(c) else { continue };
                made += 1;
                let joint = joint(&design);
                let [low, high] = joint.flexion_deg;
                let wraps: Vec<f64> = (0..=400)
                    .map(|i| joint.wrap(low + (high - low) * f64::from(i) / 400.0).unwrap().wrap_deg)
                    .collect();
                let fall = wraps.windows(2).map(|w| w[0] - w[1]).fold(f64::NEG_INFINITY, f64::max);
                let at: Vec<_> = wraps.windows(2).filter(|w| w[0] - w[1] > 1e-9).collect();
                assert!(fall < 1e-9, "{set:?}: {fall} {at:?}");
                assert!(wraps[0] < 5.0 && wraps[400] > high - 5.0, "{set:?}: {wraps:?}");
                // Neither does it jump: the tendon is a string.
                let steps = wraps.windows(2).map(|w| w[1] - w[0]).fold(0.0, f64::max);
                assert!(steps < 6.0 * (high - low) / 400.0, "{set:?}: {steps}");
            }
        }
    }
    assert!(made > 40, "{made}");
}

#[test]
fn flexions_beyond_the_stops_are_refused() {
    let joint = joint(&design(&["mount.kind=joint", "mount.flexion_min_deg=10"]));
    for flexion_deg in [9.9, 75.1, f64::NAN] {
        let error = joint.wrap(flexion_deg).unwrap_err();
        assert_eq!((error.low, error.high), (10.0, 75.0));
    }
    assert_eq!(joint.measured_joint_deg(), Some(63.89));
    let other = design(&["mount.kind=joint", "layout.wrap_angle_deg=62"]);
    assert_eq!(other.joint().unwrap().measured_joint_deg(), None);
}

#[test]
fn invalid_joints_have_remedies() {
    for (set, field, words) in [
        (&["mount.axle_mm=5.5"][..], "mount.axle_mm", "no bolt of this diameter"),
        (&["mount.flexion_max_deg=80"], "mount.flexion_max_deg", "beyond the segment"),
        (&["mount.flexion_max_deg=60"], "mount.flexion_max_deg", "never reaches the wrap"),
        (&["mount.flexion_min_deg=70"], "mount.flexion_min_deg", "never reaches the wrap"),
        (&["mount.flexion_min_deg=74"], "mount.flexion_min_deg", "stops too close"),
        (&["mount.proximal_mm=20"], "mount.proximal_mm", "under the switch or its guide"),
        (&["mount.distal_mm=20"], "mount.distal_mm", "over the switch or its anchor"),
        (&["tendon.sheath_diameter_mm=3"], "tendon.sheath_diameter_mm", "without a sheath"),
        (&["shell.wall_mm=13", "mount.axle_mm=8"], "mount.axle_mm", "too narrow for an axle"),
        (&["mount.axle_mm=4"], "mount.axle_mm", "long enough"),
        (
            &[
                "segment.span_deg=200",
                "segment.grooves=20",
                "layout.wrap_angle_deg=120",
                "mount.flexion_max_deg=150",
            ],
            "mount.flexion_max_deg",
            "do not fit next to the shell",
        ),
    ] {
        let mut c = Configuration::default();
        [&["mount.kind=joint"], set].concat().iter().for_each(|a| assign(&mut c, a).unwrap());
        let error = feasibility::design(c).unwrap_err();
        let text = error.to_string();
        assert!(text.contains(words), "{set:?}: {text}");
        assert_eq!(error.location().unwrap().field.as_deref(), Some(field), "{text}");
        assert!(!error.changes().is_empty(), "{text}");
    }
}

#[test]
fn the_replaced_word_names_the_new_one() {
    let error = read("[mount]\nkind = \"finger-link\"\n", "a.toml").unwrap_err().to_string();
    assert!(error.contains("mount.kind = \"finger-link\"") && error.contains("give \"joint\""), "{error}");
}
