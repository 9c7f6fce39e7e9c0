//! Configurations as TOML: the values that differ from the defaults, or all with their explanations.

use super::parameters::Configuration;

/// Returns `templates/reference.toml`: every parameter at its default, with unit, range, origin and reason.
pub fn reference_toml() -> String {
    let defaults = Configuration::default();
    let mut text =
        "# Every parameter of pinswitch at its default. All are optional: copy those that you change.\n\
                    # Written by `pinswitch init reference`.\n"
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

/// Returns the parameters that differ from the defaults as TOML, which reads back to `configuration`.
pub fn to_toml(configuration: &Configuration) -> String {
    let defaults = Configuration::default();
    let mut text = String::new();
    let mut section = "";
    for parameter in Configuration::PARAMETERS {
        let value = (parameter.get)(configuration).to_string();
        // Without it, the name of a file would become that of the switch.
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
    use crate::config::{Change, assign, read, read_clamped, read_over};

    #[test]
    fn the_reference_reads_back_to_the_defaults() {
        let (back, _) = read(&reference_toml(), "reference.toml").unwrap();
        assert_eq!(back, Configuration::default());
    }

    #[test]
    fn a_file_overrides_its_preset_with_a_default() {
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
        // The changes and the name, which is always written.
        assert_eq!(text.lines().filter(|l| l.contains('=')).count(), 4);
    }

    #[test]
    fn errors_name_location_value_and_help() {
        for (text, expected) in [
            (
                "[shell]\nwidth_mm = -3\n",
                "a.toml:2:12: shell.width_mm = -3: outside 2 to 100; give a number from 2 to 100",
            ),
            ("[shell]\nwith_mm = 3\n", "a.toml:2:1: shell.with_mm: unknown key; did you mean \"width_mm\"?"),
            ("\n\n[shel]\nwidth_mm = 3\n", "a.toml:3:2: shel: unknown table; did you mean \"shell\"?"),
            ("[shell]\nwidth_mm = 3\n[noise]\n", "a.toml:3:2: noise: unknown table"),
            (
                "silicone = true\n[noise]\n",
                "a.toml:1:1: noise: not a configuration: this is a rig to simulate; run `pinswitch simulate a.toml`",
            ),
            (
                "[rig]\nwrap_angle_deg = 60\n[[series]]\nfile = \"a.csv\"\n",
                "a.toml:1:2: series: not a configuration: this is a run with its logs; run `pinswitch segment a.toml`",
            ),
            (
                "[support]\nslots = \"some\"\n",
                "a.toml:2:9: support.slots = \"some\": unknown value; give \"all\" or \"occupied\"",
            ),
            (
                "[segment]\ngrooves = 1.5\n",
                "a.toml:2:11: segment.grooves = 1.5: not a whole number; give a whole number from 1 to 60",
            ),
            ("[shell]\nwidth_mm = nan\n", "a.toml:2:12: shell.width_mm = nan: outside 2 to 100"),
            (
                "[layout]\npins = [1, -2]\n",
                "a.toml:2:8: layout.pins = [1, -2]: not a list of groove numbers; give a list",
            ),
            ("shell = 3\n", "a.toml:1:1: shell = integer: not a table; write it as a table: [shell]"),
            ("[shell\n", "a.toml:1:7: invalid TOML"),
            ("[shell]\nwidth_mm = 3\nwidth_mm = 4\n", "a.toml:3:1: invalid TOML: duplicate key"),
        ] {
            let error = read(text, "a.toml").unwrap_err().to_string();
            assert!(error.starts_with(expected), "{error}");
        }
        for (text, nearest) in [
            ("[shell]\nwidth_mm = -3\n", Some("2")),
            ("[shell]\nwidth_mm = 1e9\n", Some("100")),
            ("[segment]\ngrooves = 0\n", Some("1")),
            ("[segment]\ngrooves = 3.5\n", None),
            ("[shell]\nwidth_mm = nan\n", None),
        ] {
            let error = read(text, "a.toml").unwrap_err();
            assert_eq!(error.changes().first().map(|change| change.value.as_str()), nearest, "{text}");
            let is_accepted = error.changes().iter().all(|Change { field, value }| {
                assign(&mut Configuration::default(), &format!("{field}={value}")).is_ok()
            });
            assert!(is_accepted, "{text}: {error:?}");
        }
        let error = assign(&mut Configuration::default(), "shell.width_mm").unwrap_err().to_string();
        assert!(error.starts_with("\"shell.width_mm\" is not an assignment"), "{error}");
    }

    #[test]
    fn an_error_shows_its_line() {
        let error = read("# mine\n[shell]\nwidth_mm = -3 # narrow\n", "a.toml").unwrap_err();
        assert_eq!(
            error.render("error"),
            "error: a.toml:3:12: shell.width_mm = -3: outside 2 to 100 [out-of-range]\n\
             \x20 3 | width_mm = -3 # narrow\n\
             \x20   |            ^^\n\
             \x20 help: give a number from 2 to 100"
        );
    }

    #[test]
    fn numbers_out_of_range_are_clamped() {
        let text = "[shell]\nwidth_mm = 500\nwall_mm = 9\n[segment]\ngrooves = 0\n";
        let reading = read_clamped(Configuration::default(), text, "a.toml").unwrap();
        let c = &reading.configuration;
        assert_eq!((c.shell.width_mm, c.shell.wall_mm, c.segment.grooves), (100.0, 9.0, 1));
        let fields = reading.out_of_range.iter().map(|e| e.location().and_then(|l| l.field.as_deref()));
        assert_eq!(fields.collect::<Vec<_>>(), [Some("shell.width_mm"), Some("segment.grooves")]);
        // Any other error ends the reading, and the first error of the text is reported.
        let error = read_clamped(Configuration::default(), &format!("{text}x = 1\n"), "a.toml").unwrap_err();
        assert!(error.to_string().starts_with("a.toml:2:12: shell.width_mm = 500"), "{error}");
    }
}
