//! Comparison of an explanation with scatter that explains the table equally well.

use super::explanation::{Explanation, explain};
use super::fit::{Fit, fit, jacobian};
use super::levels::Levels;
use super::noise::Noise;
use super::observations::Observations;
use super::scatter::Scatter;
use super::screening::Screen;
use super::sharper_noise::sharper_noise;
use super::unnamed::Context;
use super::variance_components::shared_again;
use super::weighed::Weighed;
use crate::parallel::both;

/// Deficit of evidence of a simpler explanation up to which it is worth a search.
const WORTH_A_SEARCH: f64 = 25.0;

/// Compares an explanation with mount effects and with drifting offsets between series, which may
/// explain a table equally well. Their groups are few, so that their variances are poorly known;
/// they compete as explanations.
pub(super) fn against_scatter(free: Explanation, data: &Observations, levels: Levels) -> Explanation {
    if free.augmented.model.terms.is_empty() {
        return with_scatter(free, data);
    }
    let bare = |noise| Scatter::ALL.iter().fold(noise, |n, scatter| scatter.left_out(n));
    let alone = Scatter::ALL.map(|scatter| beside(scatter, data, &free.baseline, bare(free.noise)));
    let mut best = or_names_alone(free, data);
    for found in alone {
        let noise = Scatter::ALL.iter().fold(best.noise, |n, scatter| scatter.taken_from(found, n));
        if noise == bare(noise) {
            continue;
        }
        // The search is only worth its time if a simpler explanation is close.
        let toll = best.toll(data);
        if !best.with_less().any(|less| less.at(data, noise).toll(data) < toll + WORTH_A_SEARCH) {
            continue;
        }
        let other = explain(&best.baseline.model, data, noise, levels);
        let other = or_names_alone(other, data);
        if other.toll(data) < best.toll(data) {
            best = other;
        }
    }
    best = without_what_scatter_replaces(best, data);
    // Effects were preferred to shapes before it was known that they need additional scatter. Their
    // gain from bending is not evidence for a shape: half a wave along the stroke resembles
    // `stroke_position`.
    if best.names() > 0 && best.noise != bare(best.noise) {
        let bent_gain = Screen::guarded(&best.augmented, &Weighed::new(data, best.noise)).bent_gain();
        let least = best.toll(data) - bent_gain;
        let shape = shape_alone(&best, data, levels).map(|shape| with_scatter(shape, data));
        best = shape.filter(|shape| shape.toll(data) < least).unwrap_or(best);
    }
    best
}

/// Returns the noise with one scatter estimated from the residuals of a fit.
fn beside(scatter: Scatter, data: &Observations, fitted: &Fit, noise: Noise) -> Noise {
    let predicted: Vec<f64> = data.force_n.iter().zip(&fitted.residual_n).map(|(y, r)| y - r).collect();
    let own = jacobian(&fitted.model, data, &predicted);
    scatter.estimated(data, &fitted.residual_n, &own, noise)
}

/// Adds the scatter that makes the table more probable under the same model.
fn with_scatter(explanation: Explanation, data: &Observations) -> Explanation {
    let noises = [explanation.noise, beside_own(&explanation, data)]
        .map(|noise| Scatter::ALL.iter().fold(noise, |n, s| beside(*s, data, &explanation.augmented, n)));
    let mut best = explanation.clone();
    for noise in noises.into_iter().filter(|noise| *noise != explanation.noise) {
        let weighed = Weighed::new(data, noise);
        let (baseline, augmented) = both(
            || fit(&explanation.baseline.model, &weighed),
            || fit(&explanation.augmented.model, &weighed),
        );
        let with = Explanation { baseline, augmented, noise, ..explanation.clone() };
        if with.toll(data) < best.toll(data) {
            best = with;
        }
    }
    best
}

/// Returns the explanation with its scatter, or its effects alone with theirs: shapes that were
/// found before the scatter was known may be part of it, or may have replaced an effect.
fn or_names_alone(explanation: Explanation, data: &Observations) -> Explanation {
    let plain = explanation.names_alone().map(|e| e.at(data, e.noise));
    let best = with_scatter(explanation, data);
    match plain.map(|plain| with_scatter(plain, data)) {
        Some(plain) if plain.toll(data) < best.toll(data) => plain,
        _ => best,
    }
}

/// Removes effects and shapes that are less probable than more scatter in their place.
fn without_what_scatter_replaces(mut best: Explanation, data: &Observations) -> Explanation {
    loop {
        let (toll, terms) = (best.toll(data), best.augmented.model.terms.len());
        let less = best
            .with_less()
            .filter(|less| less.augmented.model.terms.len() < terms)
            .map(|less| less.at(data, best.noise))
            .filter(|less| less.toll(data) < toll + WORTH_A_SEARCH)
            .map(|less| with_scatter(less, data))
            .min_by(|a, b| a.toll(data).total_cmp(&b.toll(data)));
        match less.filter(|less| less.toll(data) < toll) {
            Some(less) => best = less,
            None => return best,
        }
    }
}

/// Returns the noise common to the series, estimated with only the model's own columns projected
/// out. Before the search, all columns that might explain the table were projected out, lest a
/// missing effect inflate the noise; this leaves so little information on the friction scale of
/// series that the mount effect absorbs it.
fn beside_own(explanation: &Explanation, data: &Observations) -> Noise {
    let fitted = &explanation.augmented;
    let predicted: Vec<f64> = data.force_n.iter().zip(&fitted.residual_n).map(|(y, r)| y - r).collect();
    let own = jacobian(&fitted.model, data, &predicted);
    let bare = Scatter::ALL.iter().fold(explanation.noise, |noise, scatter| scatter.left_out(noise));
    shared_again(data, &fitted.residual_n, &own, bare)
}

/// Returns the best single shape with its noise and without scatter: the alternative to effects
/// that need additional scatter.
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
        named: baseline.model.clone(),
        baseline,
        augmented,
        structure: Some(structure?),
        structure_gain: left.first().map_or(0.0, |s| s.gain),
        structures_tried: shapes.len(),
        noise,
        isolated: None,
    })
}
