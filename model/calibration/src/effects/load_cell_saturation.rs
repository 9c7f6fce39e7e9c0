//! `load_cell_saturation`: the reading stops rising above some force.

use super::{Covariate, Effect, Parameter, Side};
use crate::table::{Frame, Point};

/// min(reading, limit) (effects.md)
#[derive(Debug)]
pub(super) struct LoadCellSaturation;

impl Effect for LoadCellSaturation {
    fn id(&self) -> &'static str {
        "load_cell_saturation"
    }

    fn side(&self) -> Side {
        Side::Rig
    }

    fn covariate(&self) -> Covariate {
        Covariate::Load
    }

    fn formula(&self) -> &'static str {
        "min(reading, limit) (effects.md)"
    }

    fn parameters(&self) -> &'static [Parameter] {
        const { &[Parameter::free("limit", "N")] }
    }

    fn starts(&self, frame: &Frame) -> Vec<Vec<f64>> {
        let highest = frame.load_range_n.1 * 1.35;
        (0..14).map(|i| vec![highest * (1.0 - 0.025 * f64::from(i))]).collect()
    }

    fn confused_with(&self) -> &'static [&'static str] {
        &["load_cell_nonlinearity"]
    }

    fn experiment(&self) -> &'static str {
        "dead weights up to 65 N on the cell"
    }

    fn invisible_because(&self) -> &'static str {
        "no reading comes near the limit of the cell"
    }

    fn on_reading(&self, k: &[f64], _: &Point, reading_n: f64) -> f64 {
        reading_n.min(k[0])
    }
}
