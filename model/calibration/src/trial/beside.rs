//! Context of a hypothesis: other effects of the table, and structure that the hypothesis does not
//! explain.

use super::IS_THAT;
use super::claim::{Found, ask, claimed, with_claim};
use crate::effects::{Effect, EffectDefinition};
use crate::inference::{Fit, Screen, Selection, Term, Weighed, dot, fit, with_what_is_left};

/// Cosine of two traces above which they count as equal.
const SAME_TRACE: f64 = 0.95;
/// Cosine above which two effects are the same thing under two ids, which no table separates.
const SAME_THING: f64 = 0.999;
/// Difference of the deviance by which one of two explanations must be better.
const TOLD_APART: f64 = 9.0;

/// Test of a hypothesis in its context.
pub(super) struct Beside {
    pub(super) found: Found,
    /// Covariate of the structure that is kept in the model, because the hypothesis does not
    /// explain it.
    pub(super) structure: Option<&'static str>,
    /// Effects that explain the table in place of the hypothesis, and how well.
    pub(super) rival: Option<(String, InItsPlace)>,
    /// Share of the gain of the shapes that the hypothesis explains in their place, if there are
    /// shapes.
    pub(super) explains: Option<f64>,
}

/// Comparison of other effects with the hypothesis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum InItsPlace {
    /// Equally good: the table does not separate the two.
    AsWell,
    /// Better: it is kept in the model.
    Better,
}

/// Tests a hypothesis. Effects that are its rivals, or have the same trace, would absorb the effect
/// under test; they are removed, the others stay. Structure is also removed while the hypothesis
/// may explain it.
pub(super) fn beside(
    definition: &EffectDefinition,
    selection: &Selection,
    weighed: &Weighed<'_>,
) -> Option<Beside> {
    let all = &selection.augmented.model;
    let effect = all.vocabulary.named(&definition.id)?;
    let alone = all.without_terms(|_| true);
    let screen_on = fit(&alone, weighed);
    let screen = Screen::new(&screen_on, weighed);
    let own = screen.effect_at(effect, claimed(definition))?.column;
    let is_rival = |id: &str| {
        selection.effects.iter().any(|e| e.effect.id() == id && e.ids().contains(&definition.id.as_str()))
    };
    let (values, mut aside) = (all.values(), Vec::new());
    for (i, term) in all.terms.iter().enumerate() {
        let Term::Named(named) = term else { continue };
        let at = all.term_offset(i);
        let constants = values[at..at + term.constants()].to_vec();
        let leaves_the_same = || {
            let other = screen.effect_at(*named, constants).map(|score| score.column);
            other.is_some_and(|other| cosine(&own, &other) > SAME_TRACE)
        };
        if is_rival(named.id()) || leaves_the_same() {
            aside.push(named.id());
        }
    }
    let is_aside = |term: &Term| matches!(term, Term::Named(e) if aside.contains(&e.id()));
    let named = fit(&all.without_terms(|t| is_aside(t) || matches!(t, Term::Structure(_))), weighed);
    let is_the_same = |other: &'static dyn Effect| {
        let mut anywhere = other.starts(&all.frame).into_iter().filter_map(|s| screen.effect_at(other, s));
        anywhere.any(|score| cosine(&own, &score.column) > SAME_THING)
    };
    let known = named.model.named_effects();
    let is_another = |(_, other, _): &(String, Fit, InItsPlace)| {
        let mut added = other.model.named_effects().into_iter();
        added.all(|e| known.iter().any(|k| k.id() == e.id()) || !is_the_same(e))
    };
    let rival = in_its_place(definition, effect, selection, &named, &aside, weighed).filter(is_another);
    if let Some((name, other, InItsPlace::Better)) = rival {
        let found = ask(definition, effect, &other, weighed)?;
        return Some(Beside {
            found,
            structure: None,
            rival: Some((name, InItsPlace::Better)),
            explains: None,
        });
    }
    let rival = rival.map(|(name, _, how)| (name, how));
    let first = ask(definition, effect, &named, weighed)?;
    let mut plain = Beside { found: first, structure: None, rival, explains: None };
    if selection.structure.is_none() && !all.terms.iter().any(|t| matches!(t, Term::Structure(_))) {
        return Some(plain);
    }
    // The hypothesis is what was found there if it explains most of the shapes' gain.
    let with_shapes = fit(&all.without_terms(is_aside), weighed);
    let with = with_claim(definition, effect, &named.model, weighed);
    let share = IS_THAT[usize::from(definition.drawn_from.is_empty())];
    let explained = (named.cost - with.cost) / (named.cost - with_shapes.cost).max(1e-9);
    if explained >= share {
        plain.explains = Some(explained);
        return Some(plain);
    }
    Some(beside_structure(definition, effect, with, weighed).unwrap_or(plain))
}

/// Returns the effects that explain most in place of the hypothesis, with their fit, unless the
/// hypothesis explains more: the removed effects, and the rivals of the hypothesis if it was
/// selected. Its shapes are free for the comparison, as theirs are.
fn in_its_place(
    definition: &EffectDefinition,
    effect: &'static dyn Effect,
    selection: &Selection,
    named: &Fit,
    aside: &[&'static str],
    weighed: &Weighed<'_>,
) -> Option<(String, Fit, InItsPlace)> {
    let all = &selection.augmented.model;
    let others: Vec<&str> = aside.iter().copied().filter(|id| *id != definition.id).collect();
    let mut found: Vec<(String, Fit)> = Vec::new();
    if !others.is_empty() {
        let is_other = |term: &Term| matches!(term, Term::Named(e) if e.id() != definition.id);
        found.push((others.join(" and "), fit(&all.without_terms(|term| !is_other(term)), weighed)));
    }
    let claims = selection.effects.iter().filter(|e| e.effect.id() == definition.id);
    for rival in claims.flat_map(|e| &e.rivals) {
        let start = rival.effect.starts(&all.frame).into_iter().next()?;
        let with = fit(&named.model.with_term(Term::Named(rival.effect), &start), weighed);
        found.push((rival.effect.id().to_owned(), with));
    }
    let (name, other) = found.into_iter().min_by(|(_, a), (_, b)| a.cost.total_cmp(&b.cost))?;
    let free = fit(&named.model.with_term(Term::Named(effect), &claimed(definition)), weighed);
    let claim = with_claim(definition, effect, &named.model, weighed).cost.min(free.cost);
    match claim - other.cost {
        behind if behind > TOLD_APART => Some((name, other, InItsPlace::Better)),
        behind if behind > -TOLD_APART => Some((name, other, InItsPlace::AsWell)),
        _ => None,
    }
}

/// Tests the hypothesis in the presence of the structure that remains once it is in the model;
/// `None` if none remains.
fn beside_structure(
    definition: &EffectDefinition,
    effect: &'static dyn Effect,
    with_claim: Fit,
    weighed: &Weighed<'_>,
) -> Option<Beside> {
    let before = with_claim.model.terms.len();
    let left = with_what_is_left(with_claim, weighed);
    let structure = left.model.terms[before..].iter().find_map(|term| match term {
        Term::Structure(s) => Some(s.covariate.as_str()),
        Term::Named(_) => None,
    })?;
    let without =
        fit(&left.model.without_terms(|t| matches!(t, Term::Named(e) if e.id() == definition.id)), weighed);
    let found = ask(definition, effect, &without, weighed)?;
    Some(Beside { found, structure: Some(structure), rival: None, explains: None })
}

fn cosine(a: &[f64], b: &[f64]) -> f64 {
    (dot(a, b) / (dot(a, a) * dot(b, b)).sqrt().max(1e-300)).abs()
}
