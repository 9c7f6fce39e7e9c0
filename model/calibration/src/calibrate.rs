//! Calibration of a table: posterior over effects, formula of unattributed structure, and report.

use std::fmt;

use pinswitch_diagnostic::{Diagnostic, codes};

use crate::confirmation::{trial_of_unseen, trials};
use crate::discovery::{DrawnForm, draw_form};
use crate::effects::{UNATTRIBUTED, Vocabulary};
use crate::evidence::{Evidence, Fitted};
use crate::model::Model;
use crate::own_values::check_finite_effects;
use crate::report::{Report, TrialOutcome};
use crate::reporting::{Findings, report};
use crate::table::{Frame, PlateauRow, with_complete_columns};

/// Reason why a table cannot be calibrated; converts to a [`Diagnostic`].
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum CalibrationError {
    /// Too few rows to estimate the baseline and its noise.
    TooFewRows {
        /// Number of rows.
        found: usize,
        /// Number that is needed.
        needed: usize,
    },
    /// A user-defined effect is not finite at a start value of its fit.
    NotFinite {
        /// Id of the effect.
        id: String,
        /// Start values, as `k = 1, h = 2`.
        values: String,
        /// Row of the table, from 1.
        row: usize,
        /// Load, speed, dwell, repetition and time of the row.
        conditions: String,
    },
    /// The friction model is not finite on the table.
    Unfit(Diagnostic),
}

impl From<&CalibrationError> for Diagnostic {
    fn from(error: &CalibrationError) -> Self {
        match error {
            CalibrationError::TooFewRows { found, needed } => Self::new(codes::TOO_FEW_ROWS, format!(
                "{found} rows are too few to estimate the baseline and its noise; at least {needed} are needed"
            ))
            .with_help("record more loads or repetitions"),
            CalibrationError::NotFinite { id, values, row, conditions } => Self::new(codes::FORMULA_NOT_FINITE, format!(
                "effect '{id}' is not finite at its start value {values} (row {row}: {conditions})"
            ))
            .with_help("guard its formula with max or min, or narrow the bounds of its constants"),
            CalibrationError::Unfit(error) => error.clone(),
        }
    }
}

impl From<CalibrationError> for Diagnostic {
    fn from(error: CalibrationError) -> Self {
        Self::from(&error)
    }
}

impl fmt::Display for CalibrationError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        Diagnostic::from(self).fmt(f)
    }
}

impl std::error::Error for CalibrationError {}

/// A report with the posterior and the models behind it.
#[derive(Debug)]
pub struct Calibration {
    /// The report.
    pub report: Report,
    /// The posterior over hypotheses.
    pub evidence: Evidence,
    /// The refitted model of the paper.
    pub baseline: Fitted,
    /// The best hypothesis.
    pub augmented: Fitted,
    /// Formula of the unattributed structure, if there is any.
    pub form: Option<DrawnForm>,
}

/// Rows in excess of the baseline's constants that are needed to estimate the noise.
const ROWS_FOR_NOISE: usize = 8;

/// Calibrates a table with the effects of a vocabulary. An effect that `calibrate` derived before is
/// attributed only if readings other than those it was derived from confirm it. `seed` is that of the
/// interval of the expected error.
///
/// ```
/// use pinswitch_calibration::effects::Vocabulary;
/// use pinswitch_calibration::table::PlateauTable;
/// use pinswitch_calibration::{Verdict, calibrate};
///
/// // `csv` is the text of a plateau table: here silicone without pins at twelve loads, and a little noise.
/// # let mut csv = "series,substrate,pins,sweep,load_mass_g,load_N,speed_pct,dwell_s,direction,repetition,position_mm,time_s,force_N\n".to_owned();
/// # let mut time_s = 0.0;
/// # for (series, load_n) in (0..12).map(|i| (i, 3.0 + 4.0 * f64::from(i))) {
/// #     for (direction, sign) in [("eccentric", -1.0), ("concentric", 1.0)] {
/// #         for repetition in 1..=6 {
/// #             time_s += 3.5;
/// #             let noise = 0.05 * (43758.5453 * (12.9898f64 * time_s).sin()).fract();
/// #             let force_n = load_n * (sign * 0.24 * 1.115_f64).exp() + noise;
/// #             csv += &format!("{series},silicone,,up,0,{load_n},50,3,{direction},{repetition},{},{time_s},{force_n}\n", 10 * repetition);
/// #         }
/// #     }
/// # }
/// let table = PlateauTable::read(csv.as_bytes(), "plateaus.csv")?;
/// let report = calibrate(&table.rows, &Vocabulary::built_in(), 1)?.report;
/// assert!(report.effects.is_empty(), "the paper's model explains these readings");
/// let mu_s = &report.baseline.parameters["mu_s"];
/// assert!((mu_s.value - 0.24).abs() < 0.002 && mu_s.ci95[0] < 0.24 && 0.24 < mu_s.ci95[1]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`CalibrationError`] if the rows do not determine the baseline, or if a user-defined effect is
/// not finite on them.
pub fn calibrate(
    rows: &[PlateauRow],
    vocabulary: &Vocabulary,
    seed: u64,
) -> Result<Calibration, CalibrationError> {
    let (rows, lacking) = with_complete_columns(rows);
    let rows = rows.as_slice();
    let baseline = Model::baseline(Frame::new(rows)).among(vocabulary);
    let needed = baseline.values().len() + ROWS_FOR_NOISE;
    if rows.len() < needed {
        return Err(CalibrationError::TooFewRows { found: rows.len(), needed });
    }
    check_finite_effects(&baseline, rows)?;
    let unfit = CalibrationError::Unfit;
    // Effects that were derived from these readings are tested on the others only.
    let unseen: Vec<_> = vocabulary
        .own()
        .filter_map(|own| trial_of_unseen(own.definition(), rows, vocabulary, seed))
        .collect();
    let is_barred =
        |id: &str| unseen.iter().any(|trial| trial.id == id && trial.outcome != TrialOutcome::Confirmed);
    let mut searched = vocabulary.retaining(|own| !is_barred(&own.definition().id));
    let mut evidence = Evidence::new(rows, &searched, seed).map_err(unfit)?;
    let trials = trials(vocabulary, &evidence, unseen);
    // A derived effect is part of the model only if these readings confirm it.
    let is_refuted = |id: &str| {
        let of = trials.iter().find(|trial| trial.id == id && trial.was_drawn);
        of.is_some_and(|trial| trial.outcome != TrialOutcome::Confirmed)
    };
    let is_in_model = |name: &str| {
        let posterior = evidence.posterior();
        let best = posterior.window.iter().take(1).flat_map(|fit| fit.hypothesis.members());
        best.chain(posterior.reported.iter().map(|reported| reported.member))
            .any(|m| evidence.name(m) == name)
    };
    let refuted: Vec<String> = searched
        .own()
        .map(|own| own.definition().id.clone())
        .filter(|id| is_refuted(id) && is_in_model(id))
        .collect();
    if !refuted.is_empty() {
        searched = searched.retaining(|own| !refuted.contains(&own.definition().id));
        evidence = Evidence::new(rows, &searched, seed).map_err(unfit)?;
    }
    let not_finite = || {
        CalibrationError::Unfit(
            Diagnostic::new(codes::MODEL_NOT_FINITE, "the friction model is not finite on this table")
                .with_help("check loads and readings for values that a rig cannot have"),
        )
    };
    let posterior = evidence.posterior();
    let baseline = evidence.fitted(&posterior.baseline).ok_or_else(not_finite)?;
    let best = posterior.window.first().ok_or_else(not_finite)?;
    let form = draw_form(rows, &evidence, &searched, seed);
    let in_model = form.as_ref().filter(|form| form.report.in_model);
    let augmented = match in_model {
        Some(form) => form.fitted.clone(),
        None => evidence.fitted(best).ok_or_else(not_finite)?,
    };
    let findings = Findings {
        rows,
        vocabulary: &searched,
        lacking: &lacking,
        evidence: &evidence,
        baseline: &baseline,
        augmented: &augmented,
        form: in_model.map(|form| &form.model_report),
        trials,
    };
    let mut report = report(findings).ok_or_else(not_finite)?;
    let unnamed = report.effects.iter_mut().find(|effect| effect.id == UNATTRIBUTED);
    if let Some((unnamed, form)) = unnamed.zip(form.as_ref()) {
        unnamed.form = Some(form.report.clone());
    }
    Ok(Calibration { report, evidence, baseline, augmented, form })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Term;
    use crate::report::Verdict;
    use crate::test_session::{session, session_with};

    fn calibrated(rows: &[PlateauRow]) -> Report {
        calibrate(rows, &Vocabulary::built_in(), 1).unwrap().report
    }

    fn offset() -> Term {
        Term::named(crate::effects::effect_named("load_cell_offset").unwrap())
    }

    /// Returns a session of that name with an offset of the load cell.
    fn day(name: &str, seed: u64, offset_n: f64) -> Vec<PlateauRow> {
        let mut rows = session_with(seed, &[(offset(), &[offset_n])]);
        rows.iter_mut().for_each(|r| r.labels.session = name.to_owned());
        rows
    }

    /// An offset that one of two sessions has is not an offset of both.
    #[test]
    fn sessions_with_different_offsets_are_not_noise() {
        let report = calibrated(&[day("a", 1, 0.6), day("b", 2, -0.6)].concat());
        assert_eq!(report.verdict, Verdict::Unattributed, "{:?}", report.effects);
        assert!(["session", "time"].contains(&report.effects[0].covariate.as_str()), "{:?}", report.effects);
        let same = calibrated(&[day("a", 1, 0.6), day("b", 2, 0.6)].concat());
        assert_eq!(same.verdict, Verdict::Attributed);
    }

    /// The curve of a part has the friction of the latest session.
    #[test]
    fn curves_have_the_latest_friction() {
        let day = |name: &str, seed, factor: f64| {
            let mut rows = session(seed);
            rows.retain(|row| row.pins.is_empty());
            for row in &mut rows {
                let exponent = row.direction.sign() * 0.24 * factor * row.wrap_angle_deg.to_radians();
                // The digits of a large sine have no order.
                let noise_n = 0.02 * (43758.5453 * libm::sin(12.9898 * row.time_s + factor)).fract();
                row.force_n = row.load_n * libm::exp(exponent) + noise_n;
                row.labels.session = name.to_owned();
            }
            rows
        };
        let rows = [day("a", 1, 1.25), day("b", 2, 1.0)].concat();
        let found = calibrate(&rows, &Vocabulary::built_in(), 1).unwrap();
        assert_eq!(found.report.changes.len(), 1, "{:?}", found.report.effects);
        let file = crate::ModelFile::new(&found.augmented);
        let silicone = pinswitch_friction::Substrate::Silicone;
        let curve = file.part_curve(silicone, &[], &[20.0], "model.toml").unwrap();
        let wrap = rows[0].wrap_angle_deg.to_radians();
        let expected = 20.0 * libm::sinh(0.24 * wrap);
        assert!((curve.friction_n[0] / expected - 1.0).abs() < 0.01, "{} {expected}", curve.friction_n[0]);
        assert_eq!(file.sides(), (Vec::new(), Vec::new()));
        // Nothing of the table was on pins, and nothing was on the rigid proxy.
        let refused = file.part_curve(silicone, &[5, 8, 11], &[20.0], "model.toml").unwrap_err();
        assert_eq!(refused.code(), pinswitch_diagnostic::codes::MODEL_BEYOND_RIG);
        assert!(refused.problem().contains("on pins"), "{refused}");
    }

    #[test]
    fn derived_effects_need_confirmation() {
        let rows = session_with(3, &[(offset(), &[0.5])]);
        let file = |start: f64, drawn_from: &str| {
            format!(
                "schema = \"pinswitch.effects/1\"\n[[effect]]\nid = \"mine\"\nside = \"rig\"\ncovariate = \"position\"\n\
                 acts_on = \"reading\"\ncombine = \"add\"\nformula = \"a*exp(-((stroke - 0.5)/0.1)^2)\"\n{drawn_from}\
                 parameters.a = {{ size = true, start = {start}, unit = \"N\" }}\n"
            )
        };
        let vocabulary = |text: String| Vocabulary::built_in().read(&text, "mine.toml").unwrap();
        let plain = vocabulary(file(0.5, ""));
        let bump = Term::Named(plain.named("mine").unwrap());
        let rows_with = |seed, size: f64| session_with(seed, &[(bump.clone(), &[size])]);
        let report = |rows: &[PlateauRow], vocabulary| calibrate(rows, &vocabulary, 1).unwrap().report;
        let first = rows_with(4, 0.5);
        let named = |report: &Report| report.effects.iter().any(|e| e.id == "mine");
        assert!(named(&report(&first, plain.clone())), "a hypothesis is found");
        let told: Vec<String> = crate::table::readings_by_session(&first).into_values().collect();
        let drawn = || vocabulary(file(0.5, &format!("drawn_from = [\"{}\"]\n", told[0])));
        // The readings that it was derived from, parts of them, and near copies.
        let near = |nth: usize, by_n: f64| -> Vec<PlateauRow> {
            let mut rows: Vec<PlateauRow> = first.iter().step_by(nth).cloned().collect();
            rows.iter_mut().step_by(2).for_each(|row| row.force_n += by_n);
            rows
        };
        let parts = [first[20..].to_vec(), first[..first.len() / 2].to_vec(), near(1, 0.01), near(2, -0.02)];
        for rows in std::iter::once(&first).chain(&parts) {
            let report = report(rows, drawn());
            assert!(
                !named(&report) && report.trials[0].outcome == TrialOutcome::Drawn,
                "{:?}",
                report.trials
            );
        }
        // Other readings confirm it, or refute it where it is absent or has the opposite sign.
        let again = report(&rows_with(5, 0.5), drawn());
        assert!(named(&again) && again.trials[0].outcome == TrialOutcome::Confirmed, "{:?}", again.trials);
        for other in [rows, rows_with(6, -0.5)] {
            let report = report(&other, drawn());
            assert!(
                !named(&report) && report.trials[0].outcome == TrialOutcome::Refuted,
                "{:?}",
                report.trials
            );
        }
    }

    /// Start of the clock: time of day, and seconds since 1970.
    #[test]
    fn the_clock_start_is_irrelevant() {
        let drift = Term::named(crate::effects::effect_named("thermal_drift").unwrap());
        let rows = session_with(7, &[(drift, &[0.8])]);
        let size = |begins_s: f64| {
            let mut rows = rows.clone();
            rows.iter_mut().for_each(|r| r.time_s += begins_s);
            let report = calibrated(&rows);
            let [effect] = report.effects.as_slice() else { panic!("{begins_s}: {:?}", report.verdict) };
            assert_eq!(effect.id, "thermal_drift", "{begins_s}");
            effect.parameters["k"].value
        };
        let plain = size(0.0);
        for begins_s in [32_400.0, -40_000.0, 1.7e9] {
            assert!((size(begins_s) / plain - 1.0).abs() < 0.02, "{begins_s}: {} {plain}", size(begins_s));
        }
    }

    #[test]
    fn too_few_rows_are_refused() {
        let rows = session(1);
        let error = calibrate(&rows[..5], &Vocabulary::built_in(), 1).unwrap_err();
        assert_eq!(error, CalibrationError::TooFewRows { found: 5, needed: 2 + ROWS_FOR_NOISE });
    }
}
