//! `A..B` on the command line.

use std::fmt::Display;
use std::str::FromStr;

use pinswitch_diagnostic::{Diagnostic, codes, excerpt};

/// A range that includes both ends, with `from <= to`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Range<T> {
    /// Lower end.
    pub(super) from: T,
    /// Upper end.
    pub(super) to: T,
}

impl<T: FromStr + PartialOrd + Display + Copy> FromStr for Range<T> {
    type Err = Diagnostic;

    /// Parses `A..B`, or `A` for a range of one value.
    fn from_str(text: &str) -> Result<Self, Diagnostic> {
        let (from, to) = text.split_once("..").unwrap_or((text, text));
        let number = |part: &str| {
            let number = part.trim().parse::<T>().ok();
            // Rust parses "NaN" and "inf" as numbers, but they cannot end a range.
            number.filter(|number| !number.to_string().contains(['N', 'i'])).ok_or_else(|| {
                Diagnostic::new(codes::MALFORMED_VALUE, format!("{:?} is not a number", excerpt(part, 40)))
                    .with_help("give A..B, such as 3..6")
            })
        };
        let (low, high) = (number(from)?, number(to)?);
        if low <= high {
            Ok(Self { from: low, to: high })
        } else {
            Err(Diagnostic::new(codes::INVALID_RANGE, "the range runs backwards")
                .with_help("give the smaller number first"))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_range_has_both_ends() {
        assert_eq!("3..6".parse(), Ok(Range { from: 3, to: 6 }));
        assert_eq!("4".parse(), Ok(Range { from: 4, to: 4 }));
        assert_eq!("3.5..80".parse(), Ok(Range { from: 3.5, to: 80.0 }));
    }

    #[test]
    fn invalid_ranges_are_refused() {
        for (text, problem) in [
            ("6..3", "the range runs backwards"),
            ("1e300..3", "the range runs backwards"),
            ("a..b", "\"a\" is not a number"),
            ("..", "\"\" is not a number"),
            ("1..NaN", "\"NaN\" is not a number"),
            ("nan..inf", "\"nan\" is not a number"),
            ("1..1e999", "\"1e999\" is not a number"),
        ] {
            assert_eq!(text.parse::<Range<f64>>().unwrap_err().problem(), problem);
        }
    }
}
