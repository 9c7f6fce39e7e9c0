//! Search for designs that reach the targets on the plot.

use pinswitch_calibration::ModelFile;
use pinswitch_diagnostic::{Diagnostic, Location, codes};
use pinswitch_friction::FrictionCurve;
use pinswitch_friction::published::GROOVES;
use pinswitch_switch::config::Configuration;
use pinswitch_switch::design::Design;
use pinswitch_switch::design::rules::checklist;
use pinswitch_switch::design_search::{
    Belief, Options, Proposal, PublishedPhysics, Sensitivity, Silent, TargetResult, load_range_n, search,
};
use pinswitch_switch::feasibility;
use pinswitch_switch::prediction::predicted_curve;
use pinswitch_switch::request::{
    DEFAULT_WITHIN, Parameter, Quantity, Request, Requirement, Target, Varied, Vary,
};
use serde::Serialize;

use crate::Answer;
use crate::calibrated_curve::calibrated_curve;
use crate::calibrated_switch::CalibratedSwitch;
use crate::prediction_cache::MODEL_NAME;
use crate::refusal::Refusal;
use crate::request::SearchRequest;
use crate::values::configuration;
use crate::{Values, changed_values};

/// Name of the occupied grooves among the varied parameters.
const PATTERN: &str = "pattern";
/// Most sources of uncertainty of a design.
const MAX_SOURCES: usize = 3;
/// Most designs that are returned, whatever the request.
const MAX_DESIGNS: usize = 12;

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
    /// What a change buys: fields with the change of the threshold and of the friction at the heaviest load, N per unit.
    gains: Vec<Gain>,
    /// Problems of the printed parts that need a review, as in the checks of the design.
    problems: Vec<String>,
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

/// What a change of a field buys, N per unit of the field.
#[derive(Debug, Serialize)]
struct Gain {
    field: &'static str,
    threshold_n: f64,
    friction_n: f64,
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
    let request = design_request(wanted)?;
    request.check()?;
    request.check_loads(load_range_n(base.configuration(), &request))?;
    // The limits of the command line, so that both find the same designs.
    let options = Options { best: wanted.most.clamp(1, MAX_DESIGNS), ..Options::default() };
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

/// Returns the targets of a request, and what the search varies: by default what that of the command line varies.
///
/// # Errors
/// [`Refusal`] if a name in `vary` is not that of a parameter.
fn design_request(request: &SearchRequest) -> Result<Request, Refusal> {
    let about = |value| Requirement::About { value, within: DEFAULT_WITHIN };
    let threshold =
        request.threshold_n.map(|n| Target { quantity: Quantity::Threshold, requirement: about(n) });
    let friction = request.friction.iter().map(|at| Target {
        quantity: Quantity::Friction { load_n: at.load_n },
        requirement: about(at.friction_n),
    });
    let vary = match &request.vary {
        None => Vary::default(),
        Some(names) => Vary {
            pattern: names.iter().any(|name| name == PATTERN),
            parameters: names
                .iter()
                .filter(|name| *name != PATTERN)
                .map(|name| parameter(name).map(Varied::by_default))
                .collect::<Result<_, _>>()?,
        },
    };
    Ok(Request { targets: threshold.into_iter().chain(friction).collect(), vary, ..Request::default() })
}

fn parameter(name: &str) -> Result<Parameter, Diagnostic> {
    Parameter::from_name(name).ok_or_else(|| {
        let known = Parameter::ALL.map(Parameter::name).join(", ");
        Diagnostic::new(codes::UNKNOWN_WORD, format!("no parameter {name:?}"))
            .with_location(Location::field("vary", name.to_owned()))
            .with_help(format!("give {PATTERN}, {known}"))
    })
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
        gains: proposal.sensitivity.iter().map(|s| gain(s, &proposal.configuration)).collect(),
        // The widest bridge is known from meshes only; none is assumed here.
        problems: checklist(&design, 0.0)
            .into_iter()
            .filter(|check| !check.is_satisfied)
            .map(|check| check.statement)
            .collect(),
        curve,
    })
}

/// The gain per unit of the field: the span is a number of pitches.
fn gain(sensitivity: &Sensitivity, configuration: &Configuration) -> Gain {
    let per_field = match sensitivity.parameter {
        Parameter::PitchDeg => 1.0 / configuration.segment.grooves as f64,
        _ => 1.0,
    };
    Gain {
        field: sensitivity.parameter.field(),
        threshold_n: sensitivity.threshold_n_per_unit * per_field,
        friction_n: sensitivity.friction_n_per_unit * per_field,
    }
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

    /// The search varies the named parameters only, and refuses unknown names.
    #[test]
    fn varied_parameters_are_those_of_the_request() {
        let found =
            result(&request(r#"{"threshold_n": 24, "vary": ["hardness_shore_a"], "most": 1}"#)).unwrap();
        assert_eq!(found.varied, ["silicone.hardness_shore_a"]);
        assert!(found.designs[0].values.contains_key("silicone.hardness_shore_a"));
        assert!(found.designs[0].gains.iter().any(|gain| gain.field == "silicone.hardness_shore_a"));
        let refused = result(&request(r#"{"threshold_n": 24, "vary": ["colour"]}"#)).unwrap_err();
        assert!(format!("{refused:?}").contains("hardness_shore_a"), "{refused:?}");
    }

    #[test]
    fn a_negative_threshold_is_refused() {
        assert!(result(&request(r#"{"threshold_n": -1}"#)).is_err());
    }
}
