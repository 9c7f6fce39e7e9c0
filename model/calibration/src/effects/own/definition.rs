//! All that is said of an effect of one's own, and whether it can be one.

use std::fmt;

use super::expression::EffectFormula;
use super::probe::probes;
use super::unit::Unit;
use super::unit_check::check_units;
use super::variable::{VARIABLES, variable};
use crate::effects::{ActsOn, Combine, Covariate, Effect, Parameter, Side, Written, effect_named};
use crate::inference::UNATTRIBUTED;
use crate::table::{Frame, tells_readings};
use pinswitch_formula::{FormulaError, is_reserved};

/// Most constants of an effect.
const MAX_PARAMETERS: usize = 8;
/// Most characters of an id, of a constant's name and of the experiment.
const MAX_ID: usize = 60;
const MAX_NAME: usize = 30;
const MAX_EXPERIMENT: usize = 300;
/// Most sessions that one may be drawn from.
const MAX_SESSIONS: usize = 4000;
/// Most effects that one may be confused with.
const MAX_RIVALS: usize = 20;
/// Largest start and bound of a constant, far above any.
const MAX_VALUE: f64 = 1e6;

/// One constant of an effect of one's own.
#[derive(Clone, Debug, PartialEq)]
pub struct OwnParameter {
    /// Its name in the formula.
    pub name: String,
    /// Its unit, such as `1`, `N`, `%` or `N^-0.5`.
    pub unit: String,
    /// Where a fit starts; of a size what is typical of it, so not zero.
    pub start: f64,
    /// Bounds of a shape; `None` for a size, which is free and at zero leaves nothing of the effect.
    pub bounds: Option<(f64, f64)>,
}

/// All that is said of an effect of one's own (`model/doc/own-effects.md`).
#[derive(Clone, Debug, PartialEq)]
pub struct EffectDefinition {
    /// Its id: `[a-z][a-z0-9_]*`.
    pub id: String,
    /// Part or measurement.
    pub side: Side,
    /// Where its trace lies.
    pub covariate: Covariate,
    /// What it acts on.
    pub acts_on: ActsOn,
    /// How.
    pub combine: Combine,
    /// The formula.
    pub formula: String,
    /// Whether the first size cannot be negative.
    pub one_sided: bool,
    /// Ids of effects that may look the same.
    pub confused_with: Vec<String>,
    /// The experiment that shows it; empty for one that varies the covariate.
    pub experiment: String,
    /// The sessions whose readings it was drawn from, by what [`crate::table::readings_by_session`] says of them; none for
    /// what somebody wrote down.
    pub drawn_from: Vec<String>,
    /// Its constants.
    pub parameters: Vec<OwnParameter>,
}

/// What of a definition is wrong.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Part {
    Id,
    /// The formula, at this byte.
    Formula(usize),
    ConfusedWith,
    Experiment,
    DrawnFrom,
    Parameters,
    Parameter(usize),
}

/// Why a definition is none of an effect.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DefinitionError {
    pub(super) part: Part,
    pub(super) problem: String,
}

impl fmt::Display for DefinitionError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.part {
            Part::Formula(at) => write!(f, "formula, byte {at}: {}", self.problem),
            _ => f.write_str(&self.problem),
        }
    }
}

impl std::error::Error for DefinitionError {}

fn require(holds: bool, part: Part, problem: impl FnOnce() -> String) -> Result<(), DefinitionError> {
    if holds { Ok(()) } else { Err(DefinitionError { part, problem: problem() }) }
}

impl EffectDefinition {
    /// A built-in effect in the language of formulas, under its own id.
    ///
    /// # Errors
    /// Why the language cannot say it.
    pub fn of(effect: &dyn Effect) -> Result<Self, &'static str> {
        let told = effect.description();
        let (acts_on, combine, formula) = match told.written {
            Written::As { acts_on, combine, formula } => (acts_on, combine, formula.to_owned()),
            Written::No(why) => return Err(why),
        };
        let start = effect.starts(&Frame::new(&[])).into_iter().next().unwrap_or_default();
        let parameter = |(p, start): (&Parameter, f64)| OwnParameter {
            name: p.name.to_owned(),
            unit: p.unit.to_owned(),
            start,
            bounds: p.bounds,
        };
        Ok(Self {
            id: told.id.to_owned(),
            side: told.side,
            covariate: told.covariate,
            acts_on,
            combine,
            formula,
            one_sided: told.one_sided,
            confused_with: told.confused_with.iter().map(|id| (*id).to_owned()).collect(),
            experiment: told.experiment.to_owned(),
            drawn_from: Vec::new(),
            parameters: told.parameters.iter().zip(start).map(parameter).collect(),
        })
    }

    /// Checks everything that one effect can be checked for, and compiles the formula.
    ///
    /// # Errors
    /// The first thing that is wrong.
    pub(super) fn compiled(&self) -> Result<EffectFormula, DefinitionError> {
        self.check_words()?;
        let mut units = Vec::new();
        for (i, parameter) in self.parameters.iter().enumerate() {
            self.check_parameter(i, parameter)?;
            let unit = Unit::parse(&parameter.unit)
                .map_err(|problem| DefinitionError { part: Part::Parameter(i), problem })?;
            units.push(unit);
        }
        let names: Vec<&str> = self.parameters.iter().map(|p| p.name.as_str()).collect();
        let faulty =
            |e: FormulaError| DefinitionError { part: Part::Formula(e.span().start), problem: e.to_string() };
        let node =
            EffectFormula::parse(&self.formula, &names, self.acts_on.knows_tension()).map_err(faulty)?;
        for (i, name) in names.iter().enumerate() {
            require(node.has_constant(i), Part::Parameter(i), || {
                format!("the formula does not use '{name}'; leave it out, or use it")
            })?;
        }
        let (unit, what) = match self.combine {
            Combine::Factor => ("1", "a factor".to_owned()),
            Combine::Sum => (self.acts_on.unit(), format!("a sum on {}", self.acts_on.as_str())),
        };
        let needed = Unit::parse(unit).map_err(|problem| faulty(FormulaError::new(0..0, problem)))?;
        check_units(node.root(), &units, needed, &what).map_err(faulty)?;
        self.check_values(&node)?;
        Ok(node)
    }

    fn check_words(&self) -> Result<(), DefinitionError> {
        let id = &self.id;
        let is_id = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_';
        let well_formed = id.chars().all(is_id) && id.starts_with(|c: char| c.is_ascii_lowercase());
        require(well_formed && id.len() <= MAX_ID, Part::Id, || {
            format!("id '{}' needs a-z first, then a-z, 0-9 and _, {MAX_ID} in all", shown(id))
        })?;
        require(effect_named(id).is_none() && id != UNATTRIBUTED, Part::Id, || {
            format!("id '{id}' is that of a built-in effect; give yours another one, such as my_{id}")
        })?;
        require(id != "none", Part::Id, || {
            "id 'none' is what reports call the absence of every effect; give yours another one".to_owned()
        })?;
        require(self.experiment.len() <= MAX_EXPERIMENT, Part::Experiment, || {
            format!(
                "an experiment told in {} characters; {MAX_EXPERIMENT} are possible",
                self.experiment.len()
            )
        })?;
        require(self.confused_with.len() <= MAX_RIVALS, Part::ConfusedWith, || {
            format!("{} effects to be confused with; {MAX_RIVALS} are possible", self.confused_with.len())
        })?;
        require(self.drawn_from.len() <= MAX_SESSIONS, Part::DrawnFrom, || {
            format!("drawn from {} sessions; {MAX_SESSIONS} are possible", self.drawn_from.len())
        })?;
        for told in &self.drawn_from {
            require(tells_readings(told), Part::DrawnFrom, || {
                format!(
                    "drawn from '{}', which tells no readings; leave drawn_from as `calibrate` wrote it, or take it out if you \
                     claim the effect yourself",
                    shown(told)
                )
            })?;
        }
        require(!self.confused_with.contains(&self.id), Part::ConfusedWith, || {
            format!("'{}' is the effect itself; name others", self.id)
        })?;
        let count = self.parameters.len();
        require((1..=MAX_PARAMETERS).contains(&count), Part::Parameters, || {
            format!("{count} parameters; 1 to {MAX_PARAMETERS} are possible")
        })?;
        require(self.parameters.iter().any(|p| p.bounds.is_none()), Part::Parameters, || {
            "no parameter is a size; mark the one at whose zero the effect is gone: size = true".to_owned()
        })
    }

    fn check_parameter(&self, i: usize, parameter: &OwnParameter) -> Result<(), DefinitionError> {
        let OwnParameter { name, start, bounds, .. } = parameter;
        let part = || Part::Parameter(i);
        let is_name = |c: char| c.is_ascii_alphanumeric() || c == '_';
        let well_formed = name.chars().all(is_name) && name.starts_with(|c: char| c.is_ascii_alphabetic());
        require(well_formed && name.len() <= MAX_NAME, part(), || {
            format!(
                "parameter '{}' needs a letter first, then letters, digits and _, {MAX_NAME} in all",
                shown(name)
            )
        })?;
        require(variable(name).is_none(), part(), || {
            let names: Vec<&str> = VARIABLES.iter().map(|v| v.name).collect();
            format!("parameter '{name}' has the name of a variable; taken are {}", names.join(", "))
        })?;
        require(!is_reserved(name), part(), || {
            format!("parameter '{name}' has the name of a function; give it another one, such as my_{name}")
        })?;
        let usable = |v: f64| v.is_finite() && v.abs() <= MAX_VALUE;
        require(
            usable(*start) && bounds.is_none_or(|(low, high)| usable(low) && usable(high)),
            part(),
            || format!("start, low and high of '{name}' are numbers from -{MAX_VALUE} to {MAX_VALUE}"),
        )?;
        let Some((low, high)) = bounds else {
            let first = self.parameters.iter().position(|p| p.bounds.is_none()) == Some(i);
            let positive = self.one_sided && first;
            return require(*start != 0.0 && (*start > 0.0 || !positive), part(), || {
                let wanted = if positive { "above 0, since one_sided = true" } else { "other than 0" };
                format!("start = {start} of the size '{name}': give what is typical of it, {wanted}")
            });
        };
        require(low < start && start < high, part(), || {
            format!("start = {start} of '{name}' must lie between low = {low} and high = {high}")
        })
    }

    /// Why small sizes are in no proportion to what they do; `None` if they are. Of `k^2`, `abs(k)` or `sqrt(k)` no linear fit can
    /// begin at zero, and an interval about zero means nothing.
    pub(super) fn not_in_proportion(&self, node: &EffectFormula) -> Option<String> {
        const SMALL: f64 = 1e-4;
        let at = |size: f64| -> Vec<f64> {
            let values: Vec<f64> =
                self.parameters.iter().map(|p| p.bounds.map_or(size * p.start, |_| p.start)).collect();
            probes().iter().map(|probe| node.value(&values, &probe.moment())).collect()
        };
        let [small, twice, turned] = [SMALL, 2.0 * SMALL, -SMALL].map(at);
        let length = |values: &[f64]| values.iter().map(|v| v.abs()).filter(|v| v.is_finite()).sum::<f64>();
        let with = |other: &[f64], factor: f64| -> Vec<f64> {
            small.iter().zip(other).map(|(a, b)| factor * a - b).collect()
        };
        let off = length(&with(&twice, 2.0)).max(length(&with(&turned, -1.0)));
        (off > 0.05 * length(&small) && off > 1e-12).then(|| {
            "small sizes must act in proportion, and the other way round where negative: k*f or exp(k*f) - 1, not k^2, abs(k), sqrt(k)"
                .to_owned()
        })
    }

    /// With all sizes zero nothing is left, and at the start there is a number, on rows that span what a rig does.
    fn check_values(&self, node: &EffectFormula) -> Result<(), DefinitionError> {
        let formula = |problem| DefinitionError { part: Part::Formula(0), problem };
        let pick = |size: f64, shape: fn(f64, (f64, f64)) -> f64| -> Vec<f64> {
            self.parameters.iter().map(|p| p.bounds.map_or(size * p.start, |b| shape(p.start, b))).collect()
        };
        let gone = [
            pick(0.0, |start, _| start),
            pick(0.0, |_, (low, high)| low + 0.01 * (high - low)),
            pick(0.0, |_, (low, high)| high - 0.01 * (high - low)),
        ];
        let there = pick(1.0, |start, _| start);
        // What acts in a narrow range only may act in none of these rows.
        let mut acts = node.root().has_cases();
        for probe in probes() {
            let moment = probe.moment();
            let value = node.value(&there, &moment);
            if !value.is_finite() {
                let text =
                    format!("no number at its start values {}; guard it with max or min", probe.told());
                return Err(formula(text));
            }
            acts |= value.abs() > 1e-12;
            if let Some(left) =
                gone.iter().map(|k| node.value(k, &moment)).find(|v| v.is_nan() || v.abs() >= 1e-9)
            {
                let text = format!(
                    "with all sizes zero it must be zero, and is {left:.4} {}; mark every constant that makes it vanish as a \
                     size, or subtract what is left",
                    probe.told()
                );
                return Err(formula(text));
            }
        }
        if acts {
            return Ok(());
        }
        Err(formula("it is zero in every row at its start values: such an effect does nothing".to_owned()))
    }
}

/// A text of any length as an error shows it.
fn shown(text: &str) -> String {
    pinswitch_diagnostic::excerpt(text, 60)
}
