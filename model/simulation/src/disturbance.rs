//! Disturbances outside the vocabulary of effects: steps, waves, worn spots, resonances, a Stribeck
//! minimum, a defective layout, material memory, a replaced tendon, and two operators.

use std::f64::consts::{PI, TAU};

use pinswitch_calibration::effects::Covariate;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::row_covariates::RowCovariates;

/// Quantity that a disturbance acts on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum DisturbanceTarget {
    /// Friction coefficients of pins and silicone, by a relative change.
    #[default]
    Friction,
    /// Friction coefficient of the pins, by a relative change.
    Pins,
    /// Friction coefficient of the silicone, by a relative change.
    Silicone,
    /// Reading, by newtons.
    Reading,
    /// Tension, by newtons against the motion.
    Drag,
}

/// Disturbance outside the vocabulary of effects.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Disturbance {
    /// Shape over time, stroke or another covariate.
    pub kind: DisturbanceKind,
    /// Quantity that it acts on.
    #[serde(default)]
    pub target: DisturbanceTarget,
    /// Size: a share of friction, or newtons.
    pub size: f64,
}

/// Shape of a disturbance. Shares of the session and of the stroke are from 0 to 1.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum DisturbanceKind {
    /// Step, or ramp, in the session.
    Step {
        /// Begin, as a share of the session.
        at: f64,
        /// Duration of the ramp, as a share of the session.
        #[serde(default)]
        over: f64,
    },
    /// Another level in a part of the session.
    Window {
        /// Begin, as a share of the session.
        from: f64,
        /// End, as a share of the session.
        to: f64,
    },
    /// Sine over the session.
    TimeWave {
        /// Number of cycles.
        cycles: f64,
        /// Phase in radians.
        phase: f64,
    },
    /// Sine, or square wave, along the stroke.
    StrokeWave {
        /// Number of cycles.
        cycles: f64,
        /// Phase in radians.
        phase: f64,
        /// Square wave instead of a sine.
        #[serde(default)]
        square: bool,
    },
    /// Worn spot: half a cosine, or a box, along the stroke.
    Spot {
        /// Centre, as a share of the stroke.
        at: f64,
        /// Full width, as a share of the stroke.
        width: f64,
        /// Box instead of half a cosine.
        #[serde(default)]
        flat: bool,
    },
    /// Resonance: Lorentz curve over the speed.
    Resonance {
        /// Speed of the maximum, in percent of full speed.
        speed_pct: f64,
        /// Half width at half maximum, in percent of full speed.
        width_pct: f64,
    },
    /// Stribeck minimum: friction is lower by `size` at a speed, with a Gaussian shape over the
    /// logarithm of the speed.
    Stribeck {
        /// Speed of the minimum, in percent of full speed.
        speed_pct: f64,
        /// Logarithm of the ratio of speeds at which a share of 1/e is left.
        width: f64,
    },
    /// One layout.
    Layout {
        /// Occupied grooves of the layout.
        pins: Vec<usize>,
    },
    /// Memory of the silicone for the load of the previous series: proportional to the decrease of
    /// the load from it, as a share of the highest load of the session, with exponential decay. The
    /// load before the session is zero.
    Memory {
        /// Repetitions, counted through both directions, after which a share of 1/e is left.
        repetitions: f64,
    },
    /// Another tendon in the rest of the session. `size` is the relative change of friction on the
    /// pins.
    Swap {
        /// Time of the replacement, as a share of the session.
        at: f64,
        /// Relative change of friction on the silicone.
        silicone: f64,
    },
    /// Friction alternates from repetition to repetition, higher by `size` at even ones and lower at
    /// odd ones.
    Alternation,
    /// Two operators: the zero of the load cell differs by `size` for the second one.
    Operators {
        /// Schedule of the operators.
        turns: OperatorSchedule,
    },
}

/// Schedule of two operators.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum OperatorSchedule {
    /// Random for each series.
    Series,
    /// One operator in each half of the session; which one begins is random.
    Half,
}

impl DisturbanceKind {
    /// Returns the numbers of the disturbance with their keys below `kind`.
    pub(super) fn numbers(&self) -> Vec<(&'static str, f64)> {
        match *self {
            Self::Step { at, over } => vec![("step.at", at), ("step.over", over)],
            Self::Window { from, to } => vec![("window.from", from), ("window.to", to)],
            Self::TimeWave { cycles, phase } => {
                vec![("time_wave.cycles", cycles), ("time_wave.phase", phase)]
            }
            Self::StrokeWave { cycles, phase, .. } => {
                vec![("stroke_wave.cycles", cycles), ("stroke_wave.phase", phase)]
            }
            Self::Spot { at, width, .. } => vec![("spot.at", at), ("spot.width", width)],
            Self::Resonance { speed_pct, width_pct } => {
                vec![("resonance.speed_pct", speed_pct), ("resonance.width_pct", width_pct)]
            }
            Self::Stribeck { speed_pct, width } => {
                vec![("stribeck.speed_pct", speed_pct), ("stribeck.width", width)]
            }
            Self::Layout { .. }
            | Self::Swap { .. }
            | Self::Alternation
            | Self::Operators { .. }
            | Self::Memory { .. } => vec![],
        }
    }

    /// Returns the numbers that the formula divides by, with their keys below `kind`.
    pub(super) fn divisors(&self) -> Vec<(&'static str, f64)> {
        match *self {
            Self::Spot { width, .. } => vec![("spot.width", width)],
            Self::Resonance { width_pct, .. } => vec![("resonance.width_pct", width_pct)],
            Self::Stribeck { .. } => self.numbers(),
            _ => vec![],
        }
    }
}

impl Disturbance {
    /// Returns the covariates to which a calibration can correctly assign the disturbance.
    pub fn covariates(&self) -> &'static [Covariate] {
        match self.kind {
            DisturbanceKind::Step { .. }
            | DisturbanceKind::Window { .. }
            | DisturbanceKind::TimeWave { .. }
            | DisturbanceKind::Swap { .. } => &[Covariate::Time],
            DisturbanceKind::StrokeWave { .. } | DisturbanceKind::Spot { .. } => &[Covariate::Position],
            DisturbanceKind::Resonance { .. } | DisturbanceKind::Stribeck { .. } => &[Covariate::Speed],
            DisturbanceKind::Layout { .. } => &[Covariate::Condition],
            DisturbanceKind::Alternation => &[Covariate::Repetition],
            DisturbanceKind::Memory { .. } => &[Covariate::Load, Covariate::Repetition],
            // A random group of series correlates weakly with every covariate.
            DisturbanceKind::Operators { .. } => &Covariate::ALL,
        }
    }

    /// Returns the value of the shape in a row, with a size of one.
    fn shape(&self, at: &RowCovariates, pins: &[usize]) -> f64 {
        let flag = |b: bool| f64::from(u8::from(b));
        let RowCovariates { time_share, stroke_share, speed_pct, .. } = *at;
        match &self.kind {
            DisturbanceKind::Step { at: from, over } => {
                ((time_share - from) / over.max(1e-9)).clamp(0.0, 1.0)
            }
            DisturbanceKind::Window { from, to } => flag(time_share >= *from && time_share < *to),
            DisturbanceKind::TimeWave { cycles, phase } => (TAU * cycles * time_share + phase).sin(),
            DisturbanceKind::StrokeWave { cycles, phase, square } => {
                let wave = (TAU * cycles * stroke_share + phase).sin();
                if *square { wave.signum() * PI / 4.0 } else { wave }
            }
            DisturbanceKind::Spot { at: centre, width, flat } => {
                let x = (stroke_share - centre) / width;
                if x.abs() > 0.5 {
                    0.0
                } else if *flat {
                    1.0
                } else {
                    (PI * x).cos()
                }
            }
            DisturbanceKind::Resonance { speed_pct: v, width_pct } => {
                1.0 / (1.0 + ((speed_pct - v) / width_pct).powi(2))
            }
            DisturbanceKind::Stribeck { speed_pct: lowest, width } => {
                -(-((speed_pct / lowest).ln() / width).powi(2)).exp()
            }
            DisturbanceKind::Layout { pins: defective } => flag(pins == defective.as_slice()),
            DisturbanceKind::Memory { repetitions } => {
                at.step_down * (-(at.series_repetition - 1.0) / repetitions).exp()
            }
            DisturbanceKind::Swap { at: from, .. } => flag(time_share >= *from),
            DisturbanceKind::Alternation => 2.0 * flag(at.repetition % 2.0 == 0.0) - 1.0,
            DisturbanceKind::Operators { .. } => flag(at.operator == 2),
        }
    }

    /// Returns the change of a reading in newtons.
    pub(super) fn on_reading_n(&self, at: &RowCovariates, pins: &[usize]) -> f64 {
        let change_n = || self.size * self.shape(at, pins);
        match self.target {
            DisturbanceTarget::Reading => change_n(),
            DisturbanceTarget::Drag => at.sign * change_n(),
            DisturbanceTarget::Friction | DisturbanceTarget::Pins | DisturbanceTarget::Silicone => 0.0,
        }
    }

    /// Returns the factors on the friction of pins and silicone.
    pub(super) fn on_friction(&self, at: &RowCovariates, pins: &[usize]) -> (f64, f64) {
        let shape = self.shape(at, pins);
        let factor = 1.0 + self.size * shape;
        match (self.target, &self.kind) {
            (DisturbanceTarget::Friction, DisturbanceKind::Swap { silicone, .. }) => {
                (factor, 1.0 + silicone * shape)
            }
            // Pins have no memory.
            (DisturbanceTarget::Friction, DisturbanceKind::Memory { .. })
            | (DisturbanceTarget::Silicone, _) => (1.0, factor),
            (DisturbanceTarget::Friction, _) => (factor, factor),
            (DisturbanceTarget::Pins, _) => (factor, 1.0),
            (DisturbanceTarget::Reading | DisturbanceTarget::Drag, _) => (1.0, 1.0),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shapes_have_their_width() {
        let on = |kind: DisturbanceKind, time_share, stroke_share, speed_pct| {
            let at = RowCovariates { time_share, stroke_share, speed_pct, ..RowCovariates::default() };
            Disturbance { kind, target: DisturbanceTarget::Friction, size: 0.5 }.on_friction(&at, &[]).0
        };
        let spot = || DisturbanceKind::Spot { at: 0.5, width: 0.1, flat: false };
        assert_eq!(on(spot(), 0.0, 0.5, 50.0), 1.5);
        assert_eq!(on(spot(), 0.0, 0.56, 50.0), 1.0);
        let step = || DisturbanceKind::Step { at: 0.4, over: 0.0 };
        assert_eq!((on(step(), 0.39, 0.0, 50.0), on(step(), 0.41, 0.0, 50.0)), (1.0, 1.5));
        let resonance = DisturbanceKind::Resonance { speed_pct: 50.0, width_pct: 1.0 };
        assert_eq!(on(resonance, 0.0, 0.0, 51.0), 1.25);
        let dip = || DisturbanceKind::Stribeck { speed_pct: 50.0, width: 0.5 };
        assert_eq!(on(dip(), 0.0, 0.0, 50.0), 0.5);
        let flank = on(dip(), 0.0, 0.0, 50.0 * 0.5f64.exp());
        assert!((flank - 1.0 + 0.5 / 1f64.exp()).abs() < 1e-12, "{flank}");
    }

    #[test]
    fn only_silicone_has_memory() {
        let memory = Disturbance {
            kind: DisturbanceKind::Memory { repetitions: 10.0 },
            target: DisturbanceTarget::Friction,
            size: 0.5,
        };
        let on = |step_down, series_repetition| {
            memory.on_friction(
                &RowCovariates { step_down, series_repetition, ..RowCovariates::default() },
                &[3, 5],
            )
        };
        assert_eq!(on(0.8, 1.0), (1.0, 1.4));
        assert_eq!(on(-0.8, 1.0), (1.0, 0.6));
        let later = on(0.8, 11.0).1;
        assert!((later - 1.0 - 0.4 / 1f64.exp()).abs() < 1e-12, "{later}");
        assert_eq!(memory.covariates(), [Covariate::Load, Covariate::Repetition]);
    }

    #[test]
    fn swap_changes_pins_and_silicone() {
        let swap = Disturbance {
            kind: DisturbanceKind::Swap { at: 0.5, silicone: -0.1 },
            target: DisturbanceTarget::Friction,
            size: 0.2,
        };
        let on =
            |time_share| swap.on_friction(&RowCovariates { time_share, ..RowCovariates::default() }, &[]);
        assert_eq!((on(0.4), on(0.6)), ((1.0, 1.0), (1.2, 0.9)));
    }

    #[test]
    fn second_operator_has_an_offset() {
        let two = Disturbance {
            kind: DisturbanceKind::Operators { turns: OperatorSchedule::Series },
            target: DisturbanceTarget::Reading,
            size: 0.5,
        };
        let on = |operator| two.on_reading_n(&RowCovariates { operator, ..RowCovariates::default() }, &[]);
        assert_eq!((on(1), on(2)), (0.0, 0.5));
    }
}
