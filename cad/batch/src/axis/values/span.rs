//! `{ from = 10, to = 12 }`: every value between two ends, for samples only.

use toml_edit::Item;

use super::range::{Range, has_key};
use super::step::on_grid;
use super::{Sampler, Series, ValueKind};
use crate::axis::{ParameterRef, config_error};
use pinswitch_switch::config::ConfigError;

pub(super) const KIND: ValueKind =
    ValueKind { is_written: |item| has_key(item, "from"), every_value, sampler };

fn every_value(field: ParameterRef, item: &Item) -> Result<Series, ConfigError> {
    Range::read(field, item)?;
    Err(config_error(&field.path(), None, "has neither step nor count", "add step = ... or count = ..."))
}

fn sampler(field: ParameterRef, item: &Item) -> Result<Sampler, ConfigError> {
    let range = Range::read(field, item)?;
    Ok(if range.whole { on_grid(range, 1.0) } else { Box::new(move |share| range.value(range.at(share))) })
}
