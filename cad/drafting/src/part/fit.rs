//! Tolerances and purposes of features: what other parts go into, which a solid does not show.

use super::bore::{Bore, Stage};
use crate::Indicator;
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
    /// Geometrical tolerances.
    pub indicators: Vec<Indicator>,
    /// Letter of the datum of which the feature is.
    pub datum: Option<char>,
}

impl Fit {
    /// A tolerance of the width, with the purpose of the feature.
    pub fn new(tolerance: impl Into<String>, purpose: impl Into<String>) -> Self {
        Self { tolerance: tolerance.into(), purpose: purpose.into(), ..Self::default() }
    }

    /// The same with a geometrical tolerance.
    #[must_use]
    pub fn with_indicator(mut self, indicator: Indicator) -> Self {
        self.indicators.push(indicator);
        self
    }

    /// The same as a datum.
    #[must_use]
    pub fn with_datum(mut self, letter: char) -> Self {
        self.datum = Some(letter);
        self
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

/// The fit of an arc about the axis.
#[derive(Clone, Debug, PartialEq)]
pub struct RadiusFit {
    /// Its radius, mm.
    pub radius_mm: f64,
    /// The fit.
    pub fit: Fit,
}

/// A thickness along a radius with its tolerance, dimensioned in the section.
#[derive(Clone, Debug, PartialEq)]
pub struct RadialSize {
    /// What it measures.
    pub key: String,
    /// Radius of its inner face, mm.
    pub inner_mm: f64,
    /// Radius of its outer face, mm.
    pub outer_mm: f64,
    /// Tolerance, such as `±0.1`.
    pub tolerance: String,
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
    /// Fits of arcs about the axis.
    pub radii: Vec<RadiusFit>,
    /// Thicknesses along a radius.
    pub sizes: Vec<RadialSize>,
    /// Tolerance of the overall height; empty without one.
    pub height_tolerance: String,
    /// Datum of a face square to the axis.
    pub face: Option<FaceDatum>,
}

/// Datum of a face square to the axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FaceDatum {
    /// Letter.
    pub letter: char,
    /// Height of the face over the bottom of the part, mm.
    pub z_mm: f64,
    /// Whether the face is directed toward the observer of the front view.
    pub is_upper: bool,
}

impl Fits {
    /// The fit of arcs of a radius about the axis, with whether it is auxiliary: the outer face of a [`RadialSize`].
    pub(super) fn of_radius(&self, radius_mm: f64) -> (Option<&Fit>, bool) {
        let fit = self.radii.iter().find(|r| same(r.radius_mm, radius_mm)).map(|r| &r.fit);
        (fit, self.sizes.iter().any(|size| same(size.outer_mm, radius_mm)))
    }

    /// Whether a feature has a position tolerance.
    pub(super) fn has_positions(&self) -> bool {
        let of_holes = self.holes.iter().map(|hole| &hole.fit);
        of_holes.chain([&self.slots, &self.half_rounds]).any(|fit| !fit.indicators.is_empty())
    }

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
