//! Moves at a steady force: in one direction, the force alternates between their level and that of
//! the rests.

use super::steady_force::{Joint, SteadyForce, Visits, visits};
use super::two_levels::{LEVELS_NOISE, TwoLevels, two_levels};
use crate::median::median;

/// Least distance of the levels of moves and rests in one direction, as a share of the force: it is
/// the repeatability of a plateau.
const REPEATABILITY: f64 = 0.01;

/// Length of a move, as a share of a rest, up to which it is known to be one.
const MOVE_SHARE: f64 = 0.4;
/// Standard deviations above which alternations are not by chance.
const BY_CHANCE: f64 = 3.0;

/// Levels in newtons between which the force alternates in one direction, if it is not known at
/// which of them the actuator moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct UnknownMoves {
    pub(super) low_n: f64,
    pub(super) high_n: f64,
}

/// Returns for each steady interval whether the actuator moves in it.
///
/// Plateaus of one direction repeat one level. If they alternate between two, each repetition has two
/// steady intervals: the move, and the rest after it. A visit to a direction begins with a move and
/// ends with a rest. Moves are taken as shorter than rests: those of the level with clearly shorter
/// intervals are moves, unless more of them come after a long one than before one.
///
/// # Errors
/// [`UnknownMoves`] if the lengths are similar, or the order contradicts them.
pub(super) fn steady_moves(all: &[SteadyForce], noise_n: f64) -> Result<Vec<bool>, UnknownMoves> {
    let Visits { groups, levels, .. } = visits(all);
    let is_high = |group: &[SteadyForce]| levels.is_some_and(|l| group[0].level_n > l.threshold);
    let sides: Vec<Side> = [false, true]
        .into_iter()
        .filter_map(|side| {
            let groups: Vec<&[SteadyForce]> =
                groups.iter().copied().filter(|group| is_high(group) == side).collect();
            Side::new(side, &groups)
        })
        .collect();
    // Equal levels change sides in half of the pairs by chance, so that twice the number is that of
    // the pairs, with its square root as standard deviation.
    let pairs = sides.iter().map(|side| side.pairs).sum::<usize>() as f64;
    let alternations = sides.iter().map(|side| side.alternations).sum::<usize>() as f64;
    let is_systematic = 2.0 * alternations > pairs + BY_CHANCE * pairs.sqrt();
    let mut is_move = vec![false; all.len()];
    for side in &sides {
        // Half of the intervals are the second one of a repetition.
        let is_alternating = side.alternations >= 2 && 3 * side.alternations >= side.intervals;
        if !is_alternating || !(is_systematic || side.is_separate(noise_n)) {
            continue;
        }
        let unknown = UnknownMoves { low_n: side.split.low, high_n: side.split.high };
        let moves_are_high = side.moves_are_high.ok_or(unknown)?;
        let mut at = 0;
        for group in &groups {
            for (i, interval) in group.iter().enumerate().filter(|_| is_high(group) == side.is_high) {
                is_move[at + i] = interval.joint != Joint::LogStart
                    && (interval.level_n > side.split.threshold) == moves_are_high;
            }
            at += group.len();
        }
    }
    Ok(is_move)
}

/// Steady intervals of one direction, split into two levels.
struct Side {
    is_high: bool,
    split: TwoLevels,
    /// Number of intervals.
    intervals: usize,
    /// Number of pairs of consecutive intervals, and of those at different levels.
    pairs: usize,
    alternations: usize,
    /// Whether the moves have the higher of the two levels, if it is known.
    moves_are_high: Option<bool>,
}

impl Side {
    /// Splits the visits to one direction; `None` if all levels are equal.
    fn new(is_high: bool, visits: &[&[SteadyForce]]) -> Option<Self> {
        // The first interval of a file may be a rest.
        let visits: Vec<&[SteadyForce]> = (visits.iter().copied())
            .map(|visit| match visit[0].joint {
                Joint::LogStart | Joint::FileStart => &visit[1..],
                Joint::Contiguous | Joint::Apart => visit,
            })
            .filter(|visit| !visit.is_empty())
            .collect();
        let intervals = || visits.iter().copied().flatten();
        let levels_n: Vec<f64> = intervals().map(|i| i.level_n).collect();
        let split = two_levels(&levels_n)?;
        let is_upper = |interval: &SteadyForce| interval.level_n > split.threshold;
        let usual_s = |upper: bool| {
            median(&mut intervals().filter(|i| is_upper(i) == upper).map(|i| i.length_s).collect::<Vec<_>>())
        };
        let (lower_s, upper_s) = (usual_s(false), usual_s(true));
        // Alternations that begin at the lower level, and at the upper one.
        let mut alternations = [0, 0];
        for pair in visits.iter().flat_map(|visit| visit.windows(2)) {
            if is_upper(&pair[0]) != is_upper(&pair[1]) {
                alternations[usize::from(is_upper(&pair[0]))] += 1;
            }
        }
        let [from_lower, from_upper] = alternations;
        let moves_are_high = if lower_s <= MOVE_SHARE * upper_s && from_lower >= from_upper {
            Some(false)
        } else if upper_s <= MOVE_SHARE * lower_s && from_upper >= from_lower {
            Some(true)
        } else {
            None
        };
        Some(Self {
            is_high,
            split,
            intervals: levels_n.len(),
            pairs: visits.iter().map(|visit| visit.len() - 1).sum(),
            alternations: from_lower + from_upper,
            moves_are_high,
        })
    }

    /// Whether the levels are further apart than those of one plateau.
    fn is_separate(&self, noise_n: f64) -> bool {
        let distance_n = self.split.high - self.split.low;
        distance_n > LEVELS_NOISE * self.split.within.max(noise_n)
            && distance_n > REPEATABILITY * self.split.high.abs().max(self.split.low.abs())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the kinds of intervals of a level and a length each: moves, others, or unknown.
    fn kinds(intervals: &[(f64, f64)]) -> String {
        let all: Vec<SteadyForce> = (intervals.iter().enumerate())
            .map(|(i, &(level_n, length_s))| SteadyForce {
                level_n,
                is_short: length_s < 1.2,
                length_s,
                joint: if i == 0 { Joint::LogStart } else { Joint::Apart },
            })
            .collect();
        match steady_moves(&all, 0.01) {
            Ok(moves) => moves.iter().map(|is_move| if *is_move { 'm' } else { '-' }).collect(),
            Err(UnknownMoves { low_n, high_n }) => format!("{low_n} or {high_n}"),
        }
    }

    #[test]
    fn moves_and_rests_have_levels() {
        // Rests at one level each.
        let one = [(20.0, 2.0), (16.0, 3.0), (24.0, 3.0), (16.02, 3.0), (24.0, 3.0), (16.01, 3.0)];
        assert_eq!(kinds(&one), "------");
        // Short moves before rests, in turns and in blocks.
        let turns =
            [(20.0, 2.0), (15.0, 0.5), (16.0, 3.0), (25.0, 0.5), (24.0, 3.0), (15.0, 0.5), (16.0, 3.0)];
        assert_eq!(kinds(&[&turns[..], &turns[3..]].concat()), "-m-m-m-m-m-");
        let blocks =
            [(20.0, 2.0), (16.0, 3.0), (15.0, 0.5), (16.0, 3.0), (15.0, 1.3), (16.0, 3.0), (24.0, 3.0)];
        assert_eq!(kinds(&blocks), "--m-m--");
        // Moves as long as the rests, or longer.
        let similar = [(20.0, 2.0), (15.0, 2.0), (16.0, 1.5), (15.0, 2.0), (16.0, 1.5), (24.0, 1.5)];
        assert_eq!(kinds(&similar), "15 or 16");
        let longer = [(20.0, 2.0), (15.0, 2.0), (16.0, 0.6), (15.0, 2.0), (16.0, 0.6), (24.0, 1.5)];
        assert_eq!(kinds(&longer), "15 or 16");
    }
}
