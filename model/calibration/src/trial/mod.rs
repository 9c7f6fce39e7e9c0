//! Tests of user-defined effects: whether a table confirms, refutes or does not decide each.
//!
//! An effect is tested alone, with its shape fixed at its start values, so that the hypothesis does
//! not depend on the table: one degree of freedom, and no correction for a search. Readings from
//! which a form was derived are excluded from its test. Other effects of the table remain in the
//! model.

mod beside;
mod claim;
mod nearby;

use serde::{Deserialize, Serialize};

use crate::effects::EffectDefinition;
use crate::inference::{Observations, Selection, Weighed};
use crate::report::{Estimate, UnequalReport};
use crate::table::{PlateauRow, matching_sessions};

use beside::{Beside, InItsPlace, beside};
use claim::Found;
use nearby::nearby;

/// Probability by chance below which an effect is confirmed if it reaches [`CONFIRMED_SHARE`] of
/// its start value.
pub const CONFIRMED_P: f64 = 0.01;
/// Share of its start value that an absent effect rarely reaches by chance.
pub const CONFIRMED_SHARE: f64 = 0.5;
/// Probability by chance below which an effect is confirmed at any size.
pub const CERTAIN_P: f64 = 1e-5;
/// Smallest share of the structure in its place that a derived form must explain to be the same,
/// since its ends or phase may differ; and that of an effect written by a person.
const IS_THAT: [f64; 2] = [0.5, 0.75];
/// Share below which the hypothesis explains only part of the structure.
const IS_ALL: f64 = 0.85;
/// Fewest readings of other sessions for a test of a derived form.
const LEAST_ROWS: usize = 20;

/// Outcome of a test.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum TrialOutcome {
    /// The effect is present: its size is significant at [`CONFIRMED_P`] and at least half its
    /// start value, or significant at [`CERTAIN_P`]. A derived or one-sided effect must have the
    /// sign of its start value.
    Confirmed,
    /// The effect is absent. For a derived effect: the interval does not reach the derived size.
    /// For one written by a person, whose start value is a typical size: the interval excludes half
    /// of it in every allowed direction.
    Refuted,
    /// Not decided: the table does not identify the effect, or another effect explains it equally
    /// well.
    Open,
    /// The effect was derived from these readings, which cannot confirm it.
    Drawn,
}

impl TrialOutcome {
    /// Returns the word in reports.
    pub fn as_str(self) -> &'static str {
        match self {
            TrialOutcome::Confirmed => "confirmed",
            TrialOutcome::Refuted => "refuted",
            TrialOutcome::Open => "open",
            TrialOutcome::Drawn => "drawn",
        }
    }
}

/// Test of one user-defined effect.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TrialReport {
    /// Id.
    pub id: String,
    /// Outcome.
    pub outcome: TrialOutcome,
    /// Probability of such a size by chance, for this effect alone; absent if it could not be
    /// tested.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub p_value: Option<f64>,
    /// Size with all shapes fixed at their start values; absent if it could not be tested.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub size: Option<Estimate>,
    /// Start value of the size: the derived size of a form.
    pub start: f64,
    /// Whether the start value was derived from other readings, rather than given as typical.
    #[serde(default)]
    pub was_drawn: bool,
    /// Further information, such as other effects in the model, or why the test is not decisive.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub note: Option<String>,
}

impl TrialReport {
    /// Revises the outcome for differences between sessions: an effect that is absent in a session
    /// is not an effect of the rig. A derived effect is already tested only on sessions from which
    /// it was not derived.
    #[must_use]
    pub(crate) fn beside(self, unequal: &[UnequalReport]) -> Self {
        let is_everywhere =
            |told: &UnequalReport| told.sizes.iter().all(|s| s.size.ci95[0] > 0.0 || s.size.ci95[1] < 0.0);
        match unequal.iter().find(|told| told.id == self.id) {
            Some(told)
                if self.outcome == TrialOutcome::Confirmed && !self.was_drawn && !is_everywhere(told) =>
            {
                let note = "its size differs between sessions and is zero in one of them".to_owned();
                Self { outcome: TrialOutcome::Open, note: Some(note), ..self }
            }
            _ => self,
        }
    }

    /// Returns size, hypothesis, probability and note in one line.
    pub fn words(&self) -> String {
        let known = if self.was_drawn { "derived before" } else { "typical" };
        let size = self.size.as_ref().zip(self.p_value).map(|(size, p_value)| {
            let [low, high] = size.ci95;
            format!(
                "here {:.4} [{low:.4}, {high:.4}] {} ({known}: {:.4}), p = {p_value:.2e}",
                size.value, size.unit, self.start
            )
        });
        let told: Vec<String> = size.into_iter().chain(self.note.clone()).collect();
        told.join("; ")
    }
}

/// Tests all user-defined effects in the vocabulary of a selection, in the order in which they were
/// read. `rows` are those of the table.
pub fn trials(rows: &[PlateauRow], selection: &Selection, data: &Observations) -> Vec<TrialReport> {
    let vocabulary = &selection.augmented.model.vocabulary;
    vocabulary.own().filter_map(|own| trial(own.definition(), rows, selection, data)).collect()
}

fn trial(
    definition: &EffectDefinition,
    rows: &[PlateauRow],
    selection: &Selection,
    data: &Observations,
) -> Option<TrialReport> {
    let (claim, first) = (Claim::of(definition)?, definition.parameters.first()?);
    let told = TrialReport {
        id: definition.id.clone(),
        outcome: TrialOutcome::Drawn,
        p_value: None,
        size: None,
        start: claim.start,
        was_drawn: claim.was_drawn,
        note: None,
    };
    let seen = unseen_part(definition, rows, data);
    let data = seen.as_ref().unwrap_or(data);
    if data.points.len() < LEAST_ROWS && seen.is_some() {
        let note = "derived from these readings; other data can confirm it";
        return Some(TrialReport { note: Some(note.to_owned()), ..told });
    }
    let weighed = Weighed::new(data, selection.noise);
    let Some(Beside { found, structure, rival, explains }) = beside(definition, selection, &weighed) else {
        let note = "not identifiable with this table";
        return Some(TrialReport { outcome: TrialOutcome::Open, note: Some(note.to_owned()), ..told });
    };
    let outcome = claim.outcome(found, structure.is_some());
    let is_named = selection.effects.iter().any(|e| e.ids().contains(&definition.id.as_str()));
    let (outcome, note) = match (outcome, structure) {
        // The search fits shapes, which a trial does not. A derived effect is attributed only
        // through its trial.
        (TrialOutcome::Refuted, _) if is_named && !claim.was_drawn => {
            let note = "not at the start values of its shapes; see the effects of the model";
            (TrialOutcome::Open, Some(note.to_owned()))
        }
        // A location is less certain than its interval: a similar effect at a slightly different
        // place is not a refutation.
        (TrialOutcome::Refuted, _) if let Some(note) = nearby(definition, claim, selection, &weighed) => {
            (TrialOutcome::Open, Some(note))
        }
        (outcome, Some(covariate)) => {
            (outcome, Some(format!("it does not explain the remaining structure along {covariate}")))
        }
        (TrialOutcome::Confirmed, None) => {
            let part = explains.filter(|share| *share < IS_ALL).map(|share| {
                format!("it explains {:.0} % of the structure there, so it is only part of it", 100.0 * share)
            });
            (outcome, part)
        }
        (outcome, None) => (outcome, None),
    };
    // A table does not confirm one of two equally good explanations.
    let (outcome, note) = match (rival, outcome) {
        (Some((name, InItsPlace::AsWell)), TrialOutcome::Confirmed) => {
            (TrialOutcome::Open, Some(format!("{name} explains the table equally well")))
        }
        (Some((name, InItsPlace::Better)), outcome) => {
            (outcome, Some(format!("{name} explains more in its place")))
        }
        (_, outcome) => (outcome, note),
    };
    let Found { value, half, p_value } = found;
    let size = Estimate { value, ci95: [value - half, value + half], unit: first.unit.clone() };
    Some(TrialReport { outcome, p_value: Some(p_value), size: Some(size), note, ..told })
}

/// Returns the readings from which an effect was not derived; `None` if these are all readings.
fn unseen_part(
    definition: &EffectDefinition,
    rows: &[PlateauRow],
    data: &Observations,
) -> Option<Observations> {
    if definition.drawn_from.is_empty() {
        return None;
    }
    let told = matching_sessions(rows, &definition.drawn_from);
    let is_seen = |session: &str| told.contains(session);
    let seen: Vec<bool> =
        data.source.iter().map(|row| rows.get(*row).is_some_and(|r| is_seen(&r.labels.session))).collect();
    seen.contains(&true).then(|| data.subset(|row| !seen[row]))
}

/// Hypothesis about a size.
#[derive(Clone, Copy, Debug)]
struct Claim {
    start: f64,
    was_drawn: bool,
    one_sided: bool,
}

impl Claim {
    fn of(definition: &EffectDefinition) -> Option<Self> {
        let was_drawn = !definition.drawn_from.is_empty();
        let start = definition.parameters.first()?.start;
        Some(Self { start, was_drawn, one_sided: definition.one_sided })
    }

    /// If the model contains structure that the hypothesis does not explain, shapes leave residuals
    /// of it that resemble many effects. Size and significance must then both be sufficient.
    fn outcome(self, found: Found, is_beside_structure: bool) -> TrialOutcome {
        let (share, half) = (found.value / self.start, (found.half / self.start).abs());
        // The sign is part of the hypothesis only if it was derived, or the effect is one-sided.
        let share = if self.was_drawn || self.one_sided { share } else { share.abs() };
        let chance = if is_beside_structure { CERTAIN_P } else { CONFIRMED_P };
        let is_large = share >= CONFIRMED_SHARE && found.p_value < chance;
        let claimed = if self.was_drawn { 1.0 } else { CONFIRMED_SHARE };
        let is_certain = found.p_value < CERTAIN_P && !is_beside_structure;
        if (is_large || is_certain) && share > half {
            TrialOutcome::Confirmed
        } else if share + half < claimed {
            TrialOutcome::Refuted
        } else {
            TrialOutcome::Open
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::calibrate_among;
    use crate::effects::{Vocabulary, effect_named};
    use crate::inference::{Levels, Term};
    use crate::test_session::{session, session_with};

    fn tried(rows: &[crate::table::PlateauRow], start: f64) -> TrialReport {
        tried_as(rows, "load", "a", start, "")
    }

    fn tried_as(
        rows: &[crate::table::PlateauRow],
        covariate: &str,
        formula: &str,
        start: f64,
        shapes: &str,
    ) -> TrialReport {
        let text = file(covariate, "reading\"\ncombine = \"add", formula, start, "N") + shapes;
        tried_in(rows, &text)
    }

    fn file(covariate: &str, acts_on: &str, formula: &str, start: f64, unit: &str) -> String {
        format!(
            "schema = \"pinswitch.effects/1\"\n[[effect]]\nid = \"mine\"\nside = \"rig\"\ncovariate = \"{covariate}\"\n\
             acts_on = \"{acts_on}\"\nformula = \"{formula}\"\n\
             parameters.a = {{ size = true, start = {start}, unit = \"{unit}\" }}\n"
        )
    }

    fn tried_in(rows: &[crate::table::PlateauRow], file: &str) -> TrialReport {
        let vocabulary = Vocabulary::built_in().read(file, "mine.toml").unwrap();
        let report = calibrate_among(rows, &vocabulary, Levels::default()).unwrap().report;
        report.trials[0].clone()
    }

    /// A constant factor on the wrap, or on free thresholds, is not identifiable, whatever its
    /// stated size.
    #[test]
    fn absorbed_effects_stay_open() {
        for (acts_on, start) in [("threshold", 0.3), ("threshold", 2.0), ("wrap", 0.3), ("wrap", 1.0)] {
            let text = file("load", &format!("{acts_on}\"\ncombine = \"factor"), "a", start, "1");
            let vocabulary = Vocabulary::built_in().read(&text, "mine.toml").unwrap();
            let report = calibrate_among(&session(2), &vocabulary, Levels::default()).unwrap().report;
            let trial = &report.trials[0];
            assert_eq!(trial.outcome, TrialOutcome::Open, "{acts_on} {start}: {trial:?}");
            assert!(
                !report.limits.iter().any(|limit| limit.id == "mine"),
                "{acts_on} {start}: {:?}",
                report.limits
            );
        }
    }

    /// A drag that is independent of speed is not one that increases with it, although both change
    /// the readings alike.
    #[test]
    fn better_explanations_prevent_confirmation() {
        let viscous =
            file("speed", "tension\"\ncombine = \"add", "a*direction*(0.4 + 0.6*speed_pct/52)", 0.5, "N");
        let vocabulary = Vocabulary::built_in().read(&viscous, "mine.toml").unwrap();
        let told = |effect| tried_in(&session_with(5, &[(Term::Named(effect), &[0.5])]), &viscous);
        let there = told(vocabulary.named("mine").unwrap());
        assert_eq!(there.outcome, TrialOutcome::Confirmed, "{there:?}");
        let constant = told(effect_named("guide_drag").unwrap());
        assert_eq!(constant.outcome, TrialOutcome::Refuted, "{constant:?}");
        assert!(constant.note.as_ref().unwrap().contains("guide_drag"), "{constant:?}");
    }

    #[test]
    fn present_effects_are_confirmed() {
        let offset = effect_named("load_cell_offset").unwrap();
        let with = session_with(1, &[(Term::Named(offset), &[0.5])]);
        let there = tried(&with, 0.5);
        assert!(there.outcome == TrialOutcome::Confirmed && there.p_value.unwrap() < 1e-6, "{there:?}");
        let [low, high] = there.size.clone().unwrap().ci95;
        assert!(low < 0.5 && 0.5 < high, "{there:?}");
        let absent = tried(&session(2), 0.5);
        assert!(
            absent.outcome == TrialOutcome::Refuted && absent.p_value.unwrap() > CONFIRMED_P,
            "{absent:?}"
        );
        // A typical size implies no sign, and a hypothesis that is too small to detect stays open.
        assert_eq!(tried(&with, -0.5).outcome, TrialOutcome::Confirmed);
        assert_eq!(tried(&session(2), 1e-4).outcome, TrialOutcome::Open);
    }

    /// Forces are not linear in friction coefficients: an effect five times the hypothesised size
    /// is reported at its true size.
    #[test]
    fn estimates_are_independent_of_hypothesised_size() {
        let friction = |start| file("position", "mu\"\ncombine = \"factor", "a*stroke", start, "1");
        let vocabulary = Vocabulary::built_in().read(&friction(0.5), "mine.toml").unwrap();
        for seed in 1..=3 {
            let rows = session_with(seed, &[(Term::Named(vocabulary.named("mine").unwrap()), &[0.5])]);
            let [known, small] = [0.5, 0.1].map(|start| tried_in(&rows, &friction(start)).size.unwrap());
            let [low, high] = small.ci95;
            assert!((known.value / small.value - 1.0).abs() < 0.01, "{known:?} {small:?}");
            assert!((0.5 / small.value - 1.0).abs() < 0.1 && low < high, "{small:?}");
        }
    }

    /// A part of an effect that is not identifiable is not confirmed by the rest of it.
    #[test]
    fn several_sizes_keep_their_ratio() {
        let text = |a: f64, b: f64| {
            file("position", "reading\"\ncombine = \"add", "a*ln(dwell_s/3) + b*(stroke - 0.5)", a, "N")
                + &format!("parameters.b = {{ size = true, start = {b}, unit = \"N\" }}\n")
        };
        let vocabulary = Vocabulary::built_in().read(&text(0.1, 0.4), "mine.toml").unwrap();
        let rows = session_with(1, &[(Term::Named(vocabulary.named("mine").unwrap()), &[0.0, 0.4])]);
        let there = tried_in(&rows, &text(0.1, 0.4));
        assert_eq!(there.outcome, TrialOutcome::Confirmed, "{there:?}");
        // One factor for both sizes: its interval is that of the factor, and not wider than the
        // size.
        let [low, high] = there.size.clone().unwrap().ci95;
        assert!(low < 0.1 && 0.1 < high && high - low < 0.05, "{there:?}");
        let other_way = tried_in(&rows, &text(0.1, -0.4));
        // In that ratio it is present with the opposite sign.
        assert!(other_way.size.clone().unwrap().ci95[1] < 0.0, "{other_way:?}");
    }

    /// The hypothesis is the shape at its start values, whether or not its constants are free in a
    /// fit: the best of many places is found by chance more often than a particular one.
    #[test]
    fn free_shapes_are_tested_at_start() {
        let wave = "sin(6.2831853*TIMES*stroke + PHASE)";
        for seed in 1..=6 {
            let free = tried_as(
                &session(seed),
                "position",
                &format!("a*{}", wave.replace("TIMES", "n").replace("PHASE", "p")),
                0.1,
                "parameters.n = { start = 2.0, low = 0.5, high = 9.0, unit = \"1\" }\n\
                 parameters.p = { start = 0.3, low = -3.0, high = 3.0, unit = \"1\" }\n",
            );
            let written_out = wave.replace("TIMES", "2.0").replace("PHASE", "0.3");
            let fixed = tried_as(&session(seed), "position", &format!("a*{written_out}"), 0.1, "");
            let near = |a: f64, b: f64| (a - b).abs() < 0.1 * b.abs().max(0.01);
            assert!(near(free.p_value.unwrap(), fixed.p_value.unwrap()), "{free:?} {fixed:?}");
            assert!(
                near(free.size.clone().unwrap().value, fixed.size.clone().unwrap().value),
                "{free:?} {fixed:?}"
            );
        }
    }

    #[test]
    fn outcomes_depend_on_interval_and_significance() {
        let of = |was_drawn, one_sided, start, value, half, p_value| {
            Claim { start, was_drawn, one_sided }.outcome(Found { value, half, p_value }, false)
        };
        let drawn = |start, value, half, p_value| of(true, false, start, value, half, p_value);
        assert_eq!(drawn(0.1, 0.08, 0.03, 1e-4), TrialOutcome::Confirmed);
        assert_eq!(drawn(-0.1, -0.08, 0.03, 1e-4), TrialOutcome::Confirmed);
        assert_eq!(drawn(-0.1, 0.08, 0.03, 1e-4), TrialOutcome::Refuted);
        // Chance reaches a probability below 0.01 once in about a hundred tables.
        assert_eq!(drawn(0.163, 0.077, 0.051, 3.5e-3), TrialOutcome::Refuted);
        assert_eq!(drawn(0.163, 0.077, 0.09, 3.5e-3), TrialOutcome::Open);
        assert_eq!(drawn(0.163, 0.077, 0.01, 1e-12), TrialOutcome::Confirmed);
        assert_eq!(drawn(0.1, 0.01, 0.03, 0.5), TrialOutcome::Refuted);
        assert_eq!(drawn(0.1, 0.05, 0.08, 0.2), TrialOutcome::Open);
        // An effect that chance does not explain may be part of other structure.
        let part = Found { value: 0.034, half: 0.011, p_value: 1e-6 };
        let claim = Claim { start: 0.116, was_drawn: true, one_sided: false };
        assert_eq!(claim.outcome(part, false), TrialOutcome::Confirmed);
        assert_eq!(claim.outcome(part, true), TrialOutcome::Refuted);
        let leftover = Found { value: 0.1, half: 0.05, p_value: 1e-4 };
        assert_eq!(claim.outcome(leftover, false), TrialOutcome::Confirmed);
        assert_eq!(claim.outcome(leftover, true), TrialOutcome::Open);
        // An interval that contains zero confirms nothing, whatever the score.
        assert_eq!(drawn(0.1, 0.3, 0.5, 1e-9), TrialOutcome::Open);
        // A typical size is not a hypothesis about the size, and about the sign only for a
        // one-sided effect.
        let written = |one_sided, value, half| of(false, one_sided, 0.1, value, half, 1e-4);
        assert_eq!(written(false, -0.08, 0.03), TrialOutcome::Confirmed);
        assert_eq!(written(true, -0.08, 0.03), TrialOutcome::Refuted);
        assert_eq!(of(false, true, 4.0, 1.6, 1.2, 9e-3), TrialOutcome::Open);
        assert_eq!(of(false, false, 0.1, 0.001, 0.02, 0.9), TrialOutcome::Refuted);
        assert_eq!(of(false, false, 0.1, -0.02, 0.04, 0.3), TrialOutcome::Open);
    }
}
