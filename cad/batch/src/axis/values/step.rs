//! `{ from = 10, to = 12, step = 0.5 }`: a range on a grid that is counted from its start.

use toml_edit::Item;

use super::range::{Range, has_key, without_float_noise};
use super::{Sampler, Series, ValueKind};
use crate::axis::{ParameterRef, config_error};
use pinswitch_switch::config::ConfigError;

pub(super) const KIND: ValueKind =
    ValueKind { is_written: |item| has_key(item, "from") && has_key(item, "step"), every_value, sampler };

/// Number of steps beyond which a range is taken for a typing error.
const MAX_STEPS: f64 = 1e7;

fn every_value(field: ParameterRef, item: &Item) -> Result<Series, ConfigError> {
    let range = Range::read(field, item)?;
    let step = range.step.unwrap_or(1.0);
    let last = last_step(&range, step);
    if last > MAX_STEPS {
        return Err(config_error(
            &field.path(),
            Some(&format!("{} to {} by {step}", range.from, range.to)),
            "has more than ten million values",
            "raise step",
        ));
    }
    #[allow(clippy::cast_precision_loss)]
    let number = move |i: u64| without_float_noise(range.from + step * i as f64);
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    let count = last as u64 + 1;
    // Between two ends that are accepted only a fraction is not, and then the second value is one already.
    range.accept(field, number(1.min(count - 1)))?;
    Ok(Series::new(count, move |i| range.value(number(i))))
}

fn sampler(field: ParameterRef, item: &Item) -> Result<Sampler, ConfigError> {
    let range = Range::read(field, item)?;
    let step = range.step.unwrap_or(1.0);
    if last_step(&range, step) >= 1.0 {
        range.accept(field, without_float_noise(range.from + step))?;
    }
    Ok(on_grid(range, step))
}

/// The sampler of a range on a grid: all values are equally likely.
pub(super) fn on_grid(range: Range, step: f64) -> Sampler {
    let last = last_step(&range, step);
    Box::new(move |share| {
        let steps = (share * (last + 1.0)).floor().min(last);
        range.value(without_float_noise(range.from + step * steps))
    })
}

/// Number of the last value, from 0; a range that ends on its grid holds its end, whatever the rounding.
fn last_step(range: &Range, step: f64) -> f64 {
    ((range.to - range.from) / step + 1e-9).floor()
}
