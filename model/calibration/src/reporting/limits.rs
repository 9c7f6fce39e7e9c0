//! Effects that are not in the model: limits of sizes, effects that are not identifiable, and the
//! outcome of each candidate.

use std::collections::BTreeMap;

use pinswitch_inference::{Candidate, Member};

use crate::effects::{SharedEffect, Vocabulary};
use crate::evidence::{Evidence, Fitted};
use crate::model::Term;
use crate::report::{CandidateReport, Fate, Invisible, LimitReport};
use crate::table::Optional;

/// Change of a reading in newtons below which an effect does not act on a table.
const NO_CHANGE_N: f64 = 1e-6;

/// Effects that no table of such a rig identifies after the refit.
pub(super) const NEVER_VISIBLE: [&str; 3] = [
    "a loss in the guide pulleys proportional to tension: requires a run without the switch",
    "a constant error of the wrap angle: requires a measurement of the angle",
    "a threshold shifted by the same load everywhere: requires an independent measurement of the transition",
];

/// Returns the limits of the identifiable effects that are not in the model.
pub(super) fn limits(evidence: &Evidence) -> Vec<LimitReport> {
    let candidates = evidence.posterior().candidates.iter();
    candidates
        .filter(|candidate| candidate.is_detectable() || candidate.size.is_excluded())
        .map(|candidate| limit(evidence, candidate))
        .collect()
}

fn limit(evidence: &Evidence, candidate: &Candidate) -> LimitReport {
    let effect = evidence.effect_at(candidate.effect);
    let values = evidence.shape_values(candidate.effect, candidate.shape);
    let [low, high] = interval(evidence, effect, candidate);
    let shapes = effect.parameters().iter().skip(1).zip(values);
    LimitReport {
        id: effect.id().to_owned(),
        parameter: effect.parameters().first().map_or("present", |p| &p.name).to_owned(),
        low,
        high,
        typical: evidence.parameter_of_size(candidate.effect, candidate.size.relevant),
        shape: shapes.map(|(p, value)| (p.name.to_string(), value)).collect::<BTreeMap<_, _>>(),
        unit: effect.parameters().first().map_or("1", |p| &p.unit).to_owned(),
        one_sided: effect.description().one_sided,
        experiment: effect.description().experiment.to_owned(),
        excluded: candidate.size.is_excluded(),
    }
}

/// Returns the 95 % interval of the first constant of an effect.
fn interval(evidence: &Evidence, effect: &SharedEffect, candidate: &Candidate) -> [f64; 2] {
    let [mut low, mut high] = candidate.size.interval();
    if evidence.is_one_sided(candidate.effect) {
        (low, high) = (low.max(0.0), high.max(0.0));
    }
    if effect.parameters().is_empty() {
        (low, high) = (low.clamp(0.0, 1.0), high.clamp(0.0, 1.0));
    }
    let ends = [low, high].map(|size| evidence.parameter_of_size(candidate.effect, size));
    [ends[0].min(ends[1]), ends[0].max(ends[1])]
}

/// Returns the effects that are not identifiable with this table, with reasons.
pub(super) fn invisible(evidence: &Evidence, baseline: &Fitted) -> Vec<Invisible> {
    let posterior = evidence.posterior();
    (0..evidence.problem().space().effects.len())
        .filter(|index| !posterior.reported.iter().any(|r| r.member == Member::Effect(*index)))
        .filter_map(|index| {
            let effect = evidence.effect_at(index);
            let description = effect.description();
            let known = posterior.candidates.iter().find(|candidate| candidate.effect == index);
            let (why, possible) = match known {
                Some(candidate) if candidate.is_detectable() || candidate.size.is_excluded() => return None,
                Some(candidate) => (
                    "the smallest relevant size would not be distinguished from noise".to_owned(),
                    Some(interval(evidence, effect, candidate)),
                ),
                None if acts(evidence, effect, baseline) => {
                    ("it is absorbed by the refitted model".to_owned(), None)
                }
                None => (description.invisible_because.to_owned(), None),
            };
            Some(Invisible {
                id: description.id.to_owned(),
                why,
                experiment: description.experiment.to_owned(),
                possible,
            })
        })
        .collect()
}

/// Returns the effects over covariates that the table lacks.
pub(super) fn without_covariate(
    vocabulary: &Vocabulary,
    lacking: &[Optional],
    is_plain: bool,
) -> Vec<Invisible> {
    let effects = vocabulary.effects().filter_map(|effect| {
        let description = effect.description();
        let column = description.covariate.column().filter(|column| lacking.contains(column))?;
        if is_plain && !description.on_plain {
            return None;
        }
        Some(Invisible {
            id: description.id.to_owned(),
            why: format!("the table has no complete column {}", column.column()),
            experiment: description.experiment.to_owned(),
            possible: None,
        })
    });
    effects.collect()
}

/// Returns whether an effect changes a reading of the table.
fn acts(evidence: &Evidence, effect: &SharedEffect, baseline: &Fitted) -> bool {
    let points: Vec<_> = evidence.rows().map(|(.., point)| *point).collect();
    let model = &baseline.model;
    let before = model.predict(&points);
    effect.typical(&model.frame).iter().any(|start| {
        let after = model.with_term(Term::Named(effect.clone()), start).predict(&points);
        after.iter().zip(&before).any(|(a, b)| (a - b).abs() > NO_CHANGE_N)
    })
}

/// Returns every effect with its probability and outcome, the most probable first.
pub(super) fn candidates(evidence: &Evidence) -> Vec<CandidateReport> {
    let posterior = evidence.posterior();
    let best = posterior.window.first().map(|fit| &fit.hypothesis);
    let is_rival =
        |member: Member| posterior.reported.iter().any(|r| r.rivals.iter().any(|(m, _)| *m == member));
    let mut all: Vec<CandidateReport> = (0..evidence.problem().space().effects.len())
        .map(|index| {
            let member = Member::Effect(index);
            let known = posterior.candidates.iter().find(|candidate| candidate.effect == index);
            let (fate, outside) = match known {
                _ if best.is_some_and(|best| best.contains(member)) => (Fate::Kept, 0.0),
                _ if is_rival(member) => (Fate::Rival, 0.0),
                Some(candidate) => {
                    let odds = libm::exp(candidate.log_odds.min(700.0));
                    let fate = if candidate.size.is_excluded() {
                        Fate::Excluded
                    } else if candidate.is_detectable() {
                        Fate::Open
                    } else {
                        Fate::Invisible
                    };
                    (fate, odds / (1.0 + odds))
                }
                None => (Fate::Invisible, evidence.problem().space().effects[index].probability),
            };
            // Outside the window the first-order odds of adding it are known.
            let inside = posterior.probability(member);
            let probability = if inside > 0.0 { inside } else { outside };
            CandidateReport { id: evidence.effect_at(index).id().to_owned(), probability, fate }
        })
        .collect();
    all.sort_by(|a, b| b.probability.total_cmp(&a.probability));
    all
}
