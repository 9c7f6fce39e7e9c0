//! User-defined effects: formulas in a file that are used like the built-in effects.
//!
//! A file ([`file`]) is parsed to definitions; a definition is checked and its formula compiled,
//! which gives an [`Effect`] of a [`Vocabulary`](super::Vocabulary). `model/doc/own-effects.md`
//! explains to users how to write one.

mod definition;
mod file;
mod identifiability;
mod probe;
#[cfg(test)]
mod tests;
mod unit;
mod unit_check;
mod unknown_name;
mod writer;

pub use definition::{DefinitionError, EffectDefinition, OwnParameter};
pub(crate) use file::effects_of_model;
pub use file::effects_schema;
pub use file::read_own_effects;
pub(crate) use unknown_name::unknown_name;
pub use writer::{own_effect_blocks, own_effects_text};

use std::borrow::Cow;

use pinswitch_diagnostic::{Diagnostic, codes};
use pinswitch_friction::sort_by_number;

use super::formula::{EffectFormula, TENSION, VARIABLES, stage};
use super::{AppliedFormula, Covariate, Description, Effect, PaperProtocol, Parameter, StudyRange, Written};
use crate::table::Frame;

/// Returns names, units and descriptions of all variables of formulas.
pub fn formula_variables() -> impl Iterator<Item = [&'static str; 3]> {
    VARIABLES.iter().map(|v| [v.name, v.unit, v.meaning])
}

/// A user-defined effect: a valid definition with its compiled formula.
///
/// ```
/// use pinswitch_calibration::effects::{
///     ActsOn, Combine, Covariate, EffectDefinition, OwnEffect, OwnParameter, Side, Vocabulary,
/// };
///
/// let dip = EffectDefinition {
///     id: "fast_creep".to_owned(),
///     side: Side::Rig,
///     covariate: Covariate::Dwell,
///     acts_on: ActsOn::Reading,
///     combine: Combine::Factor,
///     formula: "k*ln(dwell_s/3)".to_owned(),
///     one_sided: true,
///     confused_with: vec!["dwell_relaxation".to_owned()],
///     experiment: "dead weights with two pauses".to_owned(),
///     drawn_from: None,
///     parameters: vec![OwnParameter { name: "k".into(), unit: "1".into(), start: 0.02, bounds: None }],
/// };
/// let error = OwnEffect::new(EffectDefinition { formula: "k*ln(dwel_s/3)".into(), ..dip.clone() }).unwrap_err();
/// assert!(error.to_string().ends_with("did you mean dwell_s?"));
///
/// let vocabulary = Vocabulary::built_in().with(vec![OwnEffect::new(dip)?])?;
/// assert!(vocabulary.named("fast_creep").is_some());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct OwnEffect {
    definition: EffectDefinition,
    applied: AppliedFormula,
    described: Described,
}

impl OwnEffect {
    /// Checks and compiles a definition. Sizes are moved before shapes.
    ///
    /// # Errors
    /// [`DefinitionError`] of the first problem.
    pub fn new(mut definition: EffectDefinition) -> Result<Self, DefinitionError> {
        // Checked before the parameters are sorted, since errors refer to the original order.
        definition.compiled()?;
        sort_by_number(&mut definition.parameters, |p| f64::from(p.bounds.is_some()));
        let formula = definition.compiled()?;
        let described = Described::new(&definition, &formula);
        let applied = AppliedFormula::new(definition.acts_on, definition.combine, formula);
        Ok(Self { definition, applied, described })
    }

    /// Returns the definition.
    pub fn definition(&self) -> &EffectDefinition {
        &self.definition
    }

    /// Returns the names of constants that no data can identify, if there are any.
    pub(super) fn unidentifiable_constants(&self) -> Option<Vec<&str>> {
        identifiability::unidentifiable(self.applied.formula(), &self.definition.parameters)
    }

    /// Returns the name of a shape that changes the effect only in steps, if there is one.
    pub(super) fn step_parameter(&self) -> Option<&str> {
        identifiability::step_parameter(self.applied.formula(), &self.definition.parameters)
    }

    /// Returns whether the effect is nonlinear in small sizes.
    pub(super) fn is_nonlinear_in_sizes(&self) -> bool {
        self.definition.is_nonlinear_in_sizes(self.applied.formula())
    }

    /// Returns the start values, followed by variants with the shapes at other places within their
    /// bounds, so that a fit of a nonlinear shape does not end in a local minimum. A derived effect has the
    /// place where it was derived: at another one it would be another effect, which its readings did not show.
    pub(super) fn shape_starts(&self) -> Vec<Vec<f64>> {
        let parameters = &self.definition.parameters;
        let start: Vec<f64> = parameters.iter().map(|p| p.start).collect();
        let mut all = vec![start.clone()];
        if self.definition.drawn_from.as_ref().is_some_and(|readings| !readings.is_empty()) {
            return all;
        }
        let shapes: Vec<(usize, (f64, f64))> =
            parameters.iter().enumerate().filter_map(|(i, p)| Some((i, p.bounds?))).collect();
        // Two shapes are varied jointly, more than two one at a time.
        for (nth, (i, bounds)) in shapes.iter().enumerate() {
            let before = if shapes.len() == 2 && nth == 1 { all.clone() } else { vec![start.clone()] };
            for from in before {
                for share in PLACES {
                    let mut moved = from.clone();
                    moved[*i] = between(*bounds, share);
                    all.push(moved);
                }
            }
        }
        all
    }
}

/// What a description of an effect borrows in addition to the definition.
#[derive(Clone, Debug, PartialEq)]
struct Described {
    /// Formula with the quantity that it changes.
    full_formula: String,
    parameters: Vec<Parameter>,
    confused_with: Vec<Cow<'static, str>>,
    /// Ranges of the shapes for the study.
    shapes: Vec<(f64, f64)>,
    /// Whether the formula reads more than the direction and the tension: a constant force or a scale is
    /// exact and leaves no residual of its own.
    bends: bool,
}

impl Described {
    fn new(definition: &EffectDefinition, formula: &EffectFormula) -> Self {
        let parameter = |p: &OwnParameter| Parameter {
            name: Cow::Owned(p.name.clone()),
            unit: Cow::Owned(p.unit.clone()),
            bounds: p.bounds,
            otherwise: None,
        };
        let EffectDefinition { acts_on, combine, formula: text, .. } = definition;
        Self {
            full_formula: match combine {
                super::Combine::Factor => format!("{} (1 + f), f = {text}", acts_on.as_str()),
                super::Combine::Sum => format!("{} + f, f = {text}", acts_on.as_str()),
            },
            parameters: definition.parameters.iter().map(parameter).collect(),
            confused_with: definition.confused_with.iter().cloned().map(Cow::Owned).collect(),
            shapes: definition.parameters.iter().skip(1).map(|p| (p.start, p.start)).collect(),
            bends: formula.reads(|v| !["direction", TENSION].contains(&v.name)),
        }
    }
}

/// Returns why a table may not identify an effect along a covariate, and an experiment that
/// identifies it.
fn of_covariate(covariate: Covariate) -> (&'static str, &'static str) {
    match covariate {
        Covariate::Load => ("the load hardly varies", "several loads, all else equal"),
        Covariate::Direction => ("only one direction", "both directions at the same loads"),
        Covariate::Repetition => ("too few repetitions per series", "long series at one load"),
        Covariate::Position => ("the position hardly varies", "readings over the whole stroke"),
        Covariate::Speed => ("the speed never varies", "several speeds at one load"),
        Covariate::Dwell => ("the dwell never varies", "several dwells at one load"),
        Covariate::Sweep => ("the loads never descend", "a descending sweep of loads"),
        Covariate::Time => ("the session is too short", "repeat the first series at the end of the session"),
        Covariate::Condition => ("the conditions do not differ in it", "the same loads on other layouts"),
    }
}

/// Places within the bounds of a shape where a fit may start, as shares.
const PLACES: [f64; 3] = [0.15, 0.5, 0.85];

impl Effect for OwnEffect {
    fn description(&self) -> Description<'_> {
        let EffectDefinition { side, covariate, acts_on, combine, one_sided, .. } = self.definition;
        let start = self.definition.parameters.first().map_or(0.0, |p| p.start);
        let (invisible_because, experiment) = of_covariate(covariate);
        let given = self.definition.experiment.as_str();
        Description {
            id: &self.definition.id,
            side,
            covariate,
            stage: stage(acts_on, combine),
            formula: &self.described.full_formula,
            written: Written::As { acts_on, combine, formula: &self.definition.formula },
            parameters: &self.described.parameters,
            one_sided,
            bends: self.described.bends,
            scales: true,
            on_plain: true,
            confused_with: &self.described.confused_with,
            experiment: if given.is_empty() { experiment } else { given },
            invisible_because,
            study: StudyRange {
                size: Some((0.5 * start, 1.5 * start)),
                signed: !one_sided,
                shapes: &self.described.shapes,
                paper: PaperProtocol::Shown,
            },
        }
    }

    fn id(&self) -> &str {
        &self.definition.id
    }

    fn parameters(&self) -> &[Parameter] {
        &self.described.parameters
    }

    fn typical(&self, _frame: &Frame) -> Vec<Vec<f64>> {
        self.shape_starts()
    }

    fn formula(&self) -> Option<&AppliedFormula> {
        Some(&self.applied)
    }

    fn moves_along_a_series(&self) -> bool {
        self.applied.formula().reads(|v| v.moves)
    }

    fn acts_on_contact(&self) -> bool {
        !self.definition.acts_on.knows_tension()
    }

    fn cited_formula(&self) -> String {
        format!("{} (user-defined)", self.described.full_formula)
    }
}

/// Returns the error of a repeated id.
pub(super) fn duplicate(id: &str) -> DefinitionError {
    let diagnostic = Diagnostic::new(codes::DUPLICATE_ENTRY, format!("duplicate id '{id}'"))
        .with_help("give each effect its own id");
    DefinitionError { part: definition::Part::Id, diagnostic }
}

/// Interpolates between bounds, logarithmically if they are positive and their ratio exceeds 4.
fn between((low, high): (f64, f64), share: f64) -> f64 {
    if low > 0.0 && high > 4.0 * low {
        low * libm::pow(high / low, share)
    } else {
        low + share * (high - low)
    }
}
