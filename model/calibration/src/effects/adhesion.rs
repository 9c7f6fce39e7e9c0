//! `adhesion`: a constant friction force on silicone, there at zero load.

use super::{ContactState, Covariate, Effect, Parameter, Side};
use crate::table::{Condition, Frame, Point};

/// T + d c on silicone, T + d c S on a device (effects.md)
#[derive(Debug)]
pub(super) struct Adhesion;

impl Effect for Adhesion {
    fn id(&self) -> &'static str {
        "adhesion"
    }

    fn side(&self) -> Side {
        Side::Switch
    }

    fn covariate(&self) -> Covariate {
        Covariate::Direction
    }

    fn formula(&self) -> &'static str {
        "T + d c on silicone, T + d c S on a device (effects.md)"
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
        &["guide_drag"]
    }

    fn experiment(&self) -> &'static str {
        "a pins-only run or a blank run without the switch"
    }

    fn invisible_because(&self) -> &'static str {
        "no silicone, or only one direction"
    }

    fn on_contact(&self, k: &[f64], _: &Point, _: &Condition, state: &mut ContactState) {
        state.adhesion_n += k[0];
    }
}
