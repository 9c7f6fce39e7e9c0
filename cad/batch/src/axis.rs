//! Axes of a sweep: the values that one field takes, or that several take together.

use toml_edit::{Item, Value};

use pinswitch_switch::config::parameter::Parameter;
use pinswitch_switch::config::{ConfigError, Configuration};

/// A parameter of the configuration.
pub type ParameterRef = &'static Parameter<Configuration>;

/// Number of steps beyond which a range is taken for a typing error.
const MAX_STEPS: f64 = 1e7;

/// One dimension of a sweep: fields, and the values that they take together, row by row.
#[derive(Clone)]
pub struct SweepAxis {
    /// The fields that vary.
    pub fields: Vec<ParameterRef>,
    /// One value per field in every row.
    pub rows: Vec<Vec<Value>>,
}

impl std::fmt::Debug for SweepAxis {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let fields: Vec<_> = self.fields.iter().map(|p| p.path()).collect();
        write!(f, "{} rows of {}", self.rows.len(), fields.join(", "))
    }
}

/// A range of numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Range {
    /// First value.
    pub from: f64,
    /// Last value that may occur.
    pub to: f64,
    /// Grid on which the values lie, counted from `from`.
    pub step: Option<f64>,
    /// Number of values.
    pub count: Option<usize>,
    /// Whether equal steps are equal ratios.
    pub logarithmic: bool,
    /// Whether the field takes whole numbers only.
    pub whole: bool,
}

/// The field called `path`.
///
/// # Errors
/// [`ConfigError`] for a field that does not exist, or that a batch sets itself.
pub(super) fn field(path: &str) -> Result<ParameterRef, ConfigError> {
    let all = Configuration::PARAMETERS;
    if path == "switch.name" {
        return Err(config_error(
            path,
            None,
            "is set by the batch itself, to each variant's id",
            "leave it out",
        ));
    }
    all.iter().find(|p| p.path() == path).ok_or_else(|| {
        let near = all
            .iter()
            .map(|p| p.path())
            .max_by(|a, b| strsim::jaro_winkler(path, a).total_cmp(&strsim::jaro_winkler(path, b)));
        let near = near.unwrap_or_default();
        config_error(
            path,
            None,
            "is no known field",
            &format!("did you mean \"{near}\"? templates/reference.toml lists all"),
        )
    })
}

/// Whether `field` takes numbers, and if so whether they are whole.
pub(super) fn numeric(field: ParameterRef) -> Option<bool> {
    match (field.get)(&Configuration::default()) {
        Value::Integer(_) => Some(true),
        Value::Float(_) => Some(false),
        _ => None,
    }
}

/// `value`, if `field` accepts it; in the field's own type.
///
/// # Errors
/// [`ConfigError`] with the accepted range.
pub(super) fn accepted(field: ParameterRef, value: &Value) -> Result<Value, ConfigError> {
    let mut scratch = Configuration::default();
    (field.set)(&mut scratch, value).map_err(|remedy| {
        ConfigError::new(field.path(), value.clone().decorated("", "").to_string(), remedy)
    })?;
    Ok((field.get)(&scratch))
}

/// An axis of a grid: a list of values, or a range with `step` or `count`.
///
/// # Errors
/// [`ConfigError`] for values that the field does not accept, an empty or repeating list, or a bad range.
pub(super) fn axis(path: &str, item: &Item) -> Result<SweepAxis, ConfigError> {
    let field = field(path)?;
    let values = match item.as_value() {
        Some(Value::Array(list)) => listed(field, list)?,
        _ => {
            let range = range(field, item)?;
            if range.step.is_none() && range.count.is_none() {
                return Err(config_error(
                    path,
                    None,
                    "has neither step nor count",
                    "add step = ... or count = ...",
                ));
            }
            let numbers = range.values(path)?;
            numbers.into_iter().map(|x| accepted(field, &range.value(x))).collect::<Result<_, _>>()?
        }
    };
    Ok(SweepAxis { fields: vec![field], rows: values.into_iter().map(|v| vec![v]).collect() })
}

/// The values of a list.
pub(super) fn listed(field: ParameterRef, list: &toml_edit::Array) -> Result<Vec<Value>, ConfigError> {
    let path = field.path();
    if list.is_empty() {
        return Err(config_error(&path, Some("[]"), "is an empty axis", "give at least one value"));
    }
    let values: Vec<_> = list.iter().map(|v| accepted(field, v)).collect::<Result<_, _>>()?;
    for (i, value) in values.iter().enumerate() {
        let text = value.to_string();
        if values[..i].iter().any(|v| v.to_string() == text) {
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

/// Reads `{ from, to, step | count, spacing }` over a numeric field.
///
/// # Errors
/// [`ConfigError`] for a field of words, a missing or unknown key, or a range that runs backwards.
pub(super) fn range(field: ParameterRef, item: &Item) -> Result<Range, ConfigError> {
    let path = field.path();
    let Some(whole) = numeric(field) else {
        return Err(config_error(
            &path,
            None,
            "takes no numbers, so no range",
            &format!("give a list of values; it takes {}", (field.range)()),
        ));
    };
    let form = "write a list, or { from = .., to = .., step = .. } or { from = .., to = .., count = .. }";
    let Some(table) = item.as_table_like() else {
        return Err(config_error(&path, Some(&item.to_string()), "is no axis", form));
    };
    const KEYS: [&str; 5] = ["from", "to", "step", "count", "spacing"];
    if let Some((key, _)) = table.iter().find(|(key, _)| !KEYS.contains(key)) {
        return Err(config_error(&format!("{path}.{key}"), None, "is no key of a range", form));
    }
    #[allow(clippy::cast_precision_loss)]
    let number = |key: &str| -> Result<Option<f64>, ConfigError> {
        let Some(item) = table.get(key) else { return Ok(None) };
        let number = item.as_float().or_else(|| item.as_integer().map(|i| i as f64));
        number.filter(|x| x.is_finite()).map(Some).ok_or_else(|| {
            let text = item.to_string();
            config_error(&format!("{path}.{key}"), Some(text.trim()), "is no number", "give a finite number")
        })
    };
    let (Some(from), Some(to)) = (number("from")?, number("to")?) else {
        return Err(config_error(&path, None, "lacks from or to", form));
    };
    let step = number("step")?;
    let count = match table.get("count") {
        None => None,
        Some(item) => Some(
            item.as_integer().and_then(|n| usize::try_from(n).ok()).filter(|n| *n >= 1).ok_or_else(|| {
                let text = item.to_string();
                config_error(&format!("{path}.count"), Some(text.trim()), "is no count", "give 1 or more")
            })?,
        ),
    };
    let logarithmic = match table.get("spacing").map(|s| s.as_str()) {
        None | Some(Some("linear")) => false,
        Some(Some("log")) => true,
        Some(_) => {
            return Err(config_error(
                &format!("{path}.spacing"),
                None,
                "is no spacing",
                "give \"linear\" or \"log\"",
            ));
        }
    };
    if from > to {
        return Err(config_error(
            &path,
            Some(&format!("{from} to {to}")),
            "runs backwards",
            &format!("write from = {to}, to = {from}"),
        ));
    }
    if let Some(step) = step.filter(|s| *s <= 0.0) {
        return Err(config_error(
            &format!("{path}.step"),
            Some(&step.to_string()),
            "leads nowhere",
            "give a step above 0",
        ));
    }
    if logarithmic && (from <= 0.0 || step.is_some()) {
        return Err(config_error(
            &path,
            None,
            "cannot be logarithmic",
            "start above 0 and give count, not step",
        ));
    }
    if step.is_some() && count.is_some() {
        return Err(config_error(&path, None, "has both step and count", "keep one of them"));
    }
    let range = Range { from, to, step, count, logarithmic, whole };
    for end in [from, to] {
        accepted(field, &range.value(end))?;
    }
    Ok(range)
}

impl Range {
    /// `x` in the field's type.
    #[allow(clippy::cast_possible_truncation)]
    pub(super) fn value(&self, x: f64) -> Value {
        if self.whole && x.fract() == 0.0 { Value::from(x as i64) } else { Value::from(x) }
    }

    /// The value at `share` of the way, 0..=1.
    fn at(&self, share: f64) -> f64 {
        let x = if self.logarithmic {
            self.from * (self.to / self.from).powf(share)
        } else {
            self.from + (self.to - self.from) * share
        };
        if self.whole { x.round() } else { without_float_noise(x) }
    }

    /// The value for a coordinate of a sample; on a grid, all values are equally likely.
    pub(super) fn sampled_value(&self, share: f64) -> f64 {
        match self.step.or(self.whole.then_some(1.0)) {
            Some(step) => {
                let last = ((self.to - self.from) / step + 1e-9).floor();
                without_float_noise(self.from + step * (share * (last + 1.0)).floor().min(last))
            }
            None => self.at(share),
        }
    }

    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, clippy::cast_precision_loss)]
    fn values(&self, path: &str) -> Result<Vec<f64>, ConfigError> {
        if let Some(step) = self.step {
            let steps = ((self.to - self.from) / step + 1e-9).floor();
            if steps > MAX_STEPS {
                return Err(config_error(
                    path,
                    Some(&format!("{} to {} by {step}", self.from, self.to)),
                    "has more than ten million values",
                    "raise step",
                ));
            }
            return Ok((0..=steps as usize)
                .map(|i| without_float_noise(self.from + step * i as f64))
                .collect());
        }
        let count = self.count.unwrap_or(1);
        if count > MAX_STEPS as usize {
            return Err(config_error(path, Some(&count.to_string()), "is too many values", "lower count"));
        }
        let last = (count.max(2) - 1) as f64;
        let mut values: Vec<_> = (0..count).map(|i| self.at(i as f64 / last)).collect();
        values.dedup();
        if values.len() < count {
            return Err(config_error(
                path,
                Some(&format!("{count} values from {} to {}", self.from, self.to)),
                "holds fewer different values",
                &format!("lower count to {}", values.len()),
            ));
        }
        Ok(values)
    }
}

/// `x` without the noise of binary fractions: 0.3, not 0.30000000000000004.
fn without_float_noise(x: f64) -> f64 {
    format!("{x:.12e}").parse().unwrap_or(x)
}

/// An error in an axis.
pub(super) fn config_error(field: &str, value: Option<&str>, problem: &str, remedy: &str) -> ConfigError {
    ConfigError {
        field: field.to_owned(),
        value: value.map(|v| v.trim().to_owned()),
        problem: problem.to_owned(),
        remedy: remedy.to_owned(),
        place: None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn values(path: &str, text: &str) -> Result<Vec<String>, String> {
        let item = Item::Value(text.parse().unwrap());
        let level = axis(path, &item).map_err(|e| e.to_string())?;
        Ok(level.rows.iter().map(|r| r[0].to_string()).collect())
    }

    #[test]
    fn lists_and_ranges_give_their_values() {
        assert_eq!(values("shell.width_mm", "[10, 12.5]").unwrap(), ["10.0", "12.5"]);
        assert_eq!(values("layout.pins", "[[5, 8], []]").unwrap(), ["[5, 8]", "[]"]);
        let steps = values("shell.width_mm", "{ from = 10, to = 10.35, step = 0.1 }").unwrap();
        assert_eq!(steps, ["10.0", "10.1", "10.2", "10.3"]);
        assert_eq!(values("segment.grooves", "{ from = 3, to = 9, count = 3 }").unwrap(), ["3", "6", "9"]);
        let ratios = values("shell.width_mm", "{ from = 4, to = 16, count = 3, spacing = \"log\" }").unwrap();
        assert_eq!(ratios, ["4.0", "8.0", "16.0"]);
    }

    #[test]
    fn bad_axes_say_what_to_change() {
        for (path, text, expected) in [
            ("shell.with_mm", "[1]", "shell.with_mm is no known field; did you mean \"shell.width_mm\"?"),
            ("switch.name", "[\"a\"]", "switch.name is set by the batch itself"),
            (
                "support.slots",
                "{ from = 1, to = 2, step = 1 }",
                "support.slots takes no numbers, so no range",
            ),
            (
                "shell.width_mm",
                "{ from = 16, to = 10, step = 1 }",
                "shell.width_mm = 16 to 10 runs backwards",
            ),
            ("shell.width_mm", "[]", "shell.width_mm = [] is an empty axis"),
            ("shell.width_mm", "[12, 12.0]", "shell.width_mm = 12.0 stands twice"),
            ("shell.width_mm", "[-3]", "shell.width_mm = -3 is not accepted"),
            ("shell.width_mm", "12", "shell.width_mm = 12 is no axis"),
            ("shell.width_mm", "{ from = 10, to = 12 }", "shell.width_mm has neither step nor count"),
            ("shell.width_mm", "{ from = 10, to = 12, step = 0 }", "shell.width_mm.step = 0 leads nowhere"),
            ("shell.width_mm", "{ from = 10, to = 12, by = 1 }", "shell.width_mm.by is no key of a range"),
            ("shell.width_mm", "{ from = 10, to = 200, step = 1 }", "shell.width_mm = 200.0 is not accepted"),
            (
                "segment.grooves",
                "{ from = 3, to = 5, count = 9 }",
                "segment.grooves = 9 values from 3 to 5 holds",
            ),
            ("segment.grooves", "{ from = 3, to = 5, step = 0.5 }", "segment.grooves = 3.5 is not accepted"),
        ] {
            let error = values(path, text).unwrap_err();
            assert!(error.starts_with(expected), "{error}");
        }
    }
}
