//! What each law's file declares.

use super::error::LawError;
use crate::band_source::BandSource;
use crate::contact::Contact;
use crate::switch::SwitchState;

/// What a law is and does.
pub(crate) struct LawDefinition {
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
    pub(crate) uncertain: fn(&Contact, &[f64]) -> Result<UncertainFriction, LawError>,
    /// What the law is known to get wrong of a contact, in words.
    pub(crate) remark: fn(&Contact) -> Option<String>,
}

/// Friction in newtons with the sources of a law's own uncertainty, load by load.
pub(crate) struct UncertainFriction {
    pub(crate) friction_n: Vec<f64>,
    pub(crate) sources: Vec<BandSource>,
}
