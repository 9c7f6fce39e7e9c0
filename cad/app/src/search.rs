//! Designs that do what the handles on the plot ask for.

use pinswitch_calibration::ModelFile;
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
use crate::predicted::MODEL;
use crate::request::{Values, Wanted};
use crate::trouble::Trouble;
use crate::values::{configuration, values};

/// Designs that are proposed at the most, whatever is asked.
const MOST: usize = 12;
/// Made parts that are drawn for a probability: a third of what the command line takes, since somebody waits.
const QUICK: Options = Options { best: 6, draws: 300, seed: 1, starts: 6 };

/// One card.
#[derive(Debug, Serialize)]
struct Card {
    values: Values,
    pins: Vec<usize>,
    /// What it has of all that was asked.
    answers: Vec<Has>,
    probability: f64,
    threshold_n: Option<f64>,
    friction_n: f64,
    curve: FrictionCurve,
}

/// What was asked for, in newtons, and the best guess of it; a threshold, where it has no load. `value_n` is none where
/// the design does not switch.
#[derive(Debug, Serialize)]
struct Has {
    load_n: Option<f64>,
    asked_n: f64,
    value_n: Option<f64>,
    is_met: bool,
}

/// Cards, the most probable first, and how the search went, in words.
#[derive(Debug, Serialize)]
struct Found {
    designs: Vec<Card>,
    words: String,
    /// How far from what was asked a made part may be and is still counted as likely: a share.
    within: f64,
}

/// The best designs for what is wanted.
pub(crate) fn answer(wanted: &Wanted) -> Answer {
    match found(wanted) {
        Ok(found) => Answer::json(&found),
        Err(trouble) => Answer::json(&serde_json::json!({ "trouble": trouble })),
    }
}

fn found(wanted: &Wanted) -> Result<Found, Trouble> {
    let base = feasibility::design(configuration(&wanted.values)?)?;
    let about = |value| Requirement::About { value, within: DEFAULT_WITHIN };
    let threshold =
        wanted.threshold_n.map(|n| Target { quantity: Quantity::Threshold, requirement: about(n) });
    let friction = wanted.friction.iter().map(|at| Target {
        quantity: Quantity::Friction { load_n: at.load_n },
        requirement: about(at.friction_n),
    });
    // Only which grooves are occupied: dimensions have sliders of their own, and take the search many times as long.
    let vary = Vary { pattern: true, parameters: Vec::new() };
    let targets = threshold.into_iter().chain(friction).collect();
    let request = Request { targets, vary, ..Request::default() };
    request.check().map_err(Trouble::general)?;
    request.check_loads(load_range_n(base.configuration(), &request)).map_err(Trouble::general)?;
    let options = Options { best: wanted.most.clamp(1, MOST), ..QUICK };
    let model = wanted.model.as_deref().map(|text| ModelFile::parse(text, MODEL)).transpose();
    let model = model.map_err(Trouble::general)?;
    let grooves = base.configuration().segment.grooves;
    if model.is_some() && grooves != GROOVES {
        return Err(Trouble::general(format!(
            "segment.grooves = {grooves}: a calibrated switch is known by the {GROOVES} grooves of its rig; set {GROOVES}, or go \
             back to the published constants"
        )));
    }
    let published = PublishedPhysics::default();
    let calibrated = model.clone().map(|model| CalibratedSwitch::new(model, MODEL.to_owned()));
    let belief: &dyn Belief = calibrated.as_ref().map_or(&published, |switch| switch);
    let found = search(&base, &request, belief, options, &Silent);
    let mut words = format!("{} patterns, {} curves computed", found.patterns, found.tried);
    if found.blocked.is_some() {
        words.push_str("; none does all of it by the best guess: this is the nearest");
    }
    let designs = found.proposals.iter().filter_map(|proposal| card(proposal, model.as_ref())).collect();
    Ok(Found { designs, words, within: DEFAULT_WITHIN })
}

fn card(proposal: &Proposal, model: Option<&ModelFile>) -> Option<Card> {
    let design = Design::new(proposal.configuration.clone()).ok()?;
    let curve = match model {
        Some(model) => calibrated_curve(&design, model, MODEL).ok()?,
        None => predicted_curve(&design),
    };
    Some(Card {
        values: values(&proposal.configuration),
        pins: proposal.pins.clone(),
        answers: proposal.targets.iter().filter_map(|result| has(result, proposal)).collect(),
        probability: proposal.probability.all,
        threshold_n: proposal.threshold_n,
        friction_n: proposal.friction_n,
        curve,
    })
}

/// What a proposal has of one thing that was asked.
fn has(result: &TargetResult, proposal: &Proposal) -> Option<Has> {
    let Requirement::About { value: asked_n, .. } = result.target.requirement else { return None };
    let (load_n, value_n) = match result.target.quantity {
        Quantity::Threshold => (None, proposal.threshold_n),
        Quantity::Friction { load_n } => (Some(load_n), Some(result.value)),
        _ => return None,
    };
    Some(Has { load_n, asked_n, value_n, is_met: result.is_met })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_proposed_can_be_taken() {
        let wanted: Wanted = serde_json::from_str(r#"{"threshold_n": 24, "most": 2}"#).unwrap();
        let proposed = found(&wanted).unwrap();
        assert!((1..=2).contains(&proposed.designs.len()));
        let wanted: Wanted =
            serde_json::from_str(r#"{"threshold_n": 24, "friction": [{"load_n": 40, "friction_n": 8.5}]}"#)
                .unwrap();
        for card in &found(&wanted).unwrap().designs {
            let asked: Vec<_> = card.answers.iter().map(|has| (has.load_n, has.asked_n)).collect();
            assert_eq!(asked, [(None, 24.0), (Some(40.0), 8.5)]);
        }
        for card in &proposed.designs {
            assert!((0.0..=1.0).contains(&card.probability));
            Design::new(configuration(&card.values).unwrap()).unwrap();
        }
        let wanted: Wanted = serde_json::from_str(r#"{"threshold_n": -1}"#).unwrap();
        assert!(found(&wanted).is_err());
    }
}
