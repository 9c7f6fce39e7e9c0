//! What a table says of each effect of one's own: whether it confirms the effect, refutes it, or cannot tell.
//!
//! The effect is put on trial alone, with its shape held where its definition starts it, so that nothing of the table went
//! into what is asked: one question, one degree of freedom, no correction for a search.

use serde::{Deserialize, Serialize};

use crate::effects::{Effect, EffectDefinition};
use crate::inference::{
    Model, Observations, Reliability, Screen, Selection, Term, Weighed, coordinate_covariance,
    family_p_value, fit, gain_at, jacobian,
};
use crate::report::Estimate;

/// Probability by chance below which an effect counts as confirmed, if it has at least [`CONFIRMED_SHARE`] of its start
/// value.
pub const CONFIRMED_P: f64 = 0.01;
/// Share of its start value that chance rarely makes where the effect is absent.
pub const CONFIRMED_SHARE: f64 = 0.5;
/// Probability by chance below which an effect counts as confirmed whatever its size.
pub const CERTAIN_P: f64 = 1e-5;
/// Length of a trace in standard deviations below which the table does not see the effect.
const LEAST_STRENGTH: f64 = 1e-6;

/// What a table says of an effect that was known before.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum TrialOutcome {
    /// It is there, in the direction of its start value: by chance with a probability below [`CONFIRMED_P`] and at least half
    /// as large, or below [`CERTAIN_P`].
    Confirmed,
    /// It is not there at its start value: the interval of its size does not reach it, and it is not confirmed.
    Refuted,
    /// Neither: the table cannot tell.
    Open,
}

impl TrialOutcome {
    /// Its word.
    pub fn as_str(self) -> &'static str {
        match self {
            TrialOutcome::Confirmed => "confirmed",
            TrialOutcome::Refuted => "refuted",
            TrialOutcome::Open => "open",
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
    /// Probability of such a gain by chance, of this one effect.
    pub p_value: f64,
    /// Its size with all shapes held at their start values.
    pub size: Estimate,
    /// The size that its definition starts from: that which was drawn, for a form.
    pub start: f64,
}

/// The trials of all effects of one's own in the vocabulary of a selection, in the order in which they were read.
pub fn trials(selection: &Selection, data: &Observations) -> Vec<TrialReport> {
    let vocabulary = selection.augmented.model.vocabulary.clone();
    let weighed = Weighed::new(data, selection.noise);
    vocabulary.own().filter_map(|own| trial(own.definition(), selection, data, &weighed)).collect()
}

fn trial(
    definition: &EffectDefinition,
    selection: &Selection,
    data: &Observations,
    weighed: &Weighed<'_>,
) -> Option<TrialReport> {
    let mut model = selection.augmented.model.clone();
    let effect = model.vocabulary.named(&definition.id)?;
    // Shapes without a name would take over what is on trial, and so would names that it is a rival of; the others stay.
    let is_rival_of = |id: &str| {
        selection.effects.iter().any(|e| e.effect.id() == id && e.ids().contains(&definition.id.as_str()))
    };
    let stands_aside = |term: &Term| match term {
        Term::Named(named) => is_rival_of(named.id()),
        Term::Structure(_) => true,
    };
    while let Some(at) = model.terms.iter().position(stands_aside) {
        model = model.without_term(at);
    }
    let without = fit(&model, weighed);
    let claimed: Vec<f64> = definition.parameters.iter().map(|p| p.start).collect();
    let score = Screen::new(&without, weighed)
        .effect_at(effect, claimed.clone())
        .filter(|s| s.strength > LEAST_STRENGTH)?;
    let predicted: Vec<f64> = data.force_n.iter().zip(&without.residual_n).map(|(y, r)| y - r).collect();
    let own = jacobian(&without.model, data, &predicted);
    let degrees =
        Reliability::new(data, selection.noise, &own).degrees(data, &score.trace_n, score.strength.powi(2));
    let sizes = definition.parameters.iter().filter(|p| p.bounds.is_none()).count();
    let (value, sd) = if sizes == 1 {
        size_as_claimed(&without.model, effect, &claimed, weighed)?
    } else {
        // Of several sizes the claim is their ratio, too: one factor for all, to first order.
        (score.size * score.share, score.size.abs() / score.strength)
    };
    let half = gain_at(0.05, 1, degrees).sqrt() * sd;
    let p_value = family_p_value(score.gain, 1, degrees);
    let size = definition.parameters.first()?;
    let start = size.start;
    Some(TrialReport {
        id: definition.id.clone(),
        outcome: outcome(start, value, half, p_value),
        p_value,
        size: Estimate { value, ci95: [value - half, value + half], unit: size.unit.clone() },
        start,
    })
}

/// The one size of an effect whose shapes are held as claimed, and its standard deviation: fitted, since what friction
/// does is in proportion to no coefficient. `None` where the fit leaves the numbers, or the table does not know the size.
fn size_as_claimed(
    without: &Model,
    effect: &'static dyn Effect,
    claimed: &[f64],
    weighed: &Weighed<'_>,
) -> Option<(f64, f64)> {
    let with = without.with_term(Term::Named(effect), claimed);
    let at = with.term_offset(without.terms.len());
    let free: Vec<usize> = (0..=at).collect();
    let fitted = fit(&with.frozen_except(&free), weighed);
    let (value, slope) = fitted.model.value(at);
    let variance = coordinate_covariance(&fitted, weighed)[(at, at)];
    let is_known = fitted.cost.is_finite() && value.is_finite() && variance.is_finite() && variance > 0.0;
    is_known.then(|| (value, slope.abs() * variance.sqrt()))
}

fn outcome(start: f64, value: f64, half: f64, p_value: f64) -> TrialOutcome {
    let (share, half) = (value / start, (half / start).abs());
    let is_large = share >= CONFIRMED_SHARE && p_value < CONFIRMED_P;
    if is_large || (share > 0.0 && p_value < CERTAIN_P) {
        TrialOutcome::Confirmed
    } else if share + half < 1.0 {
        TrialOutcome::Refuted
    } else {
        TrialOutcome::Open
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::calibrate_among;
    use crate::effects::{Vocabulary, effect_named};
    use crate::inference::Levels;
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

    #[test]
    fn what_is_there_is_confirmed_and_what_is_not_is_refuted() {
        let offset = effect_named("load_cell_offset").unwrap();
        let with = session_with(1, &[(Term::Named(offset), &[0.5])]);
        let there = tried(&with, 0.5);
        assert!(there.outcome == TrialOutcome::Confirmed && there.p_value < 1e-6, "{there:?}");
        assert!(there.size.ci95[0] < 0.5 && 0.5 < there.size.ci95[1], "{there:?}");
        let absent = tried(&session(2), 0.5);
        assert!(absent.outcome == TrialOutcome::Refuted && absent.p_value > CONFIRMED_P, "{absent:?}");
        // The other sign is another claim, and a claim too small to see stays open.
        assert_ne!(tried(&with, -0.5).outcome, TrialOutcome::Confirmed);
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
            let [known, small] = [0.5, 0.1].map(|start| tried_in(&rows, &friction(start)));
            let [low, high] = small.size.ci95;
            assert!((known.size.value / small.size.value - 1.0).abs() < 0.01, "{known:?} {small:?}");
            assert!((0.5 / small.size.value - 1.0).abs() < 0.1 && low < high, "{small:?}");
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
        let [low, high] = there.size.ci95;
        assert!(low < 0.1 && 0.1 < high && high - low < 0.05, "{there:?}");
        let other_way = tried_in(&rows, &text(0.1, -0.4));
        assert_ne!(other_way.outcome, TrialOutcome::Confirmed, "{other_way:?}");
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
            assert!(near(free.p_value, fixed.p_value), "{} {}", free.p_value, fixed.p_value);
            assert!(near(free.size.value, fixed.size.value), "{:?} {:?}", free.size, fixed.size);
        }
    }

    #[test]
    fn an_outcome_is_decided_by_interval_and_chance() {
        assert_eq!(outcome(0.1, 0.08, 0.03, 1e-4), TrialOutcome::Confirmed);
        assert_eq!(outcome(-0.1, -0.08, 0.03, 1e-4), TrialOutcome::Confirmed);
        assert_eq!(outcome(-0.1, 0.08, 0.03, 1e-4), TrialOutcome::Refuted);
        // Chance makes a little of everything: once in some hundred tables with a probability below 0.01.
        assert_eq!(outcome(0.163, 0.077, 0.051, 3.5e-3), TrialOutcome::Refuted);
        assert_eq!(outcome(0.163, 0.077, 0.09, 3.5e-3), TrialOutcome::Open);
        assert_eq!(outcome(0.163, 0.077, 0.01, 1e-12), TrialOutcome::Confirmed);
        assert_eq!(outcome(0.1, 0.01, 0.03, 0.5), TrialOutcome::Refuted);
        assert_eq!(outcome(0.1, 0.05, 0.08, 0.2), TrialOutcome::Open);
    }
}
