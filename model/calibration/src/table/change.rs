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

    /// Returns whether a condition of the frame depends on the constant.
    fn acts_in(self, frame: &Frame) -> bool {
        frame.conditions.iter().any(|c| match self {
            Changing::Pins => c.has_pins(),
            Changing::Silicone => c.is_silicone_or_plain(),
            Changing::HalfLoad => c.device.is_some(),
        })
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

/// Most groups for which a change of each single group is tried.
const MOST_ALONE: usize = 8;
/// Most change points that are tried; with more groups, only every n-th.
const MOST_STRETCHES: usize = 24;

impl Frame {
    /// Returns the names of the groups of a grouping.
    pub fn groups_by(&self, by: Grouping) -> &[String] {
        match by {
            Grouping::Session => &self.sessions,
            Grouping::Specimen => &self.specimens,
        }
    }

    /// Returns the changes that the table could show: of all groups up to a change point, or of one
    /// group alone.
    pub(crate) fn possible_changes(&self) -> Vec<Change> {
        let mut changes = Vec::new();
        for by in [Grouping::Specimen, Grouping::Session] {
            let count = self.groups_by(by).len();
            let stride = count.div_ceil(MOST_STRETCHES).max(1);
            let stretches = (1..count).step_by(stride).map(|end| (0..end).collect::<Vec<_>>());
            let alone = (1..count.saturating_sub(1)).filter(|_| count <= MOST_ALONE).map(|i| vec![i]);
            for groups in stretches.chain(alone) {
                for constant in [Changing::Silicone, Changing::Pins, Changing::HalfLoad] {
                    let change = Change { constant, by, groups: groups.clone() };
                    if constant.acts_in(self) && !self.changes.contains(&change) {
                        changes.push(change);
                    }
                }
            }
        }
        changes
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_session::session;

    fn frame(sessions: usize) -> Frame {
        let mut rows = session(1);
        let count = rows.len();
        for (i, row) in rows.iter_mut().enumerate() {
            row.labels.session = format!("day {}", i * sessions / count);
        }
        Frame::new(&rows)
    }

    #[test]
    fn one_session_allows_no_change() {
        assert!(frame(1).possible_changes().is_empty());
        assert_eq!(frame(2).possible_changes().len(), 3, "three constants of the first session");
        let of = |groups: &[usize]| frame(3).possible_changes().iter().filter(|c| c.groups == groups).count();
        assert_eq!((of(&[0]), of(&[0, 1]), of(&[1]), of(&[2])), (3, 3, 3, 0));
        assert!(frame(60).possible_changes().len() <= 3 * MOST_STRETCHES);
    }

    #[test]
    fn unknown_sessions_count_as_the_latest() {
        let frame = frame(2);
        let change = Change { constant: Changing::Silicone, by: Grouping::Session, groups: vec![0] };
        let mut rows = session(1);
        rows.truncate(2);
        for (label, applies) in [("day 0", true), ("day 1", false), ("", false), ("day 7", false)] {
            rows.iter_mut().for_each(|r| r.labels.session = label.to_owned());
            assert_eq!(change.applies_to(&frame.points(&rows).unwrap()[0]), applies, "{label}");
        }
    }
}
