//! What only a rig with known effects and noise can tell about the calibrator.

use pinswitch_calibration::calibrate;
use pinswitch_calibration::inference::{Levels, Model, Observations, Weighed, interval_half_widths, select};
use pinswitch_calibration::segmentation::segment_run;
use pinswitch_calibration::table::{Frame, PlateauTable};

use crate::disturbance::{Disturbance, DisturbanceKind, DisturbanceTarget};
use crate::plan::{EffectPlan, NoisePlan, Plan, Protocol};
use crate::raw::RawRun;
use crate::simulate::simulate;
use crate::study::{Case, Group, run_case, study_cases};

fn estimated_correlation(plan: &Plan) -> f64 {
    let rows = simulate(plan).rows;
    let frame = Frame::new(&rows);
    let mut data = Observations::new(&frame, &rows).unwrap();
    select(&Model::baseline(frame), &mut data, Levels::default()).noise.correlation
}

#[test]
fn a_chain_is_found_as_strong_as_it_is() {
    for (rho, seed) in [(0.25, 5), (0.5, 6), (0.8, 7)] {
        let mut plan = Plan { seed, ..Plan::default() };
        plan.noise.autocorrelation = rho;
        let estimate = estimated_correlation(&plan);
        assert!((estimate - rho).abs() < 0.1, "{estimate} instead of {rho}");
    }
}

#[test]
fn independent_repetitions_are_left_alone_even_where_the_stroke_has_a_course() {
    let mut plan = Plan { seed: 8, ..Plan::default() };
    assert_eq!(estimated_correlation(&plan), 0.0);
    let kind = DisturbanceKind::Spot { at: 0.4, width: 0.15, flat: false };
    plan.disturbances.push(Disturbance { kind, target: DisturbanceTarget::Friction, size: 0.2 });
    assert_eq!(estimated_correlation(&plan), 0.0);
    plan.disturbances[0].kind = DisturbanceKind::TimeWave { cycles: 20.0, phase: 0.3 };
    (plan.disturbances[0].target, plan.disturbances[0].size) = (DisturbanceTarget::Reading, 0.2);
    assert!(estimated_correlation(&plan) < 0.25, "a slow wave is mostly a drift inside a series");
}

/// One absurd reading of three thousand is weighed down so far that not even the intervals notice.
#[test]
fn a_spike_of_any_size_leaves_sizes_and_intervals_alone() {
    let mut plan = Plan::default();
    plan.effects.push(EffectPlan { id: "load_cell_gain".to_owned(), values: vec![0.03], form: 0 });
    let rows = simulate(&plan).rows;
    let found = |spike_n: f64| {
        let mut rows = rows.clone();
        rows[5].force_n += spike_n;
        let frame = Frame::new(&rows);
        let mut data = Observations::new(&frame, &rows).unwrap();
        let found = select(&Model::baseline(frame), &mut data, Levels::default());
        let widths = interval_half_widths(&found.augmented, &Weighed::new(&data, found.noise));
        (found.augmented.model.values().pop().unwrap(), widths.last().copied().unwrap())
    };
    let (size, width) = found(0.0);
    for spike_n in [3.0, 1e3, 1e5] {
        let (with, wide) = found(spike_n);
        assert!((with - size).abs() < 0.05 * width, "{with} instead of {size} with {spike_n} N");
        assert!((wide / width - 1.0).abs() < 0.02, "{wide} instead of {width} with {spike_n} N");
    }
}

/// A rig with another wrap angle: the coefficients come out as they are once the table says the angle, and wrong by the
/// ratio of the angles if it does not.
#[test]
fn the_wrap_angle_of_the_table_reaches_the_fit() {
    let plan = Plan { wrap_angle_deg: 95.0, seed: 4, ..Plan::default() };
    let table = PlateauTable::write(&simulate(&plan).rows);
    let coefficients = |table: &str| {
        let rows = PlateauTable::read(table.as_bytes(), "t.csv").unwrap().rows;
        let report = calibrate(&rows, Levels::default()).unwrap().report;
        ["mu_p", "mu_s"].map(|name| report.baseline.parameters[name].value)
    };
    let [mu_p, mu_s] = coefficients(&table);
    assert!((mu_p / plan.constants.mu_p - 1.0).abs() < 0.03, "{mu_p}");
    assert!((mu_s / plan.constants.mu_s - 1.0).abs() < 0.03, "{mu_s}");
    let silent = table.replace(",wrap_angle_deg", "").replace(",95\n", "\n");
    let [_, mu_s] = coefficients(&silent);
    assert!((mu_s / plan.constants.mu_s - 95.0 / 63.89).abs() < 0.1, "{mu_s}");
}

/// From `run.toml` to the table: the angle of the rig stands in every row, and the paper's in none.
#[test]
fn the_wrap_angle_of_a_run_reaches_the_table() {
    for (wrap_angle_deg, column) in [(95.0, true), (63.89, false)] {
        let plan =
            Plan { wrap_angle_deg, weights_g: vec![251.2, 2505.4], layouts: Vec::new(), ..Plan::default() };
        let rows = simulate(&plan).rows;
        let run = RawRun::new(&plan, &rows, "plan").unwrap();
        let logs: Vec<_> = (0..run.logs()).filter_map(|i| run.log(i)).collect();
        let found = segment_run(&run.description(""), "run.toml", |file| {
            logs.iter()
                .find(|log| log.file == file)
                .map(|log| log.text.clone().into_bytes())
                .ok_or("no such log")
        })
        .unwrap();
        assert_eq!(found.report.series.len(), 2);
        assert!(found.rows.iter().all(|row| row.wrap_angle_deg == wrap_angle_deg));
        assert_eq!(PlateauTable::write(&found.rows).contains("wrap_angle_deg"), column);
    }
}

/// Beside every kind of noise at once, shapes found before any scatter was known stood where a strong name had stood, and a
/// second name where mounts and a walk explain the same.
#[test]
fn no_scatter_is_told_as_a_shape_or_a_second_name_beside_a_strong_one() {
    let cases = [
        ("run_in", Protocol::Paper, 2_023_002),
        ("stroke_position", Protocol::Randomised, 2_111_002),
        ("guide_drag", Protocol::Randomised, 2_114_001),
        ("coating_stiffening", Protocol::Randomised, 2_101_002),
    ];
    for (name, protocol, seed) in cases {
        let is_meant = |c: &Case| c.name == name && c.protocol == protocol && c.group == Group::Singles;
        let case = Case { every_noise: true, ..study_cases().into_iter().find(is_meant).unwrap() };
        let outcome = run_case(&case, seed, Levels::default(), false).unwrap();
        assert!(outcome.exact, "{name}: {:?}", outcome.named);
    }
}

/// Between the places of the library lie waves that a fit from them does not reach.
#[test]
fn a_quick_wave_is_drawn_with_its_own_frequency() {
    for (cycles, seed) in [(14.25, 2), (20.1, 9), (38.4, 3), (61.7, 4)] {
        let mut plan = Plan { seed, ..Plan::default() };
        let kind = DisturbanceKind::TimeWave { cycles, phase: 2.0 };
        plan.disturbances.push(Disturbance { kind, target: DisturbanceTarget::Reading, size: 0.15 });
        let form = calibrate(&simulate(&plan).rows, Levels::default()).unwrap().form.unwrap().report;
        let (size, frequency) = (form.parameters["a"].value.abs(), form.parameters["f"].value);
        assert!(form.shape == "sine" && (frequency / cycles - 1.0).abs() < 0.02, "{cycles}: {form:?}");
        assert!((size / 0.15 - 1.0).abs() < 0.2, "{cycles}: {form:?}");
    }
}

/// A rig made by the noise that was found on another has that noise: what is planned by it is planned for that rig.
#[test]
fn the_noise_that_was_found_is_found_again_on_a_rig_made_by_it() {
    let found = |plan: &Plan| {
        let rows = simulate(plan).rows;
        let frame = Frame::new(&rows);
        let mut data = Observations::new(&frame, &rows).unwrap();
        select(&Model::baseline(frame), &mut data, Levels::default()).noise
    };
    let noise = NoisePlan { series_scale: 0.03, repetition_n: 0.12, series_n: 0.08, ..NoisePlan::default() };
    let first = found(&Plan { seed: 11, noise, ..Plan::default() });
    let again = found(&Plan { seed: 12, noise: NoisePlan::of_rig(first), ..Plan::default() });
    for (name, a, b, factor) in [
        ("repetition", first.repetition.at(20.0), again.repetition.at(20.0), 1.1),
        ("series", first.series.at(20.0), again.series.at(20.0), 1.5),
        ("scale", first.series_scale, again.series_scale, 1.5),
    ] {
        assert!(a / b < factor && b / a < factor, "{name}: {a} and {b}");
    }
}
