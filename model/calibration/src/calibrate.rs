//! From a selection to its report: verdict, effects, rivals, blind spots, errors before and after.

use crate::effects::LIBRARY;
use crate::held_out::{SOUND_WEIGHT, held_out};
use crate::inference::{
    Fit, Levels, Model, Noise, Observations, Selection, Term, cell_deviation, degrees_of_freedom,
    family_p_value, interval_half_widths, select,
};
use crate::layouts_left_out::layouts_left_out;
use crate::report::{
    BadSeries, Candidate, DataSummary, EffectReport, Estimate, Fate, Invisible, ModelReport, Report,
    RivalReport, Verdict,
};
use crate::table::{Frame, PlateauRow, Surface};

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
}

/// Rows beyond the baseline's constants without which any misfit would be many times a noise that nobody knows.
const ROWS_FOR_NOISE: usize = 8;

/// Calibrates a table.
///
/// # Errors
/// [`CalibrationError::TooFewRows`] if the rows cannot fix the baseline.
pub fn calibrate(rows: &[PlateauRow], levels: Levels) -> Result<Calibration, CalibrationError> {
    let frame = Frame::new(rows);
    let start = Model::baseline(frame.clone());
    let needed = start.values().len() + ROWS_FOR_NOISE;
    let too_few = CalibrationError::TooFewRows { found: rows.len(), needed };
    let mut data = Observations::new(&frame, rows).ok_or_else(|| too_few.clone())?;
    if rows.len() < needed {
        return Err(too_few);
    }
    let selection = select(&start, &mut data, levels);
    let report = report(rows, &selection, &data);
    Ok(Calibration { report, selection, data })
}

/// A constant with its interval, which ends at the bounds of a shape.
fn estimate(value: f64, half_width: f64, unit: &str, (least, most): (f64, f64)) -> Estimate {
    let ci95 = [(value - half_width).max(least), (value + half_width).min(most)];
    Estimate { value, ci95, unit: unit.to_owned() }
}

fn model_report(fitted: &Fit, data: &Observations, noise: Noise) -> (ModelReport, f64) {
    let held = held_out(&fitted.model, data, noise);
    let (mut sum, mut count) = (0.0, 0.0);
    for (r, _) in fitted.residual_n.iter().zip(&data.weights).filter(|(_, w)| **w > SOUND_WEIGHT) {
        sum += r * r;
        count += 1.0;
    }
    let widths = interval_half_widths(fitted, data, noise);
    let conditions = &fitted.model.frame.conditions;
    let touched = |name: &str| match name {
        "mu_p" => conditions.iter().any(crate::table::Condition::has_pins),
        "mu_s" => conditions.iter().any(|c| c.surface == Surface::Silicone),
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
        rmse_n: (sum / f64::max(count, 1.0)).sqrt(),
        heldout_rmse_n: held.both_n(),
        heldout_series_rmse_n: held.series_n,
        heldout_loads_rmse_n: held.loads_n,
        heldout_layouts_rmse_n: layouts_left_out(&fitted.model, data, noise),
        parameters,
    };
    (report, held.both_n())
}

fn report(rows: &[PlateauRow], selection: &Selection, data: &Observations) -> Report {
    let noise = selection.noise;
    let (baseline, before_n) = model_report(&selection.baseline, data, noise);
    let (augmented, after_n) = if selection.augmented.model.terms.is_empty() {
        (baseline.clone(), before_n)
    } else {
        model_report(&selection.augmented, data, noise)
    };
    let effects = effects(selection, data, after_n, &augmented);
    let verdict = if selection.structure.is_some() {
        Verdict::Unattributed
    } else if effects.is_empty() {
        Verdict::None
    } else if effects.iter().any(|e| !e.rivals.is_empty()) {
        Verdict::Ambiguous
    } else {
        Verdict::Attributed
    };
    Report {
        schema: "pinswitch.calibration/1".to_owned(),
        data: DataSummary {
            rows: rows.len(),
            series: data.series,
            conditions: selection.baseline.model.frame.conditions.len(),
            outliers: data.weights.iter().filter(|w| **w <= SOUND_WEIGHT).count(),
        },
        verdict,
        noise_floor_n: noise.floor_n(data),
        noise,
        baseline,
        augmented,
        candidates: candidates(selection, &effects, data),
        effects,
        family_probability: selection.family_probability,
        invisible: selection
            .invisible
            .iter()
            .filter(|(e, ..)| !selection.augmented.model.terms.iter().any(|t| t.id() == e.id()))
            .map(|(effect, share, strength)| Invisible {
                id: effect.id().to_owned(),
                why: if *strength < 1e-6 {
                    effect.invisible_because().to_owned()
                } else if *share < 2e-3 {
                    "the refitted baseline takes it over".to_owned()
                } else {
                    format!("at a typical size it makes {strength:.1} standard deviations, 4 are needed")
                },
                experiment: effect.experiment().to_owned(),
            })
            .collect(),
        never_visible: [
            "a loss in the guide pulleys in proportion to tension: needs a run without the switch",
            "a wrap angle that is wrong by a constant: needs the angle measured",
            "a threshold shifted by the same load everywhere: needs another way to see the switching",
        ]
        .map(str::to_owned)
        .to_vec(),
        bad_series: bad_series(rows, selection, data),
        extrapolation: None,
    }
}

/// Every effect with what became of it.
fn candidates(selection: &Selection, effects: &[EffectReport], data: &Observations) -> Vec<Candidate> {
    let degrees = degrees_of_freedom(data, selection.baseline.model.values().len());
    let fate = |id: &str, p: f64| {
        if effects.iter().any(|e| e.id == id) {
            Fate::Kept
        } else if effects.iter().any(|e| e.rivals.iter().any(|r| r.id == id)) {
            Fate::Rival
        } else if p <= 0.015 {
            Fate::Superfluous
        } else if selection.invisible.iter().any(|(e, ..)| e.id() == id) {
            Fate::Invisible
        } else {
            Fate::Chance
        }
    };
    selection
        .candidates
        .iter()
        .map(|(id, gain)| {
            let p_value = family_p_value(*gain, LIBRARY.len(), degrees);
            Candidate {
                id: (*id).to_owned(),
                gain: gain.max(0.0),
                p_value,
                gain_left: selection.leftover.iter().find(|l| l.0 == *id).map(|l| l.1.max(0.0)),
                fate: fate(id, p_value),
            }
        })
        .collect()
}

fn effects(
    selection: &Selection,
    data: &Observations,
    after_n: f64,
    augmented: &ModelReport,
) -> Vec<EffectReport> {
    let model = &selection.augmented.model;
    let degrees = degrees_of_freedom(data, selection.baseline.model.values().len());
    let mut found = Vec::new();
    let (mut named, mut unnamed) = (0, Vec::new());
    for (i, term) in model.terms.iter().enumerate() {
        let Term::Named(effect) = term else {
            unnamed.push(i);
            continue;
        };
        let without = model.without_term(i);
        let gain = selection.gains.get(named).copied().unwrap_or(0.0);
        let rivals = selection.rivals.get(named).map_or(&[][..], Vec::as_slice);
        named += 1;
        found.push(EffectReport {
            id: effect.id().to_owned(),
            covariate: effect.covariate().word().to_owned(),
            side: Some(effect.side().word().to_owned()),
            formula: effect.formula().to_owned(),
            p_value: family_p_value(gain, LIBRARY.len(), degrees),
            parameters: effect
                .parameters()
                .iter()
                .filter_map(|p| {
                    let known = augmented.parameters.get(&format!("{}.{}", effect.id(), p.name))?;
                    Some((p.name.to_owned(), known.clone()))
                })
                .collect(),
            error_before_n: held_out(&without, data, selection.noise).both_n(),
            error_after_n: after_n,
            rivals: rivals
                .iter()
                .map(|r| RivalReport {
                    id: r.effect.id().to_owned(),
                    why: format!(
                        "after the refit its trace is the same to a cosine of {:.3}; in place of {} it fits worse by only {:.1} whitened squares",
                        r.cosine, effect.id(), r.worse_by
                    ),
                    experiment: format!("{}; {}", effect.experiment(), r.effect.experiment()),
                })
                .collect(),
        });
    }
    if let Some((covariate, gain)) = selection.structure {
        let shapes: Vec<String> = unnamed
            .iter()
            .filter_map(|i| match &model.terms[*i] {
                Term::Structure(s) => Some(s.describe(&model.frame)),
                Term::Named(_) => None,
            })
            .collect();
        let bare = unnamed.iter().rev().fold(model.clone(), |m, i| m.without_term(*i));
        found.push(EffectReport {
            id: "unattributed".to_owned(),
            covariate: covariate.word().to_owned(),
            side: None,
            formula: shapes.join("; "),
            p_value: family_p_value(gain, selection.structures_tried, degrees),
            parameters: augmented
                .parameters
                .iter()
                .filter(|(name, _)| name.starts_with("unattributed."))
                .map(|(name, e)| (name.clone(), e.clone()))
                .collect(),
            error_before_n: held_out(&bare, data, selection.noise).both_n(),
            error_after_n: after_n,
            rivals: Vec::new(),
        });
    }
    found
}

/// Cells whose mean residual is beyond 4.5 standard deviations, or that hold a reading beyond 20.
fn bad_series(rows: &[PlateauRow], selection: &Selection, data: &Observations) -> Vec<BadSeries> {
    let mut bad = Vec::new();
    for (index, (cell, load)) in data.cells.iter().zip(&data.cell_load_n).enumerate() {
        let (mean, sd) = cell_deviation(&selection.augmented, data, selection.noise, index);
        let worst = cell
            .iter()
            .map(|r| selection.augmented.residual_n[*r])
            .fold(0.0f64, |a, b| if b.abs() > a.abs() { b } else { a });
        let reading_sd = selection.noise.at(*load);
        let (offset_n, sd) = if mean.abs() > 4.5 * sd {
            (mean, sd)
        } else if worst.abs() > 20.0 * reading_sd {
            (worst, reading_sd)
        } else {
            continue;
        };
        if let Some(row) = cell.first().and_then(|r| rows.get(*r)) {
            bad.push(BadSeries {
                series: row.series.clone(),
                direction: crate::table::direction_word(row.direction).to_owned(),
                offset_n,
                standard_deviations: offset_n / sd,
            });
        }
    }
    bad
}
