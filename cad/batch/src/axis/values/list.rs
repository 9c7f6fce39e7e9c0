//! `[10, 12.5]`: a list of values; in a sample they are equally likely.

use std::collections::HashSet;

use pinswitch_diagnostic::{Diagnostic, codes};
use toml_edit::{Array, Item, Value};

use super::{Notation, Sampler, Series};
use crate::axis::{ParameterRef, accepted};
use crate::diagnostics::field_error;

pub(super) const NOTATION: Notation = Notation { matches: Item::is_array, series, sampler };

fn series(field: ParameterRef, item: &Item) -> Result<Series, Diagnostic> {
    let values = values(field, item)?;
    Ok(Series::new(values.len() as u64, move |index| {
        usize::try_from(index).ok().and_then(|i| values.get(i).cloned()).unwrap_or_else(|| Value::from(""))
    }))
}

/// Reads the values, each in the field's own type.
fn values(field: ParameterRef, item: &Item) -> Result<Vec<Value>, Diagnostic> {
    let path = field.path();
    let written: Vec<&Value> = item.as_array().into_iter().flat_map(Array::iter).collect();
    if written.is_empty() {
        return Err(field_error(
            codes::INVALID_AXIS,
            &path,
            Some("[]"),
            "empty axis",
            "give at least one value",
        ));
    }
    let values: Vec<_> = written.into_iter().map(|v| accepted(field, v)).collect::<Result<_, _>>()?;
    let mut seen = HashSet::new();
    for value in &values {
        let text = value.to_string();
        if !seen.insert(text.clone()) {
            return Err(field_error(
                codes::DUPLICATE_ENTRY,
                &path,
                Some(&text),
                "duplicate value",
                "list each value once",
            ));
        }
    }
    Ok(values)
}

fn sampler(field: ParameterRef, item: &Item) -> Result<Sampler, Diagnostic> {
    let all = values(field, item)?;
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, clippy::cast_precision_loss)]
    let at = move |share: f64| all[((share * all.len() as f64) as usize).min(all.len() - 1)].clone();
    Ok(Box::new(at))
}
