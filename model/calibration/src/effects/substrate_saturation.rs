//! `substrate_saturation`: the friction of the silicone is bounded, its coefficient falls with load.

use super::REFERENCE_LOAD_N;
use super::{ContactState, Covariate, Effect, Parameter, Side};
use crate::table::{Condition, Frame, Point};

/// mu_s (F/F0)^(n-1) blended with mu_s/(1 + k F/F0) by the shape h in 0..1 (effects.md)
#[derive(Debug)]
pub(super) struct SubstrateSaturation;

impl Effect for SubstrateSaturation {
    fn id(&self) -> &'static str {
        "substrate_saturation"
    }

    fn side(&self) -> Side {
        Side::Switch
    }

    fn covariate(&self) -> Covariate {
        Covariate::Load
    }

    fn formula(&self) -> &'static str {
        "mu_s (F/F0)^(n-1) blended with mu_s/(1 + k F/F0) by the shape h in 0..1 (effects.md)"
    }

    fn parameters(&self) -> &'static [Parameter] {
        const { &[Parameter::free("k", "1"), Parameter::bounded("h", "1", -0.02, 1.02)] }
    }

    // One sign: the friction of a soft contact falls behind load.
    fn one_sided(&self) -> bool {
        true
    }

    fn starts(&self, _frame: &Frame) -> Vec<Vec<f64>> {
        vec![vec![0.15, 0.05], vec![0.15, 0.5], vec![0.15, 0.95]]
    }

    fn confused_with(&self) -> &'static [&'static str] {
        &["rate_dependence", "fixture_compliance"]
    }

    fn experiment(&self) -> &'static str {
        "several loads at one speed"
    }

    fn invisible_because(&self) -> &'static str {
        "no silicone, or only one load"
    }

    fn on_contact(&self, k: &[f64], _: &Point, _: &Condition, state: &mut ContactState) {
        let f = (state.load_n / REFERENCE_LOAD_N).max(1e-3);
        // h = 0: the power law with n = 1 - k; h = 1: the hyperbola. Between them the exponents add.
        let power = f.powf(-k[0] * (1.0 - k[1]));
        let hyperbola = 1.0 / (1.0 + k[0] * k[1] * f).max(0.05);
        state.mu_silicone *= power * hyperbola;
    }
}
