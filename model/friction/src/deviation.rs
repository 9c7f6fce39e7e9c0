//! How a contact departs from the measured ones: every parameter that enters friction, in one table.

use serde::Serialize;

use crate::bed::{Bed, shore_a_of_modulus_mpa};
use crate::contact::Contact;
use crate::pattern::PinPattern;
use crate::physics::{Constants, PhysicsSwitch};
use crate::published;
use crate::sort::sort_by_number;
use crate::substrate::Substrate;

/// A parameter of a contact besides the layout of its pins.
struct Parameter {
    /// What it is, for reasons.
    name: &'static str,
    /// Unit of the value that is shown.
    unit: &'static str,
    /// Whether the paper prints it; else it is assumed for the published rig.
    printed: bool,
    /// What share of the effect that physics gives it is unsure.
    unsure: f64,
    /// Its value: any scale on which a ratio means something.
    get: fn(&Contact) -> f64,
    /// The value as it is shown, in `unit`.
    shown: fn(f64) -> f64,
    /// The same contact with the value of another.
    with: fn(&Contact, f64) -> Option<Contact>,
}

/// How the constants follow geometry and hardness is assumed, never measured: half of an effect is unsure. Chosen.
const UNSURE_SCALING: f64 = 0.5;
/// That friction follows the wrap is the capstan's, and asks for no such assumption. Chosen.
const UNSURE_WRAP: f64 = 0.1;

/// A parameter of the bed.
macro_rules! of_bed {
    ($name:literal, $unit:literal, $printed:literal, $field:ident, $shown:expr) => {
        Parameter {
            name: $name,
            unit: $unit,
            printed: $printed,
            unsure: UNSURE_SCALING,
            get: |contact| contact.bed().$field,
            shown: $shown,
            with: |contact, value| Some(contact.clone().with_bed(Bed { $field: value, ..*contact.bed() })),
        }
    };
}

/// Every parameter that enters friction, besides the pins' angles and the load.
static PARAMETERS: [Parameter; 8] = [
    Parameter {
        name: "wrap angle",
        unit: "deg",
        printed: true,
        unsure: UNSURE_WRAP,
        get: Contact::wrap_rad,
        shown: f64::to_degrees,
        with: |contact, value| contact.at_wrap(value).ok(),
    },
    of_bed!("radius of the silicone's surface", "mm", false, contact_radius_mm, |x| x),
    of_bed!("tendon diameter over the coating", "mm", true, tendon_radius_mm, |x| 2.0 * x),
    of_bed!("pin diameter", "mm", true, pin_diameter_mm, |x| x),
    of_bed!("groove radius", "mm", true, groove_radius_mm, |x| x),
    of_bed!("layer thickness", "mm", true, layer_mm, |x| x),
    of_bed!("layer width", "mm", false, layer_width_mm, |x| x),
    of_bed!("hardness of the silicone", "Shore A", true, modulus_mpa, shore_a_of_modulus_mpa),
];

/// Relative difference below which two values are one.
const SAME: f64 = 1e-9;
/// Change of friction that is none.
const NO_EFFECT: f64 = 5e-4;

/// A parameter in which a contact differs from the published rig.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Deviation {
    /// The parameter, such as `layer thickness`.
    pub parameter: &'static str,
    /// Its value here, in `unit`.
    pub value: f64,
    /// Its value on the published rig, in `unit`.
    pub published: f64,
    /// Unit of both.
    pub unit: &'static str,
    /// Whether the paper prints the published value; else it is assumed.
    pub printed: bool,
    /// What share of its effect is unsure, as a standard deviation.
    pub unsure: f64,
    /// Natural logarithm of the ratio of both.
    pub log_ratio: f64,
    /// What physics says it does: logarithm of friction here over that with the published value, load by load; empty if
    /// it finds no equilibrium.
    pub log_effect: Vec<f64>,
}

impl Deviation {
    /// In words, with the effect at the last of the loads, `heaviest_n`.
    pub(crate) fn reason(&self, heaviest_n: f64) -> String {
        let known = if self.printed { "measured was" } else { "assumed for the published rig is" };
        let effect = match self.log_effect.last() {
            None => "physics finds no equilibrium to compare".to_owned(),
            Some(effect) if effect.abs() < NO_EFFECT => {
                format!("physics says it changes friction at {heaviest_n:.2} N by less than 0.05 %")
            }
            Some(effect) => {
                format!(
                    "physics says {:+.1} % of friction at {heaviest_n:.2} N",
                    100.0 * libm::expm1(*effect)
                )
            }
        };
        // As many digits as tell the two apart.
        let places = (3..9)
            .find(|places| format!("{:.places$}", self.value) != format!("{:.places$}", self.published))
            .unwrap_or(9);
        let digits = |x: f64| {
            let text = format!("{x:.places$}");
            text.trim_end_matches('0').trim_end_matches('.').to_owned()
        };
        format!(
            "{} is {} {}, {known} {} {}; {effect}",
            self.parameter,
            digits(self.value),
            self.unit,
            digits(self.published),
            self.unit
        )
    }
}

/// The deviations of `contact` from the published rig, with their effects at `loads_n`; largest effect at the last load
/// first.
pub(crate) fn deviations(contact: &Contact, loads_n: &[f64]) -> Vec<Deviation> {
    let Some(reference) = published_rig(contact) else { return Vec::new() };
    let differing: Vec<_> = PARAMETERS
        .iter()
        .map(|p| (p, (p.get)(contact), (p.get)(&reference)))
        .filter(|(_, value, published)| (value / published - 1.0).abs() > SAME)
        .collect();
    if differing.is_empty() {
        return Vec::new();
    }
    let logs = |contact: &Contact| -> Option<Vec<f64>> {
        let states = PhysicsSwitch::new(contact, Constants::published()).states(loads_n).ok()?;
        Some(states.iter().map(|s| libm::log(s.friction_n)).collect())
    };
    let here = logs(contact);
    let mut all: Vec<Deviation> = differing
        .into_iter()
        .map(|(p, value, published)| {
            let there = (p.with)(contact, published).and_then(|c| logs(&c));
            let log_effect = match (&here, there) {
                // Where nothing rubs, at no load, nothing changes.
                (Some(here), Some(there)) => here
                    .iter()
                    .zip(&there)
                    .map(|(a, b)| if a.is_finite() && b.is_finite() { a - b } else { 0.0 })
                    .collect(),
                _ => Vec::new(),
            };
            Deviation {
                parameter: p.name,
                value: (p.shown)(value),
                published: (p.shown)(published),
                unit: p.unit,
                printed: p.printed,
                unsure: p.unsure,
                log_ratio: libm::log(value / published),
                log_effect,
            }
        })
        .collect();
    let size = |d: &Deviation| d.log_effect.last().map_or(f64::INFINITY, |e| e.abs());
    sort_by_number(&mut all, |d| -size(d));
    all
}

/// Whether every parameter but the pins' angles is that of the published rig.
pub(crate) fn is_published_rig(contact: &Contact) -> bool {
    published_rig(contact).is_some_and(|reference| {
        PARAMETERS.iter().all(|p| ((p.get)(contact) / (p.get)(&reference) - 1.0).abs() <= SAME)
    })
}

/// The same pins on the published rig.
pub(crate) fn published_rig(contact: &Contact) -> Option<Contact> {
    let all = contact.all_pins().clone();
    let wrap = published::wrap_angle_rad();
    // A proxy whose pins all lie outside the published wrap has no counterpart; a bare bed has the same parameters.
    Contact::new(contact.substrate(), all, wrap)
        .or_else(|_| Contact::new(Substrate::Silicone, PinPattern::default(), wrap))
        .ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bed::modulus_of_shore_a_mpa;

    fn three_double() -> Contact {
        let layout = &published::LAYOUTS[1];
        let pins = PinPattern::even(layout.pins, layout.pitch_rad());
        Contact::new(Substrate::Silicone, pins, published::wrap_angle_rad()).unwrap()
    }

    #[test]
    fn every_parameter_that_moves_departs_and_says_what_it_does() {
        for p in &PARAMETERS {
            let base = three_double();
            assert!(is_published_rig(&base) && deviations(&base, &[49.671]).is_empty());
            let moved = (p.with)(&base, 1.05 * (p.get)(&base)).unwrap();
            let found = deviations(&moved, &[10.0, 49.671]);
            assert_eq!(found.len(), 1, "{}", p.name);
            assert!(!is_published_rig(&moved), "{}", p.name);
            assert_eq!((found[0].parameter, found[0].log_effect.len()), (p.name, 2));
            assert!((found[0].log_ratio - libm::log(1.05f64)).abs() < 1e-9);
            assert!(found[0].reason(49.671).starts_with(p.name), "{}", found[0].reason(49.671));
        }
    }

    /// The table knows every number of the bed that a part can change: a bed that differs in any of them departs.
    #[test]
    fn no_number_of_the_bed_is_forgotten() {
        let Bed {
            contact_radius_mm: _,
            tendon_radius_mm: _,
            pin_diameter_mm: _,
            groove_radius_mm: _,
            layer_mm: _,
            layer_width_mm: _,
            modulus_mpa: _,
            // Constants of the model, the same for every part.
            foundation_n_mm2: _,
            bending_n_mm2: _,
            softening: _,
            outside: _,
        } = Bed::published();
        assert_eq!(PARAMETERS.len(), 7 + 1, "seven of the bed, and the wrap");
    }

    #[test]
    fn hardness_is_shown_as_it_is_given() {
        let soft = Bed { modulus_mpa: modulus_of_shore_a_mpa(20.0), ..Bed::published() };
        let found = deviations(&three_double().with_bed(soft), &[49.671]);
        assert!((found[0].value - 20.0).abs() < 1e-6 && (found[0].published - 50.0).abs() < 1e-6);
        let reason = found[0].reason(49.671);
        assert!(
            reason.starts_with("hardness of the silicone is 20 Shore A, measured was 50 Shore A"),
            "{reason}"
        );
    }
}
