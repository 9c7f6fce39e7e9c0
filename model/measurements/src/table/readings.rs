//! Fingerprints of the readings of a session: independent of file name and order of rows, and robust to rounding, to rows left
//! out, and to changes that are small against the noise.
//!
//! A fingerprint keeps some readings with a hash of their settings. The readings of another session at these settings differ
//! by noise of their own. The same readings do not, even if they are rounded or changed by a fraction of the noise.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;

use pinswitch_friction::sort_by_number;

use super::row::PlateauRow;
use super::substrate_word::substrate_word;
use crate::median::median;

/// Offset basis and prime of the FNV-1a hash of 32 bits (Fowler, Noll, Vo).
const BASIS: u32 = 0x811c_9dc5;
const PRIME: u32 = 0x0100_0193;
/// Number of readings kept of a session: those with the smallest hashes, so that any part of the session contains its share
/// of them (bottom-k sketch; Broder 1997).
const SKETCH: usize = 128;
/// Begin of a fingerprint. Earlier versions wrote hashes only, without it.
const MARK: &str = "readings:";
/// Hexadecimal digits of a hash, and of a reading.
const DIGITS: usize = 8;
/// Most digits of a fingerprint of an earlier version.
const EARLIER_DIGITS: usize = 256;
/// Unit of the readings that are kept, in newtons.
const UNIT_N: f64 = 0.001;
/// Probability of readings that agree as well by chance, below which they are the same.
const CHANCE: f64 = 1e-4;
/// Share of equal readings above which they cannot be told from the same readings, whatever their noise.
const EQUAL: f64 = 0.9;
/// Fewest readings at equal settings for this.
const LEAST_EQUAL: usize = 3;

/// Returns the fingerprint of each session by its name (empty where the table names none). It detects a table that was seen
/// before, or a part of it; it does not protect against forgery.
pub fn readings_by_session(rows: &[PlateauRow]) -> BTreeMap<String, String> {
    let written = |session: &Session<'_>| {
        let readings = session.by_setting.chunk_by(|a, b| a.0 == b.0).flat_map(|alike| {
            // Mounts and sweeps may repeat a setting: each of its readings has its own chance to be kept.
            let place = |(rank, (hash, _)): (usize, &(u32, f64))| hashed(*hash, rank.to_string().as_bytes());
            alike.iter().enumerate().map(move |reading| (place(reading), *reading.1))
        });
        let mut readings: Vec<(u32, (u32, f64))> = readings.collect();
        sort_by_number(&mut readings, |(place, _)| f64::from(*place));
        readings.iter().take(SKETCH).fold(MARK.to_owned(), |mut text, (_, (hash, reading_n))| {
            let _ = write!(text, "{hash:08x}{:08x}", thousandths(*reading_n));
            text
        })
    };
    sessions(rows).iter().map(|(name, session)| ((*name).to_owned(), written(session))).collect()
}

/// Returns whether a text can be a fingerprint of [`readings_by_session`], of this or an earlier version.
pub fn is_fingerprint(text: &str) -> bool {
    let are_digits = |text: &str| text.bytes().all(|b| b.is_ascii_digit() || (b'a'..=b'f').contains(&b));
    let (digits, each, most) = match text.strip_prefix(MARK) {
        Some(digits) => (digits, 2 * DIGITS, SKETCH * 2 * DIGITS),
        None => (text, DIGITS, EARLIER_DIGITS),
    };
    !digits.is_empty() && digits.len().is_multiple_of(each) && digits.len() <= most && are_digits(digits)
}

/// Returns the names of the sessions that match one of the fingerprints, at least in part. Every session matches a fingerprint
/// of an earlier version: it does not exclude any.
pub fn matching_sessions(rows: &[PlateauRow], fingerprints: &[String]) -> BTreeSet<String> {
    let all = sessions(rows);
    let is_one = |session: &Session<'_>| {
        fingerprints.iter().any(|text| kept_readings(text).is_none_or(|kept| session.agrees_with(&kept)))
    };
    all.iter().filter(|(_, session)| is_one(session)).map(|(name, _)| (*name).to_owned()).collect()
}

/// Returns the hashes and readings of a fingerprint, in newtons; `None` for one of an earlier version.
fn kept_readings(fingerprint: &str) -> Option<Vec<(u32, f64)>> {
    let digits = fingerprint.strip_prefix(MARK)?;
    let number = |at: usize| u32::from_str_radix(digits.get(at..at + DIGITS)?, 16).ok();
    let places = (0..digits.len() / (2 * DIGITS)).map(|i| 2 * DIGITS * i);
    Some(
        places
            .filter_map(|at| Some((number(at)?, UNIT_N * f64::from(number(at + DIGITS)?.cast_signed()))))
            .collect(),
    )
}

/// The readings of one session.
struct Session<'a> {
    /// Rows in the order of time.
    rows: Vec<&'a PlateauRow>,
    /// Readings in newtons with the hash of their setting and repetition, in its order and then in that of time.
    by_setting: Vec<(u32, f64)>,
}

fn sessions(rows: &[PlateauRow]) -> Vec<(&str, Session<'_>)> {
    let mut found: BTreeMap<&str, Vec<&PlateauRow>> = BTreeMap::new();
    for row in rows {
        found.entry(row.labels.session.as_str()).or_default().push(row);
    }
    found.into_iter().map(|(name, rows)| (name, Session::new(rows))).collect()
}

impl<'a> Session<'a> {
    fn new(mut rows: Vec<&'a PlateauRow>) -> Self {
        sort_by_number(&mut rows, |row| f64::from(row.repetition));
        sort_by_number(&mut rows, |row| row.time_s);
        let mut by_setting: Vec<(u32, f64)> = rows.iter().map(|row| (hash_of(row), row.force_n)).collect();
        sort_by_number(&mut by_setting, |(hash, _)| f64::from(*hash));
        Self { rows, by_setting }
    }

    /// Returns the readings with this hash.
    fn readings_at(&self, hash: u32) -> &[(u32, f64)] {
        let first = self.by_setting.partition_point(|(known, _)| *known < hash);
        let alike = &self.by_setting[first..];
        &alike[..alike.partition_point(|(known, _)| *known == hash)]
    }

    /// Returns whether kept readings agree with those of the session better than readings with noise of their own.
    ///
    /// Of `m` readings `x` at the setting of a kept reading `v`, with noise of standard deviation `s`, the nearest one is
    /// within `g` of it by chance with probability `1 - (1 - erf(g/(2 s)))^m`. Fisher's method joins these probabilities.
    fn agrees_with(&self, kept: &[(u32, f64)]) -> bool {
        let step_n = self.step_n();
        let gaps_n: Vec<(f64, usize)> = kept
            .iter()
            .filter_map(|(hash, reading_n)| {
                let own = self.readings_at(*hash);
                let gap_n = own.iter().map(|(_, own)| (own - reading_n).abs()).reduce(f64::min)?;
                Some((gap_n, own.len()))
            })
            .collect();
        let equal = gaps_n.iter().filter(|(gap_n, _)| *gap_n <= step_n / 2.0).count();
        if gaps_n.len() >= LEAST_EQUAL && equal as f64 >= EQUAL * gaps_n.len() as f64 {
            return true;
        }
        let Some(noise_n) = self.noise_n() else { return false };
        let log_chance = |(gap_n, count): &(f64, usize)| {
            let within = libm::erf((gap_n + step_n / 2.0) / (2.0 * noise_n));
            let count = f64::from(u32::try_from(*count).unwrap_or(u32::MAX));
            // 1 - (1 - p)^m, also for a small p.
            libm::log(-libm::expm1(count * libm::log1p(-within)))
        };
        fisher(&gaps_n.iter().map(log_chance).collect::<Vec<f64>>()) < CHANCE
    }

    /// Returns the smallest difference of two readings in newtons, at least that of a fingerprint.
    fn step_n(&self) -> f64 {
        let mut sorted: Vec<i32> = self.rows.iter().map(|row| thousandths(row.force_n)).collect();
        sort_by_number(&mut sorted, |reading| f64::from(*reading));
        let steps = sorted.windows(2).map(|pair| pair[1].saturating_sub(pair[0])).filter(|step| *step > 0);
        UNIT_N * f64::from(steps.min().unwrap_or(1))
    }

    /// Returns the standard deviation of the noise in newtons; `None` without repeated readings, and where most are equal.
    ///
    /// It is the least of several estimates, from the median difference of consecutive readings at one setting. Structure that
    /// every session of the rig has is no noise: a slow change does not enter these differences, an alternation not those of
    /// every second reading, and a pattern over the stroke not those of two loads, added to both or in proportion to them.
    fn noise_n(&self) -> Option<f64> {
        let mut rows = self.rows.clone();
        sort_by_number(&mut rows, |row| f64::from(hundredths(row.load_n)));
        sort_by_number(&mut rows, |row| f64::from(condition_hash(row)));
        let settings: Vec<&[&PlateauRow]> = rows
            .chunk_by(|a, b| {
                condition_hash(a) == condition_hash(b) && hundredths(a.load_n) == hundredths(b.load_n)
            })
            .collect();
        let single: Vec<Vec<f64>> =
            settings.iter().map(|rows| rows.iter().map(|row| row.force_n).collect()).collect();
        let of_two = |factor: &dyn Fn(f64, f64) -> f64| -> Vec<Vec<f64>> {
            let pairs =
                settings.windows(2).filter(|pair| condition_hash(pair[0][0]) == condition_hash(pair[1][0]));
            let difference = |pair: &[&[&PlateauRow]]| {
                let by = factor(pair[0][0].load_n, pair[1][0].load_n);
                // With the noise of one reading.
                let scale = (1.0 + by * by).sqrt();
                pair[1].iter().zip(pair[0]).map(|(b, a)| (b.force_n - by * a.force_n) / scale).collect()
            };
            pairs.map(difference).collect()
        };
        let added = of_two(&|_, _| 1.0);
        let proportional = of_two(&|lower, upper| if lower > 0.0 { upper / lower } else { 1.0 });
        let estimates = [single, added, proportional];
        let noise = estimates.iter().flat_map(|courses| [1, 2].map(|lag| noise_of(courses, lag))).flatten();
        noise.reduce(f64::min).filter(|noise_n| *noise_n > 0.0)
    }
}

/// Returns the standard deviation of noise from the differences of readings with a lag, in each of several courses.
fn noise_of(courses: &[Vec<f64>], lag: usize) -> Option<f64> {
    let apart = courses.iter().flat_map(|x| x.iter().zip(x.iter().skip(lag)));
    let mut apart_n: Vec<f64> = apart.map(|(a, b)| (a - b).abs()).collect();
    // The median of |x| is 0.6745 standard deviations of x; a difference has the variance of two readings.
    (!apart_n.is_empty()).then(|| median(&mut apart_n) / 0.6745 / 2f64.sqrt())
}

/// Returns the probability of logarithms of probabilities that are jointly as small by chance: their sum times -2 has the
/// chi-square distribution with two degrees of freedom for each (Fisher 1925).
fn fisher(logs: &[f64]) -> f64 {
    let half: f64 = -logs.iter().sum::<f64>();
    let mut term = libm::exp(-half);
    let mut sum = 0.0;
    for k in 1..=logs.len() {
        sum += term;
        term *= half / k as f64;
    }
    if logs.is_empty() { 1.0 } else { sum }
}

/// Returns a hash of the condition and the direction of a row.
fn condition_hash(row: &PlateauRow) -> u32 {
    let text = format!("{}{:?}{}", substrate_word(row.substrate), row.pins, row.direction.as_str());
    hashed(BASIS, text.as_bytes())
}

fn hash_of(row: &PlateauRow) -> u32 {
    hashed(condition_hash(row), format!(" {} {}", hundredths(row.load_n), row.repetition).as_bytes())
}

fn hashed(basis: u32, bytes: &[u8]) -> u32 {
    bytes.iter().fold(basis, |hash, byte| (hash ^ u32::from(*byte)).wrapping_mul(PRIME))
}

/// Rounds a load to hundredths of a newton, which are one setting.
fn hundredths(load_n: f64) -> i32 {
    thousandths(load_n / 10.0)
}

/// Returns a number in the unit of fingerprints.
#[expect(clippy::cast_possible_truncation, reason = "tables bound their numbers far below")]
fn thousandths(value: f64) -> i32 {
    (value / UNIT_N).round() as i32
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::*;
    use crate::test_session::session;

    fn is_recognised(rows: &[PlateauRow], of: &[PlateauRow]) -> bool {
        let fingerprints: Vec<String> = readings_by_session(of).into_values().collect();
        assert!(fingerprints.iter().all(|text| is_fingerprint(text)), "{fingerprints:?}");
        !matching_sessions(rows, &fingerprints).is_empty()
    }

    fn changed(rows: &[PlateauRow], change: impl FnMut(&mut PlateauRow)) -> Vec<PlateauRow> {
        let mut rows = rows.to_vec();
        rows.iter_mut().for_each(change);
        rows
    }

    fn rounded(rows: &[PlateauRow], step_n: f64) -> Vec<PlateauRow> {
        changed(rows, |row| row.force_n = (row.force_n / step_n).round() * step_n)
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
        for seed in 2..40 {
            assert!(!is_recognised(&session(seed), &rows), "{seed}");
        }
        let both = readings_by_session(&[rows.clone(), reordered].concat());
        assert_eq!(both.keys().map(String::as_str).collect::<Vec<_>>(), ["", "b"]);
        assert!(!is_fingerprint("x") && !is_fingerprint("") && !is_fingerprint("1234567"));
        assert!(!is_fingerprint("readings:") && !is_fingerprint("readings:12345678"));
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
        for nth in [2, 3, 5] {
            assert!(is_recognised(&part(&|i, _| i % nth == 0), &rows), "every {nth}th row");
        }
        assert!(is_recognised(&rounded(&rows, 0.01), &rows));
    }

    /// Later mounts at the settings of earlier ones are recognised, too.
    #[test]
    fn parts_with_repeated_settings_are_recognised() {
        let mounts = |seeds: std::ops::Range<u64>| -> Vec<PlateauRow> {
            let of = |seed| changed(&session(seed), |row| row.time_s += 1e5 * seed as f64);
            seeds.flat_map(of).collect()
        };
        let rows = mounts(1..4);
        for part in [mounts(1..2), mounts(2..4), rows[rows.len() / 2..].to_vec()] {
            assert!(is_recognised(&part, &rows));
        }
        assert!(!is_recognised(&mounts(4..7), &rows));
    }

    /// The noise of these sessions is 0.05 N.
    #[test]
    fn readings_changed_by_less_than_their_noise_are_recognised() {
        let rows = session(1);
        let mut random = ChaCha8Rng::seed_from_u64(7);
        for by_n in [0.002, 0.01, 0.03] {
            let near = changed(&rows, |row| row.force_n += random.random_range(-by_n..by_n));
            assert!(is_recognised(&near, &rows), "{by_n}");
            let some: Vec<PlateauRow> = near.into_iter().step_by(2).collect();
            assert!(is_recognised(&some, &rows), "half of them by {by_n}");
        }
    }

    /// A coarse cell repeats readings by chance, an exact one does not; structure is no noise.
    #[test]
    fn coarse_readings_and_structure_are_no_copies() {
        let first = session(1);
        for step_n in [0.02, 0.05, 0.1] {
            assert!(is_recognised(&rounded(&first, step_n), &rounded(&first, step_n)), "{step_n}");
            for seed in 2..12 {
                let other = rounded(&session(seed), step_n);
                assert!(!is_recognised(&other, &rounded(&first, step_n)), "{step_n} {seed}");
            }
        }
        let bump = |row: &PlateauRow| libm::exp(-((row.position_mm / 152.4 - 0.5) / 0.1).powi(2));
        let structures: [&dyn Fn(&PlateauRow) -> f64; 4] = [
            &|row| if row.repetition % 2 == 0 { 0.5 } else { -0.5 },
            &|row| 0.5 * bump(row),
            &|row| 0.02 * row.load_n * bump(row),
            &|row| 0.3 * libm::sin(0.15 * row.position_mm),
        ];
        for (i, structure) in structures.iter().enumerate() {
            let with = |seed| changed(&session(seed), |row| row.force_n += structure(row));
            for seed in 2..12 {
                assert!(!is_recognised(&with(seed), &with(1)), "structure {i}, {seed}");
            }
        }
    }

    /// Without repetitions the noise is unknown: equal readings are the same.
    #[test]
    fn single_readings_are_recognised_by_equality() {
        let single = |seed| -> Vec<PlateauRow> {
            let firsts = session(seed).into_iter().filter(|row| row.repetition == 1);
            let mut known = BTreeSet::new();
            firsts.filter(|row| known.insert(hash_of(row))).collect()
        };
        assert!(is_recognised(&single(1), &single(1)) && !is_recognised(&single(2), &single(1)));
    }

    #[test]
    fn every_session_matches_a_fingerprint_of_an_earlier_version() {
        let earlier = "0123abcd89abcdef";
        assert!(is_fingerprint(earlier));
        assert_eq!(matching_sessions(&session(1), &[earlier.to_owned()]).len(), 1);
    }

    /// Sum of two exponentials: (1 + x) exp(-x).
    #[test]
    fn probabilities_are_joined() {
        let p = fisher(&[libm::log(0.1), libm::log(0.2)]);
        assert!((p - 0.02 * (1.0 - libm::log(0.02))).abs() < 1e-12, "{p}");
        assert!((fisher(&[]) - 1.0).abs() < 1e-12);
    }
}
