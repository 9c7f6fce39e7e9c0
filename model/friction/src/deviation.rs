//! Deviations of a contact from the published rig: every parameter that friction depends on, in one
//! table.

use serde::Serialize;

use crate::bed::{Bed, shore_a_of_modulus_mpa};
use crate::contact::Contact;
use crate::pattern::PinPattern;
use crate::physics::{Constants, PhysicsSwitch};
use crate::published;
use crate::reference::reference_friction_n;
use crate::sort::sort_by_number;
use crate::substrate::Substrate;

/// Parameter of a contact, other than the layout of its pins.
struct Parameter {
    /// Name in reasons.
    name: &'static str,
    /// Unit of the displayed value.
    unit: &'static str,
    /// Whether the paper prints its value; else the value of the published rig is assumed.
    is_printed: bool,
    /// Relative standard deviation of the effect that the physics predicts for it.
    uncertainty: f64,
    /// Returns its value, on a ratio scale.
    get: fn(&Contact) -> f64,
    /// Converts a value into `unit`.
    display: fn(f64) -> f64,
    /// Returns the contact with another value.
    with: fn(&Contact, f64) -> Option<Contact>,
}

/// Relative uncertainty of an effect of geometry or hardness. The scaling of the constants is
/// assumed, not measured. Chosen.
const SCALING_UNCERTAINTY: f64 = 0.5;
/// Relative uncertainty of the effect of the wrap angle, which follows from the capstan. Chosen.
const WRAP_UNCERTAINTY: f64 = 0.1;

/// Declares a parameter of the bed.
macro_rules! bed_parameter {
    ($name:literal, $unit:literal, $is_printed:literal, $field:ident, $display:expr) => {
        Parameter {
            name: $name,
            unit: $unit,
            is_printed: $is_printed,
            uncertainty: SCALING_UNCERTAINTY,
            get: |contact| contact.bed().$field,
            display: $display,
            with: |contact, value| Some(contact.clone().with_bed(Bed { $field: value, ..*contact.bed() })),
        }
    };
}

/// Every parameter that friction depends on, except the angles of the pins and the load.
static PARAMETERS: [Parameter; 8] = [
    Parameter {
        name: "wrap angle",
        unit: "deg",
        is_printed: true,
        uncertainty: WRAP_UNCERTAINTY,
        get: Contact::wrap_rad,
        display: f64::to_degrees,
        with: |contact, value| contact.at_wrap(value).ok(),
    },
    bed_parameter!("radius of the silicone's surface", "mm", false, contact_radius_mm, |x| x),
    bed_parameter!("tendon diameter over the coating", "mm", true, tendon_radius_mm, |x| 2.0 * x),
    bed_parameter!("pin diameter", "mm", true, pin_diameter_mm, |x| x),
    bed_parameter!("groove radius", "mm", true, groove_radius_mm, |x| x),
    bed_parameter!("layer thickness", "mm", true, layer_mm, |x| x),
    bed_parameter!("layer width", "mm", false, layer_width_mm, |x| x),
    bed_parameter!("hardness of the silicone", "Shore A", true, modulus_mpa, shore_a_of_modulus_mpa),
];

/// Largest relative difference between equal values.
const SAME: f64 = 1e-9;
/// Change of friction below which an effect is reported as below 0.05 %.
const NO_EFFECT: f64 = 5e-4;

/// Parameter in which a contact differs from the published rig.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Deviation {
    /// Name of the parameter, such as `layer thickness`.
    pub parameter: &'static str,
    /// Value of the contact, in `unit`.
    pub value: f64,
    /// Value of the published rig, in `unit`.
    pub published: f64,
    /// Unit of both values.
    pub unit: &'static str,
    /// Whether the paper prints the published value; else it is assumed.
    pub is_printed: bool,
    /// Relative standard deviation of its effect.
    pub uncertainty: f64,
    /// Natural logarithm of `value` over `published`.
    pub log_ratio: f64,
    /// Effect by the physics, load by load: natural logarithm of friction with `value` over
    /// friction with `published`. Empty without an equilibrium.
    pub log_effect: Vec<f64>,
}

impl Deviation {
    /// Returns the reason text, with the effect at the last load, `heaviest_n` newtons.
    pub(crate) fn reason(&self, heaviest_n: f64) -> String {
        let rig = if self.is_printed { "published rig" } else { "published rig, assumed" };
        let effect = match self.log_effect.last() {
            None => "effect unknown: the physics does not converge".to_owned(),
            Some(effect) if effect.abs() < NO_EFFECT => {
                format!("predicted change of friction below 0.05 % at {heaviest_n:.2} N")
            }
            Some(effect) => {
                format!(
                    "predicted change of friction {:+.1} % at {heaviest_n:.2} N",
                    100.0 * libm::expm1(*effect)
                )
            }
        };
        // Enough decimal places to distinguish both values.
        let places = (3..9)
            .find(|places| format!("{:.places$}", self.value) != format!("{:.places$}", self.published))
            .unwrap_or(9);
        let digits = |x: f64| {
            let text = format!("{x:.places$}");
            text.trim_end_matches('0').trim_end_matches('.').to_owned()
        };
        format!(
            "{} is {} {} ({rig}: {} {}); {effect}",
            self.parameter,
            digits(self.value),
            self.unit,
            digits(self.published),
            self.unit
        )
    }
}

/// Computes the deviations of `contact` from the published rig, with their effects at `loads_n`
/// newtons, in descending order of the effect at the last load.
pub(crate) fn deviations(contact: &Contact, loads_n: &[f64]) -> Vec<Deviation> {
    let states = PhysicsSwitch::new(contact, Constants::published()).states(loads_n).ok();
    let here: Option<Vec<f64>> = states.map(|states| states.iter().map(|s| s.friction_n).collect());
    deviations_from(contact, loads_n, here.as_deref())
}

/// Computes the deviations as [`deviations`], from the friction of `contact` at `loads_n` by the
/// physics; `None` if that does not converge.
pub(crate) fn deviations_from(contact: &Contact, loads_n: &[f64], here_n: Option<&[f64]>) -> Vec<Deviation> {
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
        let friction_n = reference_friction_n(contact, loads_n).ok()?;
        Some(friction_n.into_iter().map(libm::log).collect())
    };
    let here: Option<Vec<f64>> = here_n.map(|all| all.iter().map(|d| libm::log(*d)).collect());
    let mut all: Vec<Deviation> = differing
        .into_iter()
        .map(|(p, value, published)| {
            let reference = (p.with)(contact, published).and_then(|c| logs(&c));
            let log_effect = match (&here, reference) {
                // Without load, friction and its change are zero.
                (Some(here), Some(reference)) => here
                    .iter()
                    .zip(&reference)
                    .map(|(a, b)| if a.is_finite() && b.is_finite() { a - b } else { 0.0 })
                    .collect(),
                _ => Vec::new(),
            };
            Deviation {
                parameter: p.name,
                value: (p.display)(value),
                published: (p.display)(published),
                unit: p.unit,
                is_printed: p.is_printed,
                uncertainty: p.uncertainty,
                log_ratio: libm::log(value / published),
                log_effect,
            }
        })
        .collect();
    let size = |d: &Deviation| d.log_effect.last().map_or(f64::INFINITY, |e| e.abs());
    sort_by_number(&mut all, |d| -size(d));
    all
}

/// Whether every parameter, except the angles of the pins, is that of the published rig.
pub(crate) fn is_published_rig(contact: &Contact) -> bool {
    published_rig(contact).is_some_and(|reference| {
        PARAMETERS.iter().all(|p| ((p.get)(contact) / (p.get)(&reference) - 1.0).abs() <= SAME)
    })
}

/// Returns the same pins on the published rig.
pub(crate) fn published_rig(contact: &Contact) -> Option<Contact> {
    let all = contact.all_pins().clone();
    let wrap = published::wrap_angle_rad();
    // A proxy with all pins outside the published wrap has no counterpart. Bare silicone has the
    // same parameters.
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
    fn every_changed_parameter_is_a_deviation() {
        for p in &PARAMETERS {
            let base = three_double();
            assert!(is_published_rig(&base) && deviations(&base, &[49.671]).is_empty());
            let moved = (p.with)(&base, 1.05 * (p.get)(&base)).unwrap();
            let all = deviations(&moved, &[10.0, 49.671]);
            assert_eq!(all.len(), 1, "{}", p.name);
            assert!(!is_published_rig(&moved), "{}", p.name);
            assert_eq!((all[0].parameter, all[0].log_effect.len()), (p.name, 2));
            assert!((all[0].log_ratio - libm::log(1.05f64)).abs() < 1e-9);
            assert!(all[0].reason(49.671).starts_with(p.name), "{}", all[0].reason(49.671));
        }
    }

    /// A new field of the bed does not compile here until the table is reviewed.
    #[test]
    fn table_covers_every_bed_dimension() {
        let Bed {
            contact_radius_mm: _,
            tendon_radius_mm: _,
            pin_diameter_mm: _,
            groove_radius_mm: _,
            layer_mm: _,
            layer_width_mm: _,
            modulus_mpa: _,
            // Constants of the model, equal for all parts.
            foundation_n_mm2: _,
            bending_n_mm2: _,
            softening: _,
            outside: _,
        } = Bed::published();
        assert_eq!(PARAMETERS.len(), 7 + 1, "seven of the bed, and the wrap angle");
    }

    #[test]
    fn hardness_is_shown_in_shore_a() {
        let soft = Bed { modulus_mpa: modulus_of_shore_a_mpa(20.0), ..Bed::published() };
        let all = deviations(&three_double().with_bed(soft), &[49.671]);
        assert!((all[0].value - 20.0).abs() < 1e-6 && (all[0].published - 50.0).abs() < 1e-6);
        let reason = all[0].reason(49.671);
        assert!(
            reason.starts_with("hardness of the silicone is 20 Shore A (published rig: 50 Shore A)"),
            "{reason}"
        );
    }
}
