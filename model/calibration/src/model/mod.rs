//! The paper's model with additional terms: the forward model of model files.

mod discrepancy;
mod forward;
mod noise;
mod sensitivity;

use pinswitch_friction::{LayoutLaw, published};

use crate::effects::{Effect, SharedEffect, Side, Structure, UNATTRIBUTED, Vocabulary};
use crate::table::Frame;

pub(crate) use discrepancy::Largest;
pub use discrepancy::{Discrepancy, DiscrepancyFactor};
pub use noise::{Noise, Spread, Wandering};
pub(crate) use sensitivity::{jacobian, prediction_sd_n};

/// A term in addition to the paper's model.
#[derive(Clone, Debug)]
pub enum Term {
    /// An effect of the vocabulary.
    Named(SharedEffect),
    /// An empirical structure along one covariate.
    Structure(Structure),
}

impl Term {
    /// Returns the term of an effect of the program; [`Term::Named`] also takes user-defined ones.
    pub fn named(effect: &'static dyn Effect) -> Self {
        Term::Named(SharedEffect::Static(effect))
    }

    /// Returns its id in reports and model files.
    pub fn id(&self) -> &str {
        match self {
            Term::Named(effect) => effect.id(),
            Term::Structure(_) => UNATTRIBUTED,
        }
    }

    /// Returns the number of its constants.
    pub fn constants(&self) -> usize {
        match self {
            Term::Named(effect) => effect.parameters().len(),
            Term::Structure(_) => 1,
        }
    }

    /// Returns whether it belongs to the switch: a part has it too. Friction that differs between sessions
    /// is that of the latest one.
    pub(crate) fn is_of_switch(&self) -> bool {
        match self {
            Term::Named(effect) => effect.description().side == Side::Switch,
            Term::Structure(structure) => structure.is_change(),
        }
    }

    /// Returns the values of its constants where they are not given.
    fn otherwise(&self) -> Vec<Option<f64>> {
        match self {
            Term::Named(effect) => effect.parameters().iter().map(|p| p.otherwise).collect(),
            Term::Structure(_) => vec![None],
        }
    }

    /// Returns the bounds of its constants; `None` for sizes.
    fn bounds(&self) -> Vec<Option<(f64, f64)>> {
        match self {
            Term::Named(effect) => effect.parameters().iter().map(|p| p.bounds).collect(),
            Term::Structure(_) => vec![None],
        }
    }
}

/// Prior of a constant: mean and standard deviation of its coordinate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Prior {
    pub(crate) mean: f64,
    pub(crate) sd: f64,
}

/// The paper's model with additional terms. Constants are stored in unbounded coordinates:
/// logarithms of positive constants, logits of bounded shapes, and sizes unchanged, since clipping
/// would stall a fit.
///
/// ```
/// use pinswitch_calibration::effects::effect_named;
/// use pinswitch_calibration::model::{Model, Term};
/// use pinswitch_calibration::table::{Frame, PlateauTable};
///
/// let csv = "series,substrate,pins,sweep,load_mass_g,load_N,speed_pct,dwell_s,direction,repetition,position_mm,time_s,force_N
/// a,silicone,,up,0,10,50,3,concentric,1,12.7,4.5,0
/// ";
/// let rows = PlateauTable::read(csv.as_bytes(), "plateaus.csv")?.rows;
/// let model = Model::baseline(Frame::new(&rows));
/// let points = model.frame.points(&rows).ok_or("a condition is new")?;
/// let offset = effect_named("load_cell_offset").ok_or("not in the catalogue")?;
/// let with = model.with_term(Term::named(offset), &[0.5]);
/// assert!((with.predict(&points)[0] - model.predict(&points)[0] - 0.5).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Model {
    /// Conditions and reference values.
    pub frame: Frame,
    /// Terms in addition to the paper's model.
    pub terms: Vec<Term>,
    /// Where the forms of the terms may be wrong.
    pub discrepancies: Vec<Discrepancy>,
    /// Effects that may be terms.
    pub vocabulary: Vocabulary,
    /// Coordinates of all constants: the baseline's first, then term by term.
    pub(crate) coordinates: Vec<f64>,
    priors: Vec<Prior>,
    /// Index of the exponent of each `plain` condition among the constants.
    pub(super) plain: Vec<usize>,
}

/// Standard deviations of the weak priors on the baseline, in logarithms: friction coefficients,
/// threshold, steepness.
const PRIOR_LOG_MU: f64 = 1.0;
pub(crate) const PRIOR_LOG_HALF_LOAD: f64 = 0.5;
const PRIOR_LOG_STEEPNESS: f64 = 0.5;
/// Prior of the exponent or the friction coefficient of a `plain` contact, and its standard deviation in
/// the logarithm.
pub(crate) const PLAIN_MU: f64 = 0.3;
pub(crate) const PRIOR_LOG_PLAIN: f64 = 1.5;
/// The same for the factor by which a constant differs between sessions or specimens.
const PRIOR_LOG_CHANGE: f64 = 0.3;

impl Model {
    /// Returns the paper's model with the published constants and the layout law
    /// (`model/doc/friction-laws.md`).
    pub fn baseline(frame: Frame) -> Self {
        let mut priors = vec![
            Prior { mean: libm::log(published::MU_PINS), sd: PRIOR_LOG_MU },
            Prior { mean: libm::log(published::MU_SILICONE), sd: PRIOR_LOG_MU },
        ];
        for condition in frame.conditions.iter().filter(|c| c.device.is_some()) {
            let n = condition.pins.len() as f64;
            let span = condition.pins.last().zip(condition.pins.first()).map_or(0, |(l, f)| l - f) as f64;
            let pitch = if n > 1.0 {
                span / (n - 1.0) * published::GROOVE_PITCH_DEG.to_radians()
            } else {
                condition.wrap_rad
            };
            let half = LayoutLaw::half_load_at_n(n, pitch, condition.wrap_rad);
            priors.push(Prior { mean: libm::log(half), sd: PRIOR_LOG_HALF_LOAD });
            priors.push(Prior { mean: libm::log(LayoutLaw::STEEPNESS), sd: PRIOR_LOG_STEEPNESS });
        }
        // `plain` contacts at several wrap angles have one friction coefficient.
        let mut plain = vec![usize::MAX; frame.conditions.len()];
        let first_plain = priors.len();
        for (i, condition) in frame.conditions.iter().enumerate() {
            if condition.substrate.is_none() {
                plain[i] = if frame.has_plain_angles { first_plain } else { priors.len() };
                if plain[i] == priors.len() {
                    priors.push(Prior { mean: libm::log(PLAIN_MU), sd: PRIOR_LOG_PLAIN });
                }
            }
        }
        priors.extend(frame.changes.iter().map(|_| Prior { mean: 0.0, sd: PRIOR_LOG_CHANGE }));
        let coordinates = priors.iter().map(|p| p.mean).collect();
        let (terms, discrepancies, vocabulary) = (Vec::new(), Vec::new(), Vocabulary::built_in());
        Self { frame, terms, discrepancies, vocabulary, coordinates, priors, plain }
    }

    /// Returns the model with another vocabulary.
    #[must_use]
    pub fn among(mut self, vocabulary: &Vocabulary) -> Self {
        self.vocabulary = vocabulary.clone();
        self
    }

    /// Adds a term whose constants have these values; the last ones may be left out where the effect has values for them.
    #[must_use]
    pub fn with_term(&self, term: Term, values: &[f64]) -> Self {
        let mut model = self.clone();
        let otherwise = term.otherwise();
        let others = otherwise.iter().skip(values.len()).flatten();
        for (bounds, value) in term.bounds().into_iter().zip(values.iter().chain(others)) {
            model.coordinates.push(to_coordinate(*value, bounds));
            model.priors.push(match bounds {
                Some(_) => Prior { mean: 0.0, sd: 1.6 },
                None => Prior { mean: 0.0, sd: 1e6 },
            });
        }
        model.terms.push(term);
        model
    }

    /// Adds a factor of the size of a term.
    #[must_use]
    pub(crate) fn with_discrepancy(mut self, discrepancy: Discrepancy) -> Self {
        self.discrepancies.push(discrepancy);
        self
    }

    /// Returns the index among the constants of the factor of the frame's first change; the others
    /// follow.
    pub(crate) fn first_change(&self) -> usize {
        self.baseline_len() - self.frame.changes.len()
    }

    /// Returns its effects, in the order of its terms.
    pub fn named_effects(&self) -> Vec<&dyn Effect> {
        self.terms
            .iter()
            .filter_map(|term| match term {
                Term::Named(effect) => Some(&**effect),
                Term::Structure(_) => None,
            })
            .collect()
    }

    /// Removes the term of an index.
    #[must_use]
    pub fn without_term(&self, index: usize) -> Self {
        let mut model = self.clone();
        let at = self.term_offset(index);
        let len = self.terms[index].constants();
        model.coordinates.drain(at..at + len);
        model.priors.drain(at..at + len);
        model.terms.remove(index);
        model.discrepancies.retain(|discrepancy| discrepancy.term != index);
        for discrepancy in &mut model.discrepancies {
            discrepancy.term -= usize::from(discrepancy.term > index);
        }
        model
    }

    /// Removes the terms for which the predicate is true.
    #[must_use]
    pub(crate) fn without_terms(&self, is_out: impl Fn(&Term) -> bool) -> Self {
        let out = (0..self.terms.len()).rev().filter(|index| is_out(&self.terms[*index]));
        out.fold(self.clone(), |model, index| model.without_term(index))
    }

    /// Returns the index of the first constant of a term.
    pub fn term_offset(&self, index: usize) -> usize {
        self.baseline_len() + self.terms.iter().take(index).map(Term::constants).sum::<usize>()
    }

    /// Returns the number of the baseline's constants.
    pub(crate) fn baseline_len(&self) -> usize {
        self.coordinates.len() - self.terms.iter().map(Term::constants).sum::<usize>()
    }

    /// Returns the indices of a device's threshold and steepness among the constants.
    pub fn device_constants(device: usize) -> [usize; 2] {
        [2 + 2 * device, 3 + 2 * device]
    }

    pub(crate) fn priors(&self) -> &[Prior] {
        &self.priors
    }

    /// Returns names and units of all constants, the baseline's first.
    pub fn names(&self) -> Vec<(String, &str)> {
        let mut names = vec![("mu_p".to_owned(), "1"), ("mu_s".to_owned(), "1")];
        for condition in self.frame.conditions.iter().filter(|c| c.device.is_some()) {
            let layout = condition.layout();
            names.push((format!("F_half[{layout}]"), "N"));
            names.push((format!("s[{layout}]"), "1"));
        }
        let name = if self.frame.has_plain_angles { "mu" } else { "x" };
        (0..self.plain_count()).for_each(|_| names.push((name.to_owned(), "1")));
        for change in &self.frame.changes {
            let all = self.frame.groups_by(change.by);
            let groups: Vec<&str> =
                change.groups.iter().filter_map(|i| all.get(*i)).map(String::as_str).collect();
            names.push((format!("{}[{}]/latest", change.constant.as_str(), groups.join("; ")), "1"));
        }
        let mut structures = 0;
        for term in &self.terms {
            match term {
                Term::Named(effect) => names.extend(
                    effect.parameters().iter().map(|p| (format!("{}.{}", effect.id(), p.name), &*p.unit)),
                ),
                Term::Structure(structure) => {
                    structures += 1;
                    names.push((format!("{UNATTRIBUTED}.{structures}"), structure.unit()));
                }
            }
        }
        names
    }

    /// Returns the value of a constant and its derivative with respect to its coordinate.
    pub(crate) fn value(&self, index: usize) -> (f64, f64) {
        self.value_at(index, self.coordinates[index])
    }

    /// Returns the value that a constant has at a coordinate, and its derivative.
    pub(crate) fn value_at(&self, index: usize, coordinate: f64) -> (f64, f64) {
        if index < self.baseline_len() {
            return (libm::exp(coordinate), libm::exp(coordinate));
        }
        let mut at = self.baseline_len();
        for term in &self.terms {
            for bounds in term.bounds() {
                if at == index {
                    return from_coordinate(coordinate, bounds);
                }
                at += 1;
            }
        }
        (coordinate, 1.0)
    }

    /// Returns the bounds of a constant: those of a shape, zero for the baseline's, none for a
    /// size.
    pub(crate) fn bounds_of(&self, index: usize) -> (f64, f64) {
        let Some(beyond) = index.checked_sub(self.baseline_len()) else { return (0.0, f64::INFINITY) };
        let bounds: Vec<_> = self.terms.iter().flat_map(Term::bounds).collect();
        bounds.get(beyond).copied().flatten().unwrap_or((f64::NEG_INFINITY, f64::INFINITY))
    }

    /// Returns the value of a constant where it is not given.
    pub(crate) fn otherwise(&self, index: usize) -> Option<f64> {
        let beyond = index.checked_sub(self.baseline_len())?;
        self.terms.iter().flat_map(Term::otherwise).nth(beyond).flatten()
    }

    /// Returns the value of a constant by its name.
    pub fn constant(&self, name: &str) -> Option<f64> {
        let at = self.names().iter().position(|(known, _)| known == name)?;
        Some(self.value(at).0)
    }

    /// Replaces a named term by the effect of another id in a vocabulary, with the same constants.
    pub(crate) fn renamed(mut self, from: &str, vocabulary: &Vocabulary, to: &str) -> Option<Self> {
        let effect = vocabulary.named(to)?;
        let term = self.terms.iter_mut().find(|term| term.id() == from)?;
        *term = Term::Named(effect);
        Some(self.among(vocabulary))
    }

    /// Returns the values of all constants.
    pub fn values(&self) -> Vec<f64> {
        (0..self.coordinates.len()).map(|i| self.value(i).0).collect()
    }

    /// Sets the constants, in the order of [`Model::names`]; returns false if their number is
    /// wrong.
    pub fn set_values(&mut self, values: &[f64]) -> bool {
        if values.len() != self.coordinates.len() {
            return false;
        }
        let base = self.baseline_len();
        let bounds: Vec<_> = self.terms.iter().flat_map(Term::bounds).collect();
        for (i, value) in values.iter().enumerate() {
            self.coordinates[i] =
                if i < base { libm::log(value.max(1e-12)) } else { to_coordinate(*value, bounds[i - base]) };
        }
        true
    }

    /// Returns the model in a frame with more conditions, whose additional constants come from the
    /// layout law.
    #[must_use]
    pub fn in_frame(&self, frame: Frame) -> Self {
        let mut model = Self::baseline(frame).among(&self.vocabulary);
        let (mut from, mut to) = (2, 2);
        model.coordinates[..2].copy_from_slice(&self.coordinates[..2]);
        // Conditions keep their order; new ones follow: devices first, then plain contacts.
        for (known, all) in [
            (2 * self.frame.devices(), 2 * model.frame.devices()),
            (self.plain_count(), model.plain_count()),
            (self.frame.changes.len(), model.frame.changes.len()),
        ] {
            model.coordinates[to..to + known].copy_from_slice(&self.coordinates[from..from + known]);
            from += known;
            to += all;
        }
        model.terms.clone_from(&self.terms);
        model.discrepancies.clone_from(&self.discrepancies);
        model.coordinates.extend_from_slice(&self.coordinates[from..]);
        model.priors.extend_from_slice(&self.priors[from..]);
        model
    }

    fn plain_count(&self) -> usize {
        let indices = self.plain.iter().filter(|at| **at != usize::MAX);
        indices.collect::<std::collections::BTreeSet<_>>().len()
    }
}

/// Returns the logit of a bounded value, with the range widened by 0.1 % so that the ends stay
/// finite.
fn to_coordinate(value: f64, bounds: Option<(f64, f64)>) -> f64 {
    bounds.map_or(value, |(least, most)| {
        let share = ((value - least) / (most - least)).clamp(1e-4, 1.0 - 1e-4);
        libm::log(share / (1.0 - share))
    })
}

/// Returns value and derivative of a bounded constant at its coordinate.
fn from_coordinate(coordinate: f64, bounds: Option<(f64, f64)>) -> (f64, f64) {
    bounds.map_or((coordinate, 1.0), |(least, most)| {
        let share = 1.0 / (1.0 + libm::exp(-coordinate));
        (least + (most - least) * share, (most - least) * share * (1.0 - share))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn coordinates_and_values_are_inverse(value in 0.01..0.99f64) {
            let bounds = Some((0.0, 1.0));
            prop_assert!((from_coordinate(to_coordinate(value, bounds), bounds).0 - value).abs() < 1e-9);
        }
    }
}
