//! Proposed designs with their reported properties.

use std::collections::BTreeMap;

use pinswitch_friction::PredictionStatus;
use pinswitch_friction::layout_search::LayoutCandidate;
use schemars::JsonSchema;
use serde::Serialize;

use super::candidate::{Draw, Trial, outer_width_mm};
use super::curve::Curve;
use super::linear::{Linear, VarianceShare};
use super::probability::{Probability, probability};
use super::sensitivity::{Sensitivity, sensitivities};
use crate::config::Configuration;
use crate::design::Design;
use crate::feasibility::is_feasible;
use crate::request::{Parameter, Quantity, Target};

/// A target with the result of a proposal.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct TargetResult {
    /// The target.
    #[serde(flatten)]
    pub target: Target,
    /// Best estimate.
    pub value: f64,
    /// 2.5 % and 97.5 % quantiles over made parts.
    pub band: [f64; 2],
    /// Whether the best estimate meets the target.
    pub is_met: bool,
    /// Share of made parts that meet the target.
    pub probability: f64,
}

/// A configuration with its reported properties.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Proposal {
    /// Occupied grooves.
    pub pins: Vec<usize>,
    /// Continuous parameters by name.
    pub parameters: BTreeMap<&'static str, f64>,
    /// Diameter of rope and thickness of its coating, mm.
    pub tendon_mm: [f64; 2],
    /// Radius of the assembled switch, mm.
    pub outer_radius_mm: f64,
    /// Width of the assembled switch, mm.
    pub outer_width_mm: f64,
    /// Prediction status over the requested loads.
    pub trust: PredictionStatus,
    /// Best estimate of the threshold, N; absent if it is outside the loads.
    pub threshold_n: Option<f64>,
    /// Best estimate of the friction at the heaviest load, N.
    pub friction_n: f64,
    /// Probability that a made part meets the request.
    pub probability: Probability,
    /// Standard error of that probability for the number of draws.
    pub standard_error: f64,
    /// Results by target.
    pub targets: Vec<TargetResult>,
    /// Index of the target that is met least often.
    pub tightest: usize,
    /// Sources of the uncertainty of that target, the largest first.
    pub uncertainty: Vec<VarianceShare>,
    /// Sensitivity to each parameter.
    pub sensitivity: Vec<Sensitivity>,
    /// The configuration.
    #[serde(skip)]
    pub configuration: Configuration,
}

/// Returns the proposal of a configuration; `None` if it cannot be built or predicted.
pub(super) fn propose(trial: &Trial<'_>, configuration: &Configuration, draws: &[Draw]) -> Option<Proposal> {
    let mut configuration = configuration.clone();
    configuration.layout.substrate = pinswitch_friction::Substrate::Silicone;
    configuration.layout.pins.sort_unstable();
    let design = Design::new(configuration.clone()).ok().filter(|_| is_feasible(&configuration))?;
    let part = trial.part(&configuration)?;
    let mut curve = trial.belief.best(&part, &trial.loads_n)?;
    let settled = trial.settled(&part, &mut curve)?;
    let values = trial.values(&mut curve, settled)?;
    let linear = Linear::of(trial, &configuration)?;
    let probability = probability(trial, &configuration, draws)?;
    let targets: Vec<TargetResult> = trial
        .request
        .targets
        .iter()
        .enumerate()
        .map(|(i, target)| TargetResult {
            target: *target,
            value: values[i],
            band: probability.band[i],
            is_met: target.requirement.is_met(values[i]),
            probability: probability.each[i],
        })
        .collect();
    let tightest =
        (0..targets.len()).min_by(|a, b| targets[*a].probability.total_cmp(&targets[*b].probability))?;
    let switching = curve.switching()?;
    let threshold_n = switching.threshold_n * settled;
    let within = switching.is_found && (trial.range_n.0..=trial.range_n.1).contains(&threshold_n);
    Some(Proposal {
        pins: configuration.layout.pins.clone(),
        parameters: Parameter::ALL.iter().map(|p| (p.name(), p.value(&configuration))).collect(),
        tendon_mm: [configuration.tendon.rope_diameter_mm, configuration.tendon.coating_mm],
        outer_radius_mm: design.support_radius_mm(),
        outer_width_mm: outer_width_mm(&configuration),
        // For the requested loads only, since the search extends beyond them.
        trust: trial.belief.banded(&part, &[trial.range_n.0, trial.range_n.1])?.status,
        threshold_n: within.then_some(threshold_n),
        friction_n: curve.value(Quantity::MaxFriction, trial.range_n)?,
        standard_error: probability.standard_error(),
        probability,
        uncertainty: linear.targets[tightest].shares(),
        tightest,
        targets,
        sensitivity: sensitivities(trial, &configuration),
        configuration,
    })
}

/// Returns a curve as a point of a plot; `None` if it cannot be predicted.
pub(super) fn pictured(
    curve: &mut Curve<'_>,
    pins: &[usize],
    range_n: (f64, f64),
) -> Option<LayoutCandidate> {
    let switching = curve.switching()?;
    let within = switching.is_found && (range_n.0..=range_n.1).contains(&switching.threshold_n);
    Some(LayoutCandidate {
        pins: pins.to_vec(),
        threshold_n: within.then_some(switching.threshold_n),
        friction_n: curve.value(Quantity::MaxFriction, range_n)?,
    })
}
