//! Dates and times of day.

use crate::decimal::Decimal;

/// Seconds of a day.
const DAY_S: i64 = 86_400;

/// Order of the parts of a date with a four-digit year at its end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DateOrder {
    /// Day, month, year.
    DayFirst,
    /// Month, day, year.
    MonthFirst,
}

/// A moment on a clock.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Moment {
    /// Days since 1970-01-01; `None` for a time of day.
    pub(crate) day: Option<i64>,
    /// Seconds since midnight; `None` for a day.
    pub(crate) seconds: Option<Decimal>,
}

impl Moment {
    /// Returns the seconds since 1970, or since midnight without a day.
    pub(crate) fn seconds(self) -> Decimal {
        let day = self.day.unwrap_or_default() * DAY_S;
        let whole = Decimal::new(u128::from(day.unsigned_abs()), 0);
        let whole = if day < 0 { whole.negated() } else { whole };
        whole.plus(self.seconds.unwrap_or(Decimal::ZERO))
    }
}

/// Whether a cell is two numbers with a colon, such as `10:15`: hours and minutes, or minutes and seconds.
pub(crate) fn is_two_parts(cell: &str) -> bool {
    let parts: Vec<&str> = cell.trim().split(':').collect();
    let is_number =
        |part: &&str| part.len() <= 2 && part.bytes().all(|b| b.is_ascii_digit()) && !part.is_empty();
    parts.len() == 2 && parts.iter().all(is_number)
}

/// Parses a date, a time of day, or both; `None` for anything else, such as a number.
pub(crate) fn parse(cell: &str, order: DateOrder) -> Option<Moment> {
    let cell = cell.trim();
    if cell.len() > 48 || !cell.as_bytes().first()?.is_ascii_digit() {
        return None;
    }
    let parts: Vec<&str> = cell.split([' ', 'T', 't']).filter(|part| !part.is_empty()).collect();
    let (day, time, half) = match parts.as_slice() {
        [one] if one.contains(':') => (None, Some(*one), None),
        [one] => (Some(*one), None, None),
        [one, half] if one.contains(':') => (None, Some(*one), Some(*half)),
        [day, time] => (Some(*day), Some(*time), None),
        [day, time, half] => (Some(*day), Some(*time), Some(*half)),
        _ => return None,
    };
    let day = match day {
        Some(text) => Some(parse_day(text, order)?),
        None => None,
    };
    let seconds = match time {
        Some(text) => {
            let (time, zone) = split_zone(text)?;
            let seconds = parse_time(time, half)?;
            // Without a date, the zone moves the start of the clock only.
            Some(if day.is_some() { seconds.plus(zone.negated()) } else { seconds })
        }
        None => None,
    };
    Some(Moment { day, seconds })
}

/// Whether the cell is a date that another order would change.
pub(crate) fn depends_on_order(cell: &str) -> bool {
    let of = |order| parse(cell, order).and_then(|moment| moment.day);
    match (of(DateOrder::DayFirst), of(DateOrder::MonthFirst)) {
        (Some(a), Some(b)) => a != b && cell.contains('/'),
        _ => false,
    }
}

fn parse_day(text: &str, order: DateOrder) -> Option<i64> {
    let text = text.trim_end_matches(',');
    let separator = text.chars().find(|c| !c.is_ascii_digit()).filter(|c| matches!(c, '.' | '/' | '-'))?;
    let parts: Vec<&str> = text.split(separator).collect();
    let [a, b, c] = parts.as_slice() else { return None };
    if [a, b, c].iter().any(|part| part.is_empty() || part.len() > 4) {
        return None;
    }
    let number = |part: &str| part.parse::<i64>().ok();
    let (a_number, b_number, c_number) = (number(a)?, number(b)?, number(c)?);
    if a.len() == 4 {
        return days(a_number, b_number, c_number);
    }
    let year = match c.len() {
        4 => c_number,
        2 => 2000 + c_number,
        _ => return None,
    };
    // Dates with points and hyphens have the day first everywhere.
    let month_first = order == DateOrder::MonthFirst && separator == '/';
    let first = if month_first { days(year, a_number, b_number) } else { days(year, b_number, a_number) };
    let second = if month_first { days(year, b_number, a_number) } else { days(year, a_number, b_number) };
    first.or(second.filter(|_| separator == '/'))
}

/// Days since 1970-01-01 in the Gregorian calendar (H. Hinnant, "chrono-compatible low-level date
/// algorithms").
fn days(year: i64, month: i64, day: i64) -> Option<i64> {
    if !(1..=12).contains(&month) || !(1..=31).contains(&day) || !(1900..=2200).contains(&year) {
        return None;
    }
    let year = if month <= 2 { year - 1 } else { year };
    let era = year.div_euclid(400);
    let of_era = year - era * 400;
    let of_year = (153 * (month + if month > 2 { -3 } else { 9 }) + 2) / 5 + day - 1;
    Some(era * 146_097 + of_era * 365 + of_era / 4 - of_era / 100 + of_year - 719_468)
}

/// Splits a time from its zone (ISO 8601), such as `+01:00`, `-0500` or `Z`; returns the seconds east of Greenwich.
fn split_zone(text: &str) -> Option<(&str, Decimal)> {
    let text = text.trim_end_matches(['Z', 'z']);
    let Some((at, sign)) = text.char_indices().find(|(_, c)| matches!(c, '+' | '-')) else {
        return Some((text, Decimal::ZERO));
    };
    let (time, zone) = (&text[..at], &text[at + 1..]);
    let digits: String = zone.chars().filter(|c| *c != ':').collect();
    let number =
        |range: std::ops::Range<usize>| digits.get(range).map_or(Some(0), |part| part.parse::<u32>().ok());
    let (hours, minutes) = (number(0..2)?, number(2..4)?);
    if !matches!(digits.len(), 2 | 4) || hours > 14 || minutes > 59 {
        return None;
    }
    let east = Decimal::new(u128::from(hours * 3600 + minutes * 60), 0);
    Some((time, if sign == '-' { east.negated() } else { east }))
}

fn parse_time(text: &str, half: Option<&str>) -> Option<Decimal> {
    let parts: Vec<&str> = text.split(':').collect();
    let (hours, minutes, seconds) = match parts.as_slice() {
        // Minutes and seconds, if the last part has a fraction.
        [minutes, seconds] if seconds.contains(['.', ',']) => ("0", *minutes, *seconds),
        [hours, minutes] => (*hours, *minutes, "0"),
        [hours, minutes, seconds] => (*hours, *minutes, *seconds),
        _ => return None,
    };
    let whole = |part: &str, most: u32| part.parse::<u32>().ok().filter(|n| *n < most);
    let mut hours = whole(hours, 100)?;
    match half.map(str::to_ascii_lowercase).as_deref() {
        Some("pm") if hours < 12 => hours += 12,
        Some("am") if hours == 12 => hours = 0,
        Some("am" | "pm") | None => {}
        Some(_) => return None,
    }
    let seconds = Decimal::parse(&seconds.replace(',', ".")).filter(|s| (0.0..61.0).contains(&s.to_f64()))?;
    let whole = u128::from(hours * 3600 + whole(minutes, 60)? * 60);
    Some(Decimal::new(whole, 0).plus(seconds))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn seconds(cell: &str) -> Option<f64> {
        parse(cell, DateOrder::DayFirst).map(|moment| moment.seconds().to_f64())
    }

    #[test]
    fn clocks_of_loggers_are_read() {
        let start = 1_361_267_499.0; // 2013-02-19T09:51:39Z
        for (cell, expected) in [
            ("2013-02-19T09:51:39Z", Some(start)),
            ("2013/02/19 09:51:39.25", Some(start + 0.25)),
            ("19.02.2013 09:51:39,25", Some(start + 0.25)),
            ("19/02/2013 9:51:39 AM", Some(start)),
            ("2013-02-19T10:51:39+01:00", Some(start)),
            ("2013-02-19T04:21:39.5-0530", Some(start + 0.5)),
            ("2013-02-19T10:51:39+99:00", None),
            ("09:51:39.197", Some(35_499.197)),
            ("9:51:39 PM", Some(78_699.0)),
            ("01:23.5", Some(83.5)),
            ("01:23", Some(4_980.0)),
            ("19.02.2013", Some(1_361_232_000.0)),
            ("12.5", None),
            ("1.2.3", None),
            ("5:3:99", None),
            ("V1", None),
        ] {
            assert_eq!(seconds(cell), expected, "{cell}");
        }
        assert!(
            depends_on_order("05/03/2024")
                && !depends_on_order("25/03/2024")
                && !depends_on_order("05.03.2024")
        );
    }

    proptest! {
        #[test]
        fn any_cell_is_a_moment_or_not(cell in "[0-9a-zA-Z:./, +-]{0,30}") {
            let _ = seconds(&cell);
        }
    }
}
