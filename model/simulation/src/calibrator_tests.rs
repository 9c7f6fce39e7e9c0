//! What only a rig with known effects and noise can tell about the calibrator.

use pinswitch_calibration::inference::{Levels, Model, Observations, interval_half_widths, select};
use pinswitch_calibration::table::Frame;

use crate::{Disturbance, EffectPlan, Kind, Plan, Target, simulate};

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
    let kind = Kind::Spot { at: 0.4, width: 0.15, flat: false };
    plan.disturbances.push(Disturbance { kind, target: Target::Friction, size: 0.2 });
    assert_eq!(estimated_correlation(&plan), 0.0);
    plan.disturbances[0].kind = Kind::TimeWave { cycles: 20.0, phase: 0.3 };
    (plan.disturbances[0].target, plan.disturbances[0].size) = (Target::Reading, 0.2);
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
        let widths = interval_half_widths(&found.augmented, &data, found.noise);
        (found.augmented.model.values().pop().unwrap(), widths.last().copied().unwrap())
    };
    let (size, width) = found(0.0);
    for spike_n in [3.0, 1e3, 1e5] {
        let (with, wide) = found(spike_n);
        assert!((with - size).abs() < 0.05 * width, "{with} instead of {size} with {spike_n} N");
        assert!((wide / width - 1.0).abs() < 0.02, "{wide} instead of {width} with {spike_n} N");
    }
}
