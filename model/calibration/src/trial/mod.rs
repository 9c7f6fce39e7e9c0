//! What a table says of each effect of one's own: whether it confirms the effect, refutes it, or cannot tell.
//!
//! The effect is put on trial alone, with its shape held where its definition starts it, so that nothing of the table went
//! into what is asked: one question, one degree of freedom, no correction for a search. Readings that a form was drawn from
//! have no part in its trial, and what else the table was found to hold stands beside it.

mod beside;
mod claim;
mod nearby;

use serde::{Deserialize, Serialize};

use crate::effects::EffectDefinition;
use crate::inference::{Observations, Selection, Weighed};
use crate::report::{Estimate, UnequalReport};
use crate::table::{PlateauRow, sessions_told};

use beside::{Beside, InItsPlace, beside};
use claim::Found;
use nearby::nearby;

/// Probability by chance below which an effect counts as confirmed, if it has at least [`CONFIRMED_SHARE`] of its start
/// value.
pub const CONFIRMED_P: f64 = 0.01;
/// Share of its start value that chance rarely makes where the effect is absent.
pub const CONFIRMED_SHARE: f64 = 0.5;
/// Probability by chance below which an effect counts as confirmed whatever its size.
pub const CERTAIN_P: f64 = 1e-5;
/// Share of what stands in its place that a form drawn before must explain to be what was found there, whose ends or phase may
/// be others; and one that somebody wrote down.
const IS_THAT: [f64; 2] = [0.5, 0.75];
/// Share of it below which something is there, and not quite what was claimed.
const IS_ALL: f64 = 0.85;
/// Readings of sessions that had no part in drawing a form without which nothing is asked.
const LEAST_ROWS: usize = 20;

/// What a table says of an effect that was known before.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum TrialOutcome {
    /// It is there: its size is not zero, by chance with a probability below [`CONFIRMED_P`] and at least half as large as its
    /// start value, or below [`CERTAIN_P`]. Of what was drawn before, or is one-sided, in the direction of that value.
    Confirmed,
    /// It is not there. Of what was drawn before: not at the size that was drawn, which the interval does not reach. Of what
    /// somebody wrote down, whose start value is what is typical: not at half of that, in no direction that it can have.
    Refuted,
    /// Neither: the table cannot tell, or a name explains it as well in its place.
    Open,
    /// The effect was drawn from these very readings, which cannot confirm it.
    Drawn,
}

impl TrialOutcome {
    /// Its word.
    pub fn as_str(self) -> &'static str {
        match self {
            TrialOutcome::Confirmed => "confirmed",
            TrialOutcome::Refuted => "refuted",
            TrialOutcome::Open => "open",
            TrialOutcome::Drawn => "drawn",
        }
    }
}

/// The trial of one effect of one's own.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TrialReport {
    /// Its id.
    pub id: String,
    /// What the table says.
    pub outcome: TrialOutcome,
    /// Probability of such a size by chance, of this one effect; absent if nothing could be asked.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub p_value: Option<f64>,
    /// Its size with all shapes held at their start values; absent if nothing could be asked.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub size: Option<Estimate>,
    /// The size that its definition starts from: that which was drawn, for a form.
    pub start: f64,
    /// Whether that size was drawn from other readings, or is what somebody thinks typical.
    #[serde(default)]
    pub was_drawn: bool,
    /// What else there is to know of it: what stood beside it, or why the table cannot tell.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub note: Option<String>,
}

impl TrialReport {
    /// The same beside what differs between sessions: what one session has and another has not is no effect of the rig. Of what
    /// was drawn only sessions that it was not drawn from were asked.
    #[must_use]
    pub(crate) fn beside(self, unequal: &[UnequalReport]) -> Self {
        let is_everywhere =
            |told: &UnequalReport| told.sizes.iter().all(|s| s.size.ci95[0] > 0.0 || s.size.ci95[1] < 0.0);
        match unequal.iter().find(|told| told.id == self.id) {
            Some(told)
                if self.outcome == TrialOutcome::Confirmed && !self.was_drawn && !is_everywhere(told) =>
            {
                let note = "its size is not the same in all sessions, and zero in one of them".to_owned();
                Self { outcome: TrialOutcome::Open, note: Some(note), ..self }
            }
            _ => self,
        }
    }

    /// Size, claim, chance and note, in one line.
    pub fn words(&self) -> String {
        let known = if self.was_drawn { "drawn before" } else { "typical" };
        let size = self.size.as_ref().zip(self.p_value).map(|(size, p_value)| {
            let [low, high] = size.ci95;
            format!(
                "here {:.4} [{low:.4}, {high:.4}] {} against {:.4} {known}, p = {p_value:.2e}",
                size.value, size.unit, self.start
            )
        });
        let told: Vec<String> = size.into_iter().chain(self.note.clone()).collect();
        told.join("; ")
    }
}

/// The trials of all effects of one's own in the vocabulary of a selection, in the order in which they were read. `rows` are
/// those of the table.
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
        let note = "these are the readings that it was drawn from: other data can confirm it";
        return Some(TrialReport { note: Some(note.to_owned()), ..told });
    }
    let weighed = Weighed::new(data, selection.noise);
    let Some(Beside { found, structure, rival, explains }) = beside(definition, selection, &weighed) else {
        let note = "this table cannot show it";
        return Some(TrialReport { outcome: TrialOutcome::Open, note: Some(note.to_owned()), ..told });
    };
    let outcome = claim.outcome(found, structure.is_some());
    let is_named = selection.effects.iter().any(|e| e.ids().contains(&definition.id.as_str()));
    let (outcome, note) = match (outcome, structure) {
        // The search moves shapes, which a trial does not. What was drawn is named by nothing but its trial.
        (TrialOutcome::Refuted, _) if is_named && !claim.was_drawn => {
            let note = "not where its shapes start: what the table has of it is named above";
            (TrialOutcome::Open, Some(note.to_owned()))
        }
        // Where something lies is less sure than what it is: what another session shows a little elsewhere is not absent.
        (TrialOutcome::Refuted, _) if let Some(note) = nearby(definition, claim, selection, &weighed) => {
            (TrialOutcome::Open, Some(note))
        }
        (outcome, Some(covariate)) => {
            (outcome, Some(format!("beside structure along {covariate} that it does not explain")))
        }
        (TrialOutcome::Confirmed, None) => {
            let part = explains.filter(|share| *share < IS_ALL).map(|share| {
                format!("it explains {:.0} % of what shapes do there: it is not quite this", 100.0 * share)
            });
            (outcome, part)
        }
        (outcome, None) => (outcome, None),
    };
    // One of two that explain a table alike is not confirmed by it.
    let (outcome, note) = match (rival, outcome) {
        (Some((name, InItsPlace::AsWell)), TrialOutcome::Confirmed) => {
            (TrialOutcome::Open, Some(format!("{name} explains the table as well in its place")))
        }
        (Some((name, InItsPlace::Better)), outcome) => {
            (outcome, Some(format!("beside {name}, which explains more in its place")))
        }
        (_, outcome) => (outcome, note),
    };
    let Found { value, half, p_value } = found;
    let size = Estimate { value, ci95: [value - half, value + half], unit: first.unit.clone() };
    Some(TrialReport { outcome, p_value: Some(p_value), size: Some(size), note, ..told })
}

/// The readings that had no part in drawing an effect; `None` if all had none.
fn unseen_part(
    definition: &EffectDefinition,
    rows: &[PlateauRow],
    data: &Observations,
) -> Option<Observations> {
    if definition.drawn_from.is_empty() {
        return None;
    }
    let told = sessions_told(rows, &definition.drawn_from);
    let is_seen = |session: &str| told.contains(session);
    let seen: Vec<bool> =
        data.source.iter().map(|row| rows.get(*row).is_some_and(|r| is_seen(&r.labels.session))).collect();
    seen.contains(&true).then(|| data.subset(|row| !seen[row]))
}

/// What is claimed of a size.
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

    /// Beside structure that the claim does not explain, what shapes leave of that looks like a little of anything: size and
    /// chance must both be right.
    fn outcome(self, found: Found, is_beside_structure: bool) -> TrialOutcome {
        let (share, half) = (found.value / self.start, (found.half / self.start).abs());
        // Which way a claim acts is part of it only if it was drawn, or physics allows no other.
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

    /// A constant factor on the wrap, or on thresholds that are free, is in no table, however large it is said to be.
    #[test]
    fn what_the_constants_take_over_is_neither_refuted_nor_excluded() {
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

    /// A drag that is the same at every speed is no drag that grows with it, however much both move the readings alike.
    #[test]
    fn what_a_name_explains_better_is_not_confirmed() {
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
    fn what_is_there_is_confirmed_and_what_is_not_is_refuted() {
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
        // A typical size claims no direction, and a claim too small to see stays open.
        assert_eq!(tried(&with, -0.5).outcome, TrialOutcome::Confirmed);
        assert_eq!(tried(&session(2), 1e-4).outcome, TrialOutcome::Open);
    }

    /// Forces are in proportion to no coefficient of friction: an effect five times as large as claimed is told as large
    /// as it is.
    #[test]
    fn the_size_of_a_large_effect_does_not_depend_on_the_size_claimed() {
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

    /// What the table cannot show of an effect is not confirmed by what it shows of the rest.
    #[test]
    fn several_sizes_are_tried_in_the_ratio_that_was_claimed() {
        let text = |a: f64, b: f64| {
            file("position", "reading\"\ncombine = \"add", "a*ln(dwell_s/3) + b*(stroke - 0.5)", a, "N")
                + &format!("parameters.b = {{ size = true, start = {b}, unit = \"N\" }}\n")
        };
        let vocabulary = Vocabulary::built_in().read(&text(0.1, 0.4), "mine.toml").unwrap();
        let rows = session_with(1, &[(Term::Named(vocabulary.named("mine").unwrap()), &[0.0, 0.4])]);
        let there = tried_in(&rows, &text(0.1, 0.4));
        assert_eq!(there.outcome, TrialOutcome::Confirmed, "{there:?}");
        // One factor for both sizes: the interval is that of the factor, and no wider than the size.
        let [low, high] = there.size.clone().unwrap().ci95;
        assert!(low < 0.1 && 0.1 < high && high - low < 0.05, "{there:?}");
        let other_way = tried_in(&rows, &text(0.1, -0.4));
        // In that ratio it is there the other way round.
        assert!(other_way.size.clone().unwrap().ci95[1] < 0.0, "{other_way:?}");
    }

    /// The claim is the shape that was drawn. Whether its constants may move when it is fitted is another matter: the best
    /// of many places is found by chance more often than the one that was claimed.
    #[test]
    fn a_shape_that_may_move_is_tried_where_it_was_claimed() {
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
    fn an_outcome_is_decided_by_interval_and_chance() {
        let of = |was_drawn, one_sided, start, value, half, p_value| {
            Claim { start, was_drawn, one_sided }.outcome(Found { value, half, p_value }, false)
        };
        let drawn = |start, value, half, p_value| of(true, false, start, value, half, p_value);
        assert_eq!(drawn(0.1, 0.08, 0.03, 1e-4), TrialOutcome::Confirmed);
        assert_eq!(drawn(-0.1, -0.08, 0.03, 1e-4), TrialOutcome::Confirmed);
        assert_eq!(drawn(-0.1, 0.08, 0.03, 1e-4), TrialOutcome::Refuted);
        // Chance makes a little of everything: once in some hundred tables with a probability below 0.01.
        assert_eq!(drawn(0.163, 0.077, 0.051, 3.5e-3), TrialOutcome::Refuted);
        assert_eq!(drawn(0.163, 0.077, 0.09, 3.5e-3), TrialOutcome::Open);
        assert_eq!(drawn(0.163, 0.077, 0.01, 1e-12), TrialOutcome::Confirmed);
        assert_eq!(drawn(0.1, 0.01, 0.03, 0.5), TrialOutcome::Refuted);
        assert_eq!(drawn(0.1, 0.05, 0.08, 0.2), TrialOutcome::Open);
        // What chance cannot make may be a part of other structure.
        let part = Found { value: 0.034, half: 0.011, p_value: 1e-6 };
        let claim = Claim { start: 0.116, was_drawn: true, one_sided: false };
        assert_eq!(claim.outcome(part, false), TrialOutcome::Confirmed);
        assert_eq!(claim.outcome(part, true), TrialOutcome::Refuted);
        let leftover = Found { value: 0.1, half: 0.05, p_value: 1e-4 };
        assert_eq!(claim.outcome(leftover, false), TrialOutcome::Confirmed);
        assert_eq!(claim.outcome(leftover, true), TrialOutcome::Open);
        // An interval that holds zero confirms nothing, whatever a score says.
        assert_eq!(drawn(0.1, 0.3, 0.5, 1e-9), TrialOutcome::Open);
        // What is typical is no claim of a size, and of a direction only where there is but one.
        let written = |one_sided, value, half| of(false, one_sided, 0.1, value, half, 1e-4);
        assert_eq!(written(false, -0.08, 0.03), TrialOutcome::Confirmed);
        assert_eq!(written(true, -0.08, 0.03), TrialOutcome::Refuted);
        assert_eq!(of(false, true, 4.0, 1.6, 1.2, 9e-3), TrialOutcome::Open);
        assert_eq!(of(false, false, 0.1, 0.001, 0.02, 0.9), TrialOutcome::Refuted);
        assert_eq!(of(false, false, 0.1, -0.02, 0.04, 0.3), TrialOutcome::Open);
    }
}
