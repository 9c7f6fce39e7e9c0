//! Words of the `substrate` column: `silicone`, `abs` (the rigid proxy), and `plain` for any other
//! rig.

use pinswitch_friction::Substrate;
use serde::{Deserialize, Deserializer, Serializer};

/// Word for an unknown material.
const PLAIN: &str = "plain";

/// Words and their substrates.
pub const WORDS: [(&str, Option<Substrate>); 3] =
    [("silicone", Some(Substrate::Silicone)), ("abs", Some(Substrate::Abs)), (PLAIN, None)];

/// Returns the word of a substrate: `silicone`, `abs`, or `plain` for an unknown material.
pub fn substrate_word(substrate: Option<Substrate>) -> &'static str {
    substrate.map_or(PLAIN, Substrate::as_str)
}

/// Writes the word of a substrate, for `#[serde(with)]`.
///
/// # Errors
/// Those of the serializer.
pub fn serialize<S: Serializer>(substrate: &Option<Substrate>, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(substrate_word(*substrate))
}

/// Reads the word of a substrate, for `#[serde(with)]`.
///
/// # Errors
/// If the value is not one of [`WORDS`].
pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<Substrate>, D::Error> {
    let word = String::deserialize(deserializer)?;
    WORDS.iter().find(|(known, _)| *known == word).map(|(_, substrate)| *substrate).ok_or_else(|| {
        let known = WORDS.map(|(word, _)| format!("`{word}`")).join(", ");
        serde::de::Error::custom(format!("unknown variant `{word}`, expected one of {known}"))
    })
}
