//! Defects of a log: missing repetitions, moves of an unusual length, and faults of the samples.

use std::ops::RangeInclusive;

use pinswitch_friction::Direction;

use super::finding::Finding;
use super::interval::stop_s;
use super::log::Log;
use super::run_plan::Rig;
use super::segmented::{Motion, Reading, Segmented};
use crate::median::median;

/// Relative departures of a measured value from the declared one.
const RATE_DEPARTURE: f64 = 0.05;
const STROKE_DEPARTURE: f64 = 0.05;
/// Periods between two plateaus of one direction above which a repetition is missing.
const MISSING_PERIODS: f64 = 1.6;
/// Usual lengths of a move over the median length.
const USUAL_LENGTHS: RangeInclusive<f64> = 0.8..=1.25;
/// Share of the samples at one end of the range above which the force is clipped.
const CLIPPED_SHARE: f64 = 0.01;

/// Adds the pauses in which a repetition is missing.
pub(super) fn missing_repetitions(readings: &[Reading], out: &mut Segmented) {
    if out.motion == Motion::Cycles {
        return;
    }
    let mut periods: Vec<f64> = readings.windows(2).map(|w| w[1].time_s - w[0].time_s).collect();
    let period_s = median(&mut periods);
    for pair in out.plateaus.windows(2) {
        let between = pair[0].time_s..pair[1].time_s;
        if out.moves.iter().any(|m| m.direction.is_none() && between.contains(&m.from_s)) {
            continue; // The repetition is left out, not missing.
        }
        // The experimenter may pause between the directions.
        if pair[0].direction == pair[1].direction
            && pair[1].time_s - pair[0].time_s > MISSING_PERIODS * period_s
        {
            out.findings
                .push(Finding::MissingRepetition { direction: pair[0].direction, after: pair[0].repetition });
        }
    }
}

/// Adds the moves of an unusual length, and a stroke that departs from the declared one.
pub(super) fn odd_speeds(log: &Log, rig: &Rig, readings: &[Reading], out: &mut Segmented) {
    let mut lengths: Vec<(Direction, u32, f64)> = Vec::new();
    let mut speeds = Vec::new();
    let mut counts = [0u32; 2];
    for (r, mark) in readings.iter().zip(&out.moves) {
        let Some(direction) = mark.direction else { continue };
        let slot = usize::from(direction == Direction::Concentric);
        counts[slot] += 1;
        let Some(travel_mm) = r.evidence.travel_mm else { continue };
        lengths.push((direction, counts[slot], travel_mm.abs()));
        speeds.push(travel_mm.abs() / (stop_s(log, r.span) - log.time_s[r.span.from]).max(1e-9));
    }
    if !speeds.is_empty() {
        out.speed_mm_s = Some(median(&mut speeds));
    }
    for direction in [Direction::Eccentric, Direction::Concentric] {
        let mut all: Vec<f64> = lengths.iter().filter(|l| l.0 == direction).map(|l| l.2).collect();
        let typical = median(&mut all);
        for (_, repetition, length) in lengths.iter().filter(|l| l.0 == direction) {
            let ratio = length / typical.max(1e-9);
            if !USUAL_LENGTHS.contains(&ratio) {
                out.findings.push(Finding::OddSpeed { direction, repetition: *repetition, ratio });
            }
        }
    }
    let positions = log.position_mm.as_deref().filter(|_| !lengths.is_empty());
    if let (Some(positions), Some(declared)) = (positions, rig.stroke_mm) {
        let low = positions.iter().copied().fold(f64::INFINITY, f64::min);
        let high = positions.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        if (high - low - declared).abs() > STROKE_DEPARTURE * declared {
            out.findings.push(Finding::Departure { field: "rig.stroke_mm", declared, measured: high - low });
        }
    }
}

/// Adds the defects of the samples.
pub(super) fn sample_defects(log: &Log, rig: &Rig, spikes: usize, findings: &mut Vec<Finding>) {
    if spikes > 0 {
        findings.push(Finding::Spikes { samples: spikes });
    }
    let step = log.period_s();
    if let Some(declared) = rig.sample_rate_hz
        && (1.0 / step / declared - 1.0).abs() > RATE_DEPARTURE
    {
        findings.push(Finding::Departure { field: "rig.sample_rate_hz", declared, measured: 1.0 / step });
    }
    // Jitter moves a stamp by up to a quarter of a step; a lost sample doubles the gap.
    let lost: f64 = (1..log.time_s.len())
        .filter(|i| !log.breaks.contains(i))
        .map(|i| ((log.time_s[i] - log.time_s[i - 1]) / step).round() - 1.0)
        .filter(|n| *n > 0.0)
        .sum();
    if lost > 0.0 {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a positive whole number"
        )]
        findings.push(Finding::LostSamples { samples: lost as usize });
    }
    if log.unusable > 0 {
        findings.push(Finding::UnusableLines { lines: log.unusable });
    }
    for (end, at) in [
        log.force_n.iter().copied().fold(f64::NEG_INFINITY, f64::max),
        log.force_n.iter().copied().fold(f64::INFINITY, f64::min),
    ]
    .into_iter()
    .map(|end| (end, log.force_n.iter().filter(|f| (**f - end).abs() < 1e-9).count()))
    {
        let share = at as f64 / log.force_n.len() as f64;
        if share > CLIPPED_SHARE {
            findings.push(Finding::Clipped { force_n: end, share });
        }
    }
}
