//! The request on the command line: a file, options, or both.

use std::path::PathBuf;

use clap::Args;
use pinswitch_diagnostic::{Diagnostic, Location, codes};
use pinswitch_switch::request::{
    DEFAULT_WITHIN, FORMS, Parameter, Quantity, Request, Requirement, Target, Varied, parse_requirement,
    parse_share,
};

use crate::Failure;
use crate::range::Range;

/// Targets, limits, and the parameters that may vary.
#[derive(Args, Debug)]
pub(super) struct RequestOptions {
    /// TOML file of a request; the options are added to it.
    #[arg(long, value_name = "TOML")]
    request: Option<PathBuf>,
    /// Threshold in newtons, the load at which silicone carries half of the friction; a bare number means about.
    #[arg(long, value_name = "TARGET", allow_negative_numbers = true)]
    threshold: Option<String>,
    /// Friction at the heaviest load in newtons; a bare number means at most.
    #[arg(long, value_name = "TARGET", allow_negative_numbers = true)]
    max_friction: Option<String>,
    /// Friction at a load, such as 'at most 8 at 50'; may be repeated.
    #[arg(long, value_name = "TARGET at LOAD", allow_negative_numbers = true)]
    friction: Vec<String>,
    /// Friction at the lightest load in newtons; a bare number means at most.
    #[arg(long, value_name = "TARGET", allow_negative_numbers = true)]
    low_friction: Option<String>,
    /// Stiffness of switching, d ln D / d ln F at the threshold: 1 for one material, more for a switch; a bare number means
    /// at least.
    #[arg(long, value_name = "TARGET", allow_negative_numbers = true)]
    stiffness: Option<String>,
    /// Half width of `about` as a share, such as 0.1 or 10%.
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
    /// Continuous parameters that may vary, with an optional range each, such as pitch_deg,layer_mm=1.5..3; none keeps all
    /// fixed [default: pitch_deg,layer_mm].
    #[arg(long, value_name = "NAME[=A..B]", value_delimiter = ',')]
    vary: Option<Vec<String>>,
    /// Keep the pins of the configuration, and search the continuous parameters only.
    #[arg(long)]
    keep_pins: bool,
    /// Available pin diameters in mm.
    #[arg(long, value_name = "MM", value_delimiter = ',')]
    pin_diameters: Vec<f64>,
    /// Available silicone hardnesses, Shore A.
    #[arg(long, value_name = "SHORE_A", value_delimiter = ',')]
    hardnesses: Vec<f64>,
}

impl RequestOptions {
    /// Returns the request of file and options together.
    ///
    /// # Errors
    /// [`Failure::bad_input`] with option or field, value, bound and help.
    pub(super) fn request(&self) -> Result<Request, Failure> {
        let mut request = match &self.request {
            Some(path) => {
                let name = path.display().to_string();
                let text = crate::input::read_text_file(path)?;
                Request::read(&text, &name).map_err(Failure::bad_input)?
            }
            None => Request::default(),
        };
        self.add_targets(&mut request)?;
        if let Some(range) = self.load_range {
            request.load_range_n = Some((range.from, range.to));
        }
        if let Some(range) = self.pins {
            request.limits.pins = Some((range.from, range.to));
        }
        request.limits.outer_radius_mm = self.outer_radius.or(request.limits.outer_radius_mm);
        request.limits.outer_width_mm = self.outer_width.or(request.limits.outer_width_mm);
        if !self.pin_diameters.is_empty() {
            request.materials.pin_diameter_mm.clone_from(&self.pin_diameters);
        }
        if !self.hardnesses.is_empty() {
            request.materials.hardness_shore_a.clone_from(&self.hardnesses);
        }
        if let Some(names) = &self.vary {
            request.vary.parameters =
                names.iter().filter(|n| *n != "none").map(|n| varied(n)).collect::<Result<_, _>>()?;
        }
        request.vary.pattern &= !self.keep_pins;
        if request.targets.is_empty() {
            return Err(Failure::bad_input(Diagnostic::new(codes::INVALID_REQUIREMENT, "the request has no target").with_help(
                "give --threshold, --max-friction, --friction, --low-friction, --stiffness or --request FILE",
            )));
        }
        request.check().map_err(|e| Failure::bad_input(self.located(e)))?;
        Ok(request)
    }

    /// Locates an error at the option that set its field, if one did.
    fn located(&self, error: Diagnostic) -> Diagnostic {
        let options = [
            ("targets.load_range_n", "--load-range", self.load_range.is_some()),
            ("limits.pins", "--pins", self.pins.is_some()),
            ("limits.outer_radius_mm", "--outer-radius", self.outer_radius.is_some()),
            ("limits.outer_width_mm", "--outer-width", self.outer_width.is_some()),
            ("materials.pin_diameter_mm", "--pin-diameters", !self.pin_diameters.is_empty()),
            ("materials.hardness_shore_a", "--hardnesses", !self.hardnesses.is_empty()),
            ("vary.", "--vary", self.vary.is_some()),
        ];
        let field = error.location().and_then(|location| location.field.clone());
        let field = field.unwrap_or_else(|| error.problem().to_owned());
        match options.iter().find(|(prefix, _, is_given)| *is_given && field.starts_with(prefix)) {
            Some((_, option, _)) => error.or_in_file(option),
            None => error,
        }
    }

    fn add_targets(&self, request: &mut Request) -> Result<(), Failure> {
        let within = match &self.within {
            Some(text) => parse_share(text).map_err(|e| refused("--within", text, e))?,
            None => DEFAULT_WITHIN,
        };
        // The target of a bare number, from value and share.
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
        for (option, text, quantity, bare) in single {
            let Some(text) = text else { continue };
            let parsed = parse_requirement(text, within).map_err(|e| refused(option, text, e))?;
            let requirement = match (parsed, text.trim().parse::<f64>()) {
                ((_, None), Ok(number)) => bare(number, within),
                ((requirement, None), Err(_)) => requirement,
                ((_, Some(load)), _) => {
                    let problem = Diagnostic::new(
                        codes::INVALID_REQUIREMENT,
                        format!("'at {load}' gives a load, which only --friction takes"),
                    );
                    return Err(refused(option, text, problem.with_help("leave it out, or use --friction")));
                }
            };
            request.targets.push(Target { quantity, requirement });
        }
        for text in &self.friction {
            match parse_requirement(text, within).map_err(|e| refused("--friction", text, e))? {
                (requirement, Some(load_n)) => {
                    request.targets.push(Target { quantity: Quantity::Friction { load_n }, requirement });
                }
                (_, None) => {
                    let problem = Diagnostic::new(codes::INVALID_REQUIREMENT, "the load is missing")
                        .with_help(format!("add a load, such as 'at 50'; {FORMS}, and 'at LOAD'"));
                    return Err(refused("--friction", text, problem));
                }
            }
        }
        Ok(())
    }
}

/// Returns the failure of an option's value.
fn refused(option: &str, value: &str, problem: impl Into<Diagnostic>) -> Failure {
    Failure::bad_input(problem.into().with_location(Location::field(option, value)))
}

/// Parses `layer_mm` or `layer_mm=1.5..3`.
fn varied(text: &str) -> Result<Varied, Failure> {
    let (name, range) = text.split_once('=').map_or((text, None), |(name, range)| (name, Some(range)));
    let parameter = Parameter::from_name(name.trim()).ok_or_else(|| {
        let known: Vec<_> = Parameter::ALL.iter().map(|p| p.name()).collect();
        let problem = Diagnostic::new(codes::UNKNOWN_FIELD, "unknown parameter");
        refused("--vary", name, problem.with_help(format!("give some of {}, or none", known.join(", "))))
    })?;
    let Some(range) = range else { return Ok(Varied::by_default(parameter)) };
    let range: Range<f64> = range.parse().map_err(|e: Diagnostic| refused("--vary", text, e))?;
    Ok(Varied { parameter, from: range.from, to: range.to })
}
