//! Numbers as laboratories write them: decimal commas, thousands separators, a unit in the cell.

use crate::decimal::Decimal;
use crate::unit::Unit;

/// The sign between whole and fraction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DecimalSign {
    /// `1.5`.
    Point,
    /// `1,5`.
    Comma,
}

impl DecimalSign {
    /// Returns the sign itself.
    pub fn as_char(self) -> char {
        match self {
            Self::Point => '.',
            Self::Comma => ',',
        }
    }

    /// Returns the word of the option `decimal`.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Point => "point",
            Self::Comma => "comma",
        }
    }
}

/// What the separators of a number show about the decimal sign.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum SignEvidence {
    /// No separator.
    Whole,
    /// Only a decimal point explains it.
    Point,
    /// Only a decimal comma explains it.
    Comma,
    /// One point before three digits, as in `1.234`.
    EitherPoint,
    /// One comma before three digits, as in `1,234`.
    EitherComma,
}

/// Parts of a cell that starts with a number.
struct Parts<'a> {
    is_negative: bool,
    mantissa: &'a str,
    exponent: Option<i32>,
    suffix: &'a str,
}

/// Whether a cell has no value.
pub(crate) fn is_missing(cell: &str) -> bool {
    const WORDS: [&str; 14] =
        ["", "-", "--", "—", "–", "nan", "na", "n/a", "#n/a", "null", "none", "nil", "#nv", "?"];
    cell.len() <= 4 && WORDS.iter().any(|word| cell.eq_ignore_ascii_case(word))
}

/// Parses a number with a given decimal sign; the rest of the cell may be a unit.
pub(crate) fn parse(cell: &str, sign: DecimalSign) -> Option<(Decimal, Option<&'static Unit>)> {
    let parts = split(cell)?;
    let unit = if parts.suffix.is_empty() { None } else { Some(Unit::parse(parts.suffix)?) };
    let mut plain = String::with_capacity(parts.mantissa.len() + 8);
    if parts.is_negative {
        plain.push('-');
    }
    let (whole, fraction) = match parts.mantissa.rsplit_once(sign.as_char()) {
        Some((whole, fraction)) => (whole, Some(fraction)),
        None => (parts.mantissa, None),
    };
    if fraction.is_some_and(|f| !f.bytes().all(|b| b.is_ascii_digit())) {
        return None;
    }
    push_grouped(&mut plain, whole, sign)?;
    if let Some(fraction) = fraction {
        plain.push('.');
        plain.push_str(fraction);
    }
    if let Some(exponent) = parts.exponent {
        plain.push('e');
        plain.push_str(&exponent.to_string());
    }
    Some((Decimal::parse(&plain)?, unit))
}

/// Appends the digits of a whole number without its thousands separators; `None` if a group has
/// other than three digits.
fn push_grouped(plain: &mut String, whole: &str, sign: DecimalSign) -> Option<()> {
    if whole.bytes().all(|b| b.is_ascii_digit()) {
        plain.push_str(whole);
        return Some(());
    }
    let mut separator = None;
    for (i, group) in whole.split(|c: char| !c.is_ascii_digit()).enumerate() {
        let fits = if i == 0 { (1..=3).contains(&group.len()) } else { group.len() == 3 };
        if !fits {
            return None;
        }
        plain.push_str(group);
    }
    // One kind of separator, and not the decimal sign.
    for c in whole.chars().filter(|c| !c.is_ascii_digit()) {
        if c == sign.as_char() || separator.is_some_and(|s| s != c) {
            return None;
        }
        separator = Some(c);
    }
    Some(())
}

/// Returns what a cell shows about the decimal sign; `None` if it is not a number with either sign.
pub(crate) fn sign_evidence(cell: &str) -> Option<SignEvidence> {
    let first = cell.chars().next()?;
    if !(first.is_ascii_digit() || matches!(first, '+' | '-' | '\u{2212}' | '.' | ',')) {
        return None;
    }
    let point = parse(cell, DecimalSign::Point);
    if !cell.contains(['.', ',']) {
        return point.map(|_| SignEvidence::Whole);
    }
    let comma = parse(cell, DecimalSign::Comma);
    let is_fraction_only = split(cell).is_some_and(|parts| {
        let whole = parts.mantissa.split(['.', ',']).next().unwrap_or_default();
        // 0,123 and 012,345 are not grouped numbers, and neither is a number with an exponent.
        whole.starts_with('0') || parts.exponent.is_some()
    });
    match (point.is_some(), comma.is_some()) {
        (true, false) => Some(SignEvidence::Point),
        (false, true) => Some(SignEvidence::Comma),
        (true, true) if cell.contains('.') => {
            Some(if is_fraction_only { SignEvidence::Point } else { SignEvidence::EitherPoint })
        }
        (true, true) => Some(if is_fraction_only { SignEvidence::Comma } else { SignEvidence::EitherComma }),
        (false, false) => None,
    }
}

fn split(cell: &str) -> Option<Parts<'_>> {
    let cell = cell.trim();
    let mut rest = cell;
    let mut is_negative = false;
    if let Some(after) = rest.strip_prefix('+') {
        rest = after;
    } else if let Some(after) = rest.strip_prefix(['-', '\u{2212}']) {
        (rest, is_negative) = (after, true);
    }
    rest = rest.trim_start();
    let mut end = 0;
    let mut characters = rest.char_indices().peekable();
    while let Some((at, c)) = characters.next() {
        let next_is_digit = characters.peek().is_some_and(|(_, next)| next.is_ascii_digit());
        let is_part = match c {
            '0'..='9' | '.' | ',' => true,
            // Thousands separators of other countries.
            ' ' | '\u{a0}' | '\u{202f}' | '\u{2009}' | '\'' | '\u{2019}' => at > 0 && next_is_digit,
            _ => false,
        };
        if !is_part {
            break;
        }
        end = at + c.len_utf8();
    }
    let mantissa = &rest[..end];
    if !mantissa.bytes().any(|b| b.is_ascii_digit()) {
        return None;
    }
    rest = &rest[end..];
    let mut exponent = None;
    if let Some(after) = rest.strip_prefix(['e', 'E']) {
        let digits = after.strip_prefix(['+', '-']).unwrap_or(after);
        let length = digits.bytes().take_while(u8::is_ascii_digit).count();
        if length > 0 {
            let whole = after.len() - digits.len() + length;
            exponent = Some(after.get(..whole)?.parse::<i32>().ok()?);
            rest = &after[whole..];
        }
    }
    let suffix = rest.trim();
    // `00.TXT` is a name.
    if !suffix.is_empty() && mantissa.ends_with(['.', ',']) {
        return None;
    }
    Some(Parts { is_negative, mantissa, exponent, suffix })
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn value(cell: &str, sign: DecimalSign) -> Option<f64> {
        parse(cell, sign).map(|(value, _)| value.to_f64())
    }

    #[test]
    fn numbers_of_many_countries_are_read() {
        for (cell, sign, expected) in [
            ("12.5", DecimalSign::Point, Some(12.5)),
            ("12,5", DecimalSign::Comma, Some(12.5)),
            ("12,5", DecimalSign::Point, None),
            ("1.234,5", DecimalSign::Comma, Some(1234.5)),
            ("1,234.5", DecimalSign::Point, Some(1234.5)),
            ("1 234 567,5", DecimalSign::Comma, Some(1_234_567.5)),
            ("1'234.5", DecimalSign::Point, Some(1234.5)),
            ("1\u{202f}234,5", DecimalSign::Comma, Some(1234.5)),
            ("\u{2212}3,5E-2", DecimalSign::Comma, Some(-0.035)),
            ("+.5", DecimalSign::Point, Some(0.5)),
            ("12.5 N", DecimalSign::Point, Some(12.5)),
            ("05.03.2024", DecimalSign::Comma, None),
            ("09:51:39", DecimalSign::Point, None),
            ("5;8;11", DecimalSign::Point, None),
            ("00.TXT", DecimalSign::Point, None),
            ("V1", DecimalSign::Point, None),
            ("1.2.3", DecimalSign::Point, None),
        ] {
            assert_eq!(value(cell, sign), expected, "{cell}");
        }
    }

    #[test]
    fn one_separator_before_three_digits_is_ambiguous() {
        for (cell, expected) in [
            ("1,234", Some(SignEvidence::EitherComma)),
            ("1.234", Some(SignEvidence::EitherPoint)),
            ("0,234", Some(SignEvidence::Comma)),
            ("1234,567", Some(SignEvidence::Comma)),
            ("1,234,567", Some(SignEvidence::Point)),
            ("1,23", Some(SignEvidence::Comma)),
            ("1,234E+00", Some(SignEvidence::Comma)),
            ("1.5", Some(SignEvidence::Point)),
            ("15", Some(SignEvidence::Whole)),
            ("05.03.2024", None),
            ("", None),
        ] {
            assert_eq!(sign_evidence(cell), expected, "{cell}");
        }
    }

    proptest! {
        #[test]
        fn any_cell_is_parsed_or_refused(cell in any::<String>()) {
            let _ = (sign_evidence(&cell), parse(&cell, DecimalSign::Comma), is_missing(&cell));
        }
    }
}
