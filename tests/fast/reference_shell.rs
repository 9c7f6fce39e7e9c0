//! The reference shell of the comparison of programs (cad/doc/batch.md): its exact volume at every
//! tolerance, and the deviation of every curve.

use pinswitch_solid::validity::examine;
use pinswitch_switch::config::{Configuration, assign};
use pinswitch_switch::design::Design;
use pinswitch_switch::parts::printed;

/// Outer radius 22, inner 19, width 10, grooves of 0.5 mm; exact by OCCT and in closed form.
const VOLUME_MM3: f64 = 901.515_397_106_802;

fn shell(tolerance_mm: f64) -> (Design, pinswitch_switch::parts::Part) {
    let mut configuration = Configuration::default();
    for assignment in [
        "shell.outer_radius_mm=22",
        "shell.wall_mm=3",
        "shell.width_mm=10",
        "fasteners.count=0",
        "shell.stop_mm=0",
        "label.engrave=false",
        "mould.kind=none",
        &format!("mesh.chord_tolerance_mm={tolerance_mm}"),
    ] {
        assign(&mut configuration, assignment).unwrap();
    }
    let design = Design::new(configuration).unwrap();
    let part = printed(&design).unwrap().into_iter().find(|p| p.name == "shell").unwrap();
    (design, part)
}

#[test]
fn volume_is_exact_at_every_tolerance() {
    for tolerance in [0.01, 0.005, 0.001] {
        let (design, part) = shell(tolerance);
        assert!((part.solid.volume_mm3() / VOLUME_MM3 - 1.0).abs() < 1e-12);
        let mesh = part.print_mesh(&design).unwrap();
        assert!(examine(&mesh, &part.expectation(&design)).is_flawless());
        let error = (mesh.volume_mm3() / VOLUME_MM3 - 1.0).abs();
        println!("tolerance {tolerance} mm: {} triangles, volume off by {:.2e}", mesh.triangles.len(), error);
        assert!(error < 1e-5, "tolerance {tolerance}: off by {error}");
    }
}

/// Measures the distance of every point of the mesh's outline from the exact profile.
#[test]
fn curves_stay_within_tolerance() {
    for tolerance in [0.05, 0.01, 0.001] {
        let (design, part) = shell(tolerance);
        let profile = part.solid.section(5.0);
        assert_eq!(profile.len(), 1);
        let polygon = profile[0].flattened(&profile[0].chords(design.tolerance()));
        let mut worst = 0.0f64;
        for (a, b) in polygon.iter().zip(polygon.iter().cycle().skip(1)) {
            for k in 0..=8 {
                worst = worst.max(profile[0].distance_mm(a + (b - a) * (f64::from(k) / 8.0)));
            }
        }
        assert!(worst <= tolerance, "{worst} > {tolerance}");
        assert!(worst > tolerance / 20.0, "{worst}: is anything measured at {tolerance}?");
    }
}
