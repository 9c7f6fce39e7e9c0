//! Clocks of loggers: raw stamps to seconds of a log, and logs to the time of the session.

use super::finding::Finding;
use crate::median::median;

/// Seconds of one count for each unit of time that loggers write; the last is the day of a
/// spreadsheet.
const UNITS_S: [f64; 5] = [1.0, 1e-3, 1e-6, 1e-9, 86_400.0];
/// Sampling periods in seconds that a log may have: 2 Hz to 20 kHz.
const PERIODS_S: std::ops::RangeInclusive<f64> = 5e-5..=0.5;
/// Longest sampling period in seconds that a unit is chosen for when its own name is refuted: 7 Hz.
const LIKELY_PERIOD_S: f64 = 0.15;
/// Sampling period times the declared rate, if they agree.
const AGREES: std::ops::RangeInclusive<f64> = 0.5..=2.0;
/// Counts at which hardware counters restart.
const COUNTS: [f64; 4] = [65_536.0, 16_777_216.0, 2_147_483_648.0, 4_294_967_296.0];
/// Seconds at which clock times restart: an hour, half a day, a day.
const CLOCKS_S: [f64; 3] = [3_600.0, 43_200.0, 86_400.0];
/// Samples that must follow a step back in time: fewer are bad stamps, not a restart of the clock.
const AFTER_RESTART: usize = 5;
/// Most consecutive bad stamps that are skipped.
const MOST_BAD: usize = 3;
/// Most sampling periods between the samples before and after a roll-over.
const LOST_AT_RESTART: f64 = 5.0;
/// Share of repeated stamps above which the clock is coarser than the sampling.
const COARSE_SHARE: f64 = 0.3;
/// Stamps in seconds up to which a clock may have restarted with a log.
const NEAR_ZERO_S: f64 = 10.0;
/// Stamps in seconds above which a clock counts from an epoch, and does not restart with a log.
const EPOCH_S: f64 = 1e6;
/// Longest pause in seconds between two logs of a session: four weeks.
const LONGEST_PAUSE_S: f64 = 28.0 * 86_400.0;

/// Times of one log.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct LogTime {
    /// Seconds since the first usable sample, strictly ascending.
    pub(super) time_s: Vec<f64>,
    /// Index of the stamp of each time.
    pub(super) samples: Vec<usize>,
    /// Stamp of the first usable sample in seconds of the logger's clock.
    pub(super) start_s: f64,
    /// Number of stamps that are not times, or that step back alone.
    pub(super) unusable: usize,
    /// Properties of the clock that a person should know.
    pub(super) findings: Vec<Finding>,
    /// Sampling period in seconds, if neither a log nor the declared rate can have it.
    pub(super) impossible_period_s: Option<f64>,
}

/// Converts the stamps of a log to times.
///
/// `unit_s` is the length of a count as the column's name states it, and `rate_hz` the declared
/// sampling rate. A unit that the rate or the sampling period refutes is replaced, with a finding.
/// A restart at a power of two of counts, an hour, half a day or a day is a roll-over; every other
/// step back that lasts is a reset. Repeated stamps of a coarse clock are spread evenly.
pub(super) fn log_time(stamps: &[f64], unit_s: f64, rate_hz: Option<f64>) -> LogTime {
    let mut out = LogTime::default();
    let usable: Vec<usize> = (0..stamps.len()).filter(|i| stamps[*i].is_finite()).collect();
    let steps: Vec<f64> = usable.windows(2).map(|w| stamps[w[1]] - stamps[w[0]]).collect();
    let mut positive: Vec<f64> = steps.iter().copied().filter(|d| *d > 0.0).collect();
    let repeated = steps.iter().filter(|d| **d == 0.0).count();
    let is_coarse = repeated as f64 > COARSE_SHARE * steps.len() as f64;
    let share = positive.len() as f64 / (positive.len() + if is_coarse { repeated } else { 0 }).max(1) as f64;
    let period = median(&mut positive) * share;
    let actual_s = unit(period, unit_s, rate_hz);
    let is_declared = |period_s: f64| rate_hz.is_some_and(|rate| AGREES.contains(&(period_s * rate)));
    out.impossible_period_s =
        Some(period * actual_s).filter(|p| *p > 0.0 && !PERIODS_S.contains(p) && !is_declared(*p));
    if actual_s != unit_s {
        out.findings.push(Finding::TimeUnit { declared_s: unit_s, measured_s: actual_s });
    }
    if is_coarse {
        out.findings.push(Finding::CoarseClock { step_s: period / share * actual_s });
    }
    let times: Vec<f64> = usable.iter().map(|i| stamps[*i] * actual_s).collect();
    let period_s = period * actual_s;
    let mut offset_s = 0.0;
    for i in 0..times.len() {
        let (Some(last), Some(before)) = (out.time_s.last().copied(), out.samples.last()) else {
            out.start_s = times[i];
            out.time_s.push(times[i]);
            out.samples.push(i);
            continue;
        };
        let previous = times[*before];
        let later = &times[i + 1..times.len().min(i + 1 + MOST_BAD)];
        if times[i] > previous {
            if later.iter().any(|t| *t > previous && *t < times[i]) {
                continue; // A stamp that jumps ahead alone.
            }
        } else if times[i] == previous && is_coarse {
            // Spread below.
        } else if times[i] == previous || later.iter().any(|t| *t > previous) || !is_restart(&times[i..]) {
            continue;
        } else {
            let step_s = previous - times[i];
            let time_s = last - out.time_s[0];
            match roll_over(previous, times[i], period_s, actual_s) {
                Some(modulus_s) => {
                    offset_s += modulus_s;
                    out.findings.push(Finding::ClockRollOver { time_s, modulus_s });
                }
                None => {
                    offset_s += step_s + period_s;
                    out.findings.push(Finding::ClockReset { time_s });
                }
            }
        }
        out.time_s.push(times[i] + offset_s);
        out.samples.push(i);
    }
    out.unusable = stamps.len() - out.samples.len();
    out.samples.iter_mut().for_each(|i| *i = usable[*i]);
    if is_coarse {
        spread(&mut out.time_s, period / share * actual_s);
    }
    let start_s = out.time_s.first().copied().unwrap_or(0.0);
    out.time_s.iter_mut().for_each(|t| *t -= start_s);
    out
}

/// Whether the stamps ascend for long enough after a step back to be a restart of the clock.
fn is_restart(times: &[f64]) -> bool {
    times.len() >= AFTER_RESTART && times[..AFTER_RESTART].windows(2).all(|w| w[1] >= w[0])
}

/// Returns the length of a count in seconds: `unit_s`, unless the sampling period refutes it.
fn unit(period: f64, unit_s: f64, rate_hz: Option<f64>) -> f64 {
    let agrees = |unit_s: f64| rate_hz.is_some_and(|rate| AGREES.contains(&(period * unit_s * rate)));
    if period <= 0.0 || agrees(unit_s) {
        return unit_s;
    }
    if let Some(other) = UNITS_S.into_iter().find(|u| agrees(*u)) {
        return other;
    }
    if PERIODS_S.contains(&(period * unit_s)) {
        return unit_s;
    }
    UNITS_S
        .into_iter()
        .find(|u| (*PERIODS_S.start()..=LIKELY_PERIOD_S).contains(&(period * u)))
        .unwrap_or(unit_s)
}

/// Returns the range in seconds of a counter that steps from `before_s` to `after_s`, or `None` for a
/// reset.
fn roll_over(before_s: f64, after_s: f64, period_s: f64, unit_s: f64) -> Option<f64> {
    let slack_s = LOST_AT_RESTART * period_s;
    // A counter restarts at zero, or at the lowest negative number.
    if after_s > slack_s {
        return None;
    }
    let counters = UNITS_S[..3].iter().chain([&unit_s]).flat_map(|unit| COUNTS.map(|count| count * unit));
    let range = before_s - after_s;
    counters
        .chain(CLOCKS_S)
        .filter(|modulus_s| (0.0..=slack_s).contains(&(modulus_s - range)))
        .min_by(f64::total_cmp)
}

/// Spreads equal times evenly up to the next one; the last group gets `step_s`.
fn spread(time_s: &mut [f64], step_s: f64) {
    let mut from = 0;
    while from < time_s.len() {
        let start_s = time_s[from];
        let to = from + time_s[from..].iter().take_while(|t| **t == start_s).count();
        // Lost samples leave a longer step, which the group does not fill.
        let length_s = time_s.get(to).map_or(step_s, |next| (next - start_s).min(step_s));
        let count = (to - from) as f64;
        for (i, t) in time_s[from..to].iter_mut().enumerate() {
            *t = start_s + length_s * i as f64 / count;
        }
        from = to;
    }
}

/// A log whose clock overlaps that of an earlier log.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Overlap {
    /// Index of the earlier log.
    pub(super) with: usize,
}

/// Time of the session, to which the logs are added in the order of the run.
///
/// A clock that runs on from log to log is used unchanged. A clock that restarts with a log
/// continues at the end of the previous log.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct SessionClock {
    /// Seconds of the session minus those of the logger's clock.
    base_s: f64,
    /// First and last stamp, in seconds, of the logs since the clock restarted, with their index.
    spans: Vec<(f64, f64, usize)>,
    /// Number of logs.
    logs: usize,
    /// Latest time of the session in seconds.
    end_s: f64,
}

impl SessionClock {
    /// Adds a log of `length_s` seconds that starts at the stamp `start_s`. Returns its start in
    /// seconds of the session.
    ///
    /// # Errors
    /// [`Overlap`] if an earlier log has stamps in the same interval.
    pub(super) fn add(&mut self, start_s: f64, length_s: f64) -> Result<f64, Overlap> {
        let end_s = start_s + length_s;
        if let (Some((first_s, ..)), Some((_, last_s, _))) = (self.spans.first(), self.spans.last()) {
            // Stamps are rounded: the next log may begin a little before the end of the last one.
            let runs_on = start_s >= last_s - 1e-3 && start_s - last_s < LONGEST_PAUSE_S;
            let is_near = start_s.abs() <= NEAR_ZERO_S || (start_s - first_s).abs() <= NEAR_ZERO_S;
            let restarts = start_s.abs() < EPOCH_S && first_s.abs() < EPOCH_S && is_near;
            if !runs_on {
                let overlap = self.spans.iter().find(|(from, to, _)| start_s < *to && end_s > *from);
                match overlap {
                    Some((.., with)) if !restarts => return Err(Overlap { with: *with }),
                    None if start_s.abs() >= EPOCH_S && (start_s - last_s).abs() < LONGEST_PAUSE_S => {}
                    _ => {
                        self.spans.clear();
                        self.base_s = self.end_s - start_s;
                    }
                }
            }
        } else {
            self.base_s = -start_s;
        }
        self.spans.push((start_s, end_s, self.logs));
        self.logs += 1;
        self.end_s = self.end_s.max(end_s + self.base_s);
        Ok(start_s + self.base_s)
    }
}

/// Parses a stamp: a number, a clock time `h:m:s`, or a date with a time in ISO 8601.
///
/// Returns the number, or seconds since midnight or since 1970 with `true`.
pub(super) fn parse_stamp(cell: &str) -> Option<(f64, bool)> {
    let cell = cell.trim();
    if let Ok(number) = cell.parse::<f64>() {
        return number.is_finite().then_some((number, false));
    }
    let (date, time) = match cell.split_once(['T', ' ']) {
        Some((date, time)) => (Some(date), time),
        None => (None, cell),
    };
    // All stamps of a log have the same zone; it does not change the differences.
    let time = time.trim_end_matches('Z');
    let time = time.split_once('+').map_or(time, |(time, _zone)| time);
    let mut parts = time.split(':');
    let hours: f64 = parts.next()?.parse().ok()?;
    let minutes: f64 = parts.next()?.parse().ok()?;
    let seconds: f64 = parts.next().map_or(Some(0.0), |s| s.replace(',', ".").parse().ok())?;
    let is_time = (0.0..=24.0).contains(&hours) && (0.0..60.0).contains(&minutes);
    if parts.next().is_some() || !is_time || !(0.0..61.0).contains(&seconds) {
        return None;
    }
    let days = match date {
        Some(date) => days_since_1970(date)?,
        None => 0.0,
    };
    Some((days * 86_400.0 + hours * 3_600.0 + minutes * 60.0 + seconds, true))
}

/// Returns the days from 1970-01-01 to a date `YYYY-MM-DD` or `YYYY/MM/DD` of the Gregorian
/// calendar.
fn days_since_1970(date: &str) -> Option<f64> {
    let mut parts = date.split(['-', '/']).map(str::parse::<i64>);
    let (year, month, day) = (parts.next()?.ok()?, parts.next()?.ok()?, parts.next()?.ok()?);
    let is_date = (1900..=2200).contains(&year) && (1..=12).contains(&month) && (1..=31).contains(&day);
    if !is_date || parts.next().is_some() {
        return None;
    }
    // The year starts in March, so that the leap day is its last day.
    let (year, month) = if month < 3 { (year - 1, month + 9) } else { (year, month - 3) };
    let days = 365 * year + year / 4 - year / 100 + year / 400 + (153 * month + 2) / 5 + day - 1;
    Some((days - 719_468) as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stamps(from: f64, step: f64, count: usize) -> Vec<f64> {
        (0..count).map(|i| from + step * i as f64).collect()
    }

    /// Seconds, milliseconds and microseconds of one log give the same times.
    #[test]
    fn units_follow_the_sampling() {
        for (unit, rate) in [(1.0, 200.0), (1e3, 200.0), (1e6, 200.0), (1e3, 10.0), (1.0, 10.0), (1e6, 1e4)] {
            let log = log_time(&stamps(1.7e9 * unit, unit / rate, 50), 1.0, Some(rate));
            assert!((log.time_s[49] - 49.0 / rate).abs() < 1e-4, "{unit} {rate}: {:?}", log.time_s);
            assert_eq!(log.findings.is_empty(), unit == 1.0);
            let alone = log_time(&stamps(0.0, unit / 200.0, 50), 1.0, None);
            assert!((alone.time_s[49] - 49.0 / 200.0).abs() < 1e-9, "{unit}: {:?}", alone.time_s);
        }
    }

    /// A spreadsheet counts days, with or without a declared rate.
    #[test]
    fn days_are_recognised() {
        for rate in [10.0, 100.0, 1000.0] {
            let days = stamps(45_356.4, 1.0 / rate / 86_400.0, 100);
            for declared in [None, Some(rate)] {
                let log = log_time(&days, 1.0, declared);
                assert!((log.time_s[99] - 99.0 / rate).abs() < 1e-5, "{rate}: {:?}", log.time_s);
                assert_eq!(log.findings, [Finding::TimeUnit { declared_s: 1.0, measured_s: 86_400.0 }]);
                assert_eq!(log.impossible_period_s, None);
            }
        }
    }

    /// No unit explains a step of 1e-12 or 1e11; a declared rate may be above those of most logs.
    #[test]
    fn impossible_rates_are_known() {
        let impossible = |step: f64, rate| log_time(&stamps(0.0, step, 50), 1.0, rate).impossible_period_s;
        assert!(impossible(1e-12, None).is_some() && impossible(1e11, None).is_some());
        assert_eq!((impossible(0.01, None), impossible(1e-5, Some(1e5))), (None, None));
    }

    #[test]
    fn counters_roll_over() {
        for modulus in [65_536.0, 4_294_967_296.0] {
            let all: Vec<f64> = stamps(modulus - 300.0, 5.0, 200)
                .iter()
                .map(|t| if *t < modulus { *t } else { t - modulus })
                .collect();
            let log = log_time(&all, 1e-3, Some(200.0));
            assert!((log.time_s[199] - 0.995).abs() < 1e-6, "{:?}", log.time_s[199]);
            assert!(matches!(log.findings[..], [Finding::ClockRollOver { .. }]), "{:?}", log.findings);
        }
    }

    #[test]
    fn resets_continue_the_time() {
        let all = [stamps(3.0, 0.01, 100), stamps(0.0, 0.01, 100)].concat();
        let log = log_time(&all, 1.0, Some(100.0));
        assert_eq!((log.time_s.len(), log.unusable), (200, 0));
        assert!((log.time_s[199] - 1.99).abs() < 1e-9);
        assert!(matches!(log.findings[..], [Finding::ClockReset { time_s }] if (time_s - 0.99).abs() < 1e-9));
    }

    #[test]
    fn single_bad_stamps_are_skipped() {
        let mut all = stamps(0.0, 0.01, 100);
        (all[20], all[50], all[99]) = (0.0, 77.0, 0.5);
        all[70] = f64::NAN;
        let log = log_time(&all, 1.0, Some(100.0));
        assert_eq!((log.time_s.len(), log.unusable), (96, 4));
        assert!(log.findings.is_empty() && log.time_s.is_sorted_by(|a, b| a < b));
    }

    #[test]
    fn repeated_stamps_are_spread() {
        let all: Vec<f64> = (0..100).map(|i| f64::from(i / 10)).collect();
        let log = log_time(&all, 1.0, Some(10.0));
        assert!((log.time_s[37] - 3.7).abs() < 1e-9, "{:?}", log.time_s);
    }

    #[test]
    fn sessions_follow_their_clocks() {
        let starts = |logs: &[(f64, f64)]| -> Result<Vec<f64>, Overlap> {
            let mut clock = SessionClock::default();
            logs.iter().map(|(start_s, length_s)| clock.add(*start_s, *length_s)).collect()
        };
        assert_eq!(starts(&[(0.0, 905.0), (0.0, 120.0), (0.5, 119.0)]), Ok(vec![0.0, 905.0, 1025.0]));
        assert_eq!(starts(&[(0.0, 905.0), (905.0, 120.0), (1030.0, 119.0)]), Ok(vec![0.0, 905.0, 1030.0]));
        assert_eq!(starts(&[(1.7e9, 905.0), (1.7e9 + 910.0, 120.0)]), Ok(vec![0.0, 910.0]));
        assert_eq!(starts(&[(1.7e9, 905.0), (1.7e9 + 900.0, 120.0)]), Err(Overlap { with: 0 }));
        // A log that is listed before an earlier one.
        assert_eq!(starts(&[(1.7e9, 905.0), (1.7e9 - 500.0, 120.0)]), Ok(vec![0.0, -500.0]));
    }

    #[test]
    fn dates_and_clock_times_are_read() {
        assert_eq!(parse_stamp("1970-01-02T00:00:01.5Z"), Some((86_401.5, true)));
        assert_eq!(parse_stamp("2000-03-01 00:00:00"), Some((951_868_800.0, true)));
        assert_eq!(parse_stamp("23:59:59,5"), Some((86_399.5, true)));
        assert_eq!(parse_stamp("12.5"), Some((12.5, false)));
        for bad in ["", "oops", "1:2:3:4", "25:99:00", "2000-13-01 00:00:00", "nan"] {
            assert_eq!(parse_stamp(bad), None, "{bad}");
        }
    }
}
