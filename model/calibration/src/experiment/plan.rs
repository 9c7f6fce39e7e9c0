//! Choice between plans: that of the search, and the paper's protocol followed by a search. They are
//! compared by the expected information of their rows.

use nalgebra::DMatrix;

use super::candidates::{paper_runs, within_cell};
use super::in_order;
use super::information::Design;
use super::question::{Question, value};
use super::rig::RigLimits;
use super::runs::{PlannedRun, rows_of};
use super::search::{Candidates, LEAST, MOST_RUNS, Search, purpose};

/// Shares of the time for which the paper's protocol is tried before searched runs, since an effect
/// of previous loads shows only in a sequence of runs.
const PROTOCOL_SHARES: [f64; 3] = [0.35, 0.7, 1.0];
/// Duration in minutes after which it repeats.
const MOST_PROTOCOL: f64 = 420.0;
/// Number of runs above which only the first share is tried, since each search takes seconds.
const MANY_RUNS: usize = 100;
/// Remaining time in minutes that is not worth another search.
const LITTLE_TIME: f64 = 3.0;

/// Input of the planning.
pub(super) struct Planner<'a> {
    pub(super) candidates: &'a Candidates,
    pub(super) design: &'a Design<'a>,
    /// Information of the recorded data.
    pub(super) recorded: &'a DMatrix<f64>,
    pub(super) questions: &'a [Question],
    pub(super) rig: &'a RigLimits,
    pub(super) minutes: f64,
}

impl Planner<'_> {
    /// Returns the information after some runs; `None` if the model lacks one of their conditions.
    pub(super) fn after(&self, runs: &[PlannedRun]) -> Option<DMatrix<f64>> {
        let rows = rows_of(runs, self.rig, "next");
        if rows.is_empty() {
            return Some(self.recorded.clone());
        }
        self.design.planned(&rows).map(|more| more + self.recorded)
    }

    /// Returns the plan with the most expected information. A longer one is better only if its
    /// additional time is worth the difference.
    pub(super) fn best_plan(&self) -> Option<Vec<PlannedRun>> {
        if self.questions.is_empty() {
            return Some(Vec::new());
        }
        let mut best = self.searched(self.recorded, self.minutes);
        let shares = if best.len() > MANY_RUNS { &PROTOCOL_SHARES[..1] } else { &PROTOCOL_SHARES };
        let mut most = value(self.questions, &self.after(&best)?);
        for share in shares {
            let protocol = self.protocol((share * self.minutes).min(MOST_PROTOCOL))?;
            let other = self.filled(protocol)?;
            let information = value(self.questions, &self.after(&other)?);
            let longer = (minutes_of(&other) - minutes_of(&best)).max(0.0);
            if information > most + LEAST * longer {
                (best, most) = (other, information);
            }
        }
        Some(best)
    }

    /// Returns the runs of a search, given the information so far.
    fn searched(&self, known: &DMatrix<f64>, minutes: f64) -> Vec<PlannedRun> {
        let search = Search { all: self.candidates, questions: self.questions, rig: self.rig, minutes };
        let chosen = search.run(known);
        let of = |c: &usize| &self.candidates.information[*c];
        let all = chosen.iter().fold(known.clone(), |sum, c| sum + of(c));
        let purposes = chosen.iter().map(|c| purpose(self.questions, &all, of(c)));
        in_order(chosen.iter().map(|c| &self.candidates.candidates[*c]).zip(purposes), self.rig)
    }

    /// Uses the remaining time of a plan.
    fn filled(&self, mut runs: Vec<PlannedRun>) -> Option<Vec<PlannedRun>> {
        let left = self.minutes - minutes_of(&runs);
        if left < LITTLE_TIME || runs.len() >= MOST_RUNS {
            return Some(runs);
        }
        let mounts = runs.iter().map(|run| run.mount).max().unwrap_or(0);
        let more = self.searched(&self.after(&runs)?, left);
        runs.extend(more.into_iter().map(|run| PlannedRun { mount: run.mount + mounts, ..run }));
        runs.truncate(MOST_RUNS);
        Some(runs)
    }

    /// Returns the paper's protocol for a duration in minutes, within the range of the load cell,
    /// with the question for which each run matters most.
    fn protocol(&self, minutes: f64) -> Option<Vec<PlannedRun>> {
        let mut runs = paper_runs(self.rig, minutes);
        let rows = rows_of(&runs, self.rig, "next");
        let fits = within_cell(self.design.model, &rows, self.rig);
        if rows.is_empty() || fits.len() != rows.len() || fits.contains(&false) {
            return Some(Vec::new());
        }
        let each = self.design.planned_series(&rows)?;
        let all = each.iter().fold(self.recorded.clone(), |sum, one| sum + one);
        for (run, one) in runs.iter_mut().zip(&each) {
            run.asks = purpose(self.questions, &all, one);
        }
        Some(runs)
    }
}

fn minutes_of(runs: &[PlannedRun]) -> f64 {
    runs.iter().map(|run| run.minutes).sum()
}
