//! `stroke_position`: the wrap angle changes along the stroke.

use super::{ContactState, Covariate, Effect, Parameter, Side};
use crate::table::{Condition, Frame, Point};

/// a (1 + k (s/stroke - 1/2)) (effects.md)
#[derive(Debug)]
pub(super) struct StrokePosition;

impl Effect for StrokePosition {
    fn id(&self) -> &'static str {
        "stroke_position"
    }

    fn side(&self) -> Side {
        Side::Rig
    }

    fn covariate(&self) -> Covariate {
        Covariate::Position
    }

    fn formula(&self) -> &'static str {
        "a (1 + k (s/stroke - 1/2)) (effects.md)"
    }

    fn parameters(&self) -> &'static [Parameter] {
        const { &[Parameter::free("k", "1")] }
    }

    fn starts(&self, _frame: &Frame) -> Vec<Vec<f64>> {
        vec![vec![0.05]]
    }

    fn confused_with(&self) -> &'static [&'static str] {
        &["run_in"]
    }

    fn experiment(&self) -> &'static str {
        "both directions over the whole stroke"
    }

    fn invisible_because(&self) -> &'static str {
        "the position never varies"
    }

    fn on_contact(&self, k: &[f64], point: &Point, _: &Condition, state: &mut ContactState) {
        state.exponent_factor *= (1.0 + k[0] * (point.position - 0.5)).max(0.0);
    }
}
