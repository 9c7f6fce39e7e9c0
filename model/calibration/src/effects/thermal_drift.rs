//! `thermal_drift`: the reading drifts with time.

use std::borrow::Cow;

use super::{
    ActsOn, Covariate, Description, Effect, PaperProtocol, Parameter, Side, Stage, StudyRange, Written,
};
use crate::table::{Condition, Frame, Point};

/// Marker type; see [`DESCRIPTION`].
#[derive(Debug)]
struct ThermalDrift;

/// Entry in the catalogue.
pub(super) const EFFECT: &dyn Effect = &ThermalDrift;

static DESCRIPTION: Description<'static> = Description {
    id: "thermal_drift",
    side: Side::Rig,
    covariate: Covariate::Time,
    stage: Stage::CellZero,
    formula: "reading + k u, u the share of the session's time",
    written: Written::sum(ActsOn::Reading, "k*time"),
    parameters: &[Parameter::free("k", "N")],
    one_sided: false,
    bends: true,
    scales: true,
    on_plain: true,
    confused_with: &[Cow::Borrowed("wear_drift")],
    experiment: "a zero reading before and after the session",
    invisible_because: "the session is too short to drift",
    study: StudyRange { size: Some((0.3, 1.5)), signed: true, shapes: &[], paper: PaperProtocol::Shown },
};

impl Effect for ThermalDrift {
    fn description(&self) -> Description<'_> {
        DESCRIPTION
    }

    fn starts(&self, _frame: &Frame) -> Vec<Vec<f64>> {
        vec![vec![0.3]]
    }

    fn on_reading(&self, k: &[f64], point: &Point, _: &Condition, reading_n: f64) -> f64 {
        reading_n + k[0] * point.time
    }
}
