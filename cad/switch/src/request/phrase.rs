//! Requirements as phrases: `at most 8 at 50`, `about 20 within 15%`, `between 4 and 6`.

use super::target::Requirement;
use crate::config::ValueError;
use pinswitch_diagnostic::{codes, short_number};

/// Accepted phrases, as the help of errors.
pub const FORMS: &str =
    "write 'at most 8', 'at least 8', 'between 4 and 6', 'about 5' or 'about 5 within 15%'";

/// Parses a requirement, and the load in newtons if the phrase ends in `at N`. A bare number means about, with a relative
/// tolerance of `within`.
///
/// # Errors
/// [`ValueError`] for any other phrase.
///
/// ```
/// use pinswitch_switch::request::{Requirement, parse_requirement};
///
/// assert_eq!(parse_requirement("at most 8 at 50", 0.1)?, (Requirement::AtMost(8.0), Some(50.0)));
/// assert_eq!(parse_requirement("20", 0.1)?, (Requirement::About { value: 20.0, within: 0.1 }, None));
/// assert!(parse_requirement("roughly 20", 0.1).is_err());
/// # Ok::<(), pinswitch_switch::config::ValueError>(())
/// ```
pub fn parse_requirement(text: &str, within: f64) -> Result<(Requirement, Option<f64>), ValueError> {
    let words: Vec<&str> = text.split_whitespace().collect();
    let number = |word: &str| {
        let digits = word.strip_suffix("N").unwrap_or(word);
        let value = digits.parse::<f64>();
        positive(value.map_err(|_| {
            ValueError::new(codes::MALFORMED_VALUE, format!("{word:?} is not a number"), FORMS)
        })?)
    };
    // The last `at N` is the load, unless it belongs to `at most` or `at least`.
    let (words, load_n) = match words.as_slice() {
        [before @ .., "at", load] if !before.is_empty() && !["most", "least"].contains(load) => {
            (before, Some(number(load)?))
        }
        all => (all, None),
    };
    let requirement = match words {
        ["at", "most", value] => Requirement::AtMost(number(value)?),
        ["at", "least", value] => Requirement::AtLeast(number(value)?),
        ["between", low, "and", high] => {
            let (low, high) = (number(low)?, number(high)?);
            if low > high {
                let problem =
                    format!("the range {} to {} is reversed", short_number(low), short_number(high));
                return Err(ValueError::new(codes::INVALID_RANGE, problem, "give the smaller number first"));
            }
            Requirement::Between(low, high)
        }
        ["about", value] | [value] => Requirement::About { value: number(value)?, within },
        ["about", value, "within", share] => {
            Requirement::About { value: number(value)?, within: parse_share(share)? }
        }
        _ => {
            return Err(ValueError::new(
                codes::INVALID_REQUIREMENT,
                format!("{text:?} is not a requirement"),
                FORMS,
            ));
        }
    };
    Ok((requirement, load_n))
}

/// Parses a share such as `0.1` or `10%`.
///
/// # Errors
/// [`ValueError`] for anything but a number above 0 and below 1.
pub fn parse_share(word: &str) -> Result<f64, ValueError> {
    let (digits, scale) = word.strip_suffix('%').map_or((word, 1.0), |digits| (digits, 0.01));
    let share = digits.parse::<f64>().ok().map(|share| share * scale);
    share.filter(|share| is_share(*share)).ok_or_else(|| not_a_share(&format!("{word:?}")))
}

/// Whether a number is above 0 and below 1.
pub(super) fn is_share(value: f64) -> bool {
    value > 0.0 && value < 1.0
}

pub(super) fn not_a_share(value: &str) -> ValueError {
    ValueError::new(
        codes::OUT_OF_RANGE,
        format!("{value} is not a share"),
        "give a number above 0 and below 1, such as 0.1 or 10%",
    )
}

/// Returns a number that is above zero and finite.
pub(super) fn positive(value: f64) -> Result<f64, ValueError> {
    if value > 0.0 && value.is_finite() {
        Ok(value)
    } else {
        Err(ValueError::new(
            codes::OUT_OF_RANGE,
            format!("{} is not a number above 0", short_number(value)),
            "give a number above 0",
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_form_is_parsed() {
        for (text, requirement, load) in [
            ("at most 8", Requirement::AtMost(8.0), None),
            ("at least 8 at 50", Requirement::AtLeast(8.0), Some(50.0)),
            ("between 4 and 6 at 30N", Requirement::Between(4.0, 6.0), Some(30.0)),
            ("about 5 at 30", Requirement::About { value: 5.0, within: 0.2 }, Some(30.0)),
            ("about 5 within 10% at 30", Requirement::About { value: 5.0, within: 0.1 }, Some(30.0)),
            ("5 at 30", Requirement::About { value: 5.0, within: 0.2 }, Some(30.0)),
        ] {
            assert_eq!(parse_requirement(text, 0.2), Ok((requirement, load)), "{text}");
        }
    }

    #[test]
    fn other_phrases_are_refused() {
        for text in
            ["", "at most", "most 8", "at most x", "about -3", "about 5 within 3", "between 6 and 4", "NaN"]
        {
            assert!(parse_requirement(text, 0.1).is_err(), "{text}");
        }
    }
}
