//! Which runs to make in the time there is: those that gain most per minute, one after the other, then each exchanged for
//! a better one (a greedy batch with exchange, as Fedorov's).

use nalgebra::DMatrix;

use super::candidates::Candidate;
use super::question::{Projections, Question};
use super::rig::RigLimits;
use crate::parallel::map_each;

/// Squares beyond which an answer is as good as certain, in units of those needed.
const ENOUGH: f64 = 3.0;
/// Worth per minute below which a run is not worth making.
const LEAST: f64 = 1e-4;
/// Candidates that are looked at one after the other, others beside them.
const AT_ONCE: usize = 256;
/// Rounds of exchanges.
const ROUNDS: usize = 2;
/// Runs up to which they are exchanged: of a longer plan, one run decides little.
pub(super) const FEW_RUNS: usize = 100;
/// Most runs of a plan: a week of work.
pub const MOST_RUNS: usize = 400;

/// What information is worth: for each question the logarithm of the squares expected, so that none is answered at the
/// cost of all others.
fn worth(questions: &[Question], information: &DMatrix<f64>) -> f64 {
    let mut projections = Projections::of(information);
    questions
        .iter()
        .map(|q| q.weight * libm::log(1.0 + (q.squares_of(&mut projections) / q.needed).clamp(0.0, ENOUGH)))
        .sum()
}

/// Candidates with the information of each, and what there is to ask.
#[derive(Debug)]
pub(super) struct Search<'a> {
    pub(super) candidates: &'a [Candidate],
    pub(super) information: &'a [DMatrix<f64>],
    pub(super) questions: &'a [Question],
    pub(super) rig: &'a RigLimits,
    pub(super) minutes: f64,
}

impl Search<'_> {
    /// Places of the candidates to run.
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
        // An exchange may have left time over.
        while let Some(next) = self.best(&chosen, &total) {
            total += &self.information[next];
            chosen.push(next);
        }
        chosen
    }

    /// Minutes of a choice: recording, and each change of load and contact once.
    fn minutes_of(&self, chosen: &[usize]) -> f64 {
        let before = |i: usize| chosen[..i].iter().map(|c| &self.candidates[*c]);
        chosen.iter().enumerate().map(|(i, c)| self.candidates[*c].minutes(before(i), self.rig)).sum()
    }

    /// The candidate that gains most per minute, of those for which there is time; `None` if none gains anything.
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
        // Of equals the first, however many are looked at side by side.
        let best = parts.into_iter().flatten().reduce(|a, b| if b.0 > a.0 { b } else { a });
        best.map(|(_, i)| i)
    }

    /// The question that a chosen run does most for: the one that suffers most without it.
    pub(super) fn purpose(&self, place: usize, chosen: &[usize], known: &DMatrix<f64>) -> Option<&Question> {
        let all = chosen.iter().fold(known.clone(), |sum, c| sum + &self.information[*c]);
        let without = &all - &self.information[chosen[place]];
        self.questions.iter().max_by(|a, b| a.loss(&all, &without).total_cmp(&b.loss(&all, &without)))
    }
}
