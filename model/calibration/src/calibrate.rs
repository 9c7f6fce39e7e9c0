//! Calibration of a table: search for effects, formula of unattributed structure, expected error of
//! a new session, and report.

use std::fmt;

use pinswitch_diagnostic::Diagnostic;

use crate::effects::Vocabulary;
use crate::forms::{DrawnForm, draw_form};
use crate::held_out::{HeldOut, held_out};
use crate::inference::{
    Levels, MOST_ROWS, Model, Noise, Observations, Selection, Term, UNATTRIBUTED, Weighed,
    averaged_intervals, fit, select,
};
use crate::own_values::check_finite_effects;
use crate::parallel::{both, map_each};
use crate::promise::{learn, parts, promise};
use crate::report::Report;
use crate::table::{Frame, PlateauRow};
use crate::telling::{ReportInputs, model_report, report};
use crate::trial::{TrialOutcome, trials};

/// Reason why a table cannot be calibrated; converts to a [`Diagnostic`].
#[derive(Clone, Debug, PartialEq, Eq)]
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
}

impl From<&CalibrationError> for Diagnostic {
    fn from(error: &CalibrationError) -> Self {
        match error {
            CalibrationError::TooFewRows { found, needed } => Self::new(format!(
                "{found} rows are too few to estimate the baseline and its noise; at least {needed} are needed"
            ))
            .with_help("record more loads or repetitions"),
            CalibrationError::NotFinite { id, values, row, conditions } => Self::new(format!(
                "effect '{id}' is not finite at its start value {values} (row {row}: {conditions})"
            ))
            .with_help("guard its formula with max or min, or narrow the bounds of its constants"),
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

/// A report with the fits behind it.
#[derive(Clone, Debug)]
pub struct Calibration {
    /// The report.
    pub report: Report,
    /// The selected model.
    pub selection: Selection,
    /// The rows as fitted.
    pub data: Observations,
    /// Formula of the unattributed structure, if there is any.
    pub form: Option<DrawnForm>,
}

/// Rows in excess of the baseline's constants that are needed to estimate the noise.
const ROWS_FOR_NOISE: usize = 8;

/// Calibrates a table, with the built-in effects.
///
/// ```
/// use pinswitch_calibration::inference::Levels;
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
/// let report = calibrate(&table.rows, Levels::default())?.report;
/// assert_eq!(report.verdict, Verdict::None, "the paper's model explains these readings");
/// let mu_s = &report.baseline.parameters["mu_s"];
/// assert!((mu_s.value - 0.24).abs() < 0.001 && mu_s.ci95[0] < 0.24 && 0.24 < mu_s.ci95[1]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`CalibrationError::TooFewRows`] if the rows do not determine the baseline.
pub fn calibrate(rows: &[PlateauRow], levels: Levels) -> Result<Calibration, CalibrationError> {
    calibrate_among(rows, &Vocabulary::built_in(), levels)
}

/// Calibrates a table, with the effects of a vocabulary. An effect that `calibrate` derived before
/// is attributed only if readings other than those it was derived from confirm it.
///
/// # Errors
/// [`CalibrationError`] if the rows do not determine the baseline, or if a user-defined effect is
/// not finite on them.
pub fn calibrate_among(
    rows: &[PlateauRow],
    vocabulary: &Vocabulary,
    levels: Levels,
) -> Result<Calibration, CalibrationError> {
    let found = with_own(rows, vocabulary, levels)?;
    let barred = only_drawn(&found, vocabulary);
    if barred.is_empty() {
        return Ok(found);
    }
    let confirmed = vocabulary.retaining(|own| !barred.contains(&own.definition().id));
    let mut again = with_own(rows, &confirmed, levels)?;
    let tried = std::mem::take(&mut again.report.trials);
    // In the order in which they were read; an effect that was removed from the vocabulary keeps
    // its trial.
    again.report.trials = found
        .report
        .trials
        .into_iter()
        .map(|trial| tried.iter().find(|other| other.id == trial.id).cloned().unwrap_or(trial))
        .collect();
    Ok(again)
}

/// Returns the ids of derived effects that are in the model without having been confirmed.
fn only_drawn(found: &Calibration, vocabulary: &Vocabulary) -> Vec<String> {
    let is_confirmed = |id: &str| {
        found.report.trials.iter().any(|trial| trial.id == id && trial.outcome == TrialOutcome::Confirmed)
    };
    let is_named = |id: &str| found.selection.effects.iter().any(|effect| effect.ids().contains(&id));
    let drawn = vocabulary.own().map(|own| own.definition()).filter(|own| !own.drawn_from.is_empty());
    drawn.filter(|own| is_named(&own.id) && !is_confirmed(&own.id)).map(|own| own.id.clone()).collect()
}

/// Factor by which the held-out error may increase if a user-defined effect is in the model.
const WORSE_WITH_OWN: f64 = 1.25;

/// Searches with and without the user-defined effects. If none of them is in the model, or the
/// held-out error is clearly larger with them, the result of the built-in effects and shapes is
/// reported, with trials, limits and rivals of all effects, so that it does not depend on the
/// user-defined ones.
fn with_own(
    rows: &[PlateauRow],
    vocabulary: &Vocabulary,
    levels: Levels,
) -> Result<Calibration, CalibrationError> {
    let found = calibrated(rows, [vocabulary, vocabulary], levels)?;
    if vocabulary.own().next().is_none() {
        return Ok(found);
    }
    let without = calibrated(rows, [&Vocabulary::built_in(), vocabulary], levels)?;
    let is_own = |id: &str| vocabulary.own().any(|own| own.definition().id == id);
    let names_own = found.selection.effects.iter().any(|effect| is_own(effect.effect.id()));
    let error_n = |c: &Calibration| c.report.augmented.heldout_rmse_n;
    Ok(if names_own && error_n(&found) <= WORSE_WITH_OWN * error_n(&without) { found } else { without })
}

/// Searches in one vocabulary, and reports for another one that contains it.
fn calibrated(
    rows: &[PlateauRow],
    [searched, told]: [&Vocabulary; 2],
    levels: Levels,
) -> Result<Calibration, CalibrationError> {
    let frame = Frame::new(rows);
    let start = Model::baseline(frame.clone()).among(searched);
    let needed = start.values().len() + ROWS_FOR_NOISE;
    let too_few = CalibrationError::TooFewRows { found: rows.len(), needed };
    let mut whole = Observations::new(&frame, rows).ok_or_else(|| too_few.clone())?;
    if rows.len() < needed {
        return Err(too_few);
    }
    check_finite_effects(&start.clone().among(told), &whole, rows)?;
    let mut data = if whole.points.len() > MOST_ROWS {
        let rough = fit(&start, &Weighed::new(&whole, Noise::constant(0.1, 0.03)));
        let sd = whole.weigh_outliers(&rough.residual_n);
        let rough = fit(&rough.model, &Weighed::new(&whole, Noise::constant(sd, sd)));
        whole.friction_n = rough.model.friction_n(&whole.points);
        whole.compacted()
    } else {
        whole.clone()
    };
    let as_it_came = data.clone();
    let learned_of = |part| learn(part, &start, &as_it_came, levels);
    let search = || {
        let selection = select(&start, &mut data, levels).told_among(told, &data, levels);
        let held = held_out(&selection.augmented.model, &Weighed::new(&data, selection.noise));
        let form = drawn(rows, &selection, &data, held);
        (selection, held, form)
    };
    let ((mut selection, mut held, mut form), mut learned) = both(search, || map_each(parts(), learned_of));
    if data.excluded_series() > 0 {
        // The folds are refitted without the excluded series.
        learned = map_each(parts(), |part| learn(part, &start, &data, levels));
    }
    let with_form = form.as_ref().is_some_and(|f| f.report.in_model);
    let promised = promise(learned, &selection, &data, with_form);
    // Terms are dropped that do not reduce the error on series that were used neither to find nor
    // to fit them.
    let is_worse = || {
        let of_baseline = held_out(&selection.baseline.model, &Weighed::new(&data, selection.noise));
        promised.is_some_and(|p| p.augmented_n > p.baseline_n) || held.both_n() > of_baseline.both_n()
    };
    if !selection.augmented.model.terms.is_empty() && is_worse() {
        selection = selection.without_findings(&data, levels);
        held = held_out(&selection.augmented.model, &Weighed::new(&data, selection.noise));
        form = None;
    }
    if let Some(named) = with_confirmed(rows, &selection, &data, held, levels) {
        held = held_out(&named.augmented.model, &Weighed::new(&data, named.noise));
        (selection, form) = (named, None);
    }
    if data.points.len() == whole.points.len() {
        whole = data.clone();
    }
    let outliers = (0..whole.points.len()).filter(|i| !whole.is_sound(*i)).count();
    let mut report = report(rows, &selection, &data, ReportInputs { levels, promised, outliers, held });
    if let Some(form) = &form {
        tell_form(form, &mut report, &mut selection, &data);
    }
    // Reports per row include all rows.
    for fitted in [&mut selection.baseline, &mut selection.augmented] {
        let predicted = fitted.model.predict(&whole.points);
        fitted.residual_n = whole.force_n.iter().zip(predicted).map(|(y, p)| y - p).collect();
    }
    let data = whole;
    Ok(Calibration { report, selection, data, form })
}

/// Smallest share of the unattributed structure that a confirmed effect of the same covariate must
/// explain to replace it, and the factor by which its held-out error may be larger, since shapes
/// are more flexible than one formula.
const STANDS_FOR: (f64, f64) = (0.85, 1.05);

/// Returns the selection with a user-defined effect in place of the structure along its covariate,
/// if the table confirms the effect and it explains that structure.
fn with_confirmed(
    rows: &[PlateauRow],
    selection: &Selection,
    data: &Observations,
    shapes: HeldOut,
    levels: Levels,
) -> Option<Selection> {
    let covariate = selection.structure?.covariate;
    let weighed = Weighed::new(data, selection.noise);
    let all = &selection.augmented.model;
    let bare = all.without_terms(|term| matches!(term, Term::Structure(_)));
    let without = fit(&bare, &weighed);
    let confirmed = trials(rows, selection, data);
    let confirmed = confirmed.iter().filter(|trial| trial.outcome == TrialOutcome::Confirmed);
    let tried = confirmed.filter_map(|trial| {
        let own = all.vocabulary.own().find(|own| own.definition().id == trial.id)?.definition();
        let effect = all.vocabulary.named(&own.id)?;
        let is_named = selection.effects.iter().any(|found| found.effect.id() == own.id);
        let claimed: Vec<f64> = own.parameters.iter().map(|p| p.start).collect();
        (own.covariate == covariate && !is_named)
            .then(|| fit(&bare.with_term(Term::Named(effect), &claimed), &weighed))
    });
    let best = tried.min_by(|a, b| a.cost.total_cmp(&b.cost))?;
    let explained = (without.cost - best.cost) / (without.cost - selection.augmented.cost);
    let held = held_out(&best.model, &weighed);
    let stands = explained >= STANDS_FOR.0 && held.both_n() <= STANDS_FOR.1 * shapes.both_n();
    stands.then(|| selection.clone().with_names(best, data, levels))
}

/// Share of the structure above which a form explains all of it, and the factor by which its
/// held-out error may then exceed that of the shapes, since one formula generalises better to
/// another session than several shapes.
const IS_ALL_OF_IT: (f64, f64) = (0.95, 1.1);

/// Returns the form of the unattributed structure. It is used in the model if its held-out error
/// does not exceed that of the shapes, or hardly exceeds it while the form explains all of the
/// structure.
fn drawn(
    rows: &[PlateauRow],
    selection: &Selection,
    data: &Observations,
    shapes: HeldOut,
) -> Option<DrawnForm> {
    let mut form = draw_form(rows, selection, data)?;
    let least = if form.report.explains >= IS_ALL_OF_IT.0 { IS_ALL_OF_IT.1 } else { 1.0 };
    form.report.in_model = form.report.heldout_rmse_n <= least * shapes.both_n();
    Some(form)
}

/// Adds a form to the report of the structure from which it was derived, and to the model if it is
/// used there.
fn tell_form(form: &DrawnForm, report: &mut Report, selection: &mut Selection, data: &Observations) {
    let in_model = form.report.in_model;
    if in_model {
        let weighed = Weighed::new(data, selection.noise);
        selection.augmented = fit(&form.fitted.model, &weighed);
        let held = held_out(&selection.augmented.model, &weighed);
        report.augmented = model_report(&selection.augmented, &weighed, held, averaged_intervals);
    }
    let after_n = report.augmented.heldout_rmse_n;
    for effect in report.effects.iter_mut().filter(|_| in_model) {
        effect.error_after_n = after_n;
    }
    if let Some(unnamed) = report.effects.iter_mut().find(|effect| effect.id == UNATTRIBUTED) {
        unnamed.form = Some(form.report.clone());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::CATALOGUE;
    use crate::report::{Fate, Verdict};
    use crate::test_session::{session, session_with};

    fn fates(levels: Levels) -> Vec<Fate> {
        let report = calibrate(&session(3), levels).unwrap().report;
        assert_eq!(report.candidates.len(), CATALOGUE.len());
        report.candidates.iter().map(|c| c.fate).collect()
    }

    /// The caller's level for chance applies to the search and to the report.
    #[test]
    fn outcomes_follow_the_given_levels() {
        let usual = fates(Levels::default());
        assert!(usual.contains(&Fate::Chance) && usual.contains(&Fate::Invisible), "{usual:?}");
        assert!(!usual.contains(&Fate::Superfluous), "{usual:?}");
        // Without sign flips the search selects nothing; the level alone then decides what chance
        // explains.
        let credulous = fates(Levels { first_p: 1.0, flips: 0.0, ..Levels::default() });
        assert!(!credulous.contains(&Fate::Chance), "{credulous:?}");
    }

    fn offset() -> Term {
        Term::Named(crate::effects::effect_named("load_cell_offset").unwrap())
    }

    /// Returns a session of that name with an offset of the load cell.
    fn day(name: &str, seed: u64, offset_n: f64) -> Vec<PlateauRow> {
        let mut rows = session_with(seed, &[(offset(), &[offset_n])]);
        rows.iter_mut().for_each(|r| r.labels.session = name.to_owned());
        rows
    }

    #[test]
    fn opposite_sizes_are_not_scatter() {
        let told = |second_n| {
            let rows = [day("a", 1, 0.6), day("b", 2, second_n)].concat();
            calibrate(&rows, Levels::default()).unwrap().report
        };
        for second_n in [-0.6, 0.0] {
            let report = told(second_n);
            let [unequal] = report.unequal.as_slice() else { panic!("{second_n}: {:?}", report.unequal) };
            let sizes: Vec<f64> = unequal.sizes.iter().map(|s| s.size.value).collect();
            assert_eq!(unequal.id, "load_cell_offset");
            assert!((sizes[0] - 0.6).abs() < 0.1 && (sizes[1] - second_n).abs() < 0.1, "{sizes:?}");
            assert!(report.verdict != Verdict::None, "{second_n}");
            let is_named = report.effects.iter().any(|e| e.id == "load_cell_offset");
            assert!(is_named || !report.adequate, "{second_n}: the residual is not noise");
        }
        let same = told(0.6);
        assert!(same.unequal.is_empty() && same.verdict == Verdict::Attributed, "{:?}", same.unequal);
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
        let report = |rows: &[PlateauRow], vocabulary| {
            calibrate_among(rows, &vocabulary, Levels::default()).unwrap().report
        };
        let first = rows_with(4, 0.5);
        let named = |report: &Report| report.effects.iter().any(|e| e.id == "mine");
        assert!(named(&report(&first, plain.clone())), "a hypothesis is found");
        let told: Vec<String> = crate::table::readings_by_session(&first).into_values().collect();
        let drawn = || vocabulary(file(0.5, &format!("drawn_from = [\"{}\"]\n", told[0])));
        // The readings that it was derived from, and parts of them.
        for rows in [&first[..], &first[20..], &first[..first.len() / 2]] {
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
        let drift = Term::Named(crate::effects::effect_named("thermal_drift").unwrap());
        let rows = session_with(7, &[(drift, &[0.8])]);
        let size = |begins_s: f64| {
            let mut rows = rows.clone();
            rows.iter_mut().for_each(|r| r.time_s += begins_s);
            let report = calibrate(&rows, Levels::default()).unwrap().report;
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
        let error = calibrate(&rows[..5], Levels::default()).unwrap_err();
        assert_eq!(error, CalibrationError::TooFewRows { found: 5, needed: 2 + ROWS_FOR_NOISE });
    }
}
