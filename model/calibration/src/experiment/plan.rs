//! Choice between plans: that of the search, those without questions that stay open, and the
//! paper's protocol followed by a search. They are compared by the expected answers of their rows.

use nalgebra::DMatrix;

use pinswitch_friction::sort_by_number;

use super::candidates::{Candidate, paper_protocol, within_cell};
use super::in_order;
use super::information::Design;
use super::question::Question;
use super::rig::RigLimits;
use super::runs::{PlannedRun, rows_of};
use super::search::{FEW_RUNS, MOST_RUNS, Search};

/// Probability below which a question stays open, so that a plan may be better without it.
const WITHIN_REACH: f64 = 0.3;
/// Most questions for which a separate plan is tried: those of the largest weight.
const ALONE: usize = 4;
/// Shares of the time for which the paper's protocol is tried before searched runs, since an effect
/// of previous loads shows only in a sequence of runs.
const PROTOCOL_SHARES: [f64; 3] = [0.35, 0.7, 1.0];
/// Duration in minutes after which it repeats.
const MOST_PROTOCOL: f64 = 420.0;
/// Number of answers by which another plan must be better.
const BETTER: f64 = 0.02;
/// Number of runs above which plans are compared before their remaining time is used.
const VERY_MANY_RUNS: usize = 300;
/// Remaining time in minutes that is not worth another search.
const LITTLE_TIME: f64 = 3.0;

/// Input of the planning.
pub(super) struct Planner<'a> {
    pub(super) candidates: &'a [Candidate],
    /// Information of each candidate.
    pub(super) information: &'a [DMatrix<f64>],
    pub(super) design: &'a Design<'a>,
    /// Information before any run.
    pub(super) data: &'a DMatrix<f64>,
    pub(super) questions: &'a [Question],
    pub(super) rig: &'a RigLimits,
    pub(super) minutes: f64,
}

impl Planner<'_> {
    /// Returns the information after some runs; `None` if the model lacks one of their conditions.
    pub(super) fn after(&self, runs: &[PlannedRun]) -> Option<DMatrix<f64>> {
        let rows = rows_of(runs, self.rig, "next");
        if rows.is_empty() {
            return Some(self.data.clone());
        }
        self.design.of(&rows).map(|more| more + self.data)
    }

    /// Returns the plan with the most expected answers. A little information about a question that
    /// stays open is not worth the answer to another one, and no plan may be worse than the paper's
    /// protocol.
    pub(super) fn best_plan(&self) -> Option<Vec<PlannedRun>> {
        if self.questions.is_empty() {
            return Some(Vec::new());
        }
        let mut best = self.searched(self.questions, self.data, self.minutes);
        let with_all = self.after(&best)?;
        let is_within_reach = |q: &&Question| q.probability(&with_all) >= WITHIN_REACH;
        let within_reach: Vec<Question> = self.questions.iter().filter(is_within_reach).cloned().collect();
        // For a long plan each search takes seconds, so only one protocol is tried.
        let is_long = best.len() > FEW_RUNS;
        let mut others = Vec::new();
        if within_reach.len() < self.questions.len() && !is_long {
            others.push(self.searched(&within_reach, self.data, self.minutes));
            let mut open: Vec<&Question> =
                self.questions.iter().filter(|q| !is_within_reach(q) && q.weight >= 1.0).collect();
            sort_by_number(&mut open, |q| -q.weight);
            let alone = open.into_iter().take(ALONE);
            others.extend(alone.map(|q| self.searched(std::slice::from_ref(q), self.data, self.minutes)));
        }
        let shares = if is_long { &PROTOCOL_SHARES[..1] } else { &PROTOCOL_SHARES };
        others.extend(shares.iter().map(|share| self.protocol((share * self.minutes).min(MOST_PROTOCOL))));
        let mut most = self.answers(&best);
        let is_very_long = best.len() > VERY_MANY_RUNS;
        for other in others {
            let other = if is_very_long { other } else { self.filled(other)? };
            let answers = self.answers(&other);
            if answers > most + BETTER {
                (best, most) = (other, answers);
            }
        }
        self.filled(best)
    }

    /// Returns the expected number of answers, weighted by question.
    fn answers(&self, runs: &[PlannedRun]) -> f64 {
        let of = |with: DMatrix<f64>| self.questions.iter().map(|q| q.weight * q.probability(&with)).sum();
        self.after(runs).map_or(0.0, of)
    }

    /// Returns the runs of a search for some questions, given the information so far.
    fn searched(&self, questions: &[Question], known: &DMatrix<f64>, minutes: f64) -> Vec<PlannedRun> {
        if questions.is_empty() {
            return Vec::new();
        }
        let Self { candidates, information, rig, .. } = *self;
        let search = Search { candidates, information, questions, rig, minutes };
        let chosen = search.run(known);
        let purposes: Vec<String> = (0..chosen.len())
            .map(|place| search.purpose(place, &chosen, known).map_or_else(String::new, Question::words))
            .collect();
        in_order(chosen.iter().map(|c| &candidates[*c]).zip(purposes), rig)
    }

    /// Uses the remaining time of a plan for all questions.
    fn filled(&self, mut runs: Vec<PlannedRun>) -> Option<Vec<PlannedRun>> {
        let left = self.minutes - runs.iter().map(|run| run.minutes).sum::<f64>();
        if left < LITTLE_TIME || runs.len() >= MOST_RUNS {
            return Some(runs);
        }
        let mounts = runs.iter().map(|run| run.mount).max().unwrap_or(0);
        let known = self.after(&runs)?;
        let more = self.searched(self.questions, &known, left);
        runs.extend(more.into_iter().map(|run| PlannedRun { mount: run.mount + mounts, ..run }));
        runs.truncate(MOST_RUNS);
        Some(runs)
    }

    /// Returns the paper's protocol for a duration in minutes, within the range of the load cell,
    /// with the question for which each run matters most.
    fn protocol(&self, minutes: f64) -> Vec<PlannedRun> {
        let mut runs = paper_protocol(self.rig, minutes);
        let rows = rows_of(&runs, self.rig, "next");
        let bears = within_cell(self.design.model, &rows, self.rig);
        if bears.len() != rows.len() || bears.contains(&false) {
            return Vec::new();
        }
        let Some(each) = self.design.by_series(&rows).filter(|each| each.len() == runs.len()) else {
            return Vec::new();
        };
        let all = each.iter().fold(self.data.clone(), |sum, one| sum + one);
        for (run, one) in runs.iter_mut().zip(&each) {
            let without = &all - one;
            let loss = |q: &&Question| q.loss(&all, &without);
            let most = self.questions.iter().max_by(|a, b| loss(a).total_cmp(&loss(b)));
            run.asks = most.map_or_else(String::new, Question::words);
        }
        runs
    }
}
