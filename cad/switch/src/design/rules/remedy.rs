//! What to change where a rule is broken: every change is tried before it is named.

use toml_edit::Value;

use pinswitch_friction::sort_by_number;

use super::{Assessment, Inspection, Rule, Severity, rules};
use crate::config::parameter::Parameter;
use crate::config::{ConfigError, Configuration};
use crate::design::Dimensions;

/// How thoroughly a change is looked for.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Effort {
    /// Values between the present one and the end of its range at which it is tried.
    tried: i64,
    /// How near to the least change it comes, in the steps in which numbers are shown.
    near: i64,
}

impl Effort {
    /// Where the design is refused, and nothing else has to be made.
    pub(crate) const THOROUGH: Self = Self { tried: 32, near: 1 };
    /// Where parts are made for each value, while somebody waits.
    pub(crate) const QUICK: Self = Self { tried: 6, near: 20 };
}

/// The step in which numbers are shown, as a share of one: what is tried is what is shown.
const STEPS_PER_UNIT: f64 = 1e3;
/// Changes that one error names: more would not be read.
const NAMED: usize = 4;

/// A change that may mend what a rule found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Change {
    /// A smaller value of this parameter.
    Lower(&'static str),
    /// A larger value.
    Raise(&'static str),
    /// A smaller value where it is above its default: of what nobody would lower who had not raised it.
    Ease(&'static str),
    /// The nearest of these values on either side: of what is sold in sizes.
    OneOf(&'static str, &'static [f64]),
    /// This value, as TOML.
    Set(&'static str, &'static str),
    /// What only words can say.
    Say(&'static str),
}

impl Change {
    const fn field(self) -> Option<&'static str> {
        match self {
            Self::Lower(field)
            | Self::Raise(field)
            | Self::Ease(field)
            | Self::OneOf(field, _)
            | Self::Set(field, _) => Some(field),
            Self::Say(_) => None,
        }
    }

    /// Whether values are tried upwards from the present one; `None` where there is nothing to walk along.
    fn is_upwards(self, c: &Configuration, parameter: &Parameter<Configuration>) -> Option<bool> {
        match self {
            Self::Lower(_) => Some(false),
            Self::Raise(_) => Some(true),
            Self::Ease(_) => {
                let default = number(&(parameter.get)(&Configuration::default()))?;
                (number(&(parameter.get)(c))? > default).then_some(false)
            }
            Self::OneOf(..) | Self::Set(..) | Self::Say(_) => None,
        }
    }
}

/// What to do about a broken rule.
#[derive(Clone, Debug, PartialEq)]
pub enum Remedy {
    /// In words.
    Words(String),
    /// Changes to be tried, the most natural first.
    Changes(&'static [Change]),
}

/// A change that was tried: its field, and what to do with it.
#[derive(Clone, Debug, PartialEq)]
struct Tried {
    field: Option<&'static str>,
    /// `lower`, `raise` or `set`; all of it, for what only words can say.
    verb: &'static str,
    /// The value, with the word before it.
    value: String,
    changed: Configuration,
}

impl Tried {
    fn words(&self, subject: &str) -> String {
        match self.field {
            None => self.verb.to_owned(),
            Some(field) => {
                let name = if field == subject { "it" } else { field };
                format!("{} {name} {}", self.verb, self.value)
            }
        }
    }
}

/// The error of `rule`, which `dimensions` break with this `problem`.
pub(super) fn error(rule: &Rule, dimensions: &Dimensions, problem: String, remedy: Remedy) -> ConfigError {
    let c = dimensions.configuration();
    let (field, remedy, changes) = match remedy {
        Remedy::Words(words) => (rule.field, words, Vec::new()),
        Remedy::Changes(changes) => advice(rule, c, changes),
    };
    ConfigError { field: field.to_owned(), value: c.shown(field), problem, remedy, changes, place: None }
}

/// The values that changes made one after another have set.
fn settings(changes: &[Tried]) -> Vec<(String, String)> {
    let set = |t: &Tried| {
        let field = t.field?;
        let parameter = Configuration::PARAMETERS.iter().find(|p| p.path() == field)?;
        Some((field.to_owned(), (parameter.get)(&t.changed).to_string()))
    };
    changes.iter().filter_map(set).collect()
}

/// The field to blame, and what to change, in words and as the values of the first way.
fn advice(
    rule: &Rule,
    c: &Configuration,
    changes: &[Change],
) -> (&'static str, String, Vec<(String, String)>) {
    // What keeps all that is kept now: a remedy that breaks another rule leads in circles.
    let before = Dimensions::new(c.clone());
    let kept: Vec<_> = rules().filter(|r| r.severity == Severity::Error && keeps(r, &before)).collect();
    let breaks_none = |d: &Dimensions| keeps(rule, d) && kept.iter().all(|r| keeps(r, d));
    let of_rule_alone = |d: &Dimensions| keeps(rule, d);
    let single = |fits: &dyn Fn(&Dimensions) -> bool| -> Vec<Tried> {
        changes.iter().filter_map(|change| tried(*change, c, fits)).collect()
    };
    // Best is what mends all that is broken: other rules may be broken by the same value.
    let all: Vec<_> = rules().filter(|r| r.severity == Severity::Error).collect();
    let mends_all = |d: &Dimensions| all.iter().all(|r| keeps(r, d));
    let mut found = single(&mends_all);
    // Better still is what leaves room for all hardware, if it is not far: else the set is made without its nut traps, and the
    // next remedy is about them.
    let has_all = |d: &Dimensions| !d.has_lost_hardware() && mends_all(d);
    for fuller in single(&has_all) {
        let is_near =
            settings(std::slice::from_ref(&fuller)).iter().all(|(field, value)| is_moderate(c, field, value));
        let plain = found.iter_mut().find(|t| t.field == fuller.field && t.verb == fuller.verb);
        if let Some(plain) = plain.filter(|_| is_near) {
            *plain = fuller;
        }
    }
    if found.is_empty() {
        found = single(&breaks_none);
    }
    if found.is_empty() {
        found = together(changes, c, &breaks_none);
        if !found.is_empty() {
            let words: Vec<_> = found.iter().map(|t| t.words(rule.field)).collect();
            let words = format!("no single value mends it: {}", words.join(", and "));
            return (rule.field, words, settings(&found));
        }
        found = single(&of_rule_alone);
    }
    if found.is_empty() {
        let fields: Vec<_> = changes.iter().filter_map(|change| change.field()).take(NAMED).collect();
        let remedy = format!(
            "no single value mends it: bring {} nearer to their defaults, which `pinswitch init reference` shows",
            fields.join(", ")
        );
        return (rule.field, remedy, Vec::new());
    }
    let subject = subject(rule, c, &found);
    // What is spoken of comes first, then what somebody set, which is more likely wrong than a default.
    sort_by_number(&mut found, |t| match t.field {
        Some(field) if field == subject => 0.0,
        Some(field) if departs(c, field) => 1.0,
        _ => 2.0,
    });
    found.truncate(NAMED);
    let first = found.iter().find(|t| t.field.is_some()).map(std::slice::from_ref).unwrap_or_default();
    let settings = settings(first);
    (subject, alternatives(found.iter().map(|t| t.words(subject)).collect()), settings)
}

/// What `changes` mend that no rule knows, each by the value nearest to the present one that `fits`: in words, with `field`
/// as what is spoken of, and as the values of the first way. No words where none of them does.
pub(crate) fn ways_out(
    field: &str,
    c: &Configuration,
    changes: &[Change],
    fits: &dyn Fn(&Configuration) -> bool,
    effort: Effort,
) -> (String, Vec<(String, String)>) {
    let fits = |d: &Dimensions| fits(d.configuration());
    let mut found: Vec<Tried> =
        changes.iter().filter_map(|change| tried_with(*change, c, &fits, effort)).collect();
    found.truncate(NAMED);
    let first = found.first().map(std::slice::from_ref).unwrap_or_default();
    let settings = settings(first);
    (alternatives(found.iter().map(|t| t.words(field)).collect()), settings)
}

/// A change that helps, in words.
pub(crate) struct WayOut {
    pub(crate) words: String,
    /// Whether the value is within a factor of two of the present one.
    pub(crate) is_moderate: bool,
}

/// The first of `changes` that `fits`: the first moderate one, if there is one. `None` where none does.
pub(crate) fn way_out(
    c: &Configuration,
    changes: &[Change],
    fits: &dyn Fn(&Configuration) -> bool,
    effort: Effort,
) -> Option<WayOut> {
    let mut large = None;
    for change in changes {
        let (words, set) = ways_out("", c, std::slice::from_ref(change), fits, effort);
        match set.first() {
            Some((field, value)) if is_moderate(c, field, value) => {
                return Some(WayOut { words, is_moderate: true });
            }
            Some(_) => large = large.or(Some(WayOut { words, is_moderate: false })),
            None => {}
        }
    }
    large
}

/// Whether a value is within a factor of two of the present one, and no set loses its screws for it.
fn is_moderate(c: &Configuration, field: &str, value: &str) -> bool {
    if field == "fasteners.count" && value.parse::<f64>().is_ok_and(|count| count < 2.0) {
        return false;
    }
    let now = c.shown(field).and_then(|shown| shown.parse::<f64>().ok());
    match (now, value.parse::<f64>()) {
        (Some(now), Ok(value)) => now == 0.0 || (0.5..=2.0).contains(&(value / now)),
        _ => true,
    }
}

/// The rule's own field, unless it has its default and another that was set can mend it: that one stands in a file.
fn subject(rule: &Rule, c: &Configuration, found: &[Tried]) -> &'static str {
    if departs(c, rule.field) {
        return rule.field;
    }
    let set =
        found.iter().filter(|t| t.verb != "set").filter_map(|t| t.field).find(|field| departs(c, field));
    set.unwrap_or(rule.field)
}

fn departs(c: &Configuration, field: &str) -> bool {
    c.shown(field) != Configuration::default().shown(field)
}

pub(super) fn keeps(rule: &Rule, dimensions: &Dimensions) -> bool {
    let inspection = Inspection { dimensions, widest_bridge_mm: None };
    !matches!((rule.assess)(&inspection), Assessment::Broken { .. })
}

/// The least change of this kind that `fits`; `None` if none does within the field's range.
fn tried(change: Change, c: &Configuration, fits: &dyn Fn(&Dimensions) -> bool) -> Option<Tried> {
    tried_with(change, c, fits, Effort::THOROUGH)
}

fn tried_with(
    change: Change,
    c: &Configuration,
    fits: &dyn Fn(&Dimensions) -> bool,
    effort: Effort,
) -> Option<Tried> {
    let Some(field) = change.field() else {
        let Change::Say(words) = change else { return None };
        return Some(Tried { field: None, verb: words, value: String::new(), changed: c.clone() });
    };
    let parameter = Configuration::PARAMETERS.iter().find(|p| p.path() == field)?;
    if let Change::Set(_, value) = change {
        let changed = Dimensions::new(with(c, parameter, value)?);
        let is_fine = fits(&changed);
        let (value, changed) = (format!("= {value}"), changed.configuration().clone());
        return is_fine.then_some(Tried { field: Some(field), verb: "set", value, changed });
    }
    if let Change::OneOf(_, values) = change {
        return nearest_of((field, values), c, parameter, fits);
    }
    let is_upwards = change.is_upwards(c, parameter)?;
    let walk = Walk::new(c, parameter, is_upwards)?;
    let (shown, changed) = walk.nearest(fits, effort)?;
    let verb = if is_upwards { "raise" } else { "lower" };
    Some(Tried { field: Some(field), verb, value: format!("to {shown}"), changed })
}

/// The nearest of `values` that `fits`.
fn nearest_of(
    (field, values): (&'static str, &[f64]),
    c: &Configuration,
    parameter: &Parameter<Configuration>,
    fits: &dyn Fn(&Dimensions) -> bool,
) -> Option<Tried> {
    let now = number(&(parameter.get)(c))?;
    let mut nearest: Vec<f64> = values.iter().copied().filter(|v| (v - now).abs() > 1e-9).collect();
    sort_by_number(&mut nearest, |value| (value - now).abs());
    nearest.into_iter().find_map(|value| {
        let shown = format!("{value:?}");
        let changed = with(c, parameter, &shown)?;
        let verb = if value > now { "raise" } else { "lower" };
        let tried = Tried { field: Some(field), verb, value: format!("to {shown}"), changed };
        fits(&Dimensions::new(tried.changed.clone())).then_some(tried)
    })
}

/// Changes that mend it together, as few as will do; none if all of them do not.
fn together(changes: &[Change], c: &Configuration, fits: &dyn Fn(&Dimensions) -> bool) -> Vec<Tried> {
    let mut steps: Vec<Change> = Vec::new();
    let mut all = c.clone();
    for change in changes {
        if let Some(last) = tried(*change, &all, fits) {
            steps.push(*change);
            // Each that is not needed is left out again.
            for i in (0..steps.len().saturating_sub(1)).rev() {
                let fewer: Vec<_> =
                    steps.iter().enumerate().filter(|(j, _)| *j != i).map(|(_, step)| *step).collect();
                if one_after_another(&fewer, c, fits).is_some() {
                    steps = fewer;
                }
            }
            return one_after_another(&steps, c, fits).unwrap_or_else(|| vec![last]);
        }
        if let Some(furthest) = furthest(*change, &all) {
            all = furthest.changed;
            steps.push(*change);
        }
    }
    Vec::new()
}

/// All but the last as far as they go, and the last as far as it must.
fn one_after_another(
    steps: &[Change],
    c: &Configuration,
    fits: &dyn Fn(&Dimensions) -> bool,
) -> Option<Vec<Tried>> {
    let (last, before) = steps.split_last()?;
    let mut found: Vec<Tried> = Vec::new();
    for step in before {
        let next = furthest(*step, found.last().map_or(c, |t| &t.changed))?;
        found.push(next);
    }
    let next = tried(*last, found.last().map_or(c, |t| &t.changed), fits)?;
    found.push(next);
    Some(found)
}

/// The change to the end of the field's range.
fn furthest(change: Change, c: &Configuration) -> Option<Tried> {
    let field = change.field()?;
    let parameter = Configuration::PARAMETERS.iter().find(|p| p.path() == field)?;
    let is_upwards = change.is_upwards(c, parameter)?;
    let walk = Walk::new(c, parameter, is_upwards)?;
    let shown = walk.shown(walk.to);
    let changed = with(c, parameter, &shown)?;
    let verb = if is_upwards { "raise" } else { "lower" };
    Some(Tried { field: Some(field), verb, value: format!("to {shown}"), changed })
}

/// The values of a parameter from the present one to the end of its range, counted in the steps in which they are shown.
struct Walk<'a> {
    c: &'a Configuration,
    parameter: &'a Parameter<Configuration>,
    is_whole: bool,
    from: i64,
    to: i64,
}

impl<'a> Walk<'a> {
    #[allow(clippy::cast_possible_truncation)]
    fn new(c: &'a Configuration, parameter: &'a Parameter<Configuration>, is_upwards: bool) -> Option<Self> {
        let [low, high] = (parameter.ends)()?;
        let value = (parameter.get)(c);
        let is_whole = value.is_integer();
        let now = number(&value).filter(|now| now.is_finite())?.clamp(low, high);
        let scale = if is_whole { 1.0 } else { STEPS_PER_UNIT };
        // A hair, so that 0.7 computed as 0.700...1 is still 0.7.
        let up = |x: f64| (x * scale - 1e-6).ceil() as i64;
        let down = |x: f64| (x * scale + 1e-6).floor() as i64;
        let (from, to) = if is_upwards { (down(now), down(high)) } else { (up(now), up(low)) };
        (from != to).then_some(Self { c, parameter, is_whole, from, to })
    }

    fn shown(&self, step: i64) -> String {
        if self.is_whole { step.to_string() } else { format!("{:.3}", step as f64 / STEPS_PER_UNIT) }
    }

    /// The value nearest to the present one that fits, with the configuration that has it.
    fn nearest(&self, fits: &dyn Fn(&Dimensions) -> bool, effort: Effort) -> Option<(String, Configuration)> {
        let at = |step: i64| {
            let shown = self.shown(step);
            let changed = Dimensions::new(with(self.c, self.parameter, &shown)?);
            fits(&changed).then_some((shown, changed))
        };
        let way = self.to - self.from;
        let mut bad = self.from;
        // Nearer to the present value they are closer: what mends is mostly near.
        let Effort { tried, near } = effort;
        let steps = (1..=tried).map(|i| match near {
            1 => self.from + way * i / tried,
            _ => self.from + way * i * i / (tried * tried),
        });
        let (mut good, mut found) = steps.into_iter().find_map(|step| {
            let found = at(step).map(|found| (step, found));
            if found.is_none() {
                bad = step;
            }
            found
        })?;
        while (good - bad).abs() > if self.is_whole { 1 } else { near } {
            let middle = i64::midpoint(good, bad);
            match at(middle) {
                Some(nearer) => (good, found) = (middle, nearer),
                None => bad = middle,
            }
        }
        let (shown, changed) = found;
        Some((shown, changed.configuration().clone()))
    }
}

/// The configuration with this value, written as TOML; `None` outside the parameter's range.
fn with(c: &Configuration, parameter: &Parameter<Configuration>, value: &str) -> Option<Configuration> {
    let value = value.parse::<Value>().ok()?;
    let mut changed = c.clone();
    (parameter.set)(&mut changed, &value).ok()?;
    Some(changed)
}

fn number(value: &Value) -> Option<f64> {
    value.as_float().or_else(|| value.as_integer().map(|i| i as f64))
}

/// `a`, `a or b`, `a, b, or c`.
fn alternatives(mut words: Vec<String>) -> String {
    match (words.pop(), words.len()) {
        (None, _) => String::new(),
        (Some(last), 0) => last,
        (Some(last), 1) => format!("{} or {last}", words.join("")),
        (Some(last), _) => format!("{}, or {last}", words.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::assign;
    use crate::design::rules::check;

    /// The error of a configuration, and the rule behind it.
    fn refused(c: &Configuration) -> Option<(&'static Rule, ConfigError)> {
        let error = check(&Dimensions::new(c.clone())).err()?;
        let dimensions = Dimensions::new(c.clone());
        let rule = rules().find(|r| r.severity == Severity::Error && !keeps(r, &dimensions)).unwrap();
        Some((rule, error))
    }

    /// Every assignment that a remedy names, as `--set` takes it.
    fn assignments(error: &ConfigError) -> Vec<String> {
        let remedy = error.remedy.replace(", or ", "|").replace(" or ", "|").replace(", and ", "|");
        let remedy = remedy.replace("no single value mends it: ", "").replace(", ", "|");
        let field = |name: &str| if name == "it" { error.field.clone() } else { name.to_owned() };
        remedy
            .split('|')
            .filter_map(|words| match words.split(' ').collect::<Vec<_>>()[..] {
                ["lower" | "raise", name, "to", value] => Some(format!("{}={value}", field(name))),
                ["set", name, "=", value] => Some(format!("{}={value}", field(name))),
                _ => None,
            })
            .collect()
    }

    /// What is wrong with the remedy of this configuration's error.
    fn fault(c: &Configuration) -> Option<String> {
        let (rule, error) = refused(c)?;
        let named = assignments(&error);
        let text = error.to_string();
        if text.len() > 560 || text.ends_with("...") || error.remedy.contains("bring ") {
            return Some(text);
        }
        let is_tried = error.remedy.contains(" to ") || error.remedy.contains(" = ");
        if is_tried && named.is_empty() {
            return Some(format!("{text}: names no assignment"));
        }
        let mends = |assignments: &[String]| {
            let mut changed = c.clone();
            assignments.iter().all(|a| assign(&mut changed, a).is_ok())
                && keeps(rule, &Dimensions::new(changed))
        };
        let is_mended = if error.remedy.starts_with("no single") {
            mends(&named)
        } else {
            named.iter().all(|a| mends(std::slice::from_ref(a)))
        };
        let set: Vec<String> =
            error.changes.iter().map(|(field, value)| format!("{field}={value}")).collect();
        let is_set = set.is_empty() != is_tried && (set.is_empty() || mends(&set));
        (!is_mended || !is_set).then(|| format!("{text}: does not work: {named:?}, {set:?}"))
    }

    fn with_all(assignments: &[&str]) -> Configuration {
        let mut c = Configuration::default();
        for assignment in assignments {
            assign(&mut c, assignment).unwrap();
        }
        c
    }

    #[test]
    fn every_remedy_of_an_extreme_configuration_works() {
        let fields: Vec<_> =
            Configuration::PARAMETERS.iter().filter_map(|p| Some((p, (p.ends)()?))).collect();
        let mut faults = Vec::new();
        let mut errors = 0;
        for (i, (a, ends_a)) in fields.iter().enumerate() {
            // Every other one that follows: all pairs would take long, and say the same.
            for (b, ends_b) in fields[i..].iter().step_by(2) {
                for (end_a, end_b) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                    let mut c = Configuration::default();
                    c.layout.pins = vec![5, 8, 11];
                    let value = |p: &Parameter<Configuration>, x: f64| format!("{}={x}", p.path());
                    let (first, second) = (value(a, ends_a[end_a]), value(b, ends_b[end_b]));
                    for assignment in [first, second] {
                        assign(&mut c, &assignment).unwrap();
                    }
                    errors += usize::from(refused(&c).is_some());
                    faults.extend(fault(&c));
                }
            }
        }
        println!("{errors} errors");
        assert!(errors > 1000, "{errors}");
        assert!(
            faults.is_empty(),
            "{} of {errors}:\n{}",
            faults.len(),
            faults[..faults.len().min(25)].join("\n")
        );
    }

    #[test]
    fn every_remedy_of_a_random_configuration_works() {
        let fields: Vec<_> =
            Configuration::PARAMETERS.iter().filter_map(|p| Some((p, (p.ends)()?))).collect();
        let mut state = 1u64;
        let mut next = move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 40) as f64 / (1u64 << 24) as f64
        };
        let mut faults = Vec::new();
        for case in 0..1000 {
            let mut c = Configuration::default();
            for kind in [
                "mould.kind=one-piece",
                "mould.kind=none",
                "support.slot_kind=through",
                "fasteners.kind=insert",
                "mount.kind=finger-link",
                "mount.kind=rig",
            ] {
                if next() < 0.25 {
                    assign(&mut c, kind).unwrap();
                }
            }
            // From one odd value to a configuration that is odd all over.
            let share = [0.03, 0.1, 0.3, 1.0][case % 4];
            for (parameter, [low, high]) in &fields {
                if next() < share {
                    let value = low + (high - low) * next();
                    let value = if (parameter.get)(&c).is_integer() { value.round() } else { value };
                    assign(&mut c, &format!("{}={value}", parameter.path())).unwrap();
                }
            }
            faults.extend(fault(&c));
        }
        assert!(faults.is_empty(), "{}:\n{}", faults.len(), faults[..faults.len().min(25)].join("\n"));
    }

    #[test]
    fn an_error_names_the_field_that_was_set_and_all_that_mend_it() {
        for (assignments, field, words) in [
            (&["tendon.rope_diameter_mm=4.4"][..], "tendon.rope_diameter_mm", "lower it to 3.900"),
            (&["tendon.coating_mm=2"], "tendon.coating_mm", "lower it to 1.600"),
            (&["print.elephant_foot_mm=1"], "print.elephant_foot_mm", "lower it to 0."),
            (&["segment.span_deg=340", "layout.wrap_angle_deg=340"], "segment.span_deg", "kind = \"none\""),
            (&["segment.end_margin_mm=10"], "segment.end_margin_mm", "lower it to "),
        ] {
            let (_, error) = refused(&with_all(assignments)).unwrap();
            assert_eq!(error.field, field, "{error}");
            assert!(error.remedy.contains(words), "{error}");
        }
    }

    /// The error of a configuration as a user meets it, of its rules or of its parts.
    fn error_of(c: &Configuration) -> Option<ConfigError> {
        match crate::design::Design::new(c.clone()) {
            Err(error) => Some(error),
            Ok(design) => crate::parts::printed(&design).err(),
        }
    }

    /// Every value that the error names, taken, leads to a set that can be made: no next error, and no note that something
    /// was left out for the same reason.
    #[test]
    fn a_remedy_about_hardware_mends_all_of_it() {
        for assignments_of_case in [
            &["fasteners.kind=insert", "fasteners.hole_diameter_mm=4"][..],
            &["fasteners.kind=insert", "fasteners.hole_diameter_mm=4.1"],
            &["fasteners.kind=insert", "fasteners.hole_diameter_mm=5.5"],
            &["fasteners.hole_diameter_mm=1.5"],
            &["fasteners.dowel_diameter_mm=3.95"],
            &["fasteners.dowel_diameter_mm=2.2"],
            &["shell.width_mm=60"],
            &["shell.width_mm=100"],
            &["mount.kind=rig", "mount.plate_mm=5"],
            &["mount.kind=flange", "mount.plate_mm=3"],
            &["mount.kind=flange", "tendon.sheath_diameter_mm=3", "mount.plate_mm=2.5"],
            &["segment.grooves=40"],
            &["segment.grooves=60"],
            &["print.elephant_foot_mm=0.3"],
            &["print.elephant_foot_mm=0.5"],
            &["print.elephant_foot_mm=1"],
        ] {
            let c = with_all(assignments_of_case);
            let error = error_of(&c).unwrap_or_else(|| panic!("{assignments_of_case:?} is fine"));
            let named = assignments(&error);
            assert!(!named.is_empty(), "{error}");
            let mut ways: Vec<Vec<String>> = named.iter().map(|a| vec![a.clone()]).collect();
            if error.remedy.starts_with("no single") {
                ways = vec![named];
            }
            for way in ways {
                let mut changed = c.clone();
                way.iter().for_each(|a| assign(&mut changed, a).unwrap());
                let next = error_of(&changed);
                assert!(next.is_none(), "{error}\n{way:?} leads to {}", next.unwrap());
            }
        }
    }

    #[test]
    fn what_a_remedy_says_leads_to_a_configuration_that_can_be_built() {
        for start in [&["shell.wall_mm=60"][..], &["segment.span_deg=322", "layout.wrap_angle_deg=322"]] {
            let mut c = with_all(start);
            let mut said = Vec::new();
            while let Some((_, error)) = refused(&c) {
                assign(&mut c, &assignments(&error)[0]).unwrap();
                said.push(error.to_string());
                assert!(said.len() < 12, "{}", said.join("\n"));
            }
        }
    }
}
