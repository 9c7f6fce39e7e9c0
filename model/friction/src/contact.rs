//! The contact of a tendon with a switch: the validated input of every prediction.

use pinswitch_diagnostic::{Diagnostic, Location, codes};

use crate::bed::Bed;
use crate::pattern::PinPattern;
use crate::plural::pluralise;
use crate::published::{self, PublishedLayout};
use crate::substrate::Substrate;

/// Largest wrap angle in degrees: two turns.
const MAX_WRAP_DEG: f64 = 720.0;
/// Largest difference from the pitch of a published layout, in radians (0.006 degrees).
const SAME_PITCH_RAD: f64 = 1e-4;

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
                Self::new(codes::OUT_OF_RANGE, format!("must be above 0 and at most {MAX_WRAP_DEG}"))
                    .with_location(Location::field("wrap angle (deg)", degrees.to_string()))
                    .with_help("give the angle over which the tendon touches the pulley")
            }
            ContactError::NoPinInWrap { degrees } => Self::new(
                codes::NO_SUPPORT,
                format!("no pin of the rigid proxy is within the wrap of {degrees:.2} deg"),
            )
            .with_help("move a pin into the wrap, or use silicone"),
        }
    }
}

/// Surface under the tendon: substrate, pins, wrap angle and dimensions.
///
/// ```
/// use pinswitch_friction::{Contact, ContactError, PinPattern, Substrate};
///
/// // Four pins, three of them within a wrap of 64 degrees.
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
    modulus_scatter: f64,
}

impl Contact {
    /// Creates a contact over `wrap_rad` radians, the angle between the directions of the incoming
    /// and the outgoing tendon. Its dimensions are those of the published bed.
    ///
    /// # Errors
    /// [`ContactError`] if the angle is out of bounds, or if a rigid proxy has no pin within the
    /// wrap.
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
            modulus_scatter: 0.0,
        })
    }

    /// Sets `F_thr` of six-single, which the paper prints as 5.7 but leaves ambiguous
    /// (`model/doc/friction-laws.md`).
    #[must_use]
    pub fn with_six_single_threshold(mut self, threshold: f64) -> Self {
        self.six_single_threshold = threshold;
        self
    }

    /// Sets the deviations from the measured part that no law models, such as another mix of the
    /// silicone. Predictions are then extrapolated, and list each deviation as a reason.
    #[must_use]
    pub fn with_unmodelled(mut self, unmodelled: Vec<String>) -> Self {
        self.unmodelled = unmodelled;
        self
    }

    /// Returns the same part with another wrap angle, in radians.
    ///
    /// # Errors
    /// [`ContactError`] as [`Contact::new`].
    pub fn at_wrap(&self, wrap_rad: f64) -> Result<Self, ContactError> {
        self.at_wrap_about(wrap_rad, 0.0)
    }

    /// Returns the same part with another wrap angle about another middle, in radians: the pins
    /// move by `-middle_rad` relative to the wrap.
    ///
    /// # Errors
    /// [`ContactError`] as [`Contact::new`].
    pub fn at_wrap_about(&self, wrap_rad: f64, middle_rad: f64) -> Result<Self, ContactError> {
        let pins = PinPattern::new(self.all_pins.angles_rad().iter().map(|a| a - middle_rad).collect());
        let other = Self::new(self.substrate, pins, wrap_rad)?;
        Ok(Self {
            unmodelled: self.unmodelled.clone(),
            six_single_threshold: self.six_single_threshold,
            bed: self.bed,
            modulus_scatter: self.modulus_scatter,
            ..other
        })
    }

    /// Sets the dimensions and stiffness of the support, which the physics uses.
    #[must_use]
    pub fn with_bed(mut self, bed: Bed) -> Self {
        self.bed = bed;
        self
    }

    /// Sets the relative standard deviation of the silicone's modulus between castings; 0 for a layer
    /// whose modulus is known. The band of a prediction contains it.
    #[must_use]
    pub fn with_modulus_scatter(mut self, relative: f64) -> Self {
        self.modulus_scatter = relative;
        self
    }

    /// Returns the relative standard deviation of the silicone's modulus between castings.
    pub fn modulus_scatter(&self) -> f64 {
        self.modulus_scatter
    }

    /// Returns the dimensions and stiffness of the support.
    pub fn bed(&self) -> &Bed {
        &self.bed
    }

    /// Returns the material under the pins.
    pub fn substrate(&self) -> Substrate {
        self.substrate
    }

    /// Returns the pins within the wrap.
    pub fn pins(&self) -> &PinPattern {
        &self.pins
    }

    /// Returns all pins of the part. The physics needs them all, because a pin just beyond the wrap
    /// may still touch the free span.
    pub fn all_pins(&self) -> &PinPattern {
        &self.all_pins
    }

    /// Returns the wrap angle in radians.
    pub fn wrap_rad(&self) -> f64 {
        self.wrap_rad
    }

    /// Returns the deviations from the measured part that no law models.
    pub fn unmodelled(&self) -> &[String] {
        &self.unmodelled
    }

    /// Returns the remarks on this contact for a prediction: what no law models, and pins outside
    /// the wrap.
    pub fn remarks(&self) -> Vec<String> {
        let mut all = self.unmodelled.clone();
        let outside = self.all_pins.count() - self.pins.count();
        if outside > 0 {
            let verb = if outside == 1 { "is" } else { "are" };
            all.push(format!("{} {verb} outside the wrap", pluralise(outside, "pin")));
        }
        all
    }

    /// Returns the published layout with these pins (same number, same even pitch, centred on the
    /// wrap), if any.
    pub fn published_layout(&self) -> Option<PublishedLayout> {
        let pitch = self.pins.mean_pitch_rad()?;
        let mut layout = *published::LAYOUTS.iter().find(|l| {
            l.pins == self.pins.count()
                && (l.pitch_rad() - pitch).abs() < SAME_PITCH_RAD
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
    fn published_layouts_are_recognised() {
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
    fn wrap_angle_selects_the_pins() {
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
    fn invalid_contacts_are_refused() {
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
