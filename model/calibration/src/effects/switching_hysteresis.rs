//! `switching_hysteresis`: the threshold differs between ascending and descending loads.

use std::borrow::Cow;

use super::{
    ActsOn, ContactState, Covariate, Description, Effect, PaperProtocol, Parameter, Side, Stage, StudyRange,
    Written,
};
use crate::table::{Condition, Frame, Point};

/// Marker type; see [`DESCRIPTION`].
#[derive(Debug)]
struct SwitchingHysteresis;

/// Entry in the catalogue.
pub(super) const EFFECT: &dyn Effect = &SwitchingHysteresis;

static DESCRIPTION: Description<'static> = Description {
    id: "switching_hysteresis",
    side: Side::Switch,
    covariate: Covariate::Sweep,
    stage: Stage::Switch,
    formula: "F_half(down) = F_half(up) - H",
    written: Written::sum(ActsOn::Threshold, "-H*descending"),
    parameters: &[Parameter::free("H", "N")],
    // The silicone recovers with a delay.
    one_sided: true,
    bends: true,
    scales: true,
    on_plain: false,
    confused_with: &[Cow::Borrowed("switch_local_tension")],
    experiment: "a descending sweep of loads on a device",
    invisible_because: "no device, or loads never descend",
    study: StudyRange { size: Some((3.0, 10.0)), signed: false, shapes: &[], paper: PaperProtocol::Hidden },
};

impl Effect for SwitchingHysteresis {
    fn description(&self) -> Description<'_> {
        DESCRIPTION
    }

    fn starts(&self, _frame: &Frame) -> Vec<Vec<f64>> {
        vec![vec![4.0], vec![1.0]]
    }

    fn on_contact(&self, k: &[f64], point: &Point, _: &Condition, state: &mut ContactState) {
        state.half_load_n = (state.half_load_n - k[0] * point.descending).max(1.0);
    }
}
