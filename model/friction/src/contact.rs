//! What the tendon lies on: the validated input of every prediction.

use pinswitch_diagnostic::{Diagnostic, Location};

use crate::bed::Bed;
use crate::pattern::PinPattern;
use crate::plural::pluralise;
use crate::published::{self, PublishedLayout};
use crate::substrate::Substrate;

/// Largest wrap angle in degrees: two turns.
const MAX_WRAP_DEG: f64 = 720.0;

/// Reason why a contact cannot be predicted.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{}", Diagnostic::from(self.clone()))]
#[non_exhaustive]
pub enum ContactError {
    /// The wrap angle is not a positive finite angle of at most two turns.
    WrapAngle {
        /// Wrap angle as given, in degrees.
        degrees: f64,
    },
    /// No pin of a rigid proxy is within the wrap, so the tendon touches nothing.
    NoPinInWrap {
        /// Wrap angle in degrees.
        degrees: f64,
    },
}

impl From<ContactError> for Diagnostic {
    fn from(error: ContactError) -> Self {
        match error {
            ContactError::WrapAngle { degrees } => {
                Self::new(format!("must be above 0 and at most {MAX_WRAP_DEG}"))
                    .with_location(Location::field("wrap angle (deg)", degrees.to_string()))
                    .with_help("give the angle over which the tendon touches the pulley")
            }
            ContactError::NoPinInWrap { degrees } => {
                Self::new(format!("no pin of the rigid proxy is within the wrap of {degrees:.2} deg"))
                    .with_help("move a pin into the wrap, or use silicone")
            }
        }
    }
}

/// Substrate, the pins that the tendon touches, and the wrap angle.
///
/// ```
/// use pinswitch_friction::{Contact, ContactError, PinPattern, Substrate};
///
/// // Three pins over a wrap of 64 degrees; the one beside it does not touch the tendon.
/// let pins = PinPattern::new([-15.0f64, 0.0, 15.0, 40.0].map(f64::to_radians).to_vec());
/// let contact = Contact::new(Substrate::Silicone, pins, 64f64.to_radians())?;
/// assert_eq!(contact.pins().count(), 3);
/// assert!(contact.remarks().iter().any(|reason| reason.contains("outside the wrap")));
///
/// let nothing = Contact::new(Substrate::Abs, PinPattern::default(), 1.0);
/// assert!(matches!(nothing, Err(ContactError::NoPinInWrap { .. })));
/// # Ok::<(), ContactError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Contact {
    substrate: Substrate,
    pins: PinPattern,
    all_pins: PinPattern,
    wrap_rad: f64,
    unmodelled: Vec<String>,
    six_single_threshold: f64,
    bed: Bed,
}

impl Contact {
    /// A contact over `wrap_rad` radians: the angle between the directions in which the tendon arrives and leaves.
    ///
    /// # Errors
    /// [`ContactError`] if the angle is unusable or if nothing would touch the tendon.
    pub fn new(substrate: Substrate, pins: PinPattern, wrap_rad: f64) -> Result<Self, ContactError> {
        let degrees = wrap_rad.to_degrees();
        if !(degrees > 0.0 && degrees <= MAX_WRAP_DEG) {
            return Err(ContactError::WrapAngle { degrees });
        }
        let touched = pins.within(wrap_rad);
        if substrate == Substrate::Abs && touched.count() == 0 {
            return Err(ContactError::NoPinInWrap { degrees });
        }
        Ok(Self {
            substrate,
            pins: touched,
            all_pins: pins,
            wrap_rad,
            unmodelled: Vec::new(),
            six_single_threshold: published::LAYOUTS[0].threshold,
            bed: Bed::published(),
        })
    }

    /// Reads `F_thr` of six-single as `threshold` instead of the printed 5.7: the paper leaves it open
    /// (`model/doc/friction-laws.md`).
    #[must_use]
    pub fn with_six_single_threshold(mut self, threshold: f64) -> Self {
        self.six_single_threshold = threshold;
        self
    }

    /// Adds ways in which the part departs from the one that was measured and of which no law knows (another mix of the
    /// silicone): the friction numbers are then an extrapolation, and each is shown.
    #[must_use]
    pub fn with_unmodelled(mut self, unmodelled: Vec<String>) -> Self {
        self.unmodelled = unmodelled;
        self
    }

    /// The same part under a tendon that wraps it over another angle, in radians.
    ///
    /// # Errors
    /// [`ContactError`] as [`Contact::new`].
    pub fn at_wrap(&self, wrap_rad: f64) -> Result<Self, ContactError> {
        let other = Self::new(self.substrate, self.all_pins.clone(), wrap_rad)?;
        Ok(Self {
            unmodelled: self.unmodelled.clone(),
            six_single_threshold: self.six_single_threshold,
            bed: self.bed,
            ..other
        })
    }

    /// Lays the pins on `bed` instead of the published one; the physics reads it.
    #[must_use]
    pub fn with_bed(mut self, bed: Bed) -> Self {
        self.bed = bed;
        self
    }

    /// Dimensions and stiffness of what carries the tendon.
    pub fn bed(&self) -> &Bed {
        &self.bed
    }

    /// What lies under the pins.
    pub fn substrate(&self) -> Substrate {
        self.substrate
    }

    /// The pins within the wrap.
    pub fn pins(&self) -> &PinPattern {
        &self.pins
    }

    /// All pins of the part. One just beyond the wrap may still touch the span that leaves it, and carries less the
    /// farther it lies: the physics asks for all.
    pub fn all_pins(&self) -> &PinPattern {
        &self.all_pins
    }

    /// The wrap angle in radians.
    pub fn wrap_rad(&self) -> f64 {
        self.wrap_rad
    }

    /// What departs from the published rig of which no law knows.
    pub fn unmodelled(&self) -> &[String] {
        &self.unmodelled
    }

    /// In what this contact departs from the published rig that no parameter of its bed shows.
    pub fn remarks(&self) -> Vec<String> {
        let mut all = self.unmodelled.clone();
        let outside = self.all_pins.count() - self.pins.count();
        if outside > 0 {
            let verb = if outside == 1 { "lies" } else { "lie" };
            all.push(format!("{} {verb} outside the wrap", pluralise(outside, "pin")));
        }
        all
    }

    /// The published layout whose pins these are: same number, same even pitch, centred on the wrap.
    pub fn published_layout(&self) -> Option<PublishedLayout> {
        let pitch = self.pins.mean_pitch_rad()?;
        let mut layout = *published::LAYOUTS.iter().find(|l| {
            l.pins == self.pins.count()
                && (l.pitch_rad() - pitch).abs() < 1e-4
                && self.pins.is_even()
                && self.pins.is_centred()
        })?;
        if layout.name == published::LAYOUTS[0].name {
            layout.threshold = self.six_single_threshold;
        }
        Some(layout)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn published_layouts_are_recognised_and_others_are_not() {
        for layout in &published::LAYOUTS {
            let pins = PinPattern::even(layout.pins, layout.pitch_rad());
            let contact = Contact::new(Substrate::Silicone, pins, published::wrap_angle_rad()).unwrap();
            assert_eq!(contact.published_layout(), Some(*layout));
            assert!(contact.remarks().is_empty());
        }
        let pins = PinPattern::even(4, 0.2);
        let contact = Contact::new(Substrate::Silicone, pins, 1.0).unwrap();
        assert_eq!(contact.published_layout(), None);
    }

    #[test]
    fn another_wrap_touches_other_pins_of_the_same_part() {
        let pins = PinPattern::even(3, 0.3);
        let contact = Contact::new(Substrate::Silicone, pins.clone(), published::wrap_angle_rad()).unwrap();
        let contact = contact.with_unmodelled(vec!["another mix".to_owned()]);
        let bent = contact.at_wrap(0.4).unwrap();
        assert_eq!((bent.pins().count(), bent.all_pins()), (1, &pins));
        assert_eq!(bent.remarks().len(), 2, "mix, pins outside");
        assert_eq!(bent.at_wrap(published::wrap_angle_rad()).unwrap(), contact);
        assert!(contact.at_wrap(0.0).is_err());
    }

    #[test]
    fn unusable_contacts_are_refused() {
        for wrap in [0.0, -1.0, f64::NAN, f64::INFINITY, 13.0] {
            assert!(matches!(
                Contact::new(Substrate::Silicone, PinPattern::default(), wrap),
                Err(ContactError::WrapAngle { .. })
            ));
        }
        assert!(matches!(
            Contact::new(Substrate::Abs, PinPattern::new(vec![0.9]), 1.0),
            Err(ContactError::NoPinInWrap { .. })
        ));
    }
}
