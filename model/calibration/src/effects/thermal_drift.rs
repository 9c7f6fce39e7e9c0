//! `thermal_drift`: the reading drifts with time.

use super::{Covariate, Effect, Parameter, Side};
use crate::table::{Frame, Point};

/// reading + k u, u share of session time (effects.md)
#[derive(Debug)]
pub(super) struct ThermalDrift;

impl Effect for ThermalDrift {
    fn id(&self) -> &'static str {
        "thermal_drift"
    }

    fn side(&self) -> Side {
        Side::Rig
    }

    fn covariate(&self) -> Covariate {
        Covariate::Time
    }

    fn formula(&self) -> &'static str {
        "reading + k u, u share of session time (effects.md)"
    }

    fn parameters(&self) -> &'static [Parameter] {
        const { &[Parameter::free("k", "N")] }
    }

    fn starts(&self, _frame: &Frame) -> Vec<Vec<f64>> {
        vec![vec![0.3]]
    }

    fn confused_with(&self) -> &'static [&'static str] {
        &["wear_drift"]
    }

    fn experiment(&self) -> &'static str {
        "a zero reading before and after the session"
    }

    fn invisible_because(&self) -> &'static str {
        "the session is too short to drift"
    }

    fn on_reading(&self, k: &[f64], point: &Point, reading_n: f64) -> f64 {
        reading_n + k[0] * point.time
    }
}
