//! `load_cell_offset`: the reading has a constant offset.

use std::borrow::Cow;

use super::{
    ActsOn, Covariate, Description, Effect, PaperProtocol, Parameter, Side, Stage, StudyRange, Written,
};
use crate::table::{Condition, Frame, Point};

/// Marker type; see [`DESCRIPTION`].
#[derive(Debug)]
struct LoadCellOffset;

/// Entry in the catalogue.
pub(super) const EFFECT: &dyn Effect = &LoadCellOffset;

static DESCRIPTION: Description<'static> = Description {
    id: "load_cell_offset",
    side: Side::Rig,
    covariate: Covariate::Direction,
    stage: Stage::CellZero,
    formula: "reading + b",
    written: Written::sum(ActsOn::Reading, "b"),
    parameters: &[Parameter::free("b", "N")],
    one_sided: false,
    bends: false,
    scales: true,
    on_plain: true,
    confused_with: &[Cow::Borrowed("hook_omitted")],
    experiment: "a zero reading of the unloaded cell",
    invisible_because: "too few loads",
    study: StudyRange { size: Some((0.2, 1.5)), signed: true, shapes: &[], paper: PaperProtocol::Shown },
};

impl Effect for LoadCellOffset {
    fn description(&self) -> Description<'_> {
        DESCRIPTION
    }

    fn starts(&self, _frame: &Frame) -> Vec<Vec<f64>> {
        vec![vec![0.3]]
    }

    fn on_reading(&self, k: &[f64], _: &Point, _: &Condition, reading_n: f64) -> f64 {
        reading_n + k[0]
    }
}
