//! Round and hexagonal holes that lie one over another on one axis: holes of screws with their recesses, nut traps, seats
//! of inserts and of bearings. Each axis is told in one callout, from the far face to the near one, which the front view
//! shows.

use pinswitch_friction::sort_by_number;

use super::features::same;
use super::fits::{self, Fit};
use super::words::{number, on_radius, times};
use crate::design::Design;
use crate::parts::Part;
use pinswitch_solid::profile::{Contour, Edge, Point2};
use std::f64::consts::FRAC_PI_6;

/// One hole of a [`Bore`], between the heights at which its wall begins and ends.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Stage {
    /// Height, and radius or half across the flats, from below.
    pub(super) levels: Vec<(f64, f64)>,
    pub(super) is_hexagon: bool,
    /// Whether it ends in the open, and not on a floor or a ceiling.
    pub(super) opens_down: bool,
    pub(super) opens_up: bool,
}

impl Stage {
    fn ends(&self) -> ((f64, f64), (f64, f64)) {
        (self.levels[0], self.levels[self.levels.len() - 1])
    }

    fn depth_mm(&self) -> f64 {
        let (low, high) = self.ends();
        high.0 - low.0
    }

    /// Half of its greatest width, mm: of a hexagon to a corner.
    fn reach_mm(&self) -> f64 {
        let widest = self.levels.iter().map(|l| l.1).fold(0.0, f64::max);
        if self.is_hexagon { widest / libm::cos(FRAC_PI_6) } else { widest }
    }

    fn is_like(&self, other: &Self) -> bool {
        self.is_hexagon == other.is_hexagon
            && self.opens_down == other.opens_down
            && self.opens_up == other.opens_up
            && self.levels.len() == other.levels.len()
            && self.levels.iter().zip(&other.levels).all(|(a, b)| same(a.0, b.0) && same(a.1, b.1))
    }

    /// Its size across.
    fn across(&self) -> String {
        let (low, high) = self.ends();
        match (self.is_hexagon, same(low.1, high.1)) {
            (true, _) => format!("hexagon AF {}", number(2.0 * low.1)),
            (false, true) => format!("\u{d8}{}", number(2.0 * low.1)),
            (false, false) => format!("\u{d8}{} to \u{d8}{}", number(2.0 * low.1), number(2.0 * high.1)),
        }
    }
}

/// All holes on one axis, and every place where there is such an axis.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Bore {
    pub(super) centres: Vec<Point2>,
    /// From below.
    pub(super) stages: Vec<Stage>,
}

impl Bore {
    /// Half of its greatest width, mm.
    pub(super) fn reach_mm(&self) -> f64 {
        self.stages.iter().map(Stage::reach_mm).fold(0.0, f64::max)
    }

    /// Half of the width of what the front view shows of it, mm.
    pub(super) fn shown_mm(&self) -> f64 {
        self.stages.last().map_or(0.0, |s| s.ends().1.1)
    }

    /// Thickness of what closes it between one stage and the next, mm.
    fn skins_mm(&self) -> impl Iterator<Item = f64> {
        self.stages.windows(2).map(|w| w[1].ends().0.0 - w[0].ends().1.0)
    }

    /// Whether one sees through it.
    fn is_through(&self) -> bool {
        let ends = (self.stages.first(), self.stages.last());
        let is_open = matches!(ends, (Some(low), Some(high)) if low.opens_down && high.opens_up);
        is_open && self.skins_mm().all(|skin| same(skin, 0.0))
    }

    /// Whether it is one plain hole from face to face.
    pub(super) fn is_plain(&self) -> bool {
        self.stages.len() == 1 && self.is_through()
    }
}

/// Puts a stage at `centre` to the others on its axis: `axes` are one centre each.
pub(super) fn add_stage(axes: &mut Vec<Bore>, centre: Point2, stage: Stage) {
    match axes.iter_mut().find(|a| (a.centres[0] - centre).norm() < 1e-6) {
        Some(axis) => axis.stages.push(stage),
        None => axes.push(Bore { centres: vec![centre], stages: vec![stage] }),
    }
}

/// Axes with the same holes, together.
pub(super) fn gathered(axes: Vec<Bore>) -> Vec<Bore> {
    let mut all: Vec<Bore> = Vec::new();
    for mut axis in axes {
        sort_by_number(&mut axis.stages, |stage| stage.levels[0].0);
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

/// Middle and half across the flats of a contour that is a regular hexagon.
pub(super) fn hexagon(contour: &Contour) -> Option<(Point2, f64)> {
    let corners = contour.corners();
    if corners.len() != 6 || contour.edges().iter().any(|e| !matches!(e, Edge::Line)) {
        return None;
    }
    let middle = nalgebra::center(&corners[0], &corners[3]);
    let radius = (corners[0] - middle).norm();
    let is_regular = (0..6).all(|i| {
        let (from, to) = contour.ends(i);
        same((from - middle).norm(), radius) && same((to - from).norm(), radius)
    });
    is_regular.then(|| (middle, radius * libm::cos(FRAC_PI_6)))
}

/// What a bore is called, where `is_axial` parts say places about the pulley's axis.
pub(super) fn bore(design: &Design, part: &Part, bore: &Bore, is_axial: bool) -> Vec<String> {
    let n = times(bore.centres.len());
    let fit = |stage: &Stage| fits::of_stage(design, part, *bore.centres.first()?, stage);
    let mut lines = match &bore.stages[..] {
        [stage] => single(stage, bore.is_through(), fit(stage).as_ref()),
        [low, between, high] if bore.is_through() && is_mirrored(low, high) => {
            let fit_of_low = fit(low);
            let wide =
                format!("{}, {} deep, both faces", sized(low, fit_of_low.as_ref()), number(low.depth_mm()));
            let purpose = fit_of_low.map_or_else(String::new, |f| f.purpose);
            vec![wide, purpose, format!("{} between them", sized(between, fit(between).as_ref()))]
        }
        stages => {
            let fits: Vec<Option<Fit>> = stages.iter().map(fit).collect();
            stacked(bore, stages, &fits, is_on_fasteners(design, &bore.centres))
        }
    };
    if let Some(first) = lines.first_mut() {
        first.insert_str(0, &n);
    }
    lines.retain(|l| !l.is_empty());
    if is_axial {
        lines.extend(on_radius(&bore.centres));
    }
    lines
}

/// Whether two stages are alike, but for the face that they open to.
fn is_mirrored(low: &Stage, high: &Stage) -> bool {
    !low.is_hexagon && low.across() == high.across() && same(low.depth_mm(), high.depth_mm())
}

/// Whether all lie where the screws of the shell are.
fn is_on_fasteners(design: &Design, centres: &[Point2]) -> bool {
    let radius = design.fastener_radius_mm();
    centres.iter().all(|p| {
        let angles = design.fastener_angles_rad();
        same(p.coords.norm(), radius)
            && angles.iter().any(|a| (libm::atan2(p.x.abs(), p.y) - a.abs()).abs() < 1e-6)
    })
}

/// The size of a stage with its tolerance.
fn sized(stage: &Stage, fit: Option<&Fit>) -> String {
    fit.map_or_else(|| stage.across(), |f| format!("{} {}", stage.across(), f.tolerance))
}

/// `, for dowel 2` behind what is for a dowel.
fn purpose(fit: Option<&Fit>) -> String {
    fit.map_or_else(String::new, |f| format!(", {}", f.purpose))
}

/// One hole on an axis.
fn single(stage: &Stage, is_through: bool, fit: Option<&Fit>) -> Vec<String> {
    let (low, high) = stage.ends();
    let deep = match fit.map(|f| f.depth_tolerance) {
        Some(tolerance) if !tolerance.is_empty() => format!("{} {tolerance}", number(stage.depth_mm())),
        _ => number(stage.depth_mm()),
    };
    let face = if stage.opens_down { ", far face" } else { "" };
    match (is_through, same(low.1, high.1)) {
        (true, true) => vec![format!("{} through{}", sized(stage, fit), purpose(fit))],
        (false, true) => vec![format!("{}, {deep} deep{face}{}", sized(stage, fit), purpose(fit))],
        (_, false) => {
            let tolerance = fit.map_or_else(String::new, |f| format!(" {}", f.tolerance));
            let wide = |radius: f64| format!("\u{d8}{}{tolerance}", number(2.0 * radius));
            let mouth = format!("{}, {deep} deep{face}", wide(low.1));
            let end = format!("{} at its end{}", wide(high.1), purpose(fit));
            if fit.is_some() { vec![mouth + ",", end] } else { vec![format!("{mouth}, {end}")] }
        }
    }
}

/// Stages of several widths from the far face to the near one, with what closes the way between them.
fn stacked(bore: &Bore, stages: &[Stage], fits: &[Option<Fit>], is_on_fasteners: bool) -> Vec<String> {
    let mut lines = Vec::new();
    let skins: Vec<f64> = bore.skins_mm().collect();
    for (i, (stage, fit)) in stages.iter().zip(fits).enumerate() {
        let is_narrowest = stages.iter().all(|s| s.reach_mm() >= stage.reach_mm());
        let depth =
            match (bore.is_through() && is_narrowest, stage.opens_down && i == 0, i + 1 == stages.len()) {
                (true, ..) => " through".to_owned(),
                (_, true, _) => format!(", {} deep, far face", number(stage.depth_mm())),
                (_, _, true) => format!(", {} deep, near face", number(stage.depth_mm())),
                _ => format!(", {} long", number(stage.depth_mm())),
            };
        let size = sized(stage, fit.as_ref());
        if stage.is_hexagon {
            let flats = if is_on_fasteners { "two flats square to the radius" } else { "two flats along X" };
            lines.push(format!("{size}{depth}"));
            lines.push(fit.as_ref().map_or_else(|| flats.to_owned(), |f| format!("{}, {flats}", f.purpose)));
        } else {
            lines.push(format!("{size}{depth}{}", purpose(fit.as_ref())));
        }
        if let Some(skin) = skins.get(i).filter(|s| !same(**s, 0.0)) {
            lines.push(format!("closed skin {} above it", number(*skin)));
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn holes_on_one_axis_are_one_bore() {
        let stage = |levels: &[(f64, f64)], is_hexagon, opens_down, opens_up| Stage {
            levels: levels.to_vec(),
            is_hexagon,
            opens_down,
            opens_up,
        };
        let mut axes = Vec::new();
        for x in [-3.0, 3.0] {
            add_stage(&mut axes, Point2::new(x, 1.0), stage(&[(2.8, 1.7), (5.0, 1.7)], false, false, true));
            add_stage(&mut axes, Point2::new(x, 1.0), stage(&[(0.0, 2.85), (2.4, 2.85)], true, true, false));
        }
        let all = gathered(axes);
        assert_eq!((all.len(), all[0].centres.len(), all[0].stages.len()), (1, 2, 2));
        assert!(all[0].stages[0].is_hexagon && !all[0].is_through() && !all[0].is_plain());
        assert!((all[0].skins_mm().next().unwrap() - 0.4).abs() < 1e-9);
    }

    #[test]
    fn only_regular_hexagons_are_hexagons() {
        let at = |i: i32| Point2::new(2.0 * libm::cos(f64::from(i)), 2.0 * libm::sin(f64::from(i)));
        let corner = |i: i32| {
            let angle = f64::from(i) * std::f64::consts::FRAC_PI_3 + 0.3;
            Point2::new(1.0 + 2.0 * libm::cos(angle), 2.0 * libm::sin(angle))
        };
        let (middle, half) = hexagon(&Contour::polygon((0..6).map(corner).collect())).unwrap();
        assert!((middle - Point2::new(1.0, 0.0)).norm() < 1e-9 && (half - 3.0_f64.sqrt()).abs() < 1e-9);
        assert!(hexagon(&Contour::polygon((0..6).map(at).collect())).is_none());
    }
}
