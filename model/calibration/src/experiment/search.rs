//! Search for the runs to make in the available time: greedy selection by gain per minute, followed
//! by exchanges (as Fedorov's algorithm).

use nalgebra::DMatrix;

use super::candidates::Candidate;
use super::question::{Projections, Question};
use super::rig::RigLimits;
use crate::parallel::map_each;

/// Ratio of expected to required deviance above which an answer is practically certain.
const ENOUGH: f64 = 3.0;
/// Gain per minute below which a run is not worth making.
const LEAST: f64 = 1e-4;
/// Candidates per parallel task.
const AT_ONCE: usize = 256;
/// Number of rounds of exchanges.
const ROUNDS: usize = 2;
/// Largest number of runs for which exchanges are tried, since in a longer plan a single run
/// matters little.
pub(super) const FEW_RUNS: usize = 100;
/// Most runs of a plan: a week of work.
pub const MOST_RUNS: usize = 400;

/// Returns the value of information: the sum over questions of the logarithm of the expected
/// deviance, so that no question is neglected.
fn worth(questions: &[Question], information: &DMatrix<f64>) -> f64 {
    let mut projections = Projections::of(information);
    questions
        .iter()
        .map(|q| q.weight * libm::log(1.0 + (q.squares_of(&mut projections) / q.needed).clamp(0.0, ENOUGH)))
        .sum()
}

/// Candidates with their information, and the questions.
#[derive(Debug)]
pub(super) struct Search<'a> {
    pub(super) candidates: &'a [Candidate],
    pub(super) information: &'a [DMatrix<f64>],
    pub(super) questions: &'a [Question],
    pub(super) rig: &'a RigLimits,
    pub(super) minutes: f64,
}

impl Search<'_> {
    /// Returns the indices of the chosen candidates.
    pub(super) fn run(&self, known: &DMatrix<f64>) -> Vec<usize> {
        let (mut chosen, mut total) = (Vec::new(), known.clone());
        while let Some(next) = self.best(&chosen, &total) {
            total += &self.information[next];
            chosen.push(next);
        }
        let rounds = if chosen.len() > FEW_RUNS { 0 } else { ROUNDS };
        for _ in 0..rounds {
            let mut is_better = false;
            for place in 0..chosen.len() {
                let old = chosen.remove(place);
                let without = &total - &self.information[old];
                let before = worth(self.questions, &total);
                let new = self.best(&chosen, &without).unwrap_or(old);
                let with = &without + &self.information[new];
                let kept = if worth(self.questions, &with) > before + 1e-6 { new } else { old };
                is_better |= kept != old;
                total = &without + &self.information[kept];
                chosen.insert(place, kept);
            }
            if !is_better {
                break;
            }
        }
        // An exchange may have freed time.
        while let Some(next) = self.best(&chosen, &total) {
            total += &self.information[next];
            chosen.push(next);
        }
        chosen
    }

    /// Returns the duration of a choice in minutes: recording, and each change of load and contact
    /// once.
    fn minutes_of(&self, chosen: &[usize]) -> f64 {
        let before = |i: usize| chosen[..i].iter().map(|c| &self.candidates[*c]);
        chosen.iter().enumerate().map(|(i, c)| self.candidates[*c].minutes(before(i), self.rig)).sum()
    }

    /// Returns the candidate with the largest gain per minute that fits into the time; `None` if
    /// none has a gain.
    fn best(&self, chosen: &[usize], total: &DMatrix<f64>) -> Option<usize> {
        let before = worth(self.questions, total);
        let left = self.minutes - self.minutes_of(chosen);
        if chosen.len() >= MOST_RUNS {
            return None;
        }
        let best_among = |from: usize| {
            let mut best = None;
            for i in from..self.candidates.len().min(from + AT_ONCE) {
                let minutes =
                    self.candidates[i].minutes(chosen.iter().map(|c| &self.candidates[*c]), self.rig);
                if minutes > left || chosen.contains(&i) {
                    continue;
                }
                let with = worth(self.questions, &(total + &self.information[i]));
                let gain = (with - before) / minutes.max(0.1);
                if gain > LEAST && best.is_none_or(|(most, _)| gain > most) {
                    best = Some((gain, i));
                }
            }
            best
        };
        let parts = map_each((0..self.candidates.len()).step_by(AT_ONCE).collect(), best_among);
        // Ties are resolved in favour of the first, independently of the number of threads.
        let best = parts.into_iter().flatten().reduce(|a, b| if b.0 > a.0 { b } else { a });
        best.map(|(_, i)| i)
    }

    /// Returns the question for which a chosen run matters most: the one that loses most without
    /// it.
    pub(super) fn purpose(&self, place: usize, chosen: &[usize], known: &DMatrix<f64>) -> Option<&Question> {
        let all = chosen.iter().fold(known.clone(), |sum, c| sum + &self.information[*c]);
        let without = &all - &self.information[chosen[place]];
        self.questions.iter().max_by(|a, b| a.loss(&all, &without).total_cmp(&b.loss(&all, &without)))
    }
}
