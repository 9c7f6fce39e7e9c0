//! Figures that several tables of the study share.

use pinswitch_calibration::median;

use super::outcome::CaseOutcome;

/// What was said, as one text: what was named, or else the verdict.
pub(super) fn answer_text(outcome: &CaseOutcome) -> String {
    if outcome.named.is_empty() { outcome.verdict.as_str().to_owned() } else { outcome.named.join(" + ") }
}

/// Median; not a number without values.
pub(super) fn median_of(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    if values.is_empty() { f64::NAN } else { median(&mut values) }
}

/// The median with so many digits after the point; nothing without values.
pub(super) fn median_text(values: impl Iterator<Item = f64>, digits: usize) -> String {
    let median = median_of(values);
    if median.is_nan() { String::new() } else { format!("{median:.digits$}") }
}
