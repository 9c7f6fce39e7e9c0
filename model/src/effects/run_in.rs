//! `run_in`: friction of the silicone is higher in the first repetitions of a series.

use super::{ContactState, Covariate, Effect, Parameter, Side};
use crate::rig::{Condition, Frame, Point};

/// mu_s (1 + k exp(-(r - 1)/r0)) (effects.md)
#[derive(Debug)]
pub(super) struct RunIn;

impl Effect for RunIn {
    fn id(&self) -> &'static str {
        "run_in"
    }

    fn side(&self) -> Side {
        Side::Switch
    }

    fn covariate(&self) -> Covariate {
        Covariate::Repetition
    }

    fn formula(&self) -> &'static str {
        "mu_s (1 + k exp(-(r - 1)/r0)) (effects.md)"
    }

    fn parameters(&self) -> &'static [Parameter] {
        const { &[Parameter::free("k", "1"), Parameter::bounded("r0", "1", 0.5, 12.0)] }
    }

    // One sign: friction is higher before it settles.
    fn one_sided(&self) -> bool {
        true
    }

    fn starts(&self, _frame: &Frame) -> Vec<Vec<f64>> {
        vec![vec![0.1, 1.0], vec![0.1, 2.5], vec![0.1, 5.0], vec![0.1, 9.0]]
    }

    fn confused_with(&self) -> &'static [&'static str] {
        &["stroke_position"]
    }

    fn experiment(&self) -> &'static str {
        "one series started in the middle of the stroke"
    }

    fn invisible_because(&self) -> &'static str {
        "one repetition per series, or no silicone"
    }

    fn on_contact(&self, k: &[f64], point: &Point, _: &Condition, state: &mut ContactState) {
        state.mu_silicone *= (1.0 + k[0] * (-(point.repetition - 1.0) / k[1]).exp()).max(0.0);
    }
}
