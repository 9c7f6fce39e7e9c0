//! `{ from = 10, to = 12 }`: every value between two ends, for samples only.

use pinswitch_diagnostic::{Diagnostic, codes};
use toml_edit::Item;

use super::range::{Range, has_key};
use super::step::on_grid;
use super::{Notation, Sampler, Series};
use crate::axis::ParameterRef;
use crate::diagnostics::field_error;

pub(super) const NOTATION: Notation = Notation { matches: |item| has_key(item, "from"), series, sampler };

fn series(field: ParameterRef, item: &Item) -> Result<Series, Diagnostic> {
    Range::read(field, item)?;
    let help = "add step = ... or count = ...";
    Err(field_error(codes::INVALID_AXIS, &field.path(), None, "range without step or count", help))
}

fn sampler(field: ParameterRef, item: &Item) -> Result<Sampler, Diagnostic> {
    let range = Range::read(field, item)?;
    Ok(if range.is_whole { on_grid(range, 1.0) } else { Box::new(move |share| range.value(range.at(share))) })
}
