//! `wear_drift`: friction drifts with all the travel since the session began.

use super::{ContactState, Covariate, Effect, Parameter, Side};
use crate::table::{Condition, Frame, Point};

/// mu (1 + k g(u)), u share of all repetitions, g(u) = u or (1 - exp(-u/t))/(1 - exp(-1/t)) (effects.md)
#[derive(Debug)]
pub(super) struct WearDrift;

impl Effect for WearDrift {
    fn id(&self) -> &'static str {
        "wear_drift"
    }

    fn side(&self) -> Side {
        Side::Switch
    }

    fn covariate(&self) -> Covariate {
        Covariate::Time
    }

    fn formula(&self) -> &'static str {
        "mu (1 + k g(u)), u share of all repetitions, g(u) = u or (1 - exp(-u/t))/(1 - exp(-1/t)) (effects.md)"
    }

    fn parameters(&self) -> &'static [Parameter] {
        const { &[Parameter::free("k", "1"), Parameter::bounded("t", "1", 0.08, 3.0)] }
    }

    fn starts(&self, _frame: &Frame) -> Vec<Vec<f64>> {
        vec![vec![0.1, 0.15], vec![0.1, 0.4], vec![0.1, 2.0]]
    }

    fn confused_with(&self) -> &'static [&'static str] {
        &["thermal_drift"]
    }

    fn experiment(&self) -> &'static str {
        "repeat the first series at the end of the session"
    }

    fn invisible_because(&self) -> &'static str {
        "the session is too short to drift"
    }

    fn on_contact(&self, k: &[f64], point: &Point, _: &Condition, state: &mut ContactState) {
        let settled = -(-1.0 / k[1]).exp_m1();
        let factor = (1.0 + k[0] * -(-point.travel / k[1]).exp_m1() / settled).max(0.0);
        state.mu_pins *= factor;
        state.mu_silicone *= factor;
        state.extra_exponent_pins *= factor;
    }
}
