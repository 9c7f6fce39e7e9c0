//! The noise of a synthetic rig.

use serde::{Deserialize, Serialize};

/// Noise of the synthetic rig.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct NoisePlan {
    /// Of one repetition at zero load, in newtons.
    #[serde(rename = "repetition_N")]
    pub repetition_n: f64,
    /// Its growth with load, dimensionless.
    pub repetition_per_load: f64,
    /// Of a series and direction at zero load, in newtons.
    #[serde(rename = "series_N")]
    pub series_n: f64,
    /// Its growth with load, dimensionless.
    pub series_per_load: f64,
    /// Share of rows with a gross error.
    pub outlier_share: f64,
    /// Size of gross errors in newtons.
    #[serde(rename = "outlier_N")]
    pub outlier_n: f64,
    /// Share of rows that are lost.
    pub lost_share: f64,
    /// Correlation of neighbouring repetitions, 0..1.
    pub autocorrelation: f64,
    /// Logarithmic standard deviation of the repetition noise from series to series.
    pub uneven: f64,
    /// Series whose weight is written down as that of a neighbour.
    pub mislabelled_series: u32,
    /// Heavy tails: Student's t with three degrees of freedom instead of a normal law, of the same quartiles.
    pub heavy_tails: bool,
}

impl Default for NoisePlan {
    fn default() -> Self {
        Self {
            repetition_n: 0.07,
            repetition_per_load: 0.002,
            series_n: 0.025,
            series_per_load: 0.004,
            outlier_share: 0.002,
            outlier_n: 1.0,
            lost_share: 0.0,
            autocorrelation: 0.0,
            uneven: 0.0,
            mislabelled_series: 0,
            heavy_tails: false,
        }
    }
}
