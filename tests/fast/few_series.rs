//! A table with few series names what it shows.

use pinswitch_calibration::inference::Levels;
use pinswitch_calibration::table::PlateauTable;
use pinswitch_calibration::{Verdict, calibrate};

use crate::harness::repository;

/// Found by an attack: 24 series of three conditions, by a simulator of another hand, with `rate_dependence` of 0.3. What names
/// explain is not taken out of so few series before the noise is estimated: the effect passed for scatter of the series, and a course
/// with the logarithm of speed, which is its very formula, for structure without a name.
#[test]
fn an_effect_is_named_beside_the_noise_that_it_leaves() {
    let file = repository("tests/corpus/plateaus/accepted-few-series.csv");
    let table = PlateauTable::read(std::fs::File::open(file).unwrap(), "few-series.csv").unwrap();
    let report = calibrate(&table.rows, Levels::default()).unwrap().report;
    let [effect] = report.effects.as_slice() else { panic!("{:?}: {:?}", report.verdict, report.effects) };
    assert_eq!((report.verdict, effect.id.as_str()), (Verdict::Attributed, "rate_dependence"));
    let [low, high] = effect.parameters["k"].ci95;
    assert!(low < 0.3 && 0.3 < high, "{low} {high}");
    // The folds of the promise have fewer series still, and find it all the same.
    assert!(report.promise_n.unwrap() < 0.6 * report.promise_baseline_n.unwrap(), "{:?}", report.promise_n);
}
