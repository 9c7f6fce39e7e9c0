//! `switch_local_tension`: the switch follows the local tension over the wrap, not the load.

use super::{ContactState, Covariate, Effect, Parameter, Side};
use crate::table::{Condition, Frame, Point};

/// S(mean tension over the wrap) instead of S(F); no free constant (effects.md)
#[derive(Debug)]
pub(super) struct SwitchLocalTension;

impl Effect for SwitchLocalTension {
    fn id(&self) -> &'static str {
        "switch_local_tension"
    }

    fn side(&self) -> Side {
        Side::Switch
    }

    fn covariate(&self) -> Covariate {
        Covariate::Direction
    }

    fn formula(&self) -> &'static str {
        "S(mean tension over the wrap) instead of S(F); no free constant (effects.md)"
    }

    fn parameters(&self) -> &'static [Parameter] {
        &[]
    }

    fn starts(&self, _frame: &Frame) -> Vec<Vec<f64>> {
        vec![vec![]]
    }

    fn confused_with(&self) -> &'static [&'static str] {
        &["switching_hysteresis", "direction_asymmetry"]
    }

    fn experiment(&self) -> &'static str {
        "both directions on a device at loads near its threshold"
    }

    fn invisible_because(&self) -> &'static str {
        "no device, or no load near its threshold"
    }

    fn on_contact(&self, _: &[f64], _: &Point, _: &Condition, state: &mut ContactState) {
        state.local_tension = true;
    }
}
