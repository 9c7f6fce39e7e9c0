//! Sampling and faults of raw logs.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Sampling of the logs, and rates of faults.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct RawPlan {
    /// Samples per second.
    pub sample_rate_hz: f64,
    /// Standard deviation of one sample of the force, in newtons.
    #[serde(rename = "sample_N")]
    pub sample_n: f64,
    /// Standard deviation of a time stamp, in seconds.
    pub jitter_s: f64,
    /// Share of samples with an electrical spike.
    pub spike_share: f64,
    /// Share of lost samples.
    pub lost_share: f64,
    /// Force at which the channel clips, in newtons; `None` without clipping.
    #[serde(rename = "clip_N", skip_serializing_if = "Option::is_none")]
    pub clip_n: Option<f64>,
    /// Share of logs with a move of another length.
    pub odd_speed_share: f64,
    /// Share of logs with a missing repetition.
    pub missing_share: f64,
}

impl Default for RawPlan {
    fn default() -> Self {
        Self {
            sample_rate_hz: 200.0,
            sample_n: 0.07,
            jitter_s: 0.0003,
            spike_share: 0.0004,
            lost_share: 0.002,
            clip_n: None,
            odd_speed_share: 0.05,
            missing_share: 0.05,
        }
    }
}
