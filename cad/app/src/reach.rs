//! The reach of a slider: the values of a number, around that of a design, with which it satisfies every rule.
//!
//! Rules are checked at many values, and parts are built at the ends only. An interval that is far from the value of the
//! design, behind values that break a rule, is out of reach.

use pinswitch_switch::built::Built;
use pinswitch_switch::config::Configuration;
use pinswitch_switch::design::Design;
use pinswitch_switch::formats::page::Values;
use serde::Serialize;

use crate::values::configuration;

/// Values that are tried from the one of the design to each end of the range.
const TRIED: u32 = 16;
/// Halvings of the last step of these, to find the value at which a rule breaks.
const HALVINGS: u32 = 12;

/// The answer to `reach`.
#[derive(Debug, PartialEq, Serialize)]
pub(crate) struct Reach {
    /// Least and largest value; `None` if the field is not a number with a range, or the design breaks a rule already.
    ends: Option<[f64; 2]>,
}

/// Finds the reach of a field.
pub(crate) fn answer(values: &Values, field: &str) -> Reach {
    Reach { ends: ends(values, field) }
}

fn ends(values: &Values, field: &str) -> Option<[f64; 2]> {
    let parameter = Configuration::PARAMETERS.iter().find(|parameter| parameter.path() == field)?;
    let own = configuration(values).ok()?;
    let (range, value) = ((parameter.ends)()?, (parameter.get)(&own));
    let is_whole = value.is_integer();
    let value = value.as_float().or_else(|| value.as_integer().map(|whole| whole as f64))?;
    let design = |number: f64| {
        // Ranges of whole numbers are small.
        #[allow(clippy::cast_possible_truncation)]
        let number = if is_whole { (number.round() as i64).into() } else { number.into() };
        let mut changed = own.clone();
        (parameter.set)(&mut changed, &number).ok()?;
        Design::new(changed).ok()
    };
    let satisfies_rules = |number: f64| design(number).is_some();
    let builds = |number: f64| design(number).is_some_and(|design| Built::new(design).is_ok());
    if !satisfies_rules(value) {
        return None;
    }
    Some(range.map(|end| {
        let end = last_of(value, end, is_whole, TRIED, &satisfies_rules);
        // Where the design itself is not built, another value may be.
        if builds(end) || !builds(value) { end } else { last_of(value, end, is_whole, 1, &builds) }
    }))
}

/// Returns the last value from one towards an end of the range before the first that is not allowed, of as many as are tried.
fn last_of(value: f64, end: f64, is_whole: bool, tried: u32, is_allowed: &dyn Fn(f64) -> bool) -> f64 {
    let at = |share: f64| {
        let exact = value + (end - value) * share;
        if is_whole { exact.round() } else { exact }
    };
    let share = |i: u32| f64::from(i) / f64::from(tried);
    let Some(refused) = (1..=tried).map(share).find(|share| !is_allowed(at(*share))) else { return end };
    let (mut allowed, mut refused) = (refused - share(1), refused);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (allowed + refused);
        if is_allowed(at(middle)) { allowed = middle } else { refused = middle }
    }
    at(allowed)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn with(values: &[(&str, serde_json::Value)]) -> Values {
        values.iter().map(|(path, value)| ((*path).to_owned(), value.clone())).collect()
    }

    /// Within reach every design is built, and beyond an end that is not that of the range none is.
    #[test]
    fn rules_break_beyond_the_reach() {
        let base = with(&[("layout.pins", [5, 8, 11].into())]);
        let is_allowed = |field: &str, number: serde_json::Value| {
            let mut values = base.clone();
            values.insert(field.to_owned(), number);
            configuration(&values)
                .is_ok_and(|changed| Design::new(changed).is_ok_and(|design| Built::new(design).is_ok()))
        };
        let (mut bounded, mut whole) = (0, 0);
        for parameter in Configuration::PARAMETERS {
            let (field, range) = (parameter.path(), (parameter.ends)());
            let Some([low, high]) = answer(&base, &field).ends else { continue };
            let [first, last] = range.unwrap();
            assert!(first <= low && low <= high && high <= last, "{field}");
            let is_whole = (parameter.get)(&Configuration::default()).is_integer();
            whole += usize::from(is_whole);
            let number = |value: f64| if is_whole { (value as i64).into() } else { value.into() };
            for value in [low, high] {
                assert!(is_allowed(&field, number(value)), "{field} = {value}");
            }
            let step = if is_whole { 1.0 } else { 1e-3 * (last - first) };
            for (end, beyond) in [(low, low - step), (high, high + step)] {
                if end != first && end != last {
                    bounded += 1;
                    assert!(!is_allowed(&field, number(beyond)), "{field} = {beyond}");
                }
            }
        }
        assert!(bounded > 20 && whole > 2, "{bounded} {whole}");
    }

    #[test]
    fn what_is_no_number_has_no_reach() {
        assert_eq!(answer(&Values::new(), "layout.pins").ends, None);
        assert_eq!(answer(&Values::new(), "no.field").ends, None);
        assert_eq!(answer(&with(&[("segment.grooves", 40.into())]), "shell.width_mm").ends, None);
    }
}
