//! `run_in`: friction of the silicone is higher in the first repetitions of a series.

use super::{ContactState, Covariate, Effect, Parameter, Side};
use crate::table::{Condition, Frame, Point};

/// mu_s (1 + k exp(-(r - 1)/r0)), times c in the concentric half, 1 if it settles anew there (effects.md)
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
        "mu_s (1 + k exp(-(r - 1)/r0)), times c in the concentric half, 1 if it settles anew there (effects.md)"
    }

    fn parameters(&self) -> &'static [Parameter] {
        const {
            &[
                Parameter::free("k", "1"),
                Parameter::bounded("r0", "1", 0.5, 12.0),
                Parameter::bounded("c", "1", -0.05, 1.05),
            ]
        }
    }

    // One sign: friction is higher before it settles.
    fn one_sided(&self) -> bool {
        true
    }

    fn starts(&self, _frame: &Frame) -> Vec<Vec<f64>> {
        [1.0, 2.5, 5.0, 9.0].iter().flat_map(|r0| [1.0, 0.0].map(|c| vec![0.1, *r0, c])).collect()
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
        let share = if point.sign > 0.0 { k[2] } else { 1.0 };
        state.mu_silicone *= (1.0 + share * k[0] * (-(point.repetition - 1.0) / k[1]).exp()).max(0.0);
    }
}
