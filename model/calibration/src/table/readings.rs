//! What tells the readings of one session from those of any other, whatever their file is called, in which order its rows
//! stand, and how many of them were left out or rounded.

use std::collections::{BTreeMap, BTreeSet};

use super::row::PlateauRow;
use super::substrate_word::substrate_word;

/// Offset basis and prime of the hash of Fowler, Noll and Vo (FNV-1a, 32 bits).
const BASIS: u32 = 0x811c_9dc5;
const PRIME: u32 = 0x0100_0193;
/// Hashes that are kept of a session: the smallest, so that any part of the session has its share of them (a bottom-k sketch;
/// Broder 1997).
const KEPT: usize = 32;
/// Digits of a hash in writing.
const DIGITS: usize = 8;
/// Share of the hashes from which readings are those of the session, or a part of them. Readings of another session at the same
/// settings share some by chance: two that follow each other, both to a hundredth of a newton.
const SAME: f64 = 0.2;

/// The readings of each session, by its name (empty where the table names none), in hexadecimal digits. No defence against
/// forgery: it tells a table that was seen before, or a part of it.
pub fn readings_by_session(rows: &[PlateauRow]) -> BTreeMap<String, String> {
    let written =
        |hashes: BTreeSet<u32>| hashes.iter().take(KEPT).map(|hash| format!("{hash:08x}")).collect();
    hashes_by_session(rows).into_iter().map(|(session, hashes)| (session, written(hashes))).collect()
}

/// Whether this can be what [`readings_by_session`] writes of a session.
pub(crate) fn tells_readings(text: &str) -> bool {
    !text.is_empty()
        && text.len().is_multiple_of(DIGITS)
        && text.len() <= KEPT * DIGITS
        && text.bytes().all(|b| b.is_ascii_digit() || (b'a'..=b'f').contains(&b))
}

/// Names of the sessions whose readings, or a part of them, are among those told.
pub(crate) fn sessions_told(rows: &[PlateauRow], told: &[String]) -> BTreeSet<String> {
    let is_one = |hashes: &BTreeSet<u32>| {
        told.iter().any(|told| {
            let of: Vec<u32> = (0..told.len() / DIGITS)
                .filter_map(|i| u32::from_str_radix(told.get(DIGITS * i..DIGITS * (i + 1))?, 16).ok())
                .collect();
            let known = of.iter().filter(|hash| hashes.contains(hash)).count();
            known > 0 && known as f64 >= SAME * of.len() as f64
        })
    };
    hashes_by_session(rows)
        .into_iter()
        .filter(|(_, hashes)| is_one(hashes))
        .map(|(session, _)| session)
        .collect()
}

/// Hashes of readings that follow each other on one condition, in one direction, by load and time.
fn hashes_by_session(rows: &[PlateauRow]) -> BTreeMap<String, BTreeSet<u32>> {
    let mut order: Vec<&PlateauRow> = rows.iter().collect();
    let key = |row: &PlateauRow| (hundredths(row.load_n), hundredths(row.time_s), row.repetition);
    let course = |row: &PlateauRow| (substrate_word(row.substrate), row.direction.sign() > 0.0);
    order.sort_by(|a, b| {
        let session = a.labels.session.cmp(&b.labels.session);
        session.then(course(a).cmp(&course(b))).then(a.pins.cmp(&b.pins)).then(key(a).cmp(&key(b)))
    });
    let mut found: BTreeMap<String, BTreeSet<u32>> = BTreeMap::new();
    for row in rows {
        found.entry(row.labels.session.clone()).or_default();
    }
    for pair in order.windows(2) {
        let [a, b] = [pair[0], pair[1]];
        if a.labels.session == b.labels.session && course(a) == course(b) && a.pins == b.pins {
            found.entry(a.labels.session.clone()).or_default().insert(hash_of(a, b));
        }
    }
    found
}

fn hash_of(a: &PlateauRow, b: &PlateauRow) -> u32 {
    let numbers = [a.load_n, a.force_n, b.force_n].map(hundredths);
    let course = format!("{}{:?}{}", substrate_word(a.substrate), a.pins, a.direction.as_str());
    let bytes = course.into_bytes().into_iter().chain(numbers.into_iter().flat_map(i64::to_le_bytes));
    bytes.fold(BASIS, |hash, byte| (hash ^ u32::from(byte)).wrapping_mul(PRIME))
}

/// As tables are often rounded.
#[expect(clippy::cast_possible_truncation, reason = "tables bound their numbers far below")]
fn hundredths(value: f64) -> i64 {
    (100.0 * value).round() as i64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_session::session;

    fn is_told(rows: &[PlateauRow], of: &[PlateauRow]) -> bool {
        let told: Vec<String> = readings_by_session(of).into_values().collect();
        assert!(told.iter().all(|told| tells_readings(told)), "{told:?}");
        !sessions_told(rows, &told).is_empty()
    }

    #[test]
    fn readings_are_known_again_in_any_order_and_under_any_name_and_no_others_are() {
        let rows = session(1);
        let mut turned = rows.clone();
        turned.reverse();
        turned.iter_mut().for_each(|r| {
            r.labels.session = "b".to_owned();
            r.series = format!("again-{}", r.series);
            r.time_s += 86_400.0;
        });
        assert!(is_told(&turned, &rows) && is_told(&rows, &turned));
        for seed in 2..12 {
            assert!(!is_told(&session(seed), &rows), "{seed}");
        }
        let both = readings_by_session(&[rows.clone(), turned].concat());
        assert_eq!(both.keys().map(String::as_str).collect::<Vec<_>>(), ["", "b"]);
        assert!(!tells_readings("x") && !tells_readings("") && !tells_readings("1234567"));
    }

    #[test]
    fn parts_and_rounded_readings_are_known_again() {
        let rows = session(1);
        let part = |keep: &dyn Fn(usize, &PlateauRow) -> bool| -> Vec<PlateauRow> {
            rows.iter().enumerate().filter(|(i, r)| keep(*i, r)).map(|(_, r)| r.clone()).collect()
        };
        assert!(is_told(&rows[1..], &rows) && is_told(&rows[..rows.len() / 2], &rows));
        assert!(is_told(&part(&|_, r| r.repetition > 1), &rows));
        assert!(is_told(&part(&|i, _| i % 40 > 10), &rows));
        let mut rounded = rows.clone();
        rounded.iter_mut().for_each(|r| r.force_n = (100.0 * r.force_n).round() / 100.0);
        assert!(is_told(&rounded, &rows));
    }
}
