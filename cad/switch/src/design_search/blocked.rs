//! The reason why no design meets a request: the missed targets of the nearest design, the limits
//! that block it, and changes that would meet the request.

use schemars::JsonSchema;
use serde::Serialize;

use super::candidate::Trial;
use super::refine::{Aim, Place, refined};
use super::relaxed::extended_range;
use super::space::{Space, is_predictable};
use crate::config::Configuration;
use crate::feasibility::is_feasible;
use crate::request::{Limits, Materials, Parameter, Request, Target, Vary};
use pinswitch_friction::{pluralise, sort_by_number};

/// Steps of the search over all parameters together.
const TOGETHER_STEPS: u64 = 400;
/// Number of intervals between the values of a parameter that are evaluated.
const SCAN_STEPS: usize = 60;
/// Distance from the end of its range at which a parameter is considered to be at the end, as a
/// share of the range.
const RANGE_END_SHARE: f64 = 0.01;
/// Least reduction of the miss for which a change is reported, as a share of the miss.
const LEAST_REDUCTION: f64 = 0.02;

/// A target that the nearest design misses.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Missed {
    /// The target as text.
    pub target: String,
    /// Value of the nearest design.
    pub value: f64,
    /// The violated bound.
    pub bound: f64,
    /// Distance of the value from the bound, as a share of the bound. All misses are reported in
    /// this measure.
    pub by: f64,
}

/// A change of one parameter while all others stay fixed.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Move {
    /// The parameter.
    pub parameter: Parameter,
    /// Its value in the nearest design.
    pub from: f64,
    /// The value with the smallest miss.
    pub to: f64,
    /// Whether this value meets all targets.
    pub meets: bool,
    /// Targets that this value misses.
    pub missed: Vec<Missed>,
    /// The miss at this value, to compare changes: the root of the sum of squared logarithms.
    #[serde(skip)]
    pub(super) miss: f64,
    /// The limit of the request or the rule that forbids the change.
    pub forbidden_by: String,
}

/// The reason why no design meets a request.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Blocked {
    /// Targets that the nearest design misses.
    pub missed: Vec<Missed>,
    /// The blocking limit as text.
    pub limit: String,
    /// Single changes that would bring the nearest design closer to the request, the best first.
    pub moves: Vec<Move>,
    /// Changes of several parameters that together meet the request, if no single change does. The
    /// search for them uses the default ranges without limits of size, and any material. Empty if
    /// it finds none.
    pub together: Vec<Change>,
}

/// Most changes of one parameter that an explanation lists.
const MAX_MOVES: usize = 3;

impl Blocked {
    /// Returns the problem in a sentence: what the nearest design misses, and what blocks it.
    pub fn problem(&self) -> String {
        let problem = if self.missed.is_empty() {
            "no printable design within the limits meets the request; the nearest design outside of them does"
                .to_owned()
        } else {
            format!("no design meets the request; the nearest misses: {}", listed(&self.missed))
        };
        format!("{problem}; blocked by {}", self.limit)
    }

    /// Returns the changes that help, one sentence each.
    pub fn help(&self) -> Vec<String> {
        let mut help: Vec<String> = self.moves.iter().take(MAX_MOVES).map(advice).collect();
        if !self.together.is_empty() {
            let all: Vec<String> = self
                .together
                .iter()
                .map(|c| format!("{} from {:.2} to {:.2}", c.parameter.name(), c.from, c.to))
                .collect();
            help.push(format!("together these meet the request: {}", all.join(", ")));
        }
        help
    }
}

/// Lists how far each target is from its bound, as a share of the bound.
fn listed(missed: &[Missed]) -> String {
    let one =
        |m: &Missed| format!("{} is {:.3}, {:.1} % from {:.3}", m.target, m.value, 100.0 * m.by, m.bound);
    missed.iter().map(one).collect::<Vec<_>>().join("; ")
}

fn advice(m: &Move) -> String {
    let verb = if m.to > m.from { "raise" } else { "lower" };
    let effect =
        if m.meets { "meets the request".to_owned() } else { format!("leaves {}", listed(&m.missed)) };
    format!("{verb} {} from {:.2} to {:.2}: {effect} ({})", m.parameter.name(), m.from, m.to, m.forbidden_by)
}

/// The change of one parameter among several.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Change {
    /// The parameter.
    pub parameter: Parameter,
    /// Its value in the nearest design.
    pub from: f64,
    /// Its value in the design that meets the request.
    pub to: f64,
}

/// Returns the reason why `nearest` does not meet the request. `other_pins` is the smallest miss
/// with any number of pins, and that number.
pub(super) fn blocked(
    trial: &Trial<'_>,
    space: &Space,
    nearest: &Configuration,
    other_pins: Option<(usize, f64)>,
) -> Blocked {
    let miss = trial.shortfall(nearest).unwrap_or(f64::INFINITY);
    let missed = all_missed(trial, nearest);
    let mut moves: Vec<Move> = Parameter::ALL
        .iter()
        .filter_map(|p| best_move(trial, space, nearest, *p))
        .filter(|m| m.miss < (1.0 - LEAST_REDUCTION) * miss)
        .collect();
    // Changes that meet the request come first. Among these, parameters that the request lets vary
    // precede fixed ones, and small changes precede large ones. The other changes follow in the
    // order of their miss.
    let is_fixed = |m: &Move| {
        !space.varied.iter().any(|v| v.parameter == m.parameter) && !is_listed(trial.request, m.parameter)
    };
    let change = |m: &Move| libm::log(m.to / m.from).abs();
    sort_by_number(&mut moves, |m| if m.meets { change(m) } else { m.miss });
    sort_by_number(&mut moves, |m| match m.meets {
        true => f64::from(is_fixed(m)),
        false => 2.0,
    });
    let of_pins = |pins: usize, effect: &str| {
        let range = trial.request.limits.pins.map_or_else(String::new, |(a, b)| format!("{a}..{b}"));
        format!("limits.pins = {range}: with {} the request {effect}", pluralise(pins, "pin"))
    };
    let limit = match (moves.first(), other_pins) {
        (Some(first), _) if first.meets => first.forbidden_by.clone(),
        (_, Some((pins, other))) if other <= 0.0 => of_pins(pins, "can be met"),
        (None, Some((pins, other))) if other < (1.0 - LEAST_REDUCTION) * miss => {
            of_pins(pins, "is missed by less")
        }
        (Some(first), _) => format!("{}; no single parameter reaches the request", first.forbidden_by),
        (None, _) => "the physics: no varied parameter reduces the miss; relax a target".to_owned(),
    };
    let together = if moves.first().is_some_and(|m| m.meets) { Vec::new() } else { together(trial, nearest) };
    Blocked { missed, limit, moves, together }
}

/// Returns changes of all parameters that lead from the nearest design to one that meets the
/// request; empty if the search finds none.
fn together(trial: &Trial<'_>, nearest: &Configuration) -> Vec<Change> {
    let free = Request {
        limits: Limits {
            pins: None,
            ..if trial.has_soft_sizes() { trial.request.limits.clone() } else { Limits::default() }
        },
        materials: Materials::default(),
        vary: Vary {
            pattern: false,
            parameters: Parameter::ALL.iter().map(|p| extended_range(*p, nearest)).collect(),
        },
        ..trial.request.clone()
    };
    let trial = trial.with_request(&free);
    let space = Space::new(nearest, &free);
    let start = Place { material: 0, pins: nearest.layout.pins.clone(), at: space.base() };
    let there = refined(&trial, &space, &start, Aim::Nearest, TOGETHER_STEPS);
    let solution = space.configuration(there.material, &there.pins, &there.at);
    if trial.shortfall(&solution).is_none_or(|miss| miss > 0.0) {
        return Vec::new();
    }
    let change = |p: &Parameter| Change { parameter: *p, from: p.value(nearest), to: p.value(&solution) };
    Parameter::ALL.iter().map(change).filter(|c| libm::log(c.to / c.from).abs() > 0.005).collect()
}

/// Returns the targets that `configuration` misses, and the sizes where their limits are soft.
fn all_missed(trial: &Trial<'_>, configuration: &Configuration) -> Vec<Missed> {
    let values = trial.median(configuration).unwrap_or_default();
    let targets = trial.request.targets.iter().zip(&values).filter_map(|(t, v)| missed(t, *v, trial.range_n));
    let sizes = trial.missed_sizes(configuration).into_iter().map(|(field, value, bound)| Missed {
        target: format!("{field} = {bound} mm"),
        value,
        bound,
        by: (value - bound) / bound,
    });
    targets.chain(sizes).collect()
}

fn missed(target: &Target, value: f64, range_n: (f64, f64)) -> Option<Missed> {
    let of = |text: String, bound: f64| {
        Some(Missed { target: text, value, bound, by: (value - bound).abs() / bound })
    };
    if !target.requirement.is_met(value) {
        return of(target.to_string(), target.requirement.nearest_bound(value));
    }
    let (low, high) = range_n;
    let outside = target.quantity == crate::request::Quantity::Threshold && !(low..=high).contains(&value);
    if outside {
        return of(
            format!("{target} (within the loads, {low} to {high} N)"),
            if value < low { low } else { high },
        );
    }
    None
}

/// Returns the value of one parameter with the smallest miss, whether or not the request allows it.
fn best_move(
    trial: &Trial<'_>,
    space: &Space,
    nearest: &Configuration,
    parameter: Parameter,
) -> Option<Move> {
    let from = parameter.value(nearest);
    let (least, most) = parameter.hard_range();
    let (usual_least, usual_most) = parameter.default_range();
    let (low, high) = if trial.missed_sizes(nearest).is_empty() {
        (usual_least.min(from / 2.0).max(least), usual_most.max(from * 2.0).min(most))
    } else {
        (least, most)
    };
    let candidates = (0..=SCAN_STEPS).filter_map(|i| {
        let to = parameter.rounded(low * libm::pow(high / low, i as f64 / SCAN_STEPS as f64), (low, high));
        let mut moved = nearest.clone();
        parameter.set(&mut moved, to);
        if (to - from).abs() < 1e-9 || !is_predictable(&moved) {
            return None;
        }
        let miss = trial.shortfall(&moved)?;
        crate::design::is_accepted(moved.clone()).then_some((to, miss, moved))
    });
    // Among equal misses, such as zero, the smallest change is the best.
    let change = |to: f64| libm::log(to / from).abs();
    let mut candidates: Vec<_> = candidates.collect();
    candidates.sort_by(|a, b| a.1.total_cmp(&b.1).then_with(|| change(a.0).total_cmp(&change(b.0))));
    // A configuration that does not build is useless as advice.
    let (to, miss, moved) = candidates.into_iter().find(|(.., moved)| is_feasible(moved))?;
    let forbidden_by = forbidden(trial.request, space, parameter, from, to)
        .or_else(|| trial.broken_limit(&moved))
        .unwrap_or_else(|| "the search stopped early: increase --starts".to_owned());
    let missed = all_missed(trial, &moved);
    Some(Move { parameter, from, to, meets: miss == 0.0, missed, miss, forbidden_by })
}

/// Returns whether the request lists the materials that determine a parameter.
const fn is_listed(request: &Request, parameter: Parameter) -> bool {
    match parameter {
        Parameter::PinDiameterMm => !request.materials.pin_diameter_mm.is_empty(),
        Parameter::HardnessShoreA => !request.materials.hardness_shore_a.is_empty(),
        _ => false,
    }
}

/// Returns the field of the request that forbids a change; `None` if the request allows it.
fn forbidden(request: &Request, space: &Space, parameter: Parameter, from: f64, to: f64) -> Option<String> {
    let name = parameter.name();
    if let Some(v) = space.varied.iter().find(|v| v.parameter == parameter) {
        let slack = RANGE_END_SHARE * (v.to - v.from);
        return if to > v.to {
            Some(format!("vary.{name} ends at {}", v.to))
        } else if to < v.from {
            Some(format!("vary.{name} begins at {}", v.from))
        } else if from > v.to - slack && to > from || from < v.from + slack && to < from {
            Some(format!("vary.{name} = {}..{}", v.from, v.to))
        } else {
            None
        };
    }
    let list = match parameter {
        Parameter::PinDiameterMm => &request.materials.pin_diameter_mm,
        Parameter::HardnessShoreA => &request.materials.hardness_shore_a,
        _ => return Some(format!("{name} is fixed at {from:.2}, because it is not in vary")),
    };
    Some(if list.is_empty() {
        format!("{name} is fixed at {from:.2}, because it is not in vary")
    } else {
        format!("materials.{name} = {list:?}")
    })
}
