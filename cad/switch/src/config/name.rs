//! Names that become names of files and folders, and are never paths.

use std::fmt;

use pinswitch_diagnostic::codes;
use toml_edit::Value;
use unicode_ident::is_xid_continue;

use super::ValueError;
use super::parameter::ParameterValue;

/// Most characters of a name.
const MAX_CHARACTERS: usize = 80;
/// Most bytes of a name as UTF-8: leaves room for an extension within the 255 of a file system.
const MAX_BYTES: usize = 240;
/// The name of a text without any allowed character.
const NAMELESS: &str = "unnamed";
/// Device names on Windows, with any extension.
const DEVICES: [&str; 4] = ["CON", "PRN", "AUX", "NUL"];
/// Device names on Windows that end in a digit.
const NUMBERED_DEVICES: [&str; 2] = ["COM", "LPT"];

/// The name of a switch, a sweep or a log: letters of any script, digits, spaces and `-_.+`. It is a valid file name on
/// every platform, and cannot lead out of its folder.
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
    /// Returns `text` as a name.
    ///
    /// # Errors
    /// [`ValueError`] for a text that is not a valid name.
    pub fn new(text: &str) -> Result<Self, ValueError> {
        let error =
            || ValueError::new(codes::UNKNOWN_WORD, "not a valid name", format!("give {}", Self::form()));
        if is_name(text) { Ok(Self(text.to_owned())) } else { Err(error()) }
    }

    /// Returns the valid name nearest to `text`, such as the name of a file: characters that are not allowed become
    /// `-`. A valid name is unchanged.
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

    /// Returns the name of a file without folder and extension: the default name of its configuration.
    #[must_use]
    pub fn from_file_stem(file: &str) -> Self {
        let name = file.rsplit(['/', std::path::MAIN_SEPARATOR]).next().unwrap_or(file);
        Self::cleaned(
            name.rsplit_once('.').map_or(name, |(stem, _)| if stem.is_empty() { name } else { stem }),
        )
    }

    /// Returns the name as text.
    #[must_use]
    pub fn as_str(&self) -> &str {
        &self.0
    }

    /// Describes the accepted names.
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

    fn read(value: &Value, (): &()) -> Result<Self, ValueError> {
        let error =
            || ValueError::new(codes::WRONG_TYPE, "not a text", format!("give {}, in quotes", Self::form()));
        value.as_str().map_or_else(|| Err(error()), Self::new)
    }

    fn write(&self) -> Value {
        Value::from(self.as_str())
    }

    fn describe((): &()) -> String {
        Self::form()
    }
}

/// Whether a name may contain `c`: the characters of Unicode identifiers, spaces, `-`, `.` and `+`.
fn is_allowed(c: char) -> bool {
    is_xid_continue(c) || " -.+".contains(c)
}

fn is_name(text: &str) -> bool {
    let ends = [text.chars().next(), text.chars().next_back()];
    let has_length = text.len() <= MAX_BYTES && text.chars().count() <= MAX_CHARACTERS;
    // Windows drops a dot at the end, and a space at an end is invisible.
    let has_ends = ends.iter().all(|end| end.is_some_and(|c| c != '.' && c != ' '));
    has_length && has_ends && text.chars().all(is_allowed) && !is_device(text)
}

/// Whether the name is a device on Windows.
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
    fn a_file_stem_becomes_a_name() {
        let stem = |file: &str| Name::from_file_stem(file).as_str().to_owned();
        assert_eq!(stem("parts/My Part.toml"), "My Part");
        assert_eq!(stem("my.part.TOML"), "my.part");
        assert_eq!(stem("three-double"), "three-double");
        assert_eq!(stem(".toml"), "toml");
        assert_eq!((stem(""), stem("..")), (NAMELESS.to_owned(), NAMELESS.to_owned()));
    }

    #[test]
    fn names_of_any_script_are_valid() {
        let longest = "ü".repeat(80);
        for good in
            ["three-double", "a b_c.d+e", "スイッチ 3", "переключатель", "स्विच", "7", "x..y", "-x", &longest]
        {
            assert_eq!(Name::new(good).as_deref(), Ok(good));
            assert_eq!(Name::cleaned(good).as_str(), good);
        }
    }

    #[test]
    fn paths_are_not_names() {
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
        fn any_text_has_a_nearest_name(text in any::<String>()) {
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
