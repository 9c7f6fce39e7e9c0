//! The noise of a synthetic rig.

use pinswitch_calibration::inference::Noise;
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
    /// Logarithmic standard deviation of friction from series to series: the tendon is seated anew.
    #[serde(skip_serializing_if = "is_zero")]
    pub series_scale: f64,
    /// Logarithmic standard deviation of friction from mount to mount: the tendon wraps a little more or less.
    #[serde(skip_serializing_if = "is_zero")]
    pub mount_scale: f64,
    /// Of a series, shared by both directions, at zero load, in newtons.
    #[serde(rename = "series_common_N", skip_serializing_if = "is_zero")]
    pub series_common_n: f64,
    /// Its growth with load, dimensionless.
    #[serde(skip_serializing_if = "is_zero")]
    pub series_common_per_load: f64,
    /// Correlation of the offsets of a series with those of the series before it in time, 0..1.
    #[serde(skip_serializing_if = "is_zero")]
    pub series_walk: f64,
    /// Step of the load cell in newtons: readings are multiples of it.
    #[serde(rename = "resolution_N", skip_serializing_if = "is_zero")]
    pub resolution_n: f64,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "as serde asks for it")]
fn is_zero(value: &f64) -> bool {
    *value == 0.0
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
            series_scale: 0.0,
            mount_scale: 0.0,
            series_common_n: 0.0,
            series_common_per_load: 0.0,
            series_walk: 0.0,
            resolution_n: 0.0,
        }
    }
}

impl NoisePlan {
    /// The noise that a calibration found on a rig, part by part, for rigs like it.
    ///
    /// Offsets that wander in part do so whole here, with less memory: their correlation from series to series is kept. A
    /// part that groups of rows share (sessions, operators, specimens) is left out: a plan has one of each. What a
    /// calibration does not estimate (outliers, lost rows, uneven noise, steps of the cell) is absent.
    pub fn of_rig(noise: Noise) -> Self {
        let walk = noise.walk;
        // Sizes of the offsets' parts are shares of what they are as a whole.
        let wanders = |share: f64| {
            if walk.correlation > 0.0 && share > 0.0 { (walk.white.hypot(share), share) } else { (1.0, 0.0) }
        };
        let ((direction, moving), (common, _)) = (wanders(walk.direction), wanders(walk.common));
        Self {
            repetition_n: noise.repetition.constant_n,
            repetition_per_load: noise.repetition.per_load,
            series_n: direction * noise.series.constant_n,
            series_per_load: direction * noise.series.per_load,
            outlier_share: 0.0,
            autocorrelation: noise.correlation,
            series_scale: noise.series_scale,
            mount_scale: noise.mount_scale,
            series_common_n: common * noise.series_common.constant_n,
            series_common_per_load: common * noise.series_common.per_load,
            series_walk: walk.correlation * (moving / direction).powi(2),
            ..Self::default()
        }
    }
}
