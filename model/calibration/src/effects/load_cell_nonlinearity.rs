//! `load_cell_nonlinearity`: the reading bends with its square.

use super::REFERENCE_LOAD_N;
use super::{Covariate, Effect, Parameter, Side};
use crate::table::{Frame, Point};

/// reading + k (reading/F0)^2 (effects.md)
#[derive(Debug)]
pub(super) struct LoadCellNonlinearity;

impl Effect for LoadCellNonlinearity {
    fn id(&self) -> &'static str {
        "load_cell_nonlinearity"
    }

    fn side(&self) -> Side {
        Side::Rig
    }

    fn covariate(&self) -> Covariate {
        Covariate::Load
    }

    fn formula(&self) -> &'static str {
        "reading + k (reading/F0)^2 (effects.md)"
    }

    fn parameters(&self) -> &'static [Parameter] {
        const { &[Parameter::free("k", "N")] }
    }

    fn starts(&self, _frame: &Frame) -> Vec<Vec<f64>> {
        vec![vec![0.4]]
    }

    fn confused_with(&self) -> &'static [&'static str] {
        &["load_cell_gain", "load_cell_saturation"]
    }

    fn experiment(&self) -> &'static str {
        "dead weights up to 65 N on the cell"
    }

    fn invisible_because(&self) -> &'static str {
        "only one direction, or one load"
    }

    fn on_reading(&self, k: &[f64], _: &Point, reading_n: f64) -> f64 {
        reading_n + k[0] * (reading_n / REFERENCE_LOAD_N).powi(2)
    }
}
