//! How far the friction of a contact is known from measurements, and why no further.

use serde::{Deserialize, Serialize};

use crate::contact::Contact;
use crate::deviation::{Deviation, is_published_rig};
use crate::plural::pluralise;
use crate::published;
use crate::substrate::Substrate;

/// Number of pins between which the published layouts lie.
const PINS_MEASURED: std::ops::RangeInclusive<usize> = 3..=6;
/// Slack on the published pitches, in radians.
const PITCH_SLACK_RAD: f64 = 1e-3;
/// Slack on the tested loads, relative.
const LOAD_SLACK: f64 = 1e-3;

/// How far a curve can be trusted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum PredictionStatus {
    /// A condition that the paper measured.
    Published,
    /// Between measured conditions.
    Interpolated,
    /// Outside them: a guess.
    Extrapolated,
}

/// Whether the paper measured this very condition: silicone alone or one of its layouts, on its rig.
pub(crate) fn is_measured(contact: &Contact) -> bool {
    let bare = contact.substrate() == Substrate::Silicone && contact.all_pins().count() == 0;
    (bare || contact.published_layout().is_some())
        && contact.remarks().is_empty()
        && is_published_rig(contact)
}

/// How far the friction of `contact` is known at `loads_n`, and why no further; `deviations` are its own.
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
        if loads_n.iter().any(|load| *load < 0.9 * heavy) {
            reasons.push(format!(
                "the paper prints the friction of this condition at {heavy:.2} N only; from {light:.2} N up to there the band also covers what the laws disagree on"
            ));
        }
        return (PredictionStatus::Published, reasons);
    }
    let (narrow, wide) = measured_pitches_rad();
    reasons.push(format!(
        "{} pins {:.2} deg apart lie between the layouts that were measured: 3 to 6 pins, {:.2} to {:.2} deg",
        contact.pins().count(),
        contact.pins().mean_pitch_rad().unwrap_or_default().to_degrees(),
        narrow.to_degrees(),
        wide.to_degrees()
    ));
    (PredictionStatus::Interpolated, reasons)
}

/// The loads outside those tested, in words.
fn untested_loads(loads_n: &[f64]) -> Option<String> {
    let lightest = loads_n.iter().copied().fold(f64::INFINITY, f64::min);
    let heaviest = loads_n.iter().copied().fold(0.0, f64::max);
    let (from, to) = (published::lightest_load_n(), published::heaviest_load_n());
    (lightest < from * (1.0 - LOAD_SLACK) || heaviest > to * (1.0 + LOAD_SLACK)).then(|| {
        format!("the loads reach from {lightest:.2} to {heaviest:.2} N; tested were {from:.2} to {to:.2} N")
    })
}

fn measured_pitches_rad() -> (f64, f64) {
    let pitches = published::LAYOUTS.map(|l| l.pitch_rad());
    (pitches.iter().copied().fold(f64::MAX, f64::min), pitches.iter().copied().fold(0.0, f64::max))
}

/// In what a layout lies outside the measured ones.
fn unmeasured_layout(contact: &Contact) -> Vec<String> {
    let pins = contact.pins();
    let mut reasons = Vec::new();
    if !PINS_MEASURED.contains(&pins.count()) {
        reasons.push(format!("{}; measured were 3 and 6", pluralise(pins.count(), "pin")));
    }
    let (narrow, wide) = measured_pitches_rad();
    if let Some(pitch) = pins.mean_pitch_rad()
        && !(narrow - PITCH_SLACK_RAD..=wide + PITCH_SLACK_RAD).contains(&pitch)
    {
        reasons.push(format!(
            "the pitch is {:.2} deg; measured were {:.2} to {:.2} deg",
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
        reasons.push(format!("the pins are unevenly spaced, at {} deg; measured were even ones", degrees()));
    }
    if !pins.is_centred() {
        reasons.push(format!(
            "the pins lie off the middle of the wrap, at {} deg; measured were centred ones",
            degrees()
        ));
    }
    reasons
}

/// How far the layout of `contact` lies from the nearest measured one, as a length in the logarithms of number and
/// pitch, unevenness and offset; and how far beyond the range of the measured ones.
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
