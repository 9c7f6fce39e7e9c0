//! `load_cell_gain`: the reading has a wrong scale.

use super::{Covariate, Effect, Parameter, Side};
use crate::table::{Frame, Point};

/// reading (1 + g) (effects.md)
#[derive(Debug)]
pub(super) struct LoadCellGain;

impl Effect for LoadCellGain {
    fn id(&self) -> &'static str {
        "load_cell_gain"
    }

    fn side(&self) -> Side {
        Side::Rig
    }

    fn covariate(&self) -> Covariate {
        Covariate::Load
    }

    fn formula(&self) -> &'static str {
        "reading (1 + g) (effects.md)"
    }

    fn parameters(&self) -> &'static [Parameter] {
        const { &[Parameter::free("g", "1")] }
    }

    fn starts(&self, _frame: &Frame) -> Vec<Vec<f64>> {
        vec![vec![0.02]]
    }

    fn confused_with(&self) -> &'static [&'static str] {
        &["direction_asymmetry", "load_cell_nonlinearity"]
    }

    fn experiment(&self) -> &'static str {
        "dead weights up to 65 N on the cell"
    }

    fn invisible_because(&self) -> &'static str {
        "only one direction"
    }

    fn on_reading(&self, k: &[f64], _: &Point, reading_n: f64) -> f64 {
        reading_n * (1.0 + k[0])
    }
}
