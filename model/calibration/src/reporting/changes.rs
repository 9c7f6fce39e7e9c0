//! Constants of the switch that differ between sessions or specimens.

use std::collections::BTreeMap;

use pinswitch_inference::Member;

use crate::evidence::Evidence;
use crate::report::ChangeReport;

/// Returns the reported changes.
pub(super) fn changes(evidence: &Evidence) -> Vec<ChangeReport> {
    let reported = evidence.posterior().reported.iter().filter(|r| evidence.is_change(r.member));
    reported
        .filter_map(|reported| {
            let Member::Kernel(kernel) = reported.member else { return None };
            let curve = evidence.posterior().curve(evidence.problem(), kernel)?;
            let by = evidence.covariate(reported.member);
            let factors: BTreeMap<String, f64> = evidence
                .groups(by)
                .zip(curve)
                .map(|(group, value)| (group.to_owned(), 1.0 + value))
                .collect();
            Some(ChangeReport {
                constant: evidence.changing_constant(kernel).to_owned(),
                layout: evidence.changing_layout(kernel),
                by: by.to_owned(),
                probability: reported.probability,
                factors,
            })
        })
        .collect()
}
