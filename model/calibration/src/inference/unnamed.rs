//! Structure that no name explains: found, compared with the names, corrected by smooth shapes.

use super::fit::{Fit, fit};
use super::forward::Term;
use super::noise::Noise;
use super::observations::Observations;
use super::screening::{Screen, StructureScore};
use super::selection::{Levels, named, search};
use super::significance::{degrees_of_freedom, gain_at};
use crate::effects::Covariate;

/// Adds a structure's shapes to a model and fits.
fn with_structure(from: &Fit, score: &StructureScore, data: &Observations, noise: Noise) -> Fit {
    let model = score
        .group
        .iter()
        .zip(&score.sizes)
        .fold(from.model.clone(), |m, (s, k)| m.with_term(Term::Structure(s.clone()), &[*k]));
    fit(&model, data, noise)
}

/// Looks for structure that no name explains, and lets it compete with the names from the start.
pub(super) fn unnamed(
    baseline: &Fit,
    found: Fit,
    left: &[StructureScore],
    bent_gain: f64,
    data: &Observations,
    noise: Noise,
    levels: Levels,
) -> (Fit, Option<(Covariate, f64)>) {
    let explained = baseline.cost - found.cost;
    // With few series chance reaches further: the level of the study holds for dozens of them.
    let degrees = degrees_of_freedom(data, baseline.model.coordinates.len());
    let chance = gain_at(levels.structure_p, left.len().max(1), degrees);
    let least = levels.structure.max(chance).max(levels.structure_share * explained);
    let alone = if found.model.terms.is_empty() {
        Vec::new()
    } else {
        Screen::new(baseline, data, noise).structures()
    };
    let mut best: Option<(Fit, Covariate, f64)> = None;
    let penalty = |f: &Fit| f.cost + levels.further * named(&f.model).len() as f64;
    // On top of the names.
    if let Some(score) = left.first().filter(|s| s.gain > least) {
        let with = with_structure(&found, score, data, noise);
        let gain = found.cost - with.cost;
        if gain > least {
            let pruned = drop_all_superfluous(with, data, noise, levels.further);
            best = Some((pruned, score.group[0].covariate, gain));
        }
    }
    // Instead of the names: the best shape alone, and names only on top of it.
    if let Some(score) = alone.first().filter(|s| s.gain > least) {
        let with = with_structure(baseline, score, data, noise);
        // One shape against several names: each name beyond the first must have paid for itself.
        let names = named(&found.model).len() as f64;
        // The names may bend their forms before the shape is said to fit better than they do.
        let margin = levels.outright + 0.06 * bent_gain - 12.0 * (names - 1.0);
        if with.cost < found.cost - bent_gain - margin || best.is_some() {
            let gain = baseline.cost - with.cost;
            let extended = search(&with, data, noise, levels);
            let pruned = drop_all_superfluous(extended, data, noise, levels.further);
            if best.as_ref().is_none_or(|(b, _, _)| penalty(&pruned) < penalty(b)) {
                best = Some((pruned, score.group[0].covariate, gain));
            }
        }
    }
    match best {
        Some((with, covariate, gain)) => {
            let corrected = smooth(with, data, noise);
            let least = levels.further.max(0.01 * (baseline.cost - corrected.cost));
            (drop_all_superfluous(corrected, data, noise, least), Some((covariate, gain)))
        }
        None => (found, None),
    }
}

/// Drops any named effect that is superfluous next to a structure.
fn drop_all_superfluous(mut current: Fit, data: &Observations, noise: Noise, least: f64) -> Fit {
    loop {
        let cheapest = (0..current.model.terms.len())
            .filter(|i| matches!(current.model.terms[*i], Term::Named(_)))
            .map(|i| fit(&current.model.without_term(i), data, noise))
            .min_by(|a, b| a.cost.total_cmp(&b.cost));
        match cheapest {
            Some(without) if without.cost - current.cost < least => current = without,
            _ => return current,
        }
    }
}

/// Refines the data-driven correction: more shapes while each gains clearly.
fn smooth(mut current: Fit, data: &Observations, noise: Noise) -> Fit {
    for _ in 0..4 {
        let scores = Screen::new(&current, data, noise).structures();
        let Some(score) = scores.first().filter(|s| s.gain > 30.0) else { break };
        let with = with_structure(&current, score, data, noise);
        if current.cost - with.cost < 25.0 {
            break;
        }
        current = with;
    }
    current
}
