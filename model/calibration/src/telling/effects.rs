//! Reports of the effects with their rivals, and of unattributed structure.

use crate::held_out::held_out;
use crate::inference::{
    FoundEffect, Rival, Selection, Term, UNATTRIBUTED, Weighed, degrees_of_freedom, family_p_value,
};
use crate::report::{EffectReport, ModelReport, RivalReport};

pub(super) fn effects(
    selection: &Selection,
    weighed: &Weighed<'_>,
    after_n: f64,
    augmented: &ModelReport,
) -> Vec<EffectReport> {
    let degrees = degrees_of_freedom(weighed.data, selection.baseline.model.values().len());
    let mut reports: Vec<EffectReport> = selection
        .effects
        .iter()
        .map(|found| named_report(found, selection, weighed, degrees, after_n, augmented))
        .collect();
    reports.extend(unnamed_report(selection, weighed, degrees, after_n, augmented));
    reports
}

fn named_report(
    found: &FoundEffect,
    selection: &Selection,
    weighed: &Weighed<'_>,
    degrees: f64,
    after_n: f64,
    augmented: &ModelReport,
) -> EffectReport {
    let description = found.effect.description();
    let without = selection.augmented.model.without_term(found.term);
    EffectReport {
        id: description.id.to_owned(),
        covariate: description.covariate.as_str().to_owned(),
        side: Some(description.side.as_str().to_owned()),
        formula: found.effect.cited_formula(),
        p_value: family_p_value(found.gain, selection.baseline.model.vocabulary.tries(), degrees),
        parameters: description
            .parameters
            .iter()
            .filter_map(|p| {
                let known = augmented.parameters.get(&format!("{}.{}", description.id, p.name))?;
                Some((p.name.to_owned(), known.clone()))
            })
            .collect(),
        error_before_n: held_out(&without, weighed).both_n(),
        error_after_n: after_n,
        rivals: found.rivals.iter().map(|rival| rival_report(found, rival)).collect(),
        form: None,
    }
}

fn rival_report(found: &FoundEffect, rival: &Rival) -> RivalReport {
    let (description, other) = (found.effect.description(), rival.effect.description());
    RivalReport {
        id: other.id.to_owned(),
        why: format!(
            "after the refit both change the readings alike (cosine {:.3}); replacing {} by it increases the deviance by only {:.1}",
            rival.cosine, description.id, rival.worse_by
        ),
        experiment: if description.experiment == other.experiment {
            description.experiment.to_owned()
        } else {
            format!("{}; {}", description.experiment, other.experiment)
        },
    }
}

/// Returns the report of unattributed structure, if there is any.
fn unnamed_report(
    selection: &Selection,
    weighed: &Weighed<'_>,
    degrees: f64,
    after_n: f64,
    augmented: &ModelReport,
) -> Option<EffectReport> {
    let structure = selection.structure?;
    let model = &selection.augmented.model;
    let shapes: Vec<(usize, String)> = model
        .terms
        .iter()
        .enumerate()
        .filter_map(|(i, term)| match term {
            Term::Structure(s) => Some((i, s.describe(&model.frame))),
            Term::Named(_) => None,
        })
        .collect();
    let bare = shapes.iter().rev().fold(model.clone(), |m, (i, _)| m.without_term(*i));
    Some(EffectReport {
        id: UNATTRIBUTED.to_owned(),
        covariate: structure.covariate.as_str().to_owned(),
        side: None,
        formula: shapes.iter().map(|(_, words)| words.as_str()).collect::<Vec<_>>().join("; "),
        p_value: family_p_value(structure.gain, selection.structures_tried, degrees),
        parameters: augmented
            .parameters
            .iter()
            .filter(|(name, _)| name.starts_with(UNATTRIBUTED))
            .map(|(name, e)| (name.clone(), e.clone()))
            .collect(),
        error_before_n: held_out(&bare, weighed).both_n(),
        error_after_n: after_n,
        rivals: Vec::new(),
        form: None,
    })
}
