//! The ask on the command line: a file, options, or both.

use std::path::PathBuf;

use clap::Args;

use crate::Failure;
use crate::range::Range;
use pinswitch_switch::config::{Diagnostic, Location, ValueError};
use pinswitch_switch::request::{
    DEFAULT_WITHIN, FORMS, Parameter, Quantity, Request, Requirement, Target, Varied, parse_requirement,
    parse_share,
};

/// Targets, limits, and what may vary. A wish is `at most 8`, `at least 8`, `between 4 and 6`, `about 5` or
/// `about 5 within 15%`.
#[derive(Args, Debug)]
pub(super) struct AskFlags {
    /// The ask as a TOML file; options are added to it.
    #[arg(long, value_name = "TOML")]
    ask: Option<PathBuf>,
    /// Threshold in newtons, the load at which silicone makes half of the friction; a bare number means about.
    #[arg(long, value_name = "WISH", allow_negative_numbers = true)]
    threshold: Option<String>,
    /// Friction at the heaviest load in newtons; a bare number means at most.
    #[arg(long, value_name = "WISH", allow_negative_numbers = true)]
    max_friction: Option<String>,
    /// Friction at a load, such as 'at most 8 at 50'; may be repeated.
    #[arg(long, value_name = "WISH at LOAD", allow_negative_numbers = true)]
    friction: Vec<String>,
    /// Friction at the lightest load in newtons; a bare number means at most.
    #[arg(long, value_name = "WISH", allow_negative_numbers = true)]
    low_friction: Option<String>,
    /// Stiffness of switching, d ln D / d ln F at the threshold: 1 for one material, more for a switch; a bare number means
    /// at least.
    #[arg(long, value_name = "WISH", allow_negative_numbers = true)]
    stiffness: Option<String>,
    /// What about means: a share, such as 0.1 or 10%.
    #[arg(long, value_name = "SHARE")]
    within: Option<String>,
    /// Lightest and heaviest load in newtons, such as 3..80 [default: friction.load_min_n..friction.load_max_n, widened to
    /// the targets].
    #[arg(long, value_name = "A..B")]
    load_range: Option<Range<f64>>,
    /// Fewest and most pins, such as 3..6 [default: any number].
    #[arg(long, value_name = "A..B")]
    pins: Option<Range<usize>>,
    /// Largest radius of the assembled switch in mm.
    #[arg(long, value_name = "MM")]
    outer_radius: Option<f64>,
    /// Largest width of the assembled switch in mm.
    #[arg(long, value_name = "MM")]
    outer_width: Option<f64>,
    /// Continuous parameters that may vary, each with a range if wanted, such as pitch_deg,layer_mm=1.5..3; none keeps all
    /// [default: pitch_deg,layer_mm].
    #[arg(long, value_name = "NAME[=A..B]", value_delimiter = ',')]
    vary: Option<Vec<String>>,
    /// Keep the pins of the configuration, and search the continuous parameters only.
    #[arg(long)]
    keep_pins: bool,
    /// Diameters of the pins at hand in mm.
    #[arg(long, value_name = "MM", value_delimiter = ',')]
    pin_diameters: Vec<f64>,
    /// Hardnesses of the silicones at hand, Shore A.
    #[arg(long, value_name = "SHORE_A", value_delimiter = ',')]
    hardnesses: Vec<f64>,
}

impl AskFlags {
    /// The ask of file and options together.
    ///
    /// # Errors
    /// [`Failure::BadInput`] names option or field, value, bound and remedy.
    pub(super) fn ask(&self) -> Result<Request, Failure> {
        let mut ask = match &self.ask {
            Some(path) => {
                let name = path.display().to_string();
                let text = crate::input::read_text_file(path)?;
                Request::read(&text, &name).map_err(Failure::bad_input)?
            }
            None => Request::default(),
        };
        self.add_targets(&mut ask)?;
        if let Some(range) = self.load_range {
            ask.load_range_n = Some((range.from, range.to));
        }
        if let Some(range) = self.pins {
            ask.limits.pins = Some((range.from, range.to));
        }
        ask.limits.outer_radius_mm = self.outer_radius.or(ask.limits.outer_radius_mm);
        ask.limits.outer_width_mm = self.outer_width.or(ask.limits.outer_width_mm);
        if !self.pin_diameters.is_empty() {
            ask.materials.pin_diameter_mm.clone_from(&self.pin_diameters);
        }
        if !self.hardnesses.is_empty() {
            ask.materials.hardness_shore_a.clone_from(&self.hardnesses);
        }
        if let Some(named) = &self.vary {
            ask.vary.parameters =
                named.iter().filter(|n| *n != "none").map(|n| varied(n)).collect::<Result<_, _>>()?;
        }
        ask.vary.pattern &= !self.keep_pins;
        if ask.targets.is_empty() {
            return Err(Failure::bad_input(
                "nothing is asked; give --threshold, --max-friction, --friction, --low-friction, --stiffness or --ask FILE",
            ));
        }
        ask.check().map_err(|e| Failure::bad_input(self.in_options(e)))?;
        Ok(ask)
    }

    /// The message about a field that an option gave, with the option's name.
    fn in_options(&self, error: Diagnostic) -> Diagnostic {
        let options = [
            ("ask.load_range_n", "--load-range", self.load_range.is_some()),
            ("limits.pins", "--pins", self.pins.is_some()),
            ("limits.outer_radius_mm", "--outer-radius", self.outer_radius.is_some()),
            ("limits.outer_width_mm", "--outer-width", self.outer_width.is_some()),
            ("materials.pin_diameter_mm", "--pin-diameters", !self.pin_diameters.is_empty()),
            ("materials.hardness_shore_a", "--hardnesses", !self.hardnesses.is_empty()),
            ("vary.", "--vary ", self.vary.is_some()),
        ];
        let location = error.location().cloned().unwrap_or_default();
        let path = location.field.as_deref().unwrap_or_default();
        let given = options.iter().filter(|(.., is_given)| *is_given);
        let option = given
            .filter_map(|(field, option, _)| Some(format!("{option}{}", path.strip_prefix(field)?)))
            .next();
        match option {
            Some(option) => error.with_location(Location { field: Some(option), ..location }),
            None => error,
        }
    }

    fn add_targets(&self, ask: &mut Request) -> Result<(), Failure> {
        let within = match &self.within {
            Some(text) => parse_share(text).map_err(|e| Failure::bad_input(format!("--within: {e}")))?,
            None => DEFAULT_WITHIN,
        };
        // What a bare number means: value and share.
        type Bare = fn(f64, f64) -> Requirement;
        let about: Bare = |value, within| Requirement::About { value, within };
        let at_most: Bare = |value, _| Requirement::AtMost(value);
        let at_least: Bare = |value, _| Requirement::AtLeast(value);
        let single = [
            ("--threshold", &self.threshold, Quantity::Threshold, about),
            ("--max-friction", &self.max_friction, Quantity::MaxFriction, at_most),
            ("--low-friction", &self.low_friction, Quantity::LowLoadFriction, at_most),
            ("--stiffness", &self.stiffness, Quantity::Stiffness, at_least),
        ];
        for (flag, text, quantity, bare) in single {
            let Some(text) = text else { continue };
            let refused = |e: ValueError| Failure::bad_input(e.in_field(flag, text));
            let wish = match (parse_requirement(text, within).map_err(refused)?, text.trim().parse::<f64>()) {
                ((_, None), Ok(number)) => bare(number, within),
                ((wish, None), Err(_)) => wish,
                ((_, Some(load)), _) => {
                    return Err(Failure::bad_input(format!(
                        "{flag} = {text}: 'at {load}' belongs to --friction; leave it out here"
                    )));
                }
            };
            ask.targets.push(Target { quantity, requirement: wish });
        }
        for text in &self.friction {
            let refused = |e: ValueError| Failure::bad_input(e.in_field("--friction", text));
            match parse_requirement(text, within).map_err(refused)? {
                (wish, Some(load_n)) => {
                    ask.targets.push(Target { quantity: Quantity::Friction { load_n }, requirement: wish });
                }
                (_, None) => {
                    return Err(Failure::bad_input(format!(
                        "--friction = {text}: at which load? End it in 'at 50'; {FORMS}, and 'at LOAD'"
                    )));
                }
            }
        }
        Ok(())
    }
}

/// `layer_mm` or `layer_mm=1.5..3`.
fn varied(text: &str) -> Result<Varied, Failure> {
    let (name, range) = text.split_once('=').map_or((text, None), |(name, range)| (name, Some(range)));
    let parameter = Parameter::from_name(name.trim()).ok_or_else(|| {
        let known: Vec<_> = Parameter::ALL.iter().map(|p| p.name()).collect();
        Failure::bad_input(format!(
            "--vary {name}: no such parameter; known are {}, or none",
            known.join(", ")
        ))
    })?;
    let Some(range) = range else { return Ok(Varied::by_default(parameter)) };
    let range: Range<f64> = range.parse().map_err(|e| Failure::bad_input(format!("--vary {text}: {e}")))?;
    Ok(Varied { parameter, from: range.from, to: range.to })
}
