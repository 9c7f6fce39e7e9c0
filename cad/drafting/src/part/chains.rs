//! Chains of walls that share rings: a hole, a peg or an outline from below to above.

use super::bore::{Flats, Stage};
use crate::contour::{circle, hexagon, lettering, same};
use pinswitch_solid::profile::{Contour, Point2, Vector2};
use pinswitch_solid::solid::Solid;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_3};

/// A chain of walls, with the rings between them.
pub(super) struct Chain<'a> {
    /// Contours with their heights in mm, from below.
    pub(super) rings: Vec<(&'a Contour, f64)>,
    /// Height of its lower end, with its chamfer, mm.
    pub(super) foot_mm: f64,
    /// Whether it ends in the open below and above, and not on a floor or a ceiling.
    opens: (bool, bool),
    pub(super) is_lettering: bool,
}

impl Chain<'_> {
    pub(super) fn is_hole(&self) -> bool {
        self.rings[0].0.area_mm2() < 0.0
    }

    /// Height and radius in mm at each ring, if all rings are of one kind.
    fn levels(&self, kind: fn(&Contour) -> Option<(Point2, f64)>) -> Option<Vec<(f64, f64)>> {
        self.rings.iter().map(|(contour, z)| Some((*z, kind(contour)?.1))).collect()
    }

    /// Centre and levels of a round boss.
    pub(super) fn boss(&self) -> Option<(Point2, Vec<(f64, f64)>)> {
        let (centre, _) = circle(self.rings[0].0).filter(|_| !self.is_hole())?;
        Some((centre, self.levels(circle)?))
    }

    /// Centre and stage of a round or hexagonal hole.
    pub(super) fn stage(&self) -> Option<(Point2, Stage)> {
        let first = self.rings[0].0;
        let (centre, _) = circle(first).or_else(|| hexagon(first)).filter(|_| self.is_hole())?;
        let mut levels = self.levels(circle).or_else(|| self.levels(hexagon))?;
        let flats = circle(first).is_none().then(|| flats(first, centre));
        levels[0].0 = self.foot_mm;
        let (opens_down, opens_up) = self.opens;
        Some((centre, Stage { levels, flats, opens_down, opens_up }))
    }

    pub(super) fn is_blind(&self) -> bool {
        self.opens != (true, true)
    }

    /// The displacement from `other`, if both are equal.
    pub(super) fn displacement(&self, other: &Self) -> Option<Vector2> {
        let first = |chain: &Self| chain.rings[0].0.corners().first().copied();
        let by = first(self)? - first(other)?;
        let is_moved = |(a, b): (&(&Contour, f64), &(&Contour, f64))| {
            let corners = (a.0.corners(), b.0.corners());
            same(a.1, b.1)
                && corners.0.len() == corners.1.len()
                && corners.0.iter().zip(corners.1).all(|(p, q)| same((p - q - by).norm(), 0.0))
        };
        let is_copy =
            self.rings.len() == other.rings.len() && self.rings.iter().zip(&other.rings).all(is_moved);
        (is_copy && !same(by.norm(), 0.0)).then_some(by)
    }
}

/// The direction of the flats of a regular hexagon.
fn flats(hexagon: &Contour, centre: Point2) -> Flats {
    let edge = |i: usize| {
        let (from, to) = hexagon.ends(i);
        (to - from).normalize()
    };
    let radius = centre.coords.norm();
    let is_square = |i: usize| same(edge(i).dot(&centre.coords) / radius, 0.0);
    if radius > 1e-6 && (0..3).any(is_square) {
        return Flats::SquareToRadius;
    }
    if (0..3).any(|i| same(edge(i).y, 0.0)) {
        return Flats::AlongX;
    }
    // Flats repeat every 60 degrees: the angle nearest to x.
    let angle = libm::atan2(edge(0).y, edge(0).x).rem_euclid(FRAC_PI_3);
    Flats::AtAngle(if angle > FRAC_PI_2 / 3.0 { angle - FRAC_PI_3 } else { angle }.to_degrees())
}

/// Returns the chains of a solid, without the bottom chamfers of `chamfer_mm`.
pub(super) fn chains(solid: &Solid, chamfer_mm: f64) -> Vec<Chain<'_>> {
    let rings: Vec<(&Contour, f64)> = solid.rings().collect();
    let walls: Vec<(usize, usize)> = solid.walls().collect();
    let letters = lettering(solid);
    let floors: Vec<usize> = solid.caps().filter_map(|(_, members)| members.first().copied()).collect();
    let starts = walls.iter().filter(|(low, _)| !walls.iter().any(|(_, high)| high == low));
    starts
        .map(|(low, high)| {
            let mut numbers = vec![*low, *high];
            while let Some((_, next)) = walls.iter().find(|(low, _)| low == &numbers[numbers.len() - 1]) {
                // A closed chain is not a solid, but must not be an endless loop.
                if numbers.contains(next) {
                    break;
                }
                numbers.push(*next);
            }
            let foot_mm = rings[*low].1;
            let is_open = |i: usize| !floors.contains(&i);
            let opens = (is_open(*low), is_open(numbers[numbers.len() - 1]));
            let mut chain: Vec<_> = numbers.iter().map(|i| rings[*i]).collect();
            let is_chamfer = chamfer_mm > 0.0 && chain.len() > 2 && same(chain[1].1 - chain[0].1, chamfer_mm);
            if is_chamfer {
                chain.remove(0);
            }
            Chain { rings: chain, foot_mm, opens, is_lettering: letters[*low] }
        })
        .collect()
}
