//! Sensitivity of a proposal to each parameter.

use schemars::JsonSchema;
use serde::Serialize;

use super::candidate::Trial;
use crate::config::Configuration;
use crate::request::{Parameter, Quantity};

/// Relative step: large enough to make the mesh of the physics insignificant, and small enough for
/// an almost linear curve.
const STEP: f64 = 0.02;

/// Derivatives with respect to one parameter, by central differences.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Sensitivity {
    /// The parameter.
    pub parameter: Parameter,
    /// Value of the parameter.
    pub value: f64,
    /// Change of the friction at the heaviest load, N per unit of the parameter.
    pub friction_n_per_unit: f64,
    /// Change of the threshold, N per unit of the parameter.
    pub threshold_n_per_unit: f64,
    /// Change of each target's quantity per unit of the parameter.
    pub targets_per_unit: Vec<f64>,
}

/// Returns the sensitivities of `configuration`, without parameters whose change cannot be
/// predicted.
pub(super) fn sensitivities(trial: &Trial<'_>, configuration: &Configuration) -> Vec<Sensitivity> {
    Parameter::ALL.iter().filter_map(|p| sensitivity(trial, configuration, *p)).collect()
}

fn sensitivity(
    trial: &Trial<'_>,
    configuration: &Configuration,
    parameter: Parameter,
) -> Option<Sensitivity> {
    let value = parameter.value(configuration);
    let step = STEP * value;
    let at = |value: f64| {
        let mut moved = configuration.clone();
        parameter.set(&mut moved, value);
        let part = trial.part(&moved)?;
        let mut curve = trial.belief.best(&part, &trial.loads_n)?;
        let values = trial.values(&mut curve, 1.0)?;
        let mut of = |quantity| curve.value(quantity, trial.range_n);
        Some((of(Quantity::MaxFriction)?, of(Quantity::Threshold)?, values))
    };
    // If one side cannot be predicted, since a pin would leave the wrap, a one-sided difference is
    // used.
    let (below, above) = (at(value - step), at(value + step));
    let sides = if below.is_some() && above.is_some() { 2.0 } else { 1.0 };
    let (low, high) = (below.or_else(|| at(value))?, above.or_else(|| at(value))?);
    let slope = |low: f64, high: f64| (high - low) / (sides * step);
    Some(Sensitivity {
        parameter,
        value,
        friction_n_per_unit: slope(low.0, high.0),
        threshold_n_per_unit: slope(low.1, high.1),
        targets_per_unit: low.2.iter().zip(&high.2).map(|(l, h)| slope(*l, *h)).collect(),
    })
}
