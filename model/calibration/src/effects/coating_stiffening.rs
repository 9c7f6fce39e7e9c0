//! `coating_stiffening`: friction of the coating on the pins grows with load.

use super::REFERENCE_LOAD_N;
use super::{ContactState, Covariate, Effect, Parameter, Side};
use crate::table::{Condition, Frame, Point};

/// mu_p (1 + k (F/F0)^m), m in 1..2, F0 = 50 N (effects.md)
#[derive(Debug)]
pub(super) struct CoatingStiffening;

impl Effect for CoatingStiffening {
    fn id(&self) -> &'static str {
        "coating_stiffening"
    }

    fn side(&self) -> Side {
        Side::Switch
    }

    fn covariate(&self) -> Covariate {
        Covariate::Load
    }

    fn formula(&self) -> &'static str {
        "mu_p (1 + k (F/F0)^m), m in 1..2, F0 = 50 N (effects.md)"
    }

    fn parameters(&self) -> &'static [Parameter] {
        const { &[Parameter::free("k", "1"), Parameter::bounded("m", "1", 0.9, 2.1)] }
    }

    // One sign: the contact grows with load.
    fn one_sided(&self) -> bool {
        true
    }

    fn starts(&self, _frame: &Frame) -> Vec<Vec<f64>> {
        vec![vec![0.4, 1.05], vec![0.4, 1.5], vec![0.4, 1.95]]
    }

    fn confused_with(&self) -> &'static [&'static str] {
        &["polygon_bending", "coating_ploughing"]
    }

    fn experiment(&self) -> &'static str {
        "pins-only runs over load and pin count"
    }

    fn invisible_because(&self) -> &'static str {
        "no condition with pins, or only one load"
    }

    fn on_contact(&self, k: &[f64], _: &Point, _: &Condition, state: &mut ContactState) {
        state.mu_pins *= (1.0 + k[0] * (state.load_n / REFERENCE_LOAD_N).powf(k[1])).max(0.0);
    }
}
