//! Every part of many variants is one valid body with its exact volume, in double and in single precision.

use std::io::Cursor;

use super::{Part, printed, reference_bodies};
use crate::built::verified;
use crate::config::{Configuration, assign};
use crate::design::Design;
use pinswitch_solid::files::{read_stl, stl_bytes};
use pinswitch_solid::mesh::Mesh;
use pinswitch_solid::validity::examine;
use pinswitch_solid::verification::second_kernel;

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
    assert!(report.is_flawless(), "{variant:?} {}: {:#?}", part.name, report.faults);
    assert!(report.facts.low_mm[2].abs() < 1e-12);
    let written = read_stl(&mut Cursor::new(stl_bytes(&mesh).unwrap())).unwrap().mesh;
    let report = examine(&written, &expected);
    assert!(report.is_flawless(), "{variant:?} {} as STL: {:#?}", part.name, report.faults);
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
fn the_second_kernel_confirms_every_part() {
    let kernel = second_kernel().unwrap();
    for (kind, tolerance) in [("split", "0.01"), ("one-piece", "0.01"), ("one-piece", "0.1")] {
        let design = design(&[
            "layout.pins=[5, 8, 11]",
            &format!("mould.kind={kind}"),
            &format!("mesh.chord_tolerance_mm={tolerance}"),
            "print.elephant_foot_mm=0.2",
            "parts.guide_pulley=true",
        ]);
        for part in printed(&design).unwrap().iter().chain(&reference_bodies(&design).unwrap()) {
            let mesh = part.print_mesh(&design).unwrap();
            let verification = verified(part, &mesh, &design, kernel);
            assert!(verification.is_ok_and(|v| v.closed), "{kind}, {tolerance} mm: {}", part.name);
        }
    }
}

/// The part, the quantity, both values and the limit are in the error.
#[test]
fn the_second_kernel_refuses_wrong_meshes() {
    let kernel = second_kernel().unwrap();
    let design = design(&["layout.pins=[5, 8, 11]"]);
    let parts = printed(&design).unwrap();
    let shell = parts.iter().find(|part| part.name == "shell").unwrap();
    let right = shell.print_mesh(&design).unwrap();
    let refusal = |mesh: &Mesh| verified(shell, mesh, &design, kernel).unwrap_err().to_string();

    // A thousandth of the radius of 20 mm is twice the chord tolerance.
    let mut scaled = shell.mesh(&design).unwrap();
    scaled.positions.iter_mut().for_each(|p| *p *= 1.001);
    let message = refusal(&scaled.translated(shell.print_shift_mm()));
    assert!(message.starts_with("shell: ") && message.contains(" mm"), "{message}");

    let mut open = right.clone();
    open.triangles.pop();
    assert!(refusal(&open).contains("the mesh of pinswitch is not closed"), "{}", refusal(&open));

    let mut moved = right.clone();
    let low = moved.bounds().unwrap().0.z;
    let top = moved.positions.iter_mut().find(|p| p.z > low + 1.0).unwrap();
    top.z += 0.03;
    assert!(refusal(&moved).contains("at most"), "{}", refusal(&moved));

    let support = parts.iter().find(|part| part.name == "support-left").unwrap();
    let message = refusal(&support.print_mesh(&design).unwrap());
    assert!(
        message.contains("volume differs: ") && message.contains(" mm3 in truck-modeling, at most "),
        "{message}"
    );
}
