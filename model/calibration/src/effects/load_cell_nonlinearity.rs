//! `load_cell_nonlinearity`: the reading has a quadratic error.

use std::borrow::Cow;

use super::{
    ActsOn, Covariate, Description, Effect, PaperProtocol, Parameter, REFERENCE_LOAD_N, Side, Stage,
    StudyRange, Written,
};
use crate::table::{Condition, Frame, Point};

/// Marker type; see [`DESCRIPTION`].
#[derive(Debug)]
struct LoadCellNonlinearity;

/// Entry in the catalogue.
pub(super) const EFFECT: &dyn Effect = &LoadCellNonlinearity;

static DESCRIPTION: Description<'static> = Description {
    id: "load_cell_nonlinearity",
    side: Side::Rig,
    covariate: Covariate::Load,
    stage: Stage::CellScale,
    formula: "reading + k (reading/F0)^2",
    written: Written::sum(ActsOn::Reading, "k*(tension_n/50)^2"),
    parameters: &[Parameter::free("k", "N")],
    one_sided: false,
    bends: true,
    scales: true,
    on_plain: true,
    confused_with: &[Cow::Borrowed("load_cell_gain"), Cow::Borrowed("load_cell_saturation")],
    experiment: "dead weights up to 65 N on the cell",
    invisible_because: "only one direction, or one load",
    study: StudyRange { size: Some((0.3, 1.5)), signed: true, shapes: &[], paper: PaperProtocol::Shown },
};

impl Effect for LoadCellNonlinearity {
    fn description(&self) -> Description<'_> {
        DESCRIPTION
    }

    fn starts(&self, _frame: &Frame) -> Vec<Vec<f64>> {
        vec![vec![0.4]]
    }

    fn on_reading(&self, k: &[f64], _: &Point, _: &Condition, reading_n: f64) -> f64 {
        reading_n + k[0] * (reading_n / REFERENCE_LOAD_N).powi(2)
    }
}
