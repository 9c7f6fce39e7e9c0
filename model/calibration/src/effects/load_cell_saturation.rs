//! `load_cell_saturation`: the reading saturates above a force.

use std::borrow::Cow;

use super::{Covariate, Description, Effect, PaperProtocol, Parameter, Side, Stage, StudyRange, Written};
use crate::table::{Condition, Frame, Point};

/// Marker type; see [`DESCRIPTION`].
#[derive(Debug)]
pub(super) struct LoadCellSaturation;

/// Entry in the catalogue.
pub(super) static EFFECT: LoadCellSaturation = LoadCellSaturation;

static DESCRIPTION: Description<'static> = Description {
    id: "load_cell_saturation",
    side: Side::Rig,
    covariate: Covariate::Load,
    stage: Stage::CellLimit,
    formula: "min(reading, limit)",
    written: Written::No("no value of the limit cancels the effect"),
    parameters: &[Parameter::free("limit", "N")],
    one_sided: false,
    bends: true,
    scales: false,
    on_plain: true,
    confused_with: &[Cow::Borrowed("load_cell_nonlinearity")],
    experiment: "dead weights up to 65 N on the cell",
    invisible_because: "no reading is near the limit of the load cell",
    study: StudyRange { size: Some((46.0, 58.0)), signed: false, shapes: &[], paper: PaperProtocol::Shown },
};

impl Effect for LoadCellSaturation {
    fn description(&self) -> Description<'_> {
        DESCRIPTION
    }

    fn typical(&self, frame: &Frame) -> Vec<Vec<f64>> {
        let highest = frame.load_range_n.1 * 1.35;
        (0..14).map(|i| vec![highest * (1.0 - 0.025 * f64::from(i))]).collect()
    }

    fn on_reading(&self, k: &[f64], _: &Point, _: &Condition, reading_n: f64) -> f64 {
        reading_n.min(k[0])
    }
}
