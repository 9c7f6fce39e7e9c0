//! Tests of the whole inference on small sessions.

use pinswitch_inference::{Member, SizedEffect};

use super::{Evidence, Session};
use crate::effects::{Channel, Covariate, Shape, Structure, Vocabulary, effect_named};
use crate::model::Term;
use crate::model_file::ModelFile;
use crate::table::{Frame, Labels, PlateauRow};
use crate::test_session::{session, session_with};

fn evidence(rows: &[PlateauRow]) -> Evidence {
    Evidence::new(rows, &Vocabulary::built_in(), 1).unwrap()
}

fn reported(evidence: &Evidence) -> Vec<&str> {
    evidence.posterior().reported.iter().map(|r| evidence.name(r.member)).collect()
}

/// Readings that a constant does not change are kept: with any effect they equal those of a new evaluation.
#[test]
fn moved_constants_change_all_that_depends_on_them() {
    let rows: Vec<PlateauRow> = session(3).into_iter().step_by(5).collect();
    let evidence = Evidence::baseline(&rows, 1).unwrap();
    let space = evidence.problem().space();
    let forward = &evidence.problem().rows().forward;
    let constants: Vec<f64> = space.constants.iter().map(|constant| constant.mean).collect();
    let curved = vec![(0..rows.len()).map(|row| 0.01 * (row % 3) as f64).collect()];
    for (effect, prior) in space.effects.iter().enumerate() {
        let size = prior.starts.first().copied().unwrap_or(1.0);
        let effects = [SizedEffect { effect, shape: 0, size, shifts: [0.0; 3] }];
        let readings = forward.readings_at(&constants, &effects, &curved);
        for constant in 0..constants.len() {
            let mut moved = constants.clone();
            moved[constant] += 0.1;
            let kept = forward.readings_where_moved([&constants, &moved], &effects, &curved, &readings);
            assert_eq!(kept, forward.readings_at(&moved, &effects, &curved), "{} {constant}", prior.name);
            assert_ne!(kept, readings, "{} {constant}", prior.name);
        }
    }
}

#[test]
fn nothing_is_reported_without_effects() {
    let evidence = evidence(&session(3));
    assert!(reported(&evidence).is_empty());
    assert!(!evidence.posterior().candidates.is_empty());
}

/// The size is within three standard deviations of the true one, and predictions contain it.
#[test]
fn an_offset_is_attributed() {
    let term = Term::named(effect_named("load_cell_offset").unwrap());
    let rows = session_with(4, &[(term, &[0.6])]);
    let evidence = evidence(&rows);
    assert_eq!(reported(&evidence), ["load_cell_offset"]);
    let size = evidence.posterior().size(member_index(&evidence, "load_cell_offset")).unwrap();
    assert!((size.mean - 0.6).abs() < 3.0 * size.sd && size.sd < 0.05, "{size:?}");
    let predictions = evidence.predict(&rows, Session::New).unwrap();
    let squares = predictions.iter().zip(&rows).map(|(p, row)| (p.mean - row.force_n).powi(2));
    let error = (squares.sum::<f64>() / rows.len() as f64).sqrt();
    let expected = evidence.posterior().expected_error.unwrap();
    assert!(error < 0.1 && error < 2.0 * expected.value, "{error} {expected:?}");
}

fn member_index(evidence: &Evidence, name: &str) -> usize {
    evidence.problem().space().effects.iter().position(|effect| effect.name == name).unwrap()
}

/// Contacts at several angles have one friction coefficient, so that no structure over the wrap
/// angle is needed.
#[test]
fn plain_contacts_use_their_wrap_angle() {
    let mut rows = Vec::new();
    for (series, (degrees, load_n)) in
        [(45.0, 5.0), (90.0, 5.0), (180.0, 5.0), (45.0, 20.0), (90.0, 20.0), (180.0, 20.0)]
            .into_iter()
            .enumerate()
    {
        for mut row in session(5).into_iter().take(18) {
            row.series = series.to_string();
            row.substrate = None;
            row.pins = Vec::new();
            row.load_n = load_n;
            row.wrap_angle_deg = degrees;
            row.time_s += 100.0 * series as f64;
            let exponent = 0.18 * f64::to_radians(degrees) * row.direction.sign();
            let noise = 0.02 * libm::sin(7.0 * row.time_s + degrees);
            row.force_n = load_n * libm::exp(exponent) + noise;
            rows.push(row);
        }
    }
    let evidence = evidence(&rows);
    assert!(reported(&evidence).is_empty(), "{:?}", reported(&evidence));
    let constants = evidence.posterior().window[0].constants();
    assert_eq!(constants.len(), 1);
    assert!((libm::exp(constants[0]) - 0.18).abs() < 0.005, "{constants:?}");
}

/// Structure over a covariate needs at least three values of it, or two levels of a factor.
#[test]
fn kernels_are_not_finer_than_the_sampling() {
    let mut rows = session(6);
    rows.retain(|row| row.repetition <= 2);
    rows.iter_mut().for_each(|row| row.position_mm = 20.0);
    let evidence = evidence(&rows);
    let kernels = &evidence.problem().space().kernels;
    assert!(kernels.iter().all(|k| k.covariate != "position" && k.covariate != "dwell"));
    assert!(kernels.iter().all(|k| !k.name.contains("repetition") && !k.name.contains("operator")));
    assert!(kernels.iter().any(|k| k.covariate == "load"));
}

/// A device that was not measured has no threshold, and the error names it.
#[test]
fn an_unmeasured_device_is_refused() {
    let evidence = evidence(&session(7));
    let mut row = session(7)[0].clone();
    row.pins = vec![6, 8, 10];
    let error = evidence.predict(&[row], Session::New).unwrap_err();
    assert_eq!(error.problem(), "no series of silicone 6;8;10 in the fitted table");
    assert!(error.help().is_some());
}

/// A few rows of the fitted session are predicted as in the whole table.
#[test]
fn few_rows_of_the_fitted_session_are_predicted() {
    let rows = session(7);
    let evidence = evidence(&rows);
    let whole = evidence.predict(&rows, Session::Fitted).unwrap();
    let few = evidence.predict(&rows[..3], Session::Fitted).unwrap();
    assert!(few.iter().zip(&whole).all(|(few, whole)| (few.mean - whole.mean).abs() < 1e-9));
}

/// The name of a kernel contains its channel, and its curve has a value for every row.
#[test]
fn structure_is_reported_with_its_covariate() {
    let mut rows = session(8);
    rows.iter_mut().for_each(|row| {
        row.force_n += if row.repetition % 2 == 0 { 0.1 } else { -0.1 };
    });
    let evidence = evidence(&rows);
    let member = evidence.posterior().reported[0].member;
    assert_eq!(evidence.name(member), "reading over alternate repetitions");
    assert_eq!(evidence.covariate(member), "repetition");
    let Member::Kernel(kernel) = member else { panic!("an effect") };
    let curve = evidence.posterior().curve(evidence.problem(), kernel).unwrap();
    assert_eq!(curve.len(), rows.len());
    assert!(curve.iter().all(|value| (value.abs() - 0.1).abs() < 0.01));
}

/// A cell whose scale drifts, or differs by operator, is named by its covariate and its channel.
#[test]
fn a_scale_of_the_cell_that_changes_is_the_cells() {
    let end = session(11).iter().map(|row| row.time_s).fold(1.0, f64::max);
    for name in ["gain over time", "gain over operator"] {
        let mut rows = session(11);
        for row in &mut rows {
            let is_second = row.series.len() % 2 == 0 || row.series.ends_with(['1', '4', '5', '8']);
            row.labels.operator = if is_second { "B" } else { "A" }.to_owned();
            row.force_n *= match name {
                "gain over time" => 1.0 + 0.04 * row.time_s / end,
                _ if is_second => 1.04,
                _ => 1.0,
            };
        }
        assert_eq!(reported(&evidence(&rows)), [name]);
    }
}

/// One reading determines nothing.
/// Intervals, waves, levels and processes of a kernel share its probability, in a short and in a long table.
#[test]
fn forms_of_a_kernel_have_its_probability() {
    for rows in [&session(3)[..], &session(3)[..300]] {
        let evidence = Evidence::baseline(rows, 1).unwrap();
        for kernel in &evidence.problem().space().kernels {
            let total: f64 = kernel.variants.iter().sum();
            assert!((total - 1.0).abs() < 1e-9, "{}: {total}", kernel.name);
        }
    }
}

/// Another day, or another cast, with half loads that are 15 % lower and the same friction: of all layouts, or of one.
#[test]
fn a_half_load_that_differs_is_a_change_of_it() {
    let frame = Frame::new(&session(3));
    let one = frame.conditions.iter().position(|condition| condition.device == Some(1)).unwrap();
    for only_in in [None, Some(one)] {
        let form = Shape::Constant;
        let (covariate, channel) = (Covariate::Condition, Channel::HalfLoad);
        let softer = Term::Structure(Structure { covariate, channel, only_in, form });
        let later = session_with(5, &[(softer, &[-0.15])]);
        for (by, label) in [
            ("session", (|labels, name| labels.session = name) as fn(&mut Labels, String)),
            ("specimen", |labels, name| labels.specimen = name),
        ] {
            let mut rows = [session(3), later.clone()].concat();
            let count = rows.len() / 2;
            for (i, row) in rows.iter_mut().enumerate() {
                row.series = format!("{}-{}", i / count, row.series);
                label(&mut row.labels, format!("{}", i / count));
            }
            let calibration = crate::calibrate(&rows, &Vocabulary::built_in(), 1).unwrap();
            let report = &calibration.report;
            assert!(report.effects.is_empty(), "{by}: {:?}", report.effects);
            let [change] = report.changes.as_slice() else { panic!("{by}: {:?}", report.changes) };
            assert_eq!((change.constant.as_str(), change.by.as_str()), ("F_half", by));
            assert_eq!(change.layout, only_in.map(|one| frame.conditions[one].layout()));
            let ratio = change.factors["1"] / change.factors["0"];
            assert!((ratio - 0.85).abs() < 0.03, "{by}: {:?}", change.factors);
            // The term of the model file is the function of the kernel.
            let text = ModelFile::new(&calibration.augmented).to_text().unwrap();
            let file = ModelFile::parse(&text, "model.toml").unwrap();
            let (predicted_n, _) = file.predict(&rows, Session::Fitted, "model.toml").unwrap();
            let errors = predicted_n.iter().zip(&rows).map(|(y, row)| (y - row.force_n).powi(2));
            let rms = (errors.sum::<f64>() / rows.len() as f64).sqrt();
            assert!(rms < 0.06, "{by}: {rms} N with noise of 0.05 N");
            // The half load of each part is known, though what they have in common is not.
            let predicted = calibration.evidence.predict(&rows, Session::Fitted).unwrap();
            let largest = predicted.iter().map(|prediction| prediction.sd).fold(0.0, f64::max);
            assert!(largest < 0.1, "{by}: {largest} N");
            // The half loads of another session may differ again; the same specimens have the same ones.
            let error = report.expected_error_n.as_ref().unwrap();
            let is_wide = error.ci90[1] > 3.0 * error.ci90[0];
            assert_eq!(is_wide, by == "session", "{by}: {error:?}");
            if let Some(one) = only_in {
                let (text, _) = text.trim_end().rsplit_once('\n').unwrap();
                let elsewhere = text.replace(&format!("only_in = {one}"), "only_in = 5");
                let error = ModelFile::parse(&elsewhere, "model.toml").unwrap_err().to_string();
                assert!(error.contains("structure.only_in"), "{error}");
            }
        }
    }
}

#[test]
fn one_row_is_inconclusive() {
    let evidence = evidence(&session(9)[..1]);
    assert!(reported(&evidence).is_empty());
    assert!(!evidence.posterior().candidates.iter().any(|candidate| candidate.size.is_excluded()));
}

/// The offset of a long series is one offset, and no drift, drag or other effect.
#[test]
fn a_long_series_is_one() {
    for seed in [10, 11] {
        let mut rows = session(seed);
        for (i, row) in rows.iter_mut().enumerate() {
            row.series = (i / 180).to_string();
            row.repetition = 1 + u32::try_from(i % 180).unwrap();
            row.force_n += [0.05, -0.08, 0.03, 0.1, -0.04, 0.02][i / 180];
        }
        let evidence = evidence(&rows);
        assert_eq!(evidence.series_count(), 6);
        assert!(reported(&evidence).is_empty(), "{:?}", reported(&evidence));
    }
}

/// Series that are wrong among few are gross errors: they do not hide behind the scatter that they make, and are no structure.
#[test]
fn a_wrong_series_among_few_is_a_gross_error() {
    for (seed, series, change) in [(12, "4", 3.0), (13, "0", -1.0), (14, "11", 15.0)] {
        let mut rows = session(seed);
        rows.retain(|row| row.series.parse::<usize>().unwrap() < 12);
        let sound = evidence(&rows);
        assert!(sound.posterior().outliers.series.is_empty() && reported(&sound).is_empty());
        rows.iter_mut().filter(|row| row.series == series).for_each(|row| row.force_n += change);
        let evidence = evidence(&rows);
        assert!(reported(&evidence).is_empty(), "{:?}", reported(&evidence));
        let wrong: Vec<String> =
            evidence.posterior().outliers.series.iter().map(|wrong| wrong.series.to_string()).collect();
        assert!(!wrong.is_empty() && wrong.iter().all(|wrong| wrong == series), "{wrong:?}");
    }
}

/// Several wrong series among few hide each other: none of them gains alone.
#[test]
fn several_wrong_series_are_gross_errors() {
    for (seed, change, wrong) in [(20, 5.0, ["1", "6", "13"]), (21, -2.0, ["0", "4", "15"])] {
        let mut rows = session(seed);
        rows.retain(|row| row.series.parse::<usize>().unwrap() < 18);
        let of_wrong = rows.iter_mut().filter(|row| wrong.contains(&row.series.as_str()));
        of_wrong.for_each(|row| row.force_n += change);
        let evidence = evidence(&rows);
        assert!(reported(&evidence).is_empty(), "{:?}", reported(&evidence));
        let mut found: Vec<usize> = evidence.posterior().outliers.series.iter().map(|s| s.series).collect();
        found.dedup();
        assert_eq!(found, wrong.map(|series| series.parse::<usize>().unwrap()));
    }
}

/// A cell that shows one value in a series is off by another amount in each direction.
#[test]
fn a_series_with_one_value_is_a_gross_error() {
    for (seed, series, value) in [(15, "6", -5.0), (16, "2", 12.0)] {
        let mut rows = session(seed);
        rows.retain(|row| row.series.parse::<usize>().unwrap() < 18);
        rows.iter_mut().filter(|row| row.series == series).for_each(|row| row.force_n = value);
        let evidence = evidence(&rows);
        assert!(reported(&evidence).is_empty(), "{:?}", reported(&evidence));
        let wrong = &evidence.posterior().outliers.series;
        assert!(
            wrong.len() == 2 && wrong.iter().all(|wrong| wrong.series.to_string() == series),
            "{wrong:?}"
        );
        let expected = evidence.predict(&rows, Session::New).unwrap();
        for of in wrong {
            let is_of =
                |i: &usize| rows[*i].series == series && (rows[*i].direction.sign() > 0.0) == of.direction;
            let row = (0..rows.len()).find(is_of).unwrap();
            assert!((of.offset - (value - expected[row].mean)).abs() < 0.3, "{of:?}");
        }
    }
}

/// Structure over the position can have a value of its own at each position: a worn spot has edges.
#[test]
fn structure_over_the_position_is_as_fine_as_its_sampling() {
    let rows = session(17);
    let evidence = evidence(&rows);
    let problem = evidence.problem();
    let kernel = problem.space().kernels.iter().position(|k| k.name == "reading over position").unwrap();
    let positions: std::collections::BTreeMap<i64, usize> =
        rows.iter().enumerate().map(|(row, of)| ((100.0 * of.position_mm).round() as i64, row)).collect();
    let own = |basis: &pinswitch_inference::Basis| {
        let values = positions.values().flat_map(|row| basis.at(*row).to_vec()).collect::<Vec<f64>>();
        nalgebra::DMatrix::from_row_slice(positions.len(), basis.coefficients(), &values).rank(1e-6)
    };
    let ranks: Vec<usize> = problem.rows().bases[kernel].iter().map(own).collect();
    // Brownian motion starts at zero. After the levels there is one form for each position.
    assert_eq!((positions.len(), &ranks[1..3], &ranks[3..]), (9, &[8, 9][..], &[1; 9][..]));
}
