//! One source of uncertainty.

use serde::Serialize;

/// Half width of a standard normal distribution at 95 %.
pub(crate) const NORMAL_95: f64 = 1.96;

/// Half widths of `ln D` at 95 % that come from one source, load by load; none is negative.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BandSource {
    /// The source, such as `constants` or `layer thickness`.
    pub name: String,
    /// Downwards.
    pub down: Vec<f64>,
    /// Upwards.
    pub up: Vec<f64>,
}

impl BandSource {
    /// A source that is as wide downwards as upwards.
    pub(crate) fn even(name: impl Into<String>, half: Vec<f64>) -> Self {
        Self { name: name.into(), down: half.clone(), up: half }
    }
}
