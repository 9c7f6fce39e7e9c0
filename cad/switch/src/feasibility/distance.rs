//! The distance between a configuration and a proposal.

use toml_edit::Value;

use crate::config::Configuration;
use crate::config::parameter::{Parameter, number};

/// The parameters in which two configurations differ, in the order of the table.
pub(super) fn differing(
    a: &Configuration,
    b: &Configuration,
) -> impl Iterator<Item = &'static Parameter<Configuration>> {
    let value = |p: &Parameter<Configuration>, c: &Configuration| (p.get)(c).to_string();
    Configuration::PARAMETERS.iter().filter(move |p| value(p, a) != value(p, b))
}

/// The distance of a proposal. Proposals are compared by the number of changed parameters; then by how many of these have
/// their default, since a value that the user set is the likelier mistake; then by the size of the changes.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub(super) struct Distance {
    changes: usize,
    defaults: usize,
    size: f64,
}

impl Distance {
    /// The distance from `start` to `c`.
    pub(super) fn new(start: &Configuration, c: &Configuration) -> Self {
        let default = Configuration::default();
        let changed: Vec<_> = differing(start, c).collect();
        let is_default =
            |p: &&&Parameter<Configuration>| (p.get)(start).to_string() == (p.get)(&default).to_string();
        Self {
            changes: changed.len(),
            defaults: changed.iter().filter(is_default).count(),
            size: changed.iter().map(|p| size(&(p.get)(start), &(p.get)(c))).sum(),
        }
    }
}

impl Distance {
    /// Compares two distances; sizes are never NaN.
    pub(super) fn total_cmp(&self, other: &Self) -> std::cmp::Ordering {
        let counts = |d: &Self| (d.changes, d.defaults);
        counts(self).cmp(&counts(other)).then(self.size.total_cmp(&other.size))
    }
}

/// The size of a change, 0 to 2: of a number relative to the larger of both values, of a list the share of its items that
/// changed, of anything else 1.
#[allow(clippy::cast_precision_loss)]
fn size(from: &Value, to: &Value) -> f64 {
    match (number(from), number(to), from.as_array(), to.as_array()) {
        (Some(from), Some(to), ..) => (to - from).abs() / from.abs().max(to.abs()).max(f64::MIN_POSITIVE),
        (_, _, Some(from), Some(to)) => {
            let texts = |list: &toml_edit::Array| -> Vec<String> {
                list.iter().map(|item| item.clone().decorated("", "").to_string()).collect()
            };
            let (from, to) = (texts(from), texts(to));
            let common = from.iter().filter(|item| to.contains(item)).count();
            1.0 - common as f64 / from.len().max(to.len()).max(1) as f64
        }
        _ => 1.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::assign;

    fn with(assignments: &[&str]) -> Configuration {
        let mut c = Configuration::default();
        assignments.iter().for_each(|a| assign(&mut c, a).unwrap());
        c
    }

    #[test]
    fn fewer_changes_are_nearer() {
        let start = with(&["shell.width_mm=20", "shell.wall_mm=9", "layout.pins=[5, 8, 11]"]);
        let to = |assignments: &[&str]| {
            let mut c = start.clone();
            assignments.iter().for_each(|a| assign(&mut c, a).unwrap());
            Distance::new(&start, &c)
        };
        let nearest_first = [
            to(&[]),
            to(&["shell.width_mm=19"]),
            to(&["layout.pins=[5, 8, 12]"]),
            to(&["shell.width_mm=5"]),
            // The same change of a value at its default is farther.
            to(&["shell.outer_radius_mm=20.1"]),
            to(&["shell.width_mm=19.9", "shell.wall_mm=8.9"]),
        ];
        assert!(nearest_first.windows(2).all(|pair| pair[0] < pair[1]), "{nearest_first:?}");
    }
}
