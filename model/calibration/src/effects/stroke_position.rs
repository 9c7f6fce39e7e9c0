//! `stroke_position`: the wrap angle changes along the stroke.

use std::borrow::Cow;

use super::{
    ActsOn, ContactState, Covariate, Description, Effect, PaperProtocol, Parameter, Side, Stage, StudyRange,
    Written,
};
use crate::table::{Condition, Frame, Point};

/// Marker type; see [`DESCRIPTION`].
#[derive(Debug)]
struct StrokePosition;

/// Entry in the catalogue.
pub(super) const EFFECT: &dyn Effect = &StrokePosition;

static DESCRIPTION: Description<'static> = Description {
    id: "stroke_position",
    side: Side::Rig,
    covariate: Covariate::Position,
    stage: Stage::ScaledFriction,
    formula: "a (1 + k (s/stroke - 1/2))",
    written: Written::factor(ActsOn::Wrap, "k*(stroke - 0.5)"),
    parameters: &[Parameter::free("k", "1")],
    one_sided: false,
    bends: true,
    scales: true,
    on_plain: true,
    confused_with: &[Cow::Borrowed("run_in")],
    experiment: "both directions over the whole stroke",
    invisible_because: "the position never varies",
    study: StudyRange { size: Some((0.05, 0.2)), signed: true, shapes: &[], paper: PaperProtocol::Shown },
};

impl Effect for StrokePosition {
    fn description(&self) -> Description<'_> {
        DESCRIPTION
    }

    fn starts(&self, _frame: &Frame) -> Vec<Vec<f64>> {
        vec![vec![0.05]]
    }

    fn on_contact(&self, k: &[f64], point: &Point, _: &Condition, state: &mut ContactState) {
        state.exponent_factor *= (1.0 + k[0] * (point.position - 0.5)).max(0.0);
    }
}
