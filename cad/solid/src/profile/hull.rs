//! The convex hull of discs: a band stretched around them.
//!
//! The support function of a disc at `c` with radius `r` is `h(φ) = c·u(φ) + r` for the direction
//! `u(φ)`. That of the hull is the largest of all discs, and arcs of the hull end where two discs
//! have equal support.

use std::f64::consts::TAU;

use super::contour::Contour;
use super::pen::Pen;
use super::point::{Point2, Vector2};

/// Directions that differ by at most this, in radians, are equal.
const SAME_RAD: f64 = 1e-9;

/// A disc.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disc {
    /// Centre.
    pub centre: Point2,
    /// Radius, mm.
    pub radius_mm: f64,
}

impl Disc {
    fn support_mm(&self, angle_rad: f64) -> f64 {
        self.centre.coords.dot(&direction(angle_rad)) + self.radius_mm
    }
}

/// The directions in which one disc is the outermost.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HullArc {
    /// Index of the disc.
    pub disc: usize,
    /// First direction, radians, counter-clockwise from +x.
    pub from_rad: f64,
    /// Last direction.
    pub to_rad: f64,
}

fn direction(angle_rad: f64) -> Vector2 {
    Vector2::new(libm::cos(angle_rad), libm::sin(angle_rad))
}

/// Returns the outermost discs from the direction `from_rad` counter-clockwise to `to_rad`, in
/// order. Between two of them the band is straight.
pub fn hull_arcs(discs: &[Disc], from_rad: f64, to_rad: f64) -> Vec<HullArc> {
    // Just after the start, so that of two discs with equal support the next one is taken.
    let start = from_rad + 2.0 * SAME_RAD;
    let outermost =
        (0..discs.len()).max_by(|a, b| discs[*a].support_mm(start).total_cmp(&discs[*b].support_mm(start)));
    let Some(mut disc) = outermost else { return Vec::new() };
    let mut arcs = Vec::new();
    let mut here = from_rad;
    while here < to_rad {
        let next = next_disc(discs, disc, here);
        let end = next.map_or(to_rad, |n| n.0.min(to_rad));
        arcs.push(HullArc { disc, from_rad: here, to_rad: end });
        let Some((_, other)) = next.filter(|n| n.0 < to_rad) else { break };
        (disc, here) = (other, end);
    }
    arcs
}

/// The disc that follows `disc` after the direction `here_rad`, and the direction from which it is
/// outermost. Of discs on one tangent the last is taken.
fn next_disc(discs: &[Disc], disc: usize, here_rad: f64) -> Option<(f64, usize)> {
    let others = || {
        (0..discs.len())
            .filter(|other| *other != disc)
            .filter_map(|other| Some((overtaken_rad(&discs[disc], &discs[other], here_rad)?, other)))
    };
    let first = others().min_by(|a, b| a.0.total_cmp(&b.0))?;
    let beyond = |other: usize| discs[other].support_mm(first.0 + 4.0 * SAME_RAD);
    let tied = others().filter(|other| other.0 <= first.0 + 2.0 * SAME_RAD);
    let outermost = tied.max_by(|a, b| beyond(a.1).total_cmp(&beyond(b.1)));
    Some((first.0, outermost.map_or(first.1, |other| other.1)))
}

/// The first direction after `after_rad` from which the support of `other` exceeds that of `disc`;
/// `None` if it never does.
fn overtaken_rad(disc: &Disc, other: &Disc, after_rad: f64) -> Option<f64> {
    let between = other.centre - disc.centre;
    let share = (disc.radius_mm - other.radius_mm) / between.norm();
    if !(-1.0..1.0).contains(&share) {
        return None;
    }
    // From here on, `between · u` exceeds the difference of the radii, for less than half a turn.
    let begins = libm::atan2(between.y, between.x) - libm::acos(share);
    let turned = (begins - after_rad - SAME_RAD).rem_euclid(TAU);
    Some(after_rad + SAME_RAD + turned)
}

/// Returns the convex hull of `discs`, counter-clockwise; `None` without discs.
pub fn hull(discs: &[Disc]) -> Option<Contour> {
    // The rightmost disc is outermost at the direction +x: the hull starts where the next arc
    // begins.
    let whole = hull_arcs(discs, 0.0, TAU);
    let second = whole.get(1).copied();
    let Some(second) = second else {
        let only = discs.get(whole.first()?.disc)?;
        return Some(Contour::circle(only.centre, only.radius_mm));
    };
    let arcs = hull_arcs(discs, second.from_rad, second.from_rad + TAU);
    let at = |disc: usize, angle: f64| discs[disc].centre + direction(angle) * discs[disc].radius_mm;
    let first = arcs.first()?;
    let mut pen = Pen::at(at(first.disc, first.from_rad));
    for (i, arc) in arcs.iter().enumerate() {
        let next = arcs[(i + 1) % arcs.len()];
        if arc.to_rad - arc.from_rad > SAME_RAD && discs[arc.disc].radius_mm > 0.0 {
            pen = pen.arc_to(discs[arc.disc].centre, at(arc.disc, arc.to_rad), true);
        }
        if i + 1 < arcs.len() {
            pen = pen.line_to(at(next.disc, next.from_rad));
        }
    }
    Some(pen.close())
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::f64::consts::FRAC_PI_2;

    fn disc(x: f64, y: f64, radius_mm: f64) -> Disc {
        Disc { centre: Point2::new(x, y), radius_mm }
    }

    #[test]
    fn a_band_around_two_discs_is_a_stadium() {
        let band = hull(&[disc(0.0, 0.0, 1.0), disc(5.0, 0.0, 1.0)]).unwrap();
        assert!((band.area_mm2() - (10.0 + std::f64::consts::PI)).abs() < 1e-9);
        assert!(hull(&[]).is_none());
        let swallowed = hull(&[disc(0.0, 0.0, 3.0), disc(1.0, 0.0, 1.0)]).unwrap();
        assert!((swallowed.area_mm2() - 9.0 * std::f64::consts::PI).abs() < 1e-9);
    }

    /// Three discs on one tangent, in each order: the middle one has no arc.
    #[test]
    fn discs_on_one_tangent_are_skipped() {
        for tilt in [0.0, 0.3, 1.1, -0.7, 2.9] {
            let at = |x: f64, radius_mm: f64| {
                let (along, up) = (direction(tilt), direction(tilt + FRAC_PI_2));
                Disc { centre: Point2::from(along * x + up * (23.0 - radius_mm)), radius_mm }
            };
            let ends = [at(20.0, 0.0), at(-20.0, 0.0)];
            for middle in [vec![at(0.0, 23.0)], vec![at(3.0, 1.3), at(-2.0, 1.3), at(0.0, 23.0)]] {
                let discs = [&ends[..], &middle].concat();
                let arcs = hull_arcs(&discs, tilt + 0.9, tilt + FRAC_PI_2 + 0.7);
                let kept: Vec<_> =
                    arcs.iter().filter(|a| a.to_rad - a.from_rad > 1e-6).map(|a| a.disc).collect();
                assert_eq!(kept, [0, 1], "{tilt}: {arcs:?}");
            }
        }
    }

    proptest! {
        /// A hull contains every disc, and its support is the largest of theirs.
        #[test]
        fn a_hull_contains_its_discs(all in prop::collection::vec((-20.0..20.0f64, -20.0..20.0f64, 0.1..6.0f64), 2..9)) {
            let discs: Vec<Disc> = all.iter().map(|(x, y, r)| disc(*x, *y, *r)).collect();
            let band = hull(&discs).unwrap();
            for d in &discs {
                prop_assert!(band.distance_mm(d.centre) >= d.radius_mm - 1e-6);
            }
            let longest = discs.iter().map(|d| d.support_mm(0.7)).fold(f64::NEG_INFINITY, f64::max);
            let corners = band.flattened(&vec![64; band.edges().len()]);
            let reached = corners.iter().map(|p| p.coords.dot(&direction(0.7))).fold(f64::NEG_INFINITY, f64::max);
            // Flattened arcs keep their area, so that their corners are slightly outside.
            prop_assert!((reached - longest).abs() < 0.05, "{reached}, {longest}");
            prop_assert!(band.area_mm2() > 0.0);
        }
    }
}
