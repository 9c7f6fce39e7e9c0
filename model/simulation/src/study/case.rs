//! A kind of rig in the study.

use pinswitch_calibration::effects::Covariate;

use super::nulls::{NULLS, OFTEN};
use crate::plan::Protocol;

/// Truth about a rig.
#[derive(Clone, Debug, PartialEq)]
pub enum Truth {
    /// No effect: the paper's model.
    Nothing,
    /// Effects of the vocabulary.
    Effects(Vec<&'static str>),
    /// Effects that are confounded in this protocol: the answer must report all of them.
    Confounded(Vec<&'static str>),
    /// Small effect, the first of two that are confounded in this protocol: the answer must report
    /// both, or be inconclusive.
    SmallConfounded([&'static str; 2]),
    /// Disturbance outside the vocabulary.
    Outside {
        /// Correct covariates; any of them will do.
        covariates: &'static [Covariate],
        /// Effect of the vocabulary that is also a correct answer.
        or_named: Option<&'static str>,
    },
}

/// Group of kinds of rig.
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
    /// A drag of the guide pulleys, and a second effect that it may mask.
    Masks,
    /// One effect that is confounded with another in the protocol.
    Confounded,
    /// A disturbance outside the vocabulary.
    Outside,
    /// The small bench without effect.
    BenchNulls,
    /// The small bench with one effect.
    BenchSingles,
    /// The small bench with two effects.
    BenchPairs,
    /// The small bench with a disturbance outside the vocabulary.
    BenchOutside,
}

impl Group {
    /// All groups.
    pub const ALL: [Group; 11] = [
        Group::Nulls,
        Group::Singles,
        Group::Scattered,
        Group::Pairs,
        Group::Masks,
        Group::Confounded,
        Group::Outside,
        Group::BenchNulls,
        Group::BenchSingles,
        Group::BenchPairs,
        Group::BenchOutside,
    ];

    /// Returns the name on the command line, such as `nulls`.
    pub fn as_str(self) -> &'static str {
        match self {
            Group::Nulls => "nulls",
            Group::Singles => "singles",
            Group::Scattered => "scattered",
            Group::Pairs => "pairs",
            Group::Masks => "masks",
            Group::Confounded => "confounded",
            Group::Outside => "outside",
            Group::BenchNulls => "bench-nulls",
            Group::BenchSingles => "bench-singles",
            Group::BenchPairs => "bench-pairs",
            Group::BenchOutside => "bench-outside",
        }
    }
}

/// Kind of rig.
#[derive(Clone, Debug, PartialEq)]
pub struct Case {
    /// Effects or disturbance, as text.
    pub name: String,
    /// Protocol of the session.
    pub protocol: Protocol,
    /// Group of the kind.
    pub group: Group,
    /// Effects or disturbance.
    pub truth: Truth,
    /// Whether the rig has every kind of noise at once, instead of the noise of its kind.
    pub every_noise: bool,
}

impl Case {
    /// Whether the word is the name of its group, or else a part of its own name.
    pub fn matches(&self, word: &str) -> bool {
        match Group::ALL.iter().find(|g| g.as_str() == word) {
            Some(group) => self.group == *group,
            None => self.name.contains(word),
        }
    }

    /// Returns the number of rigs of this kind in a study with `seeds` rigs of every kind; the
    /// first kinds without effect have two and a half times as many.
    pub fn rigs(&self, seeds: u64) -> u64 {
        let often = NULLS.iter().take(OFTEN).any(|kind| kind.0 == self.name);
        if often { (10 * seeds).div_ceil(4) } else { seeds }
    }
}
