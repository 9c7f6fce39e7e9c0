//! Requests for a design: targets of a switch, limits, available materials, and variable
//! parameters.
//!
//! `cad/doc/design.md` explains every field. [`Request::read`] reads a file, [`parse_requirement`] a requirement from the
//! command line.

mod parameter;
mod phrase;
mod read;
mod target;
mod tolerance;

use crate::config::{Diagnostic, Location};
use pinswitch_diagnostic::{Code, codes, short_number};
use pinswitch_friction::sort_by_number;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

pub use parameter::Parameter;
pub use phrase::{FORMS, parse_requirement, parse_share};
pub use read::request_schema;
pub use target::{Quantity, Requirement, Target};
pub use tolerance::{SOURCES, Tolerances};

/// Default `within` of an `about`.
pub const DEFAULT_WITHIN: f64 = 0.10;

/// Smallest and largest size of a switch that can be requested, mm.
const SIZES_MM: (f64, f64) = (0.1, 1000.0);
/// Heaviest load of a range, N.
const HEAVIEST_N: f64 = 1000.0;
/// Largest standard deviation of a tolerance.
const LARGEST_DEVIATION: f64 = 20.0;
/// Loads that differ by less than this share are equal.
const SAME_LOAD: f64 = 1e-6;

/// Targets, limits, variable parameters, available materials, and manufacturing tolerances.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct Request {
    /// Targets of the curve, all to be met at once.
    pub targets: Vec<Target>,
    /// Lightest and heaviest load, N; if absent those of the configuration, widened to the loads of the targets.
    pub load_range_n: Option<(f64, f64)>,
    /// Limits of the part.
    pub limits: Limits,
    /// Parameters that the search may vary.
    pub vary: Vary,
    /// Available materials.
    pub materials: Materials,
    /// Deviations of made parts from their configuration.
    pub tolerances: Tolerances,
}

/// Limits of the part.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Limits {
    /// Fewest and most pins.
    pub pins: Option<(usize, usize)>,
    /// Largest radius of the assembled switch, that of its side supports, mm.
    pub outer_radius_mm: Option<f64>,
    /// Largest width of the assembled switch over both supports, mm.
    pub outer_width_mm: Option<f64>,
    /// Template or file with the settings of the printer.
    pub preset: Option<String>,
}

/// Parameters that the search may vary.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Vary {
    /// Whether the occupied grooves may change.
    pub pattern: bool,
    /// Continuous parameters, each within a range.
    pub parameters: Vec<Varied>,
}

/// A continuous parameter and the range in which it varies.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
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
    /// Patterns, pitch and thickness, which take another print and another casting with the same materials.
    fn default() -> Self {
        Self {
            pattern: true,
            parameters: vec![Varied::by_default(Parameter::PitchDeg), Varied::by_default(Parameter::LayerMm)],
        }
    }
}

/// Available materials. An empty list means the material of the configuration.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Materials {
    /// Diameters of pins, mm.
    pub pin_diameter_mm: Vec<f64>,
    /// Hardnesses of silicones, Shore A.
    pub hardness_shore_a: Vec<f64>,
    /// Tendons.
    pub tendon: Vec<Tendon>,
}

/// An available tendon.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Tendon {
    /// Diameter of the bare rope, mm.
    pub rope_diameter_mm: f64,
    /// Coating on the radius, mm.
    pub coating_mm: f64,
}

/// The error of a field with a value.
fn invalid(
    code: Code,
    field: impl Into<String>,
    value: impl Into<String>,
    problem: &str,
    help: &str,
) -> Diagnostic {
    Diagnostic::new(code, problem).with_help(help).with_location(Location::field(field, value))
}

/// The error of targets that exclude each other.
fn contradiction(a: &Target, b: &Target, reason: &str) -> Diagnostic {
    Diagnostic::new(codes::CONTRADICTORY_TARGETS, format!("'{a}' and '{b}' contradict each other{reason}"))
        .with_help("drop one, or widen it")
}

impl Request {
    /// Checks the values of the request.
    ///
    /// # Errors
    /// A [`Diagnostic`] for a request without targets, two targets that contradict each other, or a value out of range.
    pub fn check(&self) -> Result<(), Diagnostic> {
        if self.targets.is_empty() {
            let error = Diagnostic::new(codes::INVALID_REQUIREMENT, "the request has no target");
            return Err(error.with_help("give a threshold, a friction or a stiffness"));
        }
        self.targets.iter().try_for_each(Target::check_magnitude)?;
        for (i, a) in self.targets.iter().enumerate() {
            if let Some(b) = self.targets[i + 1..].iter().find(|b| a.contradicts(b)) {
                return Err(contradiction(a, b, ""));
            }
        }
        if let Some((low, high)) = self.load_range_n
            && !(low >= 0.0 && low < high && high <= HEAVIEST_N)
        {
            let value = format!("{}..{}", short_number(low), short_number(high));
            let problem = format!("not a range within 0 to {HEAVIEST_N} N");
            return Err(invalid(
                codes::INVALID_RANGE,
                "targets.load_range_n",
                value,
                &problem,
                "give the lightest load first",
            ));
        }
        self.check_limits()?;
        self.check_parameters()?;
        let deviations = self.tolerances.sd();
        let is_valid = |sd: f64| (0.0..=LARGEST_DEVIATION).contains(&sd);
        match Tolerances::FIELDS.iter().zip(deviations).find(|(_, sd)| !is_valid(*sd)) {
            Some((field, sd)) => Err(invalid(
                codes::OUT_OF_RANGE,
                format!("tolerances.{field}"),
                short_number(sd),
                "not a standard deviation",
                &format!("give a number from 0 to {LARGEST_DEVIATION}"),
            )),
            None => Ok(()),
        }
    }

    /// Checks the targets against the lightest and the heaviest load, N.
    ///
    /// # Errors
    /// A [`Diagnostic`] for a threshold outside the loads, and for two frictions that contradict each other at one load
    /// or because friction increases with load.
    pub fn check_loads(&self, (lightest, heaviest): (f64, f64)) -> Result<(), Diagnostic> {
        for target in self.targets.iter().filter(|t| t.quantity == Quantity::Threshold) {
            let (low, high) = target.requirement.interval();
            if low > heaviest || high < lightest {
                return Err(invalid(
                    codes::OUT_OF_RANGE,
                    "targets.load_range_n",
                    format!("{lightest}..{heaviest}"),
                    &format!("'{target}' is outside the range of loads, in N"),
                    "widen the range (--load-range), or change the threshold",
                ));
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
                let (a_of, b_of) = (a.requirement.interval(), b.requirement.interval());
                if a_of.0 > b_of.1 || (is_same_load && b_of.0 > a_of.1) {
                    let reason = if is_same_load {
                        format!(": both are for a load of {load} N")
                    } else {
                        format!(": friction increases with load, from {load} N to {other_load} N")
                    };
                    return Err(contradiction(a, b, &reason));
                }
            }
        }
        Ok(())
    }

    fn check_limits(&self) -> Result<(), Diagnostic> {
        let lengths = [
            ("outer_radius_mm", self.limits.outer_radius_mm),
            ("outer_width_mm", self.limits.outer_width_mm),
        ];
        let (least, most) = SIZES_MM;
        for (field, value) in lengths {
            if let Some(value) = value.filter(|v| !(least..=most).contains(v)) {
                return Err(invalid(
                    codes::OUT_OF_RANGE,
                    format!("limits.{field}"),
                    short_number(value),
                    &format!("outside {least} to {most} mm"),
                    "give the size of a switch",
                ));
            }
        }
        match self.limits.pins {
            Some((fewest, most)) if fewest == 0 || fewest > most => Err(invalid(
                codes::INVALID_RANGE,
                "limits.pins",
                format!("{fewest}..{most}"),
                "not a range of at least 1 pin",
                &format!("give the smaller number first, such as 1..{}", most.max(1)),
            )),
            _ => Ok(()),
        }
    }

    fn check_parameters(&self) -> Result<(), Diagnostic> {
        let within = |field: String, parameter: Parameter, value: f64| {
            let (least, most) = parameter.hard_range();
            if value >= least && value <= most {
                return Ok(());
            }
            let problem = format!("outside {least} to {most}, the range of {}", parameter.field());
            Err(invalid(
                codes::OUT_OF_RANGE,
                field,
                short_number(value),
                &problem,
                "give a value in the range",
            ))
        };
        for (i, v) in self.vary.parameters.iter().enumerate() {
            let name = v.parameter.name();
            within(format!("vary.{name}"), v.parameter, v.from)?;
            within(format!("vary.{name}"), v.parameter, v.to)?;
            let value = || format!("{}..{}", short_number(v.from), short_number(v.to));
            if v.from > v.to {
                let help = "give the smaller value first";
                return Err(invalid(
                    codes::INVALID_RANGE,
                    format!("vary.{name}"),
                    value(),
                    "the range is reversed",
                    help,
                ));
            }
            if self.vary.parameters[..i].iter().any(|other| other.parameter == v.parameter) {
                let help = "give one range";
                return Err(invalid(
                    codes::DUPLICATE_ENTRY,
                    format!("vary.{name}"),
                    value(),
                    "given twice",
                    help,
                ));
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
                let problem = format!("vary.{name} and materials.{name} exclude each other");
                return Err(
                    Diagnostic::new(codes::CONFLICTING_SETTINGS, problem).with_help("drop one of them")
                );
            }
        }
        for tendon in &self.materials.tendon {
            if !((0.1..=6.0).contains(&tendon.rope_diameter_mm) && (0.0..=2.0).contains(&tendon.coating_mm)) {
                let value = format!(
                    "{} mm with {} mm of coating",
                    short_number(tendon.rope_diameter_mm),
                    short_number(tendon.coating_mm)
                );
                let help = "give 0.1 to 6 mm of rope and 0 to 2 mm of coating";
                return Err(invalid(
                    codes::OUT_OF_RANGE,
                    "materials.tendon",
                    value,
                    "not a tendon that a switch can have",
                    help,
                ));
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn request(targets: Vec<Target>) -> Request {
        Request { targets, ..Request::default() }
    }

    #[test]
    fn huge_numbers_are_shown_short() {
        for requirement in [Requirement::AtMost(1e300), Requirement::About { value: 1e300, within: 0.1 }] {
            for quantity in [Quantity::Threshold, Quantity::Friction { load_n: 1e300 }] {
                let error = request(vec![Target { quantity, requirement }]).check().unwrap_err().to_string();
                assert!(error.contains("1e300") && error.len() < 160, "{error}");
            }
        }
    }

    #[test]
    fn contradictions_name_both_sides() {
        let friction = |requirement| Target { quantity: Quantity::Friction { load_n: 50.0 }, requirement };
        let error = request(vec![friction(Requirement::AtMost(3.0)), friction(Requirement::AtLeast(5.0))])
            .check()
            .unwrap_err()
            .to_string();
        assert!(error.contains("at most 3 N") && error.contains("at least 5 N"), "{error}");
        assert!(request(Vec::new()).check().unwrap_err().problem().contains("no target"));
        let mut both = request(vec![friction(Requirement::AtMost(3.0))]);
        both.materials.pin_diameter_mm = vec![0.8];
        assert_eq!(both.check(), Ok(()));
        both.vary.parameters.push(Varied::by_default(Parameter::PinDiameterMm));
        let error = both.check().unwrap_err().to_string();
        assert!(error.contains("vary.pin_diameter_mm and materials.pin_diameter_mm"), "{error}");
    }

    #[test]
    fn targets_that_loads_exclude_are_refused() {
        let of = |quantity, requirement| Target { quantity, requirement };
        let at = |load_n, requirement| of(Quantity::Friction { load_n }, requirement);
        let (max, low) = (Quantity::MaxFriction, Quantity::LowLoadFriction);
        let refused =
            |targets: Vec<Target>, range| request(targets).check_loads(range).unwrap_err().to_string();
        let about = of(Quantity::Threshold, Requirement::About { value: 24.0, within: 0.1 });
        let error = refused(vec![about], (30.0, 60.0));
        assert!(error.contains("threshold about 24 N") && error.contains("30..60"), "{error}");
        for targets in [
            vec![of(max, Requirement::AtMost(5.0)), at(49.671, Requirement::AtLeast(8.0))],
            vec![at(3.0766, Requirement::AtMost(0.1)), of(low, Requirement::AtLeast(0.2))],
            vec![at(50.0, Requirement::AtMost(5.0)), at(30.0, Requirement::AtLeast(8.0))],
            vec![of(low, Requirement::AtLeast(6.0)), of(max, Requirement::AtMost(5.0))],
        ] {
            let error = refused(targets.clone(), (3.0766, 49.671));
            assert!(targets.iter().all(|t| error.contains(&t.to_string())), "{error}");
        }
        let consistent = vec![
            at(30.0, Requirement::AtMost(5.0)),
            at(50.0, Requirement::AtLeast(8.0)),
            of(max, Requirement::AtMost(9.0)),
        ];
        assert_eq!(request(consistent).check_loads((3.0, 50.0)), Ok(()));
    }

    #[test]
    fn implausible_magnitudes_are_refused() {
        for (quantity, value) in [
            (Quantity::Threshold, 1e-30),
            (Quantity::Threshold, 1e30),
            (Quantity::MaxFriction, 1e-30),
            (Quantity::Friction { load_n: 1e-30 }, 1.0),
            (Quantity::Friction { load_n: 1e5 }, 1.0),
            (Quantity::Stiffness, 1e9),
        ] {
            let target = Target { quantity, requirement: Requirement::AtLeast(value) };
            let error = request(vec![target]).check().unwrap_err();
            assert!(error.problem().contains("outside"), "{error}");
            assert!(error.help().is_some_and(|help| help.starts_with("give a")), "{error}");
        }
        let target = Target { quantity: Quantity::Threshold, requirement: Requirement::AtLeast(5.0) };
        let mut small = request(vec![target]);
        small.limits.outer_width_mm = Some(1e-9);
        assert!(small.check().unwrap_err().problem().contains("0.1 to 1000 mm"));
    }

    #[test]
    fn ranges_beyond_the_configuration_are_refused() {
        let target = Target { quantity: Quantity::Threshold, requirement: Requirement::AtLeast(5.0) };
        let mut one = request(vec![target]);
        one.vary.parameters = vec![Varied { parameter: Parameter::LayerMm, from: 1.0, to: 30.0 }];
        let error = one.check().unwrap_err().to_string();
        assert!(error.contains("vary.layer_mm = 30") && error.contains("0.3 to 10"), "{error}");
    }
}
