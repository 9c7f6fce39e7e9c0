//! Shortlist of candidate runs with their information: all runs of a rig if these are few,
//! otherwise the most informative ones per minute for each question.

use nalgebra::DMatrix;

use pinswitch_friction::sort_by_number;

use super::candidates::{Candidate, alone};
use super::information::Design;
use super::question::{Projections, Question};
use super::rig::RigLimits;
use crate::inference::Wandering;
use crate::parallel::map_each;
use crate::table::PlateauRow;

/// Most runs that are all searched: those of the paper's rig.
const MOST: usize = 6_000;
/// Number of runs kept otherwise.
const KEPT: usize = 1_500;
/// Runs whose information is computed at once, to limit memory.
const AT_ONCE: usize = 2_000;

/// Runs with their information, and the information of all possible runs together.
#[derive(Debug)]
pub(super) struct Shortlist {
    pub(super) candidates: Vec<Candidate>,
    pub(super) information: Vec<DMatrix<f64>>,
    pub(super) everything: DMatrix<f64>,
}

impl Shortlist {
    /// Returns the shortlist of `all`, given the information `known`. `None` if the model lacks a
    /// condition.
    pub(super) fn of(
        all: Vec<Candidate>,
        design: &Design<'_>,
        known: &DMatrix<f64>,
        questions: &[Question],
        rig: &RigLimits,
        minutes: f64,
    ) -> Option<Self> {
        let mut everything = known.clone();
        let each = if all.len() > MOST { KEPT / questions.len().max(1) } else { all.len() };
        let mut kept: Vec<(Candidate, DMatrix<f64>, Vec<f64>)> = Vec::new();
        for chunk in all.chunks(AT_ONCE) {
            let parts = map_each(chunk.chunks(AT_ONCE / 4).collect(), |part: &[Candidate]| {
                of_candidates(design, part, rig, minutes)
            });
            let information: Vec<DMatrix<f64>> =
                parts.into_iter().collect::<Option<Vec<_>>>()?.into_iter().flatten().collect();
            for (candidate, information) in chunk.iter().zip(information) {
                everything += &information;
                let alone_minutes = candidate.minutes(std::iter::empty(), rig).max(0.1);
                let with = known + &information;
                let gains = if all.len() > MOST {
                    let mut projections = Projections::of(&with);
                    questions
                        .iter()
                        .map(|q| q.squares_of(&mut projections) / q.needed / alone_minutes)
                        .collect()
                } else {
                    Vec::new()
                };
                kept.push((candidate.clone(), information, gains));
            }
            if all.len() > MOST {
                kept = best_of_each(kept, questions.len(), each);
            }
        }
        let (candidates, information) = kept.into_iter().map(|(c, i, _)| (c, i)).unzip();
        Some(Self { candidates, information, everything })
    }
}

/// Returns the `each` best for every question, in their original order.
fn best_of_each<T>(
    all: Vec<(T, DMatrix<f64>, Vec<f64>)>,
    questions: usize,
    each: usize,
) -> Vec<(T, DMatrix<f64>, Vec<f64>)> {
    let mut is_kept = vec![false; all.len()];
    for question in 0..questions {
        let mut order: Vec<usize> = (0..all.len()).collect();
        sort_by_number(&mut order, |i| -all[*i].2[question]);
        order.into_iter().take(each).for_each(|i| is_kept[i] = true);
    }
    all.into_iter().zip(is_kept).filter(|(_, kept)| *kept).map(|(one, _)| one).collect()
}

/// Returns the information of each candidate, as if each were mounted separately, since the
/// combination is not yet known.
fn of_candidates(
    design: &Design<'_>,
    all: &[Candidate],
    rig: &RigLimits,
    minutes: f64,
) -> Option<Vec<DMatrix<f64>>> {
    // Offsets that drift between runs are independent offsets of single runs.
    let mut noise = design.noise;
    noise.walk = Wandering::default();
    let design = Design { model: design.model, noise, traces: design.traces };
    let begins_s = |c: &Candidate| if c.late { 0.75 * 60.0 * minutes } else { 0.0 };
    let rows: Vec<PlateauRow> =
        all.iter().enumerate().flat_map(|(i, c)| alone(c, &i.to_string(), rig, begins_s(c))).collect();
    let each = design.by_series(&rows)?;
    // The run before a candidate is not part of it.
    let has_before = all.iter().any(|c| c.after_g.is_some());
    Some(if has_before { each.into_iter().skip(1).step_by(2).collect() } else { each })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_question_keeps_its_best() {
        let of = |name, gains: [f64; 2]| (name, DMatrix::zeros(0, 0), gains.to_vec());
        let all = vec![of("a", [3.0, 0.0]), of("b", [2.0, 1.0]), of("c", [1.0, 2.0]), of("d", [0.0, 3.0])];
        let names = |each| -> Vec<&str> {
            best_of_each(all.clone(), 2, each).into_iter().map(|(name, _, _)| name).collect()
        };
        assert_eq!(names(1), ["a", "d"]);
        assert_eq!(names(2), ["a", "b", "c", "d"]);
    }
}
