//! Numbers on a page; a number that is not finite is shown as unknown.

/// Formats a number with `decimals` decimals.
pub(super) fn number(value: f64, decimals: usize) -> String {
    if value.is_finite() { format!("{value:.decimals$}") } else { "unknown".to_owned() }
}

/// Formats a force in newtons.
pub(super) fn newtons(value: f64) -> String {
    if value.is_finite() { format!("{value:.4} N") } else { number(value, 4) }
}

/// Formats a number with three significant digits, with an exponent only if it is very small or
/// large.
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

/// Formats a number with its unit; a share as a percentage.
pub(super) fn with_unit(value: f64, unit: &str) -> String {
    match unit {
        "1" if value.is_finite() => format!("{} %", short(100.0 * value)),
        _ if !value.is_finite() => number(value, 0),
        _ => format!("{} {unit}", short(value)),
    }
}

/// Formats a probability, never as 0 or 1: it depends on the priors.
pub(super) fn probability(p: f64) -> String {
    match p {
        p if !p.is_finite() => number(p, 0),
        p if p > 0.9995 => "&gt;0.999".to_owned(),
        p if p < 0.0005 => "&lt;0.001".to_owned(),
        p => format!("{p:.3}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_three_digits_or_are_unknown() {
        let cases = [(0.0, "0"), (1234.5, "1234"), (-0.0123, "-0.0123"), (2e-7, "2.0e-7"), (12.34, "12.3")];
        for (value, expected) in cases {
            assert_eq!(short(value), expected);
        }
        for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            for text in [
                short(value),
                newtons(value),
                number(value, 2),
                with_unit(value, "1"),
                with_unit(value, "N"),
                probability(value),
            ] {
                assert_eq!(text, "unknown");
            }
        }
        assert_eq!([0.99996, 0.9981, 1e-9].map(probability), ["&gt;0.999", "0.998", "&lt;0.001"]);
        assert_eq!(with_unit(0.029, "1"), "2.90 %");
        assert_eq!(with_unit(0.31, "N"), "0.310 N");
    }
}
