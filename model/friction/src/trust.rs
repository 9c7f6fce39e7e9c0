//! How far the friction of a contact is known from measurements, and why no further.

use serde::{Deserialize, Serialize};

use crate::published;
use crate::{Contact, Substrate};

/// Relative uncertainty outside what was measured, where every law is a guess.
pub(crate) const EXTRAPOLATED_SPREAD: f64 = 0.40;
/// Number of pins between which the published layouts lie.
const PINS_MEASURED: std::ops::RangeInclusive<usize> = 3..=6;
/// Slack on the published pitches, in radians.
const PITCH_SLACK_RAD: f64 = 1e-3;

/// How far a curve can be trusted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Trust {
    /// A condition that the paper measured.
    Published,
    /// Between measured conditions.
    Interpolated,
    /// Outside them: a guess.
    Extrapolated,
}

/// How far the friction of `contact` is known from measurements, and why no further.
pub(crate) fn trust(contact: &Contact) -> (Trust, Vec<String>) {
    let mut reasons = contact.departures();
    let pins = contact.pins();
    let bare_silicone = contact.substrate() == Substrate::Silicone && pins.count() == 0;
    if bare_silicone || contact.published_layout().is_some() {
        let trust = if reasons.is_empty() { Trust::Published } else { Trust::Extrapolated };
        return (trust, reasons);
    }
    if !PINS_MEASURED.contains(&pins.count()) {
        reasons.push(format!("{} pin(s); measured were 3 and 6", pins.count()));
    }
    let pitches = published::LAYOUTS.map(|l| l.pitch_rad());
    let (narrow, wide) =
        (pitches.iter().copied().fold(f64::MAX, f64::min), pitches.iter().copied().fold(0.0, f64::max));
    match pins.mean_pitch_rad() {
        Some(pitch) if pitch < narrow - PITCH_SLACK_RAD || pitch > wide + PITCH_SLACK_RAD => {
            reasons.push(format!(
                "the pitch is {:.2} deg; measured were {:.2} to {:.2} deg",
                pitch.to_degrees(),
                narrow.to_degrees(),
                wide.to_degrees()
            ))
        }
        _ => {}
    }
    if !pins.is_even() {
        reasons.push("the pins are unevenly spaced; measured were even ones".to_owned());
    }
    if !pins.is_centred() {
        reasons.push("the pins lie off the middle of the wrap; measured were centred ones".to_owned());
    }
    if reasons.is_empty() {
        reasons.push("this layout lies between those that were measured".to_owned());
        (Trust::Interpolated, reasons)
    } else {
        (Trust::Extrapolated, reasons)
    }
}
