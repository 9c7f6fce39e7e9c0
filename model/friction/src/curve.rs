//! Predicted friction curves.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::band::Band;
use crate::contact::Contact;
use crate::law::Law;
use crate::published;
use crate::status::{PredictionStatus, is_measured};
use crate::substrate::Substrate;
use crate::switch::SwitchState;

/// Tension and friction over load, as columns of equal length. Forces are in newtons.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FrictionCurve {
    /// Law of the curve.
    pub law: Law,
    /// Support of the prediction by measurements.
    #[serde(rename = "trust")]
    pub status: PredictionStatus,
    /// Reasons for the status, disagreements between laws, and known errors of the law.
    pub reasons: Vec<String>,
    /// Load on the tendon.
    pub load_n: Vec<f64>,
    /// Tension while the load is released.
    pub eccentric_n: Vec<f64>,
    /// Tension while the load is pulled.
    pub concentric_n: Vec<f64>,
    /// Friction `D = (T_c - T_e)/2`.
    pub friction_n: Vec<f64>,
    /// Lower edge of the band of `D`.
    pub band_low_n: Vec<f64>,
    /// Upper edge of the band of `D`.
    pub band_high_n: Vec<f64>,
    /// Share of `D` that comes from the silicone, 0 to 1.
    pub silicone_share: Vec<f64>,
}

/// Friction maximum or onset that the paper prints for a contact.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PublishedPoint {
    /// Load in newtons.
    pub load_n: f64,
    /// Friction in newtons; `None` for the onset of three-double, whose load alone is printed.
    pub friction_n: Option<f64>,
}

impl FrictionCurve {
    /// Creates the curve of these states by a law, with the edges of `band`.
    pub(crate) fn from_states(
        law: Law,
        status: PredictionStatus,
        reasons: Vec<String>,
        states: &[SwitchState],
        band: &Band,
    ) -> Self {
        let column = |f: fn(&SwitchState) -> f64| states.iter().map(f).collect::<Vec<_>>();
        let halves: Vec<(f64, f64)> = states.iter().map(|s| band.half_width_at(s.load_n)).collect();
        let edge = |log: fn(&(f64, f64)) -> f64| {
            states.iter().zip(&halves).map(|(s, half)| s.friction_n * libm::exp(log(half))).collect()
        };
        Self {
            law,
            status,
            reasons,
            load_n: column(|s| s.load_n),
            eccentric_n: column(|s| s.eccentric_n),
            concentric_n: column(|s| s.concentric_n),
            friction_n: column(|s| s.friction_n),
            band_low_n: edge(|half| -half.0),
            band_high_n: edge(|half| half.1),
            silicone_share: column(|s| s.silicone_share),
        }
    }
}

/// Returns the published points of this contact: its maximum, and the onset of switching of
/// three-double. Empty for a contact that the paper did not measure.
pub fn published_points(contact: &Contact) -> Vec<PublishedPoint> {
    if !is_measured(contact) {
        return Vec::new();
    }
    let maximum = |d| PublishedPoint { load_n: published::heaviest_load_n(), friction_n: Some(d) };
    match (contact.published_layout(), contact.substrate()) {
        (Some(layout), substrate) => {
            let mut points = vec![maximum(layout.max_n(substrate))];
            if layout.name == "three-double" && substrate == Substrate::Silicone {
                points.push(PublishedPoint { load_n: published::THREE_DOUBLE_ONSET_N, friction_n: None });
            }
            points
        }
        (None, Substrate::Silicone) if contact.pins().count() == 0 => {
            vec![maximum(published::SILICONE_ALONE_MAX_N)]
        }
        _ => Vec::new(),
    }
}
