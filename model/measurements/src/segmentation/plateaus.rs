//! Plateaus of one log: moves are found by the actuator's power, then the settled force of each
//! rest is read.

use pinswitch_friction::Direction;
use serde::Serialize;

use super::finding::Finding;
use super::log::Log;
use super::run_plan::Rig;
use crate::median::median;

/// One plateau: the steady reading after a move.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Plateau {
    /// Direction of the previous move.
    pub direction: Direction,
    /// Number of the repetition in its direction, from 1.
    pub repetition: u32,
    /// Settled force in newtons.
    #[serde(rename = "force_N")]
    pub force_n: f64,
    /// Actuator position in millimetres.
    pub position_mm: f64,
    /// End of the rest in seconds since the log began.
    pub time_s: f64,
    /// Number of averaged samples, without spikes.
    pub samples: usize,
}

/// Plateaus and findings of one log.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Segmented {
    /// Plateaus in the order of time.
    pub plateaus: Vec<Plateau>,
    /// Defects of the log.
    pub findings: Vec<Finding>,
}

/// An interval in which the actuator runs: sample indices, with the end excluded.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Move {
    from: usize,
    to: usize,
}

/// Power in watts above which the actuator runs.
const RUNNING_W: f64 = 2.0;
/// Averaging time at the end of a plateau, and guard time before the next move, in seconds.
const READ_S: f64 = 1.0;
const GUARD_S: f64 = 0.012;

/// Finds the plateaus and the defects of a log.
pub fn segment(log: &Log, rig: &Rig) -> Segmented {
    let mut out = Segmented::default();
    let moves = moves(log, rig);
    let period = rig.on_s + rig.dwell_s;
    let mut counts = [0u32; 2];
    let mut lengths: Vec<(Direction, u32, f64)> = Vec::new();
    let mut spikes = 0;
    for (i, m) in moves.iter().enumerate() {
        let next = moves.get(i + 1);
        let stop_s = log.time_s[m.to - 1];
        let rest_end_s = next.map_or_else(
            || (stop_s + rig.dwell_s).min(log.time_s[log.time_s.len() - 1]),
            |n| log.time_s[n.from].min(stop_s + rig.dwell_s + 0.05),
        );
        let travelled = level(log, rest_end_s - 0.5, rest_end_s)
            - level(log, log.time_s[m.from] - 0.3, log.time_s[m.from]);
        let direction = if travelled >= 0.0 { Direction::Eccentric } else { Direction::Concentric };
        let slot = usize::from(direction == Direction::Concentric);
        let from_s = (rest_end_s - READ_S).max(stop_s + 0.25 * (rest_end_s - stop_s));
        let window = range(log, from_s, rest_end_s - GUARD_S);
        let Some((force_n, samples)) = settled_force(&log.force_n[window.clone()]) else {
            out.findings.push(Finding::UnreadableRest { time_s: rest_end_s });
            continue;
        };
        spikes += window.len() - samples;
        counts[slot] += 1;
        lengths.push((direction, counts[slot], travelled.abs()));
        out.plateaus.push(Plateau {
            direction,
            repetition: counts[slot],
            force_n,
            position_mm: level(log, from_s, rest_end_s),
            time_s: rest_end_s,
            samples,
        });
    }
    for pair in out.plateaus.windows(2) {
        // The experimenter may pause between the directions.
        if pair[0].direction == pair[1].direction && pair[1].time_s - pair[0].time_s > 1.6 * period {
            out.findings
                .push(Finding::MissingRepetition { direction: pair[0].direction, after: pair[0].repetition });
        }
    }
    findings(log, rig, spikes, &lengths, &mut out);
    out
}

/// Returns the intervals with power; short interruptions are closed and short bursts are dropped.
fn moves(log: &Log, rig: &Rig) -> Vec<Move> {
    let mut moves: Vec<Move> = Vec::new();
    for (i, power) in log.power_w.iter().enumerate() {
        if *power <= RUNNING_W {
            continue;
        }
        match moves.last_mut() {
            Some(last) if log.time_s[i] - log.time_s[last.to - 1] < 0.2 * rig.on_s => last.to = i + 1,
            _ => moves.push(Move { from: i, to: i + 1 }),
        }
    }
    moves.retain(|m| log.time_s[m.to - 1] - log.time_s[m.from] > 0.4 * rig.on_s);
    moves
}

/// Returns the indices of the samples between two times.
fn range(log: &Log, from_s: f64, to_s: f64) -> std::ops::Range<usize> {
    let from = log.time_s.partition_point(|t| *t < from_s);
    from..log.time_s.partition_point(|t| *t < to_s).max(from)
}

/// Returns the median position between two times in millimetres.
fn level(log: &Log, from_s: f64, to_s: f64) -> f64 {
    let mut values = log.position_mm[range(log, from_s, to_s)].to_vec();
    median(&mut values)
}

/// Returns the mean of the samples within 4.5 robust standard deviations of the median, and their
/// number.
fn settled_force(force_n: &[f64]) -> Option<(f64, usize)> {
    if force_n.len() < 20 {
        return None;
    }
    let mut values = force_n.to_vec();
    let centre = median(&mut values);
    let mut sizes: Vec<f64> = force_n.iter().map(|f| (f - centre).abs()).collect();
    let bound = 4.5 * (1.4826 * median(&mut sizes)).max(1e-3);
    let (sum, count) = force_n
        .iter()
        .filter(|f| (**f - centre).abs() <= bound)
        .fold((0.0, 0usize), |(sum, count), f| (sum + f, count + 1));
    (count >= 20).then(|| (sum / count as f64, count))
}

/// Adds the defects of the log as a whole.
fn findings(log: &Log, rig: &Rig, spikes: usize, lengths: &[(Direction, u32, f64)], out: &mut Segmented) {
    if spikes > 0 {
        out.findings.push(Finding::Spikes { samples: spikes });
    }
    let step = 1.0 / rig.sample_rate_hz;
    // Jitter moves a stamp by up to a quarter of a step; a lost sample doubles the gap.
    let lost: f64 =
        log.time_s.windows(2).map(|w| ((w[1] - w[0]) / step).round() - 1.0).filter(|n| *n > 0.0).sum();
    if lost > 0.0 {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a positive whole number"
        )]
        out.findings.push(Finding::LostSamples { samples: lost as usize });
    }
    if log.unusable > 0 {
        out.findings.push(Finding::UnusableLines { lines: log.unusable });
    }
    for (end, at) in [
        log.force_n.iter().copied().fold(f64::NEG_INFINITY, f64::max),
        log.force_n.iter().copied().fold(f64::INFINITY, f64::min),
    ]
    .into_iter()
    .map(|end| (end, log.force_n.iter().filter(|f| (**f - end).abs() < 1e-9).count()))
    {
        let share = at as f64 / log.force_n.len() as f64;
        if share > 0.01 {
            out.findings.push(Finding::Clipped { force_n: end, share });
        }
    }
    for direction in [Direction::Eccentric, Direction::Concentric] {
        let mut all: Vec<f64> = lengths.iter().filter(|l| l.0 == direction).map(|l| l.2).collect();
        let typical = median(&mut all);
        for (_, repetition, length) in lengths.iter().filter(|l| l.0 == direction) {
            let ratio = length / typical.max(1e-9);
            if !(0.8..=1.25).contains(&ratio) {
                out.findings.push(Finding::OddSpeed { direction, repetition: *repetition, ratio });
            }
        }
    }
}
