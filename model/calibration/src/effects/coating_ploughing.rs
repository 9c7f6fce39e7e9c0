//! `coating_ploughing`: the coating is ploughed by the force at each pin.

use super::{ContactState, Covariate, Effect, Parameter, Side};
use crate::table::{Condition, Frame, Point};

/// x_p + kappa sqrt(F) sum theta_i^1.5 (model.md 3)
#[derive(Debug)]
pub(super) struct CoatingPloughing;

impl Effect for CoatingPloughing {
    fn id(&self) -> &'static str {
        "coating_ploughing"
    }

    fn side(&self) -> Side {
        Side::Switch
    }

    fn covariate(&self) -> Covariate {
        Covariate::Load
    }

    fn formula(&self) -> &'static str {
        "x_p + kappa sqrt(F) sum theta_i^1.5 (model.md 3)"
    }

    fn parameters(&self) -> &'static [Parameter] {
        const { &[Parameter::free("kappa", "N^-0.5")] }
    }

    // One sign: ploughing only adds friction.
    fn one_sided(&self) -> bool {
        true
    }

    fn starts(&self, _frame: &Frame) -> Vec<Vec<f64>> {
        vec![vec![0.024]]
    }

    fn confused_with(&self) -> &'static [&'static str] {
        &["coating_stiffening", "polygon_bending"]
    }

    fn experiment(&self) -> &'static str {
        "pins-only runs over load and pin count"
    }

    fn invisible_because(&self) -> &'static str {
        "no condition with pins"
    }

    fn on_contact(&self, k: &[f64], _: &Point, condition: &Condition, state: &mut ContactState) {
        state.extra_exponent_pins += k[0] * state.load_n.sqrt() * condition.ploughing;
    }
}
