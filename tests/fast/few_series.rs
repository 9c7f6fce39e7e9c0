//! Calibration of a table with few series.

use pinswitch_calibration::effects::Vocabulary;
use pinswitch_calibration::table::PlateauTable;
use pinswitch_calibration::{Verdict, calibrate};

use crate::harness::repository;

/// 24 series of three conditions from an independent simulator, with `rate_dependence` of 0.3.
/// With so few series, variation between them could explain the effect as well, and its trend with the
/// logarithm of speed could be structure without a name.
#[test]
fn effects_are_detected_in_few_series() {
    let file = repository("tests/corpus/plateaus/accepted-few-series.csv");
    let table = PlateauTable::read(std::fs::File::open(file).unwrap(), "few-series.csv").unwrap();
    let report = calibrate(&table.rows, &Vocabulary::built_in(), 1).unwrap().report;
    let [effect] = report.effects.as_slice() else { panic!("{:?}: {:?}", report.verdict, report.effects) };
    assert_eq!((report.verdict, effect.id.as_str()), (Verdict::Attributed, "rate_dependence"));
    let [low, high] = effect.parameters["k"].ci95;
    assert!(low < 0.3 && 0.3 < high, "{low} {high}");
    // The hypotheses are weighed without the series that is predicted, and still contain it.
    assert!(report.promise_n.unwrap() < 0.6 * report.promise_baseline_n.unwrap(), "{:?}", report.promise_n);
}
