//! Hierarchical noise of a model file: repetition noise, possibly autocorrelated, and components that
//! rows share.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A variance that increases with the square of the load: `constant^2 + (per_load F)^2`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Spread {
    /// Standard deviation at zero load, in newtons.
    pub constant_n: f64,
    /// Increase with load, dimensionless.
    pub per_load: f64,
}

impl Spread {
    /// Returns the standard deviation at a load, in newtons.
    pub fn at(self, load_n: f64) -> f64 {
        libm::hypot(self.constant_n, self.per_load * load_n)
    }
}

/// Drifting part of the offsets of series, in files of earlier versions. Sizes are shares of the
/// offsets' standard deviations.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Wandering {
    /// Correlation with the previous series; 0 without drift.
    pub correlation: f64,
    /// Size of the part that does not drift.
    pub white: f64,
    /// Size of the drifting offset common to both directions.
    pub common: f64,
    /// Size of the drifting offset of each direction.
    pub direction: f64,
}

impl Wandering {
    /// Returns whether there is any drift.
    pub(crate) fn is_any(&self) -> bool {
        self.correlation > 0.0 && (self.common > 0.0 || self.direction > 0.0)
    }
}

/// Noise of a table. A component is zero if it was not detected or not estimated.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Noise {
    /// Noise of one repetition.
    pub repetition: Spread,
    /// Offset common to the rows of one series and direction.
    pub series: Spread,
    /// Correlation of consecutive repetitions in a series and direction.
    #[serde(default)]
    pub correlation: f64,
    /// Offset common to both directions of a series.
    #[serde(default)]
    pub series_common: Spread,
    /// Relative variation of the friction exponent between series (tendon seating).
    #[serde(default)]
    pub series_scale: f64,
    /// Relative variation of the friction exponent, or the wrap, between mounts.
    #[serde(default)]
    pub mount_scale: f64,
    /// Drifting part of the offsets of series.
    #[serde(default)]
    pub walk: Wandering,
    /// Variation of the reading between operators and between sessions, in newtons.
    #[serde(rename = "group_offset_N", default)]
    pub group_offset_n: f64,
    /// Relative variation of the friction exponent between specimens.
    #[serde(default)]
    pub specimen_scale: f64,
}

impl Noise {
    /// Returns noise that is independent of the load, in newtons.
    pub fn constant(repetition_n: f64, series_n: f64) -> Self {
        let same = |constant_n| Spread { constant_n, per_load: 0.0 };
        Self {
            repetition: same(repetition_n),
            series: same(series_n),
            correlation: 0.0,
            series_common: same(0.0),
            series_scale: 0.0,
            mount_scale: 0.0,
            walk: Wandering::default(),
            group_offset_n: 0.0,
            specimen_scale: 0.0,
        }
    }

    /// Returns the share of the offsets' standard deviations that does not drift.
    pub(crate) fn white(self) -> f64 {
        if self.walk.is_any() { self.walk.white } else { 1.0 }
    }

    /// Returns the standard deviation in newtons of the drifting part of an offset.
    pub fn wandering_n(self, load_n: f64) -> f64 {
        if !self.walk.is_any() {
            return 0.0;
        }
        libm::hypot(
            self.walk.common * self.series_common.at(load_n),
            self.walk.direction * self.series.at(load_n),
        )
    }

    /// Returns the standard deviation in newtons of one reading around the model, where
    /// `friction_n` is the change of friction in newtons per relative change of its exponent.
    pub fn at(self, load_n: f64, friction_n: f64) -> f64 {
        let scale = libm::hypot(libm::hypot(self.series_scale, self.mount_scale), self.specimen_scale);
        let parts = [
            self.repetition.at(load_n),
            self.white() * self.series.at(load_n),
            self.white() * self.series_common.at(load_n),
            self.wandering_n(load_n),
            self.group_offset_n,
            scale * friction_n,
        ];
        parts.into_iter().fold(0.0, libm::hypot)
    }
}
