//! Why a request cannot be met: what the nearest design misses, what holds it there, and what would move it.

use serde::Serialize;

use super::candidate::Trial;
use super::refine::{Aim, Place, refined};
use super::relaxed::usual;
use super::space::{Space, is_predictable};
use crate::config::Configuration;
use crate::request::{Limits, Materials, Parameter, Request, Target, Vary};
use pinswitch_friction::{counted, sort_by_number};

/// Steps of the search over all parameters together.
const TOGETHER_STEPS: u64 = 400;
/// Values of a parameter that are tried, from one end of its range to the other.
const TRIED: usize = 60;
/// A parameter this near to the end of its range, as a share of it, lies at the end.
const AT_THE_END: f64 = 0.01;
/// Share of the miss that a move must take away to be worth naming.
const WORTH_NAMING: f64 = 0.02;

/// A target that the nearest design does not meet.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Missed {
    /// The target, in words.
    pub target: String,
    /// What the nearest design has.
    pub value: f64,
    /// The bound that it would have to reach.
    pub bound: f64,
    /// How far it lies from the bound, as a share of the bound: the one measure in which misses are stated.
    pub by: f64,
}

/// A change of one parameter, all others kept.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Move {
    /// The parameter.
    pub parameter: Parameter,
    /// Its value in the nearest design.
    pub from: f64,
    /// The value that comes nearest to the request.
    pub to: f64,
    /// Whether all targets are met there.
    pub meets: bool,
    /// What is missed there.
    pub missed: Vec<Missed>,
    /// How far all is missed there, to compare moves by: a root of summed squares of logarithms.
    #[serde(skip)]
    pub(super) miss: f64,
    /// What forbids it: a limit of the request, or a rule of what can be printed.
    pub forbidden_by: String,
}

/// Why a request cannot be met.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Blocked {
    /// Targets that the nearest design misses.
    pub missed: Vec<Missed>,
    /// The limit that blocks it, in words.
    pub limit: String,
    /// What would move the nearest design, the best first.
    pub moves: Vec<Move>,
    /// Where no single change meets the request: changes of several parameters that do so together, if there are any within
    /// what is usual, with no limits of size and any material.
    pub together: Vec<Change>,
}

/// A parameter that changes with others.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Change {
    /// The parameter.
    pub parameter: Parameter,
    /// Its value in the nearest design.
    pub from: f64,
    /// Its value in a design that meets the request.
    pub to: f64,
}

/// Why `nearest` is not what was asked. `other_pins` is the best miss with any number of pins.
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
        .filter(|m| m.miss < (1.0 - WORTH_NAMING) * miss)
        .collect();
    // What meets the request first: where the request itself sets the limit before what is merely held, then by how little it
    // changes. After that what comes nearest.
    let is_held = |m: &Move| {
        !space.varied.iter().any(|v| v.parameter == m.parameter) && !is_listed(trial.request, m.parameter)
    };
    let change = |m: &Move| libm::log(m.to / m.from).abs();
    sort_by_number(&mut moves, |m| if m.meets { change(m) } else { m.miss });
    sort_by_number(&mut moves, |m| match m.meets {
        true => f64::from(is_held(m)),
        false => 2.0,
    });
    let of_pins = |pins: usize, effect: &str| {
        let asked = trial.request.limits.pins.map_or_else(String::new, |(a, b)| format!("{a}..{b}"));
        format!("limits.pins = {asked}: with {} the request {effect}", counted(pins, "pin"))
    };
    let limit = match (moves.first(), other_pins) {
        (Some(first), _) if first.meets => first.forbidden_by.clone(),
        (_, Some((pins, other))) if other <= 0.0 => of_pins(pins, "can be met"),
        (None, Some((pins, other))) if other < (1.0 - WORTH_NAMING) * miss => {
            of_pins(pins, "is missed by less")
        }
        (Some(first), _) => format!("{}; no single parameter reaches the request", first.forbidden_by),
        (None, _) => {
            "the physics: no parameter that the program knows comes nearer; relax a target".to_owned()
        }
    };
    let together = if moves.first().is_some_and(|m| m.meets) { Vec::new() } else { together(trial, nearest) };
    Blocked { missed, limit, moves, together }
}

/// Changes of all parameters, from the nearest design, that meet the request; none if the search finds none.
fn together(trial: &Trial<'_>, nearest: &Configuration) -> Vec<Change> {
    let free = Request {
        limits: Limits {
            pins: None,
            ..if trial.has_soft_sizes() { trial.request.limits.clone() } else { Limits::default() }
        },
        materials: Materials::default(),
        vary: Vary {
            pattern: false,
            parameters: Parameter::ALL.iter().map(|p| usual(*p, nearest)).collect(),
        },
        ..trial.request.clone()
    };
    let trial = trial.with_ask(&free);
    let space = Space::new(nearest, &free);
    let start = Place { material: 0, pins: nearest.layout.pins.clone(), at: space.base() };
    let there = refined(&trial, &space, &start, Aim::Nearest, TOGETHER_STEPS);
    let found = space.configuration(there.material, &there.pins, &there.at);
    if trial.shortfall(&found).is_none_or(|miss| miss > 0.0) {
        return Vec::new();
    }
    let change = |p: &Parameter| Change { parameter: *p, from: p.value(nearest), to: p.value(&found) };
    Parameter::ALL.iter().map(change).filter(|c| libm::log(c.to / c.from).abs() > 0.005).collect()
}

/// Targets, and sizes where they are wishes, that `configuration` misses.
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

/// The value of one parameter that comes nearest to the request, whatever the request allows.
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
    let tried = (0..=TRIED).filter_map(|i| {
        let to = parameter.rounded(low * libm::pow(high / low, i as f64 / TRIED as f64), (low, high));
        let mut moved = nearest.clone();
        parameter.set(&mut moved, to);
        if (to - from).abs() < 1e-9 || !is_predictable(&moved) {
            return None;
        }
        let miss = trial.shortfall(&moved)?;
        // What no printer makes is no advice.
        let printable = crate::design::is_accepted(moved.clone());
        printable.then_some((to, miss, moved))
    });
    // Of those that meet it, the one that changes least; otherwise the one that comes nearest.
    let change = |to: f64| libm::log(to / from).abs();
    let (to, miss, moved) =
        tried.min_by(|a, b| a.1.total_cmp(&b.1).then_with(|| change(a.0).total_cmp(&change(b.0))))?;
    let forbidden_by = forbidden(trial.request, space, parameter, from, to)
        .or_else(|| trial.broken_limit(&moved))
        .unwrap_or_else(|| {
            "the search, which stopped near to it: request again with more --starts".to_owned()
        });
    let missed = all_missed(trial, &moved);
    Some(Move { parameter, from, to, meets: miss == 0.0, missed, miss, forbidden_by })
}

/// Whether the request names the materials that a parameter is taken from.
const fn is_listed(request: &Request, parameter: Parameter) -> bool {
    match parameter {
        Parameter::PinDiameterMm => !request.materials.pin_diameter_mm.is_empty(),
        Parameter::HardnessShoreA => !request.materials.hardness_shore_a.is_empty(),
        _ => false,
    }
}

/// What in the request keeps a parameter from going there.
fn forbidden(request: &Request, space: &Space, parameter: Parameter, from: f64, to: f64) -> Option<String> {
    let name = parameter.name();
    if let Some(v) = space.varied.iter().find(|v| v.parameter == parameter) {
        let slack = AT_THE_END * (v.to - v.from);
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
        _ => return Some(format!("{name} is held at {from:.2}: it is not in vary")),
    };
    Some(if list.is_empty() {
        format!("{name} is held at {from:.2}: it is not in vary")
    } else {
        format!("materials.{name} = {list:?}")
    })
}
