//! Effects that are not in the model: limits of sizes, effects that are not identifiable, and the
//! outcome of each candidate.

use crate::inference::{
    CandidateEffect, Levels, Observations, Selection, degrees_of_freedom, family_p_value,
};
use crate::report::{CandidateReport, Fate, Invisible, LimitReport};

pub(super) fn limits(selection: &Selection) -> Vec<LimitReport> {
    selection
        .limits
        .iter()
        .map(|limit| LimitReport {
            id: limit.effect.id().to_owned(),
            parameter: limit.effect.parameters().first().map_or("present", |p| p.name).to_owned(),
            low: limit.interval[0],
            high: limit.interval[1],
            typical: limit.typical,
            shape: limit
                .effect
                .parameters()
                .iter()
                .skip(1)
                .zip(&limit.shape)
                .map(|(parameter, value)| (parameter.name.to_owned(), *value))
                .collect(),
            unit: limit.effect.parameters().first().map_or("1", |p| p.unit).to_owned(),
            one_sided: limit.effect.description().one_sided,
            experiment: limit.effect.description().experiment.to_owned(),
            excluded: limit.is_excluded(),
        })
        .collect()
}

/// Effects that no table of such a rig identifies after the refit.
pub(super) const NEVER_VISIBLE: [&str; 3] = [
    "a loss in the guide pulleys proportional to tension: requires a run without the switch",
    "a constant error of the wrap angle: requires a measurement of the angle",
    "a threshold shifted by the same load everywhere: requires an independent measurement of the transition",
];

/// Returns the effects that are not identifiable with this table, with reasons.
pub(super) fn invisible(selection: &Selection) -> Vec<Invisible> {
    selection
        .invisible()
        .filter(|c| !selection.effects.iter().any(|found| found.effect.id() == c.effect.id()))
        .map(|candidate| {
            let description = candidate.effect.description();
            Invisible {
                id: description.id.to_owned(),
                why: if candidate.strength < 1e-6 {
                    description.invisible_because.to_owned()
                } else if candidate.is_taken_over() {
                    "it is absorbed by the refitted baseline".to_owned()
                } else {
                    format!(
                        "a typical size changes the readings by {:.2} standard deviations, at least {} are needed",
                        candidate.strength,
                        CandidateEffect::MIN_STRENGTH
                    )
                },
                experiment: description.experiment.to_owned(),
                possible: selection
                    .hidden_limits
                    .iter()
                    .find(|limit| limit.effect.id() == description.id)
                    .map(|limit| limit.interval),
            }
        })
        .collect()
}

/// Returns every effect with its outcome.
pub(super) fn candidates(selection: &Selection, data: &Observations, levels: Levels) -> Vec<CandidateReport> {
    let degrees = degrees_of_freedom(data, selection.baseline.model.values().len());
    let fate = |candidate: &CandidateEffect, p: f64| {
        let id = candidate.effect.id();
        if selection.effects.iter().any(|found| found.effect.id() == id) {
            Fate::Kept
        } else if selection.effects.iter().any(|found| found.ids().contains(&id)) {
            Fate::Rival
        } else if p <= levels.first_p && selection.effects.is_empty() && selection.structure.is_none() {
            Fate::Unsettled
        } else if p <= levels.first_p {
            Fate::Superfluous
        } else if candidate.is_invisible() {
            Fate::Invisible
        } else {
            Fate::Chance
        }
    };
    selection
        .candidates
        .iter()
        .map(|candidate| {
            let p_value =
                family_p_value(candidate.gain, selection.baseline.model.vocabulary.tries(), degrees);
            CandidateReport {
                id: candidate.effect.id().to_owned(),
                gain: candidate.gain.max(0.0),
                p_value,
                gain_left: candidate.gain_left.map(|gain| gain.max(0.0)),
                fate: fate(candidate, p_value),
            }
        })
        .collect()
}
