//! The paper's model with additional terms: its constants, and the coordinates in which they are
//! fitted.

use pinswitch_friction::{LayoutLaw, published};

use crate::effects::{Covariate, Effect, Shape, Structure, Vocabulary};
use crate::table::{Change, Frame};

/// Id of structure that no effect explains.
pub const UNATTRIBUTED: &str = "unattributed";

/// A term in addition to the paper's model.
#[derive(Clone, Debug)]
pub enum Term {
    /// An effect of the vocabulary.
    Named(&'static dyn Effect),
    /// An empirical structure along one covariate.
    Structure(Structure),
}

impl Term {
    /// Returns its id in reports and model files.
    pub fn id(&self) -> &'static str {
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

    /// Returns whether it varies within a series: with the repetition, the position or the time.
    pub(crate) fn moves_along_a_series(&self) -> bool {
        let covariate = match self {
            Term::Named(effect) => return effect.moves_along_a_series(),
            Term::Structure(Structure { form: Shape::Memory { .. }, .. }) => return true,
            Term::Structure(structure) => structure.covariate,
        };
        matches!(covariate, Covariate::Repetition | Covariate::Position | Covariate::Time)
    }

    /// Returns whether its effect on the contact varies within a series.
    pub(super) fn moves_contact(&self) -> bool {
        self.moves_along_a_series()
            && match self {
                Term::Named(effect) => effect.acts_on_contact(),
                Term::Structure(structure) => !structure.is_of_reading(),
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
/// use pinswitch_calibration::inference::{Model, Term};
/// use pinswitch_calibration::table::{Frame, PlateauTable};
///
/// let csv = "series,substrate,pins,sweep,load_mass_g,load_N,speed_pct,dwell_s,direction,repetition,position_mm,time_s,force_N
/// a,silicone,,up,0,10,50,3,concentric,1,12.7,4.5,0
/// ";
/// let rows = PlateauTable::read(csv.as_bytes(), "plateaus.csv")?.rows;
/// let model = Model::baseline(Frame::new(&rows));
/// let points = model.frame.points(&rows).ok_or("a condition is new")?;
/// let offset = effect_named("load_cell_offset").ok_or("not in the catalogue")?;
/// let with = model.with_term(Term::Named(offset), &[0.5]);
/// assert!((with.predict(&points)[0] - model.predict(&points)[0] - 0.5).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Model {
    /// Conditions and reference values.
    pub frame: Frame,
    /// Terms in addition to the paper's model.
    pub terms: Vec<Term>,
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
const PRIOR_LOG_HALF_LOAD: f64 = 0.35;
const PRIOR_LOG_STEEPNESS: f64 = 0.5;
/// The same for the factor by which a constant differs between sessions or specimens.
const PRIOR_LOG_CHANGE: f64 = 0.3;

/// Prior standard deviation of the coordinate of a fixed constant.
const HELD: f64 = 1e-5;

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
        let mut plain = vec![usize::MAX; frame.conditions.len()];
        for (i, condition) in frame.conditions.iter().enumerate() {
            if condition.substrate.is_none() {
                plain[i] = priors.len();
                priors.push(Prior { mean: libm::log(0.3f64), sd: 1.5 });
            }
        }
        priors.extend(frame.changes.iter().map(|_| Prior { mean: 0.0, sd: PRIOR_LOG_CHANGE }));
        let coordinates = priors.iter().map(|p| p.mean).collect();
        Self { frame, terms: Vec::new(), vocabulary: Vocabulary::built_in(), coordinates, priors, plain }
    }

    /// Returns the model with another vocabulary.
    #[must_use]
    pub fn among(mut self, vocabulary: &Vocabulary) -> Self {
        self.vocabulary = vocabulary.clone();
        self
    }

    /// Adds a term whose constants have these values.
    #[must_use]
    pub fn with_term(&self, term: Term, values: &[f64]) -> Self {
        let mut model = self.clone();
        for (bounds, value) in term.bounds().into_iter().zip(values) {
            model.coordinates.push(to_coordinate(*value, bounds));
            model.priors.push(match bounds {
                Some(_) => Prior { mean: 0.0, sd: 1.6 },
                None => Prior { mean: 0.0, sd: 1e6 },
            });
        }
        model.terms.push(term);
        model
    }

    /// Adds a constant that differs in some sessions or specimens, with a factor of one.
    #[must_use]
    pub(crate) fn with_change(&self, change: Change) -> Self {
        let (mut model, at) = (self.clone(), self.baseline_len());
        model.frame.changes.push(change);
        model.coordinates.insert(at, 0.0);
        model.priors.insert(at, Prior { mean: 0.0, sd: PRIOR_LOG_CHANGE });
        model
    }

    /// Removes the last change.
    #[must_use]
    pub(crate) fn without_last_change(&self) -> Self {
        let (mut model, at) = (self.clone(), self.baseline_len() - 1);
        if model.frame.changes.pop().is_some() {
            model.coordinates.remove(at);
            model.priors.remove(at);
        }
        model
    }

    /// Returns the index among the constants of the factor of the frame's first change; the others
    /// follow.
    pub(crate) fn first_change(&self) -> usize {
        self.baseline_len() - self.frame.changes.len()
    }

    /// Returns its effects, in the order of its terms.
    pub fn named_effects(&self) -> Vec<&'static dyn Effect> {
        self.terms
            .iter()
            .filter_map(|term| match term {
                Term::Named(effect) => Some(*effect),
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
        model
    }

    /// Removes the terms for which the predicate is true.
    #[must_use]
    pub(crate) fn without_terms(&self, is_out: impl Fn(&Term) -> bool) -> Self {
        let out = (0..self.terms.len()).rev().filter(|index| is_out(&self.terms[*index]));
        out.fold(self.clone(), |model, index| model.without_term(index))
    }

    /// Fixes every constant except these.
    #[must_use]
    pub(crate) fn frozen_except(&self, free: &[usize]) -> Self {
        let mut model = self.clone();
        for (i, (prior, coordinate)) in model.priors.iter_mut().zip(&model.coordinates).enumerate() {
            if !free.contains(&i) {
                *prior = Prior { mean: *coordinate, sd: HELD };
            }
        }
        model
    }

    /// Fixes one bounded constant at a share of its range; `None` for a constant without bounds.
    pub(crate) fn held_at(&self, index: usize, share: f64) -> Option<Self> {
        let (low, high) = self.bounds_of(index);
        let bounds = (low.is_finite() && high.is_finite()).then_some((low, high))?;
        let mean = to_coordinate(low + share * (high - low), Some(bounds));
        let mut model = self.clone();
        model.coordinates[index] = mean;
        model.priors[index] = Prior { mean, sd: HELD };
        Some(model)
    }

    /// Returns whether a constant is fixed.
    pub(crate) fn is_held(&self, index: usize) -> bool {
        self.priors[index].sd <= HELD
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
    pub fn names(&self) -> Vec<(String, &'static str)> {
        let mut names = vec![("mu_p".to_owned(), "1"), ("mu_s".to_owned(), "1")];
        for condition in self.frame.conditions.iter().filter(|c| c.device.is_some()) {
            let layout = condition.layout();
            names.push((format!("F_half[{layout}]"), "N"));
            names.push((format!("s[{layout}]"), "1"));
        }
        for _ in self.plain.iter().filter(|at| **at != usize::MAX) {
            names.push(("x".to_owned(), "1"));
        }
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
                    effect.parameters().iter().map(|p| (format!("{}.{}", effect.id(), p.name), p.unit)),
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
        let coordinate = self.coordinates[index];
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
        model.coordinates.extend_from_slice(&self.coordinates[from..]);
        model.priors.extend_from_slice(&self.priors[from..]);
        model
    }

    fn plain_count(&self) -> usize {
        self.plain.iter().filter(|at| **at != usize::MAX).count()
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
