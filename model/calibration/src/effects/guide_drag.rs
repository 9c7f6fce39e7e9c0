//! `guide_drag`: a constant drag of the guide pulleys in every condition.

use std::borrow::Cow;

use super::{
    ActsOn, ContactState, Covariate, Description, Effect, PaperProtocol, Parameter, Side, Stage, StudyRange,
    Written,
};
use crate::table::{Condition, Frame, Point};

/// Marker type; see [`DESCRIPTION`].
#[derive(Debug)]
struct GuideDrag;

/// Entry in the catalogue.
pub(super) const EFFECT: &dyn Effect = &GuideDrag;

static DESCRIPTION: Description<'static> = Description {
    id: "guide_drag",
    side: Side::Rig,
    covariate: Covariate::Direction,
    stage: Stage::Drag,
    formula: "T + d c in every condition",
    written: Written::sum(ActsOn::Tension, "c*direction"),
    parameters: &[Parameter::free("c", "N")],
    // It opposes every move.
    one_sided: true,
    bends: false,
    scales: true,
    on_plain: true,
    confused_with: &[Cow::Borrowed("adhesion")],
    experiment: "a pins-only run or a blank run without the switch",
    invisible_because: "only one direction",
    study: StudyRange { size: Some((0.1, 0.5)), signed: false, shapes: &[], paper: PaperProtocol::Shown },
};

impl Effect for GuideDrag {
    fn description(&self) -> Description<'_> {
        DESCRIPTION
    }

    fn starts(&self, _frame: &Frame) -> Vec<Vec<f64>> {
        vec![vec![0.2]]
    }

    fn on_contact(&self, k: &[f64], _: &Point, _: &Condition, state: &mut ContactState) {
        state.drag_n += k[0];
    }
}
