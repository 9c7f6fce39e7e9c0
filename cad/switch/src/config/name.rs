//! Names that become files and folders: a name is never a path.

use std::fmt;

use toml_edit::Value;
use unicode_ident::is_xid_continue;

use super::parameter::ParameterValue;

/// Most characters of a name.
const MAX_CHARACTERS: usize = 80;
/// Most bytes of a name as UTF-8, which leave room for an ending within the 255 of a file system.
const MAX_BYTES: usize = 240;
/// What stands in for a name of which nothing is left.
const NAMELESS: &str = "unnamed";
/// Names of devices on Windows, whatever their ending.
const DEVICES: [&str; 4] = ["CON", "PRN", "AUX", "NUL"];
/// Those with a number of one digit behind them.
const NUMBERED_DEVICES: [&str; 2] = ["COM", "LPT"];

/// A name of a switch, a sweep or a log: letters of any script, digits, spaces and `-_.+`, so that it can stand in any
/// folder, and in no other.
///
/// ```
/// use pinswitch_switch::config::Name;
///
/// assert_eq!(Name::new("Umlenkrolle 3.1").unwrap().as_str(), "Umlenkrolle 3.1");
/// assert!(Name::new("../../x").is_err());
/// assert_eq!(Name::cleaned("../../x").as_str(), "-..-x");
/// ```
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Name(String);

impl Name {
    /// The name `text`, if it is one.
    ///
    /// # Errors
    /// What would be accepted.
    pub fn new(text: &str) -> Result<Self, String> {
        if is_name(text) { Ok(Self(text.to_owned())) } else { Err(format!("give {}", Self::form())) }
    }

    /// The name nearest to `text`, for what has a name by its nature, such as a file: other characters become `-`.
    /// A name stays as it is.
    #[must_use]
    pub fn cleaned(text: &str) -> Self {
        let mut clean = String::new();
        for character in text.trim().chars().map(|c| if is_allowed(c) { c } else { '-' }).take(MAX_CHARACTERS)
        {
            if clean.len() + character.len_utf8() > MAX_BYTES {
                break;
            }
            clean.push(character);
        }
        let clean = clean.trim_start_matches(['.', ' ']).trim_end();
        let clean = if is_device(clean) { format!("{clean:.76}-set") } else { clean.to_owned() };
        Self(if is_name(&clean) { clean } else { NAMELESS.to_owned() })
    }

    /// The name that a file lends to a set whose configuration names none: that of the file, without folder and ending.
    #[must_use]
    pub fn lent_by(file: &str) -> Self {
        let name = file.rsplit(['/', std::path::MAIN_SEPARATOR]).next().unwrap_or(file);
        Self::cleaned(
            name.rsplit_once('.').map_or(name, |(stem, _)| if stem.is_empty() { name } else { stem }),
        )
    }

    /// The name as text.
    #[must_use]
    pub fn as_str(&self) -> &str {
        &self.0
    }

    /// What is accepted, in words.
    #[must_use]
    pub fn form() -> String {
        format!(
            "a name of 1 to {MAX_CHARACTERS} letters, digits, spaces and -_.+, not a path, without a dot or space at an end"
        )
    }
}

impl fmt::Display for Name {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::ops::Deref for Name {
    type Target = str;

    fn deref(&self) -> &str {
        &self.0
    }
}

impl AsRef<std::path::Path> for Name {
    fn as_ref(&self) -> &std::path::Path {
        std::path::Path::new(&self.0)
    }
}

impl ParameterValue for Name {
    type Bounds = ();

    fn read(value: &Value, (): &()) -> Result<Self, String> {
        value.as_str().map_or_else(|| Err(format!("give {}, in quotes", Self::form())), Self::new)
    }

    fn write(&self) -> Value {
        Value::from(self.as_str())
    }

    fn describe((): &()) -> String {
        Self::form()
    }
}

/// Letters and digits of any script with the marks that belong to them, as identifiers may have, and a little more.
fn is_allowed(c: char) -> bool {
    is_xid_continue(c) || " -.+".contains(c)
}

fn is_name(text: &str) -> bool {
    let ends = [text.chars().next(), text.chars().next_back()];
    let has_length = text.len() <= MAX_BYTES && text.chars().count() <= MAX_CHARACTERS;
    // A dot at its end is lost on Windows, a space at an end is not seen anywhere.
    let has_ends = ends.iter().all(|end| end.is_some_and(|c| c != '.' && c != ' '));
    has_length && has_ends && text.chars().all(is_allowed) && !is_device(text)
}

/// Whether Windows takes the name for a device.
fn is_device(text: &str) -> bool {
    let stem = text.split('.').next().unwrap_or_default().trim_end().to_ascii_uppercase();
    let numbered = |device: &&str| {
        stem.strip_prefix(*device)
            .is_some_and(|n| n.len() == 1 && n.starts_with(|d: char| d.is_ascii_digit()))
    };
    DEVICES.contains(&stem.as_str()) || NUMBERED_DEVICES.iter().any(numbered)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::path::{Component, Path};

    #[test]
    fn a_file_lends_its_name() {
        let lent = |file: &str| Name::lent_by(file).as_str().to_owned();
        assert_eq!(lent("parts/My Part.toml"), "My Part");
        assert_eq!(lent("my.part.TOML"), "my.part");
        assert_eq!(lent("three-double"), "three-double");
        assert_eq!(lent(".toml"), "toml");
        assert_eq!((lent(""), lent("..")), (NAMELESS.to_owned(), NAMELESS.to_owned()));
    }

    #[test]
    fn names_of_any_script_are_names() {
        let longest = "ü".repeat(80);
        for good in
            ["three-double", "a b_c.d+e", "スイッチ 3", "переключатель", "स्विच", "7", "x..y", "-x", &longest]
        {
            assert_eq!(Name::new(good).as_deref(), Ok(good));
            assert_eq!(Name::cleaned(good).as_str(), good);
        }
    }

    #[test]
    fn paths_are_no_names() {
        let (long, wide) = ("x".repeat(81), "𐍈".repeat(61));
        for bad in [
            "",
            ".",
            "..",
            "../../x",
            "/etc/x",
            "a/b",
            "a\\b",
            "C:x",
            ".hidden",
            " x",
            "x ",
            "x.",
            "a\0b",
            "a\nb",
            "<b>",
            "a\"b",
            "{{JS}}",
            "con",
            "NUL.txt",
            "lpt1",
            "a\u{202e}b",
            &long,
            &wide,
        ] {
            assert!(Name::new(bad).is_err(), "{bad:?}");
        }
    }

    proptest! {
        #[test]
        fn any_text_has_a_nearest_name_in_its_folder(text in any::<String>()) {
            let name = Name::cleaned(&text);
            prop_assert_eq!(Name::new(&name), Ok(name.clone()));
            let parts: Vec<_> = Path::new(name.as_str()).components().collect();
            prop_assert!(matches!(parts.as_slice(), [Component::Normal(only)] if *only == name.as_str()));
            if let Ok(same) = Name::new(&text) {
                prop_assert_eq!(same, name);
            }
        }
    }
}
