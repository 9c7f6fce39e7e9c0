//! `A..B` on the command line.

use std::fmt::Display;
use std::str::FromStr;

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
            part.trim().parse::<T>().map_err(|_| format!("{part:?} is no number; give A..B, such as 3..6"))
        };
        let (from, to) = (number(from)?, number(to)?);
        // Also refuses NaN, which is not ordered.
        if from <= to {
            Ok(Self { from, to })
        } else {
            Err(format!("{from}..{to} runs backwards; give the smaller number first"))
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
        for bad in ["6..3", "a..b", "..", "1..NaN"] {
            assert!(bad.parse::<Range<f64>>().is_err(), "{bad}");
        }
    }
}
