//! Detection of swapped columns, such as readings in the load column or times in the position
//! column.

use std::collections::HashSet;

use pinswitch_friction::published::GRAVITY_M_S2;

use super::follows::Following;
use super::friction_gap::{Friction, friction};
use super::row::PlateauRow;

/// A numeric column that may be swapped with another one.
type Column = (&'static str, fn(&PlateauRow) -> f64);

const LOAD: Column = ("load_N", |r| r.load_n);
const FORCE: Column = ("force_N", |r| r.force_n);
const MASS: Column = ("load_mass_g", |r| r.load_mass_g);
const POSITION: Column = ("position_mm", |r| r.position_mm);
const SPEED: Column = ("speed_pct", |r| r.speed_pct);
const DWELL: Column = ("dwell_s", |r| r.dwell_s);
const TIME: Column = ("time_s", |r| r.time_s);
const ALL: [Column; 7] = [MASS, LOAD, SPEED, DWELL, POSITION, TIME, FORCE];

/// Largest departure of a load from the weight of its mass and a hook, as a share of the range of
/// weights.
const WEIGHS: f64 = 0.01;
/// Departure, as the same share, above which a column is not that weight.
const WEIGHS_NOT: f64 = 0.05;

/// Rank correlation of readings and loads above which a table with swapped columns counts as sound.
const SOUND: f64 = 0.9;

/// Two swapped columns, and the evidence.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Swapped {
    /// The column that comes first in a header.
    pub(super) first: &'static str,
    /// The other column.
    pub(super) second: &'static str,
    /// Why they count as swapped.
    pub(super) evidence: &'static str,
}

/// Returns columns that are evidently swapped, however consistent the table is otherwise.
pub(super) fn evident(rows: &[PlateauRow]) -> Option<Swapped> {
    if loads_vary_within_series(rows) {
        let evidence = "load_N varies within series that contain both directions, while force_N is constant";
        return Some(Swapped { first: LOAD.0, second: FORCE.0, evidence });
    }
    if departure_from_weight(rows, LOAD.1).is_some_and(|share| share > WEIGHS_NOT) {
        let weight = [SPEED, DWELL, POSITION, TIME, FORCE]
            .into_iter()
            .find(|column| departure_from_weight(rows, column.1).is_some_and(|share| share < WEIGHS));
        if let Some((second, _)) = weight {
            let evidence = "the second contains the weights of load_mass_g";
            return Some(Swapped { first: LOAD.0, second, evidence });
        }
    }
    let clock = [POSITION, SPEED].into_iter().find(|column| is_clock(rows, column.1));
    match clock {
        Some((first, _)) if !is_clock(rows, TIME.1) => Some(Swapped {
            first,
            second: TIME.0,
            evidence: "the first increases from series to series, as time does",
        }),
        _ => None,
    }
}

/// Returns columns whose exchange makes an implausible table plausible.
pub(super) fn repairing(rows: &[PlateauRow]) -> Option<Swapped> {
    for (i, first) in ALL.iter().enumerate() {
        for second in &ALL[i + 1..] {
            let exchanged = |column: Column| match column.0 {
                name if name == first.0 => second.1,
                name if name == second.0 => first.1,
                _ => column.1,
            };
            let names = [first.0, second.0];
            // Swapped loads and readings look like swapped directions: `evident` detects those.
            let is_candidate =
                [LOAD, FORCE, MASS].iter().any(|c| names.contains(&c.0)) && names != [LOAD.0, FORCE.0];
            let timed = !names.contains(&TIME.0) || is_clock(rows, exchanged(TIME));
            if is_candidate && timed && is_sound(rows, exchanged(LOAD), exchanged(FORCE), exchanged(MASS)) {
                let evidence = "the table is plausible with the two exchanged";
                return Some(Swapped { first: first.0, second: second.0, evidence });
            }
        }
    }
    None
}

/// Returns whether three columns behave as load, reading and mass.
fn is_sound(
    rows: &[PlateauRow],
    load: fn(&PlateauRow) -> f64,
    force: fn(&PlateauRow) -> f64,
    mass: fn(&PlateauRow) -> f64,
) -> bool {
    let following = Following::new(rows, load, force);
    let unknown = rows.iter().all(|r| r.load_mass_g == 0.0 && mass(r) == 0.0);
    let weighs = unknown || departure(rows, load, mass).is_some_and(|d| d < WEIGHS);
    weighs
        && following.judged > 0
        && 10 * following.astray <= following.judged
        && following.correlation > SOUND
        && rows.iter().all(|r| load(r) >= 0.0)
        && friction(rows, load, force) == Friction::Measured
}

/// Returns whether, in nearly all series with both directions, the readings are constant and the
/// loads are not.
fn loads_vary_within_series(rows: &[PlateauRow]) -> bool {
    let range = |of: &[PlateauRow], value: fn(&PlateauRow) -> f64| {
        let values = of.iter().map(value);
        values.clone().fold(f64::NEG_INFINITY, f64::max) - values.fold(f64::INFINITY, f64::min)
    };
    let (mut both, mut odd) = (0, 0);
    for series in rows.chunk_by(|a, b| a.series == b.series && a.labels.session == b.labels.session) {
        if range(series, |r| r.direction.sign()) > 0.0 {
            let size = series.iter().map(|r| r.load_n).fold(0.0, f64::max);
            both += 1;
            odd += usize::from(range(series, FORCE.1) < 1e-6 * size && range(series, LOAD.1) > 1e-3 * size);
        }
    }
    both >= 2 && 10 * odd >= 9 * both
}

/// Returns the largest departure of a column from the weight of the masses and one hook, as a share
/// of its range; `None` if the masses do not vary.
fn departure_from_weight(rows: &[PlateauRow], column: fn(&PlateauRow) -> f64) -> Option<f64> {
    departure(rows, column, MASS.1)
}

fn departure(
    rows: &[PlateauRow],
    column: fn(&PlateauRow) -> f64,
    mass: fn(&PlateauRow) -> f64,
) -> Option<f64> {
    let ends = |of: &mut dyn Iterator<Item = f64>| {
        of.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)))
    };
    let weight = |r: &PlateauRow| mass(r) * 1e-3 * GRAVITY_M_S2;
    let known = || rows.iter().filter(|r| mass(r) > 0.0);
    let (light, heavy) = ends(&mut known().map(weight));
    let (least, most) = ends(&mut known().map(|r| column(r) - weight(r)));
    (heavy - light > 1e-3 * heavy).then(|| (most - least) / (heavy - light))
}

/// Returns whether a column increases like time: within each series, and from each series to the
/// next.
fn is_clock(rows: &[PlateauRow], column: fn(&PlateauRow) -> f64) -> bool {
    let mut order: Vec<&PlateauRow> = rows.iter().collect();
    order.sort_by(|a, b| {
        a.labels.session.cmp(&b.labels.session).then_with(|| column(a).total_cmp(&column(b)))
    });
    let runs: Vec<&[&PlateauRow]> =
        order.chunk_by(|a, b| a.labels.session == b.labels.session && a.series == b.series).collect();
    let names: HashSet<(&str, &str)> =
        rows.iter().map(|r| (r.labels.session.as_str(), r.series.as_str())).collect();
    let long: Vec<_> = runs.iter().filter(|run| run.len() > 1).collect();
    let moving = long.iter().filter(|run| run.windows(2).all(|w| column(w[1]) > column(w[0]))).count();
    names.len() > 2 && runs.len() == names.len() && long.len() > 1 && 10 * moving >= 9 * long.len()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_session::session;

    #[test]
    fn sound_tables_have_no_swapped_columns() {
        let rows = session(4);
        assert_eq!(evident(&rows), None);
        assert!(is_clock(&rows, TIME.1) && !is_clock(&rows, POSITION.1));
        assert!(is_sound(&rows, LOAD.1, FORCE.1, MASS.1));
    }

    #[test]
    fn swapped_columns_are_named() {
        let named = |swap: fn(&mut PlateauRow), masses: bool| {
            let mut rows = session(4);
            rows.iter_mut().for_each(|r| {
                swap(r);
                r.load_mass_g *= f64::from(u8::from(masses));
            });
            evident(&rows).or_else(|| repairing(&rows)).map(|s| [s.first, s.second])
        };
        for masses in [true, false] {
            let load_force: fn(&mut PlateauRow) = |r| std::mem::swap(&mut r.load_n, &mut r.force_n);
            assert_eq!(named(load_force, masses), Some(["load_N", "force_N"]), "{masses}");
            let position_force: fn(&mut PlateauRow) = |r| std::mem::swap(&mut r.position_mm, &mut r.force_n);
            assert_eq!(named(position_force, masses), Some(["position_mm", "force_N"]), "{masses}");
            let position_time: fn(&mut PlateauRow) = |r| std::mem::swap(&mut r.position_mm, &mut r.time_s);
            assert_eq!(named(position_time, masses), Some(["position_mm", "time_s"]), "{masses}");
            let load_time: fn(&mut PlateauRow) = |r| std::mem::swap(&mut r.load_n, &mut r.time_s);
            assert_eq!(named(load_time, masses), Some(["load_N", "time_s"]), "{masses}");
        }
    }
}
