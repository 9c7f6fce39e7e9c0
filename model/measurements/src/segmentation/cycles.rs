//! Continuous cycles: strokes without rests, such as triangles and sines.

use super::interval::Move;
use super::log::Log;
use super::moves::{Speeds, speeds};
use super::two_levels::{noise_about_slope, without_spikes};
use crate::median::median;

/// Share of the time in motion from which a log has cycles. A sine is slow for 9 % of the time.
const MOVING_SHARE: f64 = 0.85;
/// The same for a log of one cycle: steps that are blurred by a long window also reverse once.
const MOVING_SHARE_OF_ONE: f64 = 0.97;
/// Most stops per half-cycle, and the least share of one that a stop takes: strokes in steps have
/// more.
const STOPS_PER_HALF_CYCLE: f64 = 1.5;
const STOP_SHARE: f64 = 0.02;
/// Speed in the middle of a stroke, as a share of its median, below which it rests, and the largest
/// share of such samples. A sine has at least 0.8 of its median there.
const SLOW_SHARE: f64 = 0.65;
const MAX_SLOW_SHARE: f64 = 0.03;
/// Reversal of the position, as a share of its range, that ends a half-cycle.
const REVERSAL_SHARE: f64 = 0.1;
/// Part of the stroke over which the force is averaged: its middle half.
const MIDDLE: (f64, f64) = (0.25, 0.75);

/// Bend of the difference of the branches in the middle part, as a share of the difference, above
/// which the force has not settled there, and its least size in standard errors. A decay whose time
/// constant is a thirteenth of the half-cycle has a bend of 0.02, and shifts a reading by 0.01.
const BEND_SHARE: f64 = 0.04;
const BEND_ERRORS: f64 = 5.0;

/// Middle part of a half-cycle.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct HalfCycle {
    /// Whole half-cycle.
    pub(super) stroke: Move,
    /// Samples in the middle part of the stroke.
    pub(super) middle: std::ops::Range<usize>,
    /// Travel in millimetres.
    pub(super) travel_mm: f64,
    /// Position at the centre of the middle part in millimetres.
    pub(super) centre_mm: f64,
}

/// Returns the half-cycles of a log, or `None` if its strokes have rests.
///
/// All half-cycles have the same middle part, so that both branches are read at the same positions.
/// A half-cycle that does not cover it, such as the first one, is left out.
pub(super) fn half_cycles(log: &Log) -> Option<Vec<HalfCycle>> {
    let position_mm = log.position_mm.as_ref()?;
    let Speeds { is_in_motion: is_moving, mm_s, .. } = speeds(log, position_mm)?;
    let (first, last) = (is_moving.iter().position(|m| *m)?, is_moving.iter().rposition(|m| *m)?);
    let moving_count = is_moving[first..=last].iter().filter(|m| **m).count();
    let position = without_spikes(position_mm);
    let turns = turning_points(&position[first..=last]);
    let strokes: Vec<Move> =
        turns.windows(2).map(|w| Move { from: first + w[0], to: first + w[1] + 1 }).collect();
    let share = if strokes.len() > 2 { MOVING_SHARE } else { MOVING_SHARE_OF_ONE };
    let is_continuous = moving_count as f64 > share * (last + 1 - first) as f64;
    let mut lengths: Vec<f64> = strokes.iter().map(|s| (s.to - s.from) as f64).collect();
    let shortest = STOP_SHARE * median(&mut lengths);
    let stops = is_moving[first..=last].chunk_by(|a, b| a == b);
    let stops = stops.filter(|run| !run[0] && run.len() as f64 > shortest).count();
    if !is_continuous || strokes.len() < 2 || stops as f64 > STOPS_PER_HALF_CYCLE * strokes.len() as f64 {
        return None;
    }
    let slow: usize = strokes.iter().map(|s| slow_samples(&mm_s[s.from..s.to])).sum();
    if slow as f64 > MAX_SLOW_SHARE * lengths.iter().sum::<f64>() {
        return None;
    }
    let ends = |is_high: bool| {
        let mut ends: Vec<f64> = (strokes.iter())
            .map(|s| (position[s.from], position[s.to - 1]))
            .map(|(a, b)| if is_high { a.max(b) } else { a.min(b) })
            .collect();
        median(&mut ends)
    };
    let (low, high) = (ends(false), ends(true));
    let (from_mm, to_mm) = (low + MIDDLE.0 * (high - low), low + MIDDLE.1 * (high - low));
    let halves = strokes.into_iter().filter_map(|stroke| {
        let (start_mm, end_mm) = (position[stroke.from], position[stroke.to - 1]);
        if start_mm.min(end_mm) > from_mm || start_mm.max(end_mm) < to_mm {
            return None;
        }
        let is_inside = |i: &usize| (from_mm..=to_mm).contains(&position[*i]);
        let from = (stroke.from..stroke.to).find(is_inside)?;
        let to = (stroke.from..stroke.to).rfind(is_inside)? + 1;
        let centre_mm = 0.5 * (from_mm + to_mm);
        Some(HalfCycle { stroke, middle: from..to, travel_mm: end_mm - start_mm, centre_mm })
    });
    Some(halves.collect())
}

/// Returns the bend of the difference of the branches over the difference, if the force still
/// settles after a reversal in the middle of the strokes.
///
/// The mean forces of the thirds of the middle part, in the order of time, are `f1`, `f2` and `f3`. A
/// force that depends on the position has the same bend `f1 - 2 f2 + f3` on both branches, since its
/// slope cancels. A decay after the reversal has one of opposite sign on each branch.
pub(super) fn unsettled(log: &Log, halves: &[HalfCycle]) -> Option<f64> {
    // Bends and means of the branches; the sign of the travel separates them.
    let mut branches: [(Vec<f64>, Vec<f64>); 2] = Default::default();
    for half in halves {
        let third = half.middle.len() / 3;
        if third == 0 {
            return None;
        }
        let forces = &log.force_n[half.middle.clone()];
        let mean_of = |at: usize| median(&mut forces[at * third..(at + 1) * third].to_vec());
        let (first, middle, last) = (mean_of(0), mean_of(1), mean_of(2));
        let branch = &mut branches[usize::from(half.travel_mm > 0.0)];
        branch.0.push(first - 2.0 * middle + last);
        branch.1.push((first + middle + last) / 3.0);
    }
    let count = branches.iter().map(|b| b.0.len()).min().unwrap_or(0);
    if count == 0 {
        return None;
    }
    let [(mut bends_a, mut means_a), (mut bends_b, mut means_b)] = branches;
    let bend = median(&mut bends_a) - median(&mut bends_b);
    let difference = median(&mut means_a) - median(&mut means_b);
    let third = halves.iter().map(|half| half.middle.len() / 3).min().unwrap_or(1);
    // Each bend is a sum of three medians with the squared weights 1, 4 and 1. The variance of a median
    // is pi/2 times that of a mean, and the median of the bends adds the same factor.
    let of_median = std::f64::consts::FRAC_PI_2 * std::f64::consts::FRAC_PI_2;
    let error = noise_about_slope(&log.force_n) * (2.0 * 6.0 * of_median / (third * count) as f64).sqrt();
    // The branches approach their levels, which are further apart than the means.
    let share = -bend / difference;
    (share > BEND_SHARE && bend.abs() > BEND_ERRORS * error).then_some(share)
}

/// Returns the number of samples in the middle of a stroke with a speed far below its median: rests
/// that are blurred by the window of the speed.
fn slow_samples(mm_s: &[f64]) -> usize {
    let (from, to) = (mm_s.len() / 5, mm_s.len() - mm_s.len() / 5);
    let middle = &mm_s[from..to];
    let usual = median(&mut middle.to_vec());
    middle.iter().filter(|v| **v < SLOW_SHARE * usual).count()
}

/// Returns the indices of the first and last value and of the reversals between them.
fn turning_points(position_mm: &[f64]) -> Vec<usize> {
    let low = position_mm.iter().copied().fold(f64::INFINITY, f64::min);
    let high = position_mm.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let bound = (REVERSAL_SHARE * (high - low)).max(6.0 * noise_about_slope(position_mm));
    let mut turns = vec![0];
    let (mut lowest, mut highest, mut rises) = (0, 0, None);
    for (i, x) in position_mm.iter().enumerate() {
        if *x > position_mm[highest] {
            highest = i;
        }
        if *x < position_mm[lowest] {
            lowest = i;
        }
        if rises != Some(false) && position_mm[highest] - x > bound {
            if rises.is_some() || highest > 0 {
                turns.push(highest);
            }
            (rises, lowest) = (Some(false), i);
        } else if rises != Some(true) && x - position_mm[lowest] > bound {
            if rises.is_some() || lowest > 0 {
                turns.push(lowest);
            }
            (rises, highest) = (Some(true), i);
        }
        match rises {
            Some(true) => lowest = i,
            Some(false) => highest = i,
            None => {}
        }
    }
    turns.push(position_mm.len() - 1);
    turns.dedup();
    turns
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A log of triangles at 100 Hz: the friction reverses with a time constant, and the force has a
    /// part that depends on the position.
    fn triangles(period_s: f64, settling_s: f64, elastic: impl Fn(f64) -> f64) -> Log {
        let mut friction = 0.0;
        let (mut times, mut forces, mut positions) = (Vec::new(), Vec::new(), Vec::new());
        for i in 0..3000u32 {
            let phase = (f64::from(i) / 100.0 / period_s).fract();
            let (at, sign) = if phase < 0.5 { (2.0 * phase, -1.0) } else { (2.0 - 2.0 * phase, 1.0) };
            friction += (sign - friction) * (0.01 / settling_s).min(1.0);
            let noise = 0.03 * libm::sin(37.0 * f64::from(i) * f64::from(i));
            times.push(f64::from(i) / 100.0);
            forces.push(20.0 + 4.0 * friction + elastic(at) + noise);
            positions.push(40.0 * at);
        }
        Log::new(times, forces, Some(positions), None, "a").unwrap()
    }

    #[test]
    fn unsettled_strokes_are_known() {
        let bend = |log: &Log| unsettled(log, &half_cycles(log).unwrap());
        assert!(bend(&triangles(2.0, 0.3, |_| 0.0)).unwrap() > 0.1);
        assert!(bend(&triangles(2.0, 0.3, |at| 5.0 * at)).is_some());
        // Settled, with a force that depends on the position.
        assert_eq!(bend(&triangles(8.0, 0.1, |_| 0.0)), None);
        assert_eq!(bend(&triangles(8.0, 0.1, |at| 5.0 * at * at)), None);
        assert_eq!(bend(&triangles(2.0, 0.01, |at| 5.0 * at)), None);
    }
}
