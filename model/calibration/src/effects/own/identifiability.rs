//! Identifiability of a formula's constants: no data determine `a` and `b` of `(a + b)*f`, only
//! their sum.

use nalgebra::DMatrix;

use super::definition::OwnParameter;
use super::probe::spread_probes;
use crate::effects::formula::EffectFormula;

/// Smallest singular value of the sensitivities, as a share of the largest, below which a
/// combination of constants changes nothing. Finite differences of equal formulas agree to 1e-8.
const NEGLIGIBLE: f64 = 1e-6;
/// Smallest component of such a combination that makes a constant part of it.
const SMALLEST_COMPONENT: f64 = 0.05;
/// Rows per constant in which a formula must act for a decision.
const ROWS_EACH: usize = 3;

/// Returns the names of constants that no data can identify at any values; `None` if there are
/// none, or the probe rows do not decide it.
pub(super) fn unidentifiable<'a>(
    formula: &EffectFormula,
    parameters: &'a [OwnParameter],
) -> Option<Vec<&'a str>> {
    // Constants may be confounded at the start values only, which is acceptable.
    let places = [(1.0, 0.5), (1.37, 0.31), (0.71, 0.68)];
    // A different share for each constant, since exchangeable constants are confounded where they
    // are equal.
    let between = |share: f64, k: usize| 0.1 + 0.8 * libm::modf(share + 0.618 * k as f64).0;
    let mut confounded: Option<Vec<usize>> = None;
    for (i, (size, shape)) in places.into_iter().enumerate() {
        let values: Vec<f64> = parameters
            .iter()
            .enumerate()
            .map(|(k, p)| match p.bounds {
                _ if i == 0 => p.start,
                None => p.start * (size + 0.1 * k as f64),
                Some((low, high)) => low + (high - low) * between(shape, k),
            })
            .collect();
        let here = confounded_at(formula, parameters, &values)?;
        confounded = Some(match confounded {
            None => here,
            Some(before) => before.into_iter().filter(|k| here.contains(k)).collect(),
        });
    }
    let names: Vec<&str> = confounded?.into_iter().map(|k| parameters[k].name.as_str()).collect();
    (names.len() > 1).then_some(names)
}

/// Returns the name of a shape that changes the effect only in steps, which a fit cannot follow.
pub(super) fn step_parameter<'a>(formula: &EffectFormula, parameters: &'a [OwnParameter]) -> Option<&'a str> {
    let rows = spread_probes();
    let start: Vec<f64> = parameters.iter().map(|p| p.start).collect();
    let at = |k: usize, value: f64| -> Vec<f64> {
        let mut moved = start.clone();
        moved[k] = value;
        rows.iter().map(|row| formula.value(&moved, &row.moment())).collect()
    };
    let jumps = |(k, parameter): &(usize, &OwnParameter)| {
        let Some((low, high)) = parameter.bounds else { return false };
        let places: Vec<f64> = (1..20).map(|i| low + (high - low) * (f64::from(i) / 20.0 + 1e-3)).collect();
        let step = 1e-7 * (high - low);
        let moves_a_little = places.iter().any(|place| at(*k, *place) != at(*k, place + step));
        let moves = places.windows(2).any(|pair| at(*k, pair[0]) != at(*k, pair[1]));
        moves && !moves_a_little
    };
    parameters.iter().enumerate().find(jumps).map(|(_, parameter)| parameter.name.as_str())
}

/// Returns the constants of a combination without effect at these values; `None` if there is none,
/// or too few rows decide.
fn confounded_at(formula: &EffectFormula, parameters: &[OwnParameter], values: &[f64]) -> Option<Vec<usize>> {
    let rows = spread_probes();
    let mut columns: Vec<(usize, Vec<f64>)> = Vec::new();
    for (k, parameter) in parameters.iter().enumerate() {
        let scale = parameter.bounds.map_or(values[k].abs(), |(low, high)| high - low);
        let step = 1e-5 * scale.max(1e-9);
        let at = |value: f64| {
            let mut moved = values.to_vec();
            moved[k] = value;
            rows.iter().map(|row| formula.value(&moved, &row.moment())).collect::<Vec<f64>>()
        };
        let (above, below) = (at(values[k] + step), at(values[k] - step));
        let column: Vec<f64> = above.iter().zip(&below).map(|(a, b)| (a - b) / (2.0 * step)).collect();
        let length = column.iter().map(|v| v * v).sum::<f64>().sqrt();
        if !length.is_finite() {
            return None;
        }
        // A small change of the place of a step changes no row.
        if length * scale > 1e-9 {
            columns.push((k, column.into_iter().map(|v| v / length).collect()));
        }
    }
    let acts = |row: &usize| columns.iter().any(|(_, column)| column[*row].abs() > 1e-3);
    let acting = (0..rows.len()).filter(acts).count();
    if columns.len() < 2 || acting < ROWS_EACH * columns.len() {
        return None;
    }
    let matrix = DMatrix::from_fn(rows.len(), columns.len(), |row, k| columns[k].1[row]);
    let svd = matrix.svd(false, true);
    let largest = svd.singular_values.max();
    let v_t = svd.v_t?;
    let mut part = vec![false; columns.len()];
    for (i, _) in svd.singular_values.iter().enumerate().filter(|(_, v)| **v < NEGLIGIBLE * largest) {
        (0..columns.len()).for_each(|k| part[k] |= v_t[(i, k)].abs() > SMALLEST_COMPONENT);
    }
    let constants: Vec<usize> =
        columns.iter().zip(&part).filter(|(_, p)| **p).map(|((k, _), _)| *k).collect();
    (!constants.is_empty()).then_some(constants)
}

#[cfg(test)]
mod tests {
    use pinswitch_diagnostic::Diagnostic;

    use crate::effects::{CATALOGUE, EffectDefinition, OwnEffect, Vocabulary, own_effects_text};

    fn read(formula: &str, parameters: &str) -> Result<(), Diagnostic> {
        let text = format!(
            "schema = \"pinswitch.effects/1\"\n[[effect]]\nid = \"mine\"\nside = \"switch\"\ncovariate = \"speed\"\n\
             acts_on = \"mu\"\ncombine = \"factor\"\nformula = \"{formula}\"\n{parameters}"
        );
        Vocabulary::built_in().read(&text, "mine.toml").map(|_| ())
    }

    const A: &str = "parameters.a = { size = true, start = 0.1, unit = \"1\" }\n";
    const B: &str = "parameters.b = { size = true, start = 0.2, unit = \"1\" }\n";
    const D: &str = "parameters.d = { start = 1.0, low = 0.5, high = 2.0, unit = \"1\" }\n";
    const C: &str = "parameters.c = { start = 52, low = 35, high = 75, unit = \"%\" }\n";
    const W: &str = "parameters.w = { start = 8, low = 3, high = 30, unit = \"%\" }\n";

    #[test]
    fn unidentifiable_constants_are_named() {
        for (formula, parameters, names) in [
            ("(a + b)*exp(-((speed_pct - c)/w)^2)*d^2", [A, B, C, D, W].concat(), "a and b and d"),
            ("a*b*(speed_pct/50 - 1) + a*b*(speed_pct/50 - 1)^2", [A, B].concat(), "a and b"),
            ("a*exp(d*1)*load_n/50", [A, D].concat(), "a and d"),
            ("a*(1 - is_silicone) + b*(1 - is_silicone)*2", [A, B].concat(), "a and b"),
        ] {
            let error = read(formula, &parameters).unwrap_err().to_string();
            assert!(error.contains(&format!("constants {names} are not identifiable")), "{formula}: {error}");
            assert!(error.starts_with("mine.toml:8:"), "{error}");
        }
    }

    #[test]
    fn identifiable_constants_are_accepted() {
        let narrow = "parameters.w = { start = 0.2, low = 0.1, high = 0.4, unit = \"%\" }\n";
        for (formula, parameters) in [
            ("-a*exp(-((speed_pct - c)/w)^2)", [A, C, W].concat()),
            ("-a*exp(-((speed_pct - c)/w)^2)", [A, C, narrow].concat()),
            ("a*(time > 0.5) + b*(time <= 0.5)", [A, B].concat()),
            ("a*stroke + b*stroke^2", [A, B].concat()),
            ("a*(load_n/50)^d", [A, D].concat()),
            ("a*pin_count + b*is_device", [A, B].concat()),
            ("a*sin(6.28*d*stroke) + b*cos(6.28*d*stroke)", [A, B, D].concat()),
        ] {
            assert_eq!(read(formula, &parameters), Ok(()), "{formula}");
        }
    }

    #[test]
    fn parameters_of_steps_are_named() {
        let error = read("a*(speed_pct > c)", &[A, C].concat()).unwrap_err();
        assert!(error.problem().contains("only in steps with 'c'"), "{error}");
        assert_eq!(read("a*(speed_pct > 52)", A), Ok(()));
        assert_eq!(read("a*0.5*(1 + tanh((speed_pct - c)/0.5))", &[A, C].concat()), Ok(()));
        assert_eq!(read("a*max((speed_pct - c)/50, 0)", &[A, C].concat()), Ok(()));
    }

    #[test]
    fn no_built_in_effect_is_refused() {
        for effect in CATALOGUE {
            let Ok(definition) = EffectDefinition::of(*effect) else { continue };
            let own = OwnEffect::new(EffectDefinition { id: "mine".to_owned(), ..definition }).unwrap();
            assert_eq!(own.step_parameter(), None);
            assert_eq!(own.unidentifiable_constants(), None, "{}", own_effects_text([own.definition()]));
        }
    }
}
