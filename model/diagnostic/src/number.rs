//! Numbers of any size in a message.

/// The shortest text of a number that reads back as the same number, with an exponent if it is very large or small:
/// 1e300 would take hundreds of digits.
///
/// ```
/// use pinswitch_diagnostic::short_number;
///
/// assert_eq!([12.5, 1e300, -2e-9].map(short_number), ["12.5", "1e300", "-2e-9"]);
/// ```
pub fn short_number(value: f64) -> String {
    let is_plain = value == 0.0 || !value.is_finite() || PLAIN.contains(&value.abs());
    if is_plain { value.to_string() } else { format!("{value:e}") }
}

/// Magnitudes that are written without an exponent.
const PLAIN: std::ops::Range<f64> = 1e-6..1e9;
