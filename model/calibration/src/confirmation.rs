//! Trials of user-defined effects: whether readings that an effect was not derived from confirm or
//! refute it.
//!
//! The evidence of a trial is the posterior probability of the effect among all hypotheses. Readings
//! from which the effect was derived are left out. If its file does not state from which readings it was
//! derived, agreement only suggests it: it may have been derived from these.

use pinswitch_diagnostic::excerpt;
use pinswitch_inference::Member;

use crate::effects::{Covariate, EffectDefinition, Vocabulary};
use crate::evidence::Evidence;
use crate::report::{Estimate, TrialOutcome, TrialReport};
use crate::table::{PlateauRow, matching_sessions};

/// Posterior probability above which an effect is present, as for reported members.
const PRESENT: f64 = 0.9;
/// Posterior probability above which the size of an effect is that of the hypotheses with it.
const LIKELY: f64 = 0.5;
/// Share of a typical size that a refuted effect does not reach; a derived effect does not reach its
/// derived size.
const TYPICAL_SHARE: f64 = 0.5;
/// Fewest readings of other sessions for a trial of a derived effect.
const LEAST_ROWS: usize = 20;

/// Returns the report of an effect that is not tested.
fn untested(definition: &EffectDefinition, outcome: TrialOutcome, note: Option<String>) -> TrialReport {
    TrialReport {
        id: definition.id.clone(),
        outcome,
        probability: None,
        size: None,
        start: definition.parameters.first().map_or(1.0, |size| size.start),
        was_drawn: was_drawn(definition),
        note,
    }
}

fn was_drawn(definition: &EffectDefinition) -> bool {
    definition.drawn_from.as_ref().is_some_and(|readings| !readings.is_empty())
}

/// Tests an effect that was derived from some of the rows on the other rows; `None` if it was derived
/// from none of them.
pub(crate) fn trial_of_unseen(
    definition: &EffectDefinition,
    rows: &[PlateauRow],
    vocabulary: &Vocabulary,
    seed: u64,
) -> Option<TrialReport> {
    let known = matching_sessions(rows, definition.drawn_from.as_deref().unwrap_or_default());
    let is_seen = |row: &&PlateauRow| known.contains(row.labels.session.as_str());
    if !rows.iter().any(|row| is_seen(&row)) {
        return None;
    }
    let unseen: Vec<PlateauRow> = rows.iter().filter(|row| !is_seen(row)).cloned().collect();
    let drawn = || {
        let note = "derived from these readings, or from ones that cannot be told from them; other data can confirm it".to_owned();
        untested(definition, TrialOutcome::Drawn, Some(note))
    };
    if unseen.len() < LEAST_ROWS {
        return Some(drawn());
    }
    let evidence = Evidence::new(&unseen, vocabulary, seed).ok();
    Some(evidence.map_or_else(drawn, |evidence| trial(definition, &evidence)))
}

/// Returns the trials of all user-defined effects in the order in which they were read: those on unseen
/// rows, and the others from the posterior.
pub(crate) fn trials(
    vocabulary: &Vocabulary,
    evidence: &Evidence,
    unseen: Vec<TrialReport>,
) -> Vec<TrialReport> {
    let of = |definition: &EffectDefinition| {
        let known = unseen.iter().find(|trial| trial.id == definition.id).cloned();
        known.unwrap_or_else(|| trial(definition, evidence))
    };
    vocabulary.own().map(|own| of(own.definition())).collect()
}

fn trial(definition: &EffectDefinition, evidence: &Evidence) -> TrialReport {
    let effects = &evidence.problem().space().effects;
    let posterior = evidence.posterior();
    let index = effects.iter().position(|effect| effect.name == definition.id);
    let candidate = index.and_then(|i| posterior.candidates.iter().find(|c| c.effect == i));
    let absent = |note: &str| untested(definition, TrialOutcome::Open, Some(note.to_owned()));
    let Some(index) = index else { return absent("not in the vocabulary") };
    let member = Member::Effect(index);
    let inside = posterior.probability(member);
    let (probability, value, ci95) = match (posterior.size(index), candidate) {
        (Some(size), _) if inside > LIKELY => (inside, size.mean, size.interval),
        (_, Some(candidate)) => {
            let odds = libm::exp(candidate.log_odds.min(700.0));
            (inside.max(odds / (1.0 + odds)), candidate.size.size, candidate.size.interval())
        }
        (Some(size), None) => (inside, size.mean, size.interval),
        (None, None) => return absent("not identifiable with this table"),
    };
    let report = untested(definition, TrialOutcome::Open, None);
    let start = report.start;
    let has_sign = report.was_drawn || definition.one_sided;
    let is_alike = !has_sign || value * start > 0.0;
    // The least size of the hypothesis, and whether the interval excludes it in every allowed direction.
    let least = if report.was_drawn { start.abs() } else { TYPICAL_SHARE * start.abs() };
    let reaches = if has_sign {
        let (low, high) = (ci95[0] * start.signum(), ci95[1] * start.signum());
        low.max(high) >= least
    } else {
        ci95[0].abs().max(ci95[1].abs()) >= least
    };
    let outcome = if probability >= PRESENT && is_alike {
        if definition.drawn_from.is_some() { TrialOutcome::Confirmed } else { TrialOutcome::Suggested }
    } else if !reaches && (probability < 1.0 - PRESENT || !is_alike) {
        TrialOutcome::Refuted
    } else {
        TrialOutcome::Open
    };
    // A location is less certain than the interval of a size at it: structure along the covariate of the
    // effect may be the effect at another place.
    let nearby = structure_along(evidence, definition.covariate);
    let outcome = match outcome {
        TrialOutcome::Refuted if nearby.is_some() => TrialOutcome::Open,
        outcome => outcome,
    };
    let note = match outcome {
        TrialOutcome::Open if nearby.is_some() => {
            nearby.map(|name| format!("{name} acts, which may be the effect at a nearby place"))
        }
        TrialOutcome::Suggested => Some(
            "its file does not state the readings it was derived from, which may be these; `drawn_from = []` \
             declares that it was derived from none"
                .to_owned(),
        ),
        TrialOutcome::Open => rival_note(evidence, member),
        _ => None,
    };
    let unit = definition.parameters.first().map_or_else(|| "1".to_owned(), |p| excerpt(&p.unit, 40));
    TrialReport {
        outcome,
        probability: Some(probability),
        size: Some(Estimate { value, ci95, unit }),
        note,
        ..report
    }
}

/// Returns the name of reported structure along a covariate.
fn structure_along(evidence: &Evidence, covariate: Covariate) -> Option<String> {
    let is_along = |member: Member| {
        evidence.effect(member).is_none() && evidence.covariate(member) == covariate.as_str()
    };
    let reported = evidence.posterior().reported.iter().map(|r| r.member);
    reported.filter(|member| is_along(*member)).map(|member| evidence.name(member).to_owned()).next()
}

/// Names the members of the best hypothesis that the effect may take the place of.
fn rival_note(evidence: &Evidence, member: Member) -> Option<String> {
    let reported = &evidence.posterior().reported;
    let rival = |r: &&pinswitch_inference::Reported| r.rivals.iter().any(|(m, _)| *m == member);
    let names: Vec<&str> = reported.iter().filter(rival).map(|r| evidence.name(r.member)).collect();
    (!names.is_empty()).then(|| format!("{} may act in its place", names.join(" or ")))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::calibrate;
    use crate::effects::effect_named;
    use crate::model::Term;
    use crate::test_session::{session, session_with};

    fn trial_of(rows: &[PlateauRow], start: f64, drawn_from: &str) -> TrialReport {
        let file = format!(
            "schema = \"pinswitch.effects/1\"\n[[effect]]\nid = \"mine\"\nside = \"rig\"\ncovariate = \"speed\"\n\
             acts_on = \"tension\"\ncombine = \"add\"\nformula = \"a*direction*(0.4 + 0.6*speed_pct/52)\"\n\
             {drawn_from}\nparameters.a = {{ size = true, start = {start}, unit = \"N\" }}\n"
        );
        let vocabulary = Vocabulary::built_in().read(&file, "mine.toml").unwrap();
        calibrate(rows, &vocabulary, 1).unwrap().report.trials[0].clone()
    }

    fn viscous(seed: u64) -> Vec<PlateauRow> {
        let file = "schema = \"pinswitch.effects/1\"\n[[effect]]\nid = \"truth\"\nside = \"rig\"\ncovariate = \"speed\"\n\
             acts_on = \"tension\"\ncombine = \"add\"\nformula = \"a*direction*(0.4 + 0.6*speed_pct/52)\"\n\
             parameters.a = { size = true, start = 0.5, unit = \"N\" }\n";
        let vocabulary = Vocabulary::built_in().read(file, "truth.toml").unwrap();
        session_with(seed, &[(Term::Named(vocabulary.named("truth").unwrap()), &[0.5])])
    }

    /// Agreement with readings that the effect may have been derived from only suggests it.
    #[test]
    fn undeclared_origins_prevent_confirmation() {
        let rows = viscous(5);
        assert_eq!(trial_of(&rows, 0.5, "drawn_from = []").outcome, TrialOutcome::Confirmed);
        let undeclared = trial_of(&rows, 0.5, "");
        assert_eq!(undeclared.outcome, TrialOutcome::Suggested, "{undeclared:?}");
        assert!(undeclared.note.unwrap().contains("drawn_from = []"));
    }

    #[test]
    fn absent_effects_are_refuted() {
        let absent = trial_of(&session(2), 0.5, "drawn_from = []");
        assert_eq!(absent.outcome, TrialOutcome::Refuted, "{absent:?}");
    }

    /// A drag that is independent of speed is not one that increases with it.
    #[test]
    fn better_explanations_prevent_confirmation() {
        let drag = session_with(5, &[(Term::named(effect_named("guide_drag").unwrap()), &[0.5])]);
        let constant = trial_of(&drag, 0.5, "drawn_from = []");
        assert_ne!(constant.outcome, TrialOutcome::Confirmed, "{constant:?}");
    }

    /// Constants after those that a fit shifts keep their start values.
    #[test]
    fn effects_with_many_constants_are_tested() {
        let shapes: String = ["b", "c", "d", "e"]
            .iter()
            .map(|name| format!("parameters.{name} = {{ start = 1, low = 0.5, high = 2, unit = \"1\" }}\n"))
            .collect();
        let file = format!(
            "schema = \"pinswitch.effects/1\"\n[[effect]]\nid = \"mine\"\nside = \"rig\"\ncovariate = \"position\"\n\
             acts_on = \"reading\"\ncombine = \"add\"\nformula = \"a*exp(-b*stroke)*(1 + c*stroke^2)/(1 + d*stroke^3)/(1 + e*stroke^5)\"\n\
             parameters.a = {{ size = true, start = 0.5, unit = \"N\" }}\n{shapes}"
        );
        let vocabulary = Vocabulary::built_in().read(&file, "mine.toml").unwrap();
        let trial = calibrate(&session(6), &vocabulary, 1).unwrap().report.trials[0].clone();
        assert!(trial.probability.is_some_and(f64::is_finite) && trial.size.is_some(), "{trial:?}");
    }

    #[test]
    fn small_sizes_refute_a_large_hypothesis() {
        let trial = trial_of(&session(4), 5.0, "drawn_from = []");
        assert_eq!(trial.outcome, TrialOutcome::Refuted, "{trial:?}");
    }
}
