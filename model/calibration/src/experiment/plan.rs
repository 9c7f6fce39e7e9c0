//! Which of several plans: that of the search, those that give up what stays open, and the paper's protocol with a search after
//! it, compared by the answers that their real rows give.

use nalgebra::DMatrix;

use pinswitch_friction::sort_by_number;

use super::candidates::{Candidate, paper_protocol, within_cell};
use super::in_order;
use super::information::Design;
use super::question::Question;
use super::rig::RigLimits;
use super::runs::{PlannedRun, rows_of};
use super::search::{FEW_RUNS, MOST_RUNS, Search};

/// Probability below which a plan does not answer a question, and may do better without it.
const WITHIN_REACH: f64 = 0.3;
/// Questions that are each tried alone, at most: the weightiest.
const ALONE: usize = 4;
/// Shares of the time for which the paper's protocol is tried before runs that are searched for: what remembers loads shows in
/// a sequence of them, and no run by itself does.
const PROTOCOL_SHARES: [f64; 3] = [0.35, 0.7, 1.0];
/// Minutes of it beyond which it repeats itself.
const MOST_PROTOCOL: f64 = 420.0;
/// Answers by which another plan must be better.
const BETTER: f64 = 0.02;
/// Runs of a plan beyond which others are compared with it before the time that they leave is used.
const VERY_MANY_RUNS: usize = 300;
/// Minutes of a plan that are not worth another search.
const LITTLE_TIME: f64 = 3.0;

/// What plans are made of, and for.
pub(super) struct Planner<'a> {
    pub(super) candidates: &'a [Candidate],
    /// Of each candidate by itself.
    pub(super) information: &'a [DMatrix<f64>],
    pub(super) design: &'a Design<'a>,
    /// What is known before any run.
    pub(super) data: &'a DMatrix<f64>,
    pub(super) questions: &'a [Question],
    pub(super) rig: &'a RigLimits,
    pub(super) minutes: f64,
}

impl Planner<'_> {
    /// What is known after runs; `None` if the model lacks a condition of theirs.
    pub(super) fn after(&self, runs: &[PlannedRun]) -> Option<DMatrix<f64>> {
        let rows = rows_of(runs, self.rig, "next");
        if rows.is_empty() {
            return Some(self.data.clone());
        }
        self.design.of(&rows).map(|more| more + self.data)
    }

    /// The plan that gives most answers. What little is known of questions that stay open is not worth the answer to another,
    /// and no plan may be worse than the protocol that everybody has.
    pub(super) fn best_plan(&self) -> Option<Vec<PlannedRun>> {
        if self.questions.is_empty() {
            return Some(Vec::new());
        }
        let mut best = self.searched(self.questions, self.data, self.minutes);
        let with_all = self.after(&best)?;
        let is_within_reach = |q: &&Question| q.probability(&with_all) >= WITHIN_REACH;
        let within_reach: Vec<Question> = self.questions.iter().filter(is_within_reach).cloned().collect();
        // Of a long plan each search takes seconds, and one protocol of many.
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

    /// Answers that are expected of runs, each counted by its weight.
    fn answers(&self, runs: &[PlannedRun]) -> f64 {
        let of = |with: DMatrix<f64>| self.questions.iter().map(|q| q.weight * q.probability(&with)).sum();
        self.after(runs).map_or(0.0, of)
    }

    /// The runs that a search makes for some questions, where so much is known.
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

    /// A plan with the time that it leaves used for all questions.
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

    /// The paper's protocol for so many minutes, as far as the cell reads it, with the question that each run does most for.
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
