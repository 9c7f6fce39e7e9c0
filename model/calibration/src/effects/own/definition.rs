//! Definition of a user-defined effect, and its checks.

use std::fmt;
use std::ops::Range;

use pinswitch_diagnostic::{Code, Diagnostic, Location, codes, excerpt};
use pinswitch_formula::{FormulaError, is_reserved};

use super::probe::probes;
use super::unit::Unit;
use super::unit_check::{check_units, located};
use crate::effects::formula::EffectFormula;
use crate::effects::formula::{VARIABLES, variable};
use crate::effects::{
    ActsOn, Combine, Covariate, Effect, Parameter, Side, UNATTRIBUTED, Written, effect_named,
};
use crate::table::{Frame, is_fingerprint};

/// Most constants of an effect.
const MAX_PARAMETERS: usize = 8;
/// Most characters of an id, of a constant's name and of the experiment.
const MAX_ID: usize = 60;
const MAX_NAME: usize = 30;
const MAX_EXPERIMENT: usize = 300;
/// Most sessions in `drawn_from`.
const MAX_SESSIONS: usize = 4000;
/// Most rivals of an effect.
const MAX_RIVALS: usize = 20;
/// Largest start and bound of a constant, far above any real one.
const MAX_VALUE: f64 = 1e6;
/// Most characters of a name in a message.
const LONGEST_NAME: usize = 60;

/// A constant of a user-defined effect.
#[derive(Clone, Debug, PartialEq)]
pub struct OwnParameter {
    /// Name in the formula.
    pub name: String,
    /// Unit, such as `1`, `N`, `%` or `N^-0.5`.
    pub unit: String,
    /// Start value of a fit; for a size, a typical value, which cannot be zero.
    pub start: f64,
    /// Bounds of a shape; `None` for a size, which is free and cancels the effect at zero.
    pub bounds: Option<(f64, f64)>,
}

/// Definition of a user-defined effect (`model/doc/own-effects.md`).
#[derive(Clone, Debug, PartialEq)]
pub struct EffectDefinition {
    /// Id: `[a-z][a-z0-9_]*`.
    pub id: String,
    /// Whether the effect belongs to the part or to the measurement.
    pub side: Side,
    /// Covariate along which the effect shows.
    pub covariate: Covariate,
    /// Quantity that the formula changes.
    pub acts_on: ActsOn,
    /// How the formula changes it.
    pub combine: Combine,
    /// The formula.
    pub formula: String,
    /// Whether the first size cannot be negative.
    pub one_sided: bool,
    /// Ids of effects that may look the same.
    pub confused_with: Vec<String>,
    /// Experiment that identifies the effect; empty for one that varies the covariate.
    pub experiment: String,
    /// Fingerprints ([`crate::table::readings_by_session`]) of the sessions from which `calibrate`
    /// derived the formula; empty for an effect that was derived from no readings, and `None` if its
    /// origin is not declared.
    pub drawn_from: Option<Vec<String>>,
    /// Constants.
    pub parameters: Vec<OwnParameter>,
}

/// Part of a definition.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Part {
    Id,
    /// The formula, at these bytes.
    Formula(Range<usize>),
    ConfusedWith,
    Experiment,
    DrawnFrom,
    Parameters,
    /// The parameter of this index.
    Parameter(usize),
}

/// Reason why a definition is invalid; converts to a [`Diagnostic`].
#[derive(Clone, Debug, PartialEq)]
pub struct DefinitionError {
    pub(super) part: Part,
    pub(super) diagnostic: Diagnostic,
}

impl From<DefinitionError> for Diagnostic {
    fn from(error: DefinitionError) -> Self {
        error.diagnostic
    }
}

impl fmt::Display for DefinitionError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.diagnostic.fmt(f)
    }
}

impl std::error::Error for DefinitionError {}

fn require(is_met: bool, part: Part, diagnostic: impl FnOnce() -> Diagnostic) -> Result<(), DefinitionError> {
    if is_met { Ok(()) } else { Err(DefinitionError { part, diagnostic: diagnostic() }) }
}

/// Returns a diagnostic with a help.
fn advised(problem: impl Into<String>, help: impl Into<String>) -> Diagnostic {
    Diagnostic::new(codes::INVALID_EFFECT, problem).with_help(help)
}

impl EffectDefinition {
    /// Writes a built-in effect as a formula, under its own id.
    ///
    /// # Errors
    /// The reason why the formula language cannot express the effect.
    pub fn of(effect: &dyn Effect) -> Result<Self, &str> {
        let description = effect.description();
        let (acts_on, combine, formula) = match description.written {
            Written::As { acts_on, combine, formula } => (acts_on, combine, formula.to_owned()),
            Written::No(reason) => return Err(reason),
        };
        let start = effect.typical(&Frame::new(&[])).into_iter().next().unwrap_or_default();
        let parameter = |(p, start): (&Parameter, f64)| OwnParameter {
            name: p.name.to_string(),
            unit: p.unit.to_string(),
            start,
            bounds: p.bounds,
        };
        Ok(Self {
            id: description.id.to_owned(),
            side: description.side,
            covariate: description.covariate,
            acts_on,
            combine,
            formula,
            one_sided: description.one_sided,
            confused_with: description.confused_with.iter().map(ToString::to_string).collect(),
            experiment: description.experiment.to_owned(),
            drawn_from: None,
            parameters: description.parameters.iter().zip(start).map(parameter).collect(),
        })
    }

    /// Runs all checks of a single effect, and compiles the formula.
    ///
    /// # Errors
    /// The first problem.
    pub(super) fn compiled(&self) -> Result<EffectFormula, DefinitionError> {
        self.check_words()?;
        let mut units = Vec::new();
        for (i, parameter) in self.parameters.iter().enumerate() {
            self.check_parameter(i, parameter)?;
            let unit = Unit::parse(&parameter.unit)
                .map_err(|diagnostic| DefinitionError { part: Part::Parameter(i), diagnostic })?;
            units.push(unit);
        }
        let names: Vec<&str> = self.parameters.iter().map(|p| p.name.as_str()).collect();
        let formula = EffectFormula::parse(&self.formula, &names, self.acts_on.knows_tension())
            .map_err(|error| self.formula_error(&error))?;
        for (i, name) in names.iter().enumerate() {
            require(formula.has_constant(i), Part::Parameter(i), || {
                advised(format!("the formula does not use '{name}'"), "use it, or leave it out")
            })?;
        }
        let (unit, what) = match self.combine {
            Combine::Factor => ("1", "a factor".to_owned()),
            Combine::Sum => (self.acts_on.unit(), format!("a term of {}", self.acts_on.as_str())),
        };
        let needed = Unit::parse(unit).map_err(|e| self.formula_error(&located(0..0, &e)))?;
        check_units(formula.root(), &units, needed, &what).map_err(|error| self.formula_error(&error))?;
        self.check_values(&formula)?;
        Ok(formula)
    }

    /// Returns the error of a part of the formula.
    fn formula_error(&self, error: &FormulaError) -> DefinitionError {
        let span = error.span();
        let location = Location::in_text("formula", &self.formula, span.clone());
        let diagnostic = Diagnostic::from(error).with_location(location);
        DefinitionError { part: Part::Formula(span), diagnostic }
    }

    fn check_words(&self) -> Result<(), DefinitionError> {
        let id = &self.id;
        let is_id = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_';
        let well_formed = id.chars().all(is_id) && id.starts_with(|c: char| c.is_ascii_lowercase());
        require(well_formed && id.len() <= MAX_ID, Part::Id, || {
            advised(
                format!("invalid id '{}'", excerpt(id, LONGEST_NAME)),
                format!("start with a-z, then use a-z, 0-9 and _, {MAX_ID} characters at most"),
            )
        })?;
        require(effect_named(id).is_none() && id != UNATTRIBUTED, Part::Id, || {
            advised(
                format!("id '{id}' is that of a built-in effect"),
                format!("give yours another one, such as my_{id}"),
            )
        })?;
        require(id != "none", Part::Id, || {
            advised("id 'none' means the absence of every effect in reports", "give yours another one")
        })?;
        require(self.experiment.len() <= MAX_EXPERIMENT, Part::Experiment, || {
            Diagnostic::new(
                codes::INVALID_EFFECT,
                format!(
                    "the experiment has {} characters, at most {MAX_EXPERIMENT} are possible",
                    self.experiment.len()
                ),
            )
        })?;
        require(self.confused_with.len() <= MAX_RIVALS, Part::ConfusedWith, || {
            let count = self.confused_with.len();
            Diagnostic::new(
                codes::INVALID_EFFECT,
                format!("confused_with has {count} ids, at most {MAX_RIVALS} are possible"),
            )
        })?;
        let drawn_from = self.drawn_from.as_deref().unwrap_or_default();
        require(drawn_from.len() <= MAX_SESSIONS, Part::DrawnFrom, || {
            let count = drawn_from.len();
            Diagnostic::new(
                codes::INVALID_EFFECT,
                format!("drawn_from has {count} sessions, at most {MAX_SESSIONS} are possible"),
            )
        })?;
        for fingerprint in drawn_from {
            require(is_fingerprint(fingerprint), Part::DrawnFrom, || {
                advised(
                    format!("'{}' in drawn_from is not a fingerprint", excerpt(fingerprint, LONGEST_NAME)),
                    "keep drawn_from as `calibrate` wrote it, or write `drawn_from = []` if the effect was derived from no readings",
                )
            })?;
        }
        require(!self.confused_with.contains(&self.id), Part::ConfusedWith, || {
            advised(format!("confused_with contains the effect itself, '{}'", self.id), "list other effects")
        })?;
        let count = self.parameters.len();
        require((1..=MAX_PARAMETERS).contains(&count), Part::Parameters, || {
            Diagnostic::new(
                codes::INVALID_EFFECT,
                format!("{count} parameters, 1 to {MAX_PARAMETERS} are possible"),
            )
        })?;
        require(self.parameters.iter().any(|p| p.bounds.is_none()), Part::Parameters, || {
            advised("no parameter is a size", "set size = true for the one that cancels the effect at zero")
        })
    }

    fn check_parameter(&self, i: usize, parameter: &OwnParameter) -> Result<(), DefinitionError> {
        let OwnParameter { name, start, bounds, .. } = parameter;
        let part = || Part::Parameter(i);
        let is_name = |c: char| c.is_ascii_alphanumeric() || c == '_';
        let well_formed = name.chars().all(is_name) && name.starts_with(|c: char| c.is_ascii_alphabetic());
        require(well_formed && name.len() <= MAX_NAME, part(), || {
            advised(
                format!("invalid parameter name '{}'", excerpt(name, LONGEST_NAME)),
                format!("start with a letter, then use letters, digits and _, {MAX_NAME} characters at most"),
            )
        })?;
        require(variable(name).is_none(), part(), || {
            let names: Vec<&str> = VARIABLES.iter().map(|v| v.name).collect();
            advised(
                format!("parameter '{name}' has the name of a variable"),
                format!("use another name than {}", names.join(", ")),
            )
        })?;
        require(!is_reserved(name), part(), || {
            advised(
                format!("parameter '{name}' has the name of a function"),
                format!("use another name, such as my_{name}"),
            )
        })?;
        let usable = |v: f64| v.is_finite() && v.abs() <= MAX_VALUE;
        require(
            usable(*start) && bounds.is_none_or(|(low, high)| usable(low) && usable(high)),
            part(),
            || {
                Diagnostic::new(
                    codes::INVALID_EFFECT,
                    format!(
                        "start, low and high of '{name}' must be numbers from -{MAX_VALUE} to {MAX_VALUE}"
                    ),
                )
            },
        )?;
        let Some((low, high)) = bounds else {
            let first = self.parameters.iter().position(|p| p.bounds.is_none()) == Some(i);
            let positive = self.one_sided && first;
            return require(*start != 0.0 && (*start > 0.0 || !positive), part(), || {
                let bound = if positive { "above 0, since one_sided = true" } else { "other than 0" };
                advised(
                    format!("start = {start} of the size '{name}' must be {bound}"),
                    "give a typical value",
                )
            });
        };
        require(low < start && start < high, part(), || {
            Diagnostic::new(
                codes::INVALID_EFFECT,
                format!("start = {start} of '{name}' must be between low = {low} and high = {high}"),
            )
        })
    }

    /// Returns whether the effect is nonlinear in small sizes, as `k^2`, `abs(k)` or `sqrt(k)` are.
    /// A linear fit cannot start from zero then, and an interval around zero is meaningless.
    pub(super) fn is_nonlinear_in_sizes(&self, formula: &EffectFormula) -> bool {
        const SMALL: f64 = 1e-4;
        let at = |size: f64| -> Vec<f64> {
            let values: Vec<f64> =
                self.parameters.iter().map(|p| p.bounds.map_or(size * p.start, |_| p.start)).collect();
            probes().iter().map(|probe| formula.value(&values, &probe.moment())).collect()
        };
        let [small, twice, negative] = [SMALL, 2.0 * SMALL, -SMALL].map(at);
        let length = |values: &[f64]| values.iter().map(|v| v.abs()).filter(|v| v.is_finite()).sum::<f64>();
        let with = |other: &[f64], factor: f64| -> Vec<f64> {
            small.iter().zip(other).map(|(a, b)| factor * a - b).collect()
        };
        let off = length(&with(&twice, 2.0)).max(length(&with(&negative, -1.0)));
        off > 0.05 * length(&small) && off > 1e-12
    }

    /// Checks on probe rows that the formula is zero if all sizes are, and finite and not always
    /// zero at the start values.
    fn check_values(&self, formula: &EffectFormula) -> Result<(), DefinitionError> {
        let whole = |code: Code, problem: String| FormulaError::new(code, 0..0, problem);
        let pick = |size: f64, shape: fn(f64, (f64, f64)) -> f64| -> Vec<f64> {
            self.parameters.iter().map(|p| p.bounds.map_or(size * p.start, |b| shape(p.start, b))).collect()
        };
        let gone = [
            pick(0.0, |start, _| start),
            pick(0.0, |_, (low, high)| low + 0.01 * (high - low)),
            pick(0.0, |_, (low, high)| high - 0.01 * (high - low)),
        ];
        let present = pick(1.0, |start, _| start);
        // A formula that distinguishes cases may act in a narrow range that contains none of the
        // probe rows.
        let mut acts = formula.root().has_cases();
        for probe in probes() {
            let moment = probe.moment();
            let value = formula.value(&present, &moment);
            if !value.is_finite() {
                let problem =
                    format!("the formula is not finite at its start values {}", probe.description());
                return Err(self.formula_error(
                    &whole(codes::FORMULA_NOT_FINITE, problem).with_help("guard it with max or min"),
                ));
            }
            acts |= value.abs() > 1e-12;
            if let Some(left) =
                gone.iter().map(|k| formula.value(k, &moment)).find(|v| v.is_nan() || v.abs() >= 1e-9)
            {
                let problem = format!(
                    "the formula is {left:.4} instead of zero with all sizes at zero, {}",
                    probe.description()
                );
                let help = "mark every constant that cancels the effect as a size, or subtract the remainder";
                return Err(self.formula_error(&whole(codes::EFFECT_WITHOUT_ZERO, problem).with_help(help)));
            }
        }
        if acts {
            return Ok(());
        }
        let problem = "the formula is zero at its start values in every row, so the effect does nothing";
        Err(self.formula_error(&whole(codes::EFFECT_WITHOUT_ZERO, problem.to_owned())))
    }
}
