//! The forward model: from constants and a row to the reading.

use pinswitch_friction::{LayoutLaw, Substrate, published};

use crate::effects::{Channel, ContactState, Covariate, Effect, Shape, Side, Stage, Structure, Vocabulary};
use crate::table::{Condition, Frame, Point};

/// Id of a structure that no named effect explains.
pub const UNATTRIBUTED: &str = "unattributed";

/// One term on top of the paper's model.
#[derive(Clone, Debug)]
pub enum Term {
    /// An effect of the vocabulary.
    Named(&'static dyn Effect),
    /// A data-driven structure along one covariate.
    Structure(Structure),
}

impl Term {
    /// Its id in reports and model files.
    pub fn id(&self) -> &'static str {
        match self {
            Term::Named(effect) => effect.id(),
            Term::Structure(_) => UNATTRIBUTED,
        }
    }

    /// Number of its constants.
    pub fn constants(&self) -> usize {
        match self {
            Term::Named(effect) => effect.parameters().len(),
            Term::Structure(_) => 1,
        }
    }

    /// Whether it changes from row to row of a series: with the repetition, the position or the time.
    pub(crate) fn moves_along_a_series(&self) -> bool {
        let covariate = match self {
            Term::Named(effect) => return effect.moves_along_a_series(),
            Term::Structure(Structure { form: Shape::Memory { .. }, .. }) => return true,
            Term::Structure(structure) => structure.covariate,
        };
        matches!(covariate, Covariate::Repetition | Covariate::Position | Covariate::Time)
    }

    /// Whether what it does to the contact changes from row to row of a series.
    fn moves_contact(&self) -> bool {
        self.moves_along_a_series()
            && match self {
                Term::Named(effect) => effect.acts_on_contact(),
                Term::Structure(structure) => structure.channel != Channel::Reading,
            }
    }

    /// Bounds of its constants; `None` for sizes.
    fn bounds(&self) -> Vec<Option<(f64, f64)>> {
        match self {
            Term::Named(effect) => effect.parameters().iter().map(|p| p.bounds).collect(),
            Term::Structure(_) => vec![None],
        }
    }
}

/// What is known about a constant before any data: mean and standard deviation of its coordinate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Prior {
    pub(crate) mean: f64,
    pub(crate) sd: f64,
}

/// The paper's model with terms added. Constants are kept in unbounded coordinates: logarithms of positive
/// constants, logits of bounded shapes, sizes as they are; a clipped constant would stall a fit.
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
    /// Terms on top of the paper's model.
    pub terms: Vec<Term>,
    /// The effects that may be among them.
    pub vocabulary: Vocabulary,
    /// Coordinates of all constants: baseline first, then term by term.
    pub(crate) coordinates: Vec<f64>,
    priors: Vec<Prior>,
    plain: Vec<usize>,
}

/// Widths of the weak priors on the baseline, in logarithms: friction coefficients, half load, steepness.
const PRIOR_LOG_MU: f64 = 1.0;
const PRIOR_LOG_HALF_LOAD: f64 = 0.35;
const PRIOR_LOG_STEEPNESS: f64 = 0.5;

impl Model {
    /// The paper's model at the published constants and the layout law (`model/doc/friction-laws.md`).
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
        let coordinates = priors.iter().map(|p| p.mean).collect();
        Self { frame, terms: Vec::new(), vocabulary: Vocabulary::built_in(), coordinates, priors, plain }
    }

    /// The same model among other effects.
    #[must_use]
    pub fn among(mut self, vocabulary: &Vocabulary) -> Self {
        self.vocabulary = vocabulary.clone();
        self
    }

    /// The same model with a term whose constants have these values.
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

    /// Its named effects, in the order of its terms.
    pub fn named_effects(&self) -> Vec<&'static dyn Effect> {
        self.terms
            .iter()
            .filter_map(|term| match term {
                Term::Named(effect) => Some(*effect),
                Term::Structure(_) => None,
            })
            .collect()
    }

    /// The same model without its term of that index.
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

    /// The same model with every constant but these held where it is.
    #[must_use]
    pub(crate) fn frozen_except(&self, free: &[usize]) -> Self {
        let mut model = self.clone();
        for (i, (prior, coordinate)) in model.priors.iter_mut().zip(&model.coordinates).enumerate() {
            if !free.contains(&i) {
                *prior = Prior { mean: *coordinate, sd: 1e-5 };
            }
        }
        model
    }

    /// Index of the first constant of a term.
    pub fn term_offset(&self, index: usize) -> usize {
        self.baseline_len() + self.terms.iter().take(index).map(Term::constants).sum::<usize>()
    }

    /// Number of the baseline's constants.
    pub(crate) fn baseline_len(&self) -> usize {
        self.coordinates.len() - self.terms.iter().map(Term::constants).sum::<usize>()
    }

    /// Places of a device's half load and steepness among the constants.
    pub fn device_constants(device: usize) -> [usize; 2] {
        [2 + 2 * device, 3 + 2 * device]
    }

    pub(crate) fn priors(&self) -> &[Prior] {
        &self.priors
    }

    /// Names and units of all constants, baseline first.
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

    /// Value of a constant, its slope over its coordinate.
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

    /// Bounds of a constant: those of a shape, zero for the baseline's, none for a size.
    pub(crate) fn bounds_of(&self, index: usize) -> (f64, f64) {
        let Some(beyond) = index.checked_sub(self.baseline_len()) else { return (0.0, f64::INFINITY) };
        let bounds: Vec<_> = self.terms.iter().flat_map(Term::bounds).collect();
        bounds.get(beyond).copied().flatten().unwrap_or((f64::NEG_INFINITY, f64::INFINITY))
    }

    /// Values of all constants.
    pub fn values(&self) -> Vec<f64> {
        (0..self.coordinates.len()).map(|i| self.value(i).0).collect()
    }

    /// Sets the constants to these values, in the order of [`Model::names`]; false if their number is wrong.
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

    /// The same model in a frame with more conditions; what they need beyond it comes from the layout law.
    #[must_use]
    pub fn in_frame(&self, frame: Frame) -> Self {
        let mut model = Self::baseline(frame).among(&self.vocabulary);
        let (mut from, mut to) = (2, 2);
        model.coordinates[..2].copy_from_slice(&self.coordinates[..2]);
        // Conditions keep their order, new ones follow: devices first, then plain contacts.
        for (known, all) in
            [(2 * self.frame.devices(), 2 * model.frame.devices()), (self.plain_count(), model.plain_count())]
        {
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

    /// Readings in newtons at the points.
    pub fn predict(&self, points: &[Point]) -> Vec<f64> {
        let values = self.values();
        self.readings(&values, points, |_| true, &[])
    }

    /// Readings at the points that are `touched`, those of `before` elsewhere. The rows of a series are neighbours of one
    /// setting: what does not move along a series is computed once for all of them.
    fn readings(
        &self,
        values: &[f64],
        points: &[Point],
        touched: impl Fn(&Point) -> bool,
        before: &[f64],
    ) -> Vec<f64> {
        let terms = self.acting(values, false);
        let moves = self.terms.iter().any(Term::moves_along_a_series);
        let still = terms.iter().take_while(|(term, _)| !term.moves_contact()).count();
        let contact_moves = terms.iter().any(|(term, _)| term.moves_contact());
        let mut last: Option<Setting> = None;
        points
            .iter()
            .enumerate()
            .map(|(i, point)| {
                if !touched(point) {
                    return before[i];
                }
                let known = last.take().filter(|known| known.point.is_of_one_setting(point));
                if let Some(known) = known.as_ref().filter(|_| !moves) {
                    let reading = known.reading_n;
                    last = Some(Setting { point: *point, ..*known });
                    return reading;
                }
                let state = known
                    .as_ref()
                    .map_or_else(|| self.contact(values, &terms[..still], point), |known| known.state);
                let tension_n = match &known {
                    Some(known) if !contact_moves => known.tension_n,
                    _ => self.tension_n(&terms[still..], point, state),
                };
                let reading_n = self.reading_n(&terms, point, tension_n);
                last = Some(Setting { point: *point, state, tension_n, reading_n });
                reading_n
            })
            .collect()
    }

    /// Readings after one constant has changed, where `before` were those at the points: only conditions that the
    /// constant touches are computed again.
    pub(crate) fn predict_changed(&self, points: &[Point], before: &[f64], index: usize) -> Vec<f64> {
        let values = self.values();
        let touched: Vec<bool> = (0..self.frame.conditions.len()).map(|c| self.touches(index, c)).collect();
        self.readings(&values, points, |p| touched[p.condition], before)
    }

    /// Whether a constant enters the readings on a condition.
    fn touches(&self, index: usize, condition: usize) -> bool {
        let c = &self.frame.conditions[condition];
        match index {
            0 => c.has_pins(),
            1 => c.substrate == Some(Substrate::Silicone),
            _ if index < 2 + 2 * self.frame.devices() => c.device == Some((index - 2) / 2),
            _ if index < self.baseline_len() => self.plain[condition] == index,
            _ => true,
        }
    }

    /// Change of the readings in newtons when the friction exponent grows by one part in one.
    pub fn friction_n(&self, points: &[Point]) -> Vec<f64> {
        let everywhere = Structure {
            covariate: Covariate::Load,
            channel: Channel::Friction,
            form: Shape::LoadPower { power: 0, unit_n: 1.0 },
        };
        let size = 1e-3;
        let mut changed = self.with_term(Term::Structure(everywhere), &[size]).predict(points);
        changed.iter_mut().zip(self.predict(points)).for_each(|(c, p)| *c = (*c - p) / size);
        changed
    }

    /// Tension of a part in newtons: effects of the switch in, effects of the rig out.
    pub fn predict_part(&self, points: &[Point]) -> Vec<f64> {
        let values = self.values();
        let terms = self.acting(&values, true);
        let read = |point: &Point| {
            let state = self.contact(&values, &terms, point);
            self.reading_n(&terms, point, self.tension_n(&[], point, state))
        };
        points.iter().map(read).collect()
    }

    /// Share of the friction that the silicone makes at the points, by eq. 4 at the baseline's constants, 0..1.
    pub fn silicone_share(&self, points: &[Point]) -> Vec<f64> {
        let values = self.values();
        points
            .iter()
            .map(|p| {
                let condition = &self.frame.conditions[p.condition];
                let Some(d) = condition.device else {
                    return f64::from(u8::from(condition.substrate == Some(Substrate::Silicone)));
                };
                let [half_load, steepness] = Self::device_constants(d).map(|i| values[i]);
                let s = 1.0 / (1.0 + libm::exp(-steepness * (p.load_n / half_load - 1.0)));
                let silicone = (1.0 - condition.weight) * s * libm::sinh(values[1] * condition.wrap_rad);
                let pins = (1.0 + condition.weight) * (1.0 - s) * libm::sinh(values[0] * condition.wrap_rad);
                silicone / (silicone + pins).max(1e-300)
            })
            .collect()
    }

    /// The terms with their constants; of a part alone without those of the rig.
    fn acting<'a>(&'a self, values: &'a [f64], part_only: bool) -> Vec<(&'a Term, &'a [f64])> {
        let mut at = self.baseline_len();
        let mut terms = Vec::with_capacity(self.terms.len());
        for term in &self.terms {
            let constants = &values[at..at + term.constants()];
            at += term.constants();
            let is_kept = !part_only
                || matches!(term, Term::Named(effect) if effect.description().side == Side::Switch);
            terms.extend(is_kept.then_some((term, constants)));
        }
        terms
    }

    /// The contact at a point, as these terms change it.
    fn contact(&self, values: &[f64], terms: &[(&Term, &[f64])], point: &Point) -> ContactState {
        let condition: &Condition = &self.frame.conditions[point.condition];
        let plain = self.plain[point.condition];
        let [half_load_n, steepness] =
            condition.device.map_or([1.0, 1.0], |d| Self::device_constants(d).map(|i| values[i]));
        let mut state = ContactState {
            load_n: point.load_n,
            wrap_rad: condition.wrap_rad,
            mu_pins: values[0],
            mu_silicone: if plain == usize::MAX { values[1] } else { values[plain] },
            extra_exponent_pins: 0.0,
            exponent_factor: 1.0,
            half_load_n,
            steepness,
            local_tension: false,
            adhesion_n: 0.0,
            drag_n: 0.0,
        };
        on_contact(terms, point, condition, &mut state);
        state
    }

    /// Tension in newtons of a contact that further terms change, before the load cell.
    fn tension_n(&self, terms: &[(&Term, &[f64])], point: &Point, mut state: ContactState) -> f64 {
        let condition = &self.frame.conditions[point.condition];
        on_contact(terms, point, condition, &mut state);
        state.tension_n(condition, point)
    }

    /// Reading in newtons of a tension that the contact leaves.
    fn reading_n(&self, terms: &[(&Term, &[f64])], point: &Point, tension_n: f64) -> f64 {
        let condition = &self.frame.conditions[point.condition];
        let mut reading = tension_n;
        // What acts on the tension comes before the load cell, whichever was found first.
        for (term, constants) in terms {
            if let Term::Named(effect) = term {
                reading = effect.on_tension(constants, point, condition, reading);
            }
        }
        // What ends the range of the load cell acts on everything before it.
        let mut limits = Vec::new();
        for (term, constants) in terms {
            match term {
                Term::Named(effect) => {
                    if effect.description().stage == Stage::CellLimit {
                        // A second limit of one kind is tried in place of the first.
                        limits.retain(|(other, _): &(&&dyn Effect, _)| other.id() != effect.id());
                        limits.push((effect, constants));
                    } else {
                        reading = effect.on_reading(constants, point, condition, reading);
                    }
                }
                Term::Structure(structure) => {
                    reading = structure.on_reading(constants[0], point, reading);
                }
            }
        }
        limits.iter().fold(reading, |reading, (effect, k)| effect.on_reading(k, point, condition, reading))
    }
}

/// What the rows of one setting share: the contact as far as it does not move along a series, and the last row's tension and
/// reading in newtons.
struct Setting {
    point: Point,
    state: ContactState,
    tension_n: f64,
    reading_n: f64,
}

/// Changes a contact by these terms, in their order.
fn on_contact(terms: &[(&Term, &[f64])], point: &Point, condition: &Condition, state: &mut ContactState) {
    for (term, constants) in terms {
        match term {
            Term::Named(effect) => effect.on_contact(constants, point, condition, state),
            Term::Structure(structure) => structure.on_contact(constants[0], point, state),
        }
    }
}

/// Logit of a bounded value, widened by a thousandth so that the ends stay finite.
fn to_coordinate(value: f64, bounds: Option<(f64, f64)>) -> f64 {
    bounds.map_or(value, |(least, most)| {
        let share = ((value - least) / (most - least)).clamp(1e-4, 1.0 - 1e-4);
        libm::log(share / (1.0 - share))
    })
}

/// Value and slope of a bounded constant at its coordinate.
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
