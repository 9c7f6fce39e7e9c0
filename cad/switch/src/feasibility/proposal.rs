//! Proposals: changes of parameters, as text and as values.

use std::fmt;

use super::distance::differing;
use crate::config::parameter::Parameter;
use crate::config::{Change, Configuration, shown};

/// Largest number of changes of a proposal in a message: users would not read more.
const MAX_SHOWN: usize = 6;

/// The change of one parameter.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ParameterChange {
    /// Path of the parameter, such as `shell.width_mm`.
    pub field: String,
    /// Present value as TOML.
    pub from: String,
    /// Proposed value as TOML.
    pub to: String,
    /// The problem that this change solves.
    pub reason: String,
}

impl fmt::Display for ParameterChange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {} -> {}: {}", self.field, self.from, self.to, self.reason)
    }
}

/// A feasible configuration near an infeasible one.
#[derive(Clone, Debug, PartialEq)]
pub struct Proposal {
    /// The feasible configuration.
    pub configuration: Configuration,
    /// The changes that lead to it; the field to blame first.
    pub changes: Vec<ParameterChange>,
}

/// The changes from `start` to `c`, with that of `subject` first.
pub(super) fn changes(start: &Configuration, c: &Configuration, subject: &str) -> Vec<Change> {
    let change = |p: &Parameter<Configuration>| Change { field: p.path(), value: shown(&(p.get)(c)) };
    let mut changes: Vec<Change> = differing(start, c).map(change).collect();
    changes.sort_by_key(|change| change.field != subject);
    changes
}

/// The changes from `start` to `c` as an instruction, such as `lower it to 20, and set mould.kind = "none"`, where `it`
/// is the subject.
pub(crate) fn instruction(start: &Configuration, c: &Configuration, subject: &str) -> String {
    let changes = changes(start, c, subject);
    let mut all: Vec<String> = changes.iter().map(|change| step(start, change, subject)).collect();
    if all.len() > MAX_SHOWN {
        let more = all.len() - MAX_SHOWN + 1;
        all.truncate(MAX_SHOWN - 1);
        all.push(format!("change {more} more values, which `pinswitch generate --fix` does"));
    }
    all.join(", and ")
}

/// `lower it to 20`, `raise shell.wall_mm to 9.5`, `set mould.kind = "none"`.
fn step(start: &Configuration, change: &Change, subject: &str) -> String {
    let Change { field, value } = change;
    let name = if field == subject { "it" } else { field };
    let from = start.shown(field).and_then(|from| from.parse::<f64>().ok());
    match (from, value.parse::<f64>()) {
        (Some(from), Ok(to)) => format!("{} {name} to {value}", if to > from { "raise" } else { "lower" }),
        _ if field == subject => format!("set it to {value}"),
        _ => format!("set {name} = {value}"),
    }
}

/// `a`, `a, or b`, `a, b, or c`.
pub(crate) fn alternatives(mut words: Vec<String>) -> String {
    match (words.pop(), words.len()) {
        (None, _) => String::new(),
        (Some(last), 0) => last,
        (Some(last), _) => format!("{}, or {last}", words.join(", ")),
    }
}
