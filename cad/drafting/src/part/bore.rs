//! Bores: round and hexagonal holes on one axis, such as a screw hole with its counterbore or a nut trap with its hole.

use std::f64::consts::FRAC_PI_6;

use crate::contour::{same, same_point};
use pinswitch_solid::profile::Point2;

/// One hole of a [`Bore`], between the heights at which its wall begins and ends.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Stage {
    /// Height and radius in mm at each ring, from below. The radius of a hexagon is half of its width across flats.
    pub(crate) levels: Vec<(f64, f64)>,
    /// The direction of the flats of a hexagon; `None` for a round hole.
    pub(crate) flats: Option<Flats>,
    /// Whether it ends in the open below, and not on a floor.
    pub(crate) opens_down: bool,
    /// Whether it ends in the open above, and not on a ceiling.
    pub(crate) opens_up: bool,
}

/// The direction of two flats of a hexagonal hole.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Flats {
    /// Square to the radius about the axis of the part.
    SquareToRadius,
    /// Along x.
    AlongX,
    /// At this angle from x, degrees.
    AtAngle(f64),
}

impl Stage {
    /// Height and radius at the lower and at the upper end.
    pub(crate) fn ends(&self) -> ((f64, f64), (f64, f64)) {
        (self.levels[0], self.levels[self.levels.len() - 1])
    }

    pub(crate) fn depth_mm(&self) -> f64 {
        let (low, high) = self.ends();
        high.0 - low.0
    }

    /// Half of the greatest width, mm; to a corner of a hexagon.
    pub(crate) fn reach_mm(&self) -> f64 {
        let widest = self.levels.iter().map(|l| l.1).fold(0.0, f64::max);
        if self.flats.is_some() { widest / libm::cos(FRAC_PI_6) } else { widest }
    }

    fn is_like(&self, other: &Self) -> bool {
        self.flats == other.flats
            && self.opens_down == other.opens_down
            && self.opens_up == other.opens_up
            && self.levels.len() == other.levels.len()
            && self.levels.iter().zip(&other.levels).all(|(a, b)| same(a.0, b.0) && same(a.1, b.1))
    }
}

/// All holes on one axis, and the centres of all equal ones.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Bore {
    /// Centres.
    pub(crate) centres: Vec<Point2>,
    /// Its holes, from below.
    pub(crate) stages: Vec<Stage>,
}

impl Bore {
    /// Half of the greatest width, mm.
    pub(crate) fn reach_mm(&self) -> f64 {
        self.stages.iter().map(Stage::reach_mm).fold(0.0, f64::max)
    }

    /// Half of the width in the front view, mm.
    pub(crate) fn front_radius_mm(&self) -> f64 {
        self.stages.last().map_or(0.0, |s| s.ends().1.1)
    }

    /// Thickness of the closed skin between each stage and the next, mm; 0 without one.
    pub(crate) fn skins_mm(&self) -> impl Iterator<Item = f64> {
        self.stages.windows(2).map(|w| w[1].ends().0.0 - w[0].ends().1.0)
    }

    /// Whether it is open from face to face.
    pub(crate) fn is_through(&self) -> bool {
        let ends = (self.stages.first(), self.stages.last());
        let is_open = matches!(ends, (Some(low), Some(high)) if low.opens_down && high.opens_up);
        is_open && self.skins_mm().all(|skin| same(skin, 0.0))
    }

    /// Whether it is a single hole from face to face.
    pub(crate) fn is_plain(&self) -> bool {
        self.stages.len() == 1 && self.is_through()
    }
}

/// Adds a stage to the bore at `centre`. Every bore in `axes` has one centre.
pub(crate) fn add_stage(axes: &mut Vec<Bore>, centre: Point2, stage: Stage) {
    match axes.iter_mut().find(|a| same_point(a.centres[0], centre)) {
        Some(axis) => axis.stages.push(stage),
        None => axes.push(Bore { centres: vec![centre], stages: vec![stage] }),
    }
}

/// Joins equal bores into one with several centres.
pub(crate) fn joined(axes: Vec<Bore>) -> Vec<Bore> {
    let mut all: Vec<Bore> = Vec::new();
    for mut axis in axes {
        axis.stages.sort_by(|a, b| a.levels[0].0.total_cmp(&b.levels[0].0));
        let is_like = |other: &Bore| {
            other.stages.len() == axis.stages.len()
                && other.stages.iter().zip(&axis.stages).all(|(a, b)| a.is_like(b))
        };
        match all.iter_mut().find(|b| is_like(b)) {
            Some(other) => other.centres.extend(axis.centres),
            None => all.push(axis),
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn holes_on_one_axis_are_one_bore() {
        let stage = |levels: &[(f64, f64)], flats, opens_down, opens_up| Stage {
            levels: levels.to_vec(),
            flats,
            opens_down,
            opens_up,
        };
        let mut axes = Vec::new();
        for x in [-3.0, 3.0] {
            let nut = stage(&[(0.0, 2.85), (2.4, 2.85)], Some(Flats::SquareToRadius), true, false);
            add_stage(&mut axes, Point2::new(x, 1.0), stage(&[(2.8, 1.7), (5.0, 1.7)], None, false, true));
            add_stage(&mut axes, Point2::new(x, 1.0), nut);
        }
        let all = joined(axes);
        assert_eq!((all.len(), all[0].centres.len(), all[0].stages.len()), (1, 2, 2));
        assert!(all[0].stages[0].flats.is_some() && !all[0].is_through() && !all[0].is_plain());
        assert!((all[0].skins_mm().next().unwrap() - 0.4).abs() < 1e-9);
    }
}
