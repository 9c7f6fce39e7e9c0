//! Constants that differ between sessions or specimens, with intervals.

use crate::inference::{Fit, Weighed, averaged_intervals};
use crate::report::{ChangeReport, Estimate};
use crate::table::Changing;

/// Returns the changes of a fitted model, in the order in which they were selected.
pub(super) fn changes(fitted: &Fit, weighed: &Weighed<'_>) -> Vec<ChangeReport> {
    let model = &fitted.model;
    let frame = &model.frame;
    if frame.changes.is_empty() {
        return Vec::new();
    }
    let (values, reaches) = (model.values(), averaged_intervals(fitted, weighed));
    let of = |(i, change): (usize, &crate::table::Change)| {
        let at = model.first_change() + i;
        let (factor, [below, above]) = (values[at], reaches[at]);
        let (groups, others): (Vec<_>, Vec<_>) = frame
            .groups_by(change.by)
            .iter()
            .enumerate()
            .partition(|(group, _)| change.groups.contains(group));
        let names = |of: Vec<(usize, &String)>| of.into_iter().map(|(_, name)| name.clone()).collect();
        let latest = match change.constant {
            Changing::Pins => Some(values[0]),
            Changing::Silicone => {
                Some(values[1]).filter(|_| frame.conditions.iter().any(|c| c.substrate.is_some()))
            }
            Changing::HalfLoad => None,
        };
        ChangeReport {
            constant: change.constant.as_str().to_owned(),
            by: change.by.as_str().to_owned(),
            groups: names(groups),
            others: names(others),
            factor: Estimate { value: factor, ci95: [factor - below, factor + above], unit: "1".to_owned() },
            latest,
        }
    };
    frame.changes.iter().enumerate().map(of).collect()
}
