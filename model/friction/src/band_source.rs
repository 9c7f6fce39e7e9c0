//! One source of a curve's uncertainty.

use serde::Serialize;

/// Half width of a standard normal distribution at 95 %.
pub const NORMAL_95: f64 = 1.96;

/// Uncertainty of `ln D` from one source: half widths at 95 %, load by load, none negative.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BandSource {
    /// Name of the source, such as `constants` or `layer thickness`.
    pub name: String,
    /// Half widths downwards.
    pub down: Vec<f64>,
    /// Half widths upwards.
    pub up: Vec<f64>,
}

impl BandSource {
    /// Creates a source with the same half widths downwards and upwards.
    pub(crate) fn symmetric(name: impl Into<String>, half: Vec<f64>) -> Self {
        Self { name: name.into(), down: half.clone(), up: half }
    }
}
