//! `load_cell_offset`: the reading has a constant offset.

use super::{Covariate, Effect, Parameter, Side};
use crate::table::{Frame, Point};

/// reading + b (effects.md)
#[derive(Debug)]
pub(super) struct LoadCellOffset;

impl Effect for LoadCellOffset {
    fn id(&self) -> &'static str {
        "load_cell_offset"
    }

    fn side(&self) -> Side {
        Side::Rig
    }

    fn covariate(&self) -> Covariate {
        Covariate::Direction
    }

    fn formula(&self) -> &'static str {
        "reading + b (effects.md)"
    }

    fn parameters(&self) -> &'static [Parameter] {
        const { &[Parameter::free("b", "N")] }
    }

    fn starts(&self, _frame: &Frame) -> Vec<Vec<f64>> {
        vec![vec![0.3]]
    }

    fn confused_with(&self) -> &'static [&'static str] {
        &["hook_omitted"]
    }

    fn experiment(&self) -> &'static str {
        "a zero reading of the unloaded cell"
    }

    fn invisible_because(&self) -> &'static str {
        "too few loads"
    }

    fn on_reading(&self, k: &[f64], _: &Point, reading_n: f64) -> f64 {
        reading_n + k[0]
    }
}
