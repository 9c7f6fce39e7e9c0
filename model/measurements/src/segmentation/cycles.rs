//! Continuous cycles: strokes without rests, such as triangles and sines.

use super::log::Log;
use super::moves::{Move, Speeds, speeds};
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
