//! `{ from = 10, to = 12, count = 5, spacing = "log" }`: so many values with equal steps, or equal ratios.

use toml_edit::Item;

use super::range::{Range, has_key};
use super::{Sampler, Series, ValueKind};
use crate::axis::{ParameterRef, config_error};
use pinswitch_switch::config::ConfigError;

pub(super) const KIND: ValueKind =
    ValueKind { is_written: |item| has_key(item, "from") && has_key(item, "count"), every_value, sampler };

/// Number of values beyond which a count is taken for a typing error.
const MAX_COUNT: usize = 10_000_000;
/// Number of values up to which each is compared with the one before; of more, the width of a step is.
const MAX_COMPARED: usize = 100_000;
/// Relative width of a step that a number written with 13 digits shows for certain.
const LEAST_RELATIVE_STEP: f64 = 1e-11;

fn every_value(field: ParameterRef, item: &Item) -> Result<Series, ConfigError> {
    let (path, range) = (field.path(), Range::read(field, item)?);
    let count = range.count.unwrap_or(1);
    if count > MAX_COUNT {
        return Err(config_error(&path, Some(&count.to_string()), "is too many values", "lower count"));
    }
    #[allow(clippy::cast_precision_loss)]
    let number = move |i: usize| range.at(i as f64 / (count.max(2) - 1) as f64);
    let different = if count <= MAX_COMPARED {
        1 + (1..count).filter(|i| number(*i) != number(i - 1)).count()
    } else {
        range.different(count, LEAST_RELATIVE_STEP)
    };
    if different < count {
        return Err(config_error(
            &path,
            Some(&format!("{count} values from {} to {}", range.from, range.to)),
            "holds fewer different values",
            &format!("lower count to {different}"),
        ));
    }
    Ok(Series::new(count as u64, move |i| range.value(number(usize::try_from(i).unwrap_or_default()))))
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
