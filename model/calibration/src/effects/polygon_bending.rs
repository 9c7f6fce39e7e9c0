//! `polygon_bending`: the sharper the tendon turns at one pin, the more friction there.

use super::{ContactState, Covariate, Effect, Parameter, Side};
use crate::table::{Condition, Frame, Point};

/// Turn per pin to which `k` refers: 20 degrees.
const REFERENCE_TURN_RAD: f64 = 0.349_065_850_398_865_9;

/// mu_p (1 + k (a/n) / (20 deg)) with the mean turn a/n per pin (effects.md)
#[derive(Debug)]
pub(super) struct PolygonBending;

impl Effect for PolygonBending {
    fn id(&self) -> &'static str {
        "polygon_bending"
    }

    fn side(&self) -> Side {
        Side::Switch
    }

    fn covariate(&self) -> Covariate {
        Covariate::Condition
    }

    fn formula(&self) -> &'static str {
        "mu_p (1 + k (a/n) / (20 deg)) with the mean turn a/n per pin (effects.md)"
    }

    fn parameters(&self) -> &'static [Parameter] {
        const { &[Parameter::free("k", "1")] }
    }

    // One sign: sharper turns bend the fibres more.
    fn one_sided(&self) -> bool {
        true
    }

    fn starts(&self, _frame: &Frame) -> Vec<Vec<f64>> {
        vec![vec![0.5]]
    }

    fn confused_with(&self) -> &'static [&'static str] {
        &["coating_ploughing"]
    }

    fn experiment(&self) -> &'static str {
        "the same number of loads on a layout with another number of pins"
    }

    fn invisible_because(&self) -> &'static str {
        "all pins-only and device layouts have one number of pins"
    }

    fn on_contact(&self, k: &[f64], _: &Point, condition: &Condition, state: &mut ContactState) {
        if condition.has_pins() {
            state.mu_pins *= (1.0 + k[0] * condition.turn_rad / REFERENCE_TURN_RAD).max(0.0);
        }
    }
}
