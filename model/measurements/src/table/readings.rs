//! Fingerprints of the readings of a session: independent of file name and order of rows, and
//! robust to rounding and to rows left out.

use std::collections::{BTreeMap, BTreeSet};

use super::row::PlateauRow;
use super::substrate_word::substrate_word;

/// Offset basis and prime of the FNV-1a hash of 32 bits (Fowler, Noll, Vo).
const BASIS: u32 = 0x811c_9dc5;
const PRIME: u32 = 0x0100_0193;
/// Number of hashes kept of a session: the smallest, so that any part of the session contains its
/// share of them (bottom-k sketch; Broder 1997).
const SKETCH: usize = 32;
/// Hexadecimal digits of a hash.
const DIGITS: usize = 8;
/// Share of common hashes above which readings belong to the session or a part of it. Sessions at
/// the same settings share some by chance, where two consecutive readings agree to 0.01 N.
const SAME: f64 = 0.2;

/// Returns the fingerprint of each session by its name (empty where the table names none), in
/// hexadecimal digits. It detects a table that was seen before, or a part of it; it does not
/// protect against forgery.
pub fn readings_by_session(rows: &[PlateauRow]) -> BTreeMap<String, String> {
    let written =
        |hashes: BTreeSet<u32>| hashes.iter().take(SKETCH).map(|hash| format!("{hash:08x}")).collect();
    hashes_by_session(rows).into_iter().map(|(session, hashes)| (session, written(hashes))).collect()
}

/// Returns whether a text can be a fingerprint written by [`readings_by_session`].
pub fn is_fingerprint(text: &str) -> bool {
    !text.is_empty()
        && text.len().is_multiple_of(DIGITS)
        && text.len() <= SKETCH * DIGITS
        && text.bytes().all(|b| b.is_ascii_digit() || (b'a'..=b'f').contains(&b))
}

/// Returns the names of the sessions that match one of the fingerprints, at least in part.
pub fn matching_sessions(rows: &[PlateauRow], fingerprints: &[String]) -> BTreeSet<String> {
    let is_one = |hashes: &BTreeSet<u32>| {
        fingerprints.iter().any(|fingerprint| {
            let of: Vec<u32> = (0..fingerprint.len() / DIGITS)
                .filter_map(|i| u32::from_str_radix(fingerprint.get(DIGITS * i..DIGITS * (i + 1))?, 16).ok())
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

/// Returns, by session, hashes of pairs of readings that are consecutive by load and time on one
/// condition and in one direction.
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

/// Rounds to hundredths, since tables are often rounded.
#[expect(clippy::cast_possible_truncation, reason = "tables bound their numbers far below")]
fn hundredths(value: f64) -> i64 {
    (100.0 * value).round() as i64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_session::session;

    fn is_recognised(rows: &[PlateauRow], of: &[PlateauRow]) -> bool {
        let fingerprints: Vec<String> = readings_by_session(of).into_values().collect();
        assert!(fingerprints.iter().all(|text| is_fingerprint(text)), "{fingerprints:?}");
        !matching_sessions(rows, &fingerprints).is_empty()
    }

    #[test]
    fn only_known_readings_are_recognised() {
        let rows = session(1);
        let mut reordered = rows.clone();
        reordered.reverse();
        reordered.iter_mut().for_each(|r| {
            r.labels.session = "b".to_owned();
            r.series = format!("again-{}", r.series);
            r.time_s += 86_400.0;
        });
        assert!(is_recognised(&reordered, &rows) && is_recognised(&rows, &reordered));
        for seed in 2..12 {
            assert!(!is_recognised(&session(seed), &rows), "{seed}");
        }
        let both = readings_by_session(&[rows.clone(), reordered].concat());
        assert_eq!(both.keys().map(String::as_str).collect::<Vec<_>>(), ["", "b"]);
        assert!(!is_fingerprint("x") && !is_fingerprint("") && !is_fingerprint("1234567"));
    }

    #[test]
    fn parts_and_rounded_readings_are_recognised() {
        let rows = session(1);
        let part = |keep: &dyn Fn(usize, &PlateauRow) -> bool| -> Vec<PlateauRow> {
            rows.iter().enumerate().filter(|(i, r)| keep(*i, r)).map(|(_, r)| r.clone()).collect()
        };
        assert!(is_recognised(&rows[1..], &rows) && is_recognised(&rows[..rows.len() / 2], &rows));
        assert!(is_recognised(&part(&|_, r| r.repetition > 1), &rows));
        assert!(is_recognised(&part(&|i, _| i % 40 > 10), &rows));
        let mut rounded = rows.clone();
        rounded.iter_mut().for_each(|r| r.force_n = (100.0 * r.force_n).round() / 100.0);
        assert!(is_recognised(&rounded, &rows));
    }
}
