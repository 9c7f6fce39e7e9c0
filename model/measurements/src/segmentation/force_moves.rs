//! Moves that only the force shows: its change points end one steady interval and begin the next.

use std::ops::Range;

use super::change_points::{change_points, is_relaxation};
use super::interval::{Move, Schedule, samples_in, usual};
use super::log::Log;
use super::steady_force::{Joint, Steady, SteadyForce, steady_kinds};
use super::steady_moves::{UnknownMoves, steady_moves};
use super::two_levels::{LEVELS_NOISE, noise, without_spikes};

/// Length in seconds over which the force is averaged before its change points are located.
const BLOCK_S: f64 = 0.05;
/// Shortest rest in seconds, and fewest blocks of one, that the force can show.
const SHORTEST_REST_S: f64 = 0.3;
const SHORTEST_REST_BLOCKS: usize = 4;
/// Share of the usual rest below which a steady interval belongs to the settling after a move.
const SETTLING_SHARE: f64 = 0.4;
/// Blocks by which the ends of a steady interval are uncertain.
const UNCERTAIN_BLOCKS: f64 = 2.0;

/// Moves by the force, and what the force does not decide.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct ForceMoves {
    /// Moves in the order of time.
    pub(super) visible: Vec<Move>,
    /// Start and end, in seconds, of steady intervals that are neither rests nor settling.
    pub(super) unexplained_s: Vec<(f64, f64)>,
    /// Two levels in one direction, if the actuator may move at either.
    pub(super) unknown: Option<UnknownMoves>,
}

/// Mean forces of the blocks of a log.
struct Blocks<'a> {
    log: &'a Log,
    /// Samples of a block.
    size: usize,
    mean_n: Vec<f64>,
    noise_n: f64,
}

/// Steady intervals of a log, in blocks.
struct Steadiness {
    /// Intervals outside of the declared moves.
    steady: Vec<Range<usize>>,
    /// Intervals that are rests or moves.
    either: Vec<Range<usize>>,
}

impl<'a> Blocks<'a> {
    fn new(log: &'a Log) -> Self {
        let force = without_spikes(&log.force_n);
        let size = samples_in(log, BLOCK_S);
        let mean_n: Vec<f64> = force.chunks(size).map(|b| b.iter().sum::<f64>() / b.len() as f64).collect();
        let noise_n = noise(&mean_n).max(1e-6);
        Self { log, size, mean_n, noise_n }
    }

    /// Returns the first sample of a block; the last sample of the log for its end.
    fn sample(&self, block: usize) -> usize {
        (block * self.size).min(self.log.time_s.len() - 1)
    }

    fn time_s(&self, block: usize) -> f64 {
        self.log.time_s[self.sample(block)]
    }

    fn length_s(&self, blocks: &Range<usize>) -> f64 {
        self.time_s(blocks.end) - self.time_s(blocks.start)
    }

    fn level_n(&self, blocks: &Range<usize>) -> f64 {
        self.mean_n[blocks.clone()].iter().sum::<f64>() / blocks.len() as f64
    }

    /// Returns the steady intervals outside of the declared moves.
    ///
    /// A move begins where the previous rest ends: a steady interval that ends within `on_s` from
    /// there on belongs to the move. If the rest after a move is not steady, the next move begins
    /// `dwell_s` after its end. Without `dwell_s`, the next steady interval may be a rest or a move,
    /// unless it is too long for a move, or ends too early for a rest and a move.
    fn steady(&self, schedule: Schedule) -> Steadiness {
        let mut ends = change_points(&self.mean_n, self.noise_n);
        ends.push(self.mean_n.len());
        let slack_s = UNCERTAIN_BLOCKS * BLOCK_S;
        let mut steady: Vec<Range<usize>> = Vec::new();
        let mut either = Vec::new();
        // End of a move whose rest is not found yet, in seconds.
        let mut moved_s = None;
        let mut start = 0;
        for end in ends {
            let blocks = start..end;
            start = end;
            if blocks.len() < SHORTEST_REST_BLOCKS || self.length_s(&blocks) < SHORTEST_REST_S {
                continue;
            }
            let Some(last) = steady.last_mut() else {
                steady.push(blocks);
                continue;
            };
            let is_relaxing = last.end == blocks.start
                && is_relaxation(
                    &self.mean_n[last.start..blocks.end],
                    blocks.start - last.start,
                    self.noise_n,
                );
            let end_s = self.time_s(blocks.end);
            let starts_s = [
                moved_s.is_none().then(|| self.time_s(last.end)),
                moved_s.zip(schedule.dwell_s).map(|(moved_s, dwell_s)| moved_s + dwell_s),
            ];
            let is_move = schedule.on_s.is_some_and(|on_s| {
                starts_s
                    .iter()
                    .flatten()
                    .any(|start_s| end_s > start_s + slack_s && end_s <= start_s + on_s + slack_s)
            }) && !self.breaks_within(last.end, blocks.start + 1);
            let is_either = moved_s.zip(schedule.on_s).is_some_and(|(moved_s, on_s)| {
                schedule.dwell_s.is_none()
                    && end_s - moved_s > on_s
                    && self.length_s(&blocks) <= on_s + slack_s
            });
            if is_relaxing {
                last.end = blocks.end;
            } else if is_move {
                moved_s = Some(end_s);
            } else if is_either {
                moved_s = Some(end_s);
                either.push(blocks);
            } else {
                steady.push(blocks);
                moved_s = None;
            }
        }
        Steadiness { steady, either }
    }

    /// Returns the steady intervals with their levels.
    fn steady_forces(&self, all: &[Range<usize>], schedule: Schedule) -> Vec<SteadyForce> {
        let usual_s = usual(all.iter().map(|i| self.length_s(i)).collect())
            .min(schedule.dwell_s.unwrap_or(f64::INFINITY));
        let joint = |i: usize| match i {
            0 => Joint::LogStart,
            _ if self.breaks_within(all[i - 1].end.saturating_sub(1), all[i].start + 1) => Joint::FileStart,
            _ if all[i - 1].end == all[i].start => Joint::Contiguous,
            _ => Joint::Apart,
        };
        (all.iter().enumerate())
            .map(|(i, interval)| SteadyForce {
                level_n: self.level_n(interval),
                is_short: self.length_s(interval) < SETTLING_SHARE * usual_s,
                length_s: self.length_s(interval),
                joint: joint(i),
            })
            .collect()
    }

    /// Whether another file begins within blocks.
    fn breaks_within(&self, from: usize, to: usize) -> bool {
        self.log.breaks.iter().any(|b| (from..=to).contains(&(b / self.size)))
    }
}

/// Returns the moves by the change points of the force.
///
/// The end of a move is not visible in the force: it ends `on_s` after its start, if that is
/// declared, and otherwise where the force is steady.
pub(super) fn force_moves(log: &Log, schedule: Schedule) -> ForceMoves {
    let blocks = Blocks::new(log);
    let Steadiness { steady: all, either } = blocks.steady(schedule);
    let steady = blocks.steady_forces(&all, schedule);
    let (all, steady, unknown) = match steady_moves(&steady, blocks.noise_n) {
        Ok(is_move) => {
            let mut moves = is_move.into_iter();
            let rests: Vec<_> = all.into_iter().filter(|_| !moves.next().unwrap_or(false)).collect();
            let steady = blocks.steady_forces(&rests, schedule);
            (rests, steady, None)
        }
        Err(unknown) => (all, steady, Some(unknown)),
    };
    let kinds = steady_kinds(&steady);
    let of_kind =
        |kind: Steady| all.iter().zip(&kinds).filter(move |(_, k)| **k == kind).map(|(interval, _)| interval);
    let mut unexplained_s: Vec<(f64, f64)> = (of_kind(Steady::Unexplained).chain(&either))
        .map(|i| (blocks.time_s(i.start), blocks.time_s(i.end)))
        .collect();
    unexplained_s.sort_by(|a, b| a.0.total_cmp(&b.0));
    let rests: Vec<&Range<usize>> = of_kind(Steady::Rest).collect();
    let mut visible = Vec::new();
    // A log that starts with the motor has a step before its first rest.
    if let Some(rest) = rests.first().filter(|rest| rest.start > 0)
        && (blocks.mean_n[0] - blocks.level_n(rest)).abs() > LEVELS_NOISE * blocks.noise_n
    {
        visible.push(Move { from: 0, to: (rest.start * blocks.size).clamp(1, log.time_s.len()) });
    }
    for pair in rests.windows(2) {
        let from = blocks.sample(pair[0].end);
        let steady = (pair[1].start * blocks.size).clamp(from + 1, log.time_s.len());
        let to = schedule.on_s.map_or(steady, |on_s| {
            let end_s = log.time_s[from] + on_s;
            let latest = (pair[1].end * blocks.size).max(from + 1);
            log.time_s.partition_point(|t| *t < end_s).clamp(from + 1, latest)
        });
        visible.push(Move { from, to: to.min(log.time_s.len()) });
    }
    ForceMoves { visible, unexplained_s, unknown }
}

#[cfg(test)]
mod tests {
    use super::super::plateaus::segment;
    use super::super::run_plan::Rig;
    use super::*;

    /// Forces of a log at 50 Hz, with twelve moves in two blocks: at a load of 40 N, the actuator
    /// moves at 30.4 N or 52.5 N and rests at 32.4 N or 49.5 N. The sixth rest is longer by `pause_s`.
    fn log(on_s: f64, dwell_s: f64, pause_s: f64) -> Log {
        let (mut times, mut forces) = (Vec::new(), Vec::new());
        let mut time_s = 0.0;
        let mut level = 40.0;
        let mut random = 1u64;
        let mut hold = |target: f64, tau_s: f64, length_s: f64| {
            let end_s = time_s + length_s;
            while time_s < end_s {
                level += (target - level) * (0.02 / tau_s);
                times.push(time_s);
                // Knuth's linear congruential generator.
                random =
                    random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                forces.push(level + 0.04 * ((random >> 40) as f64 / (1u64 << 24) as f64 - 0.5));
                time_s += 0.02;
            }
        };
        hold(40.0, 0.1, 2.0);
        for i in 0..12 {
            let (moving_n, resting_n) = if i < 6 { (30.4, 32.4) } else { (52.5, 49.5) };
            hold(moving_n, 0.06, on_s);
            hold(resting_n, 0.1, dwell_s + if i == 5 { pause_s } else { 0.0 });
        }
        Log::new(times, forces, None, None, "a").unwrap()
    }

    /// Number of plateaus, all at the force of a rest; `None` if the log is refused.
    fn plateaus(log: &Log, on_s: Option<f64>, dwell_s: Option<f64>) -> Option<usize> {
        let rig = Rig { on_s, dwell_s, ..Rig::default() };
        let out = segment(log, &rig, Some(40.0)).ok()?;
        for plateau in &out.plateaus {
            let rest_n =
                if plateau.direction == pinswitch_friction::Direction::Eccentric { 32.4 } else { 49.5 };
            assert!((plateau.force_n - rest_n).abs() < 0.1, "{plateau:?}");
        }
        Some(out.plateaus.len())
    }

    #[test]
    fn steady_moves_are_not_rests() {
        for (on_s, dwell_s) in [(0.5, 3.0), (0.5, 8.0), (2.0, 1.5), (2.0, 3.0), (1.0, 1.0)] {
            let log = log(on_s, dwell_s, 0.0);
            let is_known = on_s < 0.4 * dwell_s;
            assert_eq!(plateaus(&log, None, None), is_known.then_some(12), "{on_s} {dwell_s}");
            assert_eq!(plateaus(&log, Some(on_s), Some(dwell_s)), Some(12), "{on_s} {dwell_s}");
        }
    }

    #[test]
    fn a_long_pause_hides_no_rest() {
        for pause_s in [60.0, 1_000.0] {
            assert_eq!(plateaus(&log(0.5, 3.0, pause_s), None, None), Some(12), "{pause_s}");
        }
    }
}
