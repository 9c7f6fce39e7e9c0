//! Every part of many variants is one valid body with its exact volume, in double and in single precision.

use std::io::Cursor;

use super::{Part, printed, reference_bodies};
use crate::config::{Configuration, assign};
use crate::design::Design;
use pinswitch_solid::files::{read_stl, stl_bytes};
use pinswitch_solid::validity::examine;

fn design(assignments: &[&str]) -> Design {
    let mut configuration = Configuration::default();
    for assignment in assignments {
        assign(&mut configuration, assignment).unwrap();
    }
    Design::new(configuration).unwrap()
}

fn assert_valid(part: &Part, design: &Design, variant: &[&str]) {
    let expected = part.expectation(design);
    let mesh = part.print_mesh(design).unwrap();
    let report = examine(&mesh, &expected);
    assert!(report.is_valid(), "{variant:?} {}: {:#?}", part.name, report.faults);
    assert!(report.facts.low_mm[2].abs() < 1e-12);
    let written = read_stl(&mut Cursor::new(stl_bytes(&mesh).unwrap())).unwrap().mesh;
    let report = examine(&written, &expected);
    assert!(report.is_valid(), "{variant:?} {} as STL: {:#?}", part.name, report.faults);
    assert_eq!(written.triangles.len(), mesh.triangles.len());
}

#[test]
fn all_parts_of_the_variants_are_valid() {
    let variants: [&[&str]; 10] = [
        &["layout.pins=[5, 8, 11]"],
        &["layout.pins=[3, 5, 7, 9, 11, 13]", "support.slots=occupied", "parts.guide_pulley=true"],
        &["layout.pins=[1, 2, 15]", "support.slot_kind=through", "segment.end_margin_mm=0.9"],
        &["print.elephant_foot_mm=0.2", "parts.guide_pulley=true"],
        &["mould.kind=one-piece", "mould.draft_deg=2", "mould.shrinkage_pct=1"],
        &[
            "mould.kind=one-piece",
            "mould.draft_deg=5",
            "mould.overfill_mm=10",
            "segment.end_margin_mm=0.9",
            "print.elephant_foot_mm=0.2",
        ],
        &[
            "mould.kind=one-piece",
            "mould.overfill_mm=0",
            "print.elephant_foot_mm=0.3",
            "segment.end_margin_mm=0.5",
        ],
        &["mould.shrinkage_pct=1.5", "support.corner_radius_mm=0", "fasteners.count=3"],
        &["label.text=ABQ08-_/.:+=", "label.height_mm=1.8", "label.stroke_mm=0.3"],
        &["layout.substrate=abs", "layout.pins=[8]", "fasteners.count=0"],
    ];
    for variant in variants {
        let design = design(variant);
        for part in printed(&design).unwrap().iter().chain(&reference_bodies(&design).unwrap()) {
            assert_valid(part, &design, variant);
        }
    }
}

/// Truck builds the same solid from the same profile: closed, with equal volume and bounds.
#[test]
fn truck_agrees_with_every_part() {
    let tolerance = pinswitch_solid::profile::ChordTolerance::new(0.01).unwrap();
    for kind in ["split", "one-piece"] {
        let mould = format!("mould.kind={kind}");
        let design = design(&[
            "layout.pins=[5, 8, 11]",
            &mould,
            "print.elephant_foot_mm=0.2",
            "parts.guide_pulley=true",
        ]);
        for part in printed(&design).unwrap().iter().chain(&reference_bodies(&design).unwrap()) {
            let truck = part.solid.brep_mesh(tolerance).unwrap();
            assert!(truck.closed, "{}", part.name);
            let exact = part.solid.volume_mm3();
            for volume in truck.mesh.axis_volumes_mm3() {
                // The vertices of truck are on the curve, so its error is up to the tolerance over the surface.
                let bound = tolerance.mm() * part.solid.surface_mm2();
                assert!((volume - exact).abs() <= bound, "{}: {volume} for {exact}", part.name);
            }
            let (low, high) = truck.mesh.bounds().unwrap();
            let (exact_low, exact_high) = part.solid.bounds().unwrap();
            let off = (low - exact_low).amax().max((high - exact_high).amax());
            assert!(off <= tolerance.mm(), "{}: off by {off}", part.name);
        }
    }
}
