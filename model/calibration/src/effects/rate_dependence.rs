//! `rate_dependence`: friction depends on the speed of the actuator.

use super::{ContactState, Covariate, Effect, Parameter, Side};
use crate::table::{Condition, Frame, Point};

/// mu (1 + k ln(v/v0)), v0 the geometric mean speed (effects.md)
#[derive(Debug)]
pub(super) struct RateDependence;

impl Effect for RateDependence {
    fn id(&self) -> &'static str {
        "rate_dependence"
    }

    fn side(&self) -> Side {
        Side::Switch
    }

    fn covariate(&self) -> Covariate {
        Covariate::Speed
    }

    fn formula(&self) -> &'static str {
        "mu (1 + k ln(v/v0)), v0 the geometric mean speed (effects.md)"
    }

    fn parameters(&self) -> &'static [Parameter] {
        const { &[Parameter::free("k", "1")] }
    }

    fn starts(&self, _frame: &Frame) -> Vec<Vec<f64>> {
        vec![vec![0.1]]
    }

    fn confused_with(&self) -> &'static [&'static str] {
        &["fixture_compliance", "substrate_saturation"]
    }

    fn experiment(&self) -> &'static str {
        "several speeds at one load"
    }

    fn invisible_because(&self) -> &'static str {
        "the speed never varies"
    }

    fn on_contact(&self, k: &[f64], point: &Point, _: &Condition, state: &mut ContactState) {
        let factor = (1.0 + k[0] * point.log_speed).max(0.0);
        state.mu_pins *= factor;
        state.mu_silicone *= factor;
        state.extra_exponent_pins *= factor;
    }
}
