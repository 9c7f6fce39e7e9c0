//! What was not found: limits of sizes, what the data cannot show, and what became of each candidate.

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

/// What no data of such a rig can show after the refit.
pub(super) const NEVER_VISIBLE: [&str; 3] = [
    "a loss in the guide pulleys in proportion to tension: needs a run without the switch",
    "a wrap angle that is wrong by a constant: needs the angle measured",
    "a threshold shifted by the same load everywhere: needs another way to see the switching",
];

/// Effects that this data cannot show, with what keeps it from it.
pub(super) fn invisible(selection: &Selection) -> Vec<Invisible> {
    selection
        .invisible()
        .filter(|c| !selection.effects.iter().any(|found| found.effect.id() == c.effect.id()))
        .map(|candidate| {
            let told = candidate.effect.description();
            Invisible {
                id: told.id.to_owned(),
                why: if candidate.strength < 1e-6 {
                    told.invisible_because.to_owned()
                } else if candidate.is_taken_over() {
                    "the refitted baseline takes it over".to_owned()
                } else {
                    format!(
                        "at a typical size it makes {:.2} standard deviations, {} are needed",
                        candidate.strength,
                        CandidateEffect::MIN_STRENGTH
                    )
                },
                experiment: told.experiment.to_owned(),
                possible: selection
                    .hidden_limits
                    .iter()
                    .find(|limit| limit.effect.id() == told.id)
                    .map(|limit| limit.interval),
            }
        })
        .collect()
}

/// Every effect with what became of it.
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
