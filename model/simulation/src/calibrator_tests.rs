//! Tests of the calibrator that need a rig with known effects and noise.

use pinswitch_calibration::effects::Vocabulary;
use pinswitch_calibration::evidence::{Evidence, Fitted};
use pinswitch_calibration::segmentation::segment_run;
use pinswitch_calibration::table::{PlateauRow, PlateauTable};
use pinswitch_calibration::{Estimate, Verdict, calibrate};

use crate::disturbance::{Disturbance, DisturbanceKind, DisturbanceTarget};
use crate::plan::{EffectPlan, NoisePlan, Plan, Protocol};
use crate::raw::RawRun;
use crate::simulate::simulate;
use crate::study::{Case, Group, run_case, study_cases};

/// Fits the baseline without effects.
fn fitted_baseline(rows: &[PlateauRow]) -> Fitted {
    let evidence = Evidence::baseline(rows, 1).unwrap();
    evidence.fitted(&evidence.posterior().baseline).unwrap()
}

/// The inference has a few correlations to choose from, which are smaller than those of the rigs.
#[test]
fn autocorrelation_is_detected() {
    for (rho, seed, least, most) in [(0.0, 8, 0.0, 0.0), (0.5, 6, 0.2, 0.5), (0.8, 7, 0.4, 0.8)] {
        let mut plan = Plan { seed, ..Plan::default() };
        plan.noise.autocorrelation = rho;
        let estimate = fitted_baseline(&simulate(&plan).rows).noise.correlation;
        assert!((least..=most).contains(&estimate), "{estimate} instead of {rho}");
    }
}

/// A worn spot with edges between two of 150 positions is one structure: with fewer functions along the stroke than positions, what
/// was left of its edges was another one of each direction.
#[test]
fn edges_of_a_worn_spot_are_no_other_structure() {
    let mut plan = Plan { protocol: Protocol::Paper, seed: 3, ..Plan::default() };
    plan.layouts.truncate(1);
    plan.disturbances.push(Disturbance {
        kind: DisturbanceKind::Spot { at: 0.48, width: 0.08, flat: true },
        target: DisturbanceTarget::Friction,
        size: 0.25,
    });
    let report = calibrate(&simulate(&plan).rows, &Vocabulary::built_in(), 1).unwrap().report;
    let named: Vec<&str> = report.effects.iter().map(|e| e.covariate.as_str()).collect();
    assert_eq!(named, ["position"], "{:?}", report.effects);
}

/// One gross error among a thousand readings changes no estimate.
#[test]
fn one_spike_changes_no_estimate() {
    let mut plan = Plan::default();
    plan.layouts.truncate(1);
    plan.effects.push(EffectPlan { id: "load_cell_gain".to_owned(), values: vec![0.03], form: 0 });
    let rows = simulate(&plan).rows;
    let estimate = |spike_n: f64| -> Estimate {
        let mut rows = rows.clone();
        rows[5].force_n += spike_n;
        let report = calibrate(&rows, &Vocabulary::built_in(), 1).unwrap().report;
        assert_eq!(report.effects.len(), 1, "{:?}", report.effects);
        report.effects[0].parameters.values().next().unwrap().clone()
    };
    let width = |e: &Estimate| e.ci95[1] - e.ci95[0];
    let without = estimate(0.0);
    for spike_n in [3.0, 1e4] {
        let with = estimate(spike_n);
        assert!((with.value - without.value).abs() < 0.05 * width(&without), "{with:?} with {spike_n} N");
        assert!((width(&with) / width(&without) - 1.0).abs() < 0.02, "{with:?} with {spike_n} N");
    }
}

/// With another wrap angle, the estimated coefficients are correct if the table has the angle.
/// Without it, they are wrong by the ratio of the angles.
#[test]
fn fit_uses_the_wrap_angle() {
    let plan = Plan { wrap_angle_deg: 95.0, seed: 4, ..Plan::default() };
    let table = PlateauTable::write(&simulate(&plan).rows);
    let coefficients = |table: &str| {
        let rows = PlateauTable::read(table.as_bytes(), "t.csv").unwrap().rows;
        let model = fitted_baseline(&rows).model;
        ["mu_p", "mu_s"].map(|name| model.constant(name).unwrap())
    };
    let [mu_p, mu_s] = coefficients(&table);
    assert!((mu_p / plan.constants.mu_p - 1.0).abs() < 0.03, "{mu_p}");
    assert!((mu_s / plan.constants.mu_s - 1.0).abs() < 0.03, "{mu_s}");
    let without_angle = table.replace(",wrap_angle_deg", "").replace(",95\n", "\n");
    let [_, mu_s] = coefficients(&without_angle);
    assert!((mu_s / plan.constants.mu_s - 95.0 / 63.89).abs() < 0.1, "{mu_s}");
}

/// Every row has the wrap angle of `run.toml`. The published angle needs no column.
#[test]
fn table_has_the_wrap_angle() {
    for (wrap_angle_deg, column) in [(95.0, true), (63.89, false)] {
        let plan =
            Plan { wrap_angle_deg, weights_g: vec![251.2, 2505.4], layouts: Vec::new(), ..Plan::default() };
        let rows = simulate(&plan).rows;
        let run = RawRun::new(&plan, &rows, "plan").unwrap();
        let logs: Vec<_> = (0..run.logs()).filter_map(|i| run.log(i)).collect();
        let segmented = segment_run(&run.description(""), "run.toml", |file| {
            logs.iter()
                .find(|log| log.file == file)
                .map(|log| log.text.clone().into_bytes())
                .ok_or(std::io::Error::from(std::io::ErrorKind::NotFound))
        })
        .unwrap();
        assert_eq!(segmented.report.series.len(), 2);
        assert!(segmented.rows.iter().all(|row| row.wrap_angle_deg == wrap_angle_deg));
        assert_eq!(PlateauTable::write(&segmented.rows).contains("wrap_angle_deg"), column);
    }
}

/// Regression test with every kind of noise at once: the calibrator once reported a shape in place
/// of a strong effect, and a second effect where the random effects of mounts and series explain
/// the data.
#[test]
fn scatter_is_not_attributed() {
    let cases = [
        ("run_in", Protocol::Paper, 2_023_002),
        ("stroke_position", Protocol::Randomised, 2_111_002),
        ("guide_drag", Protocol::Randomised, 2_114_001),
        ("coating_stiffening", Protocol::Randomised, 2_101_002),
    ];
    for (name, protocol, seed) in cases {
        let is_meant = |c: &Case| c.name == name && c.protocol == protocol && c.group == Group::Singles;
        let case = Case { every_noise: true, ..study_cases().into_iter().find(is_meant).unwrap() };
        let outcome = run_case(&case, seed).unwrap();
        assert!(outcome.exact, "{name}: {:?}", outcome.named);
    }
}

fn assert_exact(rigs: &[(&str, Protocol, u64)]) {
    for (name, protocol, seed) in rigs {
        let case = study_cases().into_iter().find(|c| c.name == *name && c.protocol == *protocol);
        let outcome = run_case(&case.unwrap(), *seed).unwrap();
        assert!(outcome.exact, "{name}, {protocol:?}: {:?}", outcome.named);
    }
}

/// A layout that is defective on both materials was an interval of time where its series follow each other, and the edges of a
/// square wave along the stroke were repetitions.
#[test]
fn structure_has_the_covariate_of_its_cause() {
    assert_exact(&[
        ("one defective layout", Protocol::Randomised, 11_765_004),
        ("wave along the stroke", Protocol::Paper, 11_675_003),
        ("wave along the stroke", Protocol::Randomised, 11_763_004),
    ]);
}

/// Friction that wanders in each direction by itself was structure over time.
#[test]
fn offsets_that_wander_are_noise() {
    assert_exact(&[
        ("no effect, walking offsets", Protocol::Paper, 11_615_003),
        ("no effect, walking offsets", Protocol::Randomised, 11_698_008),
    ]);
}

/// Run-in that decays as a hyperbola left structure over the repetition beside its exponential.
#[test]
fn hyperbolic_run_in_leaves_no_structure() {
    for plan in [Plan { seed: 7, ..Plan::default() }, Plan { seed: 8, ..Plan::randomised() }] {
        let effect = EffectPlan { id: "run_in".to_owned(), values: vec![0.3, 1.5, 1.0], form: 1 };
        let plan = Plan { effects: vec![effect], ..plan };
        let report = calibrate(&simulate(&plan).rows, &Vocabulary::built_in(), 1).unwrap().report;
        let ids: Vec<&str> = report.effects.iter().map(|effect| effect.id.as_str()).collect();
        assert_eq!((report.verdict, ids), (Verdict::Attributed, vec!["run_in"]), "{}", plan.seed);
        let [least, most] = report.effects[0].parameters["k"].ci95;
        assert!((least..most).contains(&0.3), "{:?}", report.effects[0]);
    }
}

/// The frequencies are between those of the library.
#[test]
fn waves_have_the_right_frequency() {
    for (cycles, seed) in [(3.3, 1), (14.25, 2)] {
        let mut plan = Plan { seed, ..Plan::default() };
        let kind = DisturbanceKind::TimeWave { cycles, phase: 2.0 };
        plan.disturbances.push(Disturbance { kind, target: DisturbanceTarget::Reading, size: 0.15 });
        let calibration = calibrate(&simulate(&plan).rows, &Vocabulary::built_in(), 1).unwrap();
        let form = calibration.form.unwrap().report;
        let (size, frequency) = (form.parameters["a"].value.abs(), form.parameters["f"].value);
        assert!(form.shape == "sine" && (frequency / cycles - 1.0).abs() < 0.05, "{cycles}: {form:?}");
        assert!((size / 0.15 - 1.0).abs() < 0.2, "{cycles}: {form:?}");
    }
}

#[test]
fn structure_is_not_autocorrelation() {
    let mut plan = Plan { seed: 8, ..Plan::default() };
    let kind = DisturbanceKind::Spot { at: 0.4, width: 0.15, flat: false };
    plan.disturbances.push(Disturbance { kind, target: DisturbanceTarget::Friction, size: 0.2 });
    let report = calibrate(&simulate(&plan).rows, &Vocabulary::built_in(), 1).unwrap().report;
    assert_eq!(report.noise.correlation, 0.0, "{:?}", report.effects);
}

/// The estimate of the noise is a plan for a rig with the same noise.
#[test]
fn estimated_noise_is_reproduced() {
    let estimate = |plan: &Plan| fitted_baseline(&simulate(plan).rows).noise;
    let noise = NoisePlan { series_scale: 0.03, repetition_n: 0.12, series_n: 0.08, ..NoisePlan::default() };
    let first = estimate(&Plan { seed: 11, noise, ..Plan::default() });
    let again = estimate(&Plan { seed: 12, noise: NoisePlan::from_estimate(first), ..Plan::default() });
    for (name, a, b, factor) in [
        ("repetition", first.repetition.at(20.0), again.repetition.at(20.0), 1.1),
        ("series", first.series.at(20.0), again.series.at(20.0), 1.5),
        ("scale", first.series_scale, again.series_scale, 1.5),
    ] {
        assert!(a / b < factor && b / a < factor, "{name}: {a} and {b}");
    }
}
