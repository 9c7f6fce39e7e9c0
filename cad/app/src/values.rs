//! Conversion between the values of the page and configurations.

use pinswitch_diagnostic::{Diagnostic, Location, codes};
use pinswitch_switch::config::{Configuration, Name, assign, read};
use pinswitch_switch::formats::page::{Values, changed_values};
use serde::Serialize;

use crate::refusal::Refusal;

/// Longest configuration file that is read, in bytes.
const MAX_CONFIGURATION_BYTES: usize = 1 << 20;

/// Returns the default configuration with these values.
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

/// The values of a configuration file, or why it is refused.
#[derive(Debug, Serialize)]
pub(crate) struct OpenedFile {
    values: Option<Values>,
    trouble: Option<Refusal>,
}

/// Reads the text of a configuration file; `file` is its name in errors.
pub(crate) fn open(text: &str, file: &str) -> OpenedFile {
    match read_values(text, file) {
        Ok(values) => OpenedFile { values: Some(values), trouble: None },
        Err(refusal) => OpenedFile { values: None, trouble: Some(refusal) },
    }
}

fn read_values(text: &str, file: &str) -> Result<Values, Refusal> {
    if text.len() > MAX_CONFIGURATION_BYTES {
        let problem = format!("{} bytes are too long for a configuration", text.len());
        let diagnostic = Diagnostic::new(codes::FILE_TOO_LARGE, problem)
            .with_location(Location::file(file))
            .with_help("drop a TOML file that pinswitch wrote");
        return Err(diagnostic.into());
    }
    let (mut configuration, locations) = read(text, file)?;
    if !locations.contains("switch.name") {
        configuration.switch.name = Name::from_file_stem(file);
    }
    Ok(changed_values(&configuration))
}

#[cfg(test)]
mod tests {
    use super::*;
    use pinswitch_switch::templates;

    #[test]
    fn templates_survive_a_round_trip() {
        for name in templates::names() {
            let (before, _) = read(&templates::text(name).unwrap(), name).unwrap();
            let values = changed_values(&before);
            let text = serde_json::to_string(&values).unwrap();
            let values: Values = serde_json::from_str(&text).unwrap();
            assert_eq!(configuration(&values).unwrap(), before, "{name}");
        }
    }

    #[test]
    fn invalid_values_are_refused_by_field() {
        let values: Values = serde_json::from_str(r#"{"shell.wall_mm": 1e9}"#).unwrap();
        let error = configuration(&values).unwrap_err();
        let location = error.location().unwrap();
        assert_eq!((location.field.as_deref(), &location.file), (Some("shell.wall_mm"), &None));
        for (path, value) in [("shell.wal_mm", "3"), ("x", "3"), ("layout.pins", "\"a\\nb\"")] {
            let values: Values = serde_json::from_str(&format!(r#"{{"{path}": {value}}}"#)).unwrap();
            assert!(configuration(&values).is_err(), "{path}");
        }
    }

    #[test]
    fn invalid_files_are_refused() {
        assert!(open("[shell]\nwall_mm = []", "x.toml").trouble.is_some());
        assert!(open(&"#".repeat(MAX_CONFIGURATION_BYTES + 1), "x.toml").trouble.is_some());
    }
}
