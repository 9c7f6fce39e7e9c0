//! Noise of a synthetic rig.

use pinswitch_calibration::model::Noise;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Noise of the synthetic rig.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct NoisePlan {
    /// Standard deviation of a repetition at zero load, in newtons.
    #[serde(rename = "repetition_N")]
    pub repetition_n: f64,
    /// Increase of that standard deviation with load, dimensionless; both add in squares.
    pub repetition_per_load: f64,
    /// Standard deviation of the offset of a series and direction at zero load, in newtons.
    #[serde(rename = "series_N")]
    pub series_n: f64,
    /// Increase of that standard deviation with load, dimensionless; both add in squares.
    pub series_per_load: f64,
    /// Share of rows with a gross error.
    pub outlier_share: f64,
    /// Standard deviation of gross errors in newtons.
    #[serde(rename = "outlier_N")]
    pub outlier_n: f64,
    /// Share of lost rows.
    pub lost_share: f64,
    /// Autocorrelation of successive repetitions: AR(1), 0 to 1.
    pub autocorrelation: f64,
    /// Standard deviation of the logarithm of the repetition noise between series.
    pub uneven: f64,
    /// Number of series that are labelled with a neighbouring weight.
    pub mislabelled_series: u32,
    /// Student's t distribution with three degrees of freedom instead of a normal distribution with
    /// the same quartiles.
    pub heavy_tails: bool,
    /// Standard deviation of the logarithm of friction between series: tendon seatings.
    #[serde(skip_serializing_if = "is_zero")]
    pub series_scale: f64,
    /// Standard deviation of the logarithm of friction between mounts.
    #[serde(skip_serializing_if = "is_zero")]
    pub mount_scale: f64,
    /// Standard deviation of the offset of a series, common to both directions, at zero load, in
    /// newtons.
    #[serde(rename = "series_common_N", skip_serializing_if = "is_zero")]
    pub series_common_n: f64,
    /// Increase of that standard deviation with load, dimensionless; both add in squares.
    #[serde(skip_serializing_if = "is_zero")]
    pub series_common_per_load: f64,
    /// Autocorrelation of the offsets of successive series: AR(1), 0 to 1.
    #[serde(skip_serializing_if = "is_zero")]
    pub series_walk: f64,
    /// Resolution of the load cell in newtons.
    #[serde(rename = "resolution_N", skip_serializing_if = "is_zero")]
    pub resolution_n: f64,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde passes a reference")]
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
    /// Converts the estimated noise of a calibration.
    ///
    /// A calibration splits offsets into an AR(1) process and white noise. Here the whole offset is
    /// an AR(1) process with the same correlation between successive series. Offsets of sessions,
    /// operators and specimens are omitted, because a plan has one of each. Outliers, lost rows,
    /// uneven noise and the resolution, which a calibration does not estimate, are zero.
    pub fn from_estimate(noise: Noise) -> Self {
        let walk = noise.walk;
        // The calibration has the parts as shares of the whole offset.
        let whole_and_share = |share: f64| {
            if walk.correlation > 0.0 && share > 0.0 { (walk.white.hypot(share), share) } else { (1.0, 0.0) }
        };
        let ((direction, moving), (common, _)) =
            (whole_and_share(walk.direction), whole_and_share(walk.common));
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
