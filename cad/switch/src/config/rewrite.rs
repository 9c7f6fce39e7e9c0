//! Values written back into the text of a configuration, whose comments and order stay.

use toml_edit::{DocumentMut, Item, Table, TableLike, Value};

use super::parameters::Configuration;
use super::read::read;
use super::{ConfigError, Place};

/// `text` with the values of `configuration`: what it sets otherwise is changed in its place, what it does not set and is
/// no default is added to its table. Everything else stays as it is, comments too. `file` names the text in errors.
///
/// ```
/// use pinswitch_switch::config::{Configuration, assign, read, rewritten};
///
/// let text = "# mine\n[shell]\nwidth_mm = 12 # narrow\n";
/// let (mut configuration, _) = read(text, "mine.toml")?;
/// assign(&mut configuration, "shell.width_mm=13")?;
/// assert_eq!(rewritten(text, "mine.toml", &configuration)?, "# mine\n[shell]\nwidth_mm = 13.0 # narrow\n");
/// # Ok::<(), pinswitch_switch::config::ConfigError>(())
/// ```
///
/// # Errors
/// [`ConfigError`] for a text that is no configuration.
pub fn rewritten(text: &str, file: &str, configuration: &Configuration) -> Result<String, ConfigError> {
    let (before, _) = read(text, file)?;
    let mut document: DocumentMut = text.parse().map_err(|e: toml_edit::TomlError| {
        ConfigError::syntax(Place::new(file, text, e.span().map_or(0, |s| s.start)), e.message())
    })?;
    for parameter in Configuration::PARAMETERS {
        let value = (parameter.get)(configuration);
        if value.to_string() == (parameter.get)(&before).to_string() {
            continue;
        }
        let table = document.entry(parameter.section).or_insert_with(|| Item::Table(Table::new()));
        if let Some(table) = table.as_table_like_mut() {
            put(table, parameter.key, value);
        }
    }
    Ok(document.to_string())
}

/// Sets a key to a value; what stands before and behind an old value stays there.
fn put(table: &mut dyn TableLike, key: &str, mut value: Value) {
    match table.get_mut(key).and_then(Item::as_value_mut) {
        Some(old) => {
            *value.decor_mut() = old.decor().clone();
            *old = value;
        }
        None => {
            table.insert(key, Item::Value(value));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::assign;
    use crate::templates;

    #[test]
    fn every_template_is_rewritten_to_every_other() {
        for from in templates::names() {
            let text = templates::text(from).unwrap();
            let (own, _) = read(&text, from).unwrap();
            assert_eq!(rewritten(&text, from, &own).unwrap(), text, "nothing to change changes nothing");
            for to in templates::names() {
                let (wanted, _) = read(&templates::text(to).unwrap(), to).unwrap();
                let changed = rewritten(&text, from, &wanted).unwrap();
                assert_eq!(read(&changed, from).unwrap().0, wanted, "{from} to {to}");
                let comments = |text: &str| text.lines().filter(|l| l.trim_start().starts_with('#')).count();
                assert_eq!(comments(&changed), comments(&text), "{from} to {to}");
            }
        }
    }

    #[test]
    fn inline_tables_and_missing_tables_take_values() {
        let text = "shell = { width_mm = 12 } # inline\n";
        let (mut wanted, _) = read(text, "x.toml").unwrap();
        for assignment in ["shell.wall_mm=9", "shell.width_mm=14", "layout.pins=[5, 8]"] {
            assign(&mut wanted, assignment).unwrap();
        }
        let changed = rewritten(text, "x.toml", &wanted).unwrap();
        assert_eq!(read(&changed, "x.toml").unwrap().0, wanted, "{changed}");
        assert!(changed.contains("# inline"), "{changed}");
        assert!(rewritten("[shell", "x.toml", &wanted).is_err());
    }
}
