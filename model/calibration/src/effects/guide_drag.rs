//! `guide_drag`: a constant drag of the guide pulleys, in every condition.

use super::{ContactState, Covariate, Effect, Parameter, Side};
use crate::table::{Condition, Frame, Point};

/// T + d c in every condition (effects.md)
#[derive(Debug)]
pub(super) struct GuideDrag;

impl Effect for GuideDrag {
    fn id(&self) -> &'static str {
        "guide_drag"
    }

    fn side(&self) -> Side {
        Side::Rig
    }

    fn covariate(&self) -> Covariate {
        Covariate::Direction
    }

    fn formula(&self) -> &'static str {
        "T + d c in every condition (effects.md)"
    }

    fn parameters(&self) -> &'static [Parameter] {
        const { &[Parameter::free("c", "N")] }
    }

    // One sign: it opposes every move.
    fn one_sided(&self) -> bool {
        true
    }

    fn starts(&self, _frame: &Frame) -> Vec<Vec<f64>> {
        vec![vec![0.2]]
    }

    fn confused_with(&self) -> &'static [&'static str] {
        &["adhesion"]
    }

    fn experiment(&self) -> &'static str {
        "a pins-only run or a blank run without the switch"
    }

    fn invisible_because(&self) -> &'static str {
        "only one direction"
    }

    fn on_contact(&self, k: &[f64], _: &Point, _: &Condition, state: &mut ContactState) {
        state.drag_n += k[0];
    }
}
