//! Numbers as a page shows them: what is not known is said to be so.

/// A number with so many decimals, or the word for none.
pub(super) fn number(value: f64, decimals: usize) -> String {
    if value.is_finite() { format!("{value:.decimals$}") } else { "not known".to_owned() }
}

/// A force in newtons.
pub(super) fn newtons(value: f64) -> String {
    if value.is_finite() { format!("{value:.4} N") } else { number(value, 4) }
}

/// A number with three digits that count, without an exponent where it can do without.
pub(super) fn short(value: f64) -> String {
    let size = value.abs();
    if !value.is_finite() {
        number(value, 0)
    } else if size < 1e-12 {
        "0".to_owned()
    } else if !(1e-4..1e6).contains(&size) {
        format!("{value:.1e}")
    } else {
        let decimals = [(100.0, 0), (10.0, 1), (1.0, 2), (0.1, 3), (0.01, 4), (0.001, 5)];
        let decimals = decimals.iter().find(|(from, _)| size >= *from).map_or(6, |(_, decimals)| *decimals);
        format!("{value:.decimals$}")
    }
}

/// A number with its unit; a share as a percentage.
pub(super) fn with_unit(value: f64, unit: &str) -> String {
    match unit {
        "1" if value.is_finite() => format!("{} %", short(100.0 * value)),
        _ if !value.is_finite() => number(value, 0),
        _ => format!("{} {unit}", short(value)),
    }
}

/// A probability as people write it.
pub(super) fn probability(p: f64) -> String {
    if !p.is_finite() {
        number(p, 0)
    } else if p < 1e-12 {
        "&lt; 1e-12".to_owned()
    } else if p < 0.001 {
        format!("{p:.0e}")
    } else {
        format!("{p:.3}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_digits_count_and_what_is_no_number_is_said() {
        let cases = [(0.0, "0"), (1234.5, "1234"), (-0.0123, "-0.0123"), (2e-7, "2.0e-7"), (12.34, "12.3")];
        for (value, expected) in cases {
            assert_eq!(short(value), expected);
        }
        for odd in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            for text in [
                short(odd),
                newtons(odd),
                number(odd, 2),
                with_unit(odd, "1"),
                with_unit(odd, "N"),
                probability(odd),
            ] {
                assert_eq!(text, "not known");
            }
        }
        assert_eq!(with_unit(0.029, "1"), "2.90 %");
        assert_eq!(with_unit(0.31, "N"), "0.310 N");
    }
}
