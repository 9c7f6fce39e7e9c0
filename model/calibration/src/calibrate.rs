//! From a selection to its report: verdict, effects, rivals, blind spots, errors before and after.

use pinswitch_friction::Substrate;

use crate::aliasing::aliasing;
use crate::effects::Vocabulary;
use crate::forms::{DrawnForm, draw_form};
use crate::held_out::held_out;
use crate::inference::{
    CandidateEffect, Fit, FoundEffect, Levels, MOST_ROWS, Model, Noise, Observations, Rival, Selection, Term,
    UNATTRIBUTED, Weighed, cell_deviation, degrees_of_freedom, family_p_value, fit, interval_half_widths,
    select,
};
use crate::layouts_left_out::layouts_left_out;
use crate::own_values::has_values;
use crate::promise::{Promise, promise};
use crate::report::{
    BadSeries, CandidateReport, DataSummary, EffectReport, Estimate, Fate, Invisible, LimitReport,
    ModelReport, NoisePart, Report, RivalReport, Verdict,
};
use crate::table::{Frame, PlateauRow};
use crate::trial::trials;

/// Why rows cannot be calibrated.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum CalibrationError {
    /// Too few rows for the baseline's constants and the noise beside them.
    #[error(
        "{found} rows cannot fix the baseline's constants and tell the noise beside them, {needed} can; \
         record more loads or repetitions"
    )]
    TooFewRows {
        /// Rows given.
        found: usize,
        /// Rows that could.
        needed: usize,
    },
    /// An effect of one's own has no value on the table.
    #[error(
        "effect '{id}' has no number at its start values in row {row} ({told}); guard its formula with max or min"
    )]
    NoValue {
        /// Its id.
        id: String,
        /// Row of the table, from 1.
        row: usize,
        /// Where that row lies.
        told: String,
    },
}

/// A report with the fits behind it.
#[derive(Clone, Debug)]
pub struct Calibration {
    /// The report.
    pub report: Report,
    /// The selection behind it.
    pub selection: Selection,
    /// The rows as they were fitted.
    pub data: Observations,
    /// The form of the structure that no effect explains, if there is any.
    pub form: Option<DrawnForm>,
}

/// Rows beyond the baseline's constants without which any misfit would be many times a noise that nobody knows.
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
/// [`CalibrationError::TooFewRows`] if the rows cannot fix the baseline.
pub fn calibrate(rows: &[PlateauRow], levels: Levels) -> Result<Calibration, CalibrationError> {
    calibrate_among(rows, &Vocabulary::built_in(), levels)
}

/// Calibrates a table, with the effects of a vocabulary.
///
/// # Errors
/// [`CalibrationError`] if the rows cannot fix the baseline, or if an effect of one's own has no value on them.
pub fn calibrate_among(
    rows: &[PlateauRow],
    vocabulary: &Vocabulary,
    levels: Levels,
) -> Result<Calibration, CalibrationError> {
    let frame = Frame::new(rows);
    let start = Model::baseline(frame.clone()).among(vocabulary);
    let needed = start.values().len() + ROWS_FOR_NOISE;
    let too_few = CalibrationError::TooFewRows { found: rows.len(), needed };
    let mut whole = Observations::new(&frame, rows).ok_or_else(|| too_few.clone())?;
    if rows.len() < needed {
        return Err(too_few);
    }
    has_values(&start, &whole, rows)?;
    let mut data = if whole.points.len() > MOST_ROWS {
        let rough = fit(&start, &Weighed::new(&whole, Noise::constant(0.1, 0.03)));
        let sd = whole.weigh_outliers(&rough.residual_n);
        let rough = fit(&rough.model, &Weighed::new(&whole, Noise::constant(sd, sd)));
        whole.friction_n = rough.model.friction_n(&whole.points);
        whole.compacted()
    } else {
        whole.clone()
    };
    let mut selection = select(&start, &mut data, levels);
    let mut form = drawn(&selection, &data);
    let promised = promise(&selection, &data, levels, form.as_ref().is_some_and(|f| f.report.in_model));
    // What does not help on series that had no part in finding it is not kept.
    if promised.is_some_and(|p| p.augmented_n > p.baseline_n) && !selection.augmented.model.terms.is_empty() {
        selection = selection.without_findings(&data, levels);
        form = None;
    }
    if data.points.len() == whole.points.len() {
        whole = data.clone();
    }
    let outliers = (0..whole.points.len()).filter(|i| !whole.is_sound(*i)).count();
    let mut report = report(rows, &selection, &data, levels, promised, outliers);
    if let Some(form) = &form {
        tell_form(form, &mut report, &mut selection, &data);
    }
    // What is told row by row is told of every row.
    for fitted in [&mut selection.baseline, &mut selection.augmented] {
        let predicted = fitted.model.predict(&whole.points);
        fitted.residual_n = whole.force_n.iter().zip(predicted).map(|(y, p)| y - p).collect();
    }
    let data = whole;
    Ok(Calibration { report, selection, data, form })
}

/// The form of what has no name. It goes into the model if it predicts held-out data no worse than the shapes do.
fn drawn(selection: &Selection, data: &Observations) -> Option<DrawnForm> {
    let mut form = draw_form(selection, data)?;
    let weighed = Weighed::new(data, selection.noise);
    let shapes_n = held_out(&selection.augmented.model, &weighed).both_n();
    form.report.in_model = form.report.heldout_rmse_n <= shapes_n;
    Some(form)
}

/// Tells a form beside the structure that it was drawn from, and puts it into the model if it belongs there.
fn tell_form(form: &DrawnForm, report: &mut Report, selection: &mut Selection, data: &Observations) {
    let in_model = form.report.in_model;
    if in_model {
        let weighed = Weighed::new(data, selection.noise);
        selection.augmented = fit(&form.fitted.model, &weighed);
        report.augmented = model_report(&selection.augmented, &weighed).0;
    }
    let after_n = report.augmented.heldout_rmse_n;
    for effect in report.effects.iter_mut().filter(|_| in_model) {
        effect.error_after_n = after_n;
    }
    if let Some(unnamed) = report.effects.iter_mut().find(|effect| effect.id == UNATTRIBUTED) {
        unnamed.form = Some(form.report.clone());
    }
}

/// A constant with its interval, which ends at the bounds of a shape.
fn estimate(value: f64, half_width: f64, unit: &str, (least, most): (f64, f64)) -> Estimate {
    let ci95 = [(value - half_width).max(least), (value + half_width).min(most)];
    Estimate { value, ci95, unit: unit.to_owned() }
}

fn model_report(fitted: &Fit, weighed: &Weighed<'_>) -> (ModelReport, f64) {
    let held = held_out(&fitted.model, weighed);
    let data = weighed.data;
    let sound = (0..data.points.len()).filter(|i| data.is_sound(*i));
    let rmse_n = data.root_mean_square_n(sound.map(|i| (i, fitted.residual_n[i])));
    let widths = interval_half_widths(fitted, weighed);
    let conditions = &fitted.model.frame.conditions;
    let touched = |name: &str| match name {
        "mu_p" => conditions.iter().any(crate::table::Condition::has_pins),
        "mu_s" => conditions.iter().any(|c| c.substrate == Some(Substrate::Silicone)),
        _ => true,
    };
    let parameters = fitted
        .model
        .names()
        .into_iter()
        .zip(fitted.model.values().into_iter().zip(widths))
        .enumerate()
        .filter(|(_, ((name, _), _))| touched(name))
        .map(|(i, ((name, unit), (value, width)))| {
            (name, estimate(value, width, unit, fitted.model.bounds_of(i)))
        })
        .collect();
    let report = ModelReport {
        rmse_n: if rmse_n.is_nan() { 0.0 } else { rmse_n },
        heldout_rmse_n: held.both_n(),
        heldout_series_rmse_n: held.series_n,
        heldout_loads_rmse_n: held.loads_n,
        heldout_layouts_rmse_n: layouts_left_out(&fitted.model, weighed),
        parameters,
    };
    (report, held.both_n())
}

fn report(
    rows: &[PlateauRow],
    selection: &Selection,
    data: &Observations,
    levels: Levels,
    promised: Option<Promise>,
    outliers: usize,
) -> Report {
    let noise = selection.noise;
    let weighed = &Weighed::new(data, noise);
    let (baseline, before_n) = model_report(&selection.baseline, weighed);
    let (augmented, after_n) = if selection.augmented.model.terms.is_empty() {
        (baseline.clone(), before_n)
    } else {
        model_report(&selection.augmented, weighed)
    };
    let effects = effects(selection, weighed, after_n, &augmented);
    let promise_n = promised.map(|p| if effects.is_empty() { p.baseline_n } else { p.augmented_n });
    Report {
        schema: "pinswitch.calibration/1".to_owned(),
        data: DataSummary {
            rows: rows.len(),
            series: data.series,
            conditions: selection.baseline.model.frame.conditions.len(),
            outliers,
        },
        verdict: Verdict::of(selection),
        noise_floor_n: noise.floor_n(data),
        noise,
        noise_parts: noise_parts(selection, data),
        adequate: is_adequate(augmented.heldout_series_rmse_n, noise.floor_n(data), data),
        promise_n,
        promise_baseline_n: promised.map(|p| p.baseline_n),
        limits: limits(selection),
        classes: selection
            .classes
            .iter()
            .map(|class| class.iter().map(|id| (*id).to_owned()).collect())
            .collect(),
        aliasing: aliasing(rows),
        ignored_columns: Vec::new(),
        baseline,
        augmented,
        candidates: candidates(selection, data, levels),
        effects,
        family_probability: selection.family_probability,
        invisible: invisible(selection),
        never_visible: NEVER_VISIBLE.map(str::to_owned).to_vec(),
        bad_series: bad_series(rows, selection, weighed),
        trials: trials(selection, data),
        sessions: Vec::new(),
        extrapolation: None,
    }
}

/// Whether an error on held-out series is no larger than the noise and its scatter over the series allow.
fn is_adequate(held_out_n: f64, floor_n: f64, data: &Observations) -> bool {
    let series = data.series.max(1) as f64;
    held_out_n <= floor_n * (1.0 + 3.0 / (2.0 * series).sqrt()) || held_out_n.is_nan()
}

/// Load in newtons at which parts of the noise are told.
const TOLD_AT_N: f64 = 20.0;

/// The parts of the noise that are there, the smallest groups first.
fn noise_parts(selection: &Selection, data: &Observations) -> Vec<NoisePart> {
    let noise = selection.noise;
    let bounds = selection.noise_factors;
    let part = |part: &str, what: &str, size: f64, unit: &str, factor: Option<f64>| NoisePart {
        part: part.to_owned(),
        what: what.to_owned(),
        size,
        ci95: factor.map(|f| [size / f, size * f]),
        unit: unit.to_owned(),
    };
    // Of one repetition in each direction nobody can tell what another one would have read.
    let repeated: usize = data.cells.iter().map(|cell| cell.len().saturating_sub(1)).sum();
    let repetitions = data.counts.iter().sum::<f64>() - data.cells.len() as f64;
    let mut parts = vec![
        part(
            "repetition",
            if repeated > 0 {
                "one reading, from repetition to repetition"
            } else {
                "one reading: unknown, since no series has a second repetition; it counts as an offset of the series"
            },
            if repeated > 0 { noise.repetition.at(TOLD_AT_N) } else { 0.0 },
            "N",
            (repeated > 0).then(|| (1.96 / (2.0 * repetitions.max(1.0)).sqrt()).exp()),
        ),
        part(
            "series_and_direction",
            "an offset that the rows of one series and direction share",
            noise.white() * noise.series.at(TOLD_AT_N),
            "N",
            bounds.cell,
        ),
        part(
            "series",
            "an offset that both directions of a series share",
            noise.white() * noise.series_common.at(TOLD_AT_N),
            "N",
            bounds.common,
        ),
        part(
            "series_scale",
            "friction from series to series: the tendon is seated anew",
            noise.series_scale,
            "1",
            bounds.scale,
        ),
        part("mount", "friction, or wrap, from mount to mount", noise.mount_scale, "1", bounds.mount),
        part("walk", "an offset that wanders from series to series", noise.wandering_n(TOLD_AT_N), "N", None),
        part(
            "group",
            "an offset from session to session and operator to operator",
            noise.group_offset_n,
            "N",
            None,
        ),
        part("specimen", "friction from specimen to specimen", noise.specimen_scale, "1", None),
    ];
    // A scatter of friction under a twentieth of a per cent changes nothing that is told.
    parts.retain(|p| p.part == "repetition" || p.size > if p.unit == "1" { 5e-4 } else { 0.0 });
    parts
}

fn limits(selection: &Selection) -> Vec<LimitReport> {
    selection
        .limits
        .iter()
        .map(|limit| LimitReport {
            id: limit.effect.id().to_owned(),
            parameter: limit.effect.parameters().first().map_or("present", |p| p.name).to_owned(),
            low: limit.interval[0],
            high: limit.interval[1],
            typical: limit.typical,
            unit: limit.effect.parameters().first().map_or("1", |p| p.unit).to_owned(),
            one_sided: limit.effect.description().one_sided,
            experiment: limit.effect.description().experiment.to_owned(),
            excluded: limit.is_excluded(),
        })
        .collect()
}

/// What no data of such a rig can show after the refit.
const NEVER_VISIBLE: [&str; 3] = [
    "a loss in the guide pulleys in proportion to tension: needs a run without the switch",
    "a wrap angle that is wrong by a constant: needs the angle measured",
    "a threshold shifted by the same load everywhere: needs another way to see the switching",
];

/// Effects that this data cannot show, with what keeps it from it.
fn invisible(selection: &Selection) -> Vec<Invisible> {
    selection
        .invisible()
        .filter(|c| !selection.effects.iter().any(|found| found.effect.id() == c.effect.id()))
        .map(|candidate| {
            let told = candidate.effect.description();
            Invisible {
                id: told.id.to_owned(),
                why: if candidate.strength < 1e-6 {
                    told.invisible_because.to_owned()
                } else if candidate.is_taken_over() {
                    "the refitted baseline takes it over".to_owned()
                } else {
                    format!(
                        "at a typical size it makes {:.1} standard deviations, {} are needed",
                        candidate.strength,
                        CandidateEffect::MIN_STRENGTH
                    )
                },
                experiment: told.experiment.to_owned(),
            }
        })
        .collect()
}

/// Every effect with what became of it.
fn candidates(selection: &Selection, data: &Observations, levels: Levels) -> Vec<CandidateReport> {
    let degrees = degrees_of_freedom(data, selection.baseline.model.values().len());
    let fate = |candidate: &CandidateEffect, p: f64| {
        let id = candidate.effect.id();
        if selection.effects.iter().any(|found| found.effect.id() == id) {
            Fate::Kept
        } else if selection.effects.iter().any(|found| found.ids().contains(&id)) {
            Fate::Rival
        } else if p <= levels.first_p {
            Fate::Superfluous
        } else if candidate.is_invisible() {
            Fate::Invisible
        } else {
            Fate::Chance
        }
    };
    selection
        .candidates
        .iter()
        .map(|candidate| {
            let p_value =
                family_p_value(candidate.gain, selection.baseline.model.vocabulary.count(), degrees);
            CandidateReport {
                id: candidate.effect.id().to_owned(),
                gain: candidate.gain.max(0.0),
                p_value,
                gain_left: candidate.gain_left.map(|gain| gain.max(0.0)),
                fate: fate(candidate, p_value),
            }
        })
        .collect()
}

fn effects(
    selection: &Selection,
    weighed: &Weighed<'_>,
    after_n: f64,
    augmented: &ModelReport,
) -> Vec<EffectReport> {
    let degrees = degrees_of_freedom(weighed.data, selection.baseline.model.values().len());
    let mut reports: Vec<EffectReport> = selection
        .effects
        .iter()
        .map(|found| named_report(found, selection, weighed, degrees, after_n, augmented))
        .collect();
    reports.extend(unnamed_report(selection, weighed, degrees, after_n, augmented));
    reports
}

fn named_report(
    found: &FoundEffect,
    selection: &Selection,
    weighed: &Weighed<'_>,
    degrees: f64,
    after_n: f64,
    augmented: &ModelReport,
) -> EffectReport {
    let told = found.effect.description();
    let without = selection.augmented.model.without_term(found.term);
    EffectReport {
        id: told.id.to_owned(),
        covariate: told.covariate.as_str().to_owned(),
        side: Some(told.side.as_str().to_owned()),
        formula: found.effect.cited_formula(),
        p_value: family_p_value(found.gain, selection.baseline.model.vocabulary.count(), degrees),
        parameters: told
            .parameters
            .iter()
            .filter_map(|p| {
                let known = augmented.parameters.get(&format!("{}.{}", told.id, p.name))?;
                Some((p.name.to_owned(), known.clone()))
            })
            .collect(),
        error_before_n: held_out(&without, weighed).both_n(),
        error_after_n: after_n,
        rivals: found.rivals.iter().map(|rival| rival_report(found, rival)).collect(),
        form: None,
    }
}

fn rival_report(found: &FoundEffect, rival: &Rival) -> RivalReport {
    let (told, other) = (found.effect.description(), rival.effect.description());
    RivalReport {
        id: other.id.to_owned(),
        why: format!(
            "after the refit its trace is the same to a cosine of {:.3}; in place of {} it fits worse by only {:.1} whitened squares",
            rival.cosine, told.id, rival.worse_by
        ),
        experiment: if told.experiment == other.experiment {
            told.experiment.to_owned()
        } else {
            format!("{}; {}", told.experiment, other.experiment)
        },
    }
}

/// The report of the structure that no name explains, if there is any.
fn unnamed_report(
    selection: &Selection,
    weighed: &Weighed<'_>,
    degrees: f64,
    after_n: f64,
    augmented: &ModelReport,
) -> Option<EffectReport> {
    let structure = selection.structure?;
    let model = &selection.augmented.model;
    let shapes: Vec<(usize, String)> = model
        .terms
        .iter()
        .enumerate()
        .filter_map(|(i, term)| match term {
            Term::Structure(s) => Some((i, s.describe(&model.frame))),
            Term::Named(_) => None,
        })
        .collect();
    let bare = shapes.iter().rev().fold(model.clone(), |m, (i, _)| m.without_term(*i));
    Some(EffectReport {
        id: UNATTRIBUTED.to_owned(),
        covariate: structure.covariate.as_str().to_owned(),
        side: None,
        formula: shapes.iter().map(|(_, words)| words.as_str()).collect::<Vec<_>>().join("; "),
        p_value: family_p_value(structure.gain, selection.structures_tried, degrees),
        parameters: augmented
            .parameters
            .iter()
            .filter(|(name, _)| name.starts_with(UNATTRIBUTED))
            .map(|(name, e)| (name.clone(), e.clone()))
            .collect(),
        error_before_n: held_out(&bare, weighed).both_n(),
        error_after_n: after_n,
        rivals: Vec::new(),
        form: None,
    })
}

/// Mean residual of a series and direction, in standard deviations, beyond which it is listed as bad.
const BAD_SERIES_SD: f64 = 4.5;
/// Readings further off than this many standard deviations of noise are bad ones.
pub(crate) const BAD_READING_SD: f64 = 20.0;

/// Series whose mean residual, or one reading, is further off than noise can make it.
fn bad_series(rows: &[PlateauRow], selection: &Selection, weighed: &Weighed<'_>) -> Vec<BadSeries> {
    let data = weighed.data;
    let mut bad = Vec::new();
    for (index, (cell, load)) in data.cells.iter().zip(&data.cell_load_n).enumerate() {
        let (mean, sd) = cell_deviation(&selection.augmented, weighed, index);
        let worst = cell
            .iter()
            .map(|r| selection.augmented.residual_n[*r])
            .fold(0.0f64, |a, b| if b.abs() > a.abs() { b } else { a });
        let friction_n = cell.first().map_or(0.0, |r| data.friction_n[*r]);
        let reading_sd = selection.noise.at(*load, friction_n);
        let (offset_n, sd) = if mean.abs() > BAD_SERIES_SD * sd {
            (mean, sd)
        } else if worst.abs() > BAD_READING_SD * reading_sd {
            (worst, reading_sd)
        } else {
            continue;
        };
        if let Some(row) = cell.first().and_then(|r| rows.get(data.source[*r])) {
            bad.push(BadSeries {
                series: row.series.clone(),
                direction: row.direction.as_str().to_owned(),
                offset_n,
                standard_deviations: offset_n / sd,
            });
        }
    }
    bad
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::CATALOGUE;
    use crate::test_session::session;

    fn fates(levels: Levels) -> Vec<Fate> {
        let report = calibrate(&session(3), levels).unwrap().report;
        assert_eq!(report.candidates.len(), CATALOGUE.len());
        report.candidates.iter().map(|c| c.fate).collect()
    }

    /// The level at which a gain counts as more than chance is the caller's, in the search and in the report alike.
    #[test]
    fn the_fate_of_a_candidate_follows_the_levels_given() {
        let usual = fates(Levels::default());
        assert!(usual.contains(&Fate::Chance) && usual.contains(&Fate::Invisible), "{usual:?}");
        assert!(!usual.contains(&Fate::Superfluous), "{usual:?}");
        // Flips at zero keep the search from naming anything; what chance could explain is then the level's to say.
        let credulous = fates(Levels { first_p: 1.0, flips: 0.0, ..Levels::default() });
        assert!(!credulous.contains(&Fate::Chance), "{credulous:?}");
    }

    #[test]
    fn rows_that_cannot_fix_the_baseline_are_refused_with_the_number_that_could() {
        let rows = session(1);
        let error = calibrate(&rows[..5], Levels::default()).unwrap_err();
        assert_eq!(error, CalibrationError::TooFewRows { found: 5, needed: 2 + ROWS_FOR_NOISE });
    }
}
