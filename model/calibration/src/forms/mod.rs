//! Forms for what has no name: what a structure that no effect explains looks like, drawn from a small library of formulas,
//! with its constants, its rivals among the forms, and how much of the structure it leaves.
//!
//! A form is an effect of one's own. Written to `discovered.toml` it takes part in the next calibration, which confirms or
//! refutes it on data that had no part in drawing it.

mod library;

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::calibrate::Calibration;
use crate::effects::{Covariate, EffectDefinition, OwnEffect, Vocabulary};
use crate::held_out::held_out;
use crate::inference::{Fit, Screen, Term, Weighed, fit, interval_half_widths};
use crate::report::Estimate;
use library::{Candidate, library};

/// Starts of each form that are fitted to the end.
const FITTED_STARTS: usize = 2;
/// Squares of the noise by which a rival form may fit worse, and the share of what the best one explains.
const RIVAL: f64 = 9.0;
const RIVAL_SHARE: f64 = 0.03;

/// A form that fits as well.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FormRival {
    /// Its shape.
    pub shape: String,
    /// What it acts on.
    pub acts_on: String,
    /// By how many squares of the noise it fits worse.
    pub worse_by: f64,
}

/// What a structure without a name looks like.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FormReport {
    /// `level`, `step`, `ramp`, `sine`, `bump`, `dip`, `power`, `forgetting` or `memory`.
    pub shape: String,
    /// `friction`, `reading`, `drag` or `threshold`.
    pub acts_on: String,
    /// Id of the effect in `discovered.toml`.
    pub id: String,
    /// Its formula, in the language of `model/doc/own-effects.md`.
    pub formula: String,
    /// Its constants.
    pub parameters: BTreeMap<String, Estimate>,
    /// Share of what the shapes without a name explain that this one form explains.
    pub explains: f64,
    /// Held-out error of the model with the form in place of the shapes, in newtons.
    #[serde(rename = "heldout_rmse_N")]
    pub heldout_rmse_n: f64,
    /// Other forms that fit as well.
    pub rivals: Vec<FormRival>,
}

/// A form with the effect that it is.
#[derive(Clone, Debug)]
pub struct DrawnForm {
    /// What is said of it.
    pub report: FormReport,
    /// The same as an effect of one's own.
    pub definition: EffectDefinition,
}

/// Draws the form of the structure that a calibration found and could not name; `None` if it found none, or none of the
/// library explains any of it.
pub fn draw_form(calibration: &Calibration) -> Option<DrawnForm> {
    let selection = &calibration.selection;
    let covariate = selection.structure?.covariate;
    let data = calibration.data.compacted();
    let weighed = Weighed::new(&data, selection.noise);
    let with_shapes = fit(&selection.augmented.model, &weighed);
    let mut bare = selection.augmented.model.clone();
    while let Some(at) = bare.terms.iter().position(|t| matches!(t, Term::Structure(_))) {
        bare = bare.without_term(at);
    }
    let without = fit(&bare, &weighed);
    let candidates = library(covariate, &bare.frame);
    let own = candidates.iter().filter_map(|c| OwnEffect::new(c.definition.clone()).ok()).collect();
    let known = bare.vocabulary.clone();
    let with_forms =
        Fit { model: bare.clone().among(&Vocabulary::built_in().with(own).ok()?), ..without.clone() };
    let best = best_of_each(&with_forms, &weighed, &candidates);
    let (first, found) = best.first()?;
    let explained = without.cost - found.cost;
    let rivals = best
        .iter()
        .skip(1)
        .map(|(c, f)| FormRival {
            shape: shape_of(c, f),
            acts_on: c.acts_on.to_owned(),
            worse_by: toll(c, f) - toll(first, found),
        })
        .filter(|rival| rival.worse_by <= RIVAL.max(RIVAL_SHARE * explained))
        .collect();
    if explained <= 0.0 {
        return None;
    }
    let shape = shape_of(first, found);
    let definition = named(first, found, covariate, &shape, &known);
    let half_widths = interval_half_widths(found, &weighed);
    let at = found.model.term_offset(found.model.terms.len() - 1);
    let values = found.model.values();
    let parameters = definition.parameters.iter().enumerate().map(|(i, p)| {
        let (value, half) = (values[at + i], half_widths[at + i]);
        let (low, high) = p.bounds.unwrap_or((f64::NEG_INFINITY, f64::INFINITY));
        let ci95 = [(value - half).max(low), (value + half).min(high)];
        (p.name.clone(), Estimate { value, ci95, unit: p.unit.clone() })
    });
    let by_shapes = without.cost - with_shapes.cost;
    Some(DrawnForm {
        report: FormReport {
            shape,
            acts_on: first.acts_on.to_owned(),
            id: definition.id.clone(),
            formula: definition.formula.clone(),
            parameters: parameters.collect(),
            explains: if by_shapes > 0.0 { (explained / by_shapes).min(1.0) } else { 1.0 },
            heldout_rmse_n: held_out(&found.model, &weighed).both_n(),
            rivals,
        },
        definition,
    })
}

/// The best fit of each shape on each thing, the one with the least toll first.
fn best_of_each<'a>(
    start: &Fit,
    weighed: &Weighed<'_>,
    candidates: &'a [Candidate],
) -> Vec<(&'a Candidate, Fit)> {
    let mut scores = Screen::new(start, weighed).effects();
    scores.retain(|score| score.effect.id().starts_with("form_") && score.strength > 1e-6);
    scores.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    let mut best: Vec<(&Candidate, Fit, usize)> = Vec::new();
    for score in scores {
        let Some(candidate) = candidates.iter().find(|c| c.definition.id == score.effect.id()) else {
            continue;
        };
        let is_same = |c: &Candidate| c.shape == candidate.shape && c.acts_on == candidate.acts_on;
        let known = best.iter().position(|(c, _, _)| is_same(c));
        if known.is_some_and(|at| best[at].2 >= FITTED_STARTS) {
            continue;
        }
        let fitted = fit(&start.model.with_term(Term::Named(score.effect), &score.start), weighed);
        match known {
            Some(at) => {
                best[at].2 += 1;
                if fitted.cost < best[at].1.cost {
                    (best[at].0, best[at].1) = (candidate, fitted);
                }
            }
            None => best.push((candidate, fitted, 1)),
        }
    }
    let mut best: Vec<(&Candidate, Fit)> = best.into_iter().map(|(c, f, _)| (c, f)).collect();
    best.sort_by(|(a, x), (b, y)| toll(a, x).total_cmp(&toll(b, y)));
    best
}

/// Squares that are left, and what each constant costs: as the information criterion of Schwarz for some dozen series.
fn toll(candidate: &Candidate, fitted: &Fit) -> f64 {
    const PER_CONSTANT: f64 = 4.0;
    fitted.cost + PER_CONSTANT * candidate.definition.parameters.len() as f64
}

/// A bump whose size is negative is a dip.
fn shape_of(candidate: &Candidate, fitted: &Fit) -> String {
    let at = fitted.model.term_offset(fitted.model.terms.len() - 1);
    let is_dip = candidate.shape == "bump" && fitted.model.values().get(at).is_some_and(|a| *a < 0.0);
    (if is_dip { "dip" } else { candidate.shape }).to_owned()
}

/// The definition with the constants that were found, under an id that no effect has.
fn named(
    candidate: &Candidate,
    fitted: &Fit,
    covariate: Covariate,
    shape: &str,
    known: &Vocabulary,
) -> EffectDefinition {
    let mut definition = candidate.definition.clone();
    let base = format!("discovered_{}_{shape}", covariate.as_str());
    let numbered = (2..).map(|n| format!("{base}_{n}"));
    let free = std::iter::once(base.clone()).chain(numbered).find(|id| known.named(id).is_none());
    definition.id = free.unwrap_or(base);
    let at = fitted.model.term_offset(fitted.model.terms.len() - 1);
    // Sizes come before shapes in a model, as they do here.
    for (parameter, value) in definition.parameters.iter_mut().zip(fitted.model.values().into_iter().skip(at))
    {
        // As many digits as anybody can use.
        parameter.start = format!("{value:.6e}").parse().unwrap_or(value);
        if let Some((low, high)) = parameter.bounds {
            let margin = 1e-3 * (high - low);
            parameter.start = parameter.start.clamp(low + margin, high - margin);
        }
    }
    definition
}
