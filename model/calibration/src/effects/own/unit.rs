//! Units of constants and variables, as powers of base units.

use pinswitch_diagnostic::{Diagnostic, codes};

/// The base units, as written in files.
const BASE: [&str; 5] = ["N", "%", "s", "mm", "rad"];
/// Powers closer than this are equal.
const SAME: f64 = 1e-9;
/// Largest power of a base unit.
const MAX_POWER: f64 = 20.0;

/// A product of powers of base units; powers may be fractions, as in `N^-0.5`.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Unit([f64; BASE.len()]);

impl PartialEq for Unit {
    fn eq(&self, other: &Self) -> bool {
        self.0.iter().zip(other.0).all(|(a, b)| (a - b).abs() < SAME)
    }
}

impl Unit {
    /// The unit `1`.
    pub(super) const NONE: Unit = Unit([0.0; BASE.len()]);

    /// Parses `1`, `N`, `N^-0.5`, `1/N`, `N mm`, `%/s`: factors with a power, divided by `/`,
    /// multiplied by a space or `*`.
    ///
    /// # Errors
    /// If the text is not a unit.
    pub(super) fn parse(text: &str) -> Result<Unit, Diagnostic> {
        let spaced = text.replace('/', " / ").replace('*', " ");
        let mut unit = Unit::NONE;
        let (mut sign, mut factors) = (1.0, 0);
        for word in spaced.split_whitespace() {
            if word == "/" {
                if sign < 0.0 || factors == 0 {
                    return Err(Diagnostic::new(
                        codes::UNKNOWN_UNIT,
                        format!("misplaced '/' in unit '{text}'"),
                    )
                    .with_help("use '/' once, after a factor, as in 1/N"));
                }
                sign = -1.0;
                continue;
            }
            factors += 1;
            let (name, power) = word.split_once('^').unwrap_or((word, "1"));
            let power: f64 = power.parse().unwrap_or(f64::NAN);
            if !(-MAX_POWER..=MAX_POWER).contains(&power) {
                return Err(Diagnostic::new(
                    codes::UNKNOWN_UNIT,
                    format!("invalid power in '{word}' of unit '{text}'"),
                )
                .with_help(format!("give a number from -{MAX_POWER} to {MAX_POWER}")));
            }
            if name == "1" {
                continue;
            }
            let Some(base) = BASE.iter().position(|b| *b == name) else {
                return Err(Diagnostic::new(codes::UNKNOWN_UNIT, format!("unknown unit '{text}'"))
                    .with_help(format!("use 1, {} and their products", BASE.join(", "))));
            };
            unit.0[base] += sign * power;
        }
        if factors == 0 || text.trim_end().ends_with('/') {
            return Err(
                Diagnostic::new(codes::UNKNOWN_UNIT, "missing unit").with_help("write \"1\" for none")
            );
        }
        Ok(unit)
    }

    /// Returns the product with a power of another unit.
    pub(super) fn times(self, other: Unit, power: f64) -> Unit {
        let mut product = self;
        product.0.iter_mut().zip(other.0).for_each(|(a, b)| *a += power * b);
        product
    }
}

impl std::fmt::Display for Unit {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let mut words: Vec<String> = Vec::new();
        for (name, power) in BASE.iter().zip(self.0).filter(|(_, power)| power.abs() >= SAME) {
            let rounded = (power * 1e6).round() / 1e6;
            words.push(if rounded == 1.0 { (*name).to_owned() } else { format!("{name}^{rounded}") });
        }
        f.write_str(&if words.is_empty() { "1".to_owned() } else { words.join(" ") })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_parsed_and_displayed() {
        for (text, shown) in [
            ("1", "1"),
            ("N", "N"),
            ("N^-0.5", "N^-0.5"),
            ("1/N", "N^-1"),
            ("%/s", "% s^-1"),
            ("N mm*s", "N s mm"),
        ] {
            assert_eq!(Unit::parse(text).map(|u| u.to_string()), Ok(shown.to_owned()), "{text}");
        }
        for text in ["", "kg", "N/", "/N", "N^x", "N^1e9", "1/N/s", "N^^2", "NaN", "N^NaN"] {
            assert!(Unit::parse(text).is_err(), "{text}");
        }
    }
}
