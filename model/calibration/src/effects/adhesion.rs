//! `adhesion`: a constant friction force on silicone, present at zero load.

use std::borrow::Cow;

use super::{
    ContactState, Covariate, Description, Effect, PaperProtocol, Parameter, Side, Stage, StudyRange, Written,
};
use crate::table::{Condition, Frame, Point};

/// Marker type; see [`DESCRIPTION`].
#[derive(Debug)]
pub(super) struct Adhesion;

/// Entry in the catalogue.
pub(super) static EFFECT: Adhesion = Adhesion;

static DESCRIPTION: Description<'static> = Description {
    id: "adhesion",
    side: Side::Switch,
    covariate: Covariate::Direction,
    stage: Stage::Drag,
    formula: "T + d c on silicone, T + d c S on a device",
    written: Written::No("on a device it depends on the silicone's share of the friction"),
    parameters: &[Parameter::free("c", "N")],
    // It opposes every move.
    one_sided: true,
    bends: true,
    scales: true,
    on_plain: false,
    confused_with: &[Cow::Borrowed("guide_drag")],
    experiment: "a pins-only run or a blank run without the switch",
    invisible_because: "no silicone, or only one direction",
    study: StudyRange { size: Some((0.2, 0.6)), signed: false, shapes: &[], paper: PaperProtocol::Shown },
};

impl Effect for Adhesion {
    fn description(&self) -> Description<'_> {
        DESCRIPTION
    }

    fn typical(&self, _frame: &Frame) -> Vec<Vec<f64>> {
        vec![vec![0.3]]
    }

    fn on_contact(&self, k: &[f64], _: &Point, _: &Condition, state: &mut ContactState) {
        state.adhesion_n += k[0];
    }
}
