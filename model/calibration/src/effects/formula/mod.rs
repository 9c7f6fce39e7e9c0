//! Formulas of effects, built-in and user-defined: the language's names, what a formula changes, and its place in the forward
//! model.

mod built_in;
mod expression;
mod variable;
mod written;

pub use built_in::FormulaEffect;
pub(super) use expression::{EffectFormula, Symbol};
pub(super) use variable::{Moment, TENSION, VARIABLES, variable};
pub(super) use written::stage;
pub use written::{ActsOn, Combine, Written};

use super::ContactState;
use crate::table::{Condition, Point};

/// A compiled formula with the quantity that it changes.
#[derive(Clone, Debug, PartialEq)]
pub struct AppliedFormula {
    acts_on: ActsOn,
    combine: Combine,
    formula: EffectFormula,
}

impl AppliedFormula {
    pub(super) fn new(acts_on: ActsOn, combine: Combine, formula: EffectFormula) -> Self {
        Self { acts_on, combine, formula }
    }

    pub(super) fn formula(&self) -> &EffectFormula {
        &self.formula
    }

    /// Returns whether it acts on the contact, and not on the tension or the reading.
    pub(crate) fn acts_on_contact(&self) -> bool {
        !self.acts_on.knows_tension()
    }

    /// Returns the value of a formula that acts on the contact; `load_n` is the load in newtons after effects on it.
    pub(crate) fn value_on_contact(
        &self,
        k: &[f64],
        point: &Point,
        condition: &Condition,
        load_n: f64,
    ) -> f64 {
        self.formula.value(k, &Moment { point, condition, load_n, tension_n: f64::NAN })
    }

    /// Changes the contact by the value of the formula.
    pub(crate) fn apply_to_contact(&self, value: f64, state: &mut ContactState) {
        written::on_contact(self.acts_on, self.combine, value, state);
    }

    /// Changes the contact, if the formula acts there; `k` are the constants.
    pub(super) fn on_contact(
        &self,
        k: &[f64],
        point: &Point,
        condition: &Condition,
        state: &mut ContactState,
    ) {
        if self.acts_on_contact() {
            self.apply_to_contact(self.value_on_contact(k, point, condition, state.load_n), state);
        }
    }

    /// Changes a tension in newtons before the load cell, if the formula acts there.
    pub(super) fn on_tension(&self, k: &[f64], point: &Point, condition: &Condition, tension_n: f64) -> f64 {
        self.changed(ActsOn::Tension, k, Moment { point, condition, load_n: point.load_n, tension_n })
    }

    /// Changes a reading in newtons, if the formula acts there.
    pub(super) fn on_reading(&self, k: &[f64], point: &Point, condition: &Condition, reading_n: f64) -> f64 {
        let moment = Moment { point, condition, load_n: point.load_n, tension_n: reading_n };
        self.changed(ActsOn::Reading, k, moment)
    }

    /// Returns the tension of a moment, changed if the formula acts on this quantity.
    fn changed(&self, quantity: ActsOn, k: &[f64], moment: Moment<'_>) -> f64 {
        if self.acts_on == quantity {
            self.combine.applied(moment.tension_n, self.formula.value(k, &moment))
        } else {
            moment.tension_n
        }
    }
}
