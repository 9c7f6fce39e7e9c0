//! Effects in Rust whose formula is all there is to their physics.

use std::sync::OnceLock;

use super::{AppliedFormula, EffectFormula, Written};
use crate::effects::{Description, Effect};
use crate::table::Frame;

/// An effect that its description defines: its formula is compiled at the first use, and applied like that of a user-defined
/// effect.
///
/// A text that is no formula gives predictions that are not numbers; a description without a formula
/// ([`Written::No`]) changes nothing.
#[derive(Debug)]
pub struct FormulaEffect {
    description: Description<'static>,
    typical: &'static [&'static [f64]],
    formula: OnceLock<Option<AppliedFormula>>,
}

impl FormulaEffect {
    /// Returns the effect of a description. `typical` are its typical constants, see [`Effect::typical`].
    pub const fn new(description: Description<'static>, typical: &'static [&'static [f64]]) -> Self {
        Self { description, typical, formula: OnceLock::new() }
    }

    fn compiled(&self) -> Option<AppliedFormula> {
        let Written::As { acts_on, combine, formula } = self.description.written else { return None };
        let constants: Vec<&str> = self.description.parameters.iter().map(|p| p.name.as_ref()).collect();
        let formula = EffectFormula::parse(formula, &constants, acts_on.knows_tension())
            .or_else(|_| EffectFormula::parse("0/0", &[], false));
        Some(AppliedFormula::new(acts_on, combine, formula.ok()?))
    }
}

impl Effect for FormulaEffect {
    fn description(&self) -> Description<'_> {
        self.description
    }

    fn typical(&self, _frame: &Frame) -> Vec<Vec<f64>> {
        self.typical.iter().map(|constants| constants.to_vec()).collect()
    }

    fn formula(&self) -> Option<&AppliedFormula> {
        self.formula.get_or_init(|| self.compiled()).as_ref()
    }
}
