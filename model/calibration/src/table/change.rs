//! Constants of the switch that differ between sessions or specimens.

use serde::{Deserialize, Serialize};

use super::frame::{Frame, Point};

/// A constant that may differ between specimens.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Changing {
    /// Friction coefficient of the pins.
    #[serde(rename = "mu_p")]
    Pins,
    /// Friction coefficient of the silicone, or of a `plain` contact.
    #[serde(rename = "mu_s")]
    Silicone,
    /// Threshold in newtons; one factor applies to all layouts.
    #[serde(rename = "F_half")]
    HalfLoad,
}

impl Changing {
    /// Returns the word used in reports and model files.
    pub fn as_str(self) -> &'static str {
        match self {
            Changing::Pins => "mu_p",
            Changing::Silicone => "mu_s",
            Changing::HalfLoad => "F_half",
        }
    }
}

/// Grouping of rows between which a constant may differ.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Grouping {
    /// The session.
    Session,
    /// The specimen, where the table names it.
    Specimen,
}

impl Grouping {
    /// Returns the word used in reports.
    pub fn as_str(self) -> &'static str {
        match self {
            Grouping::Session => "session",
            Grouping::Specimen => "specimen",
        }
    }
}

/// A constant that differs in some groups from the last one, by a common factor.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Change {
    /// The constant.
    pub constant: Changing,
    /// The grouping.
    pub by: Grouping,
    /// Groups with the other value, as indices into [`Frame::sessions`] or [`Frame::specimens`].
    /// The last group is never among them, since predictions are for the current switch.
    pub groups: Vec<usize>,
}

impl Change {
    /// Returns whether a row belongs to a group with the other value.
    pub(crate) fn applies_to(&self, point: &Point) -> bool {
        let group = match self.by {
            Grouping::Session => point.session_group,
            Grouping::Specimen => point.specimen_group,
        };
        group.is_some_and(|group| self.groups.contains(&group))
    }
}

impl Frame {
    /// Returns the names of the groups of a grouping.
    pub fn groups_by(&self, by: Grouping) -> &[String] {
        match by {
            Grouping::Session => &self.sessions,
            Grouping::Specimen => &self.specimens,
        }
    }
}
