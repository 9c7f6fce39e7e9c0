//! Constraints: conditions on a variant's parameters, its derived dimensions and its predicted
//! friction.

use std::cell::RefCell;
use std::fmt;
use std::ops::Range;
use std::sync::Arc;

use pinswitch_diagnostic::codes;
use pinswitch_formula::{Condition, FormulaError, Kind, NameError, Node, Operator, Type, nearest};
use pinswitch_friction::{FrictionCurve, Transition};

use super::axis::is_whole;
use pinswitch_switch::config::Configuration;
use pinswitch_switch::design::Design;
use pinswitch_switch::documents::derived;

/// Names in addition to fields and derived dimensions.
const PREDICTED: [&str; 5] = ["pin_count", "friction_n", "band_low_n", "band_high_n", "threshold_n"];

/// A condition that every variant of a sweep must meet.
#[derive(Clone, Debug)]
pub struct Constraint {
    /// As written.
    text: String,
    /// The reason, as written in the sweep.
    because: Option<String>,
    /// Names are indices of `quantities`.
    condition: Arc<Condition<usize>>,
    /// The names of the quantities in the condition.
    quantities: Vec<String>,
}

/// A constraint that a variant does not meet.
#[derive(Clone, Debug, PartialEq)]
pub struct Violation {
    /// The constraint, as written.
    pub constraint: String,
    /// The quantities in it with their values, in alphabetical order; `None` for a value that does
    /// not exist.
    pub values: Vec<(String, Option<f64>)>,
    /// The reason of the constraint, as written in the sweep.
    pub because: Option<String>,
}

impl Constraint {
    /// Parses a condition such as `shell.outer_radius_mm - shell.wall_mm >= 12 && friction_n > 4`,
    /// in the language of [`pinswitch_formula`].
    ///
    /// # Errors
    /// An unknown name, a text that is not a condition, and a part that is not finite for any variant.
    pub fn new(text: &str, because: Option<String>) -> Result<Self, FormulaError> {
        let known = names();
        let mut quantities: Vec<String> = Vec::new();
        let resolve = |name: &str| {
            if let Some(index) = quantities.iter().position(|quantity| quantity == name) {
                return Ok(index);
            }
            if !known.iter().any(|k| k == name) {
                return Err(unknown_name(name, &known));
            }
            quantities.push(name.to_owned());
            Ok(quantities.len() - 1)
        };
        let condition = Arc::new(Condition::parse(text, resolve)?);
        if let Some(place) = first_infinite(condition.root()) {
            return Err(FormulaError::new(codes::FORMULA_NOT_FINITE, place, "not a finite number")
                .with_help("divide by a quantity or a number other than 0"));
        }
        Ok(Self { text: text.to_owned(), because, condition, quantities })
    }

    /// Returns why `design` does not meet the condition; `None` if it does.
    ///
    /// A condition that depends on a value that does not exist, such as the threshold of a switch
    /// that does not switch, is not met.
    pub fn violation(&self, design: &Design, curve: &FrictionCurve) -> Option<Violation> {
        let values: Vec<Option<f64>> =
            self.quantities.iter().map(|name| value(name, design, curve)).collect();
        let read = |index: &usize| values.get(*index).copied().flatten().unwrap_or(f64::NAN);
        if self.condition.truth(read) == Some(true) {
            return None;
        }
        let mut values: Vec<_> = self.quantities.iter().cloned().zip(values).collect();
        values.sort_by(|a, b| a.0.cmp(&b.0));
        Some(Violation { constraint: self.text.clone(), values, because: self.because.clone() })
    }
}

impl fmt::Display for Violation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "constraint {:?} is not met", self.constraint)?;
        let mut separator = ": ";
        for (name, value) in &self.values {
            match value {
                Some(value) => write!(f, "{separator}{name} = {}", (value * 1e6).round() / 1e6)?,
                None => write!(f, "{separator}{name} does not exist")?,
            }
            separator = ", ";
        }
        match &self.because {
            Some(because) => write!(f, "{separator}{because}"),
            None => Ok(()),
        }
    }
}

/// Returns all names that a constraint can use: numeric fields, derived dimensions with their unit,
/// and [`PREDICTED`].
fn names() -> Vec<String> {
    let fields = Configuration::PARAMETERS.iter().filter(|p| is_whole(p).is_some()).map(|p| p.path());
    let design = Design::new(Configuration::default());
    let dimensions = design.iter().flat_map(derived).map(|d| format!("{}_{}", d.name, d.unit));
    fields.chain(dimensions).chain(PREDICTED.map(str::to_owned)).collect()
}

/// Returns the first part of a condition that is not finite, whatever the values of its quantities.
fn first_infinite<N>(root: &Node<N>) -> Option<Range<usize>> {
    let is_infinite = |node: &Node<N>| match node.kind() {
        Kind::Binary(Operator::Divide, _, divisor) if divisor.constant() == Some(0.0) => true,
        _ => node.ty() == Type::Number && node.constant().is_some_and(|value| !value.is_finite()),
    };
    let place = RefCell::new(None);
    root.any(&|node| {
        let is_first = is_infinite(node);
        if is_first {
            *place.borrow_mut() = Some(node.extent());
        }
        is_first
    });
    place.into_inner()
}

fn unknown_name(name: &str, known: &[String]) -> NameError {
    let error = NameError::new(
        codes::UNKNOWN_NAME,
        format!("unknown name '{}'", pinswitch_diagnostic::excerpt(name, 40)),
    );
    error.with_help(match nearest(name, known.iter().map(String::as_str)) {
        Some(near) => format!("did you mean {near}?"),
        None => format!("use numeric fields, derived dimensions with their unit, {}", PREDICTED.join(", ")),
    })
}

/// Returns the value of a quantity; `None` where the design has none.
fn value(name: &str, design: &Design, curve: &FrictionCurve) -> Option<f64> {
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

#[cfg(test)]
mod tests {
    use super::*;
    use pinswitch_switch::config::assign;
    use pinswitch_switch::prediction::predicted_curve;

    fn design(assignments: &[&str]) -> (Design, FrictionCurve) {
        let mut configuration = Configuration::default();
        assignments.iter().for_each(|a| assign(&mut configuration, a).unwrap());
        let design = Design::new(configuration).unwrap();
        let curve = predicted_curve(&design);
        (design, curve)
    }

    /// A switch without pins, one with three, the same without a threshold in its loads, and a
    /// large one.
    fn designs() -> [(Design, FrictionCurve); 4] {
        let five_pins =
            ["layout.pins=[4, 6, 8, 10, 12]", "shell.outer_radius_mm=24", "silicone.thickness_mm=2.5"];
        [
            design(&[]),
            design(&["layout.pins=[5, 8, 11]"]),
            design(&["layout.pins=[5, 8, 11]", "friction.load_max_n=8"]),
            design(&five_pins),
        ]
    }

    /// Which of [`designs`] meet the constraint, as `T` and `F`.
    fn met(text: &str) -> String {
        let constraint = Constraint::new(text, None).unwrap();
        let is_met =
            |(design, curve): &(Design, FrictionCurve)| constraint.violation(design, curve).is_none();
        designs().iter().map(|d| if is_met(d) { 'T' } else { 'F' }).collect()
    }

    /// Every constraint of the documents, examples and tests, with the results of an independent
    /// evaluator (exmex 0.21).
    #[test]
    fn results_equal_those_of_exmex() {
        for (text, expected) in [
            ("shell.outer_radius_mm - shell.wall_mm >= 12 && friction_n > 4", "FFFT"),
            ("contact_radius_mm + support.rise_mm <= 28.5", "TTTF"),
            ("shell.width_mm >= 14 || tendon.length_mm > 0", "TTTT"),
            ("land_on_shell_mm >= 1.0", "TTTT"),
            ("shell.width_mm > 10", "TTTT"),
            ("threshold_n > 5", "FTFT"),
            ("shell.outer_radius_mm - shell.wall_mm >= 11.5", "TTTT"),
            ("contact_radius_mm == 22 && pin_count == 3", "FTTF"),
            ("friction_n > 8.9 && friction_n < 9.1", "FTFF"),
            ("threshold_n > 20 || 1 > 2", "FTFT"),
            ("1 > 2 && 1 > 2 || shell.wall_mm < 9", "TTTT"),
            ("-shell.wall_mm + 2 * 4.25 == 0", "TTTT"),
            ("max(shell.wall_mm, 3) <= 8.5", "TTTT"),
            ("shell.wall_mm + 1 > 9.5 && pin_count < 9", "FFFF"),
            ("min(pin_count, 4) != 3", "TFFT"),
            ("round(threshold_n) >= 24", "FTFT"),
            ("floor(friction_n) == 8 || ceil(friction_n) == 9", "FTFF"),
            ("abs(contact_radius_mm - 22) < 0.5", "TTTF"),
            ("sqrt(friction_n) > 2.5 && exp(0.0) == 1 && ln(1.0) == 0", "TTFT"),
            ("sin(0.0) == 0 && cos(0.0) == 1 && 8/4/2 == 1 && 7 - 2 - 1 == 4", "TTTT"),
            ("2^3 == 8 && shell.wall_mm^2 > 70", "TTTT"),
            ("threshold_n > 20 || pin_count == 3", "FTTT"),
            ("threshold_n <= 20 || pin_count != 3", "TFFT"),
            ("pin_count == 3 || pin_count == 0 && friction_n < 1", "FTTF"),
            ("(pin_count == 3 || pin_count == 0) && friction_n < 5", "FFTF"),
            ("band_high_n - band_low_n < 0.5 * friction_n", "TTFF"),
            ("(pin_count > 0) == (friction_n > 1)", "FTFT"),
        ] {
            assert_eq!(met(text), expected, "{text}");
        }
    }

    #[test]
    fn missing_values_meet_no_condition() {
        let (design, curve) = &designs()[2];
        for text in ["threshold_n > 0", "threshold_n != 3", "!(threshold_n > 20)"] {
            let constraint = Constraint::new(text, None).unwrap();
            assert!(constraint.violation(design, curve).is_some(), "{text}");
        }
        let violation = Constraint::new("threshold_n > 20", None).unwrap().violation(design, curve);
        let text = violation.map(|v| v.to_string());
        assert_eq!(
            text.as_deref(),
            Some("constraint \"threshold_n > 20\" is not met: threshold_n does not exist")
        );
    }

    #[test]
    fn violations_list_values_and_reason() {
        let (design, curve) = &designs()[1];
        let text = "shell.wall_mm + 1 > 9.5 && pin_count < 9";
        let constraint = Constraint::new(text, Some("the mandrel".to_owned())).unwrap();
        let violation = constraint.violation(design, curve).unwrap();
        assert_eq!(
            violation.to_string(),
            "constraint \"shell.wall_mm + 1 > 9.5 && pin_count < 9\" is not met: pin_count = 3, shell.wall_mm = 8.5, the mandrel"
        );
    }

    #[test]
    fn invalid_constraints_are_located() {
        for (text, marked, expected) in [
            (
                "shell.with_mm > 3",
                "shell.with_mm",
                "unknown name 'shell.with_mm'; did you mean shell.width_mm?",
            ),
            ("friction.max_n >", "friction.max_n", "unknown name 'friction.max_n'"),
            (
                "zzzzzzzzzzzz > 1",
                "zzzzzzzzzzzz",
                "use numeric fields, derived dimensions with their unit, pin_count",
            ),
            ("tendon.length_mm < 300 && true", "true", "unknown name 'true'"),
            ("label.text > 1", "label.text", "unknown name"),
            ("shell.width_mm >", "", "expected a number, a name or '(', found the end"),
            ("pin_count > 2 &&", "", "found the end; add the operand after '&&', or remove '&&'"),
            ("pin_count <= shell.width_mm/0", "shell.width_mm/0", "not a finite number; divide by "),
            ("pin_count <= shell.width_mm/(2 - 2)", "shell.width_mm/(2 - 2)", "not a finite number"),
            ("pin_count > 2 || ln(0) < 1", "ln(0)", "not a finite number"),
            ("shell.width_mm + 1", "shell.width_mm + 1", "expected a condition, found a number"),
            ("pin_count > 2 || 3", "3", "'||' needs a condition, found a number"),
            ("1 < pin_count < 9", "<", "comparisons cannot be chained"),
            ("", "", "expected a number"),
        ] {
            let error = Constraint::new(text, None).unwrap_err();
            assert!(error.to_string().contains(expected), "{error}");
            assert_eq!(&text[error.span()], marked, "{text}");
        }
    }

    #[test]
    fn every_name_can_be_used() {
        for name in names() {
            assert!(Constraint::new(&format!("{name} > 0"), None).is_ok(), "{name}");
        }
    }
}
