//! What is believed against scatter that would explain a table as well.

use super::explanation::{Explanation, explain, sharper_noise};
use super::fit::{Fit, fit, jacobian};
use super::levels::Levels;
use super::noise::Noise;
use super::observations::Observations;
use super::screening::Screen;
use super::unnamed::Context;
use super::variance_components::{Scatter, shared_again};
use super::weighed::Weighed;
use crate::parallel::both;

/// Evidence by which believing less may be behind and still be searched for.
const WORTH_A_SEARCH: f64 = 25.0;

/// Whether scatter from mount to mount, or offsets that wander from series to series, explain a table as well as what
/// was believed without them. Their groups are few, so that no variance is known well: they compete as explanations.
pub(super) fn against_scatter(free: Explanation, data: &Observations, levels: Levels) -> Explanation {
    let beside = |scatter: Scatter, fitted: &Fit, noise| {
        let predicted: Vec<f64> = data.force_n.iter().zip(&fitted.residual_n).map(|(y, r)| y - r).collect();
        let own = jacobian(&fitted.model, data, &predicted);
        scatter.estimated(data, &fitted.residual_n, &own, noise)
    };
    // What is believed is kept, and the scatter beside it estimated.
    let at = |explanation: &Explanation, noise| {
        let weighed = Weighed::new(data, noise);
        let (baseline, augmented) = both(
            || fit(&explanation.baseline.model, &weighed),
            || fit(&explanation.augmented.model, &weighed),
        );
        Explanation { baseline, augmented, noise, ..explanation.clone() }
    };
    let with_scatter = |explanation: Explanation| {
        let noises = [explanation.noise, beside_own(&explanation, data)]
            .map(|noise| Scatter::ALL.iter().fold(noise, |n, s| beside(*s, &explanation.augmented, n)));
        let mut best = explanation.clone();
        for noise in noises.into_iter().filter(|noise| *noise != explanation.noise) {
            let with = at(&explanation, noise);
            if with.toll(data) < best.toll(data) {
                best = with;
            }
        }
        best
    };
    if free.augmented.model.terms.is_empty() {
        return with_scatter(free);
    }
    let bare = |noise| Scatter::ALL.iter().fold(noise, |n, scatter| scatter.left_out(n));
    let alone = Scatter::ALL.map(|scatter| beside(scatter, &free.baseline, bare(free.noise)));
    let mut best = with_scatter(free);
    for found in alone {
        let noise = Scatter::ALL.iter().fold(best.noise, |n, scatter| scatter.taken_from(found, n));
        if noise == bare(noise) {
            continue;
        }
        // The search is only worth its time if believing less than now comes near.
        let toll = best.toll(data);
        if !best.with_less().any(|less| less.at(data, noise).toll(data) < toll + WORTH_A_SEARCH) {
            continue;
        }
        let other = explain(&best.baseline.model, data, noise, levels);
        let other = with_scatter(other);
        if other.toll(data) < best.toll(data) {
            best = other;
        }
    }
    // Names were preferred to shapes before it was known that they need scatter beside them. What they gain by bending
    // their forms speaks for no shape: a half wave along the stroke is what `stroke_position` may look like.
    if best.names() > 0 && best.noise != bare(best.noise) {
        let bent_gain = Screen::guarded(&best.augmented, &Weighed::new(data, best.noise)).bent_gain();
        let least = best.toll(data) - bent_gain;
        let shape = shape_alone(&best, data, levels).map(with_scatter);
        best = shape.filter(|shape| shape.toll(data) < least).unwrap_or(best);
    }
    best
}

/// What series share beside the model's own columns alone. Before anything was searched for, all that might explain the
/// table was taken out first, or a missing effect would have been called noise; so many columns leave little to tell the
/// friction scale of the series by, which is then taken for that of their mounts.
fn beside_own(explanation: &Explanation, data: &Observations) -> Noise {
    let fitted = &explanation.augmented;
    let predicted: Vec<f64> = data.force_n.iter().zip(&fitted.residual_n).map(|(y, r)| y - r).collect();
    let own = jacobian(&fitted.model, data, &predicted);
    let bare = Scatter::ALL.iter().fold(explanation.noise, |noise, scatter| scatter.left_out(noise));
    shared_again(data, &fitted.residual_n, &own, bare)
}

/// The best shape alone, with the noise that is beside it and without scatter: what stands against names that need
/// scatter beside them.
fn shape_alone(named: &Explanation, data: &Observations, levels: Levels) -> Option<Explanation> {
    let bare = Scatter::ALL.iter().fold(named.noise, |n, scatter| scatter.left_out(n));
    let baseline = fit(&named.baseline.model, &Weighed::new(data, bare));
    let (sharper, shapes) = sharper_noise(&baseline, data, bare);
    let noise = sharper?;
    let weighed = Weighed::new(data, noise);
    let baseline = fit(&baseline.model, &weighed);
    let left = Screen::new(&baseline, &weighed).structures();
    let context = Context { weighed: &weighed, levels, explained: 0.0 };
    let (augmented, structure) = context.with_unnamed(&baseline, baseline.clone(), &left, 0.0);
    Some(Explanation {
        baseline,
        augmented,
        structure: Some(structure?),
        structure_gain: left.first().map_or(0.0, |s| s.gain),
        structures_tried: shapes.len(),
        noise,
        isolated: None,
    })
}
