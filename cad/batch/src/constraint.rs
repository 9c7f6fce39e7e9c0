//! Constraints: what a variant must fulfil, over its parameters, its derived dimensions and its predicted friction.

use std::sync::Arc;

use exmex::{BinOp, Express, FlatEx, MakeOperators, Operator, Val, ValMatcher, ValOpsFactory};
use pinswitch_friction::{FrictionCurve, Transition};

use super::axis::config_error;
use pinswitch_switch::config::{ConfigError, Configuration};
use pinswitch_switch::design::Design;
use pinswitch_switch::documents::derived;

/// Names beside fields and derived dimensions.
const PREDICTED: [&str; 5] = ["pin_count", "friction_n", "band_low_n", "band_high_n", "threshold_n"];

type Value = Val<i32, f64>;
type Expression = FlatEx<Value, Operators, ValMatcher>;

/// The evaluator's operators with the usual precedence: comparisons before `&&` before `||`. By default it joins
/// conditions before it compares them.
#[derive(Clone, Debug)]
struct Operators;

impl MakeOperators<Value> for Operators {
    fn make<'a>() -> Vec<Operator<'a, Value>> {
        let bound = |operator: Operator<'a, Value>| {
            let Ok(BinOp { apply, prio, is_commutative }) = operator.bin() else { return operator };
            let prio = match operator.repr() {
                "||" => 11,
                "&&" => 12,
                "==" | "!=" | "<" | "<=" | ">" | ">=" => 15,
                _ => 10 * prio,
            };
            let bin = BinOp { apply, prio, is_commutative };
            match operator.unary() {
                Ok(unary) => Operator::make_bin_unary(operator.repr(), bin, unary),
                Err(_) => Operator::make_bin(operator.repr(), bin),
            }
        };
        ValOpsFactory::<i32, f64>::make().into_iter().map(bound).collect()
    }
}

/// A condition that every variant must fulfil.
#[derive(Clone, Debug)]
pub struct Constraint {
    /// As written.
    text: String,
    /// Why, as the sweep says.
    because: Option<String>,
    expression: Arc<Expression>,
    /// The names in it, in the order in which the expression wants their values.
    names: Vec<String>,
}

impl Constraint {
    /// Reads an expression such as `shell.outer_radius_mm - shell.wall_mm >= 12 && friction_n > 4`.
    ///
    /// # Errors
    /// [`ConfigError`] for an unknown name, or what is no expression.
    pub fn new(text: &str, because: Option<String>) -> Result<Self, ConfigError> {
        let known = names();
        let (braced, unknown) = brace_names(text, &known);
        if let Some(name) = unknown {
            let near = known
                .iter()
                .max_by(|a, b| strsim::jaro_winkler(&name, a).total_cmp(&strsim::jaro_winkler(&name, b)));
            return Err(config_error(
                "constraints.require",
                Some(&format!("{text:?}")),
                &format!("has the unknown name {name:?}"),
                &format!(
                    "did you mean {:?}? Fields with numbers, derived dimensions, {} are known",
                    near.map_or("", |n| n),
                    PREDICTED.join(", ")
                ),
            ));
        }
        let refused = |problem: &str| {
            config_error(
                "constraints.require",
                Some(&format!("{text:?}")),
                problem,
                "write a comparison such as \"shell.outer_radius_mm - shell.wall_mm >= 12\"",
            )
        };
        let expression =
            Expression::parse(&braced).map_err(|e| refused(&format!("is no expression: {e}")))?;
        let names = expression.var_names().to_vec();
        // An expression that is no condition is refused before any variant is made: its type does not depend on the values.
        let ones = vec![Val::Float(1.0); names.len()];
        match expression.eval(&ones) {
            Ok(Val::Bool(_)) => {}
            _ => return Err(refused("is no condition that is true or false")),
        }
        Ok(Self { text: text.to_owned(), because, expression: Arc::new(expression), names })
    }

    /// Why `design` is refused; `None` if it fulfils the condition. A value that does not exist, such as the threshold
    /// of a switch that does not switch, fulfils nothing.
    pub fn refusal(&self, design: &Design, curve: &FrictionCurve) -> Option<String> {
        let values: Vec<_> = self.names.iter().map(|name| quantity(name, design, curve)).collect();
        let known = values.iter().map(|v| Val::Float(v.unwrap_or(f64::NAN))).collect::<Vec<_>>();
        if let Ok(Val::Bool(true)) = self.expression.eval(&known) {
            return None;
        }
        let shown: Vec<_> = self
            .names
            .iter()
            .zip(&values)
            .map(|(name, value)| match value {
                Some(value) => format!("{name} = {}", (value * 1e6).round() / 1e6),
                None => format!("there is no {name}"),
            })
            .collect();
        let because = self.because.as_ref().map(|b| format!(", {b}")).unwrap_or_default();
        Some(format!("constraint {:?} is not met: {}{because}", self.text, shown.join(", ")))
    }
}

/// All names that an expression may use.
fn names() -> Vec<String> {
    let fields = Configuration::PARAMETERS
        .iter()
        .filter(|p| {
            matches!(
                (p.get)(&Configuration::default()),
                toml_edit::Value::Integer(_) | toml_edit::Value::Float(_)
            )
        })
        .map(|p| p.path());
    let design = Design::new(Configuration::default());
    let dimensions = design.iter().flat_map(derived).map(|d| format!("{}_{}", d.name, d.unit));
    fields.chain(dimensions).chain(PREDICTED.map(str::to_owned)).collect()
}

fn quantity(name: &str, design: &Design, curve: &FrictionCurve) -> Option<f64> {
    match name {
        #[allow(clippy::cast_precision_loss)]
        "pin_count" => return Some(design.configuration().layout.pins.len() as f64),
        "friction_n" => return curve.friction_n.last().copied(),
        "band_low_n" => return curve.band_low_n.last().copied(),
        "band_high_n" => return curve.band_high_n.last().copied(),
        "threshold_n" => return Transition::of(curve).map(|t| t.threshold_n),
        _ => {}
    }
    if let Some(parameter) = Configuration::PARAMETERS.iter().find(|p| p.path() == name) {
        let value = (parameter.get)(design.configuration());
        #[allow(clippy::cast_precision_loss)]
        return value.as_float().or_else(|| value.as_integer().map(|i| i as f64));
    }
    derived(design).into_iter().find(|d| format!("{}_{}", d.name, d.unit) == name).map(|d| d.value)
}

/// `text` with every known name in braces, as the evaluator wants names with dots; and the first unknown name.
fn brace_names(text: &str, known: &[String]) -> (String, Option<String>) {
    const FUNCTIONS: [&str; 13] =
        ["abs", "sqrt", "min", "max", "round", "floor", "ceil", "exp", "ln", "sin", "cos", "if", "else"];
    let mut out = String::new();
    let mut unknown = None;
    let mut rest = text;
    while let Some(first) = rest.chars().next() {
        let word = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '.';
        if !word(first) {
            out.push(first);
            rest = &rest[first.len_utf8()..];
            continue;
        }
        let (token, after) = rest.split_at(rest.find(|c| !word(c)).unwrap_or(rest.len()));
        if known.iter().any(|k| k == token) {
            out += &format!("{{{token}}}");
        } else {
            if first.is_ascii_alphabetic() && !FUNCTIONS.contains(&token) {
                unknown.get_or_insert_with(|| token.to_owned());
            }
            out += token;
        }
        rest = after;
    }
    (out, unknown)
}

#[cfg(test)]
mod tests {
    use super::*;
    use pinswitch_switch::config::assign;
    use pinswitch_switch::prediction::predicted_curve;

    fn refusal(text: &str) -> Option<String> {
        let mut c = Configuration::default();
        assign(&mut c, "layout.pins=[5, 8, 11]").unwrap();
        let design = Design::new(c).unwrap();
        let curve = predicted_curve(&design);
        Constraint::new(text, Some("the mandrel".to_owned())).unwrap().refusal(&design, &curve)
    }

    #[test]
    fn conditions_range_over_fields_dimensions_and_friction() {
        for met in [
            "shell.outer_radius_mm - shell.wall_mm >= 11.5",
            "contact_radius_mm == 22 && pin_count == 3",
            "friction_n > 8.9 && friction_n < 9.1",
            "threshold_n > 20 || 1 > 2",
            "1 > 2 && 1 > 2 || shell.wall_mm < 9",
            "-shell.wall_mm + 2 * 4.25 == 0",
            "max(shell.wall_mm, 3) <= 8.5",
        ] {
            assert_eq!(refusal(met), None, "{met}");
        }
        let text = refusal("shell.wall_mm + 1 > 9.5 && pin_count < 9").unwrap();
        assert_eq!(
            text,
            "constraint \"shell.wall_mm + 1 > 9.5 && pin_count < 9\" is not met: pin_count = 3, shell.wall_mm = 8.5, the mandrel"
        );
    }

    #[test]
    fn bad_expressions_are_refused_before_anything_is_made() {
        for (text, expected) in [
            ("shell.with_mm > 3", "has the unknown name \"shell.with_mm\"; did you mean \"shell.width_mm\"?"),
            ("shell.width_mm >", "is no expression"),
            ("shell.width_mm + 1", "is no condition that is true or false"),
        ] {
            let error = Constraint::new(text, None).unwrap_err().to_string();
            assert!(error.contains(expected), "{error}");
        }
    }
}
