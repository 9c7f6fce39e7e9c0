//! The laws that predict friction: one file per law, and which of them is best supported for a contact.
//!
//! To add a law, write its file with a `DEFINITION` and add its line to the list below; choice, comparison, words and
//! sources follow from there. `model/doc/friction-laws.md` explains the laws with their sources.

use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::physics::PhysicsError;
use crate::{Contact, FrictionCurve};

/// What a law is and does.
pub(crate) struct Definition {
    /// The word in files and on the command line.
    pub(crate) word: &'static str,
    /// What it is called in a legend.
    pub(crate) title: &'static str,
    /// What it is and where it applies, in one line.
    pub(crate) summary: &'static str,
    /// Where it comes from.
    pub(crate) source: &'static str,
    /// Whether it needs a model file beside the contact.
    pub(crate) needs_model: bool,
    /// How well it is supported for a contact.
    pub(crate) support: fn(&Contact) -> Support,
    /// Predicts the curve of a contact at loads in newtons.
    pub(crate) curve: fn(&Contact, &[f64]) -> Result<FrictionCurve, LawError>,
}

/// How well a law is supported for a contact, weakest first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Support {
    /// It may be asked when all others have failed.
    LastResort,
    /// It can stand in for a better one.
    StandIn,
    /// It applies to contacts of any kind.
    General,
    /// The contact lies between measured ones that it was fitted to.
    Interpolated,
    /// The contact was measured.
    Measured,
}

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

            fn definition(self) -> &'static Definition {
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
}

impl Serialize for Law {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.as_str())
    }
}

impl<'de> Deserialize<'de> for Law {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let word = String::deserialize(deserializer)?;
        Self::named(&word).ok_or_else(|| serde::de::Error::custom(format!("law '{word}' is unknown")))
    }
}

/// Why a law cannot predict a contact.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LawError {
    /// The law does not describe such a contact, or needs more than the contact.
    #[error("{why}")]
    DoesNotApply {
        /// What it describes instead, and what to use.
        why: &'static str,
    },
    /// The physics has no solution.
    #[error(transparent)]
    Physics(#[from] PhysicsError),
}

/// The laws that predict `contact` from itself alone, the best supported first.
fn by_support(contact: &Contact) -> Vec<Law> {
    let mut laws: Vec<Law> = Law::predictive().collect();
    laws.sort_by_cached_key(|law| std::cmp::Reverse((law.definition().support)(contact)));
    laws
}

/// The law that is best supported for a contact: the paper's own where it measured; between its layouts the layout law,
/// whose error on devices left out is smaller (6 % against 8 %); physics for pins on the proxy, and wherever the layout
/// law would be a guess, because it alone knows of uneven, off-centre and single pins.
pub fn best_law(contact: &Contact) -> Law {
    by_support(contact).first().copied().unwrap_or(Law::Paper)
}

/// Predicts tension and friction of `contact` at `loads_n` newtons by this law.
///
/// ```
/// use pinswitch_friction::{Contact, Law, PinPattern, Substrate, predict_by};
///
/// let uneven = PinPattern::new(vec![-0.3, 0.0, 0.2]);
/// let contact = Contact::new(Substrate::Silicone, uneven, 1.115)?;
/// assert!(predict_by(Law::Paper, &contact, &[20.0]).is_err(), "the paper measured no such layout");
/// let curve = predict_by(Law::Physics, &contact, &[20.0])?;
/// assert!(curve.friction_n[0] > 1.0 && curve.law.as_str() == "physics");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`LawError`] if the law does not apply or has no solution.
pub fn predict_by(law: Law, contact: &Contact, loads_n: &[f64]) -> Result<FrictionCurve, LawError> {
    (law.definition().curve)(contact, loads_n)
}

/// Predicts by the best supported law ([`best_law`]). Where that has no solution the next best stands in, and the curve
/// says so.
///
/// ```
/// use pinswitch_friction::{Contact, Law, PinPattern, Substrate, Trust, predict, published};
///
/// // Four pins, 14 degrees apart: between the layouts that the paper measured.
/// let pins = PinPattern::even(4, 14f64.to_radians());
/// let contact = Contact::new(Substrate::Silicone, pins, published::wrap_angle_rad())?;
/// let curve = predict(&contact, &[10.0, 40.0]);
/// assert_eq!((curve.law, curve.trust), (Law::Layout, Trust::Interpolated));
/// assert!(curve.band_low_n[1] < curve.friction_n[1] && curve.friction_n[1] < curve.band_high_n[1]);
/// # Ok::<(), pinswitch_friction::ContactError>(())
/// ```
pub fn predict(contact: &Contact, loads_n: &[f64]) -> FrictionCurve {
    let mut first_failure = None;
    for law in by_support(contact) {
        match predict_by(law, contact, loads_n) {
            Ok(curve) => return with_reason(curve, first_failure),
            Err(failed) => first_failure = first_failure.or(Some(failed)),
        }
    }
    with_reason(paper::capstan_curve(contact, loads_n), first_failure)
}

/// The curve with the failure of a better law among its reasons.
fn with_reason(mut curve: FrictionCurve, failed: Option<LawError>) -> FrictionCurve {
    curve.reasons.extend(failed.map(|failed| format!("another law stands in: {failed}")));
    curve
}

/// The curves of all other laws that apply, for comparison; never mixed into the main one.
pub fn other_laws(main: Law, contact: &Contact, loads_n: &[f64]) -> Vec<FrictionCurve> {
    Law::predictive()
        .filter(|law| *law != main)
        .filter_map(|law| predict_by(law, contact, loads_n).ok())
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{PinPattern, Substrate, published};

    fn contact(substrate: Substrate, pins: PinPattern) -> Contact {
        Contact::new(substrate, pins, published::wrap_angle_rad()).unwrap()
    }

    #[test]
    fn the_best_law_follows_what_was_measured() {
        let silicone = |pins| best_law(&contact(Substrate::Silicone, pins));
        let double = &published::LAYOUTS[1];
        assert_eq!(silicone(PinPattern::even(3, double.pitch_rad())), Law::Paper);
        assert_eq!(silicone(PinPattern::default()), Law::Paper);
        assert_eq!(silicone(PinPattern::even(4, 0.25)), Law::Layout);
        assert_eq!(silicone(PinPattern::new(vec![-0.3, 0.0, 0.2])), Law::Physics);
        assert_eq!(best_law(&contact(Substrate::Abs, PinPattern::even(4, 0.25))), Law::Physics);
    }

    #[test]
    fn laws_that_do_not_apply_say_why() {
        let uneven = contact(Substrate::Silicone, PinPattern::new(vec![-0.3, 0.0, 0.2]));
        let proxy = contact(Substrate::Abs, PinPattern::even(3, 0.2));
        for (law, contact, word) in [
            (Law::Paper, &uneven, "six-single"),
            (Law::Layout, &proxy, "pins on silicone only"),
            (Law::Calibrated, &proxy, "--model"),
        ] {
            let error = predict_by(law, contact, &[10.0]).unwrap_err();
            assert!(matches!(error, LawError::DoesNotApply { .. }), "{error:?}");
            assert!(error.to_string().contains(word), "{error}");
        }
    }

    #[test]
    fn laws_stand_side_by_side() {
        let double = contact(Substrate::Silicone, PinPattern::even(3, published::LAYOUTS[1].pitch_rad()));
        let laws: Vec<_> = other_laws(Law::Paper, &double, &[20.0]).iter().map(|c| c.law).collect();
        let others: Vec<_> = Law::predictive().filter(|law| *law != Law::Paper).collect();
        assert_eq!(laws, others, "all of them apply to a published layout, and none is mixed into another");
        assert!(laws.starts_with(&[Law::Layout, Law::Physics]));
    }

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

    #[test]
    fn one_law_at_least_predicts_every_contact() {
        for (substrate, pins) in [
            (Substrate::Silicone, PinPattern::default()),
            (Substrate::Silicone, PinPattern::new(vec![0.1])),
            (Substrate::Abs, PinPattern::new(vec![-0.4, 0.3])),
        ] {
            let contact = contact(substrate, pins);
            assert_eq!(predict(&contact, &[10.0]).law, best_law(&contact));
        }
    }
}
