//! The status of a prediction: how well measurements support it, with the reasons.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::contact::Contact;
use crate::deviation::{Deviation, is_published_rig};
use crate::plural::pluralise;
use crate::published;
use crate::substrate::Substrate;

/// Numbers of pins covered by the published layouts.
const PINS_MEASURED: std::ops::RangeInclusive<usize> = 3..=6;
/// Tolerance of the published pitches, in radians.
const PITCH_SLACK_RAD: f64 = 1e-3;
/// Relative tolerance of the tested loads.
const LOAD_SLACK: f64 = 1e-3;

/// Share of the heaviest load below which nothing was measured, so that the laws are compared.
const UNMEASURED_BELOW: f64 = 0.9;

/// Support of a prediction by measurements.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum PredictionStatus {
    /// Condition that the paper measured.
    Published,
    /// Condition between measured ones.
    Interpolated,
    /// Condition outside the measured range.
    Extrapolated,
}

impl PredictionStatus {
    /// Returns its word, as in files.
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::Published => "published",
            Self::Interpolated => "interpolated",
            Self::Extrapolated => "extrapolated",
        }
    }
}

/// Whether the paper measured the condition: bare silicone or a published layout, on the published
/// rig.
pub(crate) fn is_measured(contact: &Contact) -> bool {
    let bare = contact.substrate() == Substrate::Silicone && contact.all_pins().count() == 0;
    (bare || contact.published_layout().is_some())
        && contact.remarks().is_empty()
        && is_published_rig(contact)
}

/// Returns the status of a prediction for `contact` at `loads_n` newtons, with its reasons;
/// `deviations` are those of the contact.
pub(crate) fn prediction_status(
    contact: &Contact,
    deviations: &[Deviation],
    loads_n: &[f64],
) -> (PredictionStatus, Vec<String>) {
    let heaviest_n = loads_n.iter().copied().fold(0.0, f64::max);
    let mut reasons: Vec<String> = deviations.iter().map(|d| d.reason(heaviest_n)).collect();
    reasons.extend(contact.remarks());
    reasons.extend(untested_loads(loads_n));
    let measured = contact.published_layout().is_some() || contact.all_pins().count() == 0;
    if !measured {
        reasons.extend(unmeasured_layout(contact));
    }
    if !reasons.is_empty() {
        return (PredictionStatus::Extrapolated, reasons);
    }
    if measured {
        let (light, heavy) = (published::lightest_load_n(), published::heaviest_load_n());
        if loads_n.iter().any(|load| *load < UNMEASURED_BELOW * heavy) {
            reasons.push(format!(
                "the paper prints the friction of this condition at {heavy:.2} N only; from {light:.2} N to {heavy:.2} N the band includes the disagreement of the laws"
            ));
        }
        return (PredictionStatus::Published, reasons);
    }
    let (narrow, wide) = measured_pitches_rad();
    reasons.push(format!(
        "{} pins {:.2} deg apart are between the measured layouts: 3 to 6 pins, {:.2} to {:.2} deg",
        contact.pins().count(),
        contact.pins().mean_pitch_rad().unwrap_or_default().to_degrees(),
        narrow.to_degrees(),
        wide.to_degrees()
    ));
    (PredictionStatus::Interpolated, reasons)
}

/// Returns the reason text for loads outside the tested range, if any.
fn untested_loads(loads_n: &[f64]) -> Option<String> {
    let lightest = loads_n.iter().copied().fold(f64::INFINITY, f64::min);
    let heaviest = loads_n.iter().copied().fold(0.0, f64::max);
    let (from, to) = (published::lightest_load_n(), published::heaviest_load_n());
    (lightest < from * (1.0 - LOAD_SLACK) || heaviest > to * (1.0 + LOAD_SLACK)).then(|| {
        format!("loads from {lightest:.2} to {heaviest:.2} N exceed the tested range, {from:.2} to {to:.2} N")
    })
}

/// Returns the smallest and the largest published pitch in radians.
fn measured_pitches_rad() -> (f64, f64) {
    let pitches = published::LAYOUTS.map(|l| l.pitch_rad());
    (pitches.iter().copied().fold(f64::MAX, f64::min), pitches.iter().copied().fold(0.0, f64::max))
}

/// Returns the reason texts for a layout outside the measured range.
fn unmeasured_layout(contact: &Contact) -> Vec<String> {
    let pins = contact.pins();
    let mut reasons = Vec::new();
    if !PINS_MEASURED.contains(&pins.count()) {
        reasons.push(format!("{}; the measured layouts have 3 or 6", pluralise(pins.count(), "pin")));
    }
    let (narrow, wide) = measured_pitches_rad();
    if let Some(pitch) = pins.mean_pitch_rad()
        && !(narrow - PITCH_SLACK_RAD..=wide + PITCH_SLACK_RAD).contains(&pitch)
    {
        reasons.push(format!(
            "the pitch is {:.2} deg; those of the measured layouts are {:.2} to {:.2} deg",
            pitch.to_degrees(),
            narrow.to_degrees(),
            wide.to_degrees()
        ));
    }
    let degrees = || {
        let angles: Vec<_> = pins.angles_rad().iter().map(|a| format!("{:.2}", a.to_degrees())).collect();
        angles.join(", ")
    };
    if !pins.is_even() {
        reasons.push(format!(
            "the pins are unevenly spaced, at {} deg; the measured layouts are even",
            degrees()
        ));
    }
    if !pins.is_centred() {
        reasons.push(format!(
            "the pins are off the middle of the wrap, at {} deg; the measured layouts are centred",
            degrees()
        ));
    }
    reasons
}

/// Returns two distances of the layout of `contact`: from the nearest measured layout, and from the
/// measured range.
///
/// A distance is a length over the logarithms of number and pitch, the unevenness, and the offset
/// from the middle.
pub(crate) fn layout_distance(contact: &Contact) -> (f64, f64) {
    let pins = contact.all_pins();
    if pins.count() == 0 {
        return (0.0, 0.0);
    }
    let angles = pins.angles_rad();
    let wrap = contact.wrap_rad();
    let (log_count, pitch) = (libm::log(pins.count() as f64), pins.mean_pitch_rad().unwrap_or(wrap));
    let gaps = angles.windows(2).map(|w| ((w[1] - w[0]) / pitch - 1.0).powi(2));
    let uneven = gaps.sum::<f64>() / (pins.count().max(2) - 1) as f64;
    let offset = (angles.iter().sum::<f64>() / pins.count() as f64 / (wrap / 2.0)).powi(2);
    let nearest = published::LAYOUTS
        .iter()
        .map(|l| (log_count - libm::log(l.pins as f64)).powi(2) + libm::log(pitch / l.pitch_rad()).powi(2))
        .fold(f64::INFINITY, f64::min);
    let outside = |x: f64, from: f64, to: f64| (from - x).max(x - to).max(0.0);
    let (narrow, wide) = measured_pitches_rad();
    let beyond = outside(log_count, libm::log(3f64), libm::log(6f64)).powi(2)
        + outside(libm::log(pitch), libm::log(narrow), libm::log(wide)).powi(2);
    ((nearest + uneven + offset).sqrt(), (beyond + uneven + offset).sqrt())
}
