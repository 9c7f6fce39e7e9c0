//! Disturbances outside the vocabulary in the study.

use pinswitch_calibration::effects::Covariate;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use crate::disturbance::{Disturbance, DisturbanceKind, DisturbanceTarget, OperatorSchedule};
use crate::plan::Protocol;

/// Kinds of disturbance, with the covariates of a correct answer.
pub(super) const OUTSIDE: [(&str, &[Covariate]); 12] = [
    ("step of friction in mid-session", &[Covariate::Time]),
    ("step of the reading in mid-session", &[Covariate::Time]),
    ("another level for a while", &[Covariate::Time]),
    ("wave in time", &[Covariate::Time]),
    ("wave along the stroke", &[Covariate::Position]),
    ("worn spot", &[Covariate::Position]),
    ("one defective layout", &[Covariate::Condition]),
    ("resonance at one speed", &[Covariate::Speed]),
    ("memory of the load before", &[Covariate::Load, Covariate::Repetition]),
    ("slow sine of friction", &[Covariate::Time]),
    ("another tendon from mid-session on", &[Covariate::Time]),
    ("two operators", &Covariate::ALL),
];

/// Kinds that were added later. They follow all others, because the seeds of a kind depend on its
/// index.
pub(super) const LATER: [(&str, &[Covariate]); 1] = [("Stribeck's dip", &[Covariate::Speed])];

/// Draws the disturbance of a kind.
pub(super) fn outside(
    name: &str,
    protocol: Protocol,
    layouts: &[Vec<usize>],
    random: &mut ChaCha8Rng,
) -> Disturbance {
    let sign = if random.random::<bool>() { 1.0 } else { -1.0 };
    let friction = random.random_range(0.08..0.25);
    let newtons = random.random_range(0.3..0.8);
    let of = |kind, target, size| Disturbance { kind, target, size };
    let phase = random.random_range(0.0..std::f64::consts::TAU);
    let even = random.random::<bool>();
    match name {
        "step of friction in mid-session" => {
            let over = if even { 0.0 } else { 0.02 };
            of(
                DisturbanceKind::Step { at: random.random_range(0.3..0.7), over },
                DisturbanceTarget::Friction,
                sign * friction,
            )
        }
        "step of the reading in mid-session" => of(
            DisturbanceKind::Step { at: random.random_range(0.3..0.7), over: 0.0 },
            DisturbanceTarget::Reading,
            sign * newtons,
        ),
        "another level for a while" => {
            let from = random.random_range(0.2..0.6);
            let to = from + random.random_range(0.1..0.3);
            of(DisturbanceKind::Window { from, to }, DisturbanceTarget::Reading, sign * newtons)
        }
        "wave in time" => {
            let cycles = random.random_range(3.0..40.0);
            of(DisturbanceKind::TimeWave { cycles, phase }, DisturbanceTarget::Reading, 0.5 * newtons)
        }
        "wave along the stroke" => {
            let cycles = random.random_range(1.5..4.5);
            of(
                DisturbanceKind::StrokeWave { cycles, phase, square: even },
                DisturbanceTarget::Friction,
                0.5 * friction,
            )
        }
        "worn spot" => {
            let (at, width) = (random.random_range(0.25..0.75), random.random_range(0.08..0.2));
            of(DisturbanceKind::Spot { at, width, flat: even }, DisturbanceTarget::Friction, friction)
        }
        "one defective layout" => {
            // Of three layouts, the one with another number of pins identifies the effect of
            // bending.
            let pins = layouts[random.random_range(1..layouts.len())].clone();
            let target = if even { DisturbanceTarget::Friction } else { DisturbanceTarget::Pins };
            of(DisturbanceKind::Layout { pins }, target, sign * friction * if even { 1.0 } else { 2.0 })
        }
        "memory of the load before" => {
            // With ascending loads the previous load is always similar, so that the effect must be
            // larger.
            let share = if protocol == Protocol::Paper { 5.0 } else { 2.5 };
            let repetitions = random.random_range(15.0..25.0);
            of(DisturbanceKind::Memory { repetitions }, DisturbanceTarget::Silicone, share * friction)
        }
        "slow sine of friction" => {
            let cycles = random.random_range(0.5..2.0);
            of(DisturbanceKind::TimeWave { cycles, phase }, DisturbanceTarget::Friction, friction)
        }
        "another tendon from mid-session on" => {
            let at = random.random_range(0.4..0.6);
            let other = random.random_range(0.08..0.25);
            let silicone = if even { -sign * other } else { 0.5 * sign * other };
            of(DisturbanceKind::Swap { at, silicone }, DisturbanceTarget::Friction, sign * friction)
        }
        "two operators" => {
            let turns = if even { OperatorSchedule::Series } else { OperatorSchedule::Half };
            of(DisturbanceKind::Operators { turns }, DisturbanceTarget::Reading, sign * newtons)
        }
        "Stribeck's dip" => {
            // In the paper's protocol all speeds are within 20 % of each other.
            let (speed_pct, width) = match protocol {
                Protocol::Paper => (random.random_range(50.0..54.0), random.random_range(0.015..0.04)),
                Protocol::Randomised => (random.random_range(45.0..65.0), random.random_range(0.1..0.35)),
            };
            of(DisturbanceKind::Stribeck { speed_pct, width }, DisturbanceTarget::Friction, friction)
        }
        _ => {
            let (least, most, width_pct) = match protocol {
                Protocol::Paper => (49.0f64, 55.0, 0.6),
                Protocol::Randomised => (40.0, 70.0, 3.0),
            };
            let mut speed_pct = random.random_range(least..most).round();
            if protocol == Protocol::Randomised {
                speed_pct = (speed_pct / 10.0).round().clamp(5.0, 6.0) * 10.0;
            }
            of(DisturbanceKind::Resonance { speed_pct, width_pct }, DisturbanceTarget::Friction, friction)
        }
    }
}
