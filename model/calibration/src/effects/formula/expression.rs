//! Formulas of effects: what their names mean, and their values in a row.

use pinswitch_diagnostic::codes;
use pinswitch_formula::{Formula, FormulaError, Kind, NameError, Node};

use super::variable::{Moment, TENSION, VARIABLES, Variable, variable};

/// What a name in a formula means.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::effects) enum Symbol {
    Variable(&'static Variable),
    /// A constant of the effect, by its index.
    Constant(usize),
}

/// The formula of an effect, parsed once and evaluated for each row.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::effects) struct EffectFormula(Formula<Symbol>);

impl EffectFormula {
    /// Parses a formula whose constants have these names. `knows_tension` allows the variable `tension_n`.
    ///
    /// # Errors
    /// The first [`FormulaError`].
    pub(in crate::effects) fn parse(
        text: &str,
        constants: &[&str],
        knows_tension: bool,
    ) -> Result<Self, FormulaError> {
        let resolve = |name: &str| {
            if let Some(index) = constants.iter().position(|constant| *constant == name) {
                return Ok(Symbol::Constant(index));
            }
            if name == TENSION && !knows_tension {
                let problem = "tension_n is known only where acts_on is \"tension\" or \"reading\"";
                return Err(NameError::new(codes::UNKNOWN_NAME, problem).with_help("use load_n"));
            }
            let known = constants.iter().copied().chain(VARIABLES.iter().map(|v| v.name));
            variable(name).map(Symbol::Variable).ok_or_else(|| NameError::unknown("variable", name, known))
        };
        Formula::parse(text, resolve).map(Self)
    }

    /// Returns its value in a row with these constants.
    pub(in crate::effects) fn value(&self, constants: &[f64], moment: &Moment<'_>) -> f64 {
        self.0.value(|symbol| match symbol {
            Symbol::Variable(variable) => (variable.of)(moment),
            Symbol::Constant(index) => constants.get(*index).copied().unwrap_or(f64::NAN),
        })
    }

    /// Returns its syntax tree.
    pub(in crate::effects) fn root(&self) -> &Node<Symbol> {
        self.0.root()
    }

    /// Returns whether it uses the constant with this index.
    pub(in crate::effects) fn has_constant(&self, index: usize) -> bool {
        self.root().any(&|node| *node.kind() == Kind::Name(Symbol::Constant(index)))
    }

    /// Returns whether it reads a variable that meets the condition.
    pub(in crate::effects) fn reads(&self, condition: impl Fn(&Variable) -> bool) -> bool {
        self.root()
            .any(&|node| matches!(node.kind(), Kind::Name(Symbol::Variable(variable)) if condition(variable)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tension_is_known_behind_the_contact_only() {
        assert!(EffectFormula::parse("tension_n", &[], true).is_ok());
        let error = EffectFormula::parse("1 + tension_n", &[], false).unwrap_err();
        assert_eq!((error.span(), error.help()), (4..13, Some("use load_n")));
    }

    #[test]
    fn constants_come_before_variables() {
        let formula = EffectFormula::parse("k*load_n + floor", &["k", "floor"], false).unwrap();
        assert!(formula.has_constant(1) && formula.reads(|v| v.name == "load_n"));
        let error = EffectFormula::parse("gibberish", &["k"], false).unwrap_err();
        assert!(error.help().is_some_and(|help| help.starts_with("use one of k, load_n, ")), "{error}");
    }
}
