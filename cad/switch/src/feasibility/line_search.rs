//! Line searches: the value of one parameter nearest to the present one that satisfies a constraint.

use toml_edit::{Array, Value};

use crate::config::Configuration;
use crate::config::parameter::{Parameter, number};
use crate::design::rules::Direction;

/// Steps per unit of a number. The search considers only values that a message can show.
const STEPS_PER_UNIT: f64 = 1e3;
/// Rounding error of a number, in steps: 0.7 computed as 0.700...1 is still 0.7.
const STEP_ROUNDING: f64 = 1e-6;

/// The effort of a line search.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Effort {
    /// Values probed between the present one and the end of the line, before the bisection.
    probes: i64,
    /// Distance to the nearest value at which the bisection ends, in steps.
    resolution: i64,
    /// Whether probes are denser near the present value.
    is_denser_nearby: bool,
}

impl Effort {
    /// For constraints that take microseconds.
    pub(crate) const THOROUGH: Self = Self { probes: 32, resolution: 1, is_denser_nearby: false };
    /// For constraints that build parts.
    pub(crate) const MODERATE: Self = Self { probes: 6, resolution: 1, is_denser_nearby: true };
    /// For constraints that build parts, if a value close to the nearest one is sufficient.
    pub(crate) const QUICK: Self = Self { probes: 6, resolution: 20, is_denser_nearby: true };
    /// For many parameters at once.
    pub(crate) const COARSE: Self = Self { probes: 4, resolution: 100, is_denser_nearby: true };

    /// Steps from 0 to `length` at which a line is probed, ascending.
    fn steps(self, length: i64) -> impl Iterator<Item = i64> {
        let Self { probes, is_denser_nearby, .. } = self;
        (1..=probes).map(move |i| match is_denser_nearby {
            true => length * i * i / (probes * probes),
            false => length * i / probes,
        })
    }
}

/// Returns the step nearest to `from` with a value, out of the steps from `from`, which has none, to `to`. Probes the
/// line outwards, then bisects; a step between two probes without a value can be missed.
pub(crate) fn nearest_step<T>(
    (from, to): (i64, i64),
    extra: Option<i64>,
    effort: Effort,
    mut value_at: impl FnMut(i64) -> Option<T>,
) -> Option<(i64, T)> {
    let sign = (to - from).signum();
    let mut steps: Vec<i64> =
        effort.steps((to - from).abs()).chain(extra.map(|e| (e - from) * sign)).collect();
    steps.retain(|step| (1..=(to - from).abs()).contains(step));
    steps.sort_unstable();
    steps.dedup();
    let mut bad = from;
    let (mut good, mut value) = steps.into_iter().map(|step| from + sign * step).find_map(|step| {
        let value = value_at(step).map(|value| (step, value));
        if value.is_none() {
            bad = step;
        }
        value
    })?;
    while (good - bad).abs() > effort.resolution {
        let middle = i64::midpoint(good, bad);
        match value_at(middle) {
            Some(nearer) => (good, value) = (middle, nearer),
            None => bad = middle,
        }
    }
    Some((good, value))
}

/// The values of one parameter in one direction from the present one, which is not among them.
#[derive(Clone, Debug)]
pub(crate) struct Line {
    path: String,
    values: LineValues,
}

#[derive(Clone, Debug)]
enum LineValues {
    /// Multiples of the shown step from `from` to `to`, followed by `end` if it is not a multiple.
    Grid { from: i64, to: i64, is_whole: bool, default: Option<i64>, end: Option<Value> },
    /// Listed values, the nearest first.
    Listed(Vec<Value>),
}

impl Line {
    /// Returns the line of `direction` from the value in `c`; `None` without any value in that direction.
    pub(crate) fn along(direction: Direction, c: &Configuration) -> Option<Self> {
        let parameter = direction.parameter()?;
        let now = (parameter.get)(c);
        match direction {
            Direction::Lower(_) => Self::below(parameter, c),
            Direction::Raise(_) => Self::above(parameter, c),
            Direction::Restore(_) => {
                let default = (parameter.get)(&Configuration::default());
                let is_above = number(&now)? > number(&default)?;
                is_above.then(|| Self::towards(parameter, c, &default)).flatten()
            }
            Direction::OneOf(_, sizes) => {
                let now = number(&now)?;
                let mut sizes: Vec<f64> = sizes.iter().copied().filter(|size| *size != now).collect();
                sizes.sort_by(|a, b| (a - now).abs().total_cmp(&(b - now).abs()));
                Some(Self::listed(parameter, sizes.into_iter().map(Value::from).collect()))
            }
            Direction::Set(_, value) => {
                let value = value.parse::<Value>().ok()?;
                Some(Self::listed(parameter, vec![value]))
            }
        }
    }

    /// Returns the line from the value in `c` to the least value of the parameter.
    pub(crate) fn below(parameter: &Parameter<Configuration>, c: &Configuration) -> Option<Self> {
        Self::grid(parameter, &(parameter.get)(c), (parameter.ends)()?[0])
    }

    /// Returns the line from the value in `c` to the greatest value of the parameter.
    pub(crate) fn above(parameter: &Parameter<Configuration>, c: &Configuration) -> Option<Self> {
        Self::grid(parameter, &(parameter.get)(c), (parameter.ends)()?[1])
    }

    /// Returns the line from the value in `c` to `end`, both of the same type; `None` if they are equal. Lists are
    /// repaired or emptied, choices and texts replaced.
    pub(crate) fn towards(
        parameter: &Parameter<Configuration>,
        c: &Configuration,
        end: &Value,
    ) -> Option<Self> {
        let now = (parameter.get)(c);
        if now.to_string() == end.to_string() {
            return None;
        }
        let is_exact = |line: &Self| matches!(&line.values, LineValues::Grid { from, to, .. } if from == to);
        match (number(&now), number(end), now.as_array()) {
            (Some(_), Some(to), _) => {
                let line = Self::grid(parameter, &now, to).filter(|line| !is_exact(line));
                let mut line = line.unwrap_or_else(|| Self::listed(parameter, Vec::new()));
                match &mut line.values {
                    LineValues::Grid { end: last, .. } => *last = Some(end.clone()),
                    LineValues::Listed(values) => values.push(end.clone()),
                }
                Some(line)
            }
            (_, _, Some(items)) => {
                let values = repaired_lists(items, c.segment.grooves).into_iter().chain([end.clone()]);
                Some(Self::listed(parameter, values.collect()))
            }
            _ => Some(Self::listed(parameter, vec![end.clone()])),
        }
    }

    /// Returns the line over the values of a choice other than the present one; empty for any other parameter.
    pub(crate) fn choices(parameter: &Parameter<Configuration>, c: &Configuration) -> Self {
        let now = (parameter.get)(c).to_string();
        let mut values = (parameter.choices)();
        values.retain(|value| value.to_string() != now);
        Self::listed(parameter, values)
    }

    #[allow(clippy::cast_possible_truncation)]
    fn grid(parameter: &Parameter<Configuration>, now: &Value, end: f64) -> Option<Self> {
        let is_whole = now.is_integer();
        let default = number(&(parameter.get)(&Configuration::default()));
        let now = number(now).filter(|now| now.is_finite())?;
        let scale = if is_whole { 1.0 } else { STEPS_PER_UNIT };
        let up = |x: f64| (x * scale - STEP_ROUNDING).ceil() as i64;
        let down = |x: f64| (x * scale + STEP_ROUNDING).floor() as i64;
        let is_upwards = end > now;
        let (from, to) = if is_upwards { (down(now), down(end)) } else { (up(now), up(end)) };
        let default = default.map(|x| if is_upwards { down(x) } else { up(x) });
        let values = LineValues::Grid { from, to, is_whole, default, end: None };
        (from != to).then(|| Self { path: parameter.path(), values })
    }

    fn listed(parameter: &Parameter<Configuration>, values: Vec<Value>) -> Self {
        Self { path: parameter.path(), values: LineValues::Listed(values) }
    }

    /// Returns the path of the parameter.
    pub(crate) fn field(&self) -> &str {
        &self.path
    }

    /// Returns `c` with the value nearest to the start of the line with which it `fits`; `None` if there is none.
    pub(crate) fn nearest(
        &self,
        c: &Configuration,
        fits: &dyn Fn(&Configuration) -> bool,
        effort: Effort,
    ) -> Option<Configuration> {
        let at = |value: &Value| self.with_value(c, value).filter(|changed| fits(changed));
        match &self.values {
            LineValues::Listed(values) => values.iter().find_map(at),
            LineValues::Grid { from, to, is_whole, default, end } => {
                let effort = if *is_whole { Effort { resolution: 1, ..effort } } else { effort };
                let value_at = |step| at(&grid_value(step, *is_whole));
                let found = nearest_step((*from, *to), *default, effort, value_at);
                found.map(|(_, changed)| changed).or_else(|| end.as_ref().and_then(at))
            }
        }
    }

    /// Returns `c` with values spread over the line, the nearest first.
    pub(crate) fn samples(&self, c: &Configuration) -> Vec<Configuration> {
        /// Positions on the line, in sixteenths of its length.
        const SIXTEENTHS: [i64; 5] = [1, 2, 4, 8, 16];
        match &self.values {
            LineValues::Listed(values) => values.iter().filter_map(|v| self.with_value(c, v)).collect(),
            LineValues::Grid { from, to, is_whole, default, end } => {
                let mut steps: Vec<i64> = SIXTEENTHS.iter().map(|s| from + (to - from) * s / 16).collect();
                steps.extend(default.filter(|d| (d - from).signum() == (to - from).signum()));
                steps.sort_unstable_by_key(|step| (step - from).abs());
                steps.dedup();
                steps.retain(|step| step != from);
                let values = steps.into_iter().map(|step| grid_value(step, *is_whole)).chain(end.clone());
                values.filter_map(|value| self.with_value(c, &value)).collect()
            }
        }
    }

    fn with_value(&self, c: &Configuration, value: &Value) -> Option<Configuration> {
        let parameter = Configuration::PARAMETERS.iter().find(|p| p.path() == self.path)?;
        let mut changed = c.clone();
        (parameter.set)(&mut changed, value).ok()?;
        Some(changed)
    }
}

/// Returns the value of a step.
#[allow(clippy::cast_precision_loss)]
fn grid_value(step: i64, is_whole: bool) -> Value {
    if is_whole { Value::from(step) } else { Value::from(step as f64 / STEPS_PER_UNIT) }
}

/// Returns two lists of groove numbers similar to `items`, without repeated items. The first moves
/// items outside 1 to `grooves` to the nearest free groove, and the second removes them.
fn repaired_lists(items: &Array, grooves: usize) -> [Value; 2] {
    let most = i64::try_from(grooves).unwrap_or(i64::MAX);
    let mut kept: Vec<i64> = Vec::new();
    let mut outside = Vec::new();
    for item in items.iter().filter_map(Value::as_integer) {
        match (1..=most).contains(&item) {
            true if kept.contains(&item) => {}
            true => kept.push(item),
            false => outside.push(item),
        }
    }
    let mut moved = kept.clone();
    for item in outside {
        let free = (1..=most).filter(|groove| !moved.contains(groove));
        moved.extend(free.min_by_key(|groove| groove.abs_diff(item)));
    }
    [moved, kept].map(|list| Value::from(list.into_iter().collect::<Array>()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::assign;
    use proptest::prelude::*;

    #[test]
    fn a_line_ends_at_the_range() {
        let c = Configuration::default();
        let widest = Line::along(Direction::Raise("shell.width_mm"), &c).unwrap();
        assert_eq!(
            widest.nearest(&c, &|c| c.shell.width_mm >= 17.2341, Effort::THOROUGH).unwrap().shell.width_mm,
            17.235
        );
        assert_eq!(widest.nearest(&c, &|c| c.shell.width_mm > 100.0, Effort::THOROUGH), None);
        let fewest = Line::along(Direction::Lower("segment.grooves"), &c).unwrap();
        assert_eq!(
            fewest.nearest(&c, &|c| c.segment.grooves <= 4, Effort::QUICK).unwrap().segment.grooves,
            4
        );
        assert!(Line::along(Direction::Lower("print.elephant_foot_mm"), &c).is_none());
    }

    #[test]
    fn restoring_stops_at_the_default() {
        let mut c = Configuration::default();
        assert!(Line::along(Direction::Restore("print.least_wall_mm"), &c).is_none());
        assign(&mut c, "print.least_wall_mm=1.2").unwrap();
        let line = Line::along(Direction::Restore("print.least_wall_mm"), &c).unwrap();
        let fits = |most: f64| move |c: &Configuration| c.print.least_wall_mm <= most;
        let nearest = line.nearest(&c, &fits(0.8), Effort::THOROUGH).unwrap();
        assert_eq!(nearest.print.least_wall_mm, 0.8);
        assert_eq!(line.nearest(&c, &fits(0.4), Effort::THOROUGH), None);
    }

    /// Defaults that are not multiples of the shown step are reached exactly.
    #[test]
    fn the_end_of_a_line_is_exact() {
        let default = Configuration::default();
        let mut c = default.clone();
        assign(&mut c, "friction.load_min_n=3.076").unwrap();
        let parameter = Direction::Lower("friction.load_min_n").parameter().unwrap();
        let line = Line::towards(parameter, &c, &(parameter.get)(&default)).unwrap();
        assert_eq!(line.nearest(&c, &|c| *c == default, Effort::THOROUGH), Some(default));
    }

    #[test]
    fn pins_move_to_free_grooves() {
        let lists = |pins: &[i64]| repaired_lists(&pins.iter().copied().collect(), 15).map(|l| l.to_string());
        assert_eq!(lists(&[5, 8, 15, 99]), ["[5, 8, 15, 14]", "[5, 8, 15]"]);
        assert_eq!(lists(&[5, 5]), ["[5]", "[5]"]);
    }

    proptest! {
        /// The resulting step satisfies the constraint, and the step before it does not.
        #[test]
        fn a_step_function_is_solved(from in -1000i64..1000, length in 1i64..5000, share in 0.0..1.0f64, up in any::<bool>()) {
            let sign = if up { 1 } else { -1 };
            let edge = from + sign * ((length as f64 * share) as i64 + 1).min(length);
            let fits = |step: i64| ((step - edge) * sign >= 0).then_some(());
            let (found, ()) = nearest_step((from, from + sign * length), None, Effort::THOROUGH, fits).unwrap();
            prop_assert_eq!(found, edge);
        }
    }
}
