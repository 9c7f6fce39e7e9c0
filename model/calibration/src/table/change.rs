//! Constants of the switch that some sessions, or some specimens, have otherwise than the latest one.

use serde::{Deserialize, Serialize};

use super::frame::{Frame, Point};

/// A constant that another specimen may have otherwise.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Changing {
    /// Friction coefficient of the pins.
    #[serde(rename = "mu_p")]
    Pins,
    /// Friction coefficient of the silicone, or of a `plain` contact.
    #[serde(rename = "mu_s")]
    Silicone,
    /// Load in newtons at which the layouts have half switched, all by one factor.
    #[serde(rename = "F_half")]
    HalfLoad,
}

impl Changing {
    /// The word in reports and model files.
    pub fn as_str(self) -> &'static str {
        match self {
            Changing::Pins => "mu_p",
            Changing::Silicone => "mu_s",
            Changing::HalfLoad => "F_half",
        }
    }

    /// Whether some condition of a frame depends on it.
    fn acts_in(self, frame: &Frame) -> bool {
        frame.conditions.iter().any(|c| match self {
            Changing::Pins => c.has_pins(),
            Changing::Silicone => c.is_silicone_or_plain(),
            Changing::HalfLoad => c.device.is_some(),
        })
    }
}

/// What tells the rows apart that a constant differs between.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Grouping {
    /// The session.
    Session,
    /// The specimen, where the table names it.
    Specimen,
}

impl Grouping {
    /// The word in reports.
    pub fn as_str(self) -> &'static str {
        match self {
            Grouping::Session => "session",
            Grouping::Specimen => "specimen",
        }
    }
}

/// A constant that some groups have otherwise, by one factor.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Change {
    /// What differs.
    pub constant: Changing,
    /// Between what.
    pub by: Grouping,
    /// The groups that have it otherwise, as places in [`Frame::sessions`] or [`Frame::specimens`]. The last group is
    /// none of them: what is predicted is the switch as it is now.
    pub groups: Vec<usize>,
}

impl Change {
    /// Whether a row has the constant otherwise.
    pub(crate) fn holds(&self, point: &Point) -> bool {
        let group = match self.by {
            Grouping::Session => point.session_group,
            Grouping::Specimen => point.specimen_group,
        };
        group.is_some_and(|group| self.groups.contains(&group))
    }
}

/// Groups beyond which only the stretches from the first one on are tried.
const MOST_ALONE: usize = 8;
/// Stretches that are tried: of more groups, some ends only.
const MOST_STRETCHES: usize = 24;

impl Frame {
    /// Names of the groups of one kind.
    pub fn groups_by(&self, by: Grouping) -> &[String] {
        match by {
            Grouping::Session => &self.sessions,
            Grouping::Specimen => &self.specimens,
        }
    }

    /// The changes that a table of these sessions and specimens could show: of all groups up to one of them, or of one
    /// alone.
    pub(crate) fn possible_changes(&self) -> Vec<Change> {
        let mut found = Vec::new();
        for by in [Grouping::Specimen, Grouping::Session] {
            let count = self.groups_by(by).len();
            let stride = count.div_ceil(MOST_STRETCHES).max(1);
            let stretches = (1..count).step_by(stride).map(|end| (0..end).collect::<Vec<_>>());
            let alone = (1..count.saturating_sub(1)).filter(|_| count <= MOST_ALONE).map(|i| vec![i]);
            for groups in stretches.chain(alone) {
                for constant in [Changing::Silicone, Changing::Pins, Changing::HalfLoad] {
                    let change = Change { constant, by, groups: groups.clone() };
                    if constant.acts_in(self) && !self.changes.contains(&change) {
                        found.push(change);
                    }
                }
            }
        }
        found
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
    fn one_session_has_nothing_to_differ_from() {
        assert!(frame(1).possible_changes().is_empty());
        assert_eq!(frame(2).possible_changes().len(), 3, "three constants of the first session");
        let of = |groups: &[usize]| frame(3).possible_changes().iter().filter(|c| c.groups == groups).count();
        assert_eq!((of(&[0]), of(&[0, 1]), of(&[1]), of(&[2])), (3, 3, 3, 0));
        assert!(frame(60).possible_changes().len() <= 3 * MOST_STRETCHES);
    }

    #[test]
    fn a_session_that_the_frame_does_not_know_is_like_the_latest() {
        let frame = frame(2);
        let change = Change { constant: Changing::Silicone, by: Grouping::Session, groups: vec![0] };
        let mut rows = session(1);
        rows.truncate(2);
        for (label, holds) in [("day 0", true), ("day 1", false), ("", false), ("day 7", false)] {
            rows.iter_mut().for_each(|r| r.labels.session = label.to_owned());
            assert_eq!(change.holds(&frame.points(&rows).unwrap()[0]), holds, "{label}");
        }
    }
}
