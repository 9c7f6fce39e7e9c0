//! Geometric tests of the fit: pins stay in their slots and grooves over their whole travel, parts
//! do not overlap, holes are coaxial, and the cavity of the mould equals the layer.

use i_overlay::core::fill_rule::FillRule;
use i_overlay::core::overlay_rule::OverlayRule;
use i_overlay::float::single::SingleFloatOverlay;
use nalgebra::Point2;
use pinswitch_solid::profile::{ChordTolerance, Contour, Edge, polar};
use pinswitch_switch::config::{Configuration, assign};
use pinswitch_switch::design::Design;
use pinswitch_switch::parts::{Part, Substance, printed, reference_bodies, silicone_layer};

type Polygons = Vec<Vec<[f64; 2]>>;

const FINE_MM: f64 = 1e-3;

fn design(assignments: &[&str]) -> Design {
    let mut configuration = Configuration::default();
    for assignment in assignments {
        assign(&mut configuration, assignment).unwrap();
    }
    Design::new(configuration).unwrap()
}

const VARIANTS: [&[&str]; 4] = [
    &["layout.pins=[5, 8, 11]"],
    &["layout.pins=[3, 5, 7, 9, 11, 13]", "support.slots=occupied", "fasteners.count=3"],
    &["layout.pins=[1, 2, 9]", "support.slot_kind=through", "segment.end_margin_mm=0.9"],
    &["layout.pins=[2, 15]", "shell.outer_radius_mm=30", "silicone.thickness_mm=3", "pins.diameter_mm=0.8"],
];

fn polygons(contours: &[Contour]) -> Polygons {
    let fine = ChordTolerance::new(FINE_MM).unwrap();
    let flat = |c: &Contour| c.flattened(&c.chords(fine)).iter().map(|p| [p.x, p.y]).collect();
    contours.iter().map(flat).collect()
}

fn area(shapes: &[Polygons]) -> f64 {
    let signed = |p: &Vec<[f64; 2]>| {
        let next = p.iter().cycle().skip(1);
        p.iter().zip(next).map(|(a, b)| a[0] * b[1] - b[0] * a[1]).sum::<f64>() / 2.0
    };
    shapes.iter().flatten().map(signed).sum::<f64>().abs()
}

fn combined(a: &Polygons, b: &Polygons, rule: OverlayRule) -> Vec<Polygons> {
    a.overlay(b, rule, FillRule::NonZero)
}

/// Returns the section of a part at a height of the assembly.
fn section(part: &Part, z_mm: f64) -> Vec<Contour> {
    let pose = part.pose.unwrap();
    if pose.flipped {
        part.solid.section(pose.z_mm - z_mm).iter().map(Contour::mirrored).collect()
    } else {
        part.solid.section(z_mm - pose.z_mm)
    }
}

/// Returns the heights in the assembly at which the section of a part may change.
fn heights(part: &Part) -> Vec<f64> {
    let pose = part.pose.unwrap();
    let place = |z: f64| if pose.flipped { pose.z_mm - z } else { pose.z_mm + z };
    part.solid.heights_mm().into_iter().map(place).collect()
}

/// Returns the largest area that two bodies share in any section, mm².
fn shared_mm2(a: &Part, b: &Part) -> f64 {
    let mut all = [heights(a), heights(b)].concat();
    all.sort_by(f64::total_cmp);
    let middles = all.windows(2).filter(|w| w[1] - w[0] > 1e-9).map(|w| f64::midpoint(w[0], w[1]));
    middles
        .map(|z| {
            area(&combined(&polygons(&section(a, z)), &polygons(&section(b, z)), OverlayRule::Intersect))
        })
        .fold(0.0, f64::max)
}

fn assembly(design: &Design) -> Vec<Part> {
    let mut parts = printed(design).unwrap();
    // Layer and proxy occupy the same space, so the assembly contains one of them.
    parts.retain(|p| p.pose.is_some() && p.name != "proxy");
    [parts, reference_bodies(design).unwrap()].concat()
}

#[test]
fn assembled_parts_do_not_overlap() {
    for variant in VARIANTS {
        let design = design(variant);
        let parts = assembly(&design);
        for (i, a) in parts.iter().enumerate() {
            for b in &parts[i + 1..] {
                let shared = shared_mm2(a, b);
                // Touching faces are flattened separately, which leaves slivers within the
                // tolerance along arcs.
                assert!(
                    shared < 2.0 * FINE_MM * 40.0,
                    "{variant:?}: {} and {} share {shared} mm2",
                    a.name,
                    b.name
                );
            }
        }
    }
}

#[test]
fn overlaps_are_detected() {
    let design = design(VARIANTS[0]);
    let parts = assembly(&design);
    let find = |name: &str| parts.iter().find(|p| p.name == name).unwrap();
    let mut sunk = find("silicone-layer").clone();
    sunk.pose.as_mut().unwrap().z_mm -= 1.0;
    assert!(shared_mm2(find("support-left"), &sunk) > 10.0);
    let mut shell = find("shell").clone();
    shell.pose.as_mut().unwrap().z_mm -= 1.0;
    assert!(shared_mm2(find("support-left"), &shell) > 50.0);
}

#[test]
fn pins_fit_over_full_travel() {
    for variant in VARIANTS {
        let design = design(variant);
        let c = design.configuration();
        let widest = (c.pins.diameter_mm + c.pins.tolerance_mm) / 2.0;
        let (slot, width) = (design.slot(), c.shell.width_mm);
        let parts = assembly(&design);
        let reach = (design.pin_length_mm() - width) / 2.0;
        for support in parts.iter().filter(|p| p.name.starts_with("support")) {
            let left = support.name == "support-left";
            for depth in [0.01, reach / 2.0, reach] {
                let walls = section(support, if left { -depth } else { width + depth });
                for angle in design.pin_angles_rad() {
                    for step in 0..=20 {
                        let radius = slot.inner_mm + (slot.outer_mm - slot.inner_mm) * f64::from(step) / 20.0;
                        let centre = polar(radius, angle);
                        let free = walls.iter().map(|w| w.distance_mm(centre)).fold(f64::INFINITY, f64::min);
                        let least = widest + (c.support.slot_clearance_mm - c.pins.tolerance_mm) / 2.0 - 1e-9;
                        assert!(free >= least, "{}: {free} < {least} at radius {radius}", support.name);
                    }
                }
            }
        }
        // From resting on the silicone to flush with its surface, and the pin between the slots'
        // floors.
        assert!(slot.outer_mm >= design.contact_radius_mm());
        assert!(slot.inner_mm <= design.contact_radius_mm() - c.pins.diameter_mm / 2.0);
        assert!(reach <= slot.depth_mm && reach >= c.pins.diameter_mm);
        let layer = silicone_layer(&design).unwrap().solid.section(0.1);
        for angle in design.pin_angles_rad() {
            let free = layer[0].distance_mm(polar(design.contact_radius_mm(), angle));
            assert!(free >= widest, "the groove leaves {free}, the pin needs {widest}");
        }
    }
}

/// Returns the centres of the round holes in a section.
fn hole_centres(contours: &[Contour]) -> Vec<Point2<f64>> {
    contours
        .iter()
        .filter_map(|c| match c.edges() {
            [Edge::Arc(a), Edge::Arc(b)] if (a.centre - b.centre).norm() < 1e-12 => Some(a.centre),
            _ => None,
        })
        .collect()
}

#[test]
fn shell_and_support_holes_are_coaxial() {
    for variant in VARIANTS {
        let design = design(variant);
        let parts = assembly(&design);
        let c = design.configuration();
        let centres = |name: &str, z: f64| {
            let mut all = hole_centres(&section(parts.iter().find(|p| p.name == name).unwrap(), z));
            all.sort_by(|a, b| a.x.total_cmp(&b.x));
            all
        };
        let shell = centres("shell", c.shell.width_mm / 2.0);
        assert_eq!(shell.len(), c.fasteners.count);
        for (name, z) in [("support-left", -0.1), ("support-right", c.shell.width_mm + 0.1)] {
            let plate = centres(name, z);
            assert_eq!(plate.len(), shell.len());
            for (a, b) in shell.iter().zip(&plate) {
                assert!((a - b).norm() < 1e-12, "{name}: {a} and {b}");
            }
        }
    }
}

#[test]
fn mould_cavity_equals_layer() {
    for kind in ["split", "one-piece"] {
        let design = design(&["layout.pins=[5, 8, 11]", &format!("mould.kind={kind}")]);
        let c = design.configuration();
        let layer = silicone_layer(&design).unwrap();
        assert_eq!(layer.material(), Substance::Silicone);
        let parts = printed(&design).unwrap();
        // Heights just above the mould's floor, and just below the layer's width.
        for height in [0.05, design.layer_width_mm() - 0.05] {
            let walls: Polygons = parts
                .iter()
                .filter(|p| ["mould-core", "mould-ring", "mould-tray"].contains(&p.name.as_str()))
                .flat_map(|p| {
                    let floor = if p.name == "mould-ring" { 0.0 } else { c.mould.floor_mm };
                    polygons(&p.solid.section(floor + height))
                })
                .collect();
            let shape = polygons(&layer.solid.section(1.0));
            let inside = area(&combined(&shape, &walls, OverlayRule::Intersect));
            assert!(inside < 2.0 * FINE_MM * 40.0, "{kind}: walls reach {inside} mm2 into the layer");
            // The layer fills its smooth sector except for the walls, so the ribs are in place.
            let sector = pinswitch_switch::parts::Sector {
                inner_mm: design.shell_radius_mm(),
                outer_mm: design.contact_radius_mm(),
                half_span_rad: design.half_span_rad(),
                end_shift_mm: 0.0,
            };
            let cavity = combined(&polygons(&[sector.outline()]), &walls, OverlayRule::Difference).concat();
            let beyond = area(&combined(&cavity, &shape, OverlayRule::Xor));
            assert!(beyond < 2.0 * FINE_MM * 60.0, "{kind}: {beyond} mm2 of cavity outside the layer");
            let ribs = sector.outline().area_mm2() - area(&[cavity]);
            assert!(ribs > 5.0, "{kind}: the ribs take {ribs} mm2");
        }
    }
}
