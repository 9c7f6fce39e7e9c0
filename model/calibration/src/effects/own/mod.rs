//! Effects of one's own: written as formulas in a file, they take part as the built-in ones do.
//!
//! A file ([`file`]) becomes definitions, a definition is checked and its formula compiled, and what comes of it is an
//! [`Effect`] of a [`Vocabulary`](super::Vocabulary). `model/doc/own-effects.md` tells a user how to write one.

mod definition;
mod determined;
mod expression;
mod file;
mod probe;
#[cfg(test)]
mod tests;
mod unit;
mod unit_check;
mod variable;
mod writer;

pub use definition::{DefinitionError, EffectDefinition, OwnParameter};
pub(crate) use file::effects_of_model;
pub use file::{OwnEffectError, read_own_effects};
pub use writer::{own_effect_blocks, own_effects_text};

use expression::EffectFormula;
pub(crate) use expression::unknown;
use variable::Moment;

use pinswitch_friction::sort_by_number;

use super::written::{on_contact, stage};
use super::{
    ActsOn, ContactState, Covariate, Description, Effect, PaperProtocol, Parameter, StudyRange, Written,
};
use crate::table::{Condition, Frame, Point};

/// Names, units and meanings of all variables of a formula.
pub fn formula_variables() -> impl Iterator<Item = [&'static str; 3]> {
    variable::VARIABLES.iter().map(|v| [v.name, v.unit, v.meaning])
}

/// An effect of one's own: a definition that is one, with its formula compiled.
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
///     drawn_from: Vec::new(),
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
    formula: EffectFormula,
}

impl OwnEffect {
    /// The effect of a definition. Sizes are put before shapes, as everywhere.
    ///
    /// # Errors
    /// [`DefinitionError`]: what of it is wrong.
    pub fn new(mut definition: EffectDefinition) -> Result<Self, DefinitionError> {
        // The order in the definition is what errors point at.
        definition.compiled()?;
        sort_by_number(&mut definition.parameters, |p| f64::from(p.bounds.is_some()));
        let formula = definition.compiled()?;
        Ok(Self { definition, formula })
    }

    /// What is said of it.
    pub fn definition(&self) -> &EffectDefinition {
        &self.definition
    }

    /// Names of constants that no data can tell apart, if there are any.
    pub(super) fn constants_not_told_apart(&self) -> Option<Vec<&str>> {
        determined::not_told_apart(&self.formula, &self.definition.parameters)
    }

    /// Name of a shape that moves the effect by jumps alone, if there is one.
    pub(super) fn moved_by_jumps(&self) -> Option<&str> {
        determined::jumps_only(&self.formula, &self.definition.parameters)
    }

    /// What is wrong with sizes that act in no proportion while they are small, if they do.
    pub(super) fn sizes_out_of_proportion(&self) -> Option<String> {
        self.definition.not_in_proportion(&self.formula)
    }

    /// The start, and the same with the shapes elsewhere within their bounds: a formula that is not linear in a shape must
    /// not be missed because its fit began on the wrong side.
    pub(super) fn starts(&self) -> Vec<Vec<f64>> {
        let parameters = &self.definition.parameters;
        let start: Vec<f64> = parameters.iter().map(|p| p.start).collect();
        let mut all = vec![start.clone()];
        let shapes: Vec<(usize, (f64, f64))> =
            parameters.iter().enumerate().filter_map(|(i, p)| Some((i, p.bounds?))).collect();
        // All places of two shapes together; of more, one at a time.
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

    /// The effect for as long as the program runs: descriptions are shared freely by reference, so that those made while it
    /// runs are never freed. What they take is bounded by the size of the files read.
    pub(super) fn leaked(self) -> &'static LeakedEffect {
        let description = Box::leak(Box::new(self.description()));
        Box::leak(Box::new(LeakedEffect { own: self, description }))
    }

    fn description(&self) -> Description {
        let told = &self.definition;
        let leaked = |text: String| -> &'static str { text.leak() };
        let names: Vec<&'static str> = told.confused_with.iter().map(|id| leaked(id.clone())).collect();
        let parameters: Vec<Parameter> = told
            .parameters
            .iter()
            .map(|p| Parameter {
                name: leaked(p.name.clone()),
                unit: leaked(p.unit.clone()),
                bounds: p.bounds,
            })
            .collect();
        let start = told.parameters.first().map_or(0.0, |p| p.start);
        let middle: Vec<(f64, f64)> = told.parameters.iter().skip(1).map(|p| (p.start, p.start)).collect();
        let formula = leaked(told.formula.clone());
        let (invisible_because, experiment) = of_covariate(told.covariate);
        Description {
            id: leaked(told.id.clone()),
            side: told.side,
            covariate: told.covariate,
            stage: stage(told.acts_on, told.combine),
            formula: leaked(self.told_formula()),
            written: Written::As { acts_on: told.acts_on, combine: told.combine, formula },
            parameters: parameters.leak(),
            one_sided: told.one_sided,
            // A constant force or a scale leaves nothing that could be its own.
            bends: self.formula.reads(|v| !["direction", variable::TENSION].contains(&v.name)),
            scales: true,
            confused_with: names.leak(),
            experiment: if told.experiment.is_empty() { experiment } else { leaked(told.experiment.clone()) },
            invisible_because,
            study: StudyRange {
                size: Some((0.5 * start, 1.5 * start)),
                signed: !told.one_sided,
                shapes: middle.leak(),
                paper: PaperProtocol::Shown,
            },
        }
    }

    /// What it changes, with the formula.
    fn told_formula(&self) -> String {
        let EffectDefinition { acts_on, combine, formula, .. } = &self.definition;
        match combine {
            super::Combine::Factor => format!("{} (1 + f), f = {formula}", acts_on.as_str()),
            super::Combine::Sum => format!("{} + f, f = {formula}", acts_on.as_str()),
        }
    }
}

/// What keeps a table from showing something along a covariate, and the experiment that shows it.
fn of_covariate(covariate: Covariate) -> (&'static str, &'static str) {
    match covariate {
        Covariate::Load => ("the load hardly varies", "several loads, all else the same"),
        Covariate::Direction => ("only one direction", "both directions at the same loads"),
        Covariate::Repetition => ("too few repetitions per series", "long series at one load"),
        Covariate::Position => ("the position hardly varies", "readings over the whole stroke"),
        Covariate::Speed => ("the speed never varies", "several speeds at one load"),
        Covariate::Dwell => ("the dwell time never varies", "several pauses at one load"),
        Covariate::Sweep => ("the loads never descend", "a descending sweep of loads"),
        Covariate::Time => ("the session is too short", "repeat the first series at the end of the session"),
        Covariate::Condition => ("the conditions do not differ in it", "the same loads on other layouts"),
    }
}

/// An effect of one's own that stays as long as the program runs.
#[derive(Debug)]
pub(super) struct LeakedEffect {
    pub(super) own: OwnEffect,
    description: &'static Description,
}

impl LeakedEffect {
    fn acts_on(&self) -> ActsOn {
        self.own.definition.acts_on
    }

    fn moment<'a>(point: &'a Point, condition: &'a Condition, tension_n: f64) -> Moment<'a> {
        Moment { point, condition, load_n: point.load_n, tension_n }
    }

    /// Tension or reading in newtons with the effect, which acts on it.
    fn changed(&self, k: &[f64], point: &Point, condition: &Condition, tension_n: f64) -> f64 {
        let f = self.own.formula.value(k, &Self::moment(point, condition, tension_n));
        self.own.definition.combine.applied(tension_n, f)
    }
}

/// Places over the bounds of a shape where a fit may start, as shares.
const PLACES: [f64; 3] = [0.15, 0.5, 0.85];

impl Effect for LeakedEffect {
    fn description(&self) -> &'static Description {
        self.description
    }

    fn starts(&self, _frame: &Frame) -> Vec<Vec<f64>> {
        self.own.starts()
    }

    fn on_contact(&self, k: &[f64], point: &Point, condition: &Condition, state: &mut ContactState) {
        if !self.acts_on().knows_tension() {
            let moment = Moment { load_n: state.load_n, ..Self::moment(point, condition, f64::NAN) };
            let f = self.own.formula.value(k, &moment);
            on_contact(self.acts_on(), self.own.definition.combine, f, state);
        }
    }

    fn on_tension(&self, k: &[f64], point: &Point, condition: &Condition, tension_n: f64) -> f64 {
        if self.acts_on() == ActsOn::Tension {
            self.changed(k, point, condition, tension_n)
        } else {
            tension_n
        }
    }

    fn on_reading(&self, k: &[f64], point: &Point, condition: &Condition, reading_n: f64) -> f64 {
        if self.acts_on() == ActsOn::Reading {
            self.changed(k, point, condition, reading_n)
        } else {
            reading_n
        }
    }

    fn moves_along_a_series(&self) -> bool {
        self.own.formula.reads(|v| v.moves)
    }

    fn acts_on_contact(&self) -> bool {
        !self.acts_on().knows_tension()
    }

    fn cited_formula(&self) -> String {
        format!("{} (an effect of one's own)", self.own.told_formula())
    }
}

/// Says that an id is there twice.
pub(super) fn duplicate(id: &str) -> DefinitionError {
    let problem = format!("id '{id}' is there twice; give each effect its own");
    DefinitionError { part: definition::Part::Id, problem }
}

/// A share of the way between bounds, in logarithms where they span much and are positive.
fn between((low, high): (f64, f64), share: f64) -> f64 {
    if low > 0.0 && high > 4.0 * low {
        low * libm::pow(high / low, share)
    } else {
        low + share * (high - low)
    }
}
