//! Tolerances and purposes of features: what other parts go into, which a solid does not show.

use super::bore::{Bore, Stage};
use crate::contour::{same, same_point};
use pinswitch_solid::profile::Point2;

/// The tolerance of a feature, and what it is for.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Fit {
    /// Tolerance of the width, such as `+0.1/0` or `H13`; empty without one.
    pub tolerance: String,
    /// Tolerance of the depth or height; empty without one.
    pub depth_tolerance: String,
    /// The purpose, such as `for dowel 2`; empty without one.
    pub purpose: String,
}

impl Fit {
    /// A tolerance of the width, with the purpose of the feature.
    pub fn new(tolerance: impl Into<String>, purpose: impl Into<String>) -> Self {
        Self { tolerance: tolerance.into(), depth_tolerance: String::new(), purpose: purpose.into() }
    }

    /// The same with a tolerance of the depth or height.
    #[must_use]
    pub fn with_depth_tolerance(mut self, tolerance: impl Into<String>) -> Self {
        self.depth_tolerance = tolerance.into();
        self
    }
}

/// The fit of a hole or of a boss.
#[derive(Clone, Debug, PartialEq)]
pub struct RoundFit {
    /// Its centre; `None` for all with this width.
    pub centre: Option<Point2>,
    /// Its radius, or half of its width across flats, at one of its ends, mm.
    pub half_mm: f64,
    /// The fit.
    pub fit: Fit,
}

/// The fits of the features of a part. The default has none.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Fits {
    /// Fits of round and hexagonal holes.
    pub holes: Vec<RoundFit>,
    /// Fits of round bosses and of a round part.
    pub bosses: Vec<RoundFit>,
    /// Fit of the width of slots.
    pub slots: Fit,
    /// Fit of the radius of half-round grooves and ribs.
    pub half_rounds: Fit,
}

impl Fits {
    /// The fit of a stage of the bore at `centre`.
    pub(super) fn of_stage(&self, centre: Point2, stage: &Stage) -> Option<&Fit> {
        find(&self.holes, centre, &stage.levels)
    }

    /// The fit of a boss with these heights and radii.
    pub(super) fn of_boss(&self, centre: Point2, levels: &[(f64, f64)]) -> Option<&Fit> {
        find(&self.bosses, centre, levels)
    }

    /// Splits bores whose holes have different fits.
    pub(super) fn split(&self, bores: Vec<Bore>) -> Vec<Bore> {
        let mut all: Vec<(Vec<Option<&Fit>>, Bore)> = Vec::new();
        for bore in bores {
            let first = all.len();
            for centre in bore.centres {
                let fits: Vec<_> = bore.stages.iter().map(|s| self.of_stage(centre, s)).collect();
                match all[first..].iter_mut().find(|(others, _)| *others == fits) {
                    Some((_, other)) => other.centres.push(centre),
                    None => all.push((fits, Bore { centres: vec![centre], stages: bore.stages.clone() })),
                }
            }
        }
        all.into_iter().map(|(_, bore)| bore).collect()
    }
}

fn find<'a>(fits: &'a [RoundFit], centre: Point2, levels: &[(f64, f64)]) -> Option<&'a Fit> {
    let is_of = |f: &&RoundFit| {
        f.centre.is_none_or(|at| same_point(at, centre)) && levels.iter().any(|l| same(l.1, f.half_mm))
    };
    fits.iter().find(is_of).map(|f| &f.fit)
}
