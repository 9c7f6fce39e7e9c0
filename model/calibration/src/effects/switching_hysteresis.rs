//! `switching_hysteresis`: the switching threshold differs between ascending and descending loads.

use super::{ContactState, Covariate, Effect, Parameter, Side};
use crate::table::{Condition, Frame, Point};

/// F_half(down) = F_half(up) - H (effects.md)
#[derive(Debug)]
pub(super) struct SwitchingHysteresis;

impl Effect for SwitchingHysteresis {
    fn id(&self) -> &'static str {
        "switching_hysteresis"
    }

    fn side(&self) -> Side {
        Side::Switch
    }

    fn covariate(&self) -> Covariate {
        Covariate::Sweep
    }

    fn formula(&self) -> &'static str {
        "F_half(down) = F_half(up) - H (effects.md)"
    }

    fn parameters(&self) -> &'static [Parameter] {
        const { &[Parameter::free("H", "N")] }
    }

    // One sign: the silicone recovers late.
    fn one_sided(&self) -> bool {
        true
    }

    fn starts(&self, _frame: &Frame) -> Vec<Vec<f64>> {
        vec![vec![4.0], vec![1.0]]
    }

    fn confused_with(&self) -> &'static [&'static str] {
        &["switch_local_tension"]
    }

    fn experiment(&self) -> &'static str {
        "a descending sweep of loads on a device"
    }

    fn invisible_because(&self) -> &'static str {
        "no device, or loads never descend"
    }

    fn on_contact(&self, k: &[f64], point: &Point, _: &Condition, state: &mut ContactState) {
        state.half_load_n = (state.half_load_n - k[0] * point.descending).max(1.0);
    }
}
