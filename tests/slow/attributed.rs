//! Conditions that `attributed` implies.
//!
//! Covered: effects outside the vocabulary (trends in time and along the stroke, a memory, a
//! resonance) are never attributed; a confounded effect is reported with its rival; and an
//! attributed effect has a size whose interval excludes zero, no rival, and a smaller error than
//! the baseline on series that were not used to find it, also for effects near the detection limit.
//! Not covered: a step of friction, another tendon, and half a wave of friction, which may be
//! indistinguishable from scatter or from `wear_drift` (`model/doc/calibration.md` gives the
//! frequencies).

use pinswitch_calibration::effects::Vocabulary;
use pinswitch_calibration::table::PlateauTable;
use pinswitch_calibration::{Report, Verdict, calibrate};
use pinswitch_simulation::{EffectPlan, Plan, plan_of, simulate, study_cases};

/// First seed; nothing was tuned on these seeds.
const SEED: u64 = 810_000;

/// Calibrates a simulated rig.
fn calibrated(plan: &Plan) -> Report {
    let text = PlateauTable::write(&simulate(plan).rows);
    let table = PlateauTable::read(text.as_bytes(), "rig.csv").unwrap();
    calibrate(&table.rows, &Vocabulary::built_in(), 1).unwrap().report
}

/// Returns the plans of the study's cases with these names.
fn plans(names: &[&str]) -> Vec<(String, Plan)> {
    study_cases()
        .iter()
        .filter(|case| names.contains(&case.name.as_str()))
        .map(|case| (format!("{:?} {}", case.protocol, case.name), plan_of(case, SEED)))
        .collect()
}

/// Asserts the conditions that `attributed` implies.
fn check_word(name: &str, report: &Report) {
    if report.verdict != Verdict::Attributed {
        return;
    }
    assert!(!report.effects.is_empty(), "{name}");
    for effect in &report.effects {
        assert!(effect.id != "unattributed" && effect.rivals.is_empty(), "{name}: {effect:?}");
        assert!(
            effect.error_before_n.is_some_and(|before_n| effect.error_after_n < before_n),
            "{name}: {effect:?}"
        );
        if let Some((parameter, size)) = effect.parameters.iter().find(|(p, _)| *p == "k" || *p == "g") {
            assert!(size.ci95[0] * size.ci95[1] > 0.0, "{name}: {parameter} {size:?}");
        }
    }
    if let (Some(promised), Some(baseline)) = (report.promise_n, report.promise_baseline_n) {
        assert!(promised <= baseline, "{name}: {promised} promised, {baseline} without");
    }
}

#[test]
fn unknown_effects_are_not_attributed() {
    let names = [
        "step of the reading in mid-session",
        "wave in time",
        "wave along the stroke",
        "worn spot",
        "memory of the load before",
    ];
    for (name, plan) in plans(&names) {
        let report = calibrated(&plan);
        assert_eq!(report.verdict, Verdict::Unattributed, "{name}: {:?}", report.effects);
    }
}

#[test]
fn confounded_effects_are_not_attributed() {
    let confounded = ["rate_dependence", "fixture_compliance"];
    for (name, plan) in plans(&confounded).into_iter().filter(|(name, _)| name.starts_with("Paper")) {
        let report = calibrated(&plan);
        assert_ne!(report.verdict, Verdict::Attributed, "{name}: {:?}", report.effects);
    }
}

#[test]
fn attributed_effects_have_a_size() {
    let effects = ["load_cell_offset", "load_cell_gain", "guide_drag", "stroke_position", "thermal_drift"];
    for (name, plan) in plans(&effects).into_iter().filter(|(name, _)| name.starts_with("Randomised")) {
        // From clearly detectable to hardly detectable.
        for share in [1.0, 0.15, 0.05] {
            let mut plan = plan.clone();
            plan.effects.iter_mut().filter_map(|e| e.values.first_mut()).for_each(|size| *size *= share);
            check_word(&format!("{name} times {share}"), &calibrated(&plan));
        }
    }
}

/// A drag of 10 N and a load cell that reads less: shapes with the same two traces once replaced
/// both effects, since a size of 10 N was slightly more probable for a shape than for a drag.
#[test]
fn a_huge_drag_stays_attributed() {
    for (seed, gain) in [(1, -0.035), (2, -0.03), (2, -0.045)] {
        let effects = [("guide_drag", 10.0), ("load_cell_gain", gain)];
        let effects = effects.map(|(id, size)| EffectPlan { id: id.to_owned(), values: vec![size], form: 0 });
        let report = calibrated(&Plan { seed, effects: effects.to_vec(), ..Plan::default() });
        let named: Vec<&str> = report.effects.iter().map(|e| e.id.as_str()).collect();
        assert_eq!(named, ["guide_drag", "load_cell_gain"], "seed {seed}, gain {gain}");
        assert_eq!(report.verdict, Verdict::Attributed, "seed {seed}, gain {gain}");
    }
}
