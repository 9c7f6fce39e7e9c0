//! Check that readings follow loads: slope and rank correlation in each condition.

use std::collections::BTreeMap;
use std::ops::RangeInclusive;

use pinswitch_friction::{Direction, published, sort_by_number};

use super::row::PlateauRow;
use super::substrate_word::substrate_word;
use crate::correlation::rank_correlation;
use crate::median::median;

/// Plausible slopes in newtons of reading per newton of load, for friction over the paper's wrap,
/// drags and offsets.
pub(super) const FOLLOWS: RangeInclusive<f64> = 0.2..=5.0;
/// Assumed wrap in radians of a `plain` contact, whose wrap is unknown: one revolution.
const UNKNOWN_WRAP: f64 = std::f64::consts::TAU;
/// Growth of the logarithm of the bounds per radian of wrap beyond the paper's: a friction
/// coefficient that is rarely exceeded.
const PER_RADIAN: f64 = 0.4;

/// Widening of the bounds beyond which eccentric readings alone are not conclusive.
const WIDE: f64 = 3.0;
/// Ratio of the largest to the smallest load below which a condition counts as having one load.
const ONE_LOAD: f64 = 1.02;
/// Rank correlation below which readings count as unrelated to loads, whatever the slope.
const UNRELATED: f64 = 0.5;

/// Relation of a table's readings to its loads.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Following {
    /// Number of conditions whose loads vary enough to judge.
    pub(super) judged: usize,
    /// Number of judged conditions whose readings follow the loads in neither direction.
    pub(super) astray: usize,
    /// Median slope over the conditions that do not follow.
    pub(super) slope: f64,
    /// Median over all judged conditions of the rank correlation of readings and loads.
    pub(super) correlation: f64,
    /// Plausible slopes, over the wraps of the table.
    pub(super) bounds: RangeInclusive<f64>,
}

impl Following {
    /// Relates `force` to `load`; these need not be the columns of those names.
    pub(super) fn new(
        rows: &[PlateauRow],
        load: impl Fn(&PlateauRow) -> f64,
        force: impl Fn(&PlateauRow) -> f64,
    ) -> Self {
        let trend =
            |of: &[&PlateauRow]| Trend { directions: directions(of, &load, &force), widening: widening(of) };
        let judged: Vec<Trend> =
            conditions(rows).iter().map(|of| trend(of)).filter(Trend::is_conclusive).collect();
        let judged = if judged.is_empty() { across(rows, &load, &trend) } else { judged };
        let widest = judged.iter().map(|trend| trend.widening).fold(1.0, f64::max);
        let astray = judged.iter().filter(|trend| !trend.is_possible());
        let mut slopes: Vec<f64> =
            astray.filter_map(|trend| trend.directions.first()).map(|d| d.slope).collect();
        let mut correlations: Vec<f64> = judged.iter().map(Trend::correlation).collect();
        Self {
            judged: judged.len(),
            astray: slopes.len(),
            slope: median(&mut slopes),
            correlation: median(&mut correlations),
            bounds: FOLLOWS.start() / widest..=FOLLOWS.end() * widest,
        }
    }

    /// Returns whether most conditions do not follow. A single one may be a bad run, which the fit
    /// detects.
    pub(super) fn is_astray(&self) -> bool {
        2 * self.astray > self.judged
    }
}

/// Groups rows by condition.
pub(super) fn conditions(rows: &[PlateauRow]) -> Vec<Vec<&PlateauRow>> {
    let mut found: BTreeMap<(&str, &[usize], u64), Vec<&PlateauRow>> = BTreeMap::new();
    for row in rows {
        // The wrap angle of `plain` is meaningless.
        let wrap = row.substrate.map_or(0, |_| row.wrap_angle_deg.to_bits());
        found.entry((substrate_word(row.substrate), &row.pins, wrap)).or_default().push(row);
    }
    found.into_values().collect()
}

/// Judges the table as a whole where every condition has one load only: possible if the loads
/// differ by more than the friction of the conditions can.
fn across(
    rows: &[PlateauRow],
    load: &impl Fn(&PlateauRow) -> f64,
    trend: &impl Fn(&[&PlateauRow]) -> Trend,
) -> Vec<Trend> {
    let ratio = |of: &[&PlateauRow]| {
        let loads = of.iter().map(|r| load(r)).filter(|n| *n > 0.0);
        let (least, most) = loads.fold((f64::INFINITY, 0.0), |(a, b): (f64, f64), n| (a.min(n), b.max(n)));
        most / least
    };
    let all: Vec<&PlateauRow> = rows.iter().collect();
    let friction = libm::exp(PER_RADIAN * largest_wrap_rad(&all));
    let one_load = conditions(rows).iter().all(|of| ratio(of) < ONE_LOAD);
    Some(trend(&all))
        .filter(|whole| one_load && ratio(&all) > friction && whole.is_conclusive())
        .into_iter()
        .collect()
}

/// Returns the largest wrap of some rows in radians.
fn largest_wrap_rad(rows: &[&PlateauRow]) -> f64 {
    let wrap = |r: &&PlateauRow| r.substrate.map_or(UNKNOWN_WRAP, |_| r.wrap_angle_deg.to_radians());
    rows.iter().map(wrap).fold(0.0, f64::max)
}

/// Returns the factor by which a wrap beyond the paper's widens the bounds.
fn widening(rows: &[&PlateauRow]) -> f64 {
    libm::exp(PER_RADIAN * (largest_wrap_rad(rows) - published::wrap_angle_rad()).max(0.0))
}

/// Trend of readings over loads in one condition.
struct Trend {
    directions: Vec<Along>,
    widening: f64,
}

impl Trend {
    /// Returns whether either direction follows. Friction lowers the eccentric slope and raises the
    /// concentric one.
    fn is_possible(&self) -> bool {
        self.directions.iter().any(|along| {
            let (least, most) = match along.direction {
                Direction::Eccentric => (FOLLOWS.start() / self.widening, *FOLLOWS.end()),
                Direction::Concentric => (*FOLLOWS.start(), FOLLOWS.end() * self.widening),
            };
            along.correlation > UNRELATED && (least..=most).contains(&along.slope)
        })
    }

    /// Returns whether the trend is conclusive: around a wide wrap so little of an eccentric load
    /// is left that readings need not follow it.
    fn is_conclusive(&self) -> bool {
        let narrow = self.widening < WIDE;
        self.directions.iter().any(|along| narrow || along.direction == Direction::Concentric)
    }

    /// Returns the larger of the correlations of both directions.
    fn correlation(&self) -> f64 {
        self.directions.iter().map(|d| d.correlation).fold(-1.0, f64::max)
    }
}

/// Trend of readings over loads in one direction.
struct Along {
    direction: Direction,
    /// Slope between the medians of the lightest and the heaviest quarter, in newtons per newton.
    slope: f64,
    /// Rank correlation.
    correlation: f64,
}

/// Returns the trend of `force` over `load` in each direction whose loads vary enough.
fn directions(
    rows: &[&PlateauRow],
    load: &impl Fn(&PlateauRow) -> f64,
    force: &impl Fn(&PlateauRow) -> f64,
) -> Vec<Along> {
    [Direction::Eccentric, Direction::Concentric]
        .into_iter()
        .filter_map(|direction| {
            let of = rows.iter().filter(|r| r.direction == direction);
            along(direction, of.map(|r| (load(r), force(r))).collect())
        })
        .collect()
}

/// Returns the slope in one direction in newtons per newton; `None` if the loads vary too little.
pub(super) fn slope(direction: Direction, rows: &[&PlateauRow]) -> Option<f64> {
    let of = rows.iter().filter(|r| r.direction == direction);
    Some(along(direction, of.map(|r| (r.load_n, r.force_n)).collect())?.slope)
}

/// Returns `None` if the loads vary too little.
fn along(direction: Direction, mut pairs: Vec<(f64, f64)>) -> Option<Along> {
    sort_by_number(&mut pairs, |(load_n, _)| *load_n);
    let quarter = pairs.len().div_ceil(4);
    let (light, heavy) = (&pairs[..quarter], &pairs[pairs.len() - quarter..]);
    let middle = |of: &[(f64, f64)], value: fn(&(f64, f64)) -> f64| {
        median(&mut of.iter().map(value).collect::<Vec<_>>())
    };
    let step = middle(heavy, |r| r.0) - middle(light, |r| r.0);
    let slope = (middle(heavy, |r| r.1) - middle(light, |r| r.1)) / step;
    let (loads, readings): (Vec<f64>, Vec<f64>) = pairs.iter().copied().unzip();
    (step > 0.3 * middle(heavy, |r| r.0)).then(|| Along {
        direction,
        slope,
        correlation: rank_correlation(&loads, &readings),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_session::session;

    fn of(rows: &[PlateauRow]) -> Following {
        Following::new(rows, |r| r.load_n, |r| r.force_n)
    }

    #[test]
    fn only_a_majority_astray_is_refused() {
        let mut rows = session(1);
        assert_eq!((of(&rows).judged, of(&rows).astray), (5, 0));
        rows.iter_mut().filter(|r| r.pins.is_empty()).for_each(|r| r.force_n = 7.0);
        assert!(of(&rows).astray == 1 && !of(&rows).is_astray());
        rows.iter_mut().filter(|r| r.pins.len() == 3).for_each(|r| r.force_n = 30.0);
        assert!(of(&rows).astray == 3 && of(&rows).is_astray(), "{:?}", of(&rows));
    }

    #[test]
    fn single_loads_are_judged_across_conditions() {
        let all = session(1);
        let layouts: Vec<Vec<usize>> = conditions(&all).iter().map(|of| of[0].pins.clone()).collect();
        let with = |step: f64| {
            let mut rows = all.clone();
            for row in &mut rows {
                let k = layouts.iter().position(|pins| *pins == row.pins).unwrap_or(0);
                row.load_n = 20.0 * (1.0 + step * k as f64);
                row.force_n = row.load_n + row.direction.sign();
            }
            rows
        };
        let mut rows = with(1.0);
        assert_eq!((of(&rows).judged, of(&rows).astray), (1, 0));
        rows.iter_mut().for_each(|r| r.force_n = 7.0);
        assert_eq!((of(&rows).judged, of(&rows).astray), (1, 1));
        assert_eq!(of(&with(0.15)).judged, 0);
    }

    #[test]
    fn two_revolutions_of_wrap_are_possible() {
        let mut rows = session(1);
        for row in &mut rows {
            row.wrap_angle_deg = 720.0;
            row.force_n = row.load_n * libm::exp(3.0 * row.direction.sign());
        }
        assert_eq!(of(&rows).astray, 0);
        rows.retain(|r| r.direction == Direction::Eccentric);
        assert_eq!(of(&rows).astray, 0);
    }
}
