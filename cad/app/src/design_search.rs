//! Search for designs that reach the targets on the plot.

use pinswitch_calibration::ModelFile;
use pinswitch_diagnostic::{Diagnostic, Location, codes};
use pinswitch_friction::FrictionCurve;
use pinswitch_friction::published::GROOVES;
use pinswitch_switch::design::Design;
use pinswitch_switch::design_search::{
    Belief, Options, Proposal, PublishedPhysics, Silent, TargetResult, load_range_n, search,
};
use pinswitch_switch::feasibility;
use pinswitch_switch::prediction::predicted_curve;
use pinswitch_switch::request::{DEFAULT_WITHIN, Quantity, Request, Requirement, Target, Vary};
use serde::Serialize;

use crate::Answer;
use crate::calibrated_curve::calibrated_curve;
use crate::calibrated_switch::CalibratedSwitch;
use crate::prediction_cache::MODEL_NAME;
use crate::refusal::Refusal;
use crate::request::SearchRequest;
use crate::values::configuration;
use crate::{Values, changed_values};

/// Most sources of uncertainty of a design.
const MAX_SOURCES: usize = 3;
/// Most designs that are returned, whatever the request.
const MAX_DESIGNS: usize = 12;
/// A third of the draws of the command line, since a person waits.
const OPTIONS: Options = Options { best: 6, draws: 300, seed: 1, starts: 6 };

/// One proposed design.
#[derive(Debug, Serialize)]
struct ProposedDesign {
    values: Values,
    pins: Vec<usize>,
    targets: Vec<TargetValue>,
    /// Probability that a made part reaches all targets.
    probability: f64,
    threshold_n: Option<f64>,
    /// Friction at the heaviest load, N.
    friction_n: f64,
    /// Sources of the uncertainty, the largest first.
    uncertainty: Vec<UncertaintySource>,
    curve: FrictionCurve,
}

/// A target and the value of the design.
#[derive(Debug, Serialize)]
struct TargetValue {
    /// Load of a target friction, N; `None` for the threshold.
    load_n: Option<f64>,
    target_n: f64,
    /// Value of the design, N; `None` if it does not switch.
    value_n: Option<f64>,
    is_met: bool,
}

/// Designs, the most probable first, with a summary of the search.
#[derive(Debug, Serialize)]
struct SearchResult {
    designs: Vec<ProposedDesign>,
    summary: String,
    /// Fields of the configuration that the search has varied.
    varied: Vec<&'static str>,
    /// Why no design reaches all targets; the designs are then the nearest.
    blocked: Option<Explanation>,
    /// Largest relative deviation from a target at which a made part still counts.
    tolerance: f64,
}

/// Why no design reaches all targets, and the changes that help.
#[derive(Debug, Serialize)]
struct Explanation {
    problem: String,
    help: Vec<String>,
}

/// A source of the uncertainty of a design, with its share of the variance.
#[derive(Debug, Serialize)]
struct UncertaintySource {
    source: String,
    share: f64,
}

/// Answers a search.
pub(crate) fn answer(request: &SearchRequest) -> Answer {
    match result(request) {
        Ok(result) => Answer::json(&result),
        Err(refusal) => Answer::json(&serde_json::json!({ "trouble": refusal })),
    }
}

fn result(wanted: &SearchRequest) -> Result<SearchResult, Refusal> {
    let base = feasibility::design(configuration(&wanted.values)?)?;
    let request = design_request(wanted);
    request.check()?;
    request.check_loads(load_range_n(base.configuration(), &request))?;
    let options = Options { best: wanted.most.clamp(1, MAX_DESIGNS), ..OPTIONS };
    let model = wanted.model.as_deref().map(|text| ModelFile::parse(text, MODEL_NAME)).transpose()?;
    let grooves = base.configuration().segment.grooves;
    if model.is_some() && grooves != GROOVES {
        let diagnostic =
            Diagnostic::new(codes::MODEL_BEYOND_RIG, format!("the calibrated rig has {GROOVES} grooves"))
                .with_location(Location::field("segment.grooves", grooves.to_string()))
                .with_help(format!("set it to {GROOVES}, or go back to the published constants"));
        return Err(diagnostic.into());
    }
    let published = PublishedPhysics::default();
    let switch = |model| CalibratedSwitch::new(model, MODEL_NAME.to_owned());
    let calibrated = model.clone().map(switch).transpose()?;
    let belief: &dyn Belief = calibrated.as_ref().map_or(&published, |switch| switch);
    let found = search(&base, &request, belief, options, &Silent);
    let summary = format!("{} layouts, {} curves computed", found.patterns, found.tried);
    let blocked = found.blocked.as_ref().map(|b| Explanation { problem: b.problem(), help: b.help() });
    let designs = found.proposals.iter().filter_map(|proposal| design(proposal, model.as_ref())).collect();
    let parameters = request.vary.parameters.iter().map(|varied| varied.parameter.field());
    let varied = request.vary.pattern.then_some("layout.pins").into_iter().chain(parameters).collect();
    Ok(SearchResult { designs, summary, varied, blocked, tolerance: DEFAULT_WITHIN })
}

/// Returns the targets of a request. Without a model the search varies what that of the command line varies; a calibrated
/// model is of one rig, whose dimensions stay.
fn design_request(request: &SearchRequest) -> Request {
    let about = |value| Requirement::About { value, within: DEFAULT_WITHIN };
    let threshold =
        request.threshold_n.map(|n| Target { quantity: Quantity::Threshold, requirement: about(n) });
    let friction = request.friction.iter().map(|at| Target {
        quantity: Quantity::Friction { load_n: at.load_n },
        requirement: about(at.friction_n),
    });
    let vary = match request.model {
        None => Vary::default(),
        Some(_) => Vary { pattern: true, parameters: Vec::new() },
    };
    Request { targets: threshold.into_iter().chain(friction).collect(), vary, ..Request::default() }
}

fn design(proposal: &Proposal, model: Option<&ModelFile>) -> Option<ProposedDesign> {
    let design = Design::new(proposal.configuration.clone()).ok()?;
    let curve = match model {
        Some(model) => calibrated_curve(&design, model, MODEL_NAME).ok()?,
        None => predicted_curve(&design),
    };
    Some(ProposedDesign {
        values: changed_values(&proposal.configuration),
        pins: proposal.pins.clone(),
        targets: proposal.targets.iter().filter_map(|result| target_value(result, proposal)).collect(),
        probability: proposal.probability.all,
        threshold_n: proposal.threshold_n,
        friction_n: proposal.friction_n,
        uncertainty: proposal
            .uncertainty
            .iter()
            .take(MAX_SOURCES)
            .map(|s| UncertaintySource { source: s.source.to_string(), share: s.share })
            .collect(),
        curve,
    })
}

fn target_value(result: &TargetResult, proposal: &Proposal) -> Option<TargetValue> {
    let Requirement::About { value: target_n, .. } = result.target.requirement else { return None };
    let (load_n, value_n) = match result.target.quantity {
        Quantity::Threshold => (None, proposal.threshold_n),
        Quantity::Friction { load_n } => (Some(load_n), Some(result.value)),
        _ => return None,
    };
    Some(TargetValue { load_n, target_n, value_n, is_met: result.is_met })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn request(json: &str) -> SearchRequest {
        serde_json::from_str(json).unwrap()
    }

    #[test]
    fn proposed_designs_are_valid() {
        let proposed = result(&request(r#"{"threshold_n": 24, "most": 2}"#)).unwrap();
        assert!((1..=2).contains(&proposed.designs.len()));
        for design in &proposed.designs {
            assert!((0.0..=1.0).contains(&design.probability));
            Design::new(configuration(&design.values).unwrap()).unwrap();
        }
    }

    #[test]
    fn every_design_has_every_target() {
        let targets = request(r#"{"threshold_n": 24, "friction": [{"load_n": 40, "friction_n": 8.5}]}"#);
        for design in &result(&targets).unwrap().designs {
            let targets: Vec<_> = design.targets.iter().map(|t| (t.load_n, t.target_n)).collect();
            assert_eq!(targets, [(None, 24.0), (Some(40.0), 8.5)]);
        }
    }

    #[test]
    fn a_negative_threshold_is_refused() {
        assert!(result(&request(r#"{"threshold_n": -1}"#)).is_err());
    }
}
