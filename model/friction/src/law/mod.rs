//! The laws that predict friction, one file per law, and the one that is used unless another is asked for.
//!
//! To add a law, write its file with a `DEFINITION` and add its line to the list below; comparison, bands, words and
//! sources follow from there. `model/doc/friction-laws.md` explains the laws with their sources.

mod definition;
mod error;

use pinswitch_diagnostic::excerpt;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::contact::Contact;
use crate::switch::SwitchState;
use definition::LawDefinition;
pub(crate) use definition::UncertainFriction;
pub use error::LawError;

/// Declares the files of the laws, their ids and the registry.
macro_rules! laws {
    ($($law:ident: $file:ident, $doc:literal;)*) => {
        $(pub(crate) mod $file;)*

        /// The law behind a curve.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        pub enum Law {
            $(#[doc = $doc] $law,)*
        }

        impl Law {
            /// Every law.
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
    Paper: paper, "The paper's capstan and eq. 4, with its constants.";
    Layout: layout, "The law fitted to the thresholds of the three published layouts.";
    Physics: physics, "A string over sinking pins on a foundation, see [`crate::physics`].";
    Calibrated: calibrated, "A model calibrated on measured data.";
}

impl Law {
    /// The law of every curve for which no other is asked: of those that predict every contact and change with each of
    /// its parameters, the one whose error is smallest on published layouts of which it was told nothing
    /// (`model/doc/friction-laws.md` has the table, [`crate::validation`] makes it).
    pub const DEFAULT: Self = Self::Physics;

    /// The law of a word, such as `paper`.
    pub fn named(word: &str) -> Option<Self> {
        Self::ALL.iter().copied().find(|law| law.as_str() == word)
    }

    /// The laws that predict from a contact alone: those a user can choose.
    ///
    /// ```
    /// use pinswitch_friction::Law;
    ///
    /// let words: Vec<_> = Law::predictive().map(Law::as_str).collect();
    /// assert!(words.starts_with(&["paper", "layout", "physics"]) && !words.contains(&"calibrated"));
    /// ```
    pub fn predictive() -> impl Iterator<Item = Self> {
        Self::ALL.iter().copied().filter(|law| !law.definition().needs_model)
    }

    /// The word in files and on the command line, such as `paper`.
    pub fn as_str(self) -> &'static str {
        self.definition().word
    }

    /// What it is called in a legend.
    pub fn title(self) -> &'static str {
        self.definition().title
    }

    /// What it is and where it applies, in one line.
    pub fn summary(self) -> &'static str {
        self.definition().summary
    }

    /// Where it comes from: the equation of the paper, or what it was fitted to.
    pub fn source(self) -> &'static str {
        self.definition().source
    }

    /// States of `contact` by this law at `loads_n` newtons.
    pub(crate) fn states(self, contact: &Contact, loads_n: &[f64]) -> Result<Vec<SwitchState>, LawError> {
        (self.definition().states)(contact, loads_n)
    }

    /// Friction of `contact` by this law at `loads_n` newtons, without band.
    pub(crate) fn friction_n(self, contact: &Contact, loads_n: &[f64]) -> Result<Vec<f64>, LawError> {
        Ok(self.states(contact, loads_n)?.iter().map(|s| s.friction_n).collect())
    }

    /// Friction of `contact` by this law, with what the law itself leaves uncertain.
    pub(crate) fn uncertain_friction(
        self,
        contact: &Contact,
        loads_n: &[f64],
    ) -> Result<UncertainFriction, LawError> {
        (self.definition().uncertain)(contact, loads_n)
    }

    /// What the law is known to get wrong of `contact`, in words.
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
    fn words_name_laws_and_are_what_json_holds() {
        for law in Law::ALL {
            assert_eq!(Law::named(law.as_str()), Some(*law));
            assert_eq!(serde_json::to_string(law).unwrap(), format!("\"{}\"", law.as_str()));
            assert_eq!(serde_json::from_str::<Law>(&format!("\"{}\"", law.as_str())).unwrap(), *law);
            assert!(!law.title().is_empty() && !law.source().is_empty() && !law.summary().is_empty());
        }
        assert!(serde_json::from_str::<Law>("\"guess\"").is_err());
    }
}
