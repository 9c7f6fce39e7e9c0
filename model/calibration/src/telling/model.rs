//! Report of a fitted model: constants and errors.

use pinswitch_friction::Substrate;

use crate::held_out::HeldOut;
use crate::inference::{Fit, Weighed};
use crate::layouts_left_out::layouts_left_out;
use crate::report::{Estimate, ModelReport};
use crate::table::Condition;

/// Returns a constant with its interval, limited to the bounds of a shape.
fn estimate(value: f64, [below, above]: [f64; 2], unit: &str, (least, most): (f64, f64)) -> Estimate {
    let ci95 = [(value - below).max(least), (value + above).min(most)];
    Estimate { value, ci95, unit: unit.to_owned() }
}

/// Returns the report of a fitted model; `reaches` returns the distances from each constant to the
/// ends of its interval.
pub(crate) fn model_report(
    fitted: &Fit,
    weighed: &Weighed<'_>,
    held: HeldOut,
    reaches: impl Fn(&Fit, &Weighed<'_>) -> Vec<[f64; 2]>,
) -> ModelReport {
    let data = weighed.data;
    let sound = (0..data.points.len()).filter(|i| data.is_sound(*i));
    let rmse_n = data.root_mean_square_n(sound.map(|i| (i, fitted.residual_n[i])));
    let reaches = reaches(fitted, weighed);
    let conditions = &fitted.model.frame.conditions;
    let is_used = |name: &str| match name {
        "mu_p" => conditions.iter().any(Condition::has_pins),
        "mu_s" => conditions.iter().any(|c| c.substrate == Some(Substrate::Silicone)),
        _ => true,
    };
    let parameters = fitted
        .model
        .names()
        .into_iter()
        .zip(fitted.model.values().into_iter().zip(reaches))
        .enumerate()
        .filter(|(_, ((name, _), _))| is_used(name))
        .map(|(i, ((name, unit), (value, reach)))| {
            // The table does not determine a constant that is fixed at its hypothesised value.
            let reach = if fitted.model.is_held(i) { [f64::INFINITY; 2] } else { reach };
            (name, estimate(value, reach, unit, fitted.model.bounds_of(i)))
        })
        .collect();
    ModelReport {
        rmse_n: if rmse_n.is_nan() { 0.0 } else { rmse_n },
        heldout_rmse_n: held.both_n(),
        heldout_series_rmse_n: held.series_n,
        heldout_loads_rmse_n: held.loads_n,
        heldout_layouts_rmse_n: layouts_left_out(&fitted.model, weighed),
        parameters,
    }
}
