//! Matches the series of a table with the runs of a plan.

use std::collections::HashMap;

use pinswitch_calibration::experiment::PlannedRun;
use pinswitch_calibration::table::PlateauRow;
use pinswitch_friction::published::load_n;

/// Tolerance of a load, as a share of the planned load; covers the hook and the scale.
const LOAD_TOLERANCE: f64 = 0.05;
/// Tolerance of a speed: percentage points, or a share of the planned speed if that is more.
const SPEED_TOLERANCE: (f64, f64) = (2.0, 0.05);
/// Tolerance of a dwell: seconds, or a share of the planned dwell if that is more.
const DWELL_TOLERANCE: (f64, f64) = (0.3, 0.2);

/// Match of a table with a plan.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct PlanMatch {
    /// Number of runs in the plan.
    pub(super) planned: usize,
    /// Number of runs with a separate series in the table.
    pub(super) made: usize,
    /// Number of these runs, at most, whose series follow the order of the plan.
    in_order: usize,
}

impl PlanMatch {
    /// Matches the series of `rows` with `runs`.
    pub(super) fn new(runs: &[PlannedRun], rows: &[PlateauRow]) -> Self {
        let all = series(rows);
        // For each run, the series within its tolerances, with their differences.
        let candidates: Vec<Vec<(usize, f64)>> = runs
            .iter()
            .map(|run| {
                let of = |(at, rows): (usize, &Vec<&PlateauRow>)| Some((at, difference(run, rows)?));
                all.iter().enumerate().filter_map(of).collect()
            })
            .collect();
        let in_order = longest_in_order(&candidates, all.len());
        Self { planned: runs.len(), made: matched(&candidates, all.len()).max(in_order), in_order }
    }

    /// Whether the table was recorded by the plan: at least half of the runs are in it.
    pub(super) fn is_by_plan(self) -> bool {
        2 * self.made >= self.planned
    }

    /// Whether the recorded runs follow the order of the plan.
    pub(super) fn is_in_order(self) -> bool {
        self.in_order == self.made
    }
}

/// Groups the rows by series, in the order of recording: by session, then by time.
fn series(rows: &[PlateauRow]) -> Vec<Vec<&PlateauRow>> {
    let mut groups: Vec<(usize, f64, Vec<&PlateauRow>)> = Vec::new();
    let (mut sessions, mut places) = (HashMap::new(), HashMap::new());
    for row in rows {
        let count = sessions.len();
        let session = *sessions.entry(row.labels.session.as_str()).or_insert(count);
        let place = *places.entry((session, row.series.as_str())).or_insert(groups.len());
        if place == groups.len() {
            groups.push((session, row.time_s, Vec::new()));
        }
        let (_, begin_s, of) = &mut groups[place];
        *begin_s = begin_s.min(row.time_s);
        of.push(row);
    }
    groups.sort_by(|(a, a_s, _), (b, b_s, _)| a.cmp(b).then(a_s.total_cmp(b_s)));
    groups.into_iter().map(|(_, _, of)| of).collect()
}

/// Returns the sum of the differences of a series from a run, in units of their tolerances; `None` if one exceeds its
/// tolerance.
fn difference(run: &PlannedRun, of: &[&PlateauRow]) -> Option<f64> {
    let load_n = load_n(run.load_mass_g);
    let share = |is: f64, planned: f64, allowed: f64| {
        let off = (is - planned).abs() / allowed;
        // The bound itself is within, despite rounding.
        (off <= 1.0 + 1e-9).then_some(off)
    };
    let allowed = |(fixed, share): (f64, f64), planned: f64| f64::max(fixed, share * planned);
    let of_row = |row: &&PlateauRow| {
        let is_alike = row.substrate == run.substrate && row.pins == run.pins && row.sweep == run.sweep;
        if !is_alike {
            return None;
        }
        let load = share(row.load_n, load_n, LOAD_TOLERANCE * load_n.max(1.0))?;
        let speed = share(row.speed_pct, run.speed_pct, allowed(SPEED_TOLERANCE, run.speed_pct))?;
        Some(load + speed + share(row.dwell_s, run.dwell_s, allowed(DWELL_TOLERANCE, run.dwell_s))?)
    };
    of.iter().filter_map(of_row).min_by(f64::total_cmp)
}

/// Counts the runs that match a separate series, where each run takes the most similar free series.
fn matched(candidates: &[Vec<(usize, f64)>], series: usize) -> usize {
    let mut is_taken = vec![false; series];
    let mut take = |of: &Vec<(usize, f64)>| {
        let free = of.iter().filter(|(at, _)| !is_taken[*at]);
        let (at, _) = free.min_by(|(_, a), (_, b)| a.total_cmp(b))?;
        is_taken[*at] = true;
        Some(*at)
    };
    candidates.iter().filter_map(&mut take).count()
}

/// Counts the runs whose separate series follow the order of the plan, at most: the longest common subsequence.
fn longest_in_order(candidates: &[Vec<(usize, f64)>], series: usize) -> usize {
    // The longest subsequence so far that ends before each place.
    let mut most = vec![0; series + 1];
    for of in candidates {
        let before = most.clone();
        for (at, _) in of {
            most[at + 1] = most[at + 1].max(before[*at] + 1);
        }
        for place in 1..=series {
            most[place] = most[place].max(most[place - 1]);
        }
    }
    most[series]
}

#[cfg(test)]
mod tests {
    use super::*;
    use pinswitch_calibration::experiment::{RigLimits, rows_of};
    use pinswitch_calibration::table::Sweep;
    use pinswitch_friction::Substrate;

    fn run(load_mass_g: f64, speed_pct: f64, dwell_s: f64) -> PlannedRun {
        PlannedRun {
            substrate: Some(Substrate::Silicone),
            pins: vec![5, 8, 11],
            sweep: Sweep::Up,
            load_mass_g,
            speed_pct,
            dwell_s,
            repetitions: [4, 5],
            mount: 1,
            minutes: 3.0,
            asks: String::new(),
            wrap_angle_deg: None,
        }
    }

    fn recorded(planned: &[PlannedRun], made: &[PlannedRun]) -> (usize, bool) {
        let plan_match = PlanMatch::new(planned, &rows_of(made, &RigLimits::default(), ""));
        (plan_match.made, plan_match.is_in_order())
    }

    #[test]
    fn a_run_matches_within_tolerances() {
        let planned = run(1003.2, 40.0, 3.0);
        let is_made = |made: PlannedRun| recorded(std::slice::from_ref(&planned), &[made]).0 == 1;
        for (made, as_planned) in [
            (planned.clone(), true),
            (run(1050.0, 42.0, 3.5), true),
            (run(1003.2, 38.0, 2.4), true),
            (run(1103.2, 40.0, 3.0), false),
            (run(1003.2, 43.0, 3.0), false),
            (run(1003.2, 40.0, 3.7), false),
            (PlannedRun { sweep: Sweep::Down, ..planned.clone() }, false),
            (PlannedRun { pins: vec![5, 8], ..planned.clone() }, false),
            (PlannedRun { substrate: Some(Substrate::Abs), ..planned.clone() }, false),
        ] {
            assert_eq!(is_made(made.clone()), as_planned, "{made:?}");
        }
        // The larger of the two tolerances applies, to fast speeds and to short dwells.
        let near = |planned, made| recorded(&[planned], &[made]).0 == 1;
        assert!(near(run(1003.2, 90.0, 0.5), run(1003.2, 94.0, 0.75)));
        assert!(!near(run(1003.2, 90.0, 0.5), run(1003.2, 95.0, 0.5)));
    }

    #[test]
    fn each_run_needs_a_separate_series() {
        let (one, other) = (run(1003.2, 40.0, 3.0), run(2005.0, 40.0, 3.0));
        let three_times = [one.clone(), one.clone(), one.clone(), other.clone()];
        assert_eq!(recorded(&three_times, &[one.clone(), other.clone()]), (2, true));
        assert_eq!(recorded(&three_times, &three_times), (4, true));
        // Runs that are nearly equal take the series most similar to them.
        let near = [run(1003.2, 41.0, 3.0), run(1003.2, 40.0, 3.0)];
        assert_eq!(recorded(&near, &[run(1003.2, 42.5, 3.0), run(1003.2, 40.5, 3.0)]), (2, true));
        assert_eq!(recorded(&near, &[]).0, 0);
    }

    #[test]
    fn another_order_is_detected_despite_gaps() {
        let all: Vec<PlannedRun> = [503.6, 1003.2, 2005.0, 3007.2].map(|g| run(g, 40.0, 3.0)).to_vec();
        let of =
            |places: &[usize]| recorded(&all, &places.iter().map(|at| all[*at].clone()).collect::<Vec<_>>());
        assert_eq!((of(&[0, 1, 3]), of(&[0, 3, 1]), of(&[3, 2, 1, 0])), ((3, true), (3, false), (4, false)));
        // Time defines the order, not the order of the rows in the file.
        let mut rows = rows_of(&all, &RigLimits::default(), "");
        rows.reverse();
        assert!(PlanMatch::new(&all, &rows).is_in_order());
    }
}
