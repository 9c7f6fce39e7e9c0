//! `{ from = 10, to = 12, count = 5, spacing = "log" }`: a number of values with equal steps, or
//! equal ratios.

use pinswitch_diagnostic::{Diagnostic, codes};
use toml_edit::Item;

use super::range::{Range, has_key};
use super::{Notation, Sampler, Series};
use crate::axis::ParameterRef;
use crate::diagnostics::field_error;

pub(super) const NOTATION: Notation =
    Notation { matches: |item| has_key(item, "from") && has_key(item, "count"), series, sampler };

/// Most values; a larger count is taken for a typing error.
const MAX_COUNT: usize = 10_000_000;
/// Most values that are compared one by one; of a longer range, only the step is checked.
const MAX_COMPARED: usize = 100_000;
/// Smallest relative step that always changes a number of 13 digits.
const MIN_RELATIVE_STEP: f64 = 1e-11;

fn series(field: ParameterRef, item: &Item) -> Result<Series, Diagnostic> {
    let range = Range::read(field, item)?;
    let count = range.count.unwrap_or(1);
    let refused = |problem: String, help: String| {
        Err(field_error(
            codes::TOO_MANY_ENTRIES,
            &format!("{}.count", field.path()),
            Some(&count.to_string()),
            problem,
            help,
        ))
    };
    if count > MAX_COUNT {
        return refused(format!("more than {MAX_COUNT} values"), "lower count".to_owned());
    }
    #[allow(clippy::cast_precision_loss)]
    let number = move |i: usize| range.at(i as f64 / (count.max(2) - 1) as f64);
    let different = if count <= MAX_COMPARED {
        1 + (1..count).filter(|i| number(*i) != number(i - 1)).count()
    } else {
        range.different_values(count, MIN_RELATIVE_STEP)
    };
    if different < count {
        let problem = format!("only {different} different values from {} to {}", range.from, range.to);
        return refused(problem, format!("lower count to {different}"));
    }
    Ok(Series::new(count as u64, move |i| range.value(number(usize::try_from(i).unwrap_or_default()))))
}

fn sampler(field: ParameterRef, item: &Item) -> Result<Sampler, Diagnostic> {
    Range::read(field, item)?;
    let path = format!("{}.count", field.path());
    let help = "give the number of points as sample.count";
    Err(field_error(codes::INVALID_AXIS, &path, None, "range with a count in a sample", help))
}
