//! `[10, 12.5]`: a list of values; in a sample they are equally likely.

use std::collections::HashSet;

use toml_edit::{Array, Item, Value};

use super::{Sampler, Series, ValueKind};
use crate::axis::{ParameterRef, accepted, config_error};
use pinswitch_switch::config::ConfigError;

pub(super) const KIND: ValueKind = ValueKind { is_written: Item::is_array, every_value, sampler };

fn every_value(field: ParameterRef, item: &Item) -> Result<Series, ConfigError> {
    let values = listed(field, item)?;
    Ok(Series::new(values.len() as u64, move |index| {
        usize::try_from(index).ok().and_then(|i| values.get(i).cloned()).unwrap_or_else(|| Value::from(""))
    }))
}

/// The values, each in the field's own type.
fn listed(field: ParameterRef, item: &Item) -> Result<Vec<Value>, ConfigError> {
    let path = field.path();
    let written: Vec<&Value> = item.as_array().into_iter().flat_map(Array::iter).collect();
    if written.is_empty() {
        return Err(config_error(&path, Some("[]"), "is an empty axis", "give at least one value"));
    }
    let values: Vec<_> = written.into_iter().map(|v| accepted(field, v)).collect::<Result<_, _>>()?;
    let mut before = HashSet::new();
    for value in &values {
        let text = value.to_string();
        if !before.insert(text.clone()) {
            return Err(config_error(
                &path,
                Some(&text),
                "stands twice in the list",
                "name every value once",
            ));
        }
    }
    Ok(values)
}

fn sampler(field: ParameterRef, item: &Item) -> Result<Sampler, ConfigError> {
    let all = listed(field, item)?;
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, clippy::cast_precision_loss)]
    let at = move |share: f64| all[((share * all.len() as f64) as usize).min(all.len() - 1)].clone();
    Ok(Box::new(at))
}
