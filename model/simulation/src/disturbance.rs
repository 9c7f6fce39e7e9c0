//! What nobody has named: steps, waves, worn spots, resonances, Stribeck's dip, one defective layout, a material that
//! remembers, another tendon, two operators.

use std::f64::consts::{PI, TAU};

use pinswitch_calibration::effects::Covariate;
use serde::{Deserialize, Serialize};

use crate::row_covariates::RowCovariates;

/// What a disturbance acts on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum DisturbanceTarget {
    /// A share of the friction coefficients of pins and silicone.
    #[default]
    Friction,
    /// A share of the friction coefficient of the pins.
    Pins,
    /// A share of the friction coefficient of the silicone.
    Silicone,
    /// Newtons on the reading.
    Reading,
    /// Newtons against the motion.
    Drag,
}

/// A disturbance outside the vocabulary.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Disturbance {
    /// Its course.
    pub kind: DisturbanceKind,
    /// What it acts on.
    #[serde(default)]
    pub target: DisturbanceTarget,
    /// Its size: a share of friction, or newtons.
    pub size: f64,
}

/// DisturbanceKind of a disturbance; shares of time and stroke are 0..1.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum DisturbanceKind {
    /// From a share of the session on; `over` is the share it takes to rise.
    Step {
        /// Where it begins.
        at: f64,
        /// How long it takes.
        #[serde(default)]
        over: f64,
    },
    /// Only between two shares of the session.
    Window {
        /// Where it begins.
        from: f64,
        /// Where it ends.
        to: f64,
    },
    /// A sine over the session.
    TimeWave {
        /// Cycles.
        cycles: f64,
        /// Phase in radians.
        phase: f64,
    },
    /// A sine, or a square wave, along the stroke.
    StrokeWave {
        /// Cycles.
        cycles: f64,
        /// Phase in radians.
        phase: f64,
        /// Square instead of sine.
        #[serde(default)]
        square: bool,
    },
    /// A worn spot: half a sine over `width` of the stroke, or a box.
    Spot {
        /// Centre.
        at: f64,
        /// Whole width.
        width: f64,
        /// A box instead of half a sine.
        #[serde(default)]
        flat: bool,
    },
    /// A resonance: Lorentz curve over the speed.
    Resonance {
        /// Speed in percent.
        speed_pct: f64,
        /// Half width at half height, in percent of full speed.
        width_pct: f64,
    },
    /// Stribeck's dip: friction falls to its lowest at a speed, where `size` of it is missing, and rises beyond; a bell
    /// over the logarithm of the speed.
    Stribeck {
        /// Speed of least friction in percent.
        speed_pct: f64,
        /// Ratio of speeds, as its logarithm, at which a share of 1/e is left of the dip.
        width: f64,
    },
    /// One layout, wherever its pins stand.
    Layout {
        /// Its occupied grooves.
        pins: Vec<usize>,
    },
    /// The material remembers the load of the series before: the step down from it, as a share of the highest load of
    /// the session, forgotten exponentially. The session begins after no load.
    Memory {
        /// Repetitions through both directions after which a share of 1/e is left.
        repetitions: f64,
    },
    /// Another tendon from a share of the session on. `size` is the share by which the friction of the pins changes.
    Swap {
        /// When.
        at: f64,
        /// Share by which the friction of the silicone changes.
        silicone: f64,
    },
    /// Two operators; the second zeroes the cell off by `size`.
    Operators {
        /// How they take turns.
        turns: OperatorSchedule,
    },
}

/// How two operators take turns.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum OperatorSchedule {
    /// Each series has one of them at random.
    Series,
    /// One has the first half of the session's series, the other the second; who begins is random.
    Half,
}

impl DisturbanceKind {
    /// Numbers of the disturbance with their keys below `kind`.
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
            Self::Layout { .. } | Self::Swap { .. } | Self::Operators { .. } | Self::Memory { .. } => vec![],
        }
    }

    /// Numbers that the formula divides by, with their keys below `kind`.
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
    /// Where a calibration may find it: any of these is right.
    pub fn covariates(&self) -> &'static [Covariate] {
        match self.kind {
            DisturbanceKind::Step { .. }
            | DisturbanceKind::Window { .. }
            | DisturbanceKind::TimeWave { .. }
            | DisturbanceKind::Swap { .. } => &[Covariate::Time],
            DisturbanceKind::StrokeWave { .. } | DisturbanceKind::Spot { .. } => &[Covariate::Position],
            DisturbanceKind::Resonance { .. } | DisturbanceKind::Stribeck { .. } => &[Covariate::Speed],
            DisturbanceKind::Layout { .. } => &[Covariate::Condition],
            DisturbanceKind::Memory { .. } => &[Covariate::Load, Covariate::Repetition],
            // Groups of series at random go along with everything a little, and with nothing clearly.
            DisturbanceKind::Operators { .. } => &Covariate::ALL,
        }
    }

    fn course(&self, at: &RowCovariates, pins: &[usize]) -> f64 {
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
            DisturbanceKind::Operators { .. } => flag(at.operator == 2),
        }
    }

    /// Newtons on a reading.
    pub(super) fn on_reading_n(&self, at: &RowCovariates, pins: &[usize]) -> f64 {
        let course = || self.size * self.course(at, pins);
        match self.target {
            DisturbanceTarget::Reading => course(),
            DisturbanceTarget::Drag => at.sign * course(),
            DisturbanceTarget::Friction | DisturbanceTarget::Pins | DisturbanceTarget::Silicone => 0.0,
        }
    }

    /// Factors on the friction of pins and silicone.
    pub(super) fn on_friction(&self, at: &RowCovariates, pins: &[usize]) -> (f64, f64) {
        let course = self.course(at, pins);
        let factor = 1.0 + self.size * course;
        match (self.target, &self.kind) {
            (DisturbanceTarget::Friction, DisturbanceKind::Swap { silicone, .. }) => {
                (factor, 1.0 + silicone * course)
            }
            // Pins do not remember.
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
    fn a_spot_and_a_resonance_end_where_they_should() {
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
        let beside = on(dip(), 0.0, 0.0, 50.0 * 0.5f64.exp());
        assert!((beside - 1.0 + 0.5 / 1f64.exp()).abs() < 1e-12, "{beside}");
    }

    #[test]
    fn silicone_forgets_and_pins_never_knew() {
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
    fn another_tendon_rubs_otherwise_on_pins_and_on_silicone() {
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
    fn the_second_operator_alone_is_off() {
        let two = Disturbance {
            kind: DisturbanceKind::Operators { turns: OperatorSchedule::Series },
            target: DisturbanceTarget::Reading,
            size: 0.5,
        };
        let on = |operator| two.on_reading_n(&RowCovariates { operator, ..RowCovariates::default() }, &[]);
        assert_eq!((on(1), on(2)), (0.0, 0.5));
    }
}
