//! What to change where a part cannot be built for a reason that no rule knows: the field that decides, and its bound.

use toml_edit::Value;

use crate::built::BuiltPart;
use crate::config::parameter::Parameter;
use crate::config::{ConfigError, Configuration};
use crate::design::Design;
use crate::output::BuildError;
use crate::parts::printed;

/// Halvings of the way between a value that fits and one that does not.
const HALVINGS: usize = 12;

/// The error in a field for a part that cannot be built: the first field whose default lets it be built, with the
/// value nearest to what was asked for that does. Any other error stays as it is, and so does one that no single field
/// decides.
pub(crate) fn diagnosed(error: BuildError, design: &Design) -> BuildError {
    let part = match &error {
        BuildError::Cap { part, .. } | BuildError::Invalid { part, .. } => part.clone(),
        BuildError::Configuration(_) => return error,
    };
    let c = design.configuration();
    let defaults = Configuration::default();
    let found = Configuration::PARAMETERS.iter().find_map(|field| blame(field, &part, c, &defaults));
    found.map_or(error, BuildError::Configuration)
}

fn blame(
    field: &Parameter<Configuration>,
    part: &str,
    c: &Configuration,
    defaults: &Configuration,
) -> Option<ConfigError> {
    let (asked, default) = ((field.get)(c).as_float()?, (field.get)(defaults).as_float()?);
    let fits = |value: f64| {
        let mut trial = c.clone();
        (field.set)(&mut trial, &Value::from(value)).is_ok() && can_be_built(trial, part)
    };
    if asked == default || !fits(default) {
        return None;
    }
    let (mut good, mut bad) = (default, asked);
    for _ in 0..HALVINGS {
        let middle = (good + bad) / 2.0;
        if fits(middle) { good = middle } else { bad = middle }
    }
    // Shown with three decimals, towards the default, which fits.
    let rounded = if asked > default { (good * 1e3).floor() / 1e3 } else { (good * 1e3).ceil() / 1e3 };
    let shown = if fits(rounded) { rounded } else { default };
    let verb = if asked > default { "lower" } else { "raise" };
    Some(ConfigError {
        field: field.path(),
        value: c.shown(&field.path()),
        problem: format!("does not fit this geometry: contours of {part} cross"),
        remedy: format!("{verb} it to {shown}"),
        changes: vec![(field.path(), shown.to_string())],
        place: None,
    })
}

fn can_be_built(configuration: Configuration, part: &str) -> bool {
    Design::new(configuration).is_ok_and(|design| {
        printed(&design).is_ok_and(|parts| {
            parts.into_iter().filter(|p| p.name == part).all(|p| BuiltPart::new(p, &design).is_ok())
        })
    })
}
