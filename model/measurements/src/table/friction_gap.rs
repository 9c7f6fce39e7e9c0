//! Check that the two directions differ by friction: pulling a load takes more force than releasing
//! it.

use pinswitch_friction::{Direction, sort_by_number};

use super::follows::conditions;
use super::row::PlateauRow;
use crate::median::median;

/// Loads that differ by less than this share count as equal.
const ONE_LOAD: f64 = 0.005;
/// Share of the load below which friction counts as absent, whatever the scatter.
const NONE: f64 = 0.001;
/// Share of the load above which friction counts as measured, whatever the scatter.
const SOME: f64 = 0.01;
/// Number of standard errors within which a share is not significant.
const ERRORS: f64 = 3.0;
/// Share of a condition's loads whose directions must be swapped for the condition to count.
const MOST: f64 = 0.75;

/// Friction at one load of one condition.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Gap {
    /// Load in newtons.
    pub(super) load_n: f64,
    /// Median eccentric reading in newtons.
    pub(super) eccentric_n: f64,
    /// Median concentric reading in newtons, interpolated between neighbouring loads where it is
    /// missing.
    pub(super) concentric_n: f64,
}

impl Gap {
    /// Returns friction as a share of the load: half of the difference between the directions.
    fn share(self) -> f64 {
        0.5 * (self.concentric_n - self.eccentric_n) / self.load_n
    }
}

/// Friction of a table, judged from its directions.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Friction {
    /// Present, or not decidable from the table.
    Measured,
    /// The directions differ in none of this number of conditions.
    Nowhere(usize),
    /// In most conditions the concentric readings are below the eccentric ones.
    Backwards {
        /// Number of conditions with swapped directions.
        backwards: usize,
        /// Number of conditions with both directions.
        judged: usize,
        /// The gap of median size.
        example: Gap,
    },
}

/// Judges the friction of `force` over `load`; these need not be the columns of those names.
pub(super) fn friction(
    rows: &[PlateauRow],
    load: impl Fn(&PlateauRow) -> f64,
    force: impl Fn(&PlateauRow) -> f64,
) -> Friction {
    let (mut none, mut shares, mut backwards) = (Vec::new(), Vec::new(), Vec::new());
    for of in conditions(rows) {
        let course = |direction| course(&of, direction, &load, &force);
        let (eccentric, concentric) = (course(Direction::Eccentric), course(Direction::Concentric));
        let gaps = gaps(&eccentric, &concentric);
        if gaps.is_empty() {
            // With one direction, offsets may hide friction: only an exact copy of the loads shows
            // none.
            let mut readings = eccentric.iter().chain(&concentric).peekable();
            if readings.peek().is_some() {
                none.push(readings.all(|(load, reading)| (reading / load - 1.0).abs() < NONE));
            }
            continue;
        }
        let condition: Vec<f64> = gaps.iter().map(|g| g.share()).collect();
        let negative = condition.iter().filter(|share| **share < 0.0).count();
        none.push(is_none(&condition));
        backwards.push((negative as f64 >= MOST * gaps.len() as f64, gaps));
        shares.extend(condition);
    }
    if !none.is_empty() && none.iter().all(|none| *none) {
        return Friction::Nowhere(none.len());
    }
    let wrong: Vec<Gap> =
        backwards.iter().filter(|(wrong, _)| *wrong).flat_map(|(_, gaps)| gaps).copied().collect();
    let count = backwards.iter().filter(|(wrong, _)| *wrong).count();
    match middle_gap(wrong) {
        Some(example) if 2 * count > backwards.len() && is_negative(&shares) => {
            Friction::Backwards { backwards: count, judged: backwards.len(), example }
        }
        _ => Friction::Measured,
    }
}

/// Returns the median reading at each load above zero in one direction, by ascending load.
fn course(
    rows: &[&PlateauRow],
    direction: Direction,
    load: &impl Fn(&PlateauRow) -> f64,
    force: &impl Fn(&PlateauRow) -> f64,
) -> Vec<(f64, f64)> {
    let of = rows.iter().filter(|r| r.direction == direction).map(|r| (load(r), force(r)));
    let mut pairs: Vec<(f64, f64)> = of.filter(|(load, _)| *load > 0.0).collect();
    sort_by_number(&mut pairs, |(load_n, _)| *load_n);
    pairs
        .chunk_by(|a, b| b.0 - a.0 < ONE_LOAD * a.0)
        .map(|chunk| {
            let middle =
                |value: fn(&(f64, f64)) -> f64| median(&mut chunk.iter().map(value).collect::<Vec<_>>());
            (middle(|p| p.0), middle(|p| p.1))
        })
        .collect()
}

/// Returns the gaps at the eccentric loads within the range of the concentric ones.
fn gaps(eccentric: &[(f64, f64)], concentric: &[(f64, f64)]) -> Vec<Gap> {
    eccentric
        .iter()
        .filter_map(|(load_n, eccentric_n)| {
            let after = concentric.iter().position(|(load, _)| *load > load_n * (1.0 - ONE_LOAD))?;
            let (right, right_n) = concentric[after];
            let concentric_n = if right < load_n * (1.0 + ONE_LOAD) {
                right_n
            } else {
                let (left, left_n) = concentric[after.checked_sub(1)?];
                left_n + (right_n - left_n) * (load_n - left) / (right - left)
            };
            Some(Gap { load_n: *load_n, eccentric_n: *eccentric_n, concentric_n })
        })
        .collect()
}

/// Returns the standard error of the mean of some shares.
fn standard_error(shares: &[f64]) -> f64 {
    let n = shares.len() as f64;
    let mean = shares.iter().sum::<f64>() / n;
    let squares: f64 = shares.iter().map(|s| (s - mean).powi(2)).sum();
    if shares.len() < 2 { 0.0 } else { (squares / (n - 1.0) / n).sqrt() }
}

/// Returns whether the median share is small and not significantly different from zero.
fn is_none(shares: &[f64]) -> bool {
    let middle = median(&mut shares.to_vec());
    middle.abs() < (ERRORS * standard_error(shares)).clamp(NONE, SOME)
}

/// Returns whether the shares are significantly negative: the median by a size typical of friction,
/// or nearly all of them.
fn is_negative(shares: &[f64]) -> bool {
    let middle = median(&mut shares.to_vec());
    let negative = shares.iter().filter(|share| **share < 0.0).count() as f64;
    let excess = 2.0 * negative - shares.len() as f64;
    middle < -2.0 * SOME || (middle < -NONE && excess > ERRORS * (shares.len() as f64).sqrt())
}

/// Returns the gap of median share.
fn middle_gap(mut gaps: Vec<Gap>) -> Option<Gap> {
    sort_by_number(&mut gaps, |gap| gap.share());
    gaps.get(gaps.len() / 2).copied()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_session::session;

    fn of(rows: &[PlateauRow]) -> Friction {
        friction(rows, |r| r.load_n, |r| r.force_n)
    }

    fn turn(direction: Direction) -> Direction {
        match direction {
            Direction::Eccentric => Direction::Concentric,
            Direction::Concentric => Direction::Eccentric,
        }
    }

    #[test]
    fn swapped_labels_are_detected() {
        let mut rows = session(2);
        assert_eq!(of(&rows), Friction::Measured);
        rows.iter_mut().filter(|r| r.pins.is_empty()).for_each(|r| r.direction = turn(r.direction));
        assert_eq!(of(&rows), Friction::Measured);
        rows.iter_mut().filter(|r| !r.pins.is_empty()).for_each(|r| r.direction = turn(r.direction));
        let Friction::Backwards { backwards: 5, judged: 5, example } = of(&rows) else {
            panic!("{:?}", of(&rows))
        };
        assert!(example.concentric_n < example.eccentric_n);
    }

    #[test]
    fn directions_may_have_different_loads() {
        let mut rows = session(2);
        for row in &mut rows {
            let factor = if row.direction == Direction::Concentric { 1.2 } else { 1.0 };
            (row.load_n, row.force_n) = (factor * row.load_n, factor * row.force_n);
        }
        assert_eq!(of(&rows), Friction::Measured);
        rows.iter_mut().for_each(|r| r.direction = turn(r.direction));
        assert!(matches!(of(&rows), Friction::Backwards { .. }), "{:?}", of(&rows));
    }

    #[test]
    fn small_friction_differs_from_none() {
        let scatter = |i: usize| 0.05 * ((i * 37 % 101) as f64 / 50.0 - 1.0);
        let with = |share: f64, noise: f64| {
            let mut rows = session(2);
            for (i, row) in rows.iter_mut().enumerate() {
                row.force_n = row.load_n * (1.0 + share * row.direction.sign()) + noise * scatter(i);
            }
            rows
        };
        for noise in [0.0, 1.0, 3.0] {
            assert_eq!(of(&with(0.0, noise)), Friction::Nowhere(5), "noise {noise}");
            assert_eq!(of(&with(0.02, noise)), Friction::Measured, "noise {noise}");
        }
        let one = |share: f64, noise: f64| {
            let mut rows = with(share, noise);
            rows.retain(|r| r.direction == Direction::Eccentric);
            of(&rows)
        };
        assert_eq!(one(0.0, 0.0), Friction::Nowhere(5));
        assert_eq!((one(0.05, 1.0), one(0.0, 3.0)), (Friction::Measured, Friction::Measured));
    }
}
