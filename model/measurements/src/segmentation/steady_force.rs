//! Steady intervals of the force: which are rests, where neither power nor position shows the moves.

use super::two_levels::{TwoLevels, two_levels};

/// A steady interval of the force.
#[derive(Clone, Copy, Debug)]
pub(super) struct SteadyForce {
    /// Mean force in newtons.
    pub(super) level_n: f64,
    /// Whether it is shorter than the usual rest by so much that it may belong to the settling.
    pub(super) is_short: bool,
    /// Length in seconds.
    pub(super) length_s: f64,
    /// Relation to the previous interval.
    pub(super) joint: Joint,
}

/// Relation of a steady interval to the previous one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Joint {
    /// It is the first one of the log.
    LogStart,
    /// It is the first one of another file.
    FileStart,
    /// It follows without a sample between.
    Contiguous,
    /// The force changes between them.
    Apart,
}

/// Kind of a steady interval of the force.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Steady {
    /// Rest between two moves.
    Rest,
    /// Part of the settling after a move, or of the rest before.
    Settling,
    /// Interval that is neither: the actuator may rest in it.
    Unexplained,
}

/// Least distance of the two levels as a share of the force: closer ones may be those of moves and
/// rests in one direction.
const LEAST_DISTANCE: f64 = 0.08;
/// Change of the force, as a share of the distance of its two levels, above which a steady interval
/// has another level than the previous one. The load is half the distance from both.
const OTHER_LEVEL: f64 = 0.25;
/// The same for a move from level to level.
const REVERSAL: f64 = 0.5;

/// Steady intervals by the level of the direction.
pub(super) struct Visits<'a> {
    /// Consecutive intervals at one level, within a file.
    pub(super) groups: Vec<&'a [SteadyForce]>,
    /// The two levels, if they are separate.
    pub(super) levels: Option<TwoLevels>,
    /// Distance of the levels in newtons; infinite for one level.
    distance_n: f64,
}

/// Returns the visits to the levels of the directions.
pub(super) fn visits(all: &[SteadyForce]) -> Visits<'_> {
    let levels_n: Vec<f64> = all.iter().map(|interval| interval.level_n).collect();
    let levels =
        two_levels(&levels_n).filter(|l| l.high - l.low > LEAST_DISTANCE * l.high.abs().max(l.low.abs()));
    let distance_n = levels.map_or(f64::INFINITY, |levels| levels.high - levels.low);
    let is_one_level = |a: &SteadyForce, b: &SteadyForce| {
        !matches!(b.joint, Joint::LogStart | Joint::FileStart)
            && (a.level_n - b.level_n).abs() <= OTHER_LEVEL * distance_n
    };
    Visits { groups: all.chunk_by(is_one_level).collect(), levels, distance_n }
}

/// Returns the kinds of steady intervals.
///
/// Consecutive intervals at one level form a group. Its long intervals are rests. A group of short
/// ones is a rest if the force moves to it from the other level or from the start of the log, and
/// back to the other level: settling does not leave its level again. If all long intervals are at one
/// level, the short ones at the other one may be moves instead: it is not known which. A short interval after a long
/// one, apart from it, may be the rest after a long move at a steady force.
pub(super) fn steady_kinds(all: &[SteadyForce]) -> Vec<Steady> {
    let Visits { groups, levels, distance_n } = visits(all);
    let is_long_at = |is_high: bool| {
        let threshold_n = levels.map_or(0.0, |levels| levels.threshold);
        all.iter().any(|interval| !interval.is_short && (interval.level_n > threshold_n) == is_high)
    };
    let has_long_at_both = is_long_at(false) && is_long_at(true);
    let mut kinds = Vec::new();
    for (i, group) in groups.iter().enumerate() {
        let (Some(first), Some(last)) = (group.first(), group.last()) else { continue };
        // Changes from the group before and to the next one, within a file.
        let before = (i > 0 && first.joint != Joint::FileStart).then(|| {
            let change_n = (first.level_n - groups[i - 1][groups[i - 1].len() - 1].level_n).abs();
            i == 1 || change_n > REVERSAL * distance_n
        });
        let after = groups.get(i + 1).map(|next| next[0]).filter(|next| next.joint != Joint::FileStart);
        let after = after.map(|next| (next.level_n - last.level_n).abs() > REVERSAL * distance_n || i == 0);
        let last_long = group.iter().rposition(|interval| !interval.is_short);
        for (j, interval) in group.iter().enumerate() {
            let is_last = j + 1 == group.len();
            kinds.push(match last_long {
                _ if !interval.is_short => Steady::Rest,
                Some(long) if j > long && interval.joint == Joint::Apart && after.is_some() => {
                    Steady::Unexplained
                }
                Some(_) => Steady::Settling,
                None if !is_last => Steady::Settling,
                None => match (before, after) {
                    (Some(true), Some(true)) if has_long_at_both => Steady::Rest,
                    // The rest before the first move.
                    (None, Some(true)) if first.joint == Joint::LogStart => Steady::Rest,
                    // A level of moves, or of shorter rests than those of the other direction; or the
                    // log ends soon after a move.
                    (Some(true), _) if after != Some(false) => Steady::Unexplained,
                    _ => Steady::Settling,
                },
            });
        }
    }
    kinds
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kinds(intervals: &[(f64, bool)]) -> String {
        let all: Vec<SteadyForce> = (intervals.iter().enumerate())
            .map(|(i, &(level_n, is_short))| SteadyForce {
                level_n,
                is_short,
                length_s: if is_short { 0.5 } else { 3.0 },
                joint: if i == 0 { Joint::LogStart } else { Joint::Apart },
            })
            .collect();
        let word = |kind: &Steady| match kind {
            Steady::Rest => 'r',
            Steady::Settling => 's',
            Steady::Unexplained => '?',
        };
        steady_kinds(&all).iter().map(word).collect()
    }

    #[test]
    fn short_rests_are_not_settling() {
        let (short, long) = (true, false);
        // Alternating moves with rests of different lengths, after a rest at the load.
        let rests = [(20.0, short), (16.0, short), (24.0, long), (16.0, long), (24.0, short), (16.0, long)];
        assert_eq!(kinds(&rests), "rrrrrr");
        // Each rest is after the overshoot of its move.
        let overshoots = [
            (20.0, short),
            (15.7, short),
            (16.0, short),
            (24.3, short),
            (24.0, long),
            (15.7, short),
            (16.0, long),
        ];
        assert_eq!(kinds(&overshoots), "rsrsrsr");
        // Settling towards a rest, after a reversal and after a move in the same direction.
        assert_eq!(kinds(&[(24.0, long), (15.8, short), (16.0, long), (15.8, short), (16.0, long)]), "rsrsr");
        // An overshoot by a third of the move is not a rest.
        assert_eq!(kinds(&[(16.0, long), (26.5, short), (24.0, long), (16.0, long)]), "rsrr");
        // Moves longer than the rests after them.
        assert_eq!(kinds(&[(15.7, long), (16.0, short), (24.4, long), (24.0, short), (16.0, long)]), "r?r?r");
        // Moves in one direction with a steady force far from that of the rests, and near it.
        assert_eq!(kinds(&[(16.0, long), (13.0, short), (16.0, long), (13.0, short), (16.0, long)]), "r?r?r");
        assert_eq!(kinds(&[(16.0, long), (15.6, short), (16.0, long), (15.6, short), (16.0, long)]), "rsrsr");
        // The end of a log.
        assert_eq!(kinds(&[(24.0, long), (16.0, long), (24.0, short)]), "rr?");
        assert_eq!(kinds(&[(24.0, long), (24.0, short)]), "rs");
    }
}
