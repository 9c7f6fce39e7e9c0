//! Between the values of the page and configurations.

use pinswitch_switch::config::parameter::Parameter;
use pinswitch_switch::config::{Configuration, Diagnostic, Name, assign, read};
use pinswitch_switch::documents::toml_to_json;
use serde::Serialize;

use crate::request::Values;
use crate::trouble::Trouble;

/// Longest text of a configuration that is read.
const LONGEST: usize = 1 << 20;

/// The configuration with these values.
///
/// # Errors
/// A [`Diagnostic`] for a field that is unknown or a value out of its range.
pub fn configuration(values: &Values) -> Result<Configuration, Diagnostic> {
    let mut configuration = Configuration::default();
    for (path, value) in values {
        // JSON of a number, a list of them, a truth value or a text of printable characters is TOML.
        assign(&mut configuration, &format!("{path}={value}"))?;
    }
    Ok(configuration)
}

/// The values in which a configuration differs from the defaults.
pub fn values(configuration: &Configuration) -> Values {
    let defaults = Configuration::default();
    let shown = |p: &Parameter<Configuration>, c: &Configuration| (p.get)(c);
    Configuration::PARAMETERS
        .iter()
        .filter(|p| shown(p, configuration).to_string() != shown(p, &defaults).to_string())
        .map(|p| (p.path(), toml_to_json(&shown(p, configuration))))
        .collect()
}

/// The values of a file, or what is wrong with it.
#[derive(Debug, Serialize)]
pub(crate) struct Opened {
    values: Option<Values>,
    trouble: Option<Trouble>,
}

/// Reads the text of a configuration; `file` names it in errors.
pub(crate) fn opened(text: &str, file: &str) -> Opened {
    if text.len() > LONGEST {
        let trouble = Trouble::general(format!(
            "{file}: {} bytes are no configuration, which has some hundred; drop a TOML file that pinswitch wrote",
            text.len()
        ));
        return Opened { values: None, trouble: Some(trouble) };
    }
    match read(text, file) {
        Ok((mut configuration, locations)) => {
            if !locations.contains("switch.name") {
                configuration.switch.name = Name::from_file_stem(file);
            }
            Opened { values: Some(values(&configuration)), trouble: None }
        }
        Err(error) => Opened { values: None, trouble: Some(error.into()) },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use pinswitch_switch::templates;

    #[test]
    fn every_template_goes_through_values_and_back() {
        for name in templates::names() {
            let (before, _) = read(&templates::text(name).unwrap(), name).unwrap();
            let values = values(&before);
            let text = serde_json::to_string(&values).unwrap();
            let values: Values = serde_json::from_str(&text).unwrap();
            assert_eq!(configuration(&values).unwrap(), before, "{name}");
        }
    }

    #[test]
    fn what_is_no_value_is_named_without_a_place() {
        let values: Values = serde_json::from_str(r#"{"shell.wall_mm": 1e9}"#).unwrap();
        let error = configuration(&values).unwrap_err();
        let location = error.location().unwrap();
        assert_eq!((location.field.as_deref(), &location.file), (Some("shell.wall_mm"), &None));
        for (path, value) in [("shell.wal_mm", "3"), ("x", "3"), ("layout.pins", "\"a\\nb\"")] {
            let values: Values = serde_json::from_str(&format!(r#"{{"{path}": {value}}}"#)).unwrap();
            assert!(configuration(&values).is_err(), "{path}");
        }
        assert!(opened("[shell]\nwall_mm = []", "x.toml").trouble.is_some());
        assert!(opened(&"#".repeat(LONGEST + 1), "x.toml").trouble.is_some());
    }
}
