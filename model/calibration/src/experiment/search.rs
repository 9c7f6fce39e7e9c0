//! Search for the runs to make in the available time: greedy selection by expected information per
//! minute, followed by exchanges (Fedorov 1972).

use nalgebra::DMatrix;
use pinswitch_friction::sort_by_number;

use super::candidates::{Candidate, alone};
use super::information::Design;
use super::question::{Question, value, values};
use super::rig::RigLimits;
use crate::parallel::map_each;
use crate::table::PlateauRow;

/// Information in nats per minute below which a run is not worth making.
const LEAST: f64 = 1e-5;
/// Smallest gain of an exchange, in nats.
const LEAST_EXCHANGE: f64 = 1e-6;
/// Candidates per parallel task.
const AT_ONCE: usize = 256;
/// Number of rounds of exchanges.
const ROUNDS: usize = 2;
/// Largest number of runs for which exchanges are tried, since in a longer plan a single run
/// matters little.
pub(super) const FEW_RUNS: usize = 100;
/// Most runs of a plan: a week of work.
pub const MOST_RUNS: usize = 400;
/// Most candidates that are all searched: those of the paper's rig.
const MOST_CANDIDATES: usize = 6_000;
/// Number of candidates searched otherwise: the most informative ones per minute for each question.
const SEARCHED: usize = 1_500;
/// Candidates whose information is computed at once, to limit memory.
const IN_MEMORY: usize = 2_000;
/// Share of the available time after which late runs begin.
const LATE: f64 = 0.75;

/// Candidates with their information, as if each were mounted separately, since the combination is
/// not yet known.
#[derive(Debug)]
pub(super) struct Candidates {
    pub(super) candidates: Vec<Candidate>,
    pub(super) information: Vec<DMatrix<f64>>,
    /// Information of the recorded data and all candidates, including those that are not searched.
    pub(super) everything: DMatrix<f64>,
}

impl Candidates {
    /// Computes the information of candidates. `None` if the model lacks a condition.
    pub(super) fn new(
        all: Vec<Candidate>,
        design: &Design<'_>,
        recorded: &DMatrix<f64>,
        questions: &[Question],
        rig: &RigLimits,
        minutes: f64,
    ) -> Option<Self> {
        let are_many = all.len() > MOST_CANDIDATES;
        let mut everything = recorded.clone();
        let mut kept: Vec<(Candidate, DMatrix<f64>, Vec<f64>)> = Vec::new();
        for chunk in all.chunks(IN_MEMORY) {
            let parts = map_each(chunk.chunks(AT_ONCE).collect(), |part: &[Candidate]| {
                let of_part = of_candidates(design, part, rig, minutes)?.into_iter();
                let per_minute = |(candidate, information): (&Candidate, DMatrix<f64>)| {
                    let minutes = candidate.minutes(std::iter::empty(), rig).max(0.1);
                    let gains =
                        if are_many { values(questions, &(recorded + &information)) } else { Vec::new() };
                    (candidate.clone(), information, gains.into_iter().map(|gain| gain / minutes).collect())
                };
                Some(part.iter().zip(of_part).map(per_minute).collect::<Vec<_>>())
            });
            for part in parts {
                let part = part?;
                part.iter().for_each(|(_, information, _)| everything += information);
                kept.extend(part);
            }
            if are_many {
                kept = best_of_each(kept, questions.len());
            }
        }
        let (candidates, information) = kept.into_iter().map(|(c, i, _)| (c, i)).unzip();
        Some(Self { candidates, information, everything })
    }
}

/// Returns the best for every question, in their original order.
fn best_of_each<T>(
    all: Vec<(T, DMatrix<f64>, Vec<f64>)>,
    questions: usize,
) -> Vec<(T, DMatrix<f64>, Vec<f64>)> {
    let mut is_kept = vec![false; all.len()];
    for question in 0..questions {
        let mut order: Vec<usize> = (0..all.len()).collect();
        sort_by_number(&mut order, |i| -all[*i].2[question]);
        order.into_iter().take(SEARCHED / questions).for_each(|i| is_kept[i] = true);
    }
    all.into_iter().zip(is_kept).filter(|(_, kept)| *kept).map(|(one, _)| one).collect()
}

fn of_candidates(
    design: &Design<'_>,
    all: &[Candidate],
    rig: &RigLimits,
    minutes: f64,
) -> Option<Vec<DMatrix<f64>>> {
    let begins_s = |c: &Candidate| if c.late { LATE * 60.0 * minutes } else { 0.0 };
    let rows: Vec<PlateauRow> =
        all.iter().enumerate().flat_map(|(i, c)| alone(c, &i.to_string(), rig, begins_s(c))).collect();
    let each = design.planned_series(&rows)?;
    // The run before a candidate is not part of it.
    let has_before = all.iter().any(|c| c.after_g.is_some());
    Some(if has_before { each.into_iter().skip(1).step_by(2).collect() } else { each })
}

/// Candidates and questions.
#[derive(Debug)]
pub(super) struct Search<'a> {
    pub(super) all: &'a Candidates,
    pub(super) questions: &'a [Question],
    pub(super) rig: &'a RigLimits,
    pub(super) minutes: f64,
}

impl Search<'_> {
    /// Returns the indices of the chosen candidates.
    pub(super) fn run(&self, known: &DMatrix<f64>) -> Vec<usize> {
        let (mut chosen, mut total) = (Vec::new(), known.clone());
        self.extend(&mut chosen, &mut total);
        let rounds = if chosen.len() > FEW_RUNS { 0 } else { ROUNDS };
        for _ in 0..rounds {
            let mut is_better = false;
            for place in 0..chosen.len() {
                let old = chosen.remove(place);
                let without = &total - &self.all.information[old];
                let before = value(self.questions, &total);
                let new = self.best(&chosen, &without).unwrap_or(old);
                let with = &without + &self.all.information[new];
                let kept = if value(self.questions, &with) > before + LEAST_EXCHANGE { new } else { old };
                is_better |= kept != old;
                total = &without + &self.all.information[kept];
                chosen.insert(place, kept);
            }
            if !is_better {
                break;
            }
        }
        // An exchange may have freed time.
        self.extend(&mut chosen, &mut total);
        chosen
    }

    /// Adds candidates until no other one fits into the time and has a gain.
    fn extend(&self, chosen: &mut Vec<usize>, total: &mut DMatrix<f64>) {
        while let Some(next) = self.best(chosen, total) {
            *total += &self.all.information[next];
            chosen.push(next);
        }
    }

    /// Returns the duration of a choice in minutes: recording, and each change of load and contact
    /// once.
    fn minutes_of(&self, chosen: &[usize]) -> f64 {
        let candidates = &self.all.candidates;
        let before = |i: usize| chosen[..i].iter().map(|c| &candidates[*c]);
        chosen.iter().enumerate().map(|(i, c)| candidates[*c].minutes(before(i), self.rig)).sum()
    }

    /// Returns the candidate with the largest gain per minute that fits into the time; `None` if
    /// none has a gain.
    fn best(&self, chosen: &[usize], total: &DMatrix<f64>) -> Option<usize> {
        let candidates = &self.all.candidates;
        let before = value(self.questions, total);
        let left = self.minutes - self.minutes_of(chosen);
        if chosen.len() >= MOST_RUNS {
            return None;
        }
        let best_among = |from: usize| {
            let mut best = None;
            for i in from..candidates.len().min(from + AT_ONCE) {
                let minutes = candidates[i].minutes(chosen.iter().map(|c| &candidates[*c]), self.rig);
                if minutes > left || chosen.contains(&i) {
                    continue;
                }
                let with = value(self.questions, &(total + &self.all.information[i]));
                let gain = (with - before) / minutes.max(0.1);
                if gain > LEAST && best.is_none_or(|(most, _)| gain > most) {
                    best = Some((gain, i));
                }
            }
            best
        };
        let parts = map_each((0..candidates.len()).step_by(AT_ONCE).collect(), best_among);
        // Ties are resolved in favour of the first, independently of the number of threads.
        let best = parts.into_iter().flatten().reduce(|a, b| if b.0 > a.0 { b } else { a });
        best.map(|(_, i)| i)
    }
}

/// Returns the question for which a part of the information matters most, in words.
pub(super) fn purpose(questions: &[Question], all: &DMatrix<f64>, part: &DMatrix<f64>) -> String {
    let (with, without) = (values(questions, all), values(questions, &(all - part)));
    let loss = |i: &usize| with[*i] - without[*i];
    let most = (0..questions.len()).max_by(|a, b| loss(a).total_cmp(&loss(b)));
    most.map_or_else(String::new, |i| questions[i].words())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_question_keeps_its_best() {
        let all = (0..4000).map(|i| {
            let gain = f64::from(i);
            (i, DMatrix::zeros(0, 0), vec![gain, -gain])
        });
        let kept: Vec<i32> = best_of_each(all.collect(), 2).into_iter().map(|(i, ..)| i).collect();
        assert_eq!((kept.len(), kept[0], kept[749], kept[750], kept[1499]), (1500, 0, 749, 3250, 3999));
    }
}
