//! What stands beside a claim: names that are not the same thing, and structure that the claim is no explanation of.

use super::IS_THAT;
use super::claim::{Found, ask, claimed, with_claim};
use crate::effects::{Effect, EffectDefinition};
use crate::inference::{Fit, Screen, Selection, Term, Weighed, dot, fit, with_what_is_left};

/// Cosine of two visible traces from which they are one.
const SAME_TRACE: f64 = 0.95;

/// What a table says of a claim, beside what else it holds.
pub(super) struct Beside {
    pub(super) found: Found,
    /// Where structure lies that stood beside the claim, since it explains what the claim does not.
    pub(super) structure: Option<&'static str>,
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
    let first = ask(definition, effect, &named, weighed)?;
    let plain = Beside { found: first, structure: None };
    if selection.structure.is_none() && !all.terms.iter().any(|t| matches!(t, Term::Structure(_))) {
        return Some(plain);
    }
    // The claim is what was found there if it explains most of what the shapes do.
    let with_shapes = fit(&all.without_terms(is_aside), weighed);
    let with = with_claim(definition, effect, &named.model, weighed);
    let share = IS_THAT[usize::from(definition.drawn_from.is_empty())];
    if named.cost - with.cost >= share * (named.cost - with_shapes.cost) {
        return Some(plain);
    }
    Some(beside_structure(definition, effect, with, weighed).unwrap_or(plain))
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
    Some(Beside { found, structure: Some(structure) })
}

fn cosine(a: &[f64], b: &[f64]) -> f64 {
    (dot(a, b) / (dot(a, a) * dot(b, b)).sqrt().max(1e-300)).abs()
}
