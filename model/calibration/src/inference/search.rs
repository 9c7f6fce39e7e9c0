//! Stepwise search among effects: forward, backward and exchange steps.

use pinswitch_friction::sort_by_number;

use super::fit::{Fit, fit, jacobian};
use super::levels::Levels;
use super::model::Term;
use super::reliability::Reliability;
use super::screening::{EffectScore, Screen};
use super::sign_flips::family_probability;
use super::significance::{degrees_of_freedom, family_p_value, gain_at};
use super::weighed::Weighed;
use crate::effects::Effect;
use crate::parallel::map_each;

/// Number of candidates of a scan that are fitted.
const FITTED: usize = 6;
/// Gain to first order, as a share of the largest, above which a candidate is fitted. In 651 scans
/// of 36 tables the best fit always had a share of at least 0.9.
const WORTH_A_FIT: f64 = 0.4;
/// Smallest share of its norm that an identifiable trace keeps after the refit.
pub(crate) const VISIBLE_SHARE: f64 = 2e-3;

/// Returns whether the effect of the last term has a possible size.
pub(super) fn possible(effect: &dyn Effect, fitted: &Fit) -> bool {
    let last = fitted.model.terms.len().saturating_sub(1);
    let size = fitted.model.values().get(fitted.model.term_offset(last)).copied();
    // A fit of a user-defined formula may have diverged.
    fitted.cost.is_finite() && (!effect.description().one_sided || size.is_some_and(|s| s > 0.0))
}

/// A model with one more effect.
struct Extension {
    score: EffectScore,
    fitted: Fit,
}

/// Returns fits of the most promising absent effects among those scored, best cost first.
fn extensions(
    mut scores: Vec<EffectScore>,
    from: &Fit,
    weighed: &Weighed<'_>,
    least: f64,
    beyond_form: f64,
    most: usize,
) -> Vec<Extension> {
    scores.retain(|s| s.gain > least);
    if !from.model.named_effects().is_empty() && scores.iter().any(|s| s.gain <= beyond_form) {
        // The part that bent effects of the model explain does not count for another effect.
        let guarded = Screen::guarded(from, weighed);
        scores.retain(|s| s.gain > beyond_form || guarded.effect(s.effect).is_some_and(|g| g.gain > least));
    }
    sort_by_number(&mut scores, |s| -s.gain);
    scores.truncate(most);
    let strongest = scores.first().map_or(0.0, |s| s.gain);
    scores.retain(|s| s.gain >= WORTH_A_FIT * strongest);
    let extended = |score: EffectScore| {
        let fitted = fit(&from.model.with_term(Term::Named(score.effect), &score.start), weighed);
        Extension { score, fitted }
    };
    let mut fits = map_each(scores, extended);
    fits.retain(|e| possible(e.score.effect, &e.fitted));
    sort_by_number(&mut fits, |e: &Extension| e.fitted.cost);
    fits
}

/// Returns whether a gain is not explained by chance over the vocabulary, given the uncertainty of
/// the noise along the effect's trace: a layout has few mounts, a repetition thousands of readings.
fn is_beyond_chance(
    score: &EffectScore,
    gain: f64,
    from: &Fit,
    weighed: &Weighed<'_>,
    levels: Levels,
) -> bool {
    let data = weighed.data;
    let predicted: Vec<f64> = data.force_n.iter().zip(&from.residual_n).map(|(y, r)| y - r).collect();
    let own = jacobian(&from.model, data, &predicted);
    let degrees =
        Reliability::new(data, weighed.noise, &own).degrees(data, &score.trace_n, score.strength.powi(2));
    family_p_value(gain, from.model.vocabulary.tries(), degrees) <= levels.first_p
}

/// Adds effects while each gains enough, then drops and exchanges.
pub(super) fn search(start: &Fit, weighed: &Weighed<'_>, levels: Levels) -> Fit {
    let mut current = start.clone();
    let degrees = degrees_of_freedom(weighed.data, start.model.coordinates.len());
    let first = gain_at(levels.first_p, start.model.vocabulary.tries(), degrees);
    let scores = Screen::new(start, weighed).effects();
    let strongest = scores.iter().map(|s| s.gain).fold(0.0, f64::max);
    // A weak candidate that depends on a few series is not an effect, whatever the noise model.
    // With few series, sign flips are not conclusive, and the noise model decides.
    if strongest < 3.0 * first && weighed.data.series >= 12 && flips(&scores) > levels.flips {
        return current;
    }
    let mut scores = Some(scores);
    for _ in 0..4 {
        let scores = scores.take().unwrap_or_else(|| Screen::new(&current, weighed).effects());
        let gained = bendable_gain(start, &current, weighed);
        let least = if current.model.named_effects().is_empty() {
            first
        } else {
            first.max(levels.further).max(levels.further_share * gained)
        };
        // To first order only, since a nonlinear effect may gain more once fitted.
        let screened = if current.model.named_effects().is_empty() { 0.3 } else { 0.8 } * least;
        let Some(best) =
            extensions(scores, &current, weighed, screened, levels.beyond_bending(gained), FITTED)
                .into_iter()
                .next()
        else {
            break;
        };
        let gain = current.cost - best.fitted.cost;
        if gain < least || !is_beyond_chance(&best.score, gain, &current, weighed, levels) {
            break;
        }
        current = best.fitted;
        current = exchange(current, weighed, levels.beyond_bending(gained));
        current = prune(current, weighed, levels.further.max(levels.further_share * gained), 1);
    }
    current
}

/// Returns the reduction of the deviance by the effects with approximate formulas, whose residuals
/// may be their own. A constant force leaves none, however large it is.
pub(super) fn bendable_gain(start: &Fit, found: &Fit, weighed: &Weighed<'_>) -> f64 {
    let rigid: Vec<_> = found.model.named_effects().into_iter().filter(|e| !e.description().bends).collect();
    if rigid.is_empty() || found.model.named_effects().is_empty() {
        return start.cost - found.cost;
    }
    if rigid.len() == found.model.named_effects().len() {
        return 0.0;
    }
    let mut without = found.model.clone();
    for index in (0..without.terms.len()).rev() {
        if matches!(&without.terms[index], Term::Named(e) if e.description().bends) {
            without = without.without_term(index);
        }
    }
    (fit(&without, weighed).cost - found.cost).max(0.0)
}

/// Returns the probability of the scores by sign flips.
pub(super) fn flips(scores: &[EffectScore]) -> f64 {
    let contributions: Vec<&[f64]> =
        scores.iter().filter(|s| s.visible_share > VISIBLE_SHARE).map(|s| s.by_series.as_slice()).collect();
    family_probability(&contributions)
}

/// Drops effects that the others have made superfluous, down to `keep` of them.
pub(super) fn prune(mut current: Fit, weighed: &Weighed<'_>, least: f64, keep: usize) -> Fit {
    while current.model.named_effects().len() > keep {
        let named =
            (0..current.model.terms.len()).filter(|i| matches!(current.model.terms[*i], Term::Named(_)));
        let cheapest = map_each(named.collect(), |i| fit(&current.model.without_term(i), weighed))
            .into_iter()
            .min_by(|a, b| a.cost.total_cmp(&b.cost));
        match cheapest {
            Some(without) if without.cost - current.cost < least => current = without,
            _ => break,
        }
    }
    current
}

/// Replaces an effect by another one that fits better in its place.
fn exchange(mut current: Fit, weighed: &Weighed<'_>, beyond_form: f64) -> Fit {
    if current.model.named_effects().len() < 2 {
        return current;
    }
    for _ in 0..2 {
        let mut better = None;
        for i in 0..current.model.terms.len() {
            if matches!(current.model.terms[i], Term::Named(_)) {
                let without = fit(&current.model.without_term(i), weighed);
                let id = current.model.terms[i].id();
                let scores = Screen::new(&without, weighed).effects();
                for other in extensions(scores, &without, weighed, 8.0, beyond_form, 4) {
                    if other.score.effect.id() != id && other.fitted.cost < current.cost - 1.0 {
                        better = Some(other.fitted);
                        break;
                    }
                }
                if better.is_some() {
                    break;
                }
            }
        }
        match better {
            Some(fit) => current = fit,
            None => break,
        }
    }
    current
}
