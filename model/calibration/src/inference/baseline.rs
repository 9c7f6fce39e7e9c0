//! The refitted baseline, and columns that could explain its residuals.

use super::fit::{Fit, fit, jacobian};
use super::model::{Model, Term};
use super::observations::Observations;
use super::weighed::Weighed;
use crate::effects::effect_named;

/// Fits the paper's model from several starts, since a local minimum is indistinguishable from
/// missing physics.
pub(super) fn fit_baseline(model: &Model, weighed: &Weighed<'_>) -> Fit {
    let mut best = fit(model, weighed);
    for factor in [0.75f64, 1.3] {
        let mut other = best.model.clone();
        for device in 0..other.frame.devices() {
            let [half_load, _] = Model::device_constants(device);
            other.coordinates[half_load] += libm::log(factor);
        }
        let other = fit(&other, weighed);
        if other.cost < best.cost {
            best = other;
        }
    }
    best
}

/// Number of series and directions below which only the model's own columns are projected out
/// before the noise is estimated.
const MIN_CELLS: usize = 50;

/// Most columns of user-defined effects, since many effects with many starts would leave no noise.
const OWN_COLUMNS: usize = 48;

/// Series and directions that must remain in addition to an offset, a drag and a gain.
const MIN_BESIDE: usize = 11;

/// Returns whether columns of effects are projected out before the noise is estimated.
pub(super) fn takes_names_out(data: &Observations) -> bool {
    data.cells.len() >= MIN_CELLS
}

/// Returns columns in newtons that could explain residuals: the model's own, those of the effects,
/// and coarse structure.
pub(super) fn explainable(fitted: &Fit, data: &Observations) -> Vec<Vec<f64>> {
    let predicted: Vec<f64> = data.force_n.iter().zip(&fitted.residual_n).map(|(y, r)| y - r).collect();
    let mut columns = jacobian(&fitted.model, data, &predicted);
    // So many columns would explain a few series completely and leave no noise to estimate.
    if !takes_names_out(data) {
        // A common change of all readings would still count as scatter of the series, since their
        // mean is not zero.
        if data.cells.len() > columns.len() + MIN_BESIDE {
            columns.push(vec![1.0; data.points.len()]);
            columns.push(data.points.iter().map(|p| p.sign).collect());
            columns.push(predicted);
        }
        return columns;
    }
    let vocabulary = &fitted.model.vocabulary;
    let own = vocabulary.own().count().max(1);
    for effect in vocabulary.acting_order() {
        let most = if effect_named(effect.id()).is_some() { usize::MAX } else { (OWN_COLUMNS / own).max(1) };
        for start in effect.starts(&fitted.model.frame).into_iter().take(most) {
            let changed = fitted.model.with_term(Term::Named(*effect), &start).predict(&data.points);
            columns.push(changed.iter().zip(&predicted).map(|(c, p)| c - p).collect());
        }
    }
    for condition in 0..fitted.model.frame.conditions.len() {
        for sign in [-1.0, 1.0] {
            columns.push(
                data.points
                    .iter()
                    .map(|p| f64::from(u8::from(p.condition == condition && p.sign * sign > 0.0)))
                    .collect(),
            );
        }
    }
    columns
}
