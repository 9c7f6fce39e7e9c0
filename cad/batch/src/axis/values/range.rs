//! Ranges in every notation: their ends, and the keys between them.

use pinswitch_diagnostic::{Diagnostic, codes, short_number};
use toml_edit::{Item, TableLike, Value};

use crate::axis::{ParameterRef, accepted, is_whole};
use crate::diagnostics::field_error;

const KEYS: [&str; 5] = ["from", "to", "step", "count", "spacing"];
const FORM: &str = "write a list, or { from = .., to = .., step = .. } or { from = .., to = .., count = .. }";

/// A range of numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Range {
    /// First value.
    pub(super) from: f64,
    /// Upper bound of the values.
    pub(super) to: f64,
    /// Step of the grid of the values, which starts at `from`.
    pub(super) step: Option<f64>,
    /// Number of values.
    pub(super) count: Option<usize>,
    /// Whether equal steps are equal ratios.
    is_logarithmic: bool,
    /// Whether the field takes whole numbers only.
    pub(super) is_whole: bool,
}

/// Returns whether `item` is a table with this key.
pub(super) fn has_key(item: &Item, key: &str) -> bool {
    item.as_table_like().is_some_and(|table| table.contains_key(key))
}

/// The error for values in no known notation.
pub(super) fn unknown_notation(field: ParameterRef, item: &Item) -> Diagnostic {
    match Range::read(field, item) {
        Err(e) => e,
        Ok(_) => field_error(codes::INVALID_AXIS, &field.path(), None, "neither a list nor a range", FORM),
    }
}

impl Range {
    /// Reads `{ from, to, step | count, spacing }` over a numeric field.
    ///
    /// # Errors
    /// A field that does not take numbers, a missing or unknown key, and a range that runs
    /// backwards.
    pub(super) fn read(field: ParameterRef, item: &Item) -> Result<Self, Diagnostic> {
        let path = field.path();
        let is_whole = is_whole(field).ok_or_else(|| {
            let help = format!("give a list of values; it takes {}", (field.range)());
            field_error(
                codes::INVALID_AXIS,
                &path,
                None,
                "range over a field that does not take numbers",
                help,
            )
        })?;
        let table = item.as_table_like().ok_or_else(|| {
            field_error(
                codes::INVALID_AXIS,
                &path,
                Some(&item.to_string()),
                "neither a list nor a range",
                FORM,
            )
        })?;
        if let Some((key, _)) = table.iter().find(|(key, _)| !KEYS.contains(key)) {
            return Err(field_error(
                codes::INVALID_AXIS,
                &format!("{path}.{key}"),
                None,
                "unknown key of a range",
                FORM,
            ));
        }
        let (Some(from), Some(to)) = (number(table, &path, "from")?, number(table, &path, "to")?) else {
            return Err(field_error(codes::INVALID_AXIS, &path, None, "range without from or to", FORM));
        };
        let range = Self {
            from,
            to,
            step: number(table, &path, "step")?,
            count: count(table, &path)?,
            is_logarithmic: is_logarithmic(table, &path)?,
            is_whole,
        };
        range.check(&path)?;
        for end in [from, to] {
            accepted(field, &range.value(end))?;
        }
        Ok(range)
    }

    /// Checks that the keys are consistent.
    fn check(&self, path: &str) -> Result<(), Diagnostic> {
        let Self { from, to, step, count, is_logarithmic, .. } = *self;
        if from > to {
            let value = format!("{} to {}", short_number(from), short_number(to));
            let help = format!("write from = {}, to = {}", short_number(to), short_number(from));
            return Err(field_error(codes::INVALID_RANGE, path, Some(&value), "from is above to", help));
        }
        if let Some(step) = step.filter(|s| *s <= 0.0) {
            let field = format!("{path}.step");
            return Err(field_error(
                codes::INVALID_AXIS,
                &field,
                Some(&short_number(step)),
                "not above 0",
                "give a step above 0",
            ));
        }
        if is_logarithmic && (from <= 0.0 || step.is_some()) {
            let problem = "logarithmic range with a step, or not above 0";
            return Err(field_error(
                codes::INVALID_AXIS,
                path,
                None,
                problem,
                "start above 0, and give count instead of step",
            ));
        }
        if step.is_some() && count.is_some() {
            return Err(field_error(
                codes::INVALID_AXIS,
                path,
                None,
                "range with step and count",
                "keep one of them",
            ));
        }
        Ok(())
    }

    /// Returns `x` in the field's type.
    #[allow(clippy::cast_possible_truncation)]
    pub(super) fn value(&self, x: f64) -> Value {
        // A field of whole numbers refuses a fraction itself.
        if self.is_whole && x.fract() == 0.0 { Value::from(x as i64) } else { Value::from(x) }
    }

    /// Returns the number at `share` of the range, 0 to 1.
    pub(super) fn at(&self, share: f64) -> f64 {
        let x = if self.is_logarithmic {
            self.from * (self.to / self.from).powf(share)
        } else {
            self.from + (self.to - self.from) * share
        };
        if self.is_whole { x.round() } else { without_float_noise(x) }
    }

    /// Checks that `field` accepts the number.
    ///
    /// # Errors
    /// A number that it does not accept.
    pub(super) fn accept(&self, field: ParameterRef, number: f64) -> Result<(), Diagnostic> {
        accepted(field, &self.value(number)).map(drop)
    }

    /// Returns how many of `count` values certainly differ: whole numbers between the ends, or
    /// steps of at least `min_relative_step` of the larger end. For large counts.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    pub(super) fn different_values(&self, count: usize, min_relative_step: f64) -> usize {
        let width = self.to - self.from;
        let min_step =
            if self.is_whole { 1.0 } else { min_relative_step * self.from.abs().max(self.to.abs()) };
        // A logarithmic range has its smallest step at its start.
        let narrowest = if self.is_logarithmic { width * self.from / self.to } else { width };
        let most = if min_step > 0.0 { narrowest / min_step + 1.0 } else { 1.0 };
        count.min(most as usize)
    }
}

fn number(table: &dyn TableLike, path: &str, key: &str) -> Result<Option<f64>, Diagnostic> {
    let Some(item) = table.get(key) else { return Ok(None) };
    #[allow(clippy::cast_precision_loss)]
    let number = item.as_float().or_else(|| item.as_integer().map(|i| i as f64));
    number.filter(|x| x.is_finite()).map(Some).ok_or_else(|| {
        let field = format!("{path}.{key}");
        field_error(
            codes::WRONG_TYPE,
            &field,
            Some(&item.to_string()),
            "not a finite number",
            "give a finite number",
        )
    })
}

fn count(table: &dyn TableLike, path: &str) -> Result<Option<usize>, Diagnostic> {
    let Some(item) = table.get("count") else { return Ok(None) };
    let count = item.as_integer().and_then(|n| usize::try_from(n).ok()).filter(|n| *n >= 1);
    count.map(Some).ok_or_else(|| {
        let field = format!("{path}.count");
        field_error(
            codes::WRONG_TYPE,
            &field,
            Some(&item.to_string()),
            "not a positive whole number",
            "give 1 or more",
        )
    })
}

fn is_logarithmic(table: &dyn TableLike, path: &str) -> Result<bool, Diagnostic> {
    match table.get("spacing").map(Item::as_str) {
        None | Some(Some("linear")) => Ok(false),
        Some(Some("log")) => Ok(true),
        Some(_) => {
            let field = format!("{path}.spacing");
            Err(field_error(
                codes::UNKNOWN_WORD,
                &field,
                None,
                "unknown spacing",
                "give \"linear\" or \"log\"",
            ))
        }
    }
}

/// Rounds to 13 digits, without the noise of binary fractions: 0.3, not 0.30000000000000004.
pub(super) fn without_float_noise(x: f64) -> f64 {
    format!("{x:.12e}").parse().unwrap_or(x)
}
