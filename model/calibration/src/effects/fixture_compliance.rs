//! `fixture_compliance`: the wrap angle grows with load because the mount bends.

use super::REFERENCE_LOAD_N;
use super::{ContactState, Covariate, Effect, Parameter, Side};
use crate::table::{Condition, Frame, Point};

/// a (1 + k F/F0), every condition alike (effects.md)
#[derive(Debug)]
pub(super) struct FixtureCompliance;

impl Effect for FixtureCompliance {
    fn id(&self) -> &'static str {
        "fixture_compliance"
    }

    fn side(&self) -> Side {
        Side::Rig
    }

    fn covariate(&self) -> Covariate {
        Covariate::Load
    }

    fn formula(&self) -> &'static str {
        "a (1 + k F/F0), every condition alike (effects.md)"
    }

    fn parameters(&self) -> &'static [Parameter] {
        const { &[Parameter::free("k", "1")] }
    }

    fn starts(&self, _frame: &Frame) -> Vec<Vec<f64>> {
        vec![vec![0.05]]
    }

    fn confused_with(&self) -> &'static [&'static str] {
        &["rate_dependence", "substrate_saturation"]
    }

    fn experiment(&self) -> &'static str {
        "a dial gauge on the mount, or several speeds at one load"
    }

    fn invisible_because(&self) -> &'static str {
        "only one load"
    }

    fn on_contact(&self, k: &[f64], _: &Point, _: &Condition, state: &mut ContactState) {
        state.exponent_factor *= (1.0 + k[0] * state.load_n / REFERENCE_LOAD_N).max(0.0);
    }
}
