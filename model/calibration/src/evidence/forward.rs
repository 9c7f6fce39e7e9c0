//! The friction model of a table's rows, as a forward model of the inference.

use std::sync::Arc;

use pinswitch_inference::{Constant, ForwardModel, SizedEffect};

use super::formula_values::FormulaValues;
use super::priors::EffectPrior;
use crate::effects::{AppliedFormula, ContactState, Stage};
use crate::model::{PLAIN_MU, PRIOR_LOG_HALF_LOAD, PRIOR_LOG_PLAIN};
use crate::table::{Condition, Frame, Point};

/// Prior standard deviations of the baseline's constants, in logarithms.
const LOG_MU_SD: f64 = 1.0;
const LOG_STEEPNESS_SD: f64 = 0.5;
/// Relative step of a channel for its finite difference.
const CHANNEL_STEP: f64 = 1e-4;

/// Channels through which structure acts on a reading, in the order of the forward model's columns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Channel {
    /// A force on the load cell.
    Reading,
    /// A force against the motion.
    Drag,
    /// Every friction exponent.
    Friction,
    /// The friction on the pins.
    Pins,
    /// The friction on silicone or on a `plain` contact.
    Silicone,
    /// The scale of the load cell.
    Gain,
    /// Every friction exponent, with the sign of the direction.
    DirectionFriction,
    /// The half load of every device.
    HalfLoad,
    /// That of one device.
    HalfLoadOf(usize),
}

impl Channel {
    /// Returns the channels in which readings are not linear.
    pub(super) fn curved(devices: usize) -> Vec<Self> {
        let of_all = [Self::Friction, Self::Pins, Self::Silicone, Self::HalfLoad];
        of_all.into_iter().chain((0..devices).map(Self::HalfLoadOf)).collect()
    }

    /// Returns its index among the columns.
    pub(super) fn index(self) -> usize {
        match self {
            Self::Reading => 0,
            Self::Drag => 1,
            Self::Friction => 2,
            Self::Pins => 3,
            Self::Silicone => 4,
            Self::Gain => 5,
            Self::DirectionFriction => 6,
            Self::HalfLoad => 7,
            Self::HalfLoadOf(device) => 8 + device,
        }
    }

    /// Returns its word in reports.
    pub(super) fn as_str(self) -> &'static str {
        match self {
            Self::Reading => "reading",
            Self::Drag => "drag",
            Self::Friction => "friction",
            Self::Pins => "friction on pins",
            Self::Silicone => "friction on silicone",
            Self::Gain => "gain",
            Self::DirectionFriction => "friction by direction",
            Self::HalfLoad | Self::HalfLoadOf(_) => "half load",
        }
    }

    /// Returns whether its unit is the newton.
    pub(super) fn is_force(self) -> bool {
        matches!(self, Self::Reading | Self::Drag)
    }
}

/// Indices of the baseline's constants, which are logarithms.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Baseline {
    pins: Option<usize>,
    silicone: Option<usize>,
    plain: Option<usize>,
    /// Index of the threshold of the first device; its steepness and the other devices follow.
    devices: usize,
    /// Prior means of thresholds and steepnesses of known devices, in logarithms.
    device_means: Vec<f64>,
}

impl Baseline {
    /// Returns the constants of some conditions, whose devices have these prior means.
    pub(super) fn new(conditions: &[Condition], device_means: Vec<f64>) -> Self {
        let mut next = 0;
        let mut index = |is_present: bool| {
            next += usize::from(is_present);
            is_present.then(|| next - 1)
        };
        let silicone =
            conditions.iter().any(|c| c.substrate == Some(pinswitch_friction::Substrate::Silicone));
        let pins = index(conditions.iter().any(Condition::has_pins));
        let silicone = index(silicone);
        let plain = index(conditions.iter().any(|c| c.substrate.is_none()));
        Self { pins, silicone, plain, devices: next, device_means }
    }

    /// Returns the constants with their priors.
    pub(super) fn constants(&self) -> Vec<Constant> {
        use pinswitch_friction::published::{MU_PINS, MU_SILICONE};
        let coefficients = [
            (self.pins, "ln mu_p", MU_PINS, LOG_MU_SD),
            (self.silicone, "ln mu_s", MU_SILICONE, LOG_MU_SD),
            (self.plain, "ln mu", PLAIN_MU, PRIOR_LOG_PLAIN),
        ];
        let present = coefficients.into_iter().filter(|(index, ..)| index.is_some());
        let mut constants: Vec<Constant> = present
            .map(|(_, name, mean, sd)| Constant { name: name.to_owned(), mean: libm::log(mean), sd })
            .collect();
        for (i, mean) in self.device_means.iter().enumerate() {
            let (name, sd) = if i % 2 == 0 {
                (format!("ln F_half[{}]", i / 2), PRIOR_LOG_HALF_LOAD)
            } else {
                (format!("ln s[{}]", i / 2), LOG_STEEPNESS_SD)
            };
            constants.push(Constant { name, mean: *mean, sd });
        }
        constants
    }

    /// Returns the index in a model's coordinates of each constant.
    pub(super) fn coordinates(&self, frame: &Frame) -> Vec<usize> {
        let devices = self.device_means.len();
        let mut at: Vec<(usize, usize)> = Vec::new();
        at.extend(self.pins.map(|i| (i, 0)));
        at.extend(self.silicone.map(|i| (i, 1)));
        at.extend(self.plain.map(|i| (i, 2 + 2 * frame.devices())));
        at.extend((0..devices).map(|i| (self.devices + i, 2 + i)));
        at.sort_unstable();
        at.into_iter().map(|(_, coordinate)| coordinate).collect()
    }

    /// Returns the indices of the threshold and the steepness of a device.
    pub(super) fn device_indices(&self, device: usize) -> [usize; 2] {
        [self.devices + 2 * device, self.devices + 2 * device + 1]
    }

    fn device(&self, constants: &[f64], device: usize) -> [f64; 2] {
        self.device_indices(device).map(|i| libm::exp(constants[i]))
    }
}

/// Factors on quantities of the contact, for sensitivities.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Factors {
    exponent: f64,
    pins: f64,
    silicone: f64,
    half_load: f64,
}

const NO_CHANGE: Factors = Factors { exponent: 1.0, pins: 1.0, silicone: 1.0, half_load: 1.0 };

impl Factors {
    /// Returns one plus each of [`Channel::curved`] at a row with this device.
    fn at(curved: &[Vec<f64>], row: usize, device: Option<usize>) -> Self {
        let factor = |at: usize| 1.0 + curved.get(at).and_then(|c| c.get(row)).copied().unwrap_or(0.0);
        let of_device = device.map_or(1.0, |device| factor(4 + device));
        Self { exponent: factor(0), pins: factor(1), silicone: factor(2), half_load: factor(3) * of_device }
    }

    /// Scales a contact after all effects, as structure in a model file does.
    fn apply(self, state: &mut ContactState) {
        state.mu_pins *= self.pins;
        state.extra_exponent_pins *= self.pins;
        state.mu_silicone *= self.silicone;
        state.exponent_factor *= self.exponent;
        state.half_load_n *= self.half_load;
    }
}

/// The friction model of some rows.
#[derive(Clone)]
pub(super) struct FrictionModel {
    pub(super) points: Vec<Point>,
    /// Mean time and mean share of travel of the fitted session.
    pub(super) mean_time: (f64, f64),
    pub(super) conditions: Arc<[Condition]>,
    pub(super) baseline: Baseline,
    pub(super) priors: Arc<[EffectPrior]>,
    /// Values of formulas at the points.
    pub(super) formula_values: FormulaValues,
    /// Whether a kernel acts on the half loads, whose sensitivity is zero otherwise.
    pub(super) moves_half_loads: bool,
}

/// An effect of a hypothesis.
struct Acting<'a> {
    prior: &'a EffectPrior,
    /// Its constants.
    constants: Vec<f64>,
    /// Its formula on the contact with the value at each point, if these depend on nothing but the point.
    known: Option<(&'a AppliedFormula, Arc<[f64]>)>,
}

impl FrictionModel {
    /// Returns the readings in newtons.
    fn evaluate(
        &self,
        constants: &[f64],
        effects: &[SizedEffect],
        factors: Factors,
        curved: &[Vec<f64>],
    ) -> Vec<f64> {
        let acting = self.acting(&self.points, &self.formula_values, effects);
        self.evaluate_at(&self.points, &acting, &self.contacts(constants), factors, curved, |_| None)
    }

    /// Returns the readings in newtons of points, except of rows where they are `known`.
    fn evaluate_at(
        &self,
        points: &[Point],
        acting: &[Acting<'_>],
        states: &[ContactState],
        factors: Factors,
        curved: &[Vec<f64>],
        known: impl Fn(usize) -> Option<f64>,
    ) -> Vec<f64> {
        let moves = acting.iter().any(|acting| acting.prior.effect.moves_along_a_series());
        let mut last: Option<(&Point, Factors, f64)> = None;
        points
            .iter()
            .enumerate()
            .map(|(row, point)| {
                if let Some(reading) = known(row) {
                    return reading;
                }
                let condition = &self.conditions[point.condition];
                let change = Factors::at(curved, row, condition.device);
                // Repetitions at one setting have one expectation, unless an effect varies within a series.
                let is_known =
                    |known: &Point, at: Factors| !moves && at == change && known.has_setting_of(point);
                if let Some((.., reading)) = last.filter(|(known, at, _)| is_known(known, *at)) {
                    return reading;
                }
                let mut state = ContactState { load_n: point.load_n, ..states[point.condition] };
                for Acting { prior, constants, known } in acting {
                    match known {
                        Some((formula, values)) => formula.apply_to_contact(values[row], &mut state),
                        None => prior.effect.on_contact(constants, point, condition, &mut state),
                    }
                }
                factors.apply(&mut state);
                change.apply(&mut state);
                let mut reading = state.tension_n(condition, point);
                for Acting { prior, constants, .. } in acting {
                    reading = prior.effect.on_tension(constants, point, condition, reading);
                }
                // The limit of the load cell is the last stage.
                for Acting { prior, constants, .. } in acting {
                    reading = prior.effect.on_reading(constants, point, condition, reading);
                }
                last = Some((point, change, reading));
                reading
            })
            .collect()
    }

    /// Returns the effects in the order in which they act.
    fn acting(
        &self,
        points: &[Point],
        formula_values: &FormulaValues,
        effects: &[SizedEffect],
    ) -> Vec<Acting<'_>> {
        let mut sorted: Vec<&SizedEffect> = effects.iter().collect();
        sorted.sort_by_key(|sized| self.priors[sized.effect].effect.description().stage);
        let changes_load =
            |sized: &&SizedEffect| self.priors[sized.effect].effect.description().stage == Stage::Load;
        // Formulas read the load after effects on it.
        let has_given_loads = !sorted.iter().any(changes_load);
        sorted
            .into_iter()
            .map(|sized| {
                let prior = &self.priors[sized.effect];
                let constants = prior.values(sized);
                let formula = prior.effect.formula().filter(|f| has_given_loads && f.acts_on_contact());
                let known = formula.map(|formula| {
                    let value = |point: &Point| {
                        formula.value_on_contact(
                            &constants,
                            point,
                            &self.conditions[point.condition],
                            point.load_n,
                        )
                    };
                    let compute = || points.iter().map(value).collect();
                    (formula, formula_values.of(sized.effect, &constants, compute))
                });
                Acting { prior, constants, known }
            })
            .collect()
    }

    /// Returns the contact of each condition before effects, at no load.
    fn contacts(&self, constants: &[f64]) -> Vec<ContactState> {
        let coefficient = |index: Option<usize>| index.map_or(0.0, |i| libm::exp(constants[i]));
        let mu = [self.baseline.pins, self.baseline.silicone, self.baseline.plain].map(coefficient);
        self.conditions.iter().map(|c| self.contact(c, mu, constants)).collect()
    }

    /// Returns the contact of a condition before effects, at no load.
    fn contact(&self, condition: &Condition, mu: [f64; 3], q: &[f64]) -> ContactState {
        let [mu_pins, mu_silicone, mu_plain] = mu;
        let high = if condition.substrate.is_none() { mu_plain } else { mu_silicone };
        let device = condition.device.map(|device| self.baseline.device(q, device));
        let [half_load_n, steepness] = device.unwrap_or([1.0, 1.0]);
        ContactState {
            load_n: 0.0,
            wrap_rad: condition.wrap_rad,
            mu_pins,
            mu_silicone: high,
            extra_exponent_pins: 0.0,
            exponent_factor: 1.0,
            half_load_n,
            steepness,
            local_tension: false,
            adhesion_n: 0.0,
            drag_n: 0.0,
        }
    }

    fn devices(&self) -> usize {
        self.baseline.device_means.len() / 2
    }

    /// Returns the rows at the mean time of the fitted session.
    pub(super) fn points_at_mean_time(&self) -> Vec<Point> {
        let (time, travel) = self.mean_time;
        self.points.iter().map(|point| Point { time, travel, ..*point }).collect()
    }
}

impl ForwardModel for FrictionModel {
    fn readings(&self, constants: &[f64], effects: &[SizedEffect]) -> Vec<f64> {
        self.evaluate(constants, effects, NO_CHANGE, &[])
    }

    fn channels(&self, constants: &[f64], effects: &[SizedEffect]) -> Vec<Vec<f64>> {
        self.channels_at(constants, effects, &[], &self.readings(constants, effects))
    }

    fn readings_at(&self, constants: &[f64], effects: &[SizedEffect], curved: &[Vec<f64>]) -> Vec<f64> {
        self.evaluate(constants, effects, NO_CHANGE, curved)
    }

    fn readings_where_moved(
        &self,
        constants: [&[f64]; 2],
        effects: &[SizedEffect],
        curved: &[Vec<f64>],
        readings: &[f64],
    ) -> Vec<f64> {
        // Most constants are of one device, and effects read none but through its contact.
        let [before, after] = constants.map(|constants| self.contacts(constants));
        let is_same: Vec<bool> = before.iter().zip(&after).map(|(before, after)| before == after).collect();
        let known = |row: usize| is_same[self.points[row].condition].then(|| readings[row]);
        let acting = self.acting(&self.points, &self.formula_values, effects);
        self.evaluate_at(&self.points, &acting, &after, NO_CHANGE, curved, known)
    }

    fn channels_at(
        &self,
        constants: &[f64],
        effects: &[SizedEffect],
        curved: &[Vec<f64>],
        readings: &[f64],
    ) -> Vec<Vec<f64>> {
        let slope = |factors: Factors| -> Vec<f64> {
            let after = self.evaluate(constants, effects, factors, curved);
            after.iter().zip(readings).map(|(a, b)| (a - b) / CHANNEL_STEP).collect()
        };
        let up = 1.0 + CHANNEL_STEP;
        let friction = slope(Factors { exponent: up, ..NO_CHANGE });
        let pins = slope(Factors { pins: up, ..NO_CHANGE });
        let silicone = slope(Factors { silicone: up, ..NO_CHANGE });
        let sign: Vec<f64> = self.points.iter().map(|p| p.sign).collect();
        let by_direction = friction.iter().zip(&sign).map(|(f, d)| f * d).collect();
        let half_load = if self.moves_half_loads {
            slope(Factors { half_load: up, ..NO_CHANGE })
        } else {
            vec![0.0; sign.len()]
        };
        let of_device = |device: usize| -> Vec<f64> {
            let is_of = |point: &Point| self.conditions[point.condition].device == Some(device);
            self.points.iter().zip(&half_load).map(|(p, x)| if is_of(p) { *x } else { 0.0 }).collect()
        };
        let of_devices: Vec<Vec<f64>> = (0..self.devices()).map(of_device).collect();
        let ones = vec![1.0; sign.len()];
        let mut channels =
            vec![ones, sign, friction, pins, silicone, readings.to_vec(), by_direction, half_load];
        channels.extend(of_devices);
        channels
    }

    fn of_rows(&self, rows: &[usize]) -> Box<dyn ForwardModel> {
        Box::new(Self { points: rows.iter().map(|row| self.points[*row]).collect(), ..self.clone() })
    }

    fn session_mean(&self, constants: &[f64], effects: &[SizedEffect]) -> Vec<f64> {
        let points = self.points_at_mean_time();
        let acting = self.acting(&points, &FormulaValues::default(), effects);
        self.evaluate_at(&points, &acting, &self.contacts(constants), NO_CHANGE, &[], |_| None)
    }
}

/// Returns whether a stage changes the friction, rather than the reading or the motion.
pub(super) fn is_of_friction(stage: Stage) -> bool {
    matches!(stage, Stage::AddedFriction | Stage::ScaledFriction | Stage::Switch)
}
