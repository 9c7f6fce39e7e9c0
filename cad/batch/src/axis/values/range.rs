//! What all ranges share: their ends, and the keys between them.

use toml_edit::{Item, TableLike, Value};

use crate::axis::{ParameterRef, accepted, config_error, numeric};
use pinswitch_switch::config::ConfigError;

const KEYS: [&str; 5] = ["from", "to", "step", "count", "spacing"];
const FORM: &str = "write a list, or { from = .., to = .., step = .. } or { from = .., to = .., count = .. }";

/// A range of numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Range {
    /// First value.
    pub(super) from: f64,
    /// Last value that may occur.
    pub(super) to: f64,
    /// Grid on which the values lie, counted from `from`.
    pub(super) step: Option<f64>,
    /// Number of values.
    pub(super) count: Option<usize>,
    /// Whether equal steps are equal ratios.
    logarithmic: bool,
    /// Whether the field takes whole numbers only.
    pub(super) whole: bool,
}

/// Whether `item` is a table with this key.
pub(super) fn has_key(item: &Item, key: &str) -> bool {
    item.as_table_like().is_some_and(|table| table.contains_key(key))
}

/// Why `item` is written in no known way.
pub(super) fn not_written(field: ParameterRef, item: &Item) -> ConfigError {
    match Range::read(field, item) {
        Err(e) => e,
        Ok(_) => config_error(&field.path(), None, "is no axis", FORM),
    }
}

impl Range {
    /// Reads `{ from, to, step | count, spacing }` over a numeric field.
    ///
    /// # Errors
    /// [`ConfigError`] for a field of words, a missing or unknown key, or a range that runs backwards.
    pub(super) fn read(field: ParameterRef, item: &Item) -> Result<Self, ConfigError> {
        let path = field.path();
        let whole = numeric(field).ok_or_else(|| {
            let remedy = format!("give a list of values; it takes {}", (field.range)());
            config_error(&path, None, "takes no numbers, so no range", &remedy)
        })?;
        let table = item
            .as_table_like()
            .ok_or_else(|| config_error(&path, Some(&item.to_string()), "is no axis", FORM))?;
        if let Some((key, _)) = table.iter().find(|(key, _)| !KEYS.contains(key)) {
            return Err(config_error(&format!("{path}.{key}"), None, "is no key of a range", FORM));
        }
        let (Some(from), Some(to)) = (number(table, &path, "from")?, number(table, &path, "to")?) else {
            return Err(config_error(&path, None, "lacks from or to", FORM));
        };
        let range = Self {
            from,
            to,
            step: number(table, &path, "step")?,
            count: count(table, &path)?,
            logarithmic: is_logarithmic(table, &path)?,
            whole,
        };
        range.check(&path)?;
        for end in [from, to] {
            accepted(field, &range.value(end))?;
        }
        Ok(range)
    }

    /// Whether the keys fit each other.
    fn check(&self, path: &str) -> Result<(), ConfigError> {
        let Self { from, to, step, count, logarithmic, .. } = *self;
        if from > to {
            return Err(config_error(
                path,
                Some(&format!("{from} to {to}")),
                "runs backwards",
                &format!("write from = {to}, to = {from}"),
            ));
        }
        if let Some(step) = step.filter(|s| *s <= 0.0) {
            let field = format!("{path}.step");
            return Err(config_error(
                &field,
                Some(&step.to_string()),
                "leads nowhere",
                "give a step above 0",
            ));
        }
        if logarithmic && (from <= 0.0 || step.is_some()) {
            let remedy = "start above 0 and give count, not step";
            return Err(config_error(path, None, "cannot be logarithmic", remedy));
        }
        if step.is_some() && count.is_some() {
            return Err(config_error(path, None, "has both step and count", "keep one of them"));
        }
        Ok(())
    }

    /// `x` in the field's type.
    #[allow(clippy::cast_possible_truncation)]
    pub(super) fn value(&self, x: f64) -> Value {
        // A fraction of a whole number stays one, for the field to refuse.
        if self.whole && x.fract() == 0.0 { Value::from(x as i64) } else { Value::from(x) }
    }

    /// The number at `share` of the way, 0..=1.
    pub(super) fn at(&self, share: f64) -> f64 {
        let x = if self.logarithmic {
            self.from * (self.to / self.from).powf(share)
        } else {
            self.from + (self.to - self.from) * share
        };
        if self.whole { x.round() } else { without_float_noise(x) }
    }

    /// Whether `field` accepts the number.
    ///
    /// # Errors
    /// [`ConfigError`] if it does not.
    pub(super) fn accept(&self, field: ParameterRef, number: f64) -> Result<(), ConfigError> {
        accepted(field, &self.value(number)).map(drop)
    }

    /// How many of `count` values, of which there are many, differ for certain: whole numbers between the ends, or steps
    /// of this width relative to the larger end.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    pub(super) fn different(&self, count: usize, least_relative_step: f64) -> usize {
        let width = self.to - self.from;
        let least_step =
            if self.whole { 1.0 } else { least_relative_step * self.from.abs().max(self.to.abs()) };
        // A logarithmic range is narrowest at its start.
        let narrowest = if self.logarithmic { width * self.from / self.to } else { width };
        let most = if least_step > 0.0 { narrowest / least_step + 1.0 } else { 1.0 };
        count.min(most as usize)
    }
}

fn number(table: &dyn TableLike, path: &str, key: &str) -> Result<Option<f64>, ConfigError> {
    let Some(item) = table.get(key) else { return Ok(None) };
    #[allow(clippy::cast_precision_loss)]
    let number = item.as_float().or_else(|| item.as_integer().map(|i| i as f64));
    number.filter(|x| x.is_finite()).map(Some).ok_or_else(|| {
        let text = item.to_string();
        config_error(&format!("{path}.{key}"), Some(text.trim()), "is no number", "give a finite number")
    })
}

fn count(table: &dyn TableLike, path: &str) -> Result<Option<usize>, ConfigError> {
    let Some(item) = table.get("count") else { return Ok(None) };
    let count = item.as_integer().and_then(|n| usize::try_from(n).ok()).filter(|n| *n >= 1);
    count.map(Some).ok_or_else(|| {
        let text = item.to_string();
        config_error(&format!("{path}.count"), Some(text.trim()), "is no count", "give 1 or more")
    })
}

fn is_logarithmic(table: &dyn TableLike, path: &str) -> Result<bool, ConfigError> {
    match table.get("spacing").map(Item::as_str) {
        None | Some(Some("linear")) => Ok(false),
        Some(Some("log")) => Ok(true),
        Some(_) => {
            let field = format!("{path}.spacing");
            Err(config_error(&field, None, "is no spacing", "give \"linear\" or \"log\""))
        }
    }
}

/// `x` without the noise of binary fractions: 0.3, not 0.30000000000000004.
pub(super) fn without_float_noise(x: f64) -> f64 {
    format!("{x:.12e}").parse().unwrap_or(x)
}
