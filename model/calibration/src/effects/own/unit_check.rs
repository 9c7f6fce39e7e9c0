//! Unit check of formulas: operands of sums and comparisons have equal units, arguments of
//! functions have none.
//!
//! A bare number that is added, compared or divided has the unit that makes the formula consistent,
//! as in `load_n/50` or `speed_pct > 50`; a number that multiplies has none. The unit of such a
//! number is an unknown of linear equations between powers of units, which are solved one by one
//! (Kennedy, Types for units-of-measure, 2010).

use std::ops::Range;

use pinswitch_diagnostic::{Diagnostic, codes};
use pinswitch_formula::{FormulaError, Function, Kind, Operator};

use super::unit::Unit;
use crate::effects::formula::Symbol;

type Node = pinswitch_formula::Node<Symbol>;

/// Returns the error for a diagnostic about these bytes of the formula.
pub(super) fn located(span: Range<usize>, diagnostic: &Diagnostic) -> FormulaError {
    let error = FormulaError::new(diagnostic.code(), span, diagnostic.problem());
    match diagnostic.help() {
        Some(help) => error.with_help(help),
        None => error,
    }
}

/// A unit that may depend on unknown units: a known unit times powers of unknown ones.
#[derive(Clone, Debug)]
struct Quantity {
    known: Unit,
    unknown: Vec<(usize, f64)>,
}

/// Powers smaller than this are zero.
const ZERO: f64 = 1e-9;

impl Quantity {
    fn known(known: Unit) -> Self {
        Self { known, unknown: Vec::new() }
    }

    fn times(&self, other: &Quantity, power: f64) -> Quantity {
        let mut product = Quantity { known: self.known.times(other.known, power), ..self.clone() };
        for (unknown, own) in &other.unknown {
            match product.unknown.iter_mut().find(|(u, _)| u == unknown) {
                Some((_, sum)) => *sum += power * own,
                None => product.unknown.push((*unknown, power * own)),
            }
        }
        product.unknown.retain(|(_, power)| power.abs() > ZERO);
        product
    }
}

/// Solved units of bare numbers.
#[derive(Default)]
struct Solver {
    solved: Vec<Option<Quantity>>,
}

/// Checks a formula whose constants have these units; the formula must have the unit `needed`.
/// `what` names its use.
///
/// # Errors
/// The first inconsistency.
pub(super) fn check_units(
    formula: &Node,
    constants: &[Unit],
    needed: Unit,
    what: &str,
) -> Result<(), FormulaError> {
    let mut solver = Solver::default();
    let unit = solver.unit_of(formula, constants)?;
    if solver.equal(&unit, &Quantity::known(needed)) {
        return Ok(());
    }
    let unit = solver.shown(&unit);
    let problem = format!("the formula has unit {unit}, but {what} needs {needed}");
    Err(FormulaError::new(codes::FORMULA_UNITS, formula.extent(), problem)
        .with_help("divide by a reference, as in load_n/50, or give a constant another unit"))
}

impl Solver {
    /// Substitutes all solutions into a quantity. Solutions contain no solved unknowns.
    fn resolved(&self, quantity: &Quantity) -> Quantity {
        let mut result = Quantity::known(quantity.known);
        for (unknown, power) in &quantity.unknown {
            let one = Quantity { known: Unit::NONE, unknown: vec![(*unknown, 1.0)] };
            let value = self.solved.get(*unknown).and_then(Option::as_ref).unwrap_or(&one);
            result = result.times(value, *power);
        }
        result
    }

    fn shown(&self, quantity: &Quantity) -> String {
        self.resolved(quantity).known.to_string()
    }

    /// Equates two units by solving for an unknown. Returns whether that is possible.
    fn equal(&mut self, a: &Quantity, b: &Quantity) -> bool {
        let apart = self.resolved(&a.times(b, -1.0));
        let Some((unknown, power)) = apart.unknown.first().copied() else {
            return apart.known == Unit::NONE;
        };
        // known * unknown^power * rest = 1.
        let rest = Quantity { known: apart.known, unknown: apart.unknown[1..].to_vec() };
        self.solved[unknown] = Some(Quantity::known(Unit::NONE).times(&rest, -1.0 / power));
        let again: Vec<_> = self.solved.iter().map(|s| s.as_ref().map(|s| self.resolved(s))).collect();
        self.solved = again;
        true
    }

    /// Returns the unit of an operand, which is unknown for a bare number.
    fn operand(&mut self, node: &Node, constants: &[Unit]) -> Result<Quantity, FormulaError> {
        let bare = match node.kind() {
            Kind::Negated(inner) => matches!(inner.kind(), Kind::Number(_)),
            kind => matches!(kind, Kind::Number(_)),
        };
        if !bare {
            return self.unit_of(node, constants);
        }
        self.solved.push(None);
        Ok(Quantity { known: Unit::NONE, unknown: vec![(self.solved.len() - 1, 1.0)] })
    }

    fn dimensionless(
        &mut self,
        quantity: &Quantity,
        at: Range<usize>,
        what: &str,
    ) -> Result<(), FormulaError> {
        if self.equal(quantity, &Quantity::known(Unit::NONE)) {
            return Ok(());
        }
        let unit = self.shown(quantity);
        let problem = format!("{what} has unit {unit}, but must be dimensionless");
        Err(FormulaError::new(codes::FORMULA_UNITS, at, problem)
            .with_help("divide by a reference, as in load_n/50"))
    }

    fn unit_of(&mut self, node: &Node, constants: &[Unit]) -> Result<Quantity, FormulaError> {
        match node.kind() {
            Kind::Number(_) => Ok(Quantity::known(Unit::NONE)),
            Kind::Name(Symbol::Variable(variable)) => {
                Unit::parse(variable.unit).map(Quantity::known).map_err(|e| located(node.span(), &e))
            }
            Kind::Name(Symbol::Constant(place)) => {
                Ok(Quantity::known(constants.get(*place).copied().unwrap_or(Unit::NONE)))
            }
            Kind::Negated(a) | Kind::Not(a) => self.unit_of(a, constants),
            Kind::Call(function, a) => self.call(*function, a, constants),
            Kind::Binary(operator, a, b) => self.binary(*operator, node.span(), a, b, constants),
        }
    }

    fn call(&mut self, function: Function, a: &Node, constants: &[Unit]) -> Result<Quantity, FormulaError> {
        let unit = self.unit_of(a, constants)?;
        let none = Quantity::known(Unit::NONE);
        match function {
            Function::Abs => Ok(unit),
            Function::Sqrt => Ok(none.times(&unit, 0.5)),
            Function::Sin | Function::Cos if self.shown(&unit) == "rad" => Ok(none),
            Function::Exp
            | Function::Ln
            | Function::Tanh
            | Function::Sin
            | Function::Cos
            | Function::Round
            | Function::Floor
            | Function::Ceil => {
                let name = function.name();
                self.dimensionless(&unit, a.extent(), &format!("the argument of {name}"))?;
                Ok(none)
            }
        }
    }

    fn binary(
        &mut self,
        operator: Operator,
        at: Range<usize>,
        a: &Node,
        b: &Node,
        constants: &[Unit],
    ) -> Result<Quantity, FormulaError> {
        match operator {
            Operator::Multiply => Ok(self.unit_of(a, constants)?.times(&self.unit_of(b, constants)?, 1.0)),
            Operator::Divide => Ok(self.operand(a, constants)?.times(&self.operand(b, constants)?, -1.0)),
            Operator::Power => self.power(a, b, constants),
            Operator::And | Operator::Or => {
                self.unit_of(a, constants)?;
                self.unit_of(b, constants)
            }
            Operator::Add
            | Operator::Subtract
            | Operator::Min
            | Operator::Max
            | Operator::Less
            | Operator::LessOrEqual
            | Operator::Greater
            | Operator::GreaterOrEqual
            | Operator::Equal
            | Operator::NotEqual => {
                let (left, right) = (self.operand(a, constants)?, self.operand(b, constants)?);
                if !self.equal(&left, &right) {
                    let (left, right) = (self.shown(&left), self.shown(&right));
                    let problem = format!("the operands have different units, {left} and {right}");
                    return Err(FormulaError::new(codes::FORMULA_UNITS, at, problem)
                        .with_help("divide each by a reference"));
                }
                let joins =
                    matches!(operator, Operator::Add | Operator::Subtract | Operator::Min | Operator::Max);
                Ok(if joins { left } else { Quantity::known(Unit::NONE) })
            }
        }
    }

    /// Returns the unit of a power. Unless the exponent is a number, base and exponent must be
    /// dimensionless.
    fn power(&mut self, a: &Node, b: &Node, constants: &[Unit]) -> Result<Quantity, FormulaError> {
        let base = self.unit_of(a, constants)?;
        let none = Quantity::known(Unit::NONE);
        if let Some(power) = b.constant().filter(|power| power.is_finite()) {
            return Ok(none.times(&base, power));
        }
        self.dimensionless(&base, a.extent(), "the base of a variable power")?;
        let exponent = self.unit_of(b, constants)?;
        self.dimensionless(&exponent, b.extent(), "the exponent")?;
        Ok(none)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::formula::EffectFormula;

    /// Checks a formula with constants `k` (1), `f` (N), `p` (N^-0.5), `w` (%).
    fn check(text: &str, needed: &str) -> Result<(), FormulaError> {
        let formula = EffectFormula::parse(text, &["k", "f", "p", "w"], true)?;
        let units = ["1", "N", "N^-0.5", "%"].map(|u| Unit::parse(u).unwrap());
        check_units(formula.root(), &units, Unit::parse(needed).unwrap(), "it")
    }

    #[test]
    fn consistent_units_are_accepted() {
        for (text, needed) in [
            ("-k * exp(-((speed_pct - 52)/w)^2)", "1"),
            ("k*(load_n/50)^k", "1"),
            ("k*ln(speed_pct/50)", "1"),
            ("p*sqrt(load_n)", "1"),
            ("p^2*load_n", "1"),
            ("f*direction", "N"),
            ("k*load_n", "N"),
            ("k*turn_per_pin_rad/0.349", "1"),
            ("k*sin(turn_per_pin_rad) + k*sin(6.28*stroke)", "1"),
            ("k*(load_n > 20)*(speed_pct <= 50)", "1"),
            ("k*max(load_n/50, 0.001)^(-k)", "1"),
            ("k*(load_n - previous_load_n)/50*exp(-repetitions_so_far/20)", "1"),
            ("k*exp(-50/load_n)", "1"),
            ("k*(load_n^2/2500)", "1"),
            ("k*tanh((load_n - 20)/f)", "1"),
            ("k*(load_n < f)*-1", "1"),
            ("k*(load_n > 20 && !(speed_pct > 52) or stroke > 0.5)", "1"),
            ("k*floor(load_n/10)", "1"),
        ] {
            assert_eq!(check(text, needed), Ok(()), "{text}");
        }
    }

    #[test]
    fn inconsistent_units_are_located() {
        for (text, needed, marked, part) in [
            ("k*load_n", "1", "k*load_n", "the formula has unit N, but it needs 1"),
            ("f", "1", "f", "the formula has unit N"),
            ("k*(load_n + speed_pct)", "N", "+", "different units, N and %"),
            ("k*exp(load_n)", "1", "load_n", "the argument of exp has unit N"),
            ("k*ln(load_n + 3)", "1", "load_n + 3", "the argument of ln has unit N"),
            ("k*(load_n > speed_pct)", "1", ">", "different units, N and %"),
            ("k*(time > 1 && load_n > speed_pct)", "1", ">", "different units, N and %"),
            ("k*round(load_n)", "1", "load_n", "the argument of round has unit N"),
            ("k*load_n^k", "1", "load_n", "the base of a variable power has unit N"),
            ("k*2^load_n", "1", "load_n", "the exponent has unit N"),
            ("k*(load_n/50 + load_n)", "1", "k*(load_n/50 + load_n)", "the formula has unit N"),
        ] {
            let error = check(text, needed).unwrap_err();
            assert!(error.problem().contains(part), "{text}: {error:?}");
            assert_eq!(&text[error.span()], marked, "{text}: {error:?}");
        }
    }
}
