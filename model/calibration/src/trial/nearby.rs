//! Search for a hypothesised effect at a slightly different place: the location of a step or a dip
//! is known only as well as the readings around it, but a trial fixes it at its start value.

use super::claim::claimed;
use super::{CONFIRMED_SHARE, Claim};
use crate::effects::EffectDefinition;
use crate::inference::{Selection, Term, Weighed, fit};

/// Smallest reduction of the deviance, since a free shape finds something in any noise.
const GAINS: f64 = 30.0;
/// Largest displacement, as a share of the bounds of each shape.
const ELSEWHERE: f64 = 0.1;
/// Displacements of one shape that are tried, as shares of that.
const PLACES: [f64; 4] = [-1.0, -0.5, 0.5, 1.0];

/// Returns the note about a derived form that is found close to its original place; `None` if it is
/// not.
pub(super) fn nearby(
    definition: &EffectDefinition,
    claim: Claim,
    selection: &Selection,
    weighed: &Weighed<'_>,
) -> Option<String> {
    let all = &selection.augmented.model;
    let effect = all.vocabulary.named(&definition.id)?;
    let is_of_it = |term: &Term| match term {
        Term::Named(named) => named.id() == definition.id,
        Term::Structure(_) => true,
    };
    let without = fit(&all.without_terms(is_of_it), weighed);
    let start = claimed(definition);
    let shapes: Vec<(usize, f64, f64)> = definition
        .parameters
        .iter()
        .enumerate()
        .filter_map(|(i, p)| p.bounds.map(|(low, high)| (i, low, high)))
        .collect();
    if !claim.was_drawn || shapes.is_empty() {
        return None;
    }
    let mut starts = vec![start.clone()];
    for (i, low, high) in &shapes {
        for place in PLACES {
            let moved = start[*i] + place * ELSEWHERE * (high - low);
            if *low < moved && moved < *high {
                let mut values = start.clone();
                values[*i] = moved;
                starts.push(values);
            }
        }
    }
    let fits =
        starts.iter().map(|values| fit(&without.model.with_term(Term::Named(effect), values), weighed));
    let at = without.model.values().len();
    let is_near = |values: &[f64]| {
        shapes
            .iter()
            .all(|(i, low, high)| (values[at + i] - start[*i]).abs() <= ELSEWHERE * (high - low) + 1e-9)
    };
    let near = fits.filter(|fitted| fitted.cost.is_finite() && is_near(&fitted.model.values()));
    let best = near.min_by(|a, b| a.cost.total_cmp(&b.cost))?;
    let values = best.model.values();
    let is_there = without.cost - best.cost > GAINS && values[at] / claim.start >= CONFIRMED_SHARE;
    is_there.then(|| {
        let told: Vec<String> = definition
            .parameters
            .iter()
            .enumerate()
            .map(|(i, p)| format!("{} = {:.4} {}", p.name, values[at + i], p.unit))
            .collect();
        format!("not at its original place, but a similar effect is nearby: {}", told.join(", "))
    })
}
