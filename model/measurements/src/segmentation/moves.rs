//! Moves of the actuator, from its power, its position, or the force alone.

use schemars::JsonSchema;
use serde::Serialize;

use super::force_moves::{ForceMoves, force_moves};
use super::interval::{Move, Schedule, samples_in, stop_s, usual};
use super::log::Log;
use super::steady_moves::UnknownMoves;
use super::two_levels::{LEVELS_NOISE, noise_about_slope, two_levels, without_spikes};
use crate::median::median;

/// Column from which the moves of a log were found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Source {
    /// Power of the actuator.
    Power,
    /// Position of the actuator.
    Position,
    /// Force.
    #[default]
    Force,
}

impl Source {
    /// Returns the word of reports.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Power => "power",
            Self::Position => "position",
            Self::Force => "force",
        }
    }
}

/// Least share of the variance between two levels: 0.75 is that of a uniform distribution.
const TWO_LEVELS_SHARE: f64 = 0.8;
/// Gaps in a move, as a share of the usual length, that are closed; shorter moves are dropped.
const GAP_SHARE: f64 = 0.2;
const SHORTEST_SHARE: f64 = 0.4;

/// Moves of a log.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Moves {
    /// Moves in the order of time.
    pub(super) all: Vec<Move>,
    /// Column that shows them.
    pub(super) source: Source,
    /// Number of moves that only the declared schedule shows.
    pub(super) scheduled: usize,
    /// Start and end, in seconds, of steady intervals of the force that are neither rests nor the
    /// settling after a move.
    pub(super) unexplained_s: Vec<(f64, f64)>,
    /// Two levels of the force in one direction, if the actuator may move at either.
    pub(super) unknown: Option<UnknownMoves>,
}

/// Finds the moves of a log.
pub(super) fn moves(log: &Log, schedule: Schedule) -> Moves {
    let by_position = log.position_mm.as_ref().and_then(|x| position_moves(log, x));
    let by_power = log.power_w.as_ref().and_then(|w| power_moves(log, w));
    let (all, source) = match (by_power, by_position) {
        (Some(power), Some(position)) => {
            // A column that does not follow the actuator, such as the power of another device.
            let position_mm = log.position_mm.as_deref().unwrap_or_default();
            let travel = |moves: &[Move]| moves.iter().map(|m| travelled(position_mm, *m)).sum::<f64>();
            if travel(&power) >= 0.5 * travel(&position) {
                (power, Source::Power)
            } else {
                (position, Source::Position)
            }
        }
        (Some(power), None) => (power, Source::Power),
        (None, Some(position)) => (position, Source::Position),
        (None, None) => {
            let ForceMoves { visible, unexplained_s, unknown } = force_moves(log, schedule);
            let all = scheduled_moves(log, &visible, schedule);
            let scheduled = all.len() - visible.len();
            return Moves { all, source: Source::Force, scheduled, unexplained_s, unknown };
        }
    };
    Moves { all, source, scheduled: 0, unexplained_s: Vec::new(), unknown: None }
}

/// Returns the length of the way between the neighbours of a move in millimetres.
fn travelled(position_mm: &[f64], m: Move) -> f64 {
    (position_mm[m.to.min(position_mm.len() - 1)] - position_mm[m.from.saturating_sub(1)]).abs()
}

/// Returns the moves by a power above the threshold between its two levels; `None` without two
/// levels.
fn power_moves(log: &Log, power_w: &[f64]) -> Option<Vec<Move>> {
    let power: Vec<f64> = without_spikes(power_w).into_iter().map(f64::abs).collect();
    let levels = two_levels(&power)?;
    let is_clear =
        levels.between_share > TWO_LEVELS_SHARE && levels.high - levels.low > LEVELS_NOISE * levels.within;
    let moves = is_clear.then(|| intervals(log, |i| power[i] > levels.threshold))?;
    (!moves.is_empty()).then_some(moves)
}

/// Returns the moves by the speed of the position; `None` if it does not move.
fn position_moves(log: &Log, position_mm: &[f64]) -> Option<Vec<Move>> {
    let is_moving = speeds(log, position_mm)?.is_moving;
    let moves = intervals(log, |i| is_moving[i]);
    (!moves.is_empty()).then_some(moves)
}

/// Half windows in seconds of a speed: the first over which the position visibly moves is used.
const HALF_WINDOWS_S: [f64; 3] = [0.05, 0.2, 0.8];
/// Least share of the samples with a visible motion.
const MOVING_SAMPLES: f64 = 0.002;
/// Share of the usual speed above which the position moves; and in a window that blurs short rests.
const SLOW_SHARE: f64 = 0.2;
const BLURRED_SHARE: f64 = 0.5;

/// Usual speed, in terms of the least visible one, from which a half window is long enough.
const CLEAR_SPEED: f64 = 2.0;

/// Motion of the position at each sample.
pub(super) struct Speeds {
    /// Whether the actuator moves, rather than rests.
    pub(super) is_moving: Vec<bool>,
    /// Whether it moves at least slowly, as at the reversals of a sine.
    pub(super) is_in_motion: Vec<bool>,
    /// Speed in millimetres per second.
    pub(super) mm_s: Vec<f64>,
}

/// Returns the motion of the position; `None` if it never moves.
///
/// The speed is the difference of the means of the half windows after and before a sample.
pub(super) fn speeds(log: &Log, position_mm: &[f64]) -> Option<Speeds> {
    let position = without_spikes(position_mm);
    let noise_mm = noise_about_slope(&position);
    let (places, times) = (running_sums(&position), running_sums(&log.time_s));
    let count = position.len();
    let mut visible = None;
    for half_s in HALF_WINDOWS_S {
        let half = samples_in(log, half_s);
        let difference = |sums: &[f64], i: usize| {
            let mean = |from: usize, to: usize| (sums[to] - sums[from]) / (to - from) as f64;
            mean(i, (i + half).min(count)) - mean(i.saturating_sub(half), i.max(1))
        };
        // Lost samples make a step longer, not faster.
        let speed = |i: usize| (difference(&places, i) / difference(&times, i).max(1e-9)).abs();
        // The means of short windows at the ends have more noise.
        let certainty =
            |i: usize| (2.0 * shorter(i, half, count) / (half as f64 + shorter(i, half, count))).sqrt();
        let speeds: Vec<f64> =
            (1..=count).map(|i| i.min(count - 1)).map(|i| speed(i) * certainty(i)).collect();
        let bound = LEVELS_NOISE * noise_mm * (2.0 / half as f64).sqrt() / (half as f64 * log.period_s());
        let mut fast: Vec<f64> = speeds.iter().copied().filter(|v| *v > bound).collect();
        if (fast.len() as f64) < (MOVING_SAMPLES * count as f64).max(2.0) {
            continue;
        }
        let usual = median(&mut fast);
        let above = |share: f64| -> Vec<bool> {
            let threshold = bound.max(share * usual);
            closed(speeds.iter().map(|v| *v > threshold).collect(), half)
        };
        let is_moving = above(if half_s > HALF_WINDOWS_S[0] { BLURRED_SHARE } else { SLOW_SHARE });
        visible = Some(Speeds { is_moving, is_in_motion: above(SLOW_SHARE), mm_s: speeds });
        if usual > CLEAR_SPEED * bound {
            break;
        }
    }
    visible
}

/// Returns the length of the shorter window before and after a sample.
fn shorter(at: usize, half: usize, count: usize) -> f64 {
    half.min(at).min(count - at).max(1) as f64
}

/// Returns the sums of the first values, relative to the first one.
fn running_sums(values: &[f64]) -> Vec<f64> {
    let mut sums = vec![0.0];
    let mut sum = 0.0;
    for value in values {
        sum += value - values[0];
        sums.push(sum);
    }
    sums
}

/// Closes the gaps that are shorter than a number of samples.
fn closed(mut is_moving: Vec<bool>, length: usize) -> Vec<bool> {
    let mut last = None;
    for i in 0..is_moving.len() {
        if is_moving[i] {
            if let Some(last) = last.filter(|last| i - last <= length) {
                is_moving[last..i].fill(true);
            }
            last = Some(i);
        }
    }
    is_moving
}

/// Returns the intervals in which the actuator runs; short interruptions are closed and short
/// bursts are dropped, in terms of the usual length.
fn intervals(log: &Log, runs: impl Fn(usize) -> bool) -> Vec<Move> {
    let mut moves: Vec<Move> = Vec::new();
    for i in (0..log.time_s.len()).filter(|i| runs(*i)) {
        match moves.last_mut() {
            Some(last) if last.to == i && !log.breaks.contains(&i) => last.to = i + 1,
            _ => moves.push(Move { from: i, to: i + 1 }),
        }
    }
    // The samples that a logger loses while the motor starts belong to the move.
    let length_s = |m: &Move| stop_s(log, *m) - log.time_s[m.from.saturating_sub(1)];
    let mut usual_s = usual(moves.iter().map(length_s).collect());
    for _ in 0..2 {
        let mut closed: Vec<Move> = Vec::new();
        for m in &moves {
            match closed.last_mut() {
                Some(last)
                    if log.time_s[m.from] - log.time_s[last.to - 1] < GAP_SHARE * usual_s
                        && !log.breaks.iter().any(|b| (last.to..=m.from).contains(b)) =>
                {
                    last.to = m.to;
                }
                _ => closed.push(*m),
            }
        }
        moves = closed;
        usual_s = usual(moves.iter().map(length_s).collect());
    }
    // A log may start within a move.
    moves.retain(|m| length_s(m) > SHORTEST_SHARE * usual_s || (m.from == 0 && m.to > 1));
    moves
}

/// Departure of an interval between visible moves from a multiple of the declared period, as a share
/// of the period, up to which it contains moves without a pause.
const SCHEDULE_SLACK: f64 = 0.2;

/// Share of the scheduled moves that is visible: from the first on, a longer interval is a missing
/// move, and from the second on, an irregular interval is a pause.
const ALL_VISIBLE: f64 = 0.88;
const MOST_VISIBLE: f64 = 0.6;
/// Share of the intervals that may depart from the schedule, in addition to one at the reversal.
const IRREGULAR_SHARE: f64 = 0.25;

/// Adds the moves that leave the force unchanged, where the declared schedule has them: between two
/// visible moves, before the first and after the last. Before the first, the time of a rest is left
/// for the start of the log and a pause at the reversal.
fn scheduled_moves(log: &Log, visible: &[Move], schedule: Schedule) -> Vec<Move> {
    let (Some(on_s), Some(dwell_s)) = (schedule.on_s, schedule.dwell_s) else { return visible.to_vec() };
    let (Some(first), Some(end_s)) = (visible.first(), log.time_s.last()) else { return Vec::new() };
    let period_s = on_s + dwell_s;
    let start_s = |m: &Move| log.time_s[m.from];
    let ends_s: Vec<f64> = visible.iter().map(start_s).chain([*end_s]).collect();
    let visible_share = visible_share(&ends_s, period_s);
    if visible_share > ALL_VISIBLE {
        return visible.to_vec();
    }
    let mut moves = Vec::new();
    let mut add = |start_s: f64| {
        let from = log.time_s.partition_point(|t| *t < start_s);
        let to = log.time_s.partition_point(|t| *t < start_s + on_s).max(from + 1);
        if to < log.time_s.len() && !log.breaks.iter().any(|b| (from..=to).contains(b)) {
            moves.push(Move { from, to });
        }
    };
    let fills_pauses = visible_share < MOST_VISIBLE;
    let lead_s = start_s(first) - log.time_s[0] - dwell_s;
    for i in (1..=whole(lead_s / period_s)).rev().filter(|_| fills_pauses) {
        add(start_s(first) - f64::from(i) * period_s);
    }
    for (i, pair) in ends_s.windows(2).enumerate() {
        let periods = (pair[1] - pair[0]) / period_s;
        let is_last = i + 2 == ends_s.len();
        let (count, step_s) = if is_regular(periods) && !is_last {
            (whole(periods.round()), (pair[1] - pair[0]) / periods.round())
        } else if fills_pauses {
            (whole(periods + SCHEDULE_SLACK), period_s)
        } else {
            continue;
        };
        for j in 1..count {
            add(pair[0] + f64::from(j) * step_s);
        }
    }
    moves.extend_from_slice(visible);
    moves.sort_by_key(|m| m.from);
    moves.dedup_by_key(|m| m.from);
    moves
}

/// Whether an interval is a multiple of the declared period.
fn is_regular(periods: f64) -> bool {
    periods > 0.5 && (periods - periods.round()).abs() <= SCHEDULE_SLACK
}

/// Returns the share of the scheduled moves that is visible, from the starts of the visible moves
/// and the end of the log; 1 if they contradict the schedule.
fn visible_share(ends_s: &[f64], period_s: f64) -> f64 {
    let intervals: Vec<f64> = ends_s.windows(2).map(|w| (w[1] - w[0]) / period_s).collect();
    let Some((last, between)) = intervals.split_last() else { return 1.0 };
    let regular: Vec<f64> = between.iter().filter(|p| is_regular(**p)).map(|p| p.round()).collect();
    let irregular = (between.len() - regular.len()) as f64;
    if irregular > 1.0 + IRREGULAR_SHARE * between.len() as f64 {
        return 1.0;
    }
    // The last move is visible.
    let scheduled = regular.iter().sum::<f64>() + f64::from(whole(last + SCHEDULE_SLACK).max(1));
    (regular.len() as f64 + 1.0) / scheduled
}

/// Returns the whole part of a positive number; zero for others.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "positive and limited")]
fn whole(number: f64) -> u32 {
    number.clamp(0.0, 1e6).floor() as u32
}
