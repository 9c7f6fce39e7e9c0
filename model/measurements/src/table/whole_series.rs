//! Consistency of each series: one condition, similar loads, its own readings, and correct
//! directions.

use std::collections::{BTreeMap, HashMap};

use pinswitch_friction::Direction;

use super::row::PlateauRow;
use super::substrate_word::substrate_word;
use super::table_error::TableError;
use crate::median::median;

/// Largest ratio of the loads within a series. A machine that pulls against a spring varies its
/// load by some tenths.
const MOST_SPREAD: f64 = 2.5;
/// Number of different readings that another series cannot repeat by chance. A coarse load cell
/// repeats a few values.
const COPIED: usize = 12;
/// Most series with exchanged directions that are left to the fit, which excludes them.
const LEFT_TO_FIT: usize = 3;
/// Share of the load, and number of standard errors, by which pulled readings must be below
/// released ones before a series counts as exchanged.
const BACKWARDS: (f64, f64) = (0.02, 5.0);
/// Most series that are named in an error.
const NAMED: usize = 8;

/// The rows of one series of one session.
type Series<'a> = ((&'a str, &'a str), Vec<&'a PlateauRow>);

/// Returns the first inconsistency of the series of a table.
pub(super) fn inconsistent_series(rows: &[PlateauRow], file: &str) -> Option<TableError> {
    let mut by_name: BTreeMap<(&str, &str), Vec<&PlateauRow>> = BTreeMap::new();
    for row in rows {
        by_name.entry((&row.labels.session, &row.series)).or_default().push(row);
    }
    let all: Vec<Series<'_>> = by_name.into_iter().collect();
    all.iter()
        .find_map(|(name, of)| mixed(name.1, of, file))
        .or_else(|| copied(&all, file))
        .or_else(|| exchanged(&all, file))
}

/// Refuses a series with several conditions or loads.
fn mixed(series: &str, of: &[&PlateauRow], file: &str) -> Option<TableError> {
    let first = of.first()?;
    let condition = |row: &PlateauRow| {
        let pins: Vec<String> = row.pins.iter().map(usize::to_string).collect();
        format!("{} {}", substrate_word(row.substrate), pins.join(";")).trim_end().to_owned()
    };
    let mixed = |column, one, other| {
        Some(TableError::MixedSeries { file: file.to_owned(), series: series.to_owned(), column, one, other })
    };
    if let Some(other) = of.iter().find(|r| r.substrate != first.substrate || r.pins != first.pins) {
        return mixed("pins", condition(first), condition(other));
    }
    let loads = || of.iter().map(|r| r.load_n);
    let (least, most) = (loads().fold(f64::INFINITY, f64::min), loads().fold(0.0, f64::max));
    if most > MOST_SPREAD * least {
        return mixed("load_N", format!("{least} N"), format!("{most} N"));
    }
    None
}

/// Refuses a series with the readings of another one.
fn copied(all: &[Series<'_>], file: &str) -> Option<TableError> {
    let mut known: HashMap<Vec<(bool, u64)>, &str> = HashMap::new();
    for ((_, series), of) in all {
        let mut readings: Vec<(bool, u64)> =
            of.iter().map(|r| (r.direction.sign() > 0.0, r.force_n.to_bits())).collect();
        readings.sort_unstable();
        let mut different = readings.clone();
        different.dedup();
        if different.len() < COPIED {
            continue;
        }
        if let Some(other) = known.insert(readings, series) {
            return Some(TableError::CopiedSeries {
                file: file.to_owned(),
                series: (*series).to_owned(),
                other: other.to_owned(),
                rows: of.len(),
            });
        }
    }
    None
}

/// Refuses more exchanged series than the fit can exclude.
fn exchanged(all: &[Series<'_>], file: &str) -> Option<TableError> {
    let wrong: Vec<&str> =
        all.iter().filter(|(_, of)| is_backwards(of)).map(|((_, series), _)| *series).collect();
    (wrong.len() > LEFT_TO_FIT).then(|| TableError::ExchangedSeries {
        file: file.to_owned(),
        count: wrong.len(),
        of: all.len(),
        series: format!(
            "{}{}",
            wrong[..wrong.len().min(NAMED)].join(", "),
            if wrong.len() > NAMED { ", ..." } else { "" }
        ),
    })
}

fn is_backwards(of: &[&PlateauRow]) -> bool {
    let side = |direction: Direction| -> Vec<f64> {
        of.iter().filter(|r| r.direction == direction).map(|r| r.force_n - r.load_n).collect()
    };
    let (mut released, mut pulled) = (side(Direction::Eccentric), side(Direction::Concentric));
    if released.len() < 2 || pulled.len() < 2 {
        return false;
    }
    let error2 = |values: &[f64]| {
        let (n, mean) = (values.len() as f64, values.iter().sum::<f64>() / values.len() as f64);
        values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0) / n
    };
    let error_n = (error2(&released) + error2(&pulled)).sqrt();
    let below_n = median(&mut released) - median(&mut pulled);
    let load_n = median(&mut of.iter().map(|r| r.load_n).collect::<Vec<_>>());
    below_n > (BACKWARDS.0 * load_n).max(BACKWARDS.1 * error_n)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_session::session;

    fn error(change: impl Fn(&mut Vec<PlateauRow>)) -> Option<TableError> {
        let mut rows = session(3);
        change(&mut rows);
        inconsistent_series(&rows, "t.csv")
    }

    fn turn(rows: &mut [PlateauRow], series: usize) {
        let mut names: Vec<String> = rows.iter().map(|r| r.series.clone()).collect();
        names.sort();
        names.dedup();
        for row in rows.iter_mut().filter(|r| r.load_n > 20.0 && !r.pins.is_empty()) {
            if names[names.len().saturating_sub(series)..].contains(&row.series) {
                row.direction = match row.direction {
                    Direction::Eccentric => Direction::Concentric,
                    Direction::Concentric => Direction::Eccentric,
                };
            }
        }
    }

    #[test]
    fn mixed_and_copied_series_are_refused() {
        assert_eq!(error(|_| {}), None);
        let loads =
            error(|rows| rows.iter_mut().for_each(|r| r.series = format!("{:?} {:?}", r.substrate, r.pins)));
        assert!(matches!(loads, Some(TableError::MixedSeries { column: "load_N", .. })), "{loads:?}");
        let layouts = error(|rows| rows.iter_mut().for_each(|r| r.series = format!("{}", r.load_n)));
        assert!(matches!(layouts, Some(TableError::MixedSeries { column: "pins", .. })), "{layouts:?}");
        let copied = error(|rows| {
            let first: Vec<PlateauRow> =
                rows.iter().filter(|r| r.series == rows[0].series).cloned().collect();
            rows.extend(first.into_iter().map(|r| PlateauRow { series: "again".into(), ..r }));
        });
        assert!(
            matches!(&copied, Some(TableError::CopiedSeries { series, .. }) if series == "again"),
            "{copied:?}"
        );
    }

    #[test]
    fn many_exchanged_series_are_refused() {
        let backwards = |rows: &[PlateauRow]| {
            let mut names: Vec<&str> = rows.iter().map(|r| r.series.as_str()).collect();
            names.sort_unstable();
            names.dedup();
            let of = |name: &str| rows.iter().filter(|r| r.series == name).collect::<Vec<_>>();
            names.iter().filter(|name| is_backwards(&of(name))).count()
        };
        let mut rows = session(3);
        assert_eq!(backwards(&rows), 0);
        turn(&mut rows, 400);
        let many = backwards(&rows);
        assert!(many > LEFT_TO_FIT, "{many}");
        let error = inconsistent_series(&rows, "t.csv").unwrap();
        assert!(matches!(error, TableError::ExchangedSeries { count, .. } if count == many), "{error}");
    }
}
