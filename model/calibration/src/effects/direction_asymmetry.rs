//! `direction_asymmetry`: friction differs between eccentric and concentric.

use super::{ContactState, Covariate, Effect, Parameter, Side};
use crate::table::{Condition, Frame, Point};

/// x_c = x (1 + k/2), x_e = x (1 - k/2) (effects.md)
#[derive(Debug)]
pub(super) struct DirectionAsymmetry;

impl Effect for DirectionAsymmetry {
    fn id(&self) -> &'static str {
        "direction_asymmetry"
    }

    fn side(&self) -> Side {
        Side::Switch
    }

    fn covariate(&self) -> Covariate {
        Covariate::Direction
    }

    fn formula(&self) -> &'static str {
        "x_c = x (1 + k/2), x_e = x (1 - k/2) (effects.md)"
    }

    fn parameters(&self) -> &'static [Parameter] {
        const { &[Parameter::free("k", "1")] }
    }

    fn starts(&self, _frame: &Frame) -> Vec<Vec<f64>> {
        vec![vec![0.05]]
    }

    fn confused_with(&self) -> &'static [&'static str] {
        &["load_cell_gain"]
    }

    fn experiment(&self) -> &'static str {
        "silicone and pins-only runs at the same loads: a gain does not scale with friction"
    }

    fn invisible_because(&self) -> &'static str {
        "only one direction"
    }

    fn on_contact(&self, k: &[f64], point: &Point, _: &Condition, state: &mut ContactState) {
        state.exponent_factor *= (1.0 + point.sign * k[0] / 2.0).max(0.0);
    }
}
