//! The laws that predict friction, one file per law, and the one that is used unless another is asked for.
//!
//! To add a law, write its file with a `DEFINITION` and add its line to the list below; comparison, bands, words and
//! sources follow from there. `model/doc/friction-laws.md` explains the laws with their sources.

use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::band::{Band, BandSource};
use crate::physics::PhysicsError;
use crate::trust::trust;
use crate::{Contact, FrictionCurve, SwitchState};

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
    /// Predicts the states of a contact at loads in newtons.
    pub(crate) states: fn(&Contact, &[f64]) -> Result<Vec<SwitchState>, LawError>,
    /// Friction at loads in newtons, with what the law itself leaves uncertain about it: its constants, its scatter on
    /// what was measured.
    pub(crate) uncertain: fn(&Contact, &[f64]) -> Result<Uncertain, LawError>,
    /// What the law is known to get wrong of a contact, in words.
    pub(crate) remark: fn(&Contact) -> Option<String>,
}

/// Friction in newtons with the sources of a law's own uncertainty, load by load.
pub(crate) struct Uncertain {
    pub(crate) friction_n: Vec<f64>,
    pub(crate) sources: Vec<BandSource>,
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
    /// The law of every curve for which no other is asked: of those that predict every contact and change with each of
    /// its parameters, the one whose error is smallest on published layouts of which it was told nothing
    /// (`model/doc/friction-laws.md` has the table, [`crate::evidence`] makes it).
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
    let states = (law.definition().states)(contact, loads_n)?;
    let band = Band::of(law, contact, loads_n)?;
    let (trust, mut reasons) = trust(contact, &band.departures, loads_n);
    if let Some((rival, load_n, ratio)) = band.widest_rival(NOTEWORTHY) {
        let law = law.title();
        reasons.push(if ratio > 1.0 {
            format!(
                "the laws disagree: at {load_n:.2} N {rival} gives {ratio:.1} times the friction of {law}"
            )
        } else {
            format!(
                "the laws disagree: at {load_n:.2} N {law} gives {:.1} times the friction of {rival}",
                1.0 / ratio
            )
        });
    }
    reasons.extend((law.definition().remark)(contact));
    Ok(FrictionCurve::of(law, trust, reasons, &states, &band))
}

/// Ratio of two laws' frictions that a curve's reasons name.
const NOTEWORTHY: f64 = 1.25;

/// Friction of `contact` by `law` at `loads_n` newtons, without band.
pub(crate) fn friction_by(law: Law, contact: &Contact, loads_n: &[f64]) -> Result<Vec<f64>, LawError> {
    Ok((law.definition().states)(contact, loads_n)?.iter().map(|s| s.friction_n).collect())
}

/// Friction of `contact` by `law`, with what the law itself leaves uncertain.
pub(crate) fn uncertain_by(law: Law, contact: &Contact, loads_n: &[f64]) -> Result<Uncertain, LawError> {
    (law.definition().uncertain)(contact, loads_n)
}

/// Predicts by [`Law::DEFAULT`], the same law for every contact. Should it have no solution, the layout law or the
/// paper's capstan stands in, and the curve says so in its reasons and in its law.
///
/// ```
/// use pinswitch_friction::{Contact, Law, PinPattern, Substrate, Trust, predict, published};
///
/// // Four pins, 14 degrees apart: between the layouts that the paper measured.
/// let pins = PinPattern::even(4, 14f64.to_radians());
/// let contact = Contact::new(Substrate::Silicone, pins, published::wrap_angle_rad())?;
/// let curve = predict(&contact, &[10.0, 40.0]);
/// assert_eq!((curve.law, curve.trust), (Law::Physics, Trust::Interpolated));
/// assert!(curve.band_low_n[1] < curve.friction_n[1] && curve.friction_n[1] < curve.band_high_n[1]);
/// # Ok::<(), pinswitch_friction::ContactError>(())
/// ```
pub fn predict(contact: &Contact, loads_n: &[f64]) -> FrictionCurve {
    let failed = match predict_by(Law::DEFAULT, contact, loads_n) {
        Ok(curve) => return curve,
        Err(failed) => failed,
    };
    let mut curve = predict_by(Law::Layout, contact, loads_n)
        .or_else(|_| predict_by(Law::Paper, contact, loads_n))
        .unwrap_or_else(|_| paper::capstan_curve(contact, loads_n));
    curve.reasons.push(format!("another law stands in: {failed}"));
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
    fn the_default_law_predicts_every_contact() {
        for (substrate, pins) in [
            (Substrate::Silicone, PinPattern::default()),
            (Substrate::Silicone, PinPattern::new(vec![0.1])),
            (Substrate::Abs, PinPattern::new(vec![-0.4, 0.3])),
        ] {
            let contact = contact(substrate, pins);
            assert_eq!(predict(&contact, &[10.0]).law, Law::DEFAULT);
        }
    }
}
