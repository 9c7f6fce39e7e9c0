//! Open questions of a calibration: two explanations, the probability of the first one, and the log
//! odds that runs are expected to add.
//!
//! With the squared length `S` of the difference between the predictions of both explanations, in
//! standard deviations and without the part that the fitted constants absorb, the log odds of the
//! correct explanation increase by a normal variable with mean `S/2` and variance `S`. The recorded
//! data are in the reported probabilities; runs add `S(data and runs) - S(data)`.

use nalgebra::DMatrix;
use pinswitch_friction::published;
use statrs::distribution::{ContinuousCDF, Normal};

use super::information::{Contribution, Projected};
use crate::effects::{Covariate, Effect, SharedEffect, Side};
use crate::evidence::STRUCTURE_PROBABILITY;
use crate::model::{Model, Term};
use crate::report::{Fate, LimitReport, Report, TrialOutcome};
use crate::session_plan::{COVERED, FRICTION_ABOVE, NONE};

/// Probability from which an effect is reported.
const REPORTED: f64 = 0.9;
/// Probability up to which an explanation is not a rival of another one.
const NO_RIVAL: f64 = 0.05;
/// Probability of an effect that only new readings can confirm.
const UNDECIDED: f64 = 0.5;
/// Probability from which the data suggest an effect: twice the prior one.
const SUSPECTED: f64 = 0.1;
/// Smallest probability of an explanation that is not excluded, and largest one of an explanation
/// that is not established.
const OPEN: (f64, f64) = (0.01, 0.9);
/// Largest size of a rival, in units of its start value.
const LARGEST_SHARE: f64 = 30.0;
/// Nonnegative nodes for means over a standard normal variable, with their weights.
const NODES: [(f64, f64); 6] = [
    (0.0, 0.299_214),
    (0.75, 0.225_859),
    (1.5, 0.097_140_5),
    (2.25, 0.023_805_3),
    (3.0, 0.003_323_97),
    (3.75, 0.000_264_453),
];
/// Variable of formulas for the load of the previous series.
const LOAD_BEFORE: &str = "previous_load_n";

/// Two explanations that the data do not separate.
#[derive(Clone, Debug)]
pub(super) struct Question {
    /// Ids: the attributed or suspected effect, and the other one or `none`.
    pub(super) between: [String; 2],
    /// Size in question in the unit of the effect's first constant; `None` for other questions.
    pub(super) size: Option<f64>,
    /// Probability of the first explanation.
    probability: f64,
    /// Log odds that each explanation lacks for an answer, if it is correct.
    needed: [f64; 2],
    /// Cases: either explanation is correct, and the other is fitted.
    cases: Vec<Case>,
}

/// A case: one explanation is correct at a size, and the other is fitted.
#[derive(Clone, Debug)]
struct Case {
    /// Column of the correct explanation.
    column: usize,
    /// Its size in units of the column.
    size: f64,
    /// Columns that are fitted.
    nuisance: Vec<usize>,
    /// Squared length `S` in the recorded data.
    recorded: f64,
}

impl Question {
    fn pair(between: [&str; 2], probabilities: [f64; 2], cases: [Case; 2]) -> Self {
        let share = probabilities[0] / (probabilities[0] + probabilities[1]);
        let share = if share.is_finite() { share.clamp(1.0 - OPEN.1, OPEN.1) } else { UNDECIDED };
        let (known, needed) = (log_odds(share), log_odds(1.0 - NO_RIVAL));
        Self {
            between: between.map(str::to_owned),
            size: None,
            probability: share,
            needed: [needed - known, needed + known],
            cases: cases.to_vec(),
        }
    }

    /// Returns the question whether an effect acts. It is found at the probability of a reported
    /// effect. Its absence is shown by readings, not by its small prior odds, so even odds precede
    /// them.
    fn presence(id: &str, probability: f64, size: Option<f64>, column: usize, nuisance: Vec<usize>) -> Self {
        let probability = if probability.is_finite() { probability.clamp(OPEN.0, OPEN.1) } else { UNDECIDED };
        Self {
            between: [id.to_owned(), NONE.to_owned()],
            size,
            probability,
            needed: [(log_odds(REPORTED) - log_odds(probability)).max(0.0), log_odds(REPORTED)],
            cases: vec![Case { column, size: 1.0, nuisance, recorded: 0.0 }],
        }
    }

    /// Returns the increase of `S` by this information over the recorded data, in the less
    /// favourable case.
    pub(super) fn squares<'a>(&'a self, projections: &mut Projections<'a>) -> f64 {
        let of = |case: &'a Case| (case.squares(projections) - case.recorded).max(0.0);
        let least = self.cases.iter().map(of).fold(f64::INFINITY, f64::min);
        if least.is_finite() { least } else { 0.0 }
    }

    /// Returns the probability that data with this information, which contains the recorded data,
    /// answer the question: that the log odds of the correct explanation reach the required ones.
    pub(super) fn answer_probability(&self, information: &DMatrix<f64>) -> f64 {
        let squares = self.squares(&mut Projections::new(information));
        if squares <= 1e-9 {
            return 0.0;
        }
        let reached = |needed: f64| Normal::standard().cdf((0.5 * squares - needed) / squares.sqrt());
        self.probability * reached(self.needed[0]) + (1.0 - self.probability) * reached(self.needed[1])
    }

    /// Returns the expected decrease of the entropy of the question, in nats, by an increase of `S`
    /// (Lindley 1956). It is concave in `S`, and at most the entropy of the reported probability.
    pub(super) fn expected_information(&self, squares: f64) -> f64 {
        let (known, root) = (log_odds(self.probability), squares.sqrt());
        let expected = |known: f64| -> f64 {
            let loss = |z: f64| softplus(-(known + 0.5 * squares + root * z));
            NODES
                .iter()
                .map(|(z, weight)| weight * if *z > 0.0 { loss(*z) + loss(-z) } else { loss(0.0) })
                .sum()
        };
        let of = |probability: f64, known: f64| probability * (softplus(-known) - expected(known));
        of(self.probability, known) + of(1.0 - self.probability, -known)
    }

    /// Returns the question in words, for a run sheet.
    pub(super) fn words(&self) -> String {
        format!("{} or {}", self.between[0], self.between[1])
    }

    /// Counts the information of the recorded data.
    fn after(&mut self, recorded: &DMatrix<f64>) {
        for case in &mut self.cases {
            let squares = case.squares(&mut Projections::new(recorded));
            case.recorded = squares;
        }
    }
}

impl Case {
    fn squares<'a>(&'a self, projections: &mut Projections<'a>) -> f64 {
        self.size * self.size * projections.without(&self.nuisance).squares(self.column)
    }
}

/// Returns the logarithm of the odds of a probability.
fn log_odds(probability: f64) -> f64 {
    libm::log(probability / (1.0 - probability))
}

/// Returns `ln(1 + exp(x))`.
fn softplus(x: f64) -> f64 {
    x.max(0.0) + libm::log1p(libm::exp(-x.abs()))
}

/// Projections shared between questions, since most fit the same columns.
#[derive(Debug)]
pub(super) struct Projections<'a> {
    information: &'a DMatrix<f64>,
    made: Vec<Projected<'a>>,
}

impl<'a> Projections<'a> {
    pub(super) fn new(information: &'a DMatrix<f64>) -> Self {
        Self { information, made: Vec::new() }
    }

    fn without(&mut self, nuisance: &'a [usize]) -> &Projected<'a> {
        let at = self.made.iter().position(|p| p.is_without(nuisance)).unwrap_or_else(|| {
            self.made.push(Projected::new(self.information, nuisance));
            self.made.len() - 1
        });
        &self.made[at]
    }
}

/// Returns the information in nats that data are expected to give about questions.
pub(super) fn value(questions: &[Question], information: &DMatrix<f64>) -> f64 {
    values(questions, information).into_iter().sum()
}

/// Returns the same question by question.
pub(super) fn values(questions: &[Question], information: &DMatrix<f64>) -> Vec<f64> {
    let mut projections = Projections::new(information);
    questions.iter().map(|q| q.expected_information(q.squares(&mut projections))).collect()
}

/// Questions of a report, with the contributions and effects that they compare.
#[derive(Debug, Default)]
pub(super) struct Agenda {
    pub(super) contributions: Vec<Contribution>,
    questions: Vec<Question>,
    effects: Vec<SharedEffect>,
    /// Constants of the model, whose columns come first.
    own: usize,
    /// Columns of effects that only new readings can confirm.
    unconfirmed: Vec<usize>,
    /// Ids of the user-defined effects in question.
    formulas: Vec<String>,
    /// Whether one of the effects depends on the previous load.
    remembers: bool,
}

impl Agenda {
    /// Returns all open questions of a report, whose rows have loads up to `highest_n` in newtons.
    pub(super) fn new(report: &Report, model: &Model, highest_n: f64) -> Self {
        let mut agenda = Self { own: model.values().len(), ..Self::default() };
        // A change of friction between sessions, with which an effect that only varies between
        // sessions is confounded.
        for (constant, (name, _)) in model.names().iter().enumerate() {
            if name == "mu_p" || name == "mu_s" {
                agenda.contributions.push(Contribution::NewSession { constant });
            }
        }
        // Unnamed structure of the best hypothesis may be the effect in question.
        let is_structure = |t: &usize| matches!(model.terms[*t], Term::Structure(_));
        let structures: Vec<usize> =
            (0..model.terms.len()).filter(is_structure).map(|t| model.term_offset(t)).collect();
        let all = 0..agenda.own + agenda.contributions.len();
        let fitted: Vec<usize> = all.filter(|column| !structures.contains(column)).collect();
        agenda.add_pairs(report, model, &fitted);
        agenda.add_unconfirmed(report, model, &fitted);
        agenda.add_candidates(report, model, &fitted);
        agenda.fit_similar_effects();
        for own in model.vocabulary.own().map(|own| own.definition()) {
            if agenda.effects.iter().any(|effect| effect.id() == own.id) {
                agenda.formulas.push(own.id.clone());
                agenda.remembers |= own.formula.contains(LOAD_BEFORE);
            }
        }
        // Curves and designs extend beyond the recorded loads.
        let to_n = published::heaviest_load_n();
        // Only parts with a switch have curves.
        if highest_n <= COVERED * to_n && !model.frame.is_plain() {
            let column = agenda.add(Contribution::AboveLoads { from_n: highest_n, to_n });
            let id = format!("{FRICTION_ABOVE}{highest_n:.0}_N");
            agenda.questions.push(Question::presence(&id, STRUCTURE_PROBABILITY, None, column, fitted));
        }
        agenda
    }

    /// Removes what the recorded data show of effects that were derived from them, and that only new
    /// readings can confirm.
    pub(super) fn without_unconfirmed(&self, mut recorded: DMatrix<f64>) -> DMatrix<f64> {
        for column in &self.unconfirmed {
            recorded.column_mut(*column).fill(0.0);
            recorded.row_mut(*column).fill(0.0);
        }
        recorded
    }

    /// Returns the questions, given the information of the recorded data.
    pub(super) fn questions(&self, recorded: &DMatrix<f64>) -> Vec<Question> {
        let mut questions = self.questions.clone();
        for question in &mut questions {
            if let [first, second] = &mut question.cases[..] {
                // Size of the second effect that is closest to the first.
                let is_fitted = |column: &usize| *column != second.column;
                let base: Vec<usize> = first.nuisance.iter().copied().filter(is_fitted).collect();
                let left = Projected::new(recorded, &base);
                let share = left.covariance(second.column, first.column);
                let share = share / left.covariance(second.column, second.column).max(1e-12);
                second.size = share.clamp(-LARGEST_SHARE, LARGEST_SHARE);
            }
            question.after(recorded);
        }
        questions
    }

    fn add(&mut self, contribution: Contribution) -> usize {
        self.contributions.push(contribution);
        self.own + self.contributions.len() - 1
    }

    /// Adds each pair of a reported effect and a rival.
    fn add_pairs(&mut self, report: &Report, model: &Model, fitted: &[usize]) {
        for found in &report.effects {
            for rival in &found.rivals {
                let effects = [&found.id, &rival.id].map(|id| model.vocabulary.named(id));
                let [Some(effect), Some(other)] = effects else { continue };
                self.add_pair([&effect, &other], [found.probability, rival.probability], model, fitted);
            }
        }
    }

    /// Adds user-defined effects whose trial is open, and formulas of unattributed structure, which
    /// only new readings confirm.
    fn add_unconfirmed(&mut self, report: &Report, model: &Model, fitted: &[usize]) {
        let forms = report.effects.iter().filter_map(|found| found.form.as_ref());
        let forms = forms.map(|form| (form.id.as_str(), UNDECIDED));
        let trials = report.trials.iter().filter_map(|trial| match trial.outcome {
            TrialOutcome::Drawn | TrialOutcome::Suggested => Some((trial.id.as_str(), UNDECIDED)),
            TrialOutcome::Open => Some((trial.id.as_str(), trial.probability.unwrap_or(UNDECIDED))),
            TrialOutcome::Confirmed | TrialOutcome::Refuted => None,
        });
        for (id, probability) in forms.chain(trials) {
            let Some(effect) = model.vocabulary.named(id) else { continue };
            self.add_presence(&effect, None, probability, model, fitted);
            if let Some(question) = self.questions.last_mut().filter(|q| q.between[0] == id) {
                question.size = None;
                self.unconfirmed.extend(question.cases.iter().map(|case| case.column));
            }
        }
    }

    /// Adds effects that are neither reported nor excluded, and pairs of them that the data suggest
    /// and that are similar.
    fn add_candidates(&mut self, report: &Report, model: &Model, fitted: &[usize]) {
        let is_reported = |id: &str| report.effects.iter().any(|found| found.id == id);
        let open = report.candidates.iter().filter(|c| c.fate != Fate::Excluded && !is_reported(&c.id));
        let mut suspects: Vec<(SharedEffect, f64)> = Vec::new();
        for candidate in open {
            let Some(effect) = model.vocabulary.named(&candidate.id) else { continue };
            if self.asks_about(effect.id()) {
                continue;
            }
            let limit = report.limits.iter().find(|limit| limit.id == candidate.id);
            let hidden = report.invisible.iter().find(|hidden| hidden.id == candidate.id);
            let is_suspected = candidate.probability >= SUSPECTED;
            // Effects of the rig that readings cannot contain do not change the curve of a part.
            let is_relevant = is_suspected
                || limit.is_some()
                || effect.description().side == Side::Switch
                || hidden.is_some_and(|hidden| hidden.possible.is_some());
            if is_relevant {
                self.add_presence(&effect, limit, candidate.probability, model, fitted);
            }
            if is_suspected {
                suspects.push((effect, candidate.probability));
            }
        }
        for (i, (effect, probability)) in suspects.iter().enumerate() {
            for (other, of_other) in &suspects[i + 1..] {
                let confuses = |a: &SharedEffect, b: &SharedEffect| a.description().is_confused_with(b.id());
                if confuses(effect, other) || confuses(other, effect) {
                    self.add_pair([effect, other], [*probability, *of_other], model, fitted);
                }
            }
        }
    }

    /// Adds the question whether the first or the second effect acts.
    fn add_pair(
        &mut self,
        effects: [&SharedEffect; 2],
        probabilities: [f64; 2],
        model: &Model,
        fitted: &[usize],
    ) {
        let columns = effects.map(|effect| self.column_of(effect, None, model));
        let [Some(first), Some(second)] = columns else { return };
        let others = effects.map(|effect| without_term_of(&**effect, model, fitted));
        let case = |column: usize, nuisance: &[usize], other: usize| Case {
            column,
            size: 1.0,
            nuisance: nuisance.iter().copied().chain([other]).collect(),
            recorded: 0.0,
        };
        let cases = [case(first, &others[0], second), case(second, &others[1], first)];
        self.questions.push(Question::pair(effects.map(|effect| effect.id()), probabilities, cases));
    }

    /// Adds the question whether an effect acts, at the size of a limit, in the model, or typical.
    fn add_presence(
        &mut self,
        effect: &SharedEffect,
        limit: Option<&LimitReport>,
        probability: f64,
        model: &Model,
        fitted: &[usize],
    ) {
        let column = self.column_of(effect, limit, model).filter(|_| !self.asks_about(effect.id()));
        let Some(column) = column else { return };
        let size = match &self.contributions[column - self.own] {
            Contribution::Added { values, .. } => values.first().copied(),
            _ => term_of(model, &**effect).map(|term| model.value(model.term_offset(term)).0),
        };
        let nuisance = without_term_of(&**effect, model, fitted);
        let size = Some(size.unwrap_or(1.0).abs());
        self.questions.push(Question::presence(effect.id(), probability, size, column, nuisance));
    }

    /// Returns the column of the contribution of an effect, and adds it if it is new.
    fn column_of(
        &mut self,
        effect: &SharedEffect,
        limit: Option<&LimitReport>,
        model: &Model,
    ) -> Option<usize> {
        let contribution = match term_of(model, &**effect) {
            Some(term) => Contribution::Term { term },
            None => Contribution::Added { effect: effect.clone(), values: typical(&**effect, limit, model)? },
        };
        self.effects.push(effect.clone());
        Some(self.add(contribution))
    }

    /// Fits to the presence of each effect the open effects that are similar to it, which would explain
    /// its readings as well.
    fn fit_similar_effects(&mut self) {
        let is_presence = |question: &&Question| question.between[1] == NONE;
        let present: Vec<(String, usize)> = self
            .questions
            .iter()
            .filter(is_presence)
            .filter_map(|q| Some((q.between[0].clone(), q.cases.first()?.column)))
            .collect();
        let effects = &self.effects;
        let confuses = |id: &str, other: &str| {
            let effect = effects.iter().find(|effect| effect.id() == id);
            effect.is_some_and(|effect| effect.description().is_confused_with(other))
        };
        for question in self.questions.iter_mut().filter(|question| question.between[1] == NONE) {
            let id = question.between[0].clone();
            let similar = present.iter().filter(|(other, _)| confuses(&id, other) || confuses(other, &id));
            let columns: Vec<usize> = similar.map(|(_, column)| *column).collect();
            question.cases.iter_mut().for_each(|case| case.nuisance.extend(&columns));
        }
    }

    fn asks_about(&self, id: &str) -> bool {
        self.questions.iter().any(|question| question.between.iter().any(|other| other == id))
    }

    /// Returns whether an effect in question is one of this covariate.
    pub(super) fn is_along(&self, id: &str, covariate: Covariate) -> bool {
        self.effects.iter().any(|e| e.id() == id && e.description().covariate == covariate)
    }

    /// Returns whether an effect in question depends on the previous load.
    pub(super) fn asks_of_previous_loads(&self) -> bool {
        self.remembers
    }

    /// Returns whether a user-defined effect in question, whose form may be any, is one of this
    /// covariate.
    pub(super) fn asks_of_formulas_along(&self, covariate: Covariate) -> bool {
        self.formulas.iter().any(|id| self.is_along(id, covariate))
    }

    /// Returns whether any effect in question is one of this covariate.
    pub(super) fn asks_along(&self, covariate: Covariate) -> bool {
        self.effects.iter().any(|effect| effect.description().covariate == covariate)
    }
}

/// Returns the index of the term of an effect.
fn term_of(model: &Model, effect: &dyn Effect) -> Option<usize> {
    model.terms.iter().position(|term| matches!(term, Term::Named(_)) && term.id() == effect.id())
}

/// Returns the columns without those of the constants of an effect.
fn without_term_of(effect: &dyn Effect, model: &Model, columns: &[usize]) -> Vec<usize> {
    let own = term_of(model, effect).map_or(0..0, |t| model.term_offset(t)..model.term_offset(t + 1));
    columns.iter().copied().filter(|column| !own.contains(column)).collect()
}

/// Returns the start values of an effect; with a limit, its typical size and the shape for which it
/// was reported.
fn typical(effect: &dyn Effect, limit: Option<&LimitReport>, model: &Model) -> Option<Vec<f64>> {
    let mut values = effect.typical(&model.frame).into_iter().next()?;
    if let Some(limit) = limit {
        for (value, parameter) in values.iter_mut().zip(effect.parameters()) {
            *value = limit.shape.get(&*parameter.name).copied().unwrap_or(*value);
        }
        values.iter_mut().take(1).for_each(|size| *size = limit.typical);
    }
    Some(values)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn asked(probability: f64) -> Question {
        Question::presence("adhesion", probability, Some(0.2), 0, Vec::new())
    }

    fn after(question: &Question, squares: f64) -> f64 {
        question.answer_probability(&DMatrix::from_element(1, 1, squares))
    }

    /// At even odds, half of the answers are given where the expected log odds are those of a
    /// reported probability.
    #[test]
    fn expected_log_odds_answer_half_the_time() {
        let squares = 2.0 * libm::log(9.0);
        assert!((after(&asked(0.5), squares) - 0.5).abs() < 1e-9);
        assert_eq!(after(&asked(0.5), 0.0), 0.0);
        assert!(after(&asked(0.5), 40.0) > 0.99);
    }

    /// Finding an improbable effect takes more readings than showing its absence.
    #[test]
    fn improbable_effects_need_more_information() {
        let question = asked(0.02);
        assert!(question.needed[0] > 2.5 * question.needed[1], "{:?}", question.needed);
        let absent = Normal::standard().cdf((4.0 - libm::log(9.0)) / libm::sqrt(8.0));
        assert!((after(&question, 8.0) - 0.98 * absent).abs() < 0.01);
    }

    /// The expected information starts at zero, increases with decreasing slope, and approaches the
    /// entropy.
    #[test]
    fn expected_information_is_concave_up_to_the_entropy() {
        for probability in [0.02, 0.2, 0.5, 0.9] {
            let question = asked(probability);
            let of = |squares: f64| question.expected_information(squares);
            let entropy =
                -probability * libm::log(probability) - (1.0 - probability) * libm::log(1.0 - probability);
            assert!(
                of(0.0).abs() < 1e-6 && (of(100.0) / entropy - 1.0).abs() < 1e-3,
                "{} {entropy}",
                of(100.0)
            );
            let steps: Vec<f64> = (0..30).map(|i| of(f64::from(i) + 1.0) - of(f64::from(i))).collect();
            assert!(steps.iter().all(|step| *step > -1e-3 * entropy), "{steps:?}");
            assert!(steps.windows(2).all(|w| w[1] < w[0] + 2e-3 * entropy), "{steps:?}");
        }
    }

    /// Readings count in addition to the recorded ones, which are in the probability already.
    #[test]
    fn recorded_data_count_once() {
        let mut question = asked(0.5);
        question.after(&DMatrix::from_element(1, 1, 6.0));
        assert_eq!(after(&question, 6.0), 0.0);
        assert!((after(&question, 16.0) - after(&asked(0.5), 10.0)).abs() < 1e-12);
    }
}
