//! What nobody has named: steps, waves, worn spots, resonances, one defective layout.

use std::f64::consts::{PI, TAU};

use pinswitch_calibration::effects::Covariate;
use pinswitch_calibration::table::PlateauRow;
use serde::{Deserialize, Serialize};

/// What a disturbance acts on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum DisturbanceTarget {
    /// A share of the friction coefficients of pins and silicone.
    #[default]
    Friction,
    /// A share of the friction coefficient of the pins.
    Pins,
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
    pub kind: Course,
    /// What it acts on.
    #[serde(default)]
    pub target: DisturbanceTarget,
    /// Its size: a share of friction, or newtons.
    pub size: f64,
}

/// Course of a disturbance; shares of time and stroke are 0..1.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Course {
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
    /// One layout, wherever its pins stand.
    Layout {
        /// Its occupied grooves.
        pins: Vec<usize>,
    },
}

impl Disturbance {
    /// Where a calibration should find it.
    pub fn covariate(&self) -> Covariate {
        match self.kind {
            Course::Step { .. } | Course::Window { .. } | Course::TimeWave { .. } => Covariate::Time,
            Course::StrokeWave { .. } | Course::Spot { .. } => Covariate::Position,
            Course::Resonance { .. } => Covariate::Speed,
            Course::Layout { .. } => Covariate::Condition,
        }
    }

    /// Every number of its course, and those of them that are divided by.
    pub(super) fn numbers(&self) -> (Vec<f64>, Vec<f64>) {
        match self.kind {
            Course::Step { at, over } => (vec![at, over], vec![]),
            Course::Window { from, to } => (vec![from, to], vec![]),
            Course::TimeWave { cycles, phase } | Course::StrokeWave { cycles, phase, .. } => {
                (vec![cycles, phase], vec![])
            }
            Course::Spot { at, width, .. } => (vec![at, width], vec![width]),
            Course::Resonance { speed_pct, width_pct } => (vec![speed_pct, width_pct], vec![width_pct]),
            Course::Layout { .. } => (vec![], vec![]),
        }
    }

    fn course(&self, clock: f64, place: f64, speed_pct: f64, pins: &[usize]) -> f64 {
        let flag = |b: bool| f64::from(u8::from(b));
        match &self.kind {
            Course::Step { at, over } => ((clock - at) / over.max(1e-9)).clamp(0.0, 1.0),
            Course::Window { from, to } => flag(clock >= *from && clock < *to),
            Course::TimeWave { cycles, phase } => (TAU * cycles * clock + phase).sin(),
            Course::StrokeWave { cycles, phase, square } => {
                let wave = (TAU * cycles * place + phase).sin();
                if *square { wave.signum() * PI / 4.0 } else { wave }
            }
            Course::Spot { at, width, flat } => {
                let x = (place - at) / width;
                if x.abs() > 0.5 {
                    0.0
                } else if *flat {
                    1.0
                } else {
                    (PI * x).cos()
                }
            }
            Course::Resonance { speed_pct: v, width_pct } => {
                1.0 / (1.0 + ((speed_pct - v) / width_pct).powi(2))
            }
            Course::Layout { pins: defective } => flag(pins == defective.as_slice()),
        }
    }

    /// Newtons on a reading.
    pub(super) fn on_reading_n(&self, clock: f64, place: f64, row: &PlateauRow) -> f64 {
        let course = || self.size * self.course(clock, place, row.speed_pct, &row.pins);
        match self.target {
            DisturbanceTarget::Reading => course(),
            DisturbanceTarget::Drag => row.direction.sign() * course(),
            DisturbanceTarget::Friction | DisturbanceTarget::Pins => 0.0,
        }
    }

    /// Factors on the friction of pins and silicone.
    pub(super) fn on_friction(&self, clock: f64, place: f64, speed_pct: f64, pins: &[usize]) -> (f64, f64) {
        let factor = 1.0 + self.size * self.course(clock, place, speed_pct, pins);
        match self.target {
            DisturbanceTarget::Friction => (factor, factor),
            DisturbanceTarget::Pins => (factor, 1.0),
            DisturbanceTarget::Reading | DisturbanceTarget::Drag => (1.0, 1.0),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_spot_and_a_resonance_end_where_they_should() {
        let on = |kind: Course, clock, place, speed| {
            Disturbance { kind, target: DisturbanceTarget::Friction, size: 0.5 }
                .on_friction(clock, place, speed, &[])
                .0
        };
        let spot = || Course::Spot { at: 0.5, width: 0.1, flat: false };
        assert_eq!(on(spot(), 0.0, 0.5, 50.0), 1.5);
        assert_eq!(on(spot(), 0.0, 0.56, 50.0), 1.0);
        let step = || Course::Step { at: 0.4, over: 0.0 };
        assert_eq!((on(step(), 0.39, 0.0, 50.0), on(step(), 0.41, 0.0, 50.0)), (1.0, 1.5));
        let resonance = Course::Resonance { speed_pct: 50.0, width_pct: 1.0 };
        assert_eq!(on(resonance, 0.0, 0.0, 51.0), 1.25);
    }
}
