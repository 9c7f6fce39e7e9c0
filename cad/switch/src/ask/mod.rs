//! An ask: what a switch should do, within which limits, from which materials, and what may vary.
//!
//! `cad/doc/design.md` explains every field; [`Ask::read`] reads a file, [`parse_wish`] a wish from the command line.

mod parameter;
mod phrase;
mod read;
mod target;
mod tolerance;

use phrase::short;
use pinswitch_diagnostic::excerpt;
use pinswitch_friction::sort_by_number;
use serde::{Deserialize, Serialize};

pub use parameter::Parameter;
pub use phrase::{FORMS, parse_wish, share_of};
pub use target::{Quantity, Target, Wish};
pub use tolerance::{SOURCES, Tolerances};

/// `within` of an `about` that gives none.
pub const DEFAULT_WITHIN: f64 = 0.10;

/// Most characters of an error.
const LONGEST: usize = 580;

/// Smallest and largest size that can be asked for, mm.
const LEAST_SIZE_MM: f64 = 0.1;
/// See [`LEAST_SIZE_MM`].
const MOST_SIZE_MM: f64 = 1000.0;
/// Loads that differ by less than this share are one load.
const SAME_LOAD: f64 = 1e-6;

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
#[error("{}", excerpt(.0, LONGEST))]
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
        for target in &self.targets {
            target.check_magnitude().map_err(AskError)?;
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
                "load range {}..{} N is no range within 0 to 1000 N; give the lightest load first",
                short(low),
                short(high)
            ));
        }
        self.check_limits()?;
        self.check_parameters()?;
        let spreads = self.tolerances.sd();
        match Tolerances::FIELDS.iter().zip(spreads).find(|(_, sd)| !(*sd >= 0.0 && *sd <= 20.0)) {
            Some((field, sd)) => fail(format!(
                "tolerances.{field} = {} is no standard deviation; give one from 0 to 20",
                short(sd)
            )),
            None => Ok(()),
        }
    }

    /// Checks that the targets can hold together over these loads, the lightest and the heaviest, N.
    ///
    /// # Errors
    /// [`AskError`] if a threshold is asked outside of the loads, or if two frictions contradict each other at one load or
    /// because friction grows with load.
    pub fn check_loads(&self, (lightest, heaviest): (f64, f64)) -> Result<(), AskError> {
        for target in self.targets.iter().filter(|t| t.quantity == Quantity::Threshold) {
            let (low, high) = target.wish.interval();
            if low > heaviest || high < lightest {
                return Err(AskError(format!(
                    "'{target}' lies outside of the loads, ask.load_range_n = {lightest}..{heaviest} N, within which a \
                     threshold is looked for; widen the loads (--load-range), or ask for a threshold within them"
                )));
            }
        }
        let mut frictions: Vec<(f64, &Target)> = self
            .targets
            .iter()
            .filter_map(|t| Some((t.quantity.friction_load_n((lightest, heaviest))?, t)))
            .collect();
        sort_by_number(&mut frictions, |(load_n, _)| *load_n);
        for (i, (load, a)) in frictions.iter().enumerate() {
            for (other_load, b) in &frictions[i + 1..] {
                let is_same_load = other_load - load <= SAME_LOAD * load;
                let (a_of, b_of) = (a.wish.interval(), b.wish.interval());
                if a_of.0 > b_of.1 || (is_same_load && b_of.0 > a_of.1) {
                    let why = if is_same_load {
                        format!("both are about {load} N of load")
                    } else {
                        format!("friction grows with load, and {load} N is less than {other_load} N")
                    };
                    return Err(AskError(format!(
                        "'{a}' and '{b}' cannot both hold: {why}; drop one, or widen it"
                    )));
                }
            }
        }
        Ok(())
    }

    fn check_limits(&self) -> Result<(), AskError> {
        let lengths = [
            ("outer_radius_mm", self.limits.outer_radius_mm),
            ("outer_width_mm", self.limits.outer_width_mm),
        ];
        for (field, value) in lengths {
            if let Some(value) = value.filter(|v| !(*v > 0.0 && v.is_finite())) {
                return Err(AskError(format!(
                    "limits.{field} = {} is not above 0 mm; give a length above 0",
                    short(value)
                )));
            }
            if let Some(value) = value.filter(|v| !(LEAST_SIZE_MM..=MOST_SIZE_MM).contains(v)) {
                return Err(AskError(format!(
                    "limits.{field} = {} is outside {LEAST_SIZE_MM} to {MOST_SIZE_MM} mm, the sizes that a switch can \
                     be asked for; give a length within",
                    short(value)
                )));
            }
        }
        match self.limits.pins {
            Some((fewest, most)) if fewest == 0 || fewest > most => Err(AskError(format!(
                "limits.pins = {fewest}..{most}: a switch has at least 1 pin, and the smaller number stands first; give such as 1..{}",
                most.max(1)
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
                    "{field} = {} is outside {least} to {most}, the range of {}; give a value within",
                    short(value),
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
                    short(v.from),
                    short(v.to)
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
                    short(tendon.rope_diameter_mm),
                    short(tendon.coating_mm)
                )));
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn huge_numbers_are_shown_short() {
        for wish in [Wish::AtMost(1e300), Wish::About { value: 1e300, within: 0.1 }] {
            for quantity in [Quantity::Threshold, Quantity::Friction { load_n: 1e300 }] {
                let said = ask(vec![Target { quantity, wish }]).check().unwrap_err().to_string();
                assert!(said.contains("1e300") && said.len() < 160, "{said}");
            }
        }
    }

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
    fn what_loads_rule_out_is_refused_with_both_names() {
        let of = |quantity, wish| Target { quantity, wish };
        let at = |load_n, wish| of(Quantity::Friction { load_n }, wish);
        let (max, low) = (Quantity::MaxFriction, Quantity::LowLoadFriction);
        let refused = |targets: Vec<Target>, range| ask(targets).check_loads(range).unwrap_err().0;
        let about = of(Quantity::Threshold, Wish::About { value: 24.0, within: 0.1 });
        let error = refused(vec![about], (30.0, 60.0));
        assert!(error.contains("threshold about 24 N") && error.contains("30..60"), "{error}");
        for targets in [
            vec![of(max, Wish::AtMost(5.0)), at(49.671, Wish::AtLeast(8.0))],
            vec![at(3.0766, Wish::AtMost(0.1)), of(low, Wish::AtLeast(0.2))],
            vec![at(50.0, Wish::AtMost(5.0)), at(30.0, Wish::AtLeast(8.0))],
            vec![of(low, Wish::AtLeast(6.0)), of(max, Wish::AtMost(5.0))],
        ] {
            let error = refused(targets.clone(), (3.0766, 49.671));
            assert!(targets.iter().all(|t| error.contains(&t.to_string())), "{error}");
        }
        let fine =
            vec![at(30.0, Wish::AtMost(5.0)), at(50.0, Wish::AtLeast(8.0)), of(max, Wish::AtMost(9.0))];
        assert_eq!(ask(fine).check_loads((3.0, 50.0)), Ok(()));
    }

    #[test]
    fn magnitudes_that_no_switch_has_are_refused_with_a_bound() {
        for (quantity, value) in [
            (Quantity::Threshold, 1e-30),
            (Quantity::Threshold, 1e30),
            (Quantity::MaxFriction, 1e-30),
            (Quantity::Friction { load_n: 1e-30 }, 1.0),
            (Quantity::Friction { load_n: 1e5 }, 1.0),
            (Quantity::Stiffness, 1e9),
        ] {
            let error = ask(vec![Target { quantity, wish: Wish::AtLeast(value) }]).check().unwrap_err().0;
            assert!(error.contains("is outside") && error.contains("give a"), "{error}");
        }
        let mut small = ask(vec![Target { quantity: Quantity::Threshold, wish: Wish::AtLeast(5.0) }]);
        small.limits.outer_width_mm = Some(1e-9);
        assert!(small.check().unwrap_err().0.contains("0.1 to 1000 mm"));
    }

    #[test]
    fn ranges_outside_what_a_configuration_takes_are_refused() {
        let mut one = ask(vec![Target { quantity: Quantity::Threshold, wish: Wish::AtLeast(5.0) }]);
        one.vary.parameters = vec![Varied { parameter: Parameter::LayerMm, from: 1.0, to: 30.0 }];
        let error = one.check().unwrap_err().0;
        assert!(error.contains("vary.layer_mm = 30") && error.contains("0.3 to 10"), "{error}");
    }
}
