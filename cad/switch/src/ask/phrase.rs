//! Wishes as a person says them: `at most 8 at 50`, `about 20 within 15%`, `between 4 and 6`.

use super::target::Wish;

/// How wishes are written, for errors.
pub const FORMS: &str =
    "write 'at most 8', 'at least 8', 'between 4 and 6', 'about 5' or 'about 5 within 15%'";

/// A wish, and the load that it is about if it ends in `at N`. A bare number means about.
///
/// # Errors
/// What could not be read, and how wishes are written.
///
/// ```
/// use pinswitch_switch::ask::{Wish, parse_wish};
///
/// assert_eq!(parse_wish("at most 8 at 50", 0.1), Ok((Wish::AtMost(8.0), Some(50.0))));
/// assert_eq!(parse_wish("20", 0.1), Ok((Wish::About { value: 20.0, within: 0.1 }, None)));
/// assert!(parse_wish("roughly 20", 0.1).is_err());
/// ```
pub fn parse_wish(text: &str, within: f64) -> Result<(Wish, Option<f64>), String> {
    let words: Vec<&str> = text.split_whitespace().collect();
    let number = |word: &str| {
        let plain = word.strip_suffix("N").unwrap_or(word);
        let value = plain.parse::<f64>().map_err(|_| format!("{word:?} is no number; {FORMS}"))?;
        positive(value)
    };
    // The last `at N` is the load, unless it belongs to `at most` or `at least`.
    let (words, load_n) = match words.as_slice() {
        [before @ .., "at", load] if !before.is_empty() && !["most", "least"].contains(load) => {
            (before, Some(number(load)?))
        }
        all => (all, None),
    };
    let wish = match words {
        ["at", "most", value] => Wish::AtMost(number(value)?),
        ["at", "least", value] => Wish::AtLeast(number(value)?),
        ["between", low, "and", high] => {
            let (low, high) = (number(low)?, number(high)?);
            if low > high {
                return Err(format!(
                    "{} to {} runs backwards; give the smaller number first",
                    short(low),
                    short(high)
                ));
            }
            Wish::Between(low, high)
        }
        ["about", value] | [value] => Wish::About { value: number(value)?, within },
        ["about", value, "within", share] => Wish::About { value: number(value)?, within: share_of(share)? },
        _ => return Err(format!("{text:?} is no wish; {FORMS}")),
    };
    Ok((wish, load_n))
}

/// A share such as `0.1` or `10%`.
///
/// # Errors
/// What would be accepted.
pub fn share_of(word: &str) -> Result<f64, String> {
    let (digits, scale) = word.strip_suffix('%').map_or((word, 1.0), |digits| (digits, 0.01));
    digits
        .parse::<f64>()
        .ok()
        .map(|share| share * scale)
        .filter(|share| *share > 0.0 && *share < 1.0)
        .ok_or_else(|| format!("{word:?} is no share; give one above 0 and below 1, such as 0.1 or 10%"))
}

/// The number as a message shows it: 1e300 would take hundreds of digits.
pub(super) fn short(value: f64) -> String {
    let is_plain = value == 0.0 || !value.is_finite() || (1e-6..1e9).contains(&value.abs());
    if is_plain { value.to_string() } else { format!("{value:e}") }
}

/// The number, if it is above zero and finite.
pub(super) fn positive(value: f64) -> Result<f64, String> {
    if value > 0.0 && value.is_finite() {
        Ok(value)
    } else {
        Err(format!("{} is not above 0, or not finite; give a number above 0", short(value)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_form_is_read() {
        for (text, wish, load) in [
            ("at most 8", Wish::AtMost(8.0), None),
            ("at least 8 at 50", Wish::AtLeast(8.0), Some(50.0)),
            ("between 4 and 6 at 30N", Wish::Between(4.0, 6.0), Some(30.0)),
            ("about 5 at 30", Wish::About { value: 5.0, within: 0.2 }, Some(30.0)),
            ("about 5 within 10% at 30", Wish::About { value: 5.0, within: 0.1 }, Some(30.0)),
            ("5 at 30", Wish::About { value: 5.0, within: 0.2 }, Some(30.0)),
        ] {
            assert_eq!(parse_wish(text, 0.2), Ok((wish, load)), "{text}");
        }
    }

    #[test]
    fn anything_else_is_refused_with_the_forms() {
        for text in
            ["", "at most", "most 8", "at most x", "about -3", "about 5 within 3", "between 6 and 4", "NaN"]
        {
            assert!(parse_wish(text, 0.1).is_err(), "{text}");
        }
    }
}
