//! Tolerance for the approximate formulas of effects, whose residual must not be attributed to
//! another effect.
//!
//! Every effect in the model may bend by some tens of per cent along its covariate, with the load,
//! with the direction and from layout to layout. These bent copies are nuisance columns for all
//! further candidates (`model/doc/naming-an-effect.md`), with a prior around zero, so that a second
//! effect is detected if it is larger than the tolerance.

use super::model::{Model, Term};
use super::observations::Observations;
use crate::effects::Covariate;
use crate::table::Point;

/// Prior standard deviation of the relative bend.
pub(crate) const BEND: f64 = 0.15;

/// Returns bent copies of all effects of a model, in newtons per unit share. `predicted` are the
/// model's readings.
pub(crate) fn bent_copies(model: &Model, data: &Observations, predicted: &[f64]) -> Vec<Vec<f64>> {
    let mut all = Vec::new();
    for (index, term) in model.terms.iter().enumerate() {
        let Term::Named(effect) = term else { continue };
        if !effect.description().bends {
            continue;
        }
        let without = model.without_term(index).predict(&data.points);
        let trace: Vec<f64> = predicted.iter().zip(&without).map(|(a, b)| a - b).collect();
        let mut push = |bend: &dyn Fn(&Point) -> f64| {
            all.push(trace.iter().zip(&data.points).map(|(t, p)| t * bend(p)).collect());
        };
        let (low, high) = model.frame.load_range_n;
        let load = move |p: &Point| 2.0 * (p.load_n - low) / (high - low).max(1e-9) - 1.0;
        push(&load);
        push(&|p| load(p).powi(2));
        push(&|p| p.sign);
        push(&|p| p.sign * load(p));
        match effect.description().covariate {
            Covariate::Position => {
                for power in 1..=3 {
                    push(&|p| (2.0 * p.position - 1.0).powi(power));
                }
            }
            Covariate::Time => {
                for power in 1..=2 {
                    push(&|p| (2.0 * p.time - 1.0).powi(power));
                    push(&|p| (2.0 * p.travel - 1.0).powi(power));
                }
            }
            Covariate::Repetition => {
                for settled in [1.0, 5.0] {
                    push(&|p| libm::exp(-(p.repetition - 1.0) / settled));
                }
            }
            Covariate::Speed => push(&|p| 5.0 * p.log_speed),
            Covariate::Dwell => push(&|p| p.log_dwell),
            Covariate::Load | Covariate::Condition => {
                for condition in &model.frame.conditions {
                    if condition.device.is_some() {
                        push(&|p| {
                            f64::from(u8::from(model.frame.conditions[p.condition].pins == condition.pins))
                        });
                    }
                }
            }
            Covariate::Direction | Covariate::Sweep => {}
        }
    }
    all
}
