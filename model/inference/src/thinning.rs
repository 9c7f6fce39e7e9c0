//! Some of the rows of a large problem, on which a search starts.
//!
//! The time of a fit grows with the number of readings, and with their number in a series again. Readings that repeat each other
//! in one series say little about hypotheses that a few of them do not say. So the hypotheses are searched on some readings of
//! every series, and then fitted to all of them.

use nalgebra::DVector;

use crate::design::Mode;
use crate::noise::EXCLUDED;
use crate::problem::{Problem, Rows};

/// Least number of readings of a series and direction that are kept.
const LEAST_OF_DIRECTION: usize = 2;

/// A problem with some of the rows of another one.
pub(crate) struct Thinned {
    pub(crate) problem: Problem,
    /// Index in the whole problem of each row.
    source: Vec<usize>,
    /// Number of rows of the whole problem.
    whole: usize,
}

impl Thinned {
    /// Returns about `most` rows of a problem, from all series; `None` if that would not halve their number.
    pub(crate) fn new(problem: &Problem, most: usize) -> Option<Self> {
        let source = kept_rows(problem, most);
        (2 * source.len() <= problem.len()).then(|| Self {
            problem: problem.of_rows(&source),
            source,
            whole: problem.len(),
        })
    }

    /// Returns a list over all rows at the rows of this problem; an empty list stays empty.
    pub(crate) fn select<T: Copy>(&self, all: &[T]) -> Vec<T> {
        self.source.iter().filter_map(|row| all.get(*row).copied()).collect()
    }

    /// Returns a mode of this problem as one of the whole problem, whose rows have the weight 1 unless they are excluded.
    pub(crate) fn extended(&self, mode: &Mode, excluded: &[bool]) -> Mode {
        let weight = |row: usize| if excluded.get(row) == Some(&true) { EXCLUDED } else { 1.0 };
        Mode { weights: DVector::from_fn(self.whole, |row, _| weight(row)), ..mode.clone() }
    }
}

/// Returns every third, fifth or further reading of each series and direction. The step is odd, so that readings that alternate
/// still do; its start changes from series to series, so that all positions along a series are kept somewhere.
fn kept_rows(problem: &Problem, most: usize) -> Vec<usize> {
    let rows = &problem.rows;
    let step = problem.len().div_ceil(most.max(1)) | 1;
    let mut kept = Vec::new();
    for (series, range) in problem.ranges.iter().enumerate() {
        let (second, first): (Vec<usize>, Vec<usize>) = range.clone().partition(|row| rows.direction[*row]);
        let mut of_series = Vec::new();
        for of_direction in [first, second] {
            // The largest odd step, at any start, that keeps enough.
            let most = (of_direction.len() / LEAST_OF_DIRECTION).max(2) - 1;
            let step = step.min(most | 1);
            of_series.extend(of_direction.into_iter().skip(series % step).step_by(step));
        }
        of_series.sort_unstable();
        kept.extend(of_series);
    }
    kept
}

impl Problem {
    /// Returns the problem of some rows, in ascending order and of every series.
    fn of_rows(&self, kept: &[usize]) -> Self {
        fn select<T: Copy>(all: &[T], kept: &[usize]) -> Vec<T> {
            kept.iter().map(|row| all[*row]).collect()
        }
        let all = &self.rows;
        let rows = Rows {
            series: select(&all.series, kept),
            direction: select(&all.direction, kept),
            sessions: select(&all.sessions, kept),
            order: select(&all.order, kept),
            load: select(&all.load, kept),
            levels: all.levels.iter().map(|levels| select(levels, kept)).collect(),
            bases: all
                .bases
                .iter()
                .map(|bases| bases.iter().map(|basis| basis.select(kept)).collect())
                .collect(),
            discrepancies: all
                .discrepancies
                .iter()
                .map(|columns| columns.iter().map(|column| select(column, kept)).collect())
                .collect(),
            relevant: all.relevant.iter().map(|changes| select(changes, kept)).collect(),
            is_new_session: all.is_new_session,
            forward: all.forward.of_rows(kept),
        };
        let ranges = rows.ranges();
        let readings = self.readings.select_rows(kept);
        Self::of_parts(self.space.clone(), rows, readings, ranges, self.reference)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hypothesis::Member;
    use crate::search::{Search, SearchOptions};
    use crate::test_problem::long_problem;

    #[test]
    fn every_series_keeps_readings_of_both_directions() {
        let whole = long_problem(7, 40, 0.0);
        let thinned = Thinned::new(&whole, 60).unwrap();
        assert!(thinned.problem.len() <= 70, "{}", thinned.problem.len());
        assert_eq!(thinned.problem.ranges.len(), whole.ranges.len());
        for range in &thinned.problem.ranges {
            let seconds = range.clone().filter(|row| thinned.problem.rows.direction[*row]).count();
            assert!(seconds >= 2 && range.len() - seconds >= 2, "{range:?}");
        }
        let starts: Vec<usize> =
            thinned.problem.ranges.iter().map(|range| thinned.problem.rows.order[range.start]).collect();
        assert!(starts.iter().any(|start| *start != starts[0]), "{starts:?}");
        assert_eq!(thinned.select(&whole.rows.load), thinned.problem.rows.load);
        assert!(Thinned::new(&whole, 280).is_none());
        assert!(Thinned::new(&long_problem(7, 5, 0.0), 10).is_none());
    }

    /// The posterior is that of all readings: the same window as without thinning, with the same scores.
    #[test]
    fn a_search_that_starts_thinned_ends_at_the_posterior_of_all_readings() {
        for offset in [0.0, 0.15, 0.6] {
            let problem = long_problem(12, 40, offset);
            let whole = Search::new(&problem, SearchOptions::default(), &[]).run();
            let options = SearchOptions { thinned_above: 100, ..SearchOptions::default() };
            let thinned = Search::new(&problem, options, &[]).run();
            assert_eq!(whole[0].hypothesis, thinned[0].hypothesis, "{offset}");
            assert!((whole[0].score - thinned[0].score).abs() < 0.1, "{offset}");
            assert_eq!(whole[0].hypothesis.contains(Member::Effect(0)), offset > 0.1, "{offset}");
        }
    }
}
