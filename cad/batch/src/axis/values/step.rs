//! `{ from = 10, to = 12, step = 0.5 }`: a range on a grid that starts at its first value.

use pinswitch_diagnostic::{Diagnostic, codes};
use toml_edit::Item;

use super::range::{Range, has_key, without_float_noise};
use super::{Notation, Sampler, Series};
use crate::axis::ParameterRef;
use crate::diagnostics::field_error;

pub(super) const NOTATION: Notation =
    Notation { matches: |item| has_key(item, "from") && has_key(item, "step"), series, sampler };

/// Most steps; a longer range is taken for a typing error.
const MAX_STEPS: f64 = 1e7;

fn series(field: ParameterRef, item: &Item) -> Result<Series, Diagnostic> {
    let range = Range::read(field, item)?;
    let step = range.step.unwrap_or(1.0);
    let last = last_step(&range, step);
    if last > MAX_STEPS {
        let value = format!("{} to {} by {step}", range.from, range.to);
        let problem = format!("more than {MAX_STEPS} values");
        return Err(field_error(codes::TOO_MANY_ENTRIES, &field.path(), Some(&value), problem, "raise step"));
    }
    #[allow(clippy::cast_precision_loss)]
    let number = move |i: u64| without_float_noise(range.from + step * i as f64);
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    let count = last as u64 + 1;
    // Both ends are valid. In between, only a fraction can be invalid, and then the second value is
    // one.
    range.accept(field, number(1.min(count - 1)))?;
    Ok(Series::new(count, move |i| range.value(number(i))))
}

fn sampler(field: ParameterRef, item: &Item) -> Result<Sampler, Diagnostic> {
    let range = Range::read(field, item)?;
    let step = range.step.unwrap_or(1.0);
    if last_step(&range, step) >= 1.0 {
        range.accept(field, without_float_noise(range.from + step))?;
    }
    Ok(on_grid(range, step))
}

/// Returns the sampler of a range on a grid: all values are equally likely.
pub(super) fn on_grid(range: Range, step: f64) -> Sampler {
    let last = last_step(&range, step);
    Box::new(move |share| {
        let steps = (share * (last + 1.0)).floor().min(last);
        range.value(without_float_noise(range.from + step * steps))
    })
}

/// Returns the index of the last value; a range that ends on its grid contains its end, whatever
/// the rounding.
fn last_step(range: &Range, step: f64) -> f64 {
    ((range.to - range.from) / step + 1e-9).floor()
}
