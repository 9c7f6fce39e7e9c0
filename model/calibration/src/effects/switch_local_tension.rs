//! `switch_local_tension`: the transition follows the local tension over the wrap, not the load.

use std::borrow::Cow;

use super::{ContactState, Covariate, Description, Effect, PaperProtocol, Side, Stage, StudyRange, Written};
use crate::table::{Condition, Frame, Point};

/// Marker type; see [`DESCRIPTION`].
#[derive(Debug)]
pub(super) struct SwitchLocalTension;

/// Entry in the catalogue.
pub(super) static EFFECT: SwitchLocalTension = SwitchLocalTension;

static DESCRIPTION: Description<'static> = Description {
    id: "switch_local_tension",
    side: Side::Switch,
    covariate: Covariate::Direction,
    stage: Stage::Switch,
    formula: "S(mean tension over the wrap) instead of S(F); no free constant",
    written: Written::No("it is without constants, and depends on the tension along the wrap"),
    parameters: &[],
    one_sided: false,
    bends: true,
    scales: false,
    on_plain: false,
    confused_with: &[Cow::Borrowed("switching_hysteresis"), Cow::Borrowed("direction_asymmetry")],
    experiment: "both directions on a device at loads near its threshold",
    invisible_because: "no device, or no load near its threshold",
    study: StudyRange { size: None, signed: false, shapes: &[], paper: PaperProtocol::Shown },
};

impl Effect for SwitchLocalTension {
    fn description(&self) -> Description<'_> {
        DESCRIPTION
    }

    fn typical(&self, _frame: &Frame) -> Vec<Vec<f64>> {
        vec![vec![]]
    }

    fn on_contact(&self, _: &[f64], _: &Point, _: &Condition, state: &mut ContactState) {
        state.local_tension = true;
    }
}
