//! Directions of the moves of a log, from several witnesses.
//!
//! Each witness favours a direction with a stated reliability. Its log odds are added, as in a naive
//! Bayes classifier. Three unknowns are common to the whole log, and are averaged over: the order of
//! the directions, the sign of the position, and whether the load cell agrees with the declared
//! load. If the load contradicts the two levels of the force, a fourth one is whether they are those
//! of the directions.

use pinswitch_friction::Direction;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::two_levels::{TwoLevels, two_levels};

/// Order of the directions in a log.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Protocol {
    /// All eccentric moves, then all concentric ones.
    EccentricFirst,
    /// All concentric moves, then all eccentric ones.
    ConcentricFirst,
    /// Eccentric and concentric moves in turn.
    Alternating,
    /// No fixed order.
    Unordered,
}

/// What is known about one move and the plateau after it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Evidence {
    /// Force of the plateau in newtons.
    pub(super) force_n: f64,
    /// Force before the move in newtons, if a rest precedes it.
    pub(super) before_n: Option<f64>,
    /// Travel in millimetres, if it exceeds the noise of the position.
    pub(super) travel_mm: Option<f64>,
    /// Mean power in watts during the move.
    pub(super) power_w: Option<f64>,
    /// Direction that the log declares.
    pub(super) declared: Option<Direction>,
}

/// Direction of a move.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Verdict {
    /// Likelier direction.
    pub(super) direction: Direction,
    /// Its probability.
    pub(super) probability: f64,
    /// Witnesses and their directions.
    pub(super) reason: String,
}

/// Directions of all moves of a log.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Directions {
    pub(super) verdicts: Vec<Verdict>,
    /// Whether the position decreases when the load is released.
    pub(super) is_position_reversed: bool,
    /// Levels of the force in newtons, if both are on one side of the load.
    pub(super) contradicted_levels_n: Option<(f64, f64)>,
}

/// Probability above which a direction is accepted.
pub(super) const ACCEPTED: f64 = 0.99;

/// Reliability of each witness: the probability that it names the right direction.
const COLUMN: f64 = 0.999;
const POSITION: f64 = 0.998;
/// Two separate levels of the plateaus: friction raises the concentric one.
const CLEAR_LEVELS: f64 = 0.998;
const CLOSE_LEVELS: f64 = 0.95;
/// A step of the settled force at a move.
const STEP: f64 = 0.9;
/// A plateau far from the declared load, and one near it.
const FAR_FROM_LOAD: f64 = 0.97;
const NEAR_LOAD: f64 = 0.85;
/// The sign of the power, and its level: to pull the load takes more.
const POWER_SIGN: f64 = 0.9;
const POWER_LEVEL: f64 = 0.8;
/// A move in the direction that the order of the log gives it.
const ORDER: f64 = 0.98;
/// The position increases when the load is released.
const POSITION_SIGN: f64 = 0.99;
/// The load cell agrees with the declared load.
const CELL: f64 = 0.97;
/// The two levels are those of the directions. The alternative is a change of the weight, or of the
/// zero of the cell, within the log: as rare as a wrong cell.
const LEVELS: f64 = CELL;
/// Probability of an order that is declared, and of each order without a declaration: eccentric
/// first is the protocol of the paper.
const DECLARED_ORDER: f64 = 0.97;
const ORDERS: [(Protocol, f64); 4] = [
    (Protocol::EccentricFirst, 0.55),
    (Protocol::ConcentricFirst, 0.15),
    (Protocol::Alternating, 0.15),
    (Protocol::Unordered, 0.15),
];

/// Distance of the levels, in standard deviations within a level, from which they are clear or
/// close. A normal distribution that is split in half has 2.65.
const CLEAR_DISTANCE: f64 = 6.0;
const CLOSE_DISTANCE: f64 = 4.0;
/// Repeatability of a plateau as a share of its force: levels are not tighter than this.
const REPEATABILITY: f64 = 0.01;
/// Shares of the load from which a plateau is near or far.
const NEAR_SHARE: f64 = 0.03;
const FAR_SHARE: f64 = 0.1;
/// A step below this share of the force, or below half the distance of separate levels, is not a
/// witness.
const STEP_SHARE: f64 = 0.03;

/// Log odds of a witness for the concentric direction.
#[derive(Clone, Copy, Debug)]
struct Witness {
    name: &'static str,
    log_odds: f64,
}

fn log_odds(reliability: f64, is_concentric: bool) -> f64 {
    let odds = libm::log(reliability / (1.0 - reliability));
    if is_concentric { odds } else { -odds }
}

/// Returns the direction of each move. `load_n` is the declared or measured load.
pub(super) fn directions(moves: &[Evidence], load_n: Option<f64>, protocol: Option<Protocol>) -> Directions {
    let levels = force_levels(moves);
    let power = power_levels(moves);
    let fixed: Vec<Vec<Witness>> = moves.iter().map(|m| witnesses(m, levels, power)).collect();
    // Levels on both sides of the load agree with it: its distance adds nothing.
    let contradicted = levels.filter(|levels| load_n.is_some_and(|load_n| is_one_sided(*levels, load_n)));
    let weighed_load_n = load_n.filter(|_| levels.is_none() || contradicted.is_some());
    let by_load: Vec<f64> = moves.iter().map(|m| load_witness(m, weighed_load_n)).collect();
    let by_level: Vec<f64> = moves.iter().map(|m| levels.map_or(0.0, |l| level_witness(m, l))).collect();
    let level_changes = contradicted.map(|_| changes(&by_level));
    let position: Vec<f64> =
        moves.iter().map(|m| m.travel_mm.map_or(0.0, |mm| log_odds(POSITION, mm < 0.0))).collect();
    let orders = orders(moves.len(), protocol);
    let mut combinations: Vec<Combination> = Vec::new();
    for (is_reversed, sign_share) in [(false, POSITION_SIGN), (true, 1.0 - POSITION_SIGN)] {
        for (cell, level, log_share) in common_causes(&by_load, &by_level, level_changes) {
            let odds: Vec<f64> = (0..moves.len())
                .map(|i| {
                    let sum: f64 = fixed[i].iter().map(|w| w.log_odds).sum();
                    let sign = if is_reversed { -1.0 } else { 1.0 };
                    sum + sign * position[i] + cell * by_load[i] + level * by_level[i]
                })
                .collect();
            let base = libm::log(sign_share) + log_share;
            for (share, pattern) in &orders {
                let mut log_weight = base + libm::log(*share);
                let mut concentric = Vec::with_capacity(moves.len());
                for (i, odds) in odds.iter().enumerate() {
                    let prior = pattern.prior(i);
                    let (up, down) = (libm::log(prior) + 0.5 * odds, libm::log(1.0 - prior) - 0.5 * odds);
                    let both = up.max(down) + libm::log1p(libm::exp(-(up - down).abs()));
                    log_weight += both;
                    concentric.push(libm::exp(up - both));
                }
                combinations.push(Combination { log_weight, is_reversed, concentric });
            }
        }
    }
    let top = combinations.iter().map(|c| c.log_weight).fold(f64::NEG_INFINITY, f64::max);
    let total: f64 = combinations.iter().map(|c| libm::exp(c.log_weight - top)).sum();
    let mean = |value: &dyn Fn(&Combination) -> f64| {
        combinations.iter().map(|c| libm::exp(c.log_weight - top) * value(c)).sum::<f64>() / total
    };
    let is_position_reversed =
        position.iter().any(|p| *p != 0.0) && mean(&|c| if c.is_reversed { 1.0 } else { 0.0 }) > 0.5;
    let verdicts = (0..moves.len())
        .map(|i| {
            let concentric = mean(&|c| c.concentric[i]);
            let is_concentric = concentric > 0.5;
            let mut all = fixed[i].clone();
            all.push(Witness { name: "level", log_odds: by_level[i] });
            all.push(Witness { name: "position", log_odds: position[i] });
            all.push(Witness { name: "load", log_odds: by_load[i] });
            Verdict {
                direction: if is_concentric { Direction::Concentric } else { Direction::Eccentric },
                probability: concentric.max(1.0 - concentric),
                reason: reason(&all),
            }
        })
        .collect();
    let contradicted_levels_n = contradicted.map(|levels| (levels.low, levels.high));
    Directions { verdicts, is_position_reversed, contradicted_levels_n }
}

/// Returns whether the load and the levels are witnesses (1) or not (0), with the logarithm of the
/// probability, for each common cause.
///
/// A wrong cell shifts all plateaus to one side, and a changed weight all those after the change:
/// each is one event, not one for each move. `level_changes` is the number of such events that the
/// levels need; `None` if nothing contradicts the levels.
fn common_causes(by_load: &[f64], by_level: &[f64], level_changes: Option<i32>) -> Vec<(f64, f64, f64)> {
    // Log odds that a cause has in place of the witness; it has one of two signs.
    let one_event = |odds: &[f64]| odds.iter().map(|o| 0.5 * o.abs()).sum::<f64>() - std::f64::consts::LN_2;
    let cells = [(1.0, libm::log(CELL)), (0.0, libm::log(1.0 - CELL) + one_event(by_load))];
    let levels = match level_changes {
        None => vec![(1.0, 0.0)],
        Some(changes) => vec![
            (1.0, libm::log(LEVELS)),
            (0.0, f64::from(changes) * libm::log(1.0 - LEVELS) + one_event(by_level)),
        ],
    };
    let all =
        cells.into_iter().flat_map(|(cell, a)| levels.iter().map(move |(level, b)| (cell, *level, a + b)));
    all.collect()
}

/// Returns the number of times that a witness changes its direction from one move to the next.
fn changes(log_odds: &[f64]) -> i32 {
    log_odds.windows(2).map(|pair| i32::from((pair[0] > 0.0) != (pair[1] > 0.0))).sum()
}

/// Whether both levels are on one side of the load, where friction puts only one of them.
fn is_one_sided(levels: TwoLevels, load_n: f64) -> bool {
    load_n > 0.0 && (levels.low > (1.0 + NEAR_SHARE) * load_n || levels.high < (1.0 - NEAR_SHARE) * load_n)
}

/// One combination of the unknowns that are common to a log.
struct Combination {
    /// Logarithm of its weight.
    log_weight: f64,
    /// Whether the position decreases when the load is released.
    is_reversed: bool,
    /// Probability of each move to be concentric.
    concentric: Vec<f64>,
}

/// Order of the directions in one combination.
enum Pattern {
    /// The first direction up to a move, then the other.
    Blocks { starts_concentric: bool, change: usize },
    /// The directions in turn.
    Turns { starts_concentric: bool },
    /// No order.
    None,
}

impl Pattern {
    /// Returns the probability that a move is concentric.
    fn prior(&self, at: usize) -> f64 {
        let is_concentric = match self {
            Self::Blocks { starts_concentric, change } => *starts_concentric == (at < *change),
            Self::Turns { starts_concentric } => *starts_concentric == at.is_multiple_of(2),
            Self::None => return 0.5,
        };
        if is_concentric { ORDER } else { 1.0 - ORDER }
    }
}

/// Most moves for which each change of direction is a separate combination.
const MAX_CHANGES: usize = 400;

/// Returns the orders of a log with their probabilities.
fn orders(moves: usize, declared: Option<Protocol>) -> Vec<(f64, Pattern)> {
    let mut orders = Vec::new();
    // A log of many moves has its change at one of a limited number of places.
    let step = moves.div_ceil(MAX_CHANGES).max(1);
    for (protocol, share) in ORDERS {
        let share = match declared {
            Some(declared) if declared == protocol => DECLARED_ORDER,
            Some(_) => (1.0 - DECLARED_ORDER) / 3.0,
            None => share,
        };
        match protocol {
            Protocol::EccentricFirst | Protocol::ConcentricFirst => {
                let starts_concentric = protocol == Protocol::ConcentricFirst;
                // A change after the last move is a log of one direction.
                let changes: Vec<usize> = (1..=moves.max(1)).step_by(step).chain([moves]).collect();
                let each = share / changes.len() as f64;
                orders.extend(
                    changes.into_iter().map(|change| (each, Pattern::Blocks { starts_concentric, change })),
                );
            }
            Protocol::Alternating => {
                orders.extend([
                    (0.7 * share, Pattern::Turns { starts_concentric: false }),
                    (0.3 * share, Pattern::Turns { starts_concentric: true }),
                ]);
            }
            Protocol::Unordered => orders.push((share, Pattern::None)),
        }
    }
    orders
}

/// Returns the two levels of the plateaus, if they are separate.
fn force_levels(moves: &[Evidence]) -> Option<TwoLevels> {
    let forces: Vec<f64> = moves.iter().map(|m| m.force_n).collect();
    let levels = two_levels(&forces)?;
    let repeatability = REPEATABILITY * levels.high.abs().max(levels.low.abs());
    (levels.high - levels.low > CLOSE_DISTANCE * levels.within.max(repeatability)).then_some(levels)
}

/// Returns the two levels of the power in the moves, if they are separate.
fn power_levels(moves: &[Evidence]) -> Option<TwoLevels> {
    let powers: Vec<f64> = moves.iter().filter_map(|m| m.power_w).collect();
    two_levels(&powers).filter(|levels| {
        let within = levels.within.max(0.05 * levels.high.abs().max(levels.low.abs()));
        levels.high - levels.low > CLEAR_DISTANCE * within
    })
}

/// Returns the witnesses of a move that depend on nothing common.
fn witnesses(m: &Evidence, levels: Option<TwoLevels>, power: Option<TwoLevels>) -> Vec<Witness> {
    let mut all = Vec::new();
    let mut add = |name, reliability, is_concentric| {
        all.push(Witness { name, log_odds: log_odds(reliability, is_concentric) });
    };
    if let Some(direction) = m.declared {
        add("column", COLUMN, direction == Direction::Concentric);
    }
    if let Some(before_n) = m.before_n {
        let step_n = m.force_n - before_n;
        let settling_n = levels.map_or(0.0, |levels| 0.5 * (levels.high - levels.low));
        if step_n.abs() > settling_n.max(STEP_SHARE * m.force_n.abs().max(before_n.abs())) {
            add("step", STEP, step_n > 0.0);
        }
    }
    if let (Some(power_w), Some(levels)) = (m.power_w, power) {
        let has_signs = levels.low < 0.0 && levels.high > 0.0;
        add("power", if has_signs { POWER_SIGN } else { POWER_LEVEL }, power_w > levels.threshold);
    }
    all
}

/// Returns the log odds of the level of a plateau.
fn level_witness(m: &Evidence, levels: TwoLevels) -> f64 {
    let within = levels.within.max(REPEATABILITY * levels.high.abs().max(levels.low.abs()));
    let is_clear = levels.high - levels.low > CLEAR_DISTANCE * within;
    log_odds(if is_clear { CLEAR_LEVELS } else { CLOSE_LEVELS }, m.force_n > levels.threshold)
}

/// Returns the log odds of the distance of a plateau from the load.
fn load_witness(m: &Evidence, load_n: Option<f64>) -> f64 {
    let Some(load_n) = load_n.filter(|load_n| *load_n > 0.0) else { return 0.0 };
    let share = m.force_n / load_n - 1.0;
    match share.abs() {
        s if s > FAR_SHARE => log_odds(FAR_FROM_LOAD, share > 0.0),
        s if s > NEAR_SHARE => log_odds(NEAR_LOAD, share > 0.0),
        _ => 0.0,
    }
}

/// Lists the witnesses of each direction.
fn reason(witnesses: &[Witness]) -> String {
    let names = |is_concentric: bool| {
        let names: Vec<&str> = (witnesses.iter())
            .filter(|w| w.log_odds != 0.0 && (w.log_odds > 0.0) == is_concentric)
            .map(|w| w.name)
            .collect();
        names.join(" and ")
    };
    match (names(false), names(true)) {
        (e, c) if e.is_empty() && c.is_empty() => "no witness".to_owned(),
        (e, c) if c.is_empty() => format!("{e}: eccentric"),
        (e, c) if e.is_empty() => format!("{c}: concentric"),
        (e, c) => format!("{e}: eccentric, {c}: concentric"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn evidence(force_n: f64, travel_mm: Option<f64>) -> Evidence {
        Evidence { force_n, travel_mm, ..Evidence::default() }
    }

    fn words(found: &Directions) -> String {
        let word = |v: &Verdict| match (v.probability >= ACCEPTED, v.direction) {
            (false, _) => '?',
            (_, Direction::Eccentric) => 'e',
            (_, Direction::Concentric) => 'c',
        };
        found.verdicts.iter().map(word).collect()
    }

    #[test]
    fn force_alone_decides_between_levels() {
        let moves: Vec<_> = [8.0, 8.1, 7.9, 13.5, 13.6, 13.5].map(|f| evidence(f, None)).into();
        assert_eq!(words(&directions(&moves, Some(10.5), None)), "eeeccc");
        let moves: Vec<_> = moves.into_iter().rev().collect();
        assert_eq!(words(&directions(&moves, None, None)), "ccceee");
    }

    #[test]
    fn position_alone_decides_in_the_usual_order() {
        let moves: Vec<_> =
            [8.0, -8.0].into_iter().flat_map(|mm| vec![evidence(10.0, Some(mm)); 5]).collect();
        assert_eq!(words(&directions(&moves, Some(10.0), None)), "eeeeeccccc");
        // The order could as well be unusual as the position reversed.
        let moves: Vec<_> = moves.into_iter().rev().collect();
        assert_eq!(words(&directions(&moves, Some(10.0), None)), "??????????");
        let declared = directions(&moves, Some(10.0), Some(Protocol::ConcentricFirst));
        assert_eq!(words(&declared), "ccccceeeee");
    }

    #[test]
    fn reversed_positions_are_recognised() {
        let moves: Vec<_> = [(8.0, -8.0), (13.0, 8.0)]
            .into_iter()
            .flat_map(|(f, mm)| vec![evidence(f, Some(mm)); 5])
            .collect();
        let found = directions(&moves, Some(10.0), None);
        assert_eq!(words(&found), "eeeeeccccc");
        assert!(found.is_position_reversed);
    }

    /// A move whose force contradicts its position is uncertain, and the others are not.
    #[test]
    fn contradictions_are_uncertain() {
        let mut moves: Vec<_> = [(8.0, 8.0), (13.0, -8.0)]
            .into_iter()
            .flat_map(|(f, mm)| vec![evidence(f, Some(mm)); 5])
            .collect();
        moves[2].force_n = 13.0;
        let found = directions(&moves, Some(10.0), Some(Protocol::Unordered));
        assert_eq!(words(&found), "ee?eeccccc");
        assert_eq!(found.verdicts[2].reason, "position: eccentric, level: concentric");
    }

    /// Levels on one side of the load are those of the directions in a wrong cell, or those of two
    /// weights: the force alone does not decide, and the position does.
    #[test]
    fn levels_on_one_side_of_the_load_do_not_decide() {
        for (low_n, high_n) in [(23.5, 29.4), (20.5, 23.5), (13.1, 16.3)] {
            let mut moves: Vec<_> =
                [low_n, high_n].into_iter().flat_map(|f| vec![evidence(f, None); 5]).collect();
            let found = directions(&moves, Some(19.61), None);
            assert!(!words(&found).contains(['e', 'c']), "{found:?}");
            assert!(found.contradicted_levels_n.is_some());
            moves.iter_mut().for_each(|m| m.travel_mm = Some(-8.0));
            let is_above = low_n > 19.61;
            let found = directions(&moves, Some(19.61), None);
            assert_eq!(words(&found), if is_above { "cccccccccc" } else { "??????????" }, "{found:?}");
            let turns: Vec<_> = (0..10).map(|i| evidence([low_n, high_n][i % 2], None)).collect();
            // One weight does not change with each move.
            assert_eq!(words(&directions(&turns, Some(19.61), None)), "ececececec");
        }
    }

    /// Plateaus on one side of the load may come from a wrong gain or zero of the cell.
    #[test]
    fn load_alone_does_not_decide() {
        for force_n in [8.0, 11.0] {
            let moves: Vec<_> = [force_n; 5].map(|f| evidence(f, None)).into();
            assert_eq!(words(&directions(&moves, Some(10.0), None)), "?????");
        }
        let mut moves: Vec<_> = [8.0; 5].map(|f| evidence(f, Some(3.0))).into();
        assert_eq!(words(&directions(&moves, Some(10.0), None)), "eeeee");
        moves.iter_mut().for_each(|m| (m.travel_mm, m.declared) = (None, Some(Direction::Concentric)));
        assert_eq!(words(&directions(&moves, Some(10.0), None)), "ccccc");
    }
}
