//! The walls of a solid, joined to chains where they stand on each other: what a hole, a peg or an outline is from below to
//! above.

use super::bore::{Stage, hexagon};
use super::features::{circle, lettering, same};
use pinswitch_solid::profile::{Contour, Point2, Vector2};
use pinswitch_solid::solid::Solid;

/// A run of walls over each other, each with its rings.
pub(super) struct Chain<'a> {
    pub(super) rings: Vec<(&'a Contour, f64)>,
    /// Where it begins, its chamfer included.
    pub(super) foot_mm: f64,
    /// Whether it ends in the open below, and above, and not on a floor or a ceiling.
    pub(super) opens: (bool, bool),
    pub(super) is_lettering: bool,
}

impl Chain<'_> {
    pub(super) fn is_hole(&self) -> bool {
        self.rings[0].0.area_mm2() < 0.0
    }

    /// Middle and stage of a bore, round or hexagonal; `None` of anything else.
    pub(super) fn stage(&self) -> Option<(Point2, Stage)> {
        let round = |c: &Contour| circle(c).map(|(centre, radius)| (centre, radius, false));
        let across = |c: &Contour| round(c).or_else(|| hexagon(c).map(|(centre, half)| (centre, half, true)));
        let (centre, _, is_hexagon) = across(self.rings[0].0).filter(|_| self.is_hole())?;
        let width = |c: &Contour| across(c).map_or(0.0, |(_, half, _)| half);
        let mut levels: Vec<(f64, f64)> = self.rings.iter().map(|(c, z)| (*z, width(c))).collect();
        levels[0].0 = self.foot_mm;
        let (opens_down, opens_up) = self.opens;
        Some((centre, Stage { levels, is_hexagon, opens_down, opens_up }))
    }

    pub(super) fn is_blind(&self) -> bool {
        self.opens != (true, true)
    }

    /// By how far this is `other`, moved; `None` if it is anything else.
    pub(super) fn moved_from(&self, other: &Self) -> Option<Vector2> {
        let first = |chain: &Self| chain.rings[0].0.corners().first().copied();
        let by = first(self)? - first(other)?;
        let is_moved = |(a, b): (&(&Contour, f64), &(&Contour, f64))| {
            let corners = (a.0.corners(), b.0.corners());
            same(a.1, b.1)
                && corners.0.len() == corners.1.len()
                && corners.0.iter().zip(corners.1).all(|(p, q)| (p - q - by).norm() < 1e-6)
        };
        let is_copy =
            self.rings.len() == other.rings.len() && self.rings.iter().zip(&other.rings).all(is_moved);
        (is_copy && !same(by.norm(), 0.0)).then_some(by)
    }
}

/// The walls of a solid, joined where they share a ring, without the chamfers at their feet.
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
