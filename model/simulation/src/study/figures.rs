//! Texts and medians for the tables of the study.

use pinswitch_calibration::median;

use super::outcome::CaseOutcome;

/// Returns the answer as text: the reported effects, or else the verdict.
pub(super) fn answer_text(outcome: &CaseOutcome) -> String {
    if outcome.named.is_empty() { outcome.verdict.as_str().to_owned() } else { outcome.named.join(" + ") }
}

/// Returns the median, or NaN without values.
pub(super) fn median_of(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    if values.is_empty() { f64::NAN } else { median(&mut values) }
}

/// Returns the median with this number of decimal places; empty without values.
pub(super) fn median_text(values: impl Iterator<Item = f64>, digits: usize) -> String {
    let median = median_of(values);
    if median.is_nan() { String::new() } else { format!("{median:.digits$}") }
}
