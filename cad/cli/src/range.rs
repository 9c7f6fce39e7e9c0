//! `A..B` on the command line.

use std::fmt::Display;
use std::str::FromStr;

use pinswitch_diagnostic::excerpt;

/// A range with both ends, the first no greater than the second.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Range<T> {
    /// The first.
    pub(super) from: T,
    /// The last, included.
    pub(super) to: T,
}

impl<T: FromStr + PartialOrd + Display + Copy> FromStr for Range<T> {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (from, to) = text.split_once("..").unwrap_or((text, text));
        let number = |part: &str| {
            let number = part.trim().parse::<T>().ok();
            // NaN and infinity are numbers to the parser, and ends of no range.
            number
                .filter(|number| !number.to_string().contains(['N', 'i']))
                .ok_or_else(|| format!("{:?} is no number; give A..B, such as 3..6", excerpt(part, 40)))
        };
        let (low, high) = (number(from)?, number(to)?);
        if low <= high {
            Ok(Self { from: low, to: high })
        } else {
            Err(format!("{} runs backwards; give the smaller number first", excerpt(text, 80)))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_read_both_ends() {
        assert_eq!("3..6".parse(), Ok(Range { from: 3, to: 6 }));
        assert_eq!("4".parse(), Ok(Range { from: 4, to: 4 }));
        assert_eq!("3.5..80".parse(), Ok(Range { from: 3.5, to: 80.0 }));
        for (bad, said) in [
            ("6..3", "6..3 runs backwards"),
            ("1e300..3", "1e300..3 runs backwards"),
            ("a..b", "\"a\" is no number"),
            ("..", "\"\" is no number"),
            ("1..NaN", "\"NaN\" is no number"),
            ("nan..inf", "\"nan\" is no number"),
            ("1..1e999", "\"1e999\" is no number"),
        ] {
            let error = bad.parse::<Range<f64>>().unwrap_err();
            assert!(error.starts_with(said), "{error}");
        }
    }
}
