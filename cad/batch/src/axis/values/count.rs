//! `{ from = 10, to = 12, count = 5, spacing = "log" }`: so many values with equal steps, or equal ratios.

use toml_edit::{Item, Value};

use super::range::{Range, has_key};
use super::{Sampler, ValueKind};
use crate::axis::{ParameterRef, config_error};
use pinswitch_switch::config::ConfigError;

pub(super) const KIND: ValueKind =
    ValueKind { is_written: |item| has_key(item, "from") && has_key(item, "count"), every_value, sampler };

/// Number of values beyond which a count is taken for a typing error.
const MAX_COUNT: usize = 10_000_000;

fn every_value(field: ParameterRef, item: &Item) -> Result<Vec<Value>, ConfigError> {
    let (path, range) = (field.path(), Range::read(field, item)?);
    let count = range.count.unwrap_or(1);
    if count > MAX_COUNT {
        return Err(config_error(&path, Some(&count.to_string()), "is too many values", "lower count"));
    }
    #[allow(clippy::cast_precision_loss)]
    let share = |i: usize| i as f64 / (count.max(2) - 1) as f64;
    let mut numbers: Vec<_> = (0..count).map(|i| range.at(share(i))).collect();
    numbers.dedup();
    if numbers.len() < count {
        return Err(config_error(
            &path,
            Some(&format!("{count} values from {} to {}", range.from, range.to)),
            "holds fewer different values",
            &format!("lower count to {}", numbers.len()),
        ));
    }
    range.accepted_by(field, numbers)
}

fn sampler(field: ParameterRef, item: &Item) -> Result<Sampler, ConfigError> {
    Range::read(field, item)?;
    Err(config_error(
        &format!("{}.count", field.path()),
        None,
        "has no place in a sample",
        "give the number of points as sample.count",
    ))
}
