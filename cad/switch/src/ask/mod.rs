//! An ask: what a switch should do, within which limits, from which materials, and what may vary.
//!
//! `cad/doc/design.md` explains every field; [`Ask::read`] reads a file, [`parse_wish`] a wish from the command line.

mod parameter;
mod phrase;
mod read;
mod target;
mod tolerance;

use serde::{Deserialize, Serialize};

pub use parameter::Parameter;
pub use phrase::{FORMS, parse_wish, share_of};
pub use target::{Quantity, Target, Wish};
pub use tolerance::{SOURCES, Tolerances};

/// `within` of an `about` that gives none.
pub const DEFAULT_WITHIN: f64 = 0.10;

/// Targets, limits, what may vary, materials at hand, and how well parts are made.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Ask {
    /// What is wanted of the curve, all at once.
    pub targets: Vec<Target>,
    /// Lightest and heaviest load, N; those of the configuration if absent, widened to the loads of the targets.
    pub load_range_n: Option<(f64, f64)>,
    /// What the part must keep to.
    pub limits: Limits,
    /// What the search may change.
    pub vary: Vary,
    /// What is at hand.
    pub materials: Materials,
    /// How far made parts depart from their configuration.
    pub tolerances: Tolerances,
}

/// Limits of the part.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Limits {
    /// Fewest and most pins.
    pub pins: Option<(usize, usize)>,
    /// Largest radius of the assembled switch, its side supports, mm.
    pub outer_radius_mm: Option<f64>,
    /// Largest width of the assembled switch over both supports, mm.
    pub outer_width_mm: Option<f64>,
    /// Template or file with the printer's settings, under which it must be printable.
    pub preset: Option<String>,
}

/// What the search may change.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Vary {
    /// Which grooves are occupied.
    pub pattern: bool,
    /// Continuous parameters, each within a range.
    pub parameters: Vec<Varied>,
}

/// A continuous parameter and the range in which it varies.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Varied {
    /// The parameter.
    pub parameter: Parameter,
    /// Its least value.
    pub from: f64,
    /// Its largest value.
    pub to: f64,
}

impl Varied {
    /// The parameter in its default range.
    pub const fn by_default(parameter: Parameter) -> Self {
        let (from, to) = parameter.default_range();
        Self { parameter, from, to }
    }
}

impl Default for Vary {
    /// Patterns, pitch and thickness: what another print and another casting change, with the same materials.
    fn default() -> Self {
        Self {
            pattern: true,
            parameters: vec![Varied::by_default(Parameter::PitchDeg), Varied::by_default(Parameter::LayerMm)],
        }
    }
}

/// What is at hand; an empty list leaves what the configuration says.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Materials {
    /// Diameters of pins, mm.
    pub pin_diameter_mm: Vec<f64>,
    /// Hardnesses of silicones, Shore A.
    pub hardness_shore_a: Vec<f64>,
    /// Tendons.
    pub tendon: Vec<Tendon>,
}

/// A tendon at hand.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Tendon {
    /// Diameter of the bare rope, mm.
    pub rope_diameter_mm: f64,
    /// Coating on the radius, mm.
    pub coating_mm: f64,
}

/// Why an ask cannot be used: it names the field, the value, the bound and the remedy.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{0}")]
pub struct AskError(pub String);

impl Ask {
    /// Checks that the ask can be searched for at all.
    ///
    /// # Errors
    /// [`AskError`] if nothing is asked, two targets contradict each other, or a value lies outside its bounds.
    pub fn check(&self) -> Result<(), AskError> {
        let fail = |text: String| Err(AskError(text));
        if self.targets.is_empty() {
            return fail("nothing is asked; give a threshold, a friction or a stiffness".to_owned());
        }
        for (i, a) in self.targets.iter().enumerate() {
            if let Some(b) = self.targets[i + 1..].iter().find(|b| a.contradicts(b)) {
                return fail(format!("'{a}' and '{b}' cannot both hold; drop one, or widen it"));
            }
        }
        if let Some((low, high)) = self.load_range_n
            && !(low >= 0.0 && low < high && high <= 1000.0)
        {
            return fail(format!(
                "load range {low}..{high} N is no range within 0 to 1000 N; give the lightest load first"
            ));
        }
        self.check_limits()?;
        self.check_parameters()?;
        let spreads = self.tolerances.sd();
        match Tolerances::FIELDS.iter().zip(spreads).find(|(_, sd)| !(*sd >= 0.0 && *sd <= 20.0)) {
            Some((field, sd)) => {
                fail(format!("tolerances.{field} = {sd} is no standard deviation; give one from 0 to 20"))
            }
            None => Ok(()),
        }
    }

    fn check_limits(&self) -> Result<(), AskError> {
        let lengths = [
            ("outer_radius_mm", self.limits.outer_radius_mm),
            ("outer_width_mm", self.limits.outer_width_mm),
        ];
        for (field, value) in lengths {
            if let Some(value) = value.filter(|v| !(*v > 0.0 && v.is_finite())) {
                return Err(AskError(format!(
                    "limits.{field} = {value} is not above 0 mm; give a length above 0"
                )));
            }
        }
        match self.limits.pins {
            Some((fewest, most)) if fewest == 0 || fewest > most => Err(AskError(format!(
                "limits.pins = {fewest}..{most}: a switch has at least 1 pin, and the smaller number stands first"
            ))),
            _ => Ok(()),
        }
    }

    fn check_parameters(&self) -> Result<(), AskError> {
        let within = |field: String, parameter: Parameter, value: f64| {
            let (least, most) = parameter.hard_range();
            if value >= least && value <= most {
                Ok(())
            } else {
                Err(AskError(format!(
                    "{field} = {value} is outside {least} to {most}, the range of {}; give a value within",
                    parameter.field()
                )))
            }
        };
        for (i, v) in self.vary.parameters.iter().enumerate() {
            let name = v.parameter.name();
            within(format!("vary.{name}"), v.parameter, v.from)?;
            within(format!("vary.{name}"), v.parameter, v.to)?;
            if v.from > v.to {
                return Err(AskError(format!(
                    "vary.{name} = {}..{} runs backwards; give the smaller value first",
                    v.from, v.to
                )));
            }
            if self.vary.parameters[..i].iter().any(|other| other.parameter == v.parameter) {
                return Err(AskError(format!("vary.{name} is given twice; give it once")));
            }
        }
        let lists = [
            (Parameter::PinDiameterMm, &self.materials.pin_diameter_mm),
            (Parameter::HardnessShoreA, &self.materials.hardness_shore_a),
        ];
        for (parameter, list) in lists {
            let name = parameter.name();
            for value in list {
                within(format!("materials.{name}"), parameter, *value)?;
            }
            if !list.is_empty() && self.vary.parameters.iter().any(|v| v.parameter == parameter) {
                return Err(AskError(format!(
                    "vary.{name} and materials.{name} cannot both be given; drop the one or the other"
                )));
            }
        }
        for tendon in &self.materials.tendon {
            if !((0.1..=6.0).contains(&tendon.rope_diameter_mm) && (0.0..=2.0).contains(&tendon.coating_mm)) {
                return Err(AskError(format!(
                    "materials.tendon: a rope of {} mm with {} mm of coating; give 0.1 to 6 mm and 0 to 2 mm",
                    tendon.rope_diameter_mm, tendon.coating_mm
                )));
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ask(targets: Vec<Target>) -> Ask {
        Ask { targets, ..Ask::default() }
    }

    #[test]
    fn what_cannot_be_searched_for_is_refused_with_both_names() {
        let friction = |wish| Target { quantity: Quantity::Friction { load_n: 50.0 }, wish };
        let error = ask(vec![friction(Wish::AtMost(3.0)), friction(Wish::AtLeast(5.0))]).check().unwrap_err();
        assert!(error.0.contains("at most 3 N") && error.0.contains("at least 5 N"), "{error}");
        assert!(ask(Vec::new()).check().unwrap_err().0.contains("nothing is asked"));
        let mut both = ask(vec![friction(Wish::AtMost(3.0))]);
        both.materials.pin_diameter_mm = vec![0.8];
        assert_eq!(both.check(), Ok(()));
        both.vary.parameters.push(Varied::by_default(Parameter::PinDiameterMm));
        assert!(both.check().unwrap_err().0.contains("vary.pin_diameter_mm and materials.pin_diameter_mm"));
    }

    #[test]
    fn ranges_outside_what_a_configuration_takes_are_refused() {
        let mut one = ask(vec![Target { quantity: Quantity::Threshold, wish: Wish::AtLeast(5.0) }]);
        one.vary.parameters = vec![Varied { parameter: Parameter::LayerMm, from: 1.0, to: 30.0 }];
        let error = one.check().unwrap_err().0;
        assert!(error.contains("vary.layer_mm = 30") && error.contains("0.3 to 10"), "{error}");
    }
}
