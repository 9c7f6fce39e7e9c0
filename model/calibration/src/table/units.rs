//! Whether loads and readings can be newtons, and directions the right way round, where no mass and no second direction says so.

use std::collections::{BTreeMap, BTreeSet};

use pinswitch_friction::Direction;

use super::follows::{conditions, slope};
use super::row::PlateauRow;
use super::substrate_word::substrate_word;
use super::table_error::TableError;
use crate::median::median;

/// Median loads in newtons of tendons that a printed switch can carry, and that a load cell can tell from none.
const LOADS_N: std::ops::RangeInclusive<f64> = 0.3..=1000.0;
/// What both directions together may read for each newton: friction falls out of their geometric mean, gains of cells do not.
const READS: std::ops::RangeInclusive<f64> = 0.6..=1.6;
/// Wrap angle in degrees up to which that mean says something: beyond it friction is no small part of what is read.
const NARROW_DEG: f64 = 120.0;
/// Newtons per newton by which the middle condition of a direction alone must lie on the wrong side of its load, and none of
/// them may lie on the right one: a gain of a cell does less, and friction of silicone more.
const WRONG_SIDE: (f64, f64) = (0.05, 0.02);
/// Measured wrap angles of one layout that are kept apart.
const MOST_WRAPS: usize = 8;

/// What cannot be newtons, or is labelled the wrong way round.
pub(super) fn implausible(rows: &[PlateauRow], file: &str) -> Option<TableError> {
    let mut loads: Vec<f64> = rows.iter().map(|r| r.load_n).filter(|n| *n > 0.0).collect();
    let load_n = median(&mut loads);
    let file = file.to_owned();
    if !LOADS_N.contains(&load_n) {
        return Some(TableError::NoNewtons { file, load_n, bounds: LOADS_N });
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
    // Friction adds to what is pulled and takes from what is released.
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

/// A wrap angle that was measured row by row would make a condition of each.
fn scattered_wraps(rows: &[PlateauRow], file: &str) -> Option<TableError> {
    let mut found: BTreeMap<(&str, &[usize]), BTreeSet<u64>> = BTreeMap::new();
    for row in rows.iter().filter(|row| row.substrate.is_some()) {
        let wraps = found.entry((substrate_word(row.substrate), &row.pins)).or_default();
        wraps.insert(row.wrap_angle_deg.to_bits());
    }
    let (_, wraps) = found.into_iter().find(|(_, wraps)| wraps.len() > MOST_WRAPS)?;
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

    fn said(change: impl Fn(&mut PlateauRow), only: Option<Direction>) -> String {
        let mut rows = session(4);
        rows.iter_mut().for_each(change);
        rows.retain(|r| only.is_none_or(|direction| r.direction == direction));
        implausible(&rows, "t.csv").map_or_else(String::new, |e| e.to_string())
    }

    #[test]
    fn other_units_are_told_without_masses() {
        assert_eq!(said(|_| {}, None), "");
        for factor in [101.97, 1e-3] {
            let told = said(
                |r| {
                    r.load_n *= factor;
                    r.force_n *= factor;
                },
                None,
            );
            assert!(told.contains("column 'load_N'") && told.contains("newtons"), "{factor}: {told}");
        }
        for factor in [0.2248, 2.0] {
            let told = said(|r| r.force_n *= factor, None);
            assert!(
                told.contains("column 'force_N'") && told.contains("times the loads"),
                "{factor}: {told}"
            );
        }
        assert_eq!(said(|r| r.force_n *= 1.3, None), "", "a gain of a cell is the fit's");
    }

    #[test]
    fn one_direction_under_the_name_of_the_other_is_told() {
        for only in [Direction::Eccentric, Direction::Concentric] {
            assert_eq!(said(|_| {}, Some(only)), "");
            let told = said(
                |r| {
                    r.direction = match r.direction {
                        Direction::Eccentric => Direction::Concentric,
                        Direction::Concentric => Direction::Eccentric,
                    };
                },
                Some(only),
            );
            assert!(told.contains("column 'direction'"), "{told}");
        }
    }

    #[test]
    fn a_wrap_angle_for_every_row_is_told() {
        let mut at = 0.0;
        let mut rows = session(4);
        for row in &mut rows {
            at += 0.001;
            row.wrap_angle_deg += at;
        }
        let told = implausible(&rows, "t.csv").unwrap().to_string();
        assert!(told.contains("column 'wrap_angle_deg'"), "{told}");
    }
}
