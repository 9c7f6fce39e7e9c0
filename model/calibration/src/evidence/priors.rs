//! Priors of the effects: typical sizes, prior odds, discrete shapes, and where a form may be wrong.

use std::collections::BTreeSet;

use pinswitch_inference::{Effect as EffectSpace, MOST_SHAPE_CONSTANTS, SizedEffect};

use crate::effects::{Covariate, Effect, SharedEffect, Stage, Vocabulary, effect_named};
use crate::table::{Frame, Unknown};

/// Prior probability of the effects that most rigs have.
const USUAL_PROBABILITY: f64 = 0.30;
/// Prior probability of any other effect.
const OTHER_PROBABILITY: f64 = 0.05;
/// Prior probability of a user-defined effect: whoever writes one expects it about as much as any
/// structure without a name.
const USER_PROBABILITY: f64 = 0.2;
/// Prior probability of the shape at the start values of a user-defined effect, before its variants.
const START_PROBABILITY: f64 = 0.5;
/// Effects that most rigs have.
const USUAL: [&str; 3] = ["guide_drag", "load_cell_offset", "load_cell_gain"];
/// Share of the typical size at which an effect is scored first.
const START_SHARE: f64 = 0.3;
/// Distance in newtons of the limit of the load cell above the highest reading at size zero.
const LIMIT_MARGIN_N: f64 = 0.1;

/// Prior standard deviation of a constant of a shape about its start, as a share of its range.
const SHIFT_SHARE: f64 = 0.25;
/// The same in logarithms, for a constant whose bounds have a larger ratio than this.
const LOG_SHIFT_SHARE: f64 = 1.0 / 6.0;
const LOG_RANGE: f64 = 5.0;

/// Typical distance in newtons of the limit of a load cell below the highest reading, and its starts.
const LIMIT_SIZE_N: f64 = 4.0;
const LIMIT_STARTS_N: [f64; 3] = [1.0, 3.0, 8.0];
const LIMIT: &str = "load_cell_saturation";

/// An effect with its prior.
#[derive(Clone, Debug)]
pub(super) struct EffectPrior {
    pub(super) effect: SharedEffect,
    /// Typical size; `None` for an effect without a size.
    typical_size: Option<f64>,
    /// Discrete values of the constants after the size.
    shapes: Vec<Vec<f64>>,
    /// Reading in newtons from which the limit of the load cell is measured downwards.
    pub(super) limit_from_n: Option<f64>,
    /// Whether its formula was derived from structure, or is tried in place of it.
    is_derived: bool,
}

impl EffectPrior {
    /// Returns the priors of a vocabulary for a table, whose readings are at most `highest_n`.
    /// Forces are `force_unit` times larger than on the paper's rig. Effects that are `forms` of a
    /// library have one shape, since the library has an effect for each. An effect over a covariate
    /// that is unknown has none, and on a rig of `plain` contacts one of the switch.
    pub(super) fn of_vocabulary(
        vocabulary: &Vocabulary,
        frame: &Frame,
        highest_n: f64,
        force_unit: f64,
        forms: &BTreeSet<&str>,
        unknown: Unknown,
    ) -> Vec<Self> {
        let is_plain = frame.is_plain();
        let is_candidate = |effect: &dyn Effect| {
            let description = effect.description();
            let is_unknown = description.covariate.column().is_some_and(|q| unknown.contains(q));
            !is_unknown && (description.on_plain || !is_plain)
        };
        vocabulary
            .effects()
            .filter(|effect| is_candidate(&**effect))
            .map(|effect| {
                let is_derived = forms.contains(effect.id()) || is_derived(vocabulary, effect.id());
                if effect.id() == LIMIT {
                    let typical_size = Some(LIMIT_SIZE_N * force_unit);
                    let limit_from_n = Some(highest_n + LIMIT_MARGIN_N);
                    return Self { effect, typical_size, shapes: vec![vec![]; 3], limit_from_n, is_derived };
                }
                if effect.parameters().is_empty() {
                    let shapes = vec![vec![]];
                    return Self { effect, typical_size: None, shapes, limit_from_n: None, is_derived };
                }
                let (size, mut shapes) = size_and_shapes(&*effect, frame);
                let size = size * if is_force(&*effect) { force_unit } else { 1.0 };
                if forms.contains(effect.id()) {
                    shapes.truncate(1);
                }
                Self { effect, typical_size: Some(size), shapes, limit_from_n: None, is_derived }
            })
            .collect()
    }

    /// Returns the constants of the effect for a shape and a size.
    pub(super) fn values(&self, sized: &SizedEffect) -> Vec<f64> {
        match (self.typical_size, self.limit_from_n) {
            (None, _) => Vec::new(),
            (Some(_), Some(from)) => vec![from - sized.size],
            (Some(_), None) => {
                let bounds = self.effect.parameters().iter().skip(1).map(|parameter| parameter.bounds);
                // Constants after those that a fit shifts keep their start values.
                let shifts = sized.shifts.into_iter().chain(std::iter::repeat(0.0));
                let shape = self.shapes[sized.shape].iter().zip(bounds).zip(shifts);
                let shape = shape.map(|((start, bounds), shift)| shifted(*start, bounds, shift));
                std::iter::once(sized.size).chain(shape).collect()
            }
        }
    }

    /// Returns the derivative by its shift of a constant of a shape with this value; at a bound, that towards the other one.
    pub(super) fn shift_slope(&self, constant: usize, value: f64) -> f64 {
        let Some((low, high)) = self.effect.parameters().get(constant).and_then(|p| p.bounds) else {
            return 0.0;
        };
        log_step(low, high).map_or(SHIFT_SHARE * (high - low), |step| value * step)
    }

    /// Returns the constants of a shape.
    pub(super) fn shape(&self, shape: usize) -> Vec<f64> {
        self.shapes.get(shape).cloned().unwrap_or_default()
    }

    /// Returns the number of constants of a shape that a fit shifts.
    fn shape_constants(&self) -> usize {
        self.shapes.first().map_or(0, Vec::len).min(MOST_SHAPE_CONSTANTS)
    }

    /// Returns the effect for the space of hypotheses.
    pub(super) fn space(&self, force_unit: f64) -> EffectSpace {
        let starts = match (self.typical_size, self.limit_from_n) {
            (None, _) => vec![1.0],
            (Some(_), Some(_)) => LIMIT_STARTS_N.map(|start| start * force_unit).to_vec(),
            (Some(size), None) => vec![START_SHARE * size; self.shapes.len()],
        };
        EffectSpace {
            name: self.effect.id().to_owned(),
            typical_size: self.typical_size,
            is_one_sided: self.effect.description().one_sided || self.limit_from_n.is_some(),
            probability: match (self.is_usual(), self.is_built_in()) {
                (true, _) => USUAL_PROBABILITY,
                (false, true) => OTHER_PROBABILITY,
                (false, false) => USER_PROBABILITY,
            },
            shape_probabilities: self.shape_probabilities(starts.len()),
            shape_constants: self.shape_constants(),
            starts,
        }
    }

    fn is_built_in(&self) -> bool {
        effect_named(self.effect.id()).is_some()
    }

    /// Returns the prior probabilities of the shapes; empty if they are equal.
    fn shape_probabilities(&self, count: usize) -> Vec<f64> {
        if self.is_built_in() || count < 2 {
            return Vec::new();
        }
        let other = (1.0 - START_PROBABILITY) / (count - 1) as f64;
        (0..count).map(|shape| if shape == 0 { START_PROBABILITY } else { other }).collect()
    }

    /// Returns whether most rigs have it.
    pub(super) fn is_usual(&self) -> bool {
        USUAL.contains(&self.effect.id())
    }

    /// Returns the covariates along which its form may be wrong.
    pub(super) fn discrepant_covariates(&self) -> Vec<Covariate> {
        let description = self.effect.description();
        if !description.bends || self.typical_size.is_none() {
            return Vec::new();
        }
        match self.effect.id() {
            // What happens at contacts may follow their force, which is higher in the concentric direction. Ploughing increases
            // with its root only.
            "coating_stiffening" => vec![Covariate::Load, Covariate::Direction, Covariate::Condition],
            "coating_ploughing" => vec![Covariate::Load, Covariate::Condition],
            "polygon_bending" => vec![Covariate::Condition],
            "thermal_drift" => vec![Covariate::Time],
            "adhesion" | "switching_hysteresis" | "load_cell_nonlinearity" | LIMIT => Vec::new(),
            _ if description.covariate == Covariate::Direction => vec![Covariate::Load],
            _ => {
                let mut along = vec![Covariate::Load, description.covariate];
                along.dedup();
                // A formula that stands for structure is alike in both directions, as that is.
                along.extend((!self.is_derived).then_some(Covariate::Direction));
                along
            }
        }
    }
}

/// Returns whether an effect is a user-defined one that was derived from readings.
fn is_derived(vocabulary: &Vocabulary, id: &str) -> bool {
    let mut own = vocabulary.own().map(|own| own.definition());
    own.any(|definition| {
        definition.id == id && definition.drawn_from.as_ref().is_some_and(|from| !from.is_empty())
    })
}

/// Returns a constant of a shape that is shifted from its start by standard deviations of its prior:
/// shares of its range, of the logarithm for a constant whose range covers much more than its lower
/// end.
fn shifted(start: f64, bounds: Option<(f64, f64)>, shift: f64) -> f64 {
    let Some((low, high)) = bounds else { return start };
    let value = match log_step(low, high) {
        Some(step) => start * libm::exp(shift * step),
        None => start + shift * SHIFT_SHARE * (high - low),
    };
    value.clamp(low, high)
}

/// Returns the standard deviation of the logarithm of a constant within these bounds; `None` if that of itself is given.
fn log_step(low: f64, high: f64) -> Option<f64> {
    (low > 0.0 && high > LOG_RANGE * low).then(|| LOG_SHIFT_SHARE * libm::log(high / low))
}

/// Returns whether the typical size is a force of the paper's rig, which is larger on a rig for heavier loads. That of a
/// user-defined effect is for its rig.
fn is_force(effect: &dyn Effect) -> bool {
    let stage = effect.description().stage;
    let is_newtons = effect.parameters().first().is_some_and(|size| size.unit == "N");
    effect_named(effect.id()).is_some() && is_newtons && stage != Stage::Switch
}

/// Returns the typical size of an effect, and its discrete shapes.
fn size_and_shapes(effect: &dyn Effect, frame: &Frame) -> (f64, Vec<Vec<f64>>) {
    let typical = effect.typical(frame);
    let size = typical.iter().filter_map(|k| k.first()).map(|size| size.abs()).fold(0.0, f64::max);
    let mut shapes: Vec<Vec<f64>> = typical.iter().map(|k| k.get(1..).unwrap_or_default().to_vec()).collect();
    shapes.dedup();
    (if size > 0.0 { size } else { 1.0 }, shapes)
}
