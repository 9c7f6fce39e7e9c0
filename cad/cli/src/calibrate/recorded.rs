//! How many runs of a plan a table holds, and whether in their order.

use std::collections::HashMap;

use pinswitch_calibration::experiment::PlannedRun;
use pinswitch_calibration::table::PlateauRow;
use pinswitch_friction::published::load_n;

/// By how much a weight may differ from the one planned, as a share of it: hook and scale included.
const SAME_LOAD: f64 = 0.05;
/// By how much a speed may differ: in points of percent, or as a share of the one planned, whichever is more.
const SAME_SPEED: (f64, f64) = (2.0, 0.05);
/// By how much a dwell may differ: in seconds, or as a share of the one planned, whichever is more.
const SAME_DWELL: (f64, f64) = (0.3, 0.2);

/// What a table holds of a plan.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Recorded {
    /// Runs of the plan.
    pub(super) planned: usize,
    /// Runs that have a series of their own in the table.
    pub(super) made: usize,
    /// The most of them whose series follow each other as the runs do.
    in_order: usize,
}

impl Recorded {
    /// What rows hold of these runs.
    pub(super) fn of(runs: &[PlannedRun], rows: &[PlateauRow]) -> Self {
        let all = series(rows);
        // The difference of each series that may be a run's from what was planned.
        let may_be: Vec<Vec<(usize, f64)>> = runs
            .iter()
            .map(|run| {
                let of = |(at, rows): (usize, &Vec<&PlateauRow>)| Some((at, difference(run, rows)?));
                all.iter().enumerate().filter_map(of).collect()
            })
            .collect();
        let in_order = longest_in_order(&may_be, all.len());
        Self { planned: runs.len(), made: with_one_of_their_own(&may_be, all.len()).max(in_order), in_order }
    }

    /// Whether the table was recorded by the plan, though runs may have been left out.
    pub(super) fn is_by_plan(self) -> bool {
        2 * self.made >= self.planned
    }

    /// Whether the runs that were made follow each other as planned.
    pub(super) fn is_in_order(self) -> bool {
        self.in_order == self.made
    }
}

/// The rows of each series, in the order in which they were recorded: session by session, by time.
fn series(rows: &[PlateauRow]) -> Vec<Vec<&PlateauRow>> {
    let mut found: Vec<(usize, f64, Vec<&PlateauRow>)> = Vec::new();
    let (mut sessions, mut places) = (HashMap::new(), HashMap::new());
    for row in rows {
        let count = sessions.len();
        let session = *sessions.entry(row.labels.session.as_str()).or_insert(count);
        let place = *places.entry((session, row.series.as_str())).or_insert(found.len());
        if place == found.len() {
            found.push((session, row.time_s, Vec::new()));
        }
        let (_, begin_s, of) = &mut found[place];
        *begin_s = begin_s.min(row.time_s);
        of.push(row);
    }
    found.sort_by(|(a, a_s, _), (b, b_s, _)| a.cmp(b).then(a_s.total_cmp(b_s)));
    found.into_iter().map(|(_, _, of)| of).collect()
}

/// By how much a series differs from a run, in units of what it may differ by; `None` where it is not that run.
fn difference(run: &PlannedRun, of: &[&PlateauRow]) -> Option<f64> {
    let load_n = load_n(run.load_mass_g);
    let share = |is: f64, planned: f64, allowed: f64| {
        let off = (is - planned).abs() / allowed;
        // The bound itself is within, however it is rounded.
        (off <= 1.0 + 1e-9).then_some(off)
    };
    let allowed = |(fixed, share): (f64, f64), planned: f64| f64::max(fixed, share * planned);
    let of_row = |row: &&PlateauRow| {
        let is_alike = row.substrate == Some(run.substrate) && row.pins == run.pins && row.sweep == run.sweep;
        if !is_alike {
            return None;
        }
        let load = share(row.load_n, load_n, SAME_LOAD * load_n.max(1.0))?;
        let speed = share(row.speed_pct, run.speed_pct, allowed(SAME_SPEED, run.speed_pct))?;
        Some(load + speed + share(row.dwell_s, run.dwell_s, allowed(SAME_DWELL, run.dwell_s))?)
    };
    of.iter().filter_map(of_row).min_by(f64::total_cmp)
}

/// How many runs have a series of their own, where each takes the one that is most like it.
fn with_one_of_their_own(may_be: &[Vec<(usize, f64)>], series: usize) -> usize {
    let mut is_taken = vec![false; series];
    let mut take = |of: &Vec<(usize, f64)>| {
        let free = of.iter().filter(|(at, _)| !is_taken[*at]);
        let (at, _) = free.min_by(|(_, a), (_, b)| a.total_cmp(b))?;
        is_taken[*at] = true;
        Some(*at)
    };
    may_be.iter().filter_map(&mut take).count()
}

/// The most runs that have series of their own which follow each other as the runs do: the longest common subsequence.
fn longest_in_order(may_be: &[Vec<(usize, f64)>], series: usize) -> usize {
    // The most so far that end with a series before each place.
    let mut most = vec![0; series + 1];
    for of in may_be {
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
            substrate: Substrate::Silicone,
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
        let found = Recorded::of(planned, &rows_of(made, &RigLimits::default(), ""));
        (found.made, found.is_in_order())
    }

    #[test]
    fn a_run_is_made_by_a_series_of_its_kind_and_settings() {
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
            (PlannedRun { substrate: Substrate::Abs, ..planned.clone() }, false),
        ] {
            assert_eq!(is_made(made.clone()), as_planned, "{made:?}");
        }
        // A fast run may differ by more than two points, a short pause by more than a fifth.
        let near = |planned, made| recorded(&[planned], &[made]).0 == 1;
        assert!(near(run(1003.2, 90.0, 0.5), run(1003.2, 94.0, 0.75)));
        assert!(!near(run(1003.2, 90.0, 0.5), run(1003.2, 95.0, 0.5)));
    }

    #[test]
    fn each_run_needs_a_series_of_its_own() {
        let (one, other) = (run(1003.2, 40.0, 3.0), run(2005.0, 40.0, 3.0));
        let thrice = [one.clone(), one.clone(), one.clone(), other.clone()];
        assert_eq!(recorded(&thrice, &[one.clone(), other.clone()]), (2, true));
        assert_eq!(recorded(&thrice, &thrice), (4, true));
        // Runs that are nearly alike take the series that are most like them.
        let near = [run(1003.2, 41.0, 3.0), run(1003.2, 40.0, 3.0)];
        assert_eq!(recorded(&near, &[run(1003.2, 42.5, 3.0), run(1003.2, 40.5, 3.0)]), (2, true));
        assert_eq!(recorded(&near, &[]).0, 0);
    }

    #[test]
    fn another_order_is_seen_though_runs_were_left_out() {
        let all: Vec<PlannedRun> = [503.6, 1003.2, 2005.0, 3007.2].map(|g| run(g, 40.0, 3.0)).to_vec();
        let of =
            |places: &[usize]| recorded(&all, &places.iter().map(|at| all[*at].clone()).collect::<Vec<_>>());
        assert_eq!((of(&[0, 1, 3]), of(&[0, 3, 1]), of(&[3, 2, 1, 0])), ((3, true), (3, false), (4, false)));
        // It is time that tells the order, whichever way the rows stand in the file.
        let mut rows = rows_of(&all, &RigLimits::default(), "");
        rows.reverse();
        assert!(Recorded::of(&all, &rows).is_in_order());
    }
}
