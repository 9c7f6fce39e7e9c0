//! Forms for what has no name: what a structure that no effect explains looks like, drawn from a small library of formulas,
//! with its constants, its rivals among the forms, and how much of the structure it leaves.
//!
//! A form is an effect of one's own. Written to `discovered.toml` it takes part in the next calibration, which confirms or
//! refutes it on data that had no part in drawing it.

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

/// Starts of each form that are tried on everything, and fitted to the end.
const FITTED_STARTS: usize = 2;
/// Gain at the start, as a share of the largest, from which a form is fitted: a wave may start out of phase.
const WORTH_A_FIT: f64 = 0.3;
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
    /// `level` (also between two ends), `step`, `ramp`, `sine`, `bump`, `dip`, `power`, `forgetting`, `memory` or `groups`.
    pub shape: String,
    /// `friction`, `reading`, `wrap` or `threshold`.
    pub acts_on: String,
    /// The same in the words of `discovered.toml`, such as `mu_silicone`.
    pub channel: String,
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
    /// Whether the model has the form, since it predicts held-out data no worse than the shapes do.
    pub in_model: bool,
    /// Other forms that fit as well.
    pub rivals: Vec<FormRival>,
}

impl FormReport {
    /// The shape as a thing, with its article.
    pub fn words(&self) -> String {
        match self.shape.as_str() {
            "groups" => "a level of one operator".to_owned(),
            shape => format!("a {shape}"),
        }
    }
}

/// A form with the effect that it is.
#[derive(Clone, Debug)]
pub struct DrawnForm {
    /// What is said of it.
    pub report: FormReport,
    /// The same as an effect of one's own.
    pub definition: EffectDefinition,
    /// The model with it in place of the shapes, on the rows that it was drawn from.
    pub fitted: Fit,
}

/// Draws the form of the structure that a calibration of these rows found and could not name; `None` if it found none, or none
/// of the library explains any of it.
pub fn draw_form(rows: &[PlateauRow], selection: &Selection, data: &Observations) -> Option<DrawnForm> {
    let data = data.compacted();
    let weighed = Weighed::new(&data, selection.noise);
    let Best { first, found, rivals, explained, by_shapes } =
        best(selection.structure?.covariate, &selection.augmented.model, &weighed)?;
    let shape = shape_of(&first, &found);
    let known = &selection.augmented.model.vocabulary;
    let definition = named(&first, &found, selection.structure?.covariate, &shape, known);
    let fitted = renamed(&found, &definition, known, &weighed)?;
    // Its constants are those that are told.
    let mut definition = named(&first, &fitted, selection.structure?.covariate, &shape, known);
    definition.drawn_from = readings_by_session(rows).into_values().collect();
    let at = fitted.model.term_offset(fitted.model.terms.len() - 1);
    let values = fitted.model.values();
    // Where the table does not tell where the form lies, its size is told where it was drawn, and nothing of its place.
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

/// The model with the best form in place of the shapes along a covariate, for a prediction and nothing else.
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
    /// The model with it, and without the shapes.
    found: Fit,
    rivals: Vec<FormRival>,
    /// Squares of the noise that it explains, and that the shapes do.
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

/// The same fit with the form under the name that it goes by, beside the effects that were known.
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

/// Candidates by what they would gain, with the model that has them all for its vocabulary.
struct Ranked<'a> {
    model: Model,
    scores: Vec<(&'a Candidate, EffectScore)>,
}

fn ranked<'a>(start: &Fit, weighed: &Weighed<'_>, candidates: &'a [Candidate]) -> Option<Ranked<'a>> {
    let own = candidates.iter().filter_map(|c| OwnEffect::new(c.definition.clone()).ok()).collect();
    let model = start.model.clone().among(&Vocabulary::built_in().with(own).ok()?);
    let fitted = Fit { model, ..start.clone() };
    let screen = Screen::new(&fitted, weighed);
    // Each has one start, its own: the library holds the places that are tried.
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

/// The best starts of each shape.
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

/// The best fit of each shape on each thing, the one with the least toll first.
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
    // Of forms that fit alike, one whose size is known goes first: the ends of another may lie anywhere between two readings.
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

/// Squares of the noise by which a form may fit worse than the best, which explains so many, and be its rival.
fn rival_bound(explained: f64) -> f64 {
    RIVAL.max(RIVAL_SHARE * explained)
}

/// Whether the interval of the size of a fit's last term does not reach zero. Sizes come first among the constants of a form.
fn size_is_known(fitted: &Fit, weighed: &Weighed<'_>) -> bool {
    let at = fitted.model.term_offset(fitted.model.terms.len() - 1);
    let half = interval_half_widths(fitted, weighed).get(at).copied();
    let size = fitted.model.values().get(at).copied();
    size.zip(half).is_some_and(|(size, half)| size.abs() > half)
}

/// Squares that are left, and what each constant costs: as the information criterion of Schwarz for some dozen series.
fn toll(candidate: &Candidate, fitted: &Fit) -> f64 {
    const PER_CONSTANT: f64 = 4.0;
    fitted.cost + PER_CONSTANT * candidate.definition.parameters.len() as f64
}

/// A bump whose size is negative is a dip.
fn shape_of(candidate: &Candidate, fitted: &Fit) -> String {
    let at = fitted.model.term_offset(fitted.model.terms.len() - 1);
    let is_dip = candidate.form.shape == "bump" && fitted.model.values().get(at).is_some_and(|a| *a < 0.0);
    (if is_dip { "dip" } else { candidate.form.shape }).to_owned()
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
