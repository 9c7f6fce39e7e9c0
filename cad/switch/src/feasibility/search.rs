//! The search for proposals: single changes, pairs of changes, and as few returns to defaults as suffice.

use super::distance::{Distance, differing};
use super::line_search::{Effort, Line};
use super::problem::{IsNew, Problem};
use crate::config::Configuration;
use crate::config::parameter::{Parameter, number};
use crate::design::{Dimensions, is_accepted};

/// Largest number of alternatives in a message: users would not read more.
const MAX_ALTERNATIVES: usize = 4;
/// Largest number of candidates of one line or strategy that are built.
const MAX_BUILDS: usize = 6;
/// Lines whose pairs are searched; the first are the most natural.
const MAX_PAIRED_LINES: usize = 12;
/// Largest number of pairs that satisfy the rules and are checked for obstacles, the nearest first.
const MAX_CHECKED_PAIRS: usize = 16;
/// Ratio of two numbers up to which a change is small.
const SMALL_RATIO: f64 = 2.0;
/// Least number of screws to assemble a switch.
const LEAST_SCREWS: usize = 2;

/// Returns feasible configurations near the start of `problem`, each verified by building it: all alternatives that change
/// one parameter, the most natural first; where there is none, the nearest one that changes several. Where all of them change
/// what the user chose, a pair of numbers that keeps it comes first.
pub(super) fn proposals(problem: &Problem<'_>) -> Vec<Configuration> {
    let mut found = singles(problem, &problem.lines);
    if found.is_empty() {
        let lines: Vec<Line> = problem.departing().into_iter().flat_map(|p| lines_of(problem, p)).collect();
        found = singles(problem, &lines);
    }
    if found.is_empty() {
        found.extend(verified(problem, combined));
    } else if !found.iter().any(|c| keeps_choices(problem.start, c)) {
        // What the user chose, such as a joint, is kept where two numbers are enough.
        let pair = verified(problem, |problem| paired(problem, numbers(problem)));
        found.splice(0..0, pair);
        found.truncate(MAX_ALTERNATIVES);
    }
    found
}

/// Whether only numbers and lists differ, so that the kinds and names that the user chose are unchanged.
fn keeps_choices(start: &Configuration, c: &Configuration) -> bool {
    differing(start, c).all(is_numeric)
}

fn is_numeric(parameter: &Parameter<Configuration>) -> bool {
    let value = (parameter.get)(&Configuration::default());
    number(&value).is_some() || value.is_array()
}

/// The lines of numbers and lists.
fn numbers(problem: &Problem<'_>) -> Vec<Line> {
    let is_numeric =
        |line: &&Line| Configuration::PARAMETERS.iter().any(|p| p.path() == line.field() && is_numeric(p));
    problem.lines.iter().filter(is_numeric).cloned().collect()
}

/// All lines of a parameter that departs from its default: back to it, and in every other direction.
fn lines_of(problem: &Problem<'_>, parameter: &'static Parameter<Configuration>) -> Vec<Line> {
    let c = problem.start;
    let both = [Line::below(parameter, c), Line::above(parameter, c)];
    problem
        .back(parameter)
        .into_iter()
        .chain(both.into_iter().flatten())
        .chain([Line::choices(parameter, c)])
        .collect()
}

/// The nearest verified configurations on the first lines that have one.
fn singles(problem: &Problem<'_>, lines: &[Line]) -> Vec<Configuration> {
    let mut lines: Vec<&Line> = lines.iter().collect();
    lines.sort_by_key(|line| rank(problem, line));
    let mut found: Vec<Configuration> = Vec::new();
    for line in lines {
        if found.len() == MAX_ALTERNATIVES {
            break;
        }
        let next = verified(problem, |problem| nearest(problem, line));
        found.extend(next.filter(|c| !found.contains(c)));
    }
    found
}

/// The nearest configuration on a line that satisfies the constraints known so far.
fn nearest(problem: &Problem<'_>, line: &Line) -> Option<Configuration> {
    let effort = if problem.has_obstacles() { Effort::MODERATE } else { Effort::THOROUGH };
    let nearest = line.nearest(problem.start, &|c| problem.admits(c), effort)?;
    if !Dimensions::new(nearest.clone()).lacks_recesses() {
        return Some(nearest);
    }
    // Prefers a value with space for all hardware, if the change is small. Otherwise the set would
    // have no nut traps.
    let has_recesses = |c: &Configuration| !Dimensions::new(c.clone()).lacks_recesses() && problem.admits(c);
    let complete = line.nearest(problem.start, &has_recesses, effort);
    Some(complete.filter(|c| is_small_change(problem.start, c)).unwrap_or(nearest))
}

/// The order of alternatives: the field to blame, then values that the user set, then defaults.
fn rank(problem: &Problem<'_>, line: &Line) -> usize {
    if line.field() == problem.subject {
        return 0;
    }
    let default = Configuration::default();
    1 + usize::from(problem.start.shown(line.field()) == default.shown(line.field()))
}

/// Returns the first configuration of a search that builds. Each one that does not build adds a
/// constraint to the search.
fn verified(
    problem: &Problem<'_>,
    mut find: impl FnMut(&Problem<'_>) -> Option<Configuration>,
) -> Option<Configuration> {
    for _ in 0..MAX_BUILDS {
        let candidate = find(problem)?;
        match problem.verify(&candidate) {
            Ok(()) => return Some(candidate),
            Err(IsNew(false)) => return None,
            Err(IsNew(true)) => {}
        }
    }
    None
}

/// The nearest configuration that changes several parameters.
fn combined(problem: &Problem<'_>) -> Option<Configuration> {
    let restored = restored(problem);
    let changed = restored.as_ref().map_or_else(Vec::new, |c| differing(problem.start, c).collect());
    let mut lines: Vec<Line> = changed.into_iter().flat_map(|p| problem.back(p)).collect();
    lines.extend(problem.lines.iter().cloned());
    let pair = paired(problem, lines);
    let nearer = |c: &Configuration| Distance::new(problem.start, c);
    match (restored, pair) {
        (Some(restored), Some(pair)) => Some(if nearer(&pair) < nearer(&restored) { pair } else { restored }),
        (restored, pair) => restored.or(pair),
    }
}

/// Returns the configuration with the fewest parameters changed towards their defaults, each as
/// little as possible. Starts from the default configuration, which is feasible, and restores the
/// values of the start in blocks, which are halved where they are infeasible.
fn restored(problem: &Problem<'_>) -> Option<Configuration> {
    let mut c = problem.default();
    if !problem.admits(&c) {
        return None;
    }
    take_over(problem, &mut c, &problem.departing());
    // A value may have become feasible with a later one.
    loop {
        let left: Vec<_> = differing(problem.start, &c).collect();
        left.iter().for_each(|parameter| take_over(problem, &mut c, std::slice::from_ref(parameter)));
        if differing(problem.start, &c).count() == left.len() {
            break;
        }
    }
    let effort = if problem.has_obstacles() { Effort::COARSE } else { Effort::THOROUGH };
    for parameter in problem.departing() {
        let end = (parameter.get)(&c);
        if let Some(line) = Line::towards(parameter, problem.start, &end) {
            c = line.nearest(&c, &|c| problem.admits(c), effort).unwrap_or(c);
        }
    }
    Some(c)
}

/// Sets `parameters` of `c` to their values at the start, as many as stay feasible.
fn take_over(problem: &Problem<'_>, c: &mut Configuration, parameters: &[&'static Parameter<Configuration>]) {
    let mut changed = c.clone();
    for parameter in parameters {
        // The value comes from a configuration, and is accepted.
        let _ = (parameter.set)(&mut changed, &(parameter.get)(problem.start));
    }
    if problem.admits(&changed) {
        *c = changed;
    } else if parameters.len() > 1 {
        let (first, second) = parameters.split_at(parameters.len() / 2);
        take_over(problem, c, first);
        take_over(problem, c, second);
    }
}

/// Returns the nearest configuration that changes two parameters along the first of `lines`. The search uses only the rules,
/// since there are too many pairs to build parts for each.
fn paired(problem: &Problem<'_>, mut lines: Vec<Line>) -> Option<Configuration> {
    let start = problem.start;
    lines.truncate(MAX_PAIRED_LINES);
    let satisfies_rules = |c: &Configuration| is_accepted(c.clone());
    let mut pairs: Vec<(Distance, Configuration, [&Line; 2])> = Vec::new();
    for first in &lines {
        for sample in first.samples(start) {
            for second in lines.iter().filter(|second| second.field() != first.field()) {
                if let Some(c) = second.nearest(&sample, &satisfies_rules, Effort::QUICK) {
                    pairs.push((Distance::new(start, &c), c, [first, second]));
                }
            }
        }
    }
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (_, pair, [first, second]) =
        pairs.into_iter().take(MAX_CHECKED_PAIRS).find(|(_, c, _)| problem.admits(c))?;
    // Minimises each change while the other is fixed.
    let refined = [first, second, first]
        .into_iter()
        .fold(pair.clone(), |c, line| line.nearest(&c, &satisfies_rules, Effort::THOROUGH).unwrap_or(c));
    Some(if problem.admits(&refined) { refined } else { pair })
}

/// Returns whether all changed numbers are within a factor of two, and enough screws remain for the
/// assembly.
pub(crate) fn is_small_change(start: &Configuration, c: &Configuration) -> bool {
    let is_small = |p: &'static Parameter<Configuration>| match (number(&(p.get)(start)), number(&(p.get)(c)))
    {
        (Some(from), Some(to)) if from != 0.0 => (1.0 / SMALL_RATIO..=SMALL_RATIO).contains(&(to / from)),
        _ => true,
    };
    let loses_screws = c.fasteners.count < LEAST_SCREWS && c.fasteners.count < start.fasteners.count;
    !loses_screws && differing(start, c).all(is_small)
}
