//! Reports of the effects with their rivals, and of unattributed structure.

use std::collections::BTreeMap;

use pinswitch_inference::{Member, Reported};

use super::{Findings, HeldOut, held_out};
use crate::effects::{Description, Effect, SharedEffect, UNATTRIBUTED};
use crate::model::Term;
use crate::report::{EffectReport, Estimate, ModelReport, RivalReport};

/// Largest odds in a report.
const MOST_ODDS: f64 = 1e12;

pub(super) fn effects(findings: &Findings<'_>, augmented: &ModelReport) -> Vec<EffectReport> {
    let evidence = findings.evidence;
    let reported = evidence.posterior().reported.iter().filter(|r| !evidence.is_change(r.member));
    reported.map(|reported| effect_report(findings, reported, augmented)).collect()
}

fn effect_report(findings: &Findings<'_>, reported: &Reported, augmented: &ModelReport) -> EffectReport {
    let evidence = findings.evidence;
    let posterior = evidence.posterior();
    let without = posterior.best_without(reported.member);
    let before = without.and_then(|fit| held_out(evidence, fit)).map(HeldOut::both_n);
    let odds = posterior.window.first().zip(without).map_or(MOST_ODDS, |(best, without)| {
        libm::exp((best.score - without.score).min(libm::log(MOST_ODDS)))
    });
    let effect = evidence.effect(reported.member);
    let (id, side, formula) = match effect {
        Some(effect) => {
            let side = effect.description().side.as_str().to_owned();
            (effect.id().to_owned(), Some(side), effect.cited_formula())
        }
        None => (UNATTRIBUTED.to_owned(), None, structure_words(findings, reported.member)),
    };
    EffectReport {
        covariate: evidence.covariate(reported.member).to_owned(),
        side,
        formula,
        probability: reported.probability,
        odds,
        parameters: constants(augmented, &id, effect, evidence.structure_number(reported.member)),
        error_before_n: before,
        error_after_n: augmented.heldout_rmse_n,
        rivals: reported.rivals.iter().map(|rival| rival_report(findings, reported.member, rival)).collect(),
        includes: effect.map(|effect| included(findings, &**effect)).unwrap_or_default(),
        form: None,
        id,
    }
}

/// Returns the effects that act as this one does on a rig without a switch.
fn included(findings: &Findings<'_>, effect: &dyn Effect) -> Vec<String> {
    let description = effect.description();
    let acts_alike = |other: &Description<'_>| {
        !other.on_plain && other.stage == description.stage && other.is_confused_with(description.id)
    };
    let is_plain = findings.baseline.model.frame.is_plain();
    let alike = findings.vocabulary.effects().filter(|other| is_plain && acts_alike(&other.description()));
    alike.map(|other| other.id().to_owned()).collect()
}

/// Returns the constants of an effect by name; that of a structure keeps its full name.
fn constants(
    augmented: &ModelReport,
    id: &str,
    effect: Option<&SharedEffect>,
    number: Option<usize>,
) -> BTreeMap<String, Estimate> {
    if effect.is_none() {
        let name = number.map_or_else(String::new, |number| format!("{UNATTRIBUTED}.{number}"));
        return augmented
            .parameters
            .get_key_value(&name)
            .map(|(k, v)| (k.clone(), v.clone()))
            .into_iter()
            .collect();
    }
    let prefix = format!("{id}.");
    let of = augmented.parameters.iter();
    of.filter_map(|(name, estimate)| Some((name.strip_prefix(&prefix)?.to_owned(), estimate.clone())))
        .collect()
}

fn structure_words(findings: &Findings<'_>, member: Member) -> String {
    let name = findings.evidence.name(member);
    let model = &findings.augmented.model;
    let structures = model.terms.iter().filter_map(|term| match term {
        Term::Structure(structure) => Some(structure),
        Term::Named(_) => None,
    });
    let number = findings.evidence.structure_number(member);
    let described = number.and_then(|number| structures.into_iter().nth(number - 1));
    described.map_or_else(|| name.to_owned(), |s| format!("{name}: {}", s.describe(&model.frame)))
}

fn rival_report(findings: &Findings<'_>, of: Member, (member, probability): &(Member, f64)) -> RivalReport {
    let evidence = findings.evidence;
    let experiments: Vec<&str> = [of, *member]
        .into_iter()
        .filter_map(|member| evidence.effect(member))
        .map(|effect| effect.description().experiment)
        .collect();
    let experiment = match experiments[..] {
        [first, second] if first != second => format!("{first}; {second}"),
        _ => experiments.first().map_or_else(String::new, |first| (*first).to_owned()),
    };
    RivalReport {
        id: evidence.name(*member).to_owned(),
        probability: *probability,
        why: format!(
            "hypotheses with {} in place of {} have a probability of {probability:.2}",
            evidence.name(*member),
            evidence.name(of)
        ),
        experiment,
    }
}
