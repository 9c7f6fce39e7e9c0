//! Search for the runs to make in the available time: greedy selection by expected information per
//! minute.

use nalgebra::DMatrix;

use super::candidates::{Candidate, alone};
use super::information::Design;
use super::question::{Question, value, values};
use super::rig::RigLimits;
use crate::parallel::map_each;
use crate::table::PlateauRow;

/// Information in nats per minute below which a run is not worth making.
pub(super) const LEAST: f64 = 1e-5;
/// Candidates per parallel task.
const AT_ONCE: usize = 256;
/// Most runs of a plan: a week of work.
pub const MOST_RUNS: usize = 400;
/// Share of the available time after which late runs begin.
const LATE: f64 = 0.75;

/// Candidates with their information, as if each were mounted separately, since the combination is
/// not yet known.
#[derive(Debug)]
pub(super) struct Candidates {
    pub(super) candidates: Vec<Candidate>,
    pub(super) information: Vec<DMatrix<f64>>,
}

impl Candidates {
    /// Computes the information of candidates. `None` if the model lacks a condition.
    pub(super) fn new(
        candidates: Vec<Candidate>,
        design: &Design<'_>,
        rig: &RigLimits,
        minutes: f64,
        has_memory: bool,
    ) -> Option<Self> {
        let begins_s = |c: &Candidate| if c.late { LATE * 60.0 * minutes } else { 0.0 };
        let of_part = |part: &[Candidate]| {
            let numbered = part.iter().enumerate();
            let rows = numbered.flat_map(|(i, c)| alone(c, &i.to_string(), rig, begins_s(c), has_memory));
            let each = design.planned_series(&rows.collect::<Vec<PlateauRow>>())?;
            // The run before a candidate is not part of it.
            let runs = if has_memory { 2 } else { 1 };
            Some(each.into_iter().skip(runs - 1).step_by(runs).collect::<Vec<_>>())
        };
        let parts = map_each(candidates.chunks(AT_ONCE).collect(), of_part);
        let information = parts.into_iter().collect::<Option<Vec<_>>>()?.concat();
        Some(Self { candidates, information })
    }
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
    /// Returns the indices of the chosen candidates: those with the largest gain per minute, one after
    /// the other, until no other one fits into the time and has a gain. Exchanges of chosen
    /// candidates would add less than one percent of the information, for twice the time.
    pub(super) fn run(&self, known: &DMatrix<f64>) -> Vec<usize> {
        let (mut chosen, mut total) = (Vec::new(), known.clone());
        while let Some(next) = self.best(&chosen, &total) {
            total += &self.all.information[next];
            chosen.push(next);
        }
        chosen
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
