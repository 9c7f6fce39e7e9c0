//! A solid in the coordinates of a side view: `u` across the paper, `z` the height, `w` toward the observer.

use pinswitch_solid::pose::Pose;
use pinswitch_solid::profile::{Contour, Edge};
use pinswitch_solid::solid::Solid;
use std::f64::consts::{PI, TAU};

use crate::contour::lettering;

/// Ends of curves are rounded to this, mm, so that neighbours share one number and a line through their corner crosses
/// exactly one of them.
const GRID_MM: f64 = 1e-9;

/// The side from which a solid is viewed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// From +y; `u` is x.
    Above,
    /// From -x; `u` is y.
    Left,
    /// From +x; `u` is y.
    Right,
}

impl Side {
    /// `u` and `w` of a point of the plan.
    pub(crate) const fn seen(self, x: f64, y: f64) -> [f64; 2] {
        match self {
            Self::Above => [x, y],
            Self::Left => [y, -x],
            Self::Right => [y, x],
        }
    }
}

/// A line or an arc in the plane of `u` and `w`.
#[derive(Clone, Copy, Debug)]
pub(super) enum Curve {
    /// First and last end.
    Line([f64; 2], [f64; 2]),
    /// Centre, radius, first angle and sweep.
    Arc([f64; 2], f64, f64, f64),
}

impl Curve {
    /// The point at a share of the length.
    pub(super) fn at(&self, share: f64) -> [f64; 2] {
        match *self {
            Self::Line(a, b) => [a[0] + (b[0] - a[0]) * share, a[1] + (b[1] - a[1]) * share],
            Self::Arc(c, r, start, sweep) => {
                let angle = start + sweep * share;
                [c[0] + r * libm::cos(angle), c[1] + r * libm::sin(angle)]
            }
        }
    }

    /// The unit tangent at a share of the length.
    pub(super) fn tangent(&self, share: f64) -> [f64; 2] {
        match *self {
            Self::Line(a, b) => {
                let d = [b[0] - a[0], b[1] - a[1]];
                let length = libm::hypot(d[0], d[1]).max(f64::MIN_POSITIVE);
                [d[0] / length, d[1] / length]
            }
            Self::Arc(_, _, start, sweep) => {
                let angle = start + sweep * share;
                [-libm::sin(angle) * sweep.signum(), libm::cos(angle) * sweep.signum()]
            }
        }
    }

    /// Shares of the length, ascending, at which the curve reverses along `axis` (0: u, 1: w), without its ends.
    pub(super) fn turns(&self, axis: usize) -> impl Iterator<Item = f64> + use<> {
        let arc = match *self {
            Self::Line(..) => None,
            Self::Arc(_, _, start, sweep) => Some((start, sweep)),
        };
        let quarter = if axis == 0 { 0.0 } else { PI / 2.0 };
        arc.into_iter().flat_map(move |(start, sweep)| {
            let share = move |k: i32| (quarter + f64::from(k) * sweep.signum() * PI - start) / sweep;
            (-4..=4).map(share).filter(|share| (1e-9..=1.0 - 1e-9).contains(share))
        })
    }

    /// The least and the greatest coordinate along an axis; those of the whole circle for an arc.
    fn reach(&self, axis: usize) -> [f64; 2] {
        match *self {
            Self::Line(a, b) => [a[axis].min(b[axis]), a[axis].max(b[axis])],
            Self::Arc(c, r, ..) => [c[axis] - r, c[axis] + r],
        }
    }

    /// The curve at a share of the way to `other`, which is of the same kind.
    fn between(&self, other: &Self, share: f64) -> Self {
        let mix = |a: f64, b: f64| a + (b - a) * share;
        let mixed = |a: [f64; 2], b: [f64; 2]| [mix(a[0], b[0]), mix(a[1], b[1])];
        match (*self, *other) {
            (Self::Arc(c, r, start, sweep), Self::Arc(d, s, other_start, other_sweep)) => {
                let near = start + (other_start - start + PI).rem_euclid(TAU) - PI;
                Self::Arc(mixed(c, d), mix(r, s), mix(start, near), mix(sweep, other_sweep))
            }
            _ => Self::Line(mixed(self.at(0.0), other.at(0.0)), mixed(self.at(1.0), other.at(1.0))),
        }
    }
}

/// A piece of a curve that is monotonic along an axis.
#[derive(Clone, Copy, Debug)]
struct Run {
    low: f64,
    high: f64,
    path: Path,
}

#[derive(Clone, Copy, Debug)]
enum Path {
    /// The other coordinate at the lower end, and its slope.
    Line(f64, f64),
    /// Centre, radius and side.
    Arc([f64; 2], f64, f64),
}

impl Run {
    /// The pieces of a curve.
    fn all(curve: Curve, axis: usize) -> impl Iterator<Item = Self> {
        let mut from = 0.0;
        curve.turns(axis).chain([1.0]).filter_map(move |to| {
            let shares = [from, to];
            from = to;
            Self::new(&curve, axis, shares)
        })
    }

    /// The piece between two shares of a curve; `None` if it lacks an extent along the axis.
    fn new(curve: &Curve, axis: usize, [from, to]: [f64; 2]) -> Option<Self> {
        let other = 1 - axis;
        let snapped = |share: f64| curve.at(share).map(|x| (x / GRID_MM).round() * GRID_MM);
        let (p, q) = (snapped(from), snapped(to));
        let (a, b) = if p[axis] <= q[axis] { (p, q) } else { (q, p) };
        if b[axis] - a[axis] <= 0.0 {
            return None;
        }
        let path = match curve {
            Curve::Line(..) => Path::Line(a[other], (b[other] - a[other]) / (b[axis] - a[axis])),
            Curve::Arc(c, r, start, sweep) => {
                let middle = start + sweep * f64::midpoint(from, to);
                let side = if axis == 0 { libm::sin(middle) } else { libm::cos(middle) };
                Path::Arc([c[axis], c[other]], *r, side.signum())
            }
        };
        Some(Self { low: a[axis], high: b[axis], path })
    }

    /// The other coordinate at `value`, which is not the lower end, so that a corner counts once.
    fn crossing(&self, value: f64) -> Option<f64> {
        (self.low < value && value <= self.high).then(|| match self.path {
            Path::Line(at, slope) => at + slope * (value - self.low),
            Path::Arc([c, other], r, side) => {
                other + side * (r * r - (value - c) * (value - c)).max(0.0).sqrt()
            }
        })
    }
}

/// Runs in strips of equal width along their axis, so that a line meets few of them.
#[derive(Clone, Debug)]
struct Strips {
    low: f64,
    width: f64,
    /// The runs that reach into each strip.
    runs: Vec<Vec<Run>>,
}

impl Strips {
    fn new(curves: &[Curve], axis: usize) -> Self {
        let runs: Vec<Run> = curves.iter().flat_map(|curve| Run::all(*curve, axis)).collect();
        let low = runs.iter().map(|run| run.low).fold(f64::INFINITY, f64::min);
        let high = runs.iter().map(|run| run.high).fold(f64::NEG_INFINITY, f64::max);
        let width = (high - low) / runs.len().max(1) as f64;
        let mut strips = Self { low, width, runs: vec![Vec::new(); runs.len()] };
        for run in runs {
            let (Some(first), Some(last)) = (strips.index(run.low), strips.index(run.high)) else { continue };
            strips.runs[first..=last].iter_mut().for_each(|strip| strip.push(run));
        }
        strips
    }

    /// The strip of a value; `None` without runs there.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    fn index(&self, value: f64) -> Option<usize> {
        let share = (value - self.low) / self.width;
        // The greatest value belongs to the last strip.
        (0.0..=self.runs.len() as f64).contains(&share).then(|| (share as usize).min(self.runs.len() - 1))
    }

    fn crossings(&self, value: f64) -> impl Iterator<Item = f64> {
        let near = self.index(value).map_or(&[][..], |index| &self.runs[index]);
        near.iter().filter_map(move |run| run.crossing(value))
    }
}

/// A wall between two closed curves.
#[derive(Clone, Debug)]
pub(super) struct Wall {
    /// The monotonic pieces along both axes of a vertical wall; `None` for a sloped one.
    strips: Option<[Strips; 2]>,
    pub(super) lower: Vec<Curve>,
    pub(super) upper: Vec<Curve>,
    pub(super) from_mm: f64,
    pub(super) to_mm: f64,
}

impl Wall {
    /// The curves at height `z`, within the wall, that a line at `value` may cross.
    fn curves_at(&self, z: f64, axis: usize, value: f64) -> impl Iterator<Item = Curve> {
        let share = (z - self.from_mm) / (self.to_mm - self.from_mm);
        let pairs = self.lower.iter().zip(&self.upper);
        let may_cross = move |a: &Curve, b: &Curve| {
            let (a, b) = (a.reach(axis), b.reach(axis));
            a[0].min(b[0]) - GRID_MM <= value && value <= a[1].max(b[1]) + GRID_MM
        };
        pairs.filter(move |(a, b)| may_cross(a, b)).map(move |(a, b)| a.between(b, share))
    }
}

/// A solid in a side view.
#[derive(Clone, Debug)]
pub struct Body {
    pub(super) walls: Vec<Wall>,
    /// Heights of the ends of walls, ascending.
    pub(super) levels_mm: Vec<f64>,
    /// Least and greatest `u`.
    reach_mm: [f64; 2],
    /// Greatest `w`.
    nearest_mm: f64,
}

impl Body {
    /// A solid in its pose, viewed from `side`, without engraved letters.
    #[must_use]
    pub fn new(solid: &Solid, pose: Pose, side: Side) -> Self {
        let rings: Vec<(&Contour, f64)> = solid.rings().collect();
        let letters = lettering(solid);
        let height = |z: f64| if pose.flipped { pose.z_mm - z } else { pose.z_mm + z };
        let mut walls: Vec<Wall> = solid
            .walls()
            .filter(|(lower, _)| !letters[*lower])
            .map(|(lower, upper)| {
                let curves = |i: usize| seen_contour(rings[i].0, pose.flipped, side);
                let (first, last) = if pose.flipped { (upper, lower) } else { (lower, upper) };
                let is_upright = rings[lower].0 == rings[upper].0;
                let foot = curves(first);
                Wall {
                    strips: is_upright.then(|| [Strips::new(&foot, 0), Strips::new(&foot, 1)]),
                    lower: foot,
                    upper: curves(last),
                    from_mm: height(rings[first].1),
                    to_mm: height(rings[last].1),
                }
            })
            .collect();
        walls.retain(|w| w.to_mm > w.from_mm);
        let mut levels_mm: Vec<f64> = walls.iter().flat_map(|w| [w.from_mm, w.to_mm]).collect();
        levels_mm.sort_by(f64::total_cmp);
        levels_mm.dedup_by(|a, b| (*a - *b).abs() < 1e-9);
        let curves = || walls.iter().flat_map(|wall| wall.lower.iter().chain(&wall.upper));
        let wider = |[a, b]: [f64; 2], [c, d]: [f64; 2]| [a.min(c), b.max(d)];
        let around =
            |axis| curves().map(|curve| curve.reach(axis)).fold([f64::INFINITY, f64::NEG_INFINITY], wider);
        let (reach_mm, [_, nearest_mm]) = (around(0), around(1));
        Self { walls, levels_mm, reach_mm, nearest_mm }
    }

    /// Returns whether material may be nearer to the observer than a point `[u, z, w]`.
    pub(super) fn may_hide(&self, [u, z, w]: [f64; 3]) -> bool {
        let (Some(bottom), Some(top)) = (self.levels_mm.first(), self.levels_mm.last()) else { return false };
        self.nearest_mm > w
            && (*bottom..=*top).contains(&z)
            && (self.reach_mm[0]..=self.reach_mm[1]).contains(&u)
    }

    /// Adds to `ends` where a line at height `z` enters and leaves the body, unordered. The line is at `u = value` and runs
    /// along `w` for `axis` 0, and the other way round for 1.
    pub(super) fn crossings(&self, axis: usize, value: f64, z: f64, ends: &mut Vec<f64>) {
        for wall in self.walls.iter().filter(|w| w.from_mm < z && z < w.to_mm) {
            match &wall.strips {
                Some(strips) => ends.extend(strips[axis].crossings(value)),
                None => {
                    let runs = wall.curves_at(z, axis, value).flat_map(|curve| Run::all(curve, axis));
                    ends.extend(runs.filter_map(|run| run.crossing(value)));
                }
            }
        }
    }
}

/// The edges of a contour in the coordinates of a view.
fn seen_contour(contour: &Contour, flipped: bool, side: Side) -> Vec<Curve> {
    let turn = |x: f64, y: f64| side.seen(if flipped { -x } else { x }, y);
    contour
        .edges()
        .iter()
        .enumerate()
        .map(|(i, edge)| {
            let (from, to) = contour.ends(i);
            match edge {
                Edge::Line => Curve::Line(turn(from.x, from.y), turn(to.x, to.y)),
                Edge::Arc(arc) => {
                    let centre = turn(arc.centre.x, arc.centre.y);
                    let start = turn(from.x, from.y);
                    let angle = libm::atan2(start[1] - centre[1], start[0] - centre[0]);
                    // Arcs keep their sense unless the view mirrors the plan.
                    let mirrors = flipped != (side == Side::Right);
                    let sweep = if mirrors { -arc.sweep_rad } else { arc.sweep_rad };
                    Curve::Arc(centre, arc.radius_mm, angle, sweep)
                }
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use pinswitch_solid::profile::Point2;

    /// A line crosses the same pieces in strips, and after those out of its reach are left out, as among all.
    #[test]
    fn lines_cross_the_same_pieces_in_strips() {
        let teeth = (0..40).map(|i| {
            let (angle, radius) = (f64::from(i) / 40.0 * TAU, if i % 2 == 0 { 20.0 } else { 17.5 });
            Point2::new(radius * libm::cos(angle), radius * libm::sin(angle))
        });
        let outline = Contour::polygon(teeth.collect());
        let disc = Contour::circle(Point2::new(3.0, 1.0), 2.0).reversed();
        let upright = Solid::prism(&outline, &[disc], 0.0, 4.0, 0.0).unwrap();
        let sloped = Solid::prism(&Contour::circle(Point2::origin(), 9.0), &[], 0.0, 4.0, 0.1).unwrap();
        for (solid, is_sloped) in [(upright, false), (sloped, true)] {
            let body = Body::new(&solid, Pose::upright(0.0), Side::Above);
            assert_eq!(body.walls.iter().any(|wall| wall.strips.is_none()), is_sloped);
            for (axis, step) in (0..2).flat_map(|axis| (-2300..2300).map(move |step| (axis, step))) {
                let (value, z) = (f64::from(step) * 0.01, 1.7);
                let mut found = Vec::new();
                body.crossings(axis, value, z, &mut found);
                let walls = body.walls.iter().filter(|wall| wall.from_mm < z && z < wall.to_mm);
                let all = walls.flat_map(|wall| {
                    let share = (z - wall.from_mm) / (wall.to_mm - wall.from_mm);
                    let curves = wall.lower.iter().zip(&wall.upper).map(move |(a, b)| a.between(b, share));
                    curves.flat_map(|curve| Run::all(curve, axis)).filter_map(|run| run.crossing(value))
                });
                let mut all: Vec<f64> = all.collect();
                found.sort_by(f64::total_cmp);
                all.sort_by(f64::total_cmp);
                assert_eq!(found.len(), all.len(), "{axis}, {value}: {found:?} and {all:?}");
                assert!(found.iter().zip(&all).all(|(a, b)| (a - b).abs() < 1e-9));
            }
        }
    }

    #[test]
    fn crossings_are_the_ends_of_material() {
        let disc = Contour::circle(Point2::new(3.0, 1.0), 2.0);
        let hole = Contour::circle(Point2::new(3.0, 1.0), 1.0).reversed();
        let washer = Solid::prism(&disc, &[hole], 0.0, 5.0, 0.0).unwrap();
        let across = |side: Side, flipped: bool, u: f64| {
            let body = Body::new(&washer, Pose { flipped, z_mm: if flipped { 5.0 } else { 0.0 } }, side);
            let mut ends = Vec::new();
            body.crossings(0, u, 2.5, &mut ends);
            ends.sort_by(f64::total_cmp);
            ends.into_iter().map(|w| (w * 1e6).round() / 1e6).collect::<Vec<_>>()
        };
        assert_eq!(across(Side::Above, false, 3.0), [-1.0, 0.0, 2.0, 3.0]);
        assert_eq!(across(Side::Left, false, 1.0), [-5.0, -4.0, -2.0, -1.0]);
        assert_eq!(across(Side::Right, false, 1.0), [1.0, 2.0, 4.0, 5.0]);
        assert_eq!(across(Side::Right, true, 1.0), [-5.0, -4.0, -2.0, -1.0]);
        assert_eq!(across(Side::Above, true, -3.0), [-1.0, 0.0, 2.0, 3.0]);
        assert!(across(Side::Above, false, 6.0).is_empty());
    }
}
