//! What tells the readings of one session from those of any other, whatever their file is called and in which order its rows
//! stand.

use std::collections::BTreeMap;

use super::row::PlateauRow;

/// Offset basis and prime of the hash of Fowler, Noll and Vo (FNV-1a, 64 bits).
const BASIS: u64 = 0xcbf2_9ce4_8422_2325;
const PRIME: u64 = 0x0000_0100_0000_01b3;

/// The readings of each session, by its name (empty where the table names none): how many they are, and a sum over their
/// hashes, in hexadecimal digits. No defence against forgery: it tells a table that was seen before.
pub fn readings_by_session(rows: &[PlateauRow]) -> BTreeMap<String, String> {
    let mut sums: BTreeMap<String, (usize, u64)> = BTreeMap::new();
    for row in rows {
        let (count, sum) = sums.entry(row.labels.session.clone()).or_default();
        *count += 1;
        *sum = sum.wrapping_add(hash_of(row));
    }
    sums.into_iter().map(|(session, (count, sum))| (session, format!("{count}-{sum:016x}"))).collect()
}

fn hash_of(row: &PlateauRow) -> u64 {
    let numbers = [
        row.load_n,
        row.speed_pct,
        row.dwell_s,
        row.direction.sign(),
        f64::from(row.repetition),
        row.position_mm,
        row.force_n,
    ];
    let bytes = numbers.iter().flat_map(|number| number.to_bits().to_le_bytes());
    bytes.fold(BASIS, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(PRIME))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_session::session;

    #[test]
    fn readings_are_known_again_in_any_order_and_under_any_name_and_no_others_are() {
        let of = |rows: &[PlateauRow]| readings_by_session(rows).into_values().collect::<Vec<_>>();
        let rows = session(1);
        let mut turned = rows.clone();
        turned.reverse();
        turned.iter_mut().for_each(|r| {
            r.labels.session = "b".to_owned();
            r.series = format!("again-{}", r.series);
        });
        assert_eq!(of(&rows), of(&turned));
        assert_ne!(of(&rows), of(&session(2)));
        assert_ne!(of(&rows), of(&rows[1..]));
        let both = readings_by_session(&[rows, turned].concat());
        assert_eq!(both.keys().map(String::as_str).collect::<Vec<_>>(), ["", "b"]);
    }
}
