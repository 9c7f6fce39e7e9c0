//! What stands beside a claim: names that are not the same thing, and structure that the claim is no explanation of.

use super::IS_THAT;
use super::claim::{Found, ask, claimed, with_claim};
use crate::effects::{Effect, EffectDefinition};
use crate::inference::{Fit, Screen, Selection, Term, Weighed, dot, fit, with_what_is_left};

/// Cosine of two visible traces from which they are one.
const SAME_TRACE: f64 = 0.95;
/// Cosine from which two effects are the same thing under two names, which no table tells apart.
const SAME_THING: f64 = 0.999;
/// Squares of the noise by which one of two explanations must fit better to be told from the other.
const TOLD_APART: f64 = 9.0;

/// What a table says of a claim, beside what else it holds.
pub(super) struct Beside {
    pub(super) found: Found,
    /// Where structure lies that stood beside the claim, since it explains what the claim does not.
    pub(super) structure: Option<&'static str>,
    /// A name that explains the table in place of the claim, and how well.
    pub(super) rival: Option<(String, InItsPlace)>,
    /// Share of what shapes without a name do that the claim explains in their place, where there are such.
    pub(super) explains: Option<f64>,
}

/// How well a name explains what a claim is asked about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum InItsPlace {
    /// As well: the table cannot tell which of both it is.
    AsWell,
    /// Better: it stood beside the claim.
    Better,
}

/// Asks for a claim. Names that are its rivals, or leave its very trace, would take over what is on trial: they stand
/// aside, the others stay. So does structure without a name as long as the claim may be what it is.
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
    // The claim is what was found there if it explains most of what the shapes do.
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

/// The name that explains most in place of the claim, with its fit, unless the claim explains it better: those that stand
/// aside, and the rivals of the claim where that was found. Shapes of the claim are free, as theirs are.
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

/// The same beside the structure that is left once the claim is in the model; `None` if there is none.
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
