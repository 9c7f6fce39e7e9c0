//! The definition of a law, which each law's file declares.

use super::error::LawError;
use crate::band_source::BandSource;
use crate::contact::Contact;
use crate::switch::SwitchState;

/// Definition of a law.
pub(crate) struct LawDefinition {
    /// Name in files and on the command line.
    pub(crate) word: &'static str,
    /// Name in legends.
    pub(crate) title: &'static str,
    /// Description with the domain, in one line.
    pub(crate) summary: &'static str,
    /// Source of the equation or of the constants.
    pub(crate) source: &'static str,
    /// Whether it needs a model file in addition to the contact.
    pub(crate) needs_model: bool,
    /// Predicts the states of a contact at loads in newtons.
    pub(crate) states: fn(&Contact, &[f64]) -> Result<Vec<SwitchState>, LawError>,
    /// Predicts friction at loads in newtons, with the uncertainty of the law itself: its
    /// constants, and its scatter about the measurements.
    pub(crate) uncertain: fn(&Contact, &[f64]) -> Result<UncertainFriction, LawError>,
    /// Returns a known error of the law for a contact, as text.
    pub(crate) remark: fn(&Contact) -> Option<String>,
}

/// Friction in newtons with the uncertainty of the law itself, load by load.
pub(crate) struct UncertainFriction {
    pub(crate) friction_n: Vec<f64>,
    pub(crate) sources: Vec<BandSource>,
}
