//! `hook_omitted`: the declared load leaves out the hook's weight.

use super::{ContactState, Covariate, Effect, Parameter, Side};
use crate::table::{Condition, Frame, Point};
use pinswitch_friction::published;

/// F + 0.613 N: the hook of 62.53 g; no free constant (effects.md)
#[derive(Debug)]
pub(super) struct HookOmitted;

impl Effect for HookOmitted {
    fn id(&self) -> &'static str {
        "hook_omitted"
    }

    fn side(&self) -> Side {
        Side::Rig
    }

    fn covariate(&self) -> Covariate {
        Covariate::Load
    }

    fn formula(&self) -> &'static str {
        "F + 0.613 N: the hook of 62.53 g; no free constant (effects.md)"
    }

    fn parameters(&self) -> &'static [Parameter] {
        &[]
    }

    fn starts(&self, _frame: &Frame) -> Vec<Vec<f64>> {
        vec![vec![]]
    }

    fn confused_with(&self) -> &'static [&'static str] {
        &["load_cell_offset"]
    }

    fn experiment(&self) -> &'static str {
        "weigh the hook"
    }

    fn invisible_because(&self) -> &'static str {
        ""
    }

    fn on_contact(&self, _: &[f64], _: &Point, _: &Condition, state: &mut ContactState) {
        state.load_n += published::HOOK_MASS_G * 1e-3 * published::GRAVITY_M_S2;
    }
}
