//! Forms: parametric formulas for unattributed structure.
//!
//! A form is selected from a small library, with its constants, the rival forms, and the share of
//! the structure that it explains. It is a user-defined effect. Written to `discovered.toml`, it is
//! tested in the next calibration with data from which it was not derived.

mod library;

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use pinswitch_friction::sort_by_number;

use crate::effects::{Covariate, EffectDefinition, OwnEffect, Vocabulary};
use crate::held_out::held_out;
use crate::inference::{
    EffectScore, Fit, Model, Noise, Observations, Screen, Selection, Term, Weighed, fit, interval_half_widths,
};
use crate::report::Estimate;
use crate::table::{PlateauRow, readings_by_session};
use library::{ALL, Acting, Candidate, FIRST, Form, acts_on_word, library, where_shapes_lie};

/// Number of start values of each form that are tried for all quantities and fitted.
const FITTED_STARTS: usize = 2;
/// Gain at the start values, as a share of the largest, from which a form is fitted, since a wave
/// may start out of phase.
const WORTH_A_FIT: f64 = 0.3;
/// Largest increase of the deviance of a rival form, and the same as a share of the gain of the
/// best form.
const RIVAL: f64 = 9.0;
const RIVAL_SHARE: f64 = 0.03;

/// A form that fits equally well.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FormRival {
    /// Shape.
    pub shape: String,
    /// Quantity that it changes.
    pub acts_on: String,
    /// Increase of the deviance compared with the best form.
    pub worse_by: f64,
}

/// Form of unattributed structure.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FormReport {
    /// `level` (also between two ends), `step`, `ramp`, `sine`, `bump`, `dip`, `power`,
    /// `forgetting`, `memory` or `groups`.
    pub shape: String,
    /// `friction`, `reading`, `wrap` or `threshold`.
    pub acts_on: String,
    /// Quantity in the words of `discovered.toml`, such as `mu_silicone`.
    pub channel: String,
    /// Id of the effect in `discovered.toml`.
    pub id: String,
    /// Formula, in the language of `model/doc/own-effects.md`.
    pub formula: String,
    /// Constants.
    pub parameters: BTreeMap<String, Estimate>,
    /// Share of the gain of the shapes that the form explains.
    pub explains: f64,
    /// Held-out error of the model with the form in place of the shapes, in newtons.
    #[serde(rename = "heldout_rmse_N")]
    pub heldout_rmse_n: f64,
    /// Whether the model contains the form, because its held-out error is not larger than that of
    /// the shapes.
    pub in_model: bool,
    /// Other forms that fit equally well.
    pub rivals: Vec<FormRival>,
}

impl FormReport {
    /// Returns the shape in words, with its article.
    pub fn words(&self) -> String {
        match self.shape.as_str() {
            "groups" => "a level of one operator".to_owned(),
            shape => format!("a {shape}"),
        }
    }
}

/// A form with its effect.
#[derive(Clone, Debug)]
pub struct DrawnForm {
    /// Report of the form.
    pub report: FormReport,
    /// Definition as a user-defined effect.
    pub definition: EffectDefinition,
    /// Fit of the model with the form in place of the shapes, on the rows from which it was
    /// derived.
    pub fitted: Fit,
}

/// Derives the form of the unattributed structure of a calibration; `None` without such structure,
/// or if no form of the library explains part of it.
pub fn draw_form(rows: &[PlateauRow], selection: &Selection, data: &Observations) -> Option<DrawnForm> {
    let data = data.compacted();
    let weighed = Weighed::new(&data, selection.noise);
    let Best { first, found, rivals, explained, by_shapes } =
        best(selection.structure?.covariate, &selection.augmented.model, &weighed)?;
    let shape = shape_of(&first, &found);
    let known = &selection.augmented.model.vocabulary;
    let definition = named(&first, &found, selection.structure?.covariate, &shape, known);
    let fitted = renamed(&found, &definition, known, &weighed)?;
    // Its constants are the reported ones.
    let mut definition = named(&first, &fitted, selection.structure?.covariate, &shape, known);
    definition.drawn_from = readings_by_session(rows).into_values().collect();
    let at = fitted.model.term_offset(fitted.model.terms.len() - 1);
    let values = fitted.model.values();
    // If the table does not locate the form, its size is reported at the fitted location, and no
    // interval for the location.
    let told = if size_is_known(&fitted, &weighed) {
        fitted.clone()
    } else {
        let sizes = definition.parameters.iter().filter(|p| p.bounds.is_none()).count();
        Fit { model: fitted.model.frozen_except(&(0..at + sizes).collect::<Vec<_>>()), ..fitted.clone() }
    };
    let half_widths = interval_half_widths(&told, &weighed);
    let parameters = definition.parameters.iter().enumerate().map(|(i, p)| {
        let held = told.model.is_held(at + i);
        let (value, half) = (values[at + i], if held { f64::INFINITY } else { half_widths[at + i] });
        let (low, high) = p.bounds.unwrap_or((f64::NEG_INFINITY, f64::INFINITY));
        let ci95 = [(value - half).max(low), (value + half).min(high)];
        (p.name.clone(), Estimate { value, ci95, unit: p.unit.clone() })
    });
    Some(DrawnForm {
        report: FormReport {
            shape,
            acts_on: acts_on_word(first.definition.acts_on).to_owned(),
            channel: first.definition.acts_on.as_str().to_owned(),
            id: definition.id.clone(),
            formula: definition.formula.clone(),
            parameters: parameters.collect(),
            explains: if by_shapes > 0.0 { (explained / by_shapes).min(1.0) } else { 1.0 },
            heldout_rmse_n: held_out(&fitted.model, &weighed).both_n(),
            in_model: false,
            rivals,
        },
        definition,
        fitted,
    })
}

/// Returns the model with the best form in place of the shapes along a covariate, for a prediction
/// only.
pub(crate) fn with_best_form(
    covariate: Covariate,
    with_shapes: &Model,
    noise: Noise,
    data: &Observations,
) -> Option<Model> {
    best(covariate, with_shapes, &Weighed::new(data, noise)).map(|best| best.found.model)
}

/// The best form of a structure.
struct Best {
    first: Candidate,
    /// Fit with the form and without the shapes.
    found: Fit,
    rivals: Vec<FormRival>,
    /// Gains of the form and of the shapes: reductions of the deviance.
    explained: f64,
    by_shapes: f64,
}

fn best(covariate: Covariate, with_shapes: &Model, weighed: &Weighed<'_>) -> Option<Best> {
    let with_shapes = fit(with_shapes, weighed);
    let shapes = with_shapes.model.terms.iter().filter_map(|term| match term {
        Term::Structure(shape) if shape.covariate == covariate => Some(shape),
        _ => None,
    });
    let mut forms = where_shapes_lie(shapes);
    let bare = with_shapes.model.without_terms(|term| matches!(term, Term::Structure(_)));
    let without = fit(&bare, weighed);
    forms.extend(library(covariate, &bare.frame));
    let on = |forms: &mut dyn Iterator<Item = &Form>, things: &[Acting]| -> Vec<Candidate> {
        let pairs = forms.flat_map(|form| things.iter().map(move |acting| (form, *acting)));
        pairs.enumerate().map(|(i, (form, acting))| form.on(acting, covariate, i)).collect()
    };
    let first = on(&mut forms.iter(), &FIRST);
    let promising = promising(&ranked(&without, weighed, &first)?);
    let second = on(&mut promising.iter(), &ALL);
    let best = best_of_each(&without, weighed, &second)?;
    let (first, found) = best.first()?;
    let explained = without.cost - found.cost;
    let rivals = best
        .iter()
        .skip(1)
        .map(|(c, f)| FormRival {
            shape: shape_of(c, f),
            acts_on: acts_on_word(c.definition.acts_on).to_owned(),
            worse_by: toll(c, f) - toll(first, found),
        })
        .filter(|rival| rival.worse_by <= rival_bound(explained))
        .collect();
    let by_shapes = without.cost - with_shapes.cost;
    (explained > 0.0).then(|| Best {
        first: (*first).clone(),
        found: found.clone(),
        rivals,
        explained,
        by_shapes,
    })
}

/// Returns the same fit with the form under its final id, in a vocabulary with the known effects.
fn renamed(
    found: &Fit,
    definition: &EffectDefinition,
    known: &Vocabulary,
    weighed: &Weighed<'_>,
) -> Option<Fit> {
    let last = found.model.terms.len().checked_sub(1)?;
    let values = found.model.values().split_off(found.model.term_offset(last));
    let vocabulary = known.with(vec![OwnEffect::new(definition.clone()).ok()?]).ok()?;
    let effect = vocabulary.named(&definition.id)?;
    let bare = found.model.without_term(last).among(&vocabulary);
    Some(fit(&bare.with_term(Term::Named(effect), &values), weighed))
}

/// Candidates by expected gain, with a model whose vocabulary contains them all.
struct Ranked<'a> {
    model: Model,
    scores: Vec<(&'a Candidate, EffectScore)>,
}

fn ranked<'a>(start: &Fit, weighed: &Weighed<'_>, candidates: &'a [Candidate]) -> Option<Ranked<'a>> {
    let own = candidates.iter().filter_map(|c| OwnEffect::new(c.definition.clone()).ok()).collect();
    let model = start.model.clone().among(&Vocabulary::built_in().with(own).ok()?);
    let fitted = Fit { model, ..start.clone() };
    let screen = Screen::new(&fitted, weighed);
    // Each has one start; the library contains the other start values as candidates.
    let scored = |candidate: &'a Candidate| {
        let effect = fitted.model.vocabulary.named(&candidate.definition.id)?;
        let start = effect.starts(&fitted.model.frame).into_iter().next()?;
        let score = screen.effect_at(effect, start)?;
        (score.strength > 1e-6).then_some((candidate, score))
    };
    let mut scores: Vec<_> = candidates.iter().filter_map(scored).collect();
    sort_by_number(&mut scores, |(_, score)| -score.gain);
    Some(Ranked { model: fitted.model, scores })
}

/// Returns the best starts of each shape.
fn promising(ranked: &Ranked<'_>) -> Vec<Form> {
    let mut best: Vec<Form> = Vec::new();
    for (candidate, _) in &ranked.scores {
        let of_shape = best.iter().filter(|form| form.shape == candidate.form.shape).count();
        if of_shape < FITTED_STARTS && !best.contains(&candidate.form) {
            best.push(candidate.form.clone());
        }
    }
    best
}

/// Returns the best fit of each shape and quantity, by ascending [`toll`].
fn best_of_each<'a>(
    start: &Fit,
    weighed: &Weighed<'_>,
    candidates: &'a [Candidate],
) -> Option<Vec<(&'a Candidate, Fit)>> {
    let Ranked { model, scores } = ranked(start, weighed, candidates)?;
    let most = scores.first().map_or(0.0, |(_, score)| score.gain);
    let mut best: Vec<(&Candidate, Fit)> = Vec::new();
    for (candidate, score) in scores.into_iter().filter(|(_, score)| score.gain >= WORTH_A_FIT * most) {
        let fitted = fit(&model.with_term(Term::Named(score.effect), &score.start), weighed);
        match best.iter().position(|(c, _)| c.is_like(candidate)) {
            Some(at) if fitted.cost < best[at].1.cost => best[at] = (candidate, fitted),
            Some(_) => {}
            None => best.push((candidate, fitted)),
        }
    }
    sort_by_number(&mut best, |(candidate, fitted)| toll(candidate, fitted));
    // Among forms that fit alike, one whose size is identified comes first: the ends of another may
    // be anywhere between two readings.
    let explained = best.first().map_or(0.0, |(_, fitted)| start.cost - fitted.cost);
    let alike = |(c, f): &(&Candidate, Fit)| {
        best.first().is_some_and(|(first, found)| toll(c, f) - toll(first, found) <= rival_bound(explained))
    };
    if let Some(at) = best.iter().position(|form| alike(form) && size_is_known(&form.1, weighed)) {
        let known = best.remove(at);
        best.insert(0, known);
    }
    Some(best)
}

/// Returns the increase of the deviance up to which a form is a rival of the best one with this
/// gain.
fn rival_bound(explained: f64) -> f64 {
    RIVAL.max(RIVAL_SHARE * explained)
}

/// Returns whether the interval of the size of the last term excludes zero. Sizes come before
/// shapes.
fn size_is_known(fitted: &Fit, weighed: &Weighed<'_>) -> bool {
    let at = fitted.model.term_offset(fitted.model.terms.len() - 1);
    let half = interval_half_widths(fitted, weighed).get(at).copied();
    let size = fitted.model.values().get(at).copied();
    size.zip(half).is_some_and(|(size, half)| size.abs() > half)
}

/// Returns the deviance plus a penalty for each constant: Schwarz's information criterion for some
/// dozen series.
fn toll(candidate: &Candidate, fitted: &Fit) -> f64 {
    const PER_CONSTANT: f64 = 4.0;
    fitted.cost + PER_CONSTANT * candidate.definition.parameters.len() as f64
}

/// Returns the word for the shape; a bump with a negative size is a dip.
fn shape_of(candidate: &Candidate, fitted: &Fit) -> String {
    let at = fitted.model.term_offset(fitted.model.terms.len() - 1);
    let is_dip = candidate.form.shape == "bump" && fitted.model.values().get(at).is_some_and(|a| *a < 0.0);
    (if is_dip { "dip" } else { candidate.form.shape }).to_owned()
}

/// Returns the definition with the fitted constants, under an unused id.
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
    // Sizes come before shapes in the model and in the definition.
    for (parameter, value) in definition.parameters.iter_mut().zip(fitted.model.values().into_iter().skip(at))
    {
        // Rounded to significant digits.
        parameter.start = format!("{value:.6e}").parse().unwrap_or(value);
        if let Some((low, high)) = parameter.bounds {
            let margin = 1e-3 * (high - low);
            parameter.start = parameter.start.clamp(low + margin, high - margin);
        }
    }
    definition
}
