//! Configurations as TOML: what differs from the defaults, or everything with its explanation.

use super::parameters::Configuration;

/// Every parameter with its unit, range, origin and reason, at its default: `templates/reference.toml`.
pub fn reference_toml() -> String {
    let defaults = Configuration::default();
    let mut text =
        "# Every parameter of pinswitch, at its default. Copy what you change; all are optional.\n\
                    # Written by `pinswitch init reference`; a test keeps it so.\n"
            .to_owned();
    let mut section = "";
    for parameter in Configuration::PARAMETERS {
        if parameter.section != section {
            section = parameter.section;
            text += &format!("\n[{section}]\n");
        }
        let unit = if parameter.unit().is_empty() { String::new() } else { format!(" {}", parameter.unit()) };
        text += &format!(
            "# {}. Range: {}{unit}. Origin: {}.\n{} = {}\n",
            parameter.reason,
            (parameter.range)(),
            parameter.origin,
            parameter.key,
            (parameter.get)(&defaults)
        );
    }
    text
}

/// The parameters that differ from the defaults, as TOML that reads back to `configuration`.
pub fn to_toml(configuration: &Configuration) -> String {
    let defaults = Configuration::default();
    let mut text = String::new();
    let mut section = "";
    for parameter in Configuration::PARAMETERS {
        let value = (parameter.get)(configuration).to_string();
        // A file without a name would lend its own.
        let is_name = (parameter.section, parameter.key) == ("switch", "name");
        if !is_name && value == (parameter.get)(&defaults).to_string() {
            continue;
        }
        if parameter.section != section {
            section = parameter.section;
            text += &format!("{}[{section}]\n", if text.is_empty() { "" } else { "\n" });
        }
        text += &format!("{} = {value}\n", parameter.key);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::{assign, read, read_over};

    #[test]
    fn the_reference_reads_back_to_the_defaults() {
        let (back, _) = read(&reference_toml(), "reference.toml").unwrap();
        assert_eq!(back, Configuration::default());
    }

    #[test]
    fn what_a_file_sets_wins_over_its_preset_even_at_the_default() {
        let (preset, _) = read("[shell]\nwidth_mm = 20.0\nwall_mm = 7.0\n", "preset").unwrap();
        let default = Configuration::default().shell.width_mm;
        let (both, _) = read_over(preset, &format!("[shell]\nwidth_mm = {default}\n"), "mine").unwrap();
        assert_eq!((both.shell.width_mm, both.shell.wall_mm), (default, 7.0));
    }

    #[test]
    fn a_changed_configuration_reads_back() {
        let mut changed = Configuration::default();
        for assignment in ["shell.width_mm=12.5", "support.slots=occupied", "layout.pins=[5, 8, 11]"] {
            assign(&mut changed, assignment).unwrap();
        }
        let text = to_toml(&changed);
        assert_eq!(read(&text, "x").unwrap().0, changed);
        // What was changed, and the name, which no file may lend.
        assert_eq!(text.lines().filter(|l| l.contains('=')).count(), 4);
    }

    #[test]
    fn complaints_name_file_line_field_value_and_remedy() {
        for (text, expected) in [
            (
                "[shell]\nwidth_mm = -3\n",
                "a.toml:2: shell.width_mm = -3 is not accepted; give a number within 2 to 100",
            ),
            ("[shell]\nwith_mm = 3\n", "a.toml:2: shell.with_mm is no known key; did you mean \"width_mm\"?"),
            ("\n\n[shel]\nwidth_mm = 3\n", "a.toml:3: shel is no known table; did you mean \"shell\"?"),
            ("[shell]\nwidth_mm = 3\n[noise]\n", "a.toml:3: noise is no known table"),
            (
                "silicone = true\n[noise]\n",
                "a.toml:1: noise is of no configuration: this is a rig to simulate",
            ),
            (
                "[support]\nslots = \"some\"\n",
                "a.toml:2: support.slots = \"some\" is not accepted; give \"all\" or \"occupied\"",
            ),
            (
                "[segment]\ngrooves = 1.5\n",
                "a.toml:2: segment.grooves = 1.5 is not accepted; give a whole number",
            ),
            ("[shell]\nwidth_mm = nan\n", "a.toml:2: shell.width_mm = nan is not accepted"),
            ("[layout]\npins = [1, -2]\n", "a.toml:2: layout.pins = [1, -2] is not accepted; give a list"),
            ("shell = 3\n", "a.toml:1: shell = integer is not accepted; write it as a table: [shell]"),
            ("[shell\n", "a.toml:1: syntax"),
            ("[shell]\nwidth_mm = 3\nwidth_mm = 4\n", "a.toml:3: syntax duplicate key"),
        ] {
            let error = read(text, "a.toml").unwrap_err().to_string();
            assert!(error.starts_with(expected), "{error}");
        }
        for (text, mends) in [
            ("[shell]\nwidth_mm = -3\n", Some("2")),
            ("[shell]\nwidth_mm = 1e9\n", Some("100")),
            ("[segment]\ngrooves = 0\n", Some("1")),
            ("[segment]\ngrooves = 3.5\n", None),
            ("[shell]\nwidth_mm = nan\n", None),
        ] {
            let changes = read(text, "a.toml").unwrap_err().changes;
            assert_eq!(changes.first().map(|(_, value)| value.as_str()), mends, "{text}");
            let mended = changes.iter().all(|(path, value)| {
                assign(&mut Configuration::default(), &format!("{path}={value}")).is_ok()
            });
            assert!(mended, "{text}: {changes:?}");
        }
        let error = assign(&mut Configuration::default(), "shell.width_mm").unwrap_err().to_string();
        assert!(error.starts_with("--set: syntax"), "{error}");
    }
}
