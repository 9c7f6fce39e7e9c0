//! One kind of rig in the study.

use pinswitch_calibration::effects::Covariate;

use super::nulls::{NULLS, OFTEN};
use crate::plan::Protocol;

/// What is true of a rig.
#[derive(Clone, Debug, PartialEq)]
pub enum Truth {
    /// The paper's model.
    Nothing,
    /// Effects of the vocabulary.
    Effects(Vec<&'static str>),
    /// Effects of which this protocol cannot tell one from another: the answer must name both.
    Confounded(Vec<&'static str>),
    /// The first of two effects that this protocol cannot tell apart, so small that it may be missed: the answer must
    /// name both, or say that it cannot be excluded.
    SmallConfounded([&'static str; 2]),
    /// Something outside the vocabulary.
    Outside {
        /// Where it may be found: any of these is right.
        covariates: &'static [Covariate],
        /// A name that is as right.
        or_named: Option<&'static str>,
    },
}

/// A group of kinds of rig.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Group {
    /// No effect.
    Nulls,
    /// One effect.
    Singles,
    /// One effect, and friction that differs by 1 to 2 % from series to series.
    Scattered,
    /// Two effects.
    Pairs,
    /// A drag of the guide pulleys that hides a second effect.
    Masks,
    /// One effect that the protocol cannot tell from another.
    Confounded,
    /// Something outside the vocabulary.
    Outside,
}

impl Group {
    /// All of them.
    pub const ALL: [Group; 7] = [
        Group::Nulls,
        Group::Singles,
        Group::Scattered,
        Group::Pairs,
        Group::Masks,
        Group::Confounded,
        Group::Outside,
    ];

    /// Its word.
    pub fn as_str(self) -> &'static str {
        match self {
            Group::Nulls => "nulls",
            Group::Singles => "singles",
            Group::Scattered => "scattered",
            Group::Pairs => "pairs",
            Group::Masks => "masks",
            Group::Confounded => "confounded",
            Group::Outside => "outside",
        }
    }
}

/// One kind of rig.
#[derive(Clone, Debug, PartialEq)]
pub struct Case {
    /// Its effects, or what is wrong with it, in words.
    pub name: String,
    /// Its protocol.
    pub protocol: Protocol,
    /// The group it is counted in.
    pub group: Group,
    /// What is true of it.
    pub truth: Truth,
    /// Whether it holds every kind of noise at once, whatever it would have of its own.
    pub every_noise: bool,
}

impl Case {
    /// Whether a word means it: that of its group, or else a part of its name.
    pub fn matches(&self, word: &str) -> bool {
        match Group::ALL.iter().find(|g| g.as_str() == word) {
            Some(group) => self.group == *group,
            None => self.name.contains(word),
        }
    }

    /// How many rigs of it a study makes that makes `seeds` of every kind: more of the first kinds without effect.
    pub fn rigs(&self, seeds: u64) -> u64 {
        let often = NULLS.iter().take(OFTEN).any(|kind| kind.0 == self.name);
        if often { (10 * seeds).div_ceil(4) } else { seeds }
    }
}
