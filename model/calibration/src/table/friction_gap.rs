//! Whether a table's two directions hold friction: pulling a load takes more than releasing it.

use pinswitch_friction::{Direction, sort_by_number};

use super::follows::conditions;
use super::row::PlateauRow;
use crate::median::median;

/// Loads that differ by less than this share count as one.
const ONE_LOAD: f64 = 0.005;
/// Share of the load below which friction counts as none, whatever the scatter.
const NONE: f64 = 0.001;
/// Share of the load above which friction counts as measured, whatever the scatter.
const SOME: f64 = 0.01;
/// Standard errors within which a share is not told from zero.
const ERRORS: f64 = 3.0;
/// Share of a condition's loads that must be the wrong way round.
const MOST: f64 = 0.75;

/// Friction at one load of one condition.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Gap {
    /// The load.
    pub(super) load_n: f64,
    /// Median reading while it is released.
    pub(super) eccentric_n: f64,
    /// Median reading while it is pulled, between neighbouring loads where there is none at this one.
    pub(super) concentric_n: f64,
}

impl Gap {
    /// Friction as a share of the load: half of what lies between the directions.
    fn share(self) -> f64 {
        0.5 * (self.concentric_n - self.eccentric_n) / self.load_n
    }
}

/// What the directions of a table say of its friction.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Friction {
    /// It is there, or the table cannot tell.
    Measured,
    /// In none of so many conditions do the directions differ.
    Nowhere(usize),
    /// In most conditions the load that is pulled reads less than the one released.
    Backwards {
        /// Conditions where it does.
        backwards: usize,
        /// Conditions with both directions.
        judged: usize,
        /// The gap of middle size.
        example: Gap,
    },
}

/// Looks at the friction of `force` over `load`, which need not be the columns of that name.
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
            // With one direction, offsets may hide friction: only a copy of the loads holds none.
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

/// Median readings over the loads above zero in one direction, by rising load.
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

/// Gaps at the loads released that lie among the loads pulled.
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

/// Standard error of the middle of some shares.
fn standard_error(shares: &[f64]) -> f64 {
    let n = shares.len() as f64;
    let mean = shares.iter().sum::<f64>() / n;
    let squares: f64 = shares.iter().map(|s| (s - mean).powi(2)).sum();
    if shares.len() < 2 { 0.0 } else { (squares / (n - 1.0) / n).sqrt() }
}

/// Whether the middle of some shares is not told from zero, and small.
fn is_none(shares: &[f64]) -> bool {
    let middle = median(&mut shares.to_vec());
    middle.abs() < (ERRORS * standard_error(shares)).clamp(NONE, SOME)
}

/// Whether the shares are below zero, and not by chance: the middle one by a size that is friction's, or nearly all.
fn is_negative(shares: &[f64]) -> bool {
    let middle = median(&mut shares.to_vec());
    let negative = shares.iter().filter(|share| **share < 0.0).count() as f64;
    let excess = 2.0 * negative - shares.len() as f64;
    middle < -2.0 * SOME || (middle < -NONE && excess > ERRORS * (shares.len() as f64).sqrt())
}

/// The gap whose share is in the middle.
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
    fn labels_the_wrong_way_round_are_told_and_those_of_one_condition_are_the_fits() {
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
    fn loads_that_differ_between_the_directions_are_compared_all_the_same() {
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
    fn readings_that_are_the_loads_hold_no_friction_but_little_friction_is_some() {
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
