//! Calibration of small tables as laboratories make them, which rigs of the paper's kind are unlike.

use pinswitch_calibration::effects::Vocabulary;
use pinswitch_calibration::evidence::Session;
use pinswitch_calibration::table::{Optional, PlateauTable};
use pinswitch_calibration::{ModelFile, Report, Verdict, calibrate};

use crate::harness::repository;

fn table(name: &str) -> PlateauTable {
    let file = repository("tests/data/laboratories").join(name);
    PlateauTable::read(std::fs::File::open(file).unwrap(), name).unwrap()
}

fn report(name: &str) -> Report {
    calibrate(&table(name).rows, &Vocabulary::built_in(), 1).unwrap().report
}

/// A laboratory without positions, clock, speeds and dwells has the verdict of its readings: those
/// columns are empty, and no covariate is made of them.
#[test]
fn tables_without_covariates_keep_their_verdict() {
    for name in ["drag-and-gain.csv", "capstan-seven-angles.csv", "four-stops.csv"] {
        let mut rows = table(name).rows;
        for row in &mut rows {
            row.unknown =
                Optional::ALL.into_iter().fold(row.unknown, |unknown, quantity| unknown.with(quantity));
        }
        let text = PlateauTable::write(&rows);
        assert!(text.starts_with("series,substrate,pins,load_N,direction,force_N"), "{text}");
        let rows = PlateauTable::read(text.as_bytes(), name).unwrap().rows;
        let report = calibrate(&rows, &Vocabulary::built_in(), 1).unwrap().report;
        assert_eq!(report.unknown_columns.len(), Optional::ALL.len());
        let over = ["position", "time", "speed", "dwell", "repetition", "sweep"];
        assert!(report.effects.iter().all(|e| !over.contains(&e.covariate.as_str())), "{:?}", report.effects);
        let before = self::report(name);
        let ids = |report: &Report| report.effects.iter().map(|e| e.id.clone()).collect::<Vec<_>>();
        if name != "four-stops.csv" {
            assert_eq!((report.verdict, ids(&report)), (before.verdict, ids(&before)), "{name}");
        }
    }
}

/// Six loads on one contact, mu = 0.18, drag 5 N, gain 1.15: the model is as good as least squares with
/// these three constants, and names them or what the table cannot separate from them.
#[test]
fn drag_and_gain_are_named() {
    let report = report("drag-and-gain.csv");
    let names: Vec<Vec<&str>> = report
        .effects
        .iter()
        .map(|e| std::iter::once(e.id.as_str()).chain(e.rivals.iter().map(|r| r.id.as_str())).collect())
        .collect();
    let has = |id: &str| names.iter().any(|ids| ids.contains(&id));
    assert!(names.len() == 2 && has("guide_drag") && has("load_cell_gain"), "{names:?}");
    // Without a switch, adhesion of the contact is part of the drag, and not its rival.
    let drag = report.effects.iter().find(|e| e.id == "guide_drag").unwrap();
    assert!(drag.includes == ["adhesion"] && drag.rivals.iter().all(|r| r.id != "adhesion"), "{drag:?}");
    let gain = report.effects.iter().find(|e| e.id == "load_cell_gain").unwrap();
    let [low, high] = gain.parameters["g"].ci95;
    assert!(low < 0.15 && 0.15 < high, "{gain:?}");
    let least_squares = report.least_squares_n.unwrap();
    assert!(report.augmented.heldout_series_rmse_n < 1.05 * least_squares, "{least_squares}");
    assert!(report.expected_error_n.unwrap().value < 0.15, "{:?}", report.expected_error_n);
}

/// The fourth repetition of every series has the wrong direction. Its rows are found, and the others
/// are predicted as if it were absent.
#[test]
fn repetitions_with_gross_errors_are_found() {
    let report = report("wrong-fourth-repetitions.csv");
    let series: Vec<&str> = report.bad_series.iter().map(|bad| bad.series.as_str()).collect();
    assert_eq!(series, ["0", "1", "2", "3", "4", "5"], "{:?}", report.bad_series);
    assert!(report.augmented.heldout_series_rmse_n < 0.1, "{:?}", report.augmented);
    assert!(report.effects.is_empty(), "{:?}", report.effects);
}

/// A textbook capstan with mu = 0.18 at seven wrap angles: the wrap is used.
#[test]
fn a_capstan_has_its_friction_coefficient() {
    let report = report("capstan-seven-angles.csv");
    assert_eq!(report.verdict, Verdict::None, "{:?}", report.effects);
    let mu = &report.augmented.parameters["mu"];
    let [low, high] = mu.ci95;
    assert!((mu.value - 0.18).abs() < 5e-4 && low < 0.18 && 0.18 < high + 1e-5, "{mu:?}");
}

/// One load at several angles is the oldest capstan experiment.
#[test]
fn one_load_at_many_angles_has_a_friction_coefficient() {
    let mut rows = table("capstan-seven-angles.csv").rows;
    let load_n = rows[0].load_n;
    rows.retain(|row| row.load_n == load_n);
    let one_load = PlateauTable::read(PlateauTable::write(&rows).as_bytes(), "t.csv").unwrap();
    one_load.require_baseline("t.csv").unwrap();
    let report = calibrate(&one_load.rows, &Vocabulary::built_in(), 1).unwrap().report;
    let mu = &report.augmented.parameters["mu"];
    assert!((mu.value - 0.18).abs() < 2e-3 && mu.ci95[0] < 0.18 && 0.18 < mu.ci95[1], "{mu:?}");
    assert!(report.effects.is_empty(), "{:?}", report.effects);
    // One angle of them determines nothing.
    let wrap_deg = rows[0].wrap_angle_deg;
    rows.retain(|row| row.wrap_angle_deg == wrap_deg);
    let one_angle = PlateauTable::read(PlateauTable::write(&rows).as_bytes(), "t.csv").unwrap();
    assert!(one_angle.require_baseline("t.csv").unwrap_err().to_string().contains("1 different load"));
}

/// Four stops along the stroke with nothing periodic between them: no structure is finer than the
/// sampling.
#[test]
fn four_stops_show_no_wave() {
    let report = report("four-stops.csv");
    let forms = report.effects.iter().filter_map(|effect| effect.form.as_ref());
    assert!(forms.clone().all(|form| form.shape != "sine"), "{:?}", forms.collect::<Vec<_>>());
    assert!(report.effects.iter().all(|effect| effect.covariate != "time"), "{:?}", report.effects);
    assert!(report.augmented.heldout_series_rmse_n < report.least_squares_n.unwrap());
}

/// Returns the id of each reported effect with its covariate; `unattributed` for structure.
fn reported(report: &Report) -> Vec<(String, String)> {
    report.effects.iter().map(|effect| (effect.id.clone(), effect.covariate.clone())).collect()
}

fn structure(covariate: &str) -> (String, String) {
    ("unattributed".to_owned(), covariate.to_owned())
}

/// The first reading after each reversal is 1 N low: fifteen gross errors are one pattern.
#[test]
fn the_same_mistake_in_every_series_is_structure() {
    let report = report("same-mistake.csv");
    assert_eq!(reported(&report), [structure("repetition")]);
    assert!(report.expected_error_n.unwrap().value < 0.08, "{:?}", report.expected_error_n);
}

/// Friction is 20 % lower in the last third of the session. Scatter between series does not hide it, and
/// its curvature has no other name.
#[test]
fn a_step_of_friction_is_not_scatter() {
    let report = report("friction-step.csv");
    assert_eq!(reported(&report), [structure("time")]);
    assert!(report.augmented.heldout_series_rmse_n < 0.08, "{:?}", report.augmented);
}

/// Friction differs by the factors 1, 1.4 and 0.8 between three sessions, next to a drag of 0.4 N.
#[test]
fn changes_between_sessions_have_no_other_name() {
    let report = report("friction-of-sessions.csv");
    assert_eq!(reported(&report), [("guide_drag".to_owned(), "direction".to_owned())]);
    let factors = &report.changes[0].factors;
    let ratio = factors["d1"] / factors["d2"];
    assert!((ratio / (1.4 / 0.8) - 1.0).abs() < 0.05, "{factors:?}");
}

/// One of five weights reads 6 % high. A formula takes the place of structure in the model only if its
/// predictions are as good.
#[test]
fn models_predict_their_own_table() {
    let rows = table("one-wrong-weight.csv").rows;
    let calibration = calibrate(&rows, &Vocabulary::built_in(), 1).unwrap();
    let file = ModelFile::new(&calibration.augmented);
    let (predicted, _) = file.predict(&rows, Session::Fitted, "model.toml").unwrap();
    let square: f64 = predicted.iter().zip(&rows).map(|(p, row)| (p - row.force_n).powi(2)).sum();
    let rms_n = (square / rows.len() as f64).sqrt();
    assert!(rms_n < 1.2 * calibration.report.augmented.rmse_n, "{rms_n}, {:?}", calibration.report.augmented);
}
