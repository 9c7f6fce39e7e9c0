use super::*;
use crate::config::{Configuration, assign};
use crate::prediction::Prediction;

fn design(assignments: &[&str]) -> Design {
    let mut c = Configuration::default();
    assign(&mut c, "layout.pins=[5, 8, 11]").unwrap();
    assignments.iter().for_each(|a| assign(&mut c, a).unwrap());
    Design::new(c).unwrap()
}

/// A made switch has the curve of a configuration with the measured values.
#[test]
fn the_curve_is_that_of_the_measured_values() {
    let cases = [
        ("pin_diameter_mm = 0.9", "pins.diameter_mm=0.9"),
        ("layer_thickness_mm = 2.2", "silicone.thickness_mm=2.2"),
        ("hardness_shore_a = [45, 47]", "silicone.hardness_shore_a=46"),
        ("tendon_diameter_mm = 1.6", "tendon.rope_diameter_mm=1.1"),
        ("groove_radius_mm = 0.55", "segment.groove_radius_mm=0.55"),
        ("layer_width_mm = 13.0", "silicone.side_clearance_mm=0.5"),
        ("shell_radius_mm = 20.5", "shell.outer_radius_mm=20.5"),
    ];
    for (text, assignment) in cases {
        let made = Measured::read(text, "x.toml").unwrap().apply(&design(&[]));
        let other = design(&[assignment]);
        let (made, other) = (made.contact().bed(), other.contact().bed());
        for (a, b) in [
            (made.pin_diameter_mm, other.pin_diameter_mm),
            (made.layer_mm, other.layer_mm),
            (made.layer_width_mm, other.layer_width_mm),
            (made.modulus_mpa, other.modulus_mpa),
            (made.tendon_radius_mm, other.tendon_radius_mm),
            (made.groove_radius_mm, other.groove_radius_mm),
            (made.contact_radius_mm, other.contact_radius_mm),
        ] {
            assert!((a - b).abs() < 1e-9, "{text}: {made:?} for {other:?}");
        }
    }
}

#[test]
fn readings_as_planned_need_no_change() {
    let comparison = Measured::read("pin_diameter_mm = 0.94\nslot_width_mm = 1.14\n", "x.toml")
        .unwrap()
        .compare(&design(&[]));
    assert_eq!(comparison.planned_threshold_n, comparison.measured_threshold_n);
    let [advice] = comparison.advice.as_slice() else { panic!("{:?}", comparison.advice) };
    assert!(advice.starts_with("nothing to change"), "{advice}");
}

/// Advice is followed: the layer that it names switches at the planned load.
#[test]
fn the_proposed_hardness_restores_the_threshold() {
    let plan = design(&[]);
    let measured = Measured::read("layer_thickness_mm = 2.3\nhardness_shore_a = 44\n", "x.toml").unwrap();
    let comparison = measured.compare(&plan);
    let advice = comparison.advice.iter().find(|a| a.contains("cast a layer of")).unwrap();
    let shore_a: f64 =
        advice.split("cast a layer of ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
    let again = format!("layer_thickness_mm = 2.3\nhardness_shore_a = {shore_a}\n");
    let again = Measured::read(&again, "x.toml").unwrap().compare(&plan);
    let (planned, got) = (comparison.planned_threshold_n.unwrap(), again.measured_threshold_n.unwrap());
    assert!((got / planned - 1.0).abs() < 0.01, "{got} for {planned}");
    assert!(
        comparison.text().contains("## What to do\n\n- Use the corrected curve"),
        "{}",
        comparison.text()
    );
}

#[test]
fn tight_and_loose_slots_are_reported() {
    let advice = |text: &str| Measured::read(text, "x.toml").unwrap().compare(&design(&[])).advice.join("\n");
    assert!(advice("slot_width_mm = 0.98").contains("widen the slots to 1.04 mm"));
    assert!(advice("slot_width_mm = 1.5").contains("pins tilt"));
    assert!(!advice("slot_width_mm = 1.2").contains("pins"));
}

/// A measured hardness replaces the scatter of castings by that of a durometer.
#[test]
fn a_measured_hardness_narrows_the_band() {
    let plan = design(&[]);
    let made = Measured::read("hardness_shore_a = 50", "x.toml").unwrap().apply(&plan);
    let width = |d: &Design| {
        let curve = Prediction::of(d).curve;
        curve.band_high_n.last().unwrap() - curve.band_low_n.last().unwrap()
    };
    assert!(width(&made) < width(&plan));
}

#[test]
fn bad_files_are_refused_with_their_line() {
    for (text, problem) in [
        ("", "nothing is measured"),
        ("pin_diameter_mm = \"0.9\"", "not a reading"),
        ("pin_diameter_mm = []", "not a reading"),
        ("pin_diameter_mm = -1", "outside 0.05 to 6"),
        ("pin_diameter_mm = nan", "outside 0.05 to 6"),
        ("pin_diameter = 0.9", "unknown quantity"),
        ("[pins]\ndiameter_mm = 0.9", "unknown quantity"),
        ("pin_diameter_mm 0.9", "invalid TOML"),
    ] {
        let error = Measured::read(text, "x.toml").unwrap_err();
        assert!(error.problem().starts_with(problem), "{text:?}: {error}");
        assert!(error.help().is_some() && error.to_string().starts_with("x.toml"), "{error}");
    }
}
