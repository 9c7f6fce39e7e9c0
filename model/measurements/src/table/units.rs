//! Plausibility of units and directions in tables without masses or without a second direction.

use std::collections::{BTreeMap, BTreeSet};

use pinswitch_friction::Direction;

use super::follows::{conditions, slope};
use super::row::PlateauRow;
use super::substrate_word::substrate_word;
use super::table_error::TableError;
use crate::median::median;

/// Plausible median loads in newtons: above what a load cell resolves, below what a printed switch
/// carries.
const LOADS_N: std::ops::RangeInclusive<f64> = 0.3..=1000.0;
/// Plausible ratio of readings to loads, as the geometric mean of both directions: friction cancels
/// in it, gains of load cells do not.
const READS: std::ops::RangeInclusive<f64> = 0.6..=1.6;
/// Largest wrap angle in degrees at which that mean is used: beyond it friction is a large part of
/// the readings.
const NARROW_DEG: f64 = 120.0;
/// Newtons per newton by which the median condition of a single direction must be on the wrong side
/// of its load, and by which none of them may be on the right side. Gains of load cells are
/// smaller, and friction of silicone is larger.
const WRONG_SIDE: (f64, f64) = (0.05, 0.02);
/// Most measured wrap angles of one layout.
const MOST_WRAPS: usize = 8;

/// Returns why the loads cannot be newtons, or which labels are swapped.
pub(super) fn implausible(rows: &[PlateauRow], file: &str) -> Option<TableError> {
    let mut loads: Vec<f64> = rows.iter().map(|r| r.load_n).filter(|n| *n > 0.0).collect();
    let load_n = median(&mut loads);
    let file = file.to_owned();
    if !LOADS_N.contains(&load_n) {
        return Some(TableError::ImplausibleLoads { file, load_n, bounds: LOADS_N });
    }
    let (mut both, mut alone, mut has_both) = (Vec::new(), Vec::new(), false);
    for of in conditions(rows) {
        let is_narrow = of.iter().all(|row| row.wrap_angle_deg <= NARROW_DEG);
        match [Direction::Eccentric, Direction::Concentric]
            .map(|direction| (direction, slope(direction, &of)))
        {
            [(_, Some(released)), (_, Some(pulled))] if released > 0.0 && pulled > 0.0 => {
                both.extend(is_narrow.then(|| (released * pulled).sqrt()));
                has_both = true;
            }
            [(direction, Some(slope)), (_, None)] | [(_, None), (direction, Some(slope))] => {
                alone.push((direction, slope));
            }
            _ => {}
        }
    }
    if !both.is_empty() && !READS.contains(&median(&mut both)) {
        return Some(TableError::ReadingUnit { file, factor: median(&mut both), bounds: READS });
    }
    // Friction adds to a pulled load and takes from a released one.
    let mut beyond: Vec<f64> =
        alone.iter().map(|(direction, slope)| direction.sign() * (slope - 1.0)).collect();
    let most = beyond.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if let Some((direction, _)) = alone.first().filter(|_| !has_both)
        && median(&mut beyond) < -WRONG_SIDE.0
        && most < WRONG_SIDE.1
    {
        return Some(TableError::WrongSide {
            file,
            direction: direction.as_str(),
            slope: median(&mut alone.iter().map(|(_, slope)| *slope).collect::<Vec<_>>()),
            conditions: beyond.iter().filter(|beyond| **beyond < 0.0).count(),
            of: alone.len(),
        });
    }
    scattered_wraps(rows, &file)
}

/// Refuses wrap angles that were measured row by row, since each would be a condition of its own.
fn scattered_wraps(rows: &[PlateauRow], file: &str) -> Option<TableError> {
    let mut wraps: BTreeMap<(&str, &[usize]), BTreeSet<u64>> = BTreeMap::new();
    for row in rows.iter().filter(|row| row.substrate.is_some()) {
        let of_layout = wraps.entry((substrate_word(row.substrate), &row.pins)).or_default();
        of_layout.insert(row.wrap_angle_deg.to_bits());
    }
    let (_, wraps) = wraps.into_iter().find(|(_, wraps)| wraps.len() > MOST_WRAPS)?;
    let angles = || wraps.iter().map(|bits| f64::from_bits(*bits));
    Some(TableError::ScatteredWraps {
        file: file.to_owned(),
        count: wraps.len(),
        least_deg: angles().fold(f64::INFINITY, f64::min),
        most_deg: angles().fold(0.0, f64::max),
        most: MOST_WRAPS,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_session::session;

    fn error(change: impl Fn(&mut PlateauRow), only: Option<Direction>) -> Option<TableError> {
        let mut rows = session(4);
        rows.iter_mut().for_each(change);
        rows.retain(|r| only.is_none_or(|direction| r.direction == direction));
        implausible(&rows, "t.csv")
    }

    #[test]
    fn other_units_are_detected_without_masses() {
        assert_eq!(error(|_| {}, None), None);
        for factor in [101.97, 1e-3] {
            let error = error(
                |r| {
                    r.load_n *= factor;
                    r.force_n *= factor;
                },
                None,
            );
            assert!(matches!(error, Some(TableError::ImplausibleLoads { .. })), "{factor}: {error:?}");
        }
        for factor in [0.2248, 2.0] {
            let error = error(|r| r.force_n *= factor, None);
            assert!(matches!(error, Some(TableError::ReadingUnit { .. })), "{factor}: {error:?}");
        }
        assert_eq!(error(|r| r.force_n *= 1.3, None), None, "the fit estimates the gain of a load cell");
    }

    #[test]
    fn a_mislabelled_single_direction_is_detected() {
        for only in [Direction::Eccentric, Direction::Concentric] {
            assert_eq!(error(|_| {}, Some(only)), None);
            let error = error(
                |r| {
                    r.direction = match r.direction {
                        Direction::Eccentric => Direction::Concentric,
                        Direction::Concentric => Direction::Eccentric,
                    };
                },
                Some(only),
            );
            assert!(matches!(error, Some(TableError::WrongSide { .. })), "{error:?}");
        }
    }

    #[test]
    fn varying_wrap_angles_are_refused() {
        let mut at = 0.0;
        let mut rows = session(4);
        for row in &mut rows {
            at += 0.001;
            row.wrap_angle_deg += at;
        }
        let error = implausible(&rows, "t.csv");
        assert!(matches!(error, Some(TableError::ScatteredWraps { .. })), "{error:?}");
    }
}
