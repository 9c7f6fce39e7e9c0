//! Decimal numbers, so that conversions of units are exact where the text allows it.

use std::fmt;

/// Most significant digits that are kept: further digits are below the resolution of any
/// instrument.
const MAX_DIGITS: usize = 34;
/// Significant digits of each factor when their product exceeds 38 digits.
const PRODUCT_DIGITS: u32 = 18;
/// Largest exponent of ten, in magnitude.
const MAX_EXPONENT: i32 = 10_000;

/// Powers of ten that are exact as binary numbers.
const POWERS: [f64; 23] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18,
    1e19, 1e20, 1e21, 1e22,
];

/// A decimal number: `digits` times ten to the power of `exponent`, with a sign.
///
/// A product of decimals is exact, and [`Decimal::to_f64`] rounds once. Therefore `0.0012 kN` is
/// exactly `1.2 N`.
///
/// ```
/// use pinswitch_import::Decimal;
///
/// let value = Decimal::parse("0.0012").and_then(|v| Some(v.times(Decimal::parse("1000")?)));
/// assert_eq!(value.map(Decimal::to_f64), Some(1.2));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Decimal {
    is_negative: bool,
    digits: u128,
    exponent: i32,
}

impl Decimal {
    /// The number 1.
    pub const ONE: Self = Self::new(1, 0);
    /// The number 0.
    pub const ZERO: Self = Self::new(0, 0);

    /// Creates `digits` times ten to the power of `exponent`.
    pub const fn new(digits: u128, exponent: i32) -> Self {
        Self { is_negative: false, digits, exponent }
    }

    /// Parses a number with a decimal point, such as `-12.5e-3`; `None` if it is not one.
    pub fn parse(text: &str) -> Option<Self> {
        let (mantissa, exponent) = match text.find(['e', 'E']) {
            Some(at) => (text.get(..at)?, text.get(at + 1..)?.parse::<i32>().ok()?),
            None => (text, 0),
        };
        if exponent.abs() > MAX_EXPONENT {
            return None;
        }
        let (is_negative, mantissa) = match mantissa.as_bytes().first()? {
            b'-' => (true, &mantissa[1..]),
            b'+' => (false, &mantissa[1..]),
            _ => (false, mantissa),
        };
        let mut number = Self { is_negative, digits: 0, exponent };
        let (mut significant, mut has_digit, mut is_fraction) = (0, false, false);
        for byte in mantissa.bytes() {
            match byte {
                b'0'..=b'9' => {
                    has_digit = true;
                    if significant < MAX_DIGITS {
                        number.digits = number.digits * 10 + u128::from(byte - b'0');
                        significant += usize::from(number.digits > 0);
                        number.exponent = number.exponent.checked_sub(i32::from(is_fraction))?;
                    } else {
                        number.exponent = number.exponent.checked_add(i32::from(!is_fraction))?;
                    }
                }
                b'.' if !is_fraction => is_fraction = true,
                _ => return None,
            }
        }
        has_digit.then_some(number)
    }

    /// Creates the decimal number with the shortest text that has this value; `None` if it is not
    /// finite.
    pub fn from_f64(value: f64) -> Option<Self> {
        value.is_finite().then(|| Self::parse(&format!("{value:e}"))).flatten()
    }

    /// Returns the product, exactly unless it has more than 38 digits.
    #[must_use]
    pub fn times(self, other: Self) -> Self {
        let is_negative = self.is_negative != other.is_negative;
        let (a, b) = match self.digits.checked_mul(other.digits) {
            Some(_) => (self, other),
            None => (self.shortened(PRODUCT_DIGITS), other.shortened(PRODUCT_DIGITS)),
        };
        Self { is_negative, digits: a.digits * b.digits, exponent: a.exponent + b.exponent }
    }

    /// Returns the sum, exactly unless it has more than 38 digits.
    #[must_use]
    pub fn plus(self, other: Self) -> Self {
        if other.digits == 0 {
            return self;
        }
        if self.digits == 0 {
            return other;
        }
        self.exact_sum(other).or_else(|| Self::from_f64(self.to_f64() + other.to_f64())).unwrap_or(self)
    }

    fn exact_sum(self, other: Self) -> Option<Self> {
        let exponent = self.exponent.min(other.exponent);
        let signed = |number: Self| {
            let shift = u32::try_from(number.exponent - exponent).ok()?;
            let digits = i128::try_from(number.digits).ok()?.checked_mul(10_i128.checked_pow(shift)?)?;
            Some(if number.is_negative { -digits } else { digits })
        };
        let sum = signed(self)?.checked_add(signed(other)?)?;
        Some(Self { is_negative: sum < 0, digits: sum.unsigned_abs(), exponent })
    }

    /// Returns the number with the other sign.
    #[must_use]
    pub fn negated(self) -> Self {
        Self { is_negative: !self.is_negative, ..self }
    }

    /// Whether the number is zero.
    pub fn is_zero(self) -> bool {
        self.digits == 0
    }

    /// Returns the nearest binary number.
    pub fn to_f64(self) -> f64 {
        // Both are exact as binary numbers, so that one rounding gives the nearest (W. D. Clinger,
        // PLDI 1990).
        if self.digits < 1 << 53
            && let Some(power) = POWERS.get(self.exponent.unsigned_abs() as usize)
        {
            #[expect(clippy::cast_precision_loss, reason = "below 2^53")]
            let digits = if self.is_negative { -(self.digits as f64) } else { self.digits as f64 };
            return if self.exponent < 0 { digits / power } else { digits * power };
        }
        let sign = if self.is_negative { "-" } else { "" };
        format!("{sign}{}e{}", self.digits, self.exponent).parse().unwrap_or(f64::NAN)
    }

    fn shortened(self, most: u32) -> Self {
        let (mut digits, mut exponent) = (self.digits, self.exponent);
        while digits >= 10_u128.pow(most) {
            digits = (digits + 5) / 10;
            exponent += 1;
        }
        Self { digits, exponent, ..self }
    }
}

impl fmt::Display for Decimal {
    /// Writes the number without an exponent if it is short, such as `-0.00980665`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.to_f64())
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn decimal(text: &str) -> Decimal {
        Decimal::parse(text).unwrap()
    }

    proptest! {
        #[test]
        fn parsing_agrees_with_the_standard_library(value in any::<f64>()) {
            prop_assume!(value.is_finite());
            for text in [format!("{value}"), format!("{value:e}"), format!("{value:.3e}")] {
                let expected: f64 = text.parse().unwrap();
                prop_assert_eq!(decimal(&text).to_f64().to_bits(), expected.to_bits());
            }
        }

        #[test]
        fn powers_of_ten_only_move_the_point(digits in 0u64.., shift in -12i32..12) {
            let text = format!("{digits}e{shift}");
            let product = Decimal::new(u128::from(digits), 0).times(Decimal::new(1, shift));
            prop_assert_eq!(product.to_f64(), text.parse::<f64>().unwrap());
        }

        #[test]
        fn any_text_is_parsed_or_refused(text in any::<String>()) {
            let _ = Decimal::parse(&text);
        }
    }

    #[test]
    fn products_and_sums_are_exact() {
        assert_eq!(decimal("0.0012").times(decimal("1000")).to_f64(), 1.2);
        assert_eq!(decimal("0.1").plus(decimal("0.2")).to_f64(), 0.3);
        assert_eq!(decimal("1").plus(decimal("-1e-3")).to_f64(), 0.999);
        // One pound-force.
        assert_eq!(decimal("453.59237").times(decimal("0.00980665")).to_f64(), 4.448_221_615_260_5);
        let long = decimal("39.1970510124996275989").times(decimal("4.4482216152605"));
        assert!((long.to_f64() / (39.197_051_012_499_63 * 4.448_221_615_260_5) - 1.0).abs() < 1e-15);
    }
}
