//! `dwell_relaxation`: friction of the silicone depends on the pause before the reading.

use super::{ContactState, Covariate, Effect, Parameter, Side};
use crate::table::{Condition, Frame, Point};

/// mu_s (1 + k ln(dwell / 3 s)) (effects.md)
#[derive(Debug)]
pub(super) struct DwellRelaxation;

impl Effect for DwellRelaxation {
    fn id(&self) -> &'static str {
        "dwell_relaxation"
    }

    fn side(&self) -> Side {
        Side::Switch
    }

    fn covariate(&self) -> Covariate {
        Covariate::Dwell
    }

    fn formula(&self) -> &'static str {
        "mu_s (1 + k ln(dwell / 3 s)) (effects.md)"
    }

    fn parameters(&self) -> &'static [Parameter] {
        const { &[Parameter::free("k", "1")] }
    }

    fn starts(&self, _frame: &Frame) -> Vec<Vec<f64>> {
        vec![vec![0.05]]
    }

    fn confused_with(&self) -> &'static [&'static str] {
        &[]
    }

    fn experiment(&self) -> &'static str {
        "one silicone run with dwells of 0.3, 3 and 30 s"
    }

    fn invisible_because(&self) -> &'static str {
        "the dwell time never varies, or there is no silicone"
    }

    fn on_contact(&self, k: &[f64], point: &Point, _: &Condition, state: &mut ContactState) {
        state.mu_silicone *= (1.0 + k[0] * point.log_dwell).max(0.0);
    }
}
