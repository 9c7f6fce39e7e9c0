//! Which two columns of a table stand in each other's place: a load among the readings, a clock among the positions.

use std::collections::HashSet;

use pinswitch_friction::published::GRAVITY_M_S2;

use super::follows::Following;
use super::friction_gap::{Friction, friction};
use super::row::PlateauRow;

/// A column of numbers that may stand in another's place.
type Column = (&'static str, fn(&PlateauRow) -> f64);

const LOAD: Column = ("load_N", |r| r.load_n);
const FORCE: Column = ("force_N", |r| r.force_n);
const MASS: Column = ("load_mass_g", |r| r.load_mass_g);
const POSITION: Column = ("position_mm", |r| r.position_mm);
const SPEED: Column = ("speed_pct", |r| r.speed_pct);
const DWELL: Column = ("dwell_s", |r| r.dwell_s);
const TIME: Column = ("time_s", |r| r.time_s);
const ALL: [Column; 7] = [MASS, LOAD, SPEED, DWELL, POSITION, TIME, FORCE];

/// Share of its range by which a load may depart from the weight of its mass and a hook.
const WEIGHS: f64 = 0.01;
/// The same, beyond which it is not that weight.
const WEIGHS_NOT: f64 = 0.05;

/// Rank correlation of readings and loads in a table that an exchange has made sound.
const SOUND: f64 = 0.9;

/// Two columns, and how they were told.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Swapped {
    /// The column that comes first in a header.
    pub(super) first: &'static str,
    /// The other.
    pub(super) second: &'static str,
    /// What one of them holds.
    pub(super) because: &'static str,
}

/// Columns that give themselves away, however well the table fits together otherwise.
pub(super) fn evident(rows: &[PlateauRow]) -> Option<Swapped> {
    if rows_hold_readings_as_loads(rows) {
        let because =
            "load_N changes within the series and force_N does not, though both directions are in them";
        return Some(Swapped { first: LOAD.0, second: FORCE.0, because });
    }
    if departure_from_weight(rows, LOAD.1).is_some_and(|share| share > WEIGHS_NOT) {
        let weight = [SPEED, DWELL, POSITION, TIME, FORCE]
            .into_iter()
            .find(|column| departure_from_weight(rows, column.1).is_some_and(|share| share < WEIGHS));
        if let Some((second, _)) = weight {
            let because = "the second holds what the masses of load_mass_g weigh";
            return Some(Swapped { first: LOAD.0, second, because });
        }
    }
    let clock = [POSITION, SPEED].into_iter().find(|column| is_clock(rows, column.1));
    match clock {
        Some((first, _)) if !is_clock(rows, TIME.1) => Some(Swapped {
            first,
            second: TIME.0,
            because: "the first runs on from series to series, as time does",
        }),
        _ => None,
    }
}

/// Columns whose exchange makes a table plausible that is not.
pub(super) fn repairing(rows: &[PlateauRow]) -> Option<Swapped> {
    for (i, first) in ALL.iter().enumerate() {
        for second in &ALL[i + 1..] {
            let exchanged = |column: Column| match column.0 {
                name if name == first.0 => second.1,
                name if name == second.0 => first.1,
                _ => column.1,
            };
            let names = [first.0, second.0];
            // Loads and readings in each other's place look like directions the wrong way round: `evident` tells them.
            let asked =
                [LOAD, FORCE, MASS].iter().any(|c| names.contains(&c.0)) && names != [LOAD.0, FORCE.0];
            let timed = !names.contains(&TIME.0) || is_clock(rows, exchanged(TIME));
            if asked && timed && is_sound(rows, exchanged(LOAD), exchanged(FORCE), exchanged(MASS)) {
                let because = "each is what the other should be";
                return Some(Swapped { first: first.0, second: second.0, because });
            }
        }
    }
    None
}

/// Whether three columns behave as load, reading and mass.
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

/// Whether in nearly all series with both directions the readings are one and the loads are not.
fn rows_hold_readings_as_loads(rows: &[PlateauRow]) -> bool {
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

/// Largest departure of a column from the weight of the masses and one hook, as a share of its range; `None` where the
/// masses do not vary.
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

/// Whether a column runs on as time does: it changes within the series, and no series begins before another has ended.
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
    fn a_sound_table_has_no_columns_swapped() {
        let rows = session(4);
        assert_eq!(evident(&rows), None);
        assert!(is_clock(&rows, TIME.1) && !is_clock(&rows, POSITION.1));
        assert!(is_sound(&rows, LOAD.1, FORCE.1, MASS.1));
    }

    #[test]
    fn columns_that_give_themselves_away_are_named() {
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
