//! `load_cell_gain`: the reading has a wrong scale.

use std::borrow::Cow;

use super::{
    ActsOn, Covariate, Description, Effect, PaperProtocol, Parameter, Side, Stage, StudyRange, Written,
};
use crate::table::{Condition, Frame, Point};

/// Marker type; see [`DESCRIPTION`].
#[derive(Debug)]
struct LoadCellGain;

/// Entry in the catalogue.
pub(super) const EFFECT: &dyn Effect = &LoadCellGain;

static DESCRIPTION: Description<'static> = Description {
    id: "load_cell_gain",
    side: Side::Rig,
    covariate: Covariate::Load,
    stage: Stage::CellScale,
    formula: "reading (1 + g)",
    written: Written::factor(ActsOn::Reading, "g"),
    parameters: &[Parameter::free("g", "1")],
    one_sided: false,
    bends: false,
    scales: true,
    on_plain: true,
    confused_with: &[Cow::Borrowed("direction_asymmetry"), Cow::Borrowed("load_cell_nonlinearity")],
    experiment: "dead weights up to 65 N on the cell",
    invisible_because: "only one direction",
    study: StudyRange { size: Some((0.01, 0.06)), signed: true, shapes: &[], paper: PaperProtocol::Shown },
};

impl Effect for LoadCellGain {
    fn description(&self) -> Description<'_> {
        DESCRIPTION
    }

    fn starts(&self, _frame: &Frame) -> Vec<Vec<f64>> {
        vec![vec![0.02]]
    }

    fn on_reading(&self, k: &[f64], _: &Point, _: &Condition, reading_n: f64) -> f64 {
        reading_n * (1.0 + k[0])
    }
}
