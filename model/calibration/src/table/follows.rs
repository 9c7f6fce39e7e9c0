//! Whether readings follow the loads, condition by condition: by how much a reading changes for each newton of load.

use std::collections::BTreeMap;
use std::ops::RangeInclusive;

use pinswitch_friction::{Direction, published, sort_by_number};

use super::row::PlateauRow;
use super::substrate_word::substrate_word;
use crate::aliasing::rank_correlation;
use crate::median::median;

/// Newtons of reading per newton of load that friction over the paper's wrap, drags and offsets may leave.
pub(super) const FOLLOWS: RangeInclusive<f64> = 0.2..=5.0;
/// Wrap in radians that is assumed of `plain`, whose wrap is unknown: one turn.
const UNKNOWN_WRAP: f64 = std::f64::consts::TAU;
/// Growth of the bounds' logarithm per radian of wrap beyond the paper's: a friction coefficient that is rarely reached.
const PER_RADIAN: f64 = 0.4;

/// Widening of the bounds beyond which an eccentric course alone does not tell.
const WIDE: f64 = 3.0;
/// Ratio of a condition's heaviest load to its lightest below which it has one load.
const ONE_LOAD: f64 = 1.02;
/// Rank correlation below which readings have nothing to do with loads, whatever the slope.
const UNRELATED: f64 = 0.5;

/// How a table's readings go with its loads.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Following {
    /// Conditions whose loads differ enough to tell.
    pub(super) judged: usize,
    /// Those of them whose readings follow the loads in neither direction.
    pub(super) astray: usize,
    /// Median change of the reading per newton of load over those astray.
    pub(super) slope: f64,
    /// Median over the conditions of the rank correlation of readings and loads.
    pub(super) correlation: f64,
    /// Smallest and largest change that is possible, over the wraps of the table.
    pub(super) bounds: RangeInclusive<f64>,
}

impl Following {
    /// Of `force` over `load`, which need not be the columns of that name.
    pub(super) fn new(
        rows: &[PlateauRow],
        load: impl Fn(&PlateauRow) -> f64,
        force: impl Fn(&PlateauRow) -> f64,
    ) -> Self {
        let course =
            |of: &[&PlateauRow]| Course { directions: directions(of, &load, &force), widening: widening(of) };
        let told: Vec<Course> =
            conditions(rows).iter().map(|of| course(of)).filter(Course::can_tell).collect();
        let told = if told.is_empty() { across(rows, &load, &course) } else { told };
        let widest = told.iter().map(|course| course.widening).fold(1.0, f64::max);
        let astray = told.iter().filter(|course| !course.is_possible());
        let mut slopes: Vec<f64> =
            astray.filter_map(|course| course.directions.first()).map(|d| d.slope).collect();
        let mut correlations: Vec<f64> = told.iter().map(Course::correlation).collect();
        Self {
            judged: told.len(),
            astray: slopes.len(),
            slope: median(&mut slopes),
            correlation: median(&mut correlations),
            bounds: FOLLOWS.start() / widest..=FOLLOWS.end() * widest,
        }
    }

    /// Whether most conditions do not follow: one that does not may be a bad run, which is the fit's to find.
    pub(super) fn is_astray(&self) -> bool {
        2 * self.astray > self.judged
    }
}

/// Rows by condition.
pub(super) fn conditions(rows: &[PlateauRow]) -> Vec<Vec<&PlateauRow>> {
    let mut found: BTreeMap<(&str, &[usize], u64), Vec<&PlateauRow>> = BTreeMap::new();
    for row in rows {
        // The wrap of `plain` has no meaning.
        let wrap = row.substrate.map_or(0, |_| row.wrap_angle_deg.to_bits());
        found.entry((substrate_word(row.substrate), &row.pins, wrap)).or_default().push(row);
    }
    found.into_values().collect()
}

/// The table as a whole, which can tell where every condition has one load only: if those differ by more than the
/// friction of the conditions may.
fn across(
    rows: &[PlateauRow],
    load: &impl Fn(&PlateauRow) -> f64,
    course: &impl Fn(&[&PlateauRow]) -> Course,
) -> Vec<Course> {
    let ratio = |of: &[&PlateauRow]| {
        let loads = of.iter().map(|r| load(r)).filter(|n| *n > 0.0);
        let (least, most) = loads.fold((f64::INFINITY, 0.0), |(a, b): (f64, f64), n| (a.min(n), b.max(n)));
        most / least
    };
    let all: Vec<&PlateauRow> = rows.iter().collect();
    let friction = libm::exp(PER_RADIAN * largest_wrap_rad(&all));
    let one_load = conditions(rows).iter().all(|of| ratio(of) < ONE_LOAD);
    Some(course(&all))
        .filter(|whole| one_load && ratio(&all) > friction && whole.can_tell())
        .into_iter()
        .collect()
}

/// Largest wrap of some rows, in radians.
fn largest_wrap_rad(rows: &[&PlateauRow]) -> f64 {
    let wrap = |r: &&PlateauRow| r.substrate.map_or(UNKNOWN_WRAP, |_| r.wrap_angle_deg.to_radians());
    rows.iter().map(wrap).fold(0.0, f64::max)
}

/// Factor by which a wrap beyond the paper's widens the bounds.
fn widening(rows: &[&PlateauRow]) -> f64 {
    libm::exp(PER_RADIAN * (largest_wrap_rad(rows) - published::wrap_angle_rad()).max(0.0))
}

/// How readings go with loads in one condition.
struct Course {
    directions: Vec<Along>,
    widening: f64,
}

impl Course {
    /// Whether either direction follows. Friction takes from the eccentric slope and adds to the concentric one.
    fn is_possible(&self) -> bool {
        self.directions.iter().any(|along| {
            let (least, most) = match along.direction {
                Direction::Eccentric => (FOLLOWS.start() / self.widening, *FOLLOWS.end()),
                Direction::Concentric => (*FOLLOWS.start(), FOLLOWS.end() * self.widening),
            };
            along.correlation > UNRELATED && (least..=most).contains(&along.slope)
        })
    }

    /// Whether it can tell: around a wide wrap so little is left of an eccentric load that readings need not follow.
    fn can_tell(&self) -> bool {
        let narrow = self.widening < WIDE;
        self.directions.iter().any(|along| narrow || along.direction == Direction::Concentric)
    }

    /// The better of its correlations.
    fn correlation(&self) -> f64 {
        self.directions.iter().map(|d| d.correlation).fold(-1.0, f64::max)
    }
}

/// How readings go with loads in one direction.
struct Along {
    direction: Direction,
    /// Change per newton of load, from the medians of the lightest and the heaviest quarter.
    slope: f64,
    /// Rank correlation.
    correlation: f64,
}

/// `force` along `load` in each direction that can tell.
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

/// Change of the reading per newton of load in one direction; `None` if the loads are too alike to tell.
pub(super) fn slope(direction: Direction, rows: &[&PlateauRow]) -> Option<f64> {
    let of = rows.iter().filter(|r| r.direction == direction);
    Some(along(direction, of.map(|r| (r.load_n, r.force_n)).collect())?.slope)
}

/// `None` if the loads are too alike to tell.
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
    fn one_condition_that_ignores_its_loads_is_the_fits_and_most_are_the_tables() {
        let mut rows = session(1);
        assert_eq!((of(&rows).judged, of(&rows).astray), (5, 0));
        rows.iter_mut().filter(|r| r.pins.is_empty()).for_each(|r| r.force_n = 7.0);
        assert!(of(&rows).astray == 1 && !of(&rows).is_astray());
        rows.iter_mut().filter(|r| r.pins.len() == 3).for_each(|r| r.force_n = 30.0);
        assert!(of(&rows).astray == 3 && of(&rows).is_astray(), "{:?}", of(&rows));
    }

    #[test]
    fn one_load_for_each_condition_tells_over_the_table_unless_friction_may_be_what_differs() {
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
    fn two_turns_of_wrap_are_possible_though_each_direction_alone_looks_wrong() {
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
