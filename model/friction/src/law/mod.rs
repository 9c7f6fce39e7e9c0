//! Laws of friction, one file per law, and the default law.
//!
//! To add a law, write its file with a `DEFINITION` and add its line to `laws!` below. Comparison,
//! bands, names and sources follow from the definition. `model/doc/friction-laws.md` explains the
//! laws with their sources.

mod definition;
mod error;

use std::borrow::Cow;

use pinswitch_diagnostic::excerpt;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::contact::Contact;
use crate::switch::SwitchState;
use definition::LawDefinition;
pub(crate) use definition::UncertainFriction;
pub use error::LawError;

/// Declares the files of the laws, the variants of [`Law`], and their definitions.
macro_rules! laws {
    ($($law:ident: $file:ident, $doc:literal;)*) => {
        $(pub(crate) mod $file;)*

        /// Law of friction.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        pub enum Law {
            $(#[doc = $doc] $law,)*
        }

        impl Law {
            /// All laws.
            pub const ALL: &[Law] = &[$(Law::$law),*];

            fn definition(self) -> &'static LawDefinition {
                match self {
                    $(Law::$law => &$file::DEFINITION,)*
                }
            }
        }
    };
}

laws! {
    Paper: paper, "Capstan and eq. 4 of the paper, with its constants.";
    Layout: layout, "Law fitted to the thresholds of the three published layouts.";
    Physics: physics, "String over sinking pins on a foundation, see [`crate::physics`].";
    Calibrated: calibrated, "Model calibrated on measured data.";
}

impl Law {
    /// Default law. Of the laws that predict every contact and depend on all of its parameters, it
    /// has the smallest leave-one-layout-out error on the published layouts (table in
    /// `model/doc/friction-laws.md`, computed by [`crate::validation`]).
    pub const DEFAULT: Self = Self::Physics;

    /// Returns the law with a name such as `paper`.
    pub fn named(word: &str) -> Option<Self> {
        Self::ALL.iter().copied().find(|law| law.as_str() == word)
    }

    /// Returns the laws that predict from a contact alone, which a user can choose.
    ///
    /// ```
    /// use pinswitch_friction::Law;
    ///
    /// let words: Vec<_> = Law::predictive().map(Law::as_str).collect();
    /// assert!(words.starts_with(&["paper", "layout", "physics"]));
    /// assert!(!words.contains(&"calibrated"));
    /// ```
    pub fn predictive() -> impl Iterator<Item = Self> {
        Self::ALL.iter().copied().filter(|law| !law.definition().needs_model)
    }

    /// Returns the name in files and on the command line, such as `paper`.
    pub fn as_str(self) -> &'static str {
        self.definition().word
    }

    /// Returns the name in legends.
    pub fn title(self) -> &'static str {
        self.definition().title
    }

    /// Returns a description with the domain, in one line.
    pub fn summary(self) -> &'static str {
        self.definition().summary
    }

    /// Returns the source: an equation of the paper, or the data of the fit.
    pub fn source(self) -> &'static str {
        self.definition().source
    }

    /// Predicts the states of `contact` at `loads_n` newtons.
    pub(crate) fn states(self, contact: &Contact, loads_n: &[f64]) -> Result<Vec<SwitchState>, LawError> {
        (self.definition().states)(contact, loads_n)
    }

    /// Predicts the friction of `contact` at `loads_n` newtons, in newtons.
    pub(crate) fn friction_n(self, contact: &Contact, loads_n: &[f64]) -> Result<Vec<f64>, LawError> {
        Ok(self.states(contact, loads_n)?.iter().map(|s| s.friction_n).collect())
    }

    /// Predicts the friction of `contact` at `loads_n` newtons, with the uncertainty of the law
    /// itself.
    pub(crate) fn uncertain_friction(
        self,
        contact: &Contact,
        loads_n: &[f64],
    ) -> Result<UncertainFriction, LawError> {
        (self.definition().uncertain)(contact, loads_n)
    }

    /// Returns a known error of the law for `contact`, as text.
    pub(crate) fn remark(self, contact: &Contact) -> Option<String> {
        (self.definition().remark)(contact)
    }
}

/// Most characters of an unknown law in a message.
const LONGEST_WORD: usize = 60;

impl Serialize for Law {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.as_str())
    }
}

impl JsonSchema for Law {
    fn schema_name() -> Cow<'static, str> {
        "Law".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        let words: Vec<&str> = Self::ALL.iter().map(|law| law.as_str()).collect();
        json_schema!({ "description": "Law of friction.", "type": "string", "enum": words })
    }
}

impl<'de> Deserialize<'de> for Law {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let word = String::deserialize(deserializer)?;
        Self::named(&word).ok_or_else(|| {
            let known: Vec<_> = Self::ALL.iter().map(|law| law.as_str()).collect();
            let word = excerpt(&word, LONGEST_WORD);
            serde::de::Error::custom(format!("unknown law '{word}', expected one of {}", known.join(", ")))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_round_trip_through_json() {
        for law in Law::ALL {
            assert_eq!(Law::named(law.as_str()), Some(*law));
            assert_eq!(serde_json::to_string(law).unwrap(), format!("\"{}\"", law.as_str()));
            assert_eq!(serde_json::from_str::<Law>(&format!("\"{}\"", law.as_str())).unwrap(), *law);
            assert!(!law.title().is_empty() && !law.source().is_empty() && !law.summary().is_empty());
        }
        assert!(serde_json::from_str::<Law>("\"guess\"").is_err());
    }
}
