//! Front views: a solid viewed along its axis, as lines and arcs, whole or within the circle of a detail.

use std::f64::consts::TAU;

use crate::contour::{circle, lettering, same};
use crate::{Draft, Layer, Point, Shape};
use pinswitch_solid::profile::{Arc, Contour, Edge, Point2, Vector2};
use pinswitch_solid::solid::{Facing, Solid};

/// A line of a front view, in millimetres of the solid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Trace {
    /// A straight line between two points.
    Line(Point2, Point2),
    /// An arc.
    Arc(Arc),
    /// A circle: centre and radius.
    Circle(Point2, f64),
}

/// The position of a front view on paper.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Origin of the view on paper.
    pub origin: Point,
    /// Millimetres on paper for a millimetre of the solid.
    pub scale: f64,
    /// The point of the solid at the origin of the view.
    pub about: Point2,
    /// Counter-clockwise rotation of the solid.
    pub turn_rad: f64,
}

impl Place {
    /// A view without rotation, with the origin of the solid at `origin`.
    #[must_use]
    pub fn straight(origin: Point, scale: f64) -> Self {
        Self { origin, scale, about: Point2::origin(), turn_rad: 0.0 }
    }

    /// A point of the solid on paper.
    #[must_use]
    pub fn at(&self, p: Point2) -> Point {
        let (d, (sin, cos)) = (p - self.about, libm::sincos(self.turn_rad));
        self.origin + Point::new(d.x * cos - d.y * sin, d.x * sin + d.y * cos) * self.scale
    }

    /// A trace on paper.
    #[must_use]
    pub fn shape(&self, trace: &Trace) -> Shape {
        match trace {
            Trace::Line(a, b) => Shape::Line { from: self.at(*a), to: self.at(*b) },
            Trace::Circle(centre, radius) => {
                Shape::Circle { centre: self.at(*centre), radius_mm: radius * self.scale }
            }
            Trace::Arc(arc) => Shape::Arc {
                centre: self.at(arc.centre),
                radius_mm: arc.radius_mm * self.scale,
                start_rad: arc.start_rad + self.turn_rad,
                sweep_rad: arc.sweep_rad,
            },
        }
    }
}

/// Returns the lines of a solid viewed from +z, or from -z (and mirrored) if `from_below`. The feet of bottom chamfers of
/// `chamfer_mm` are left out where they are hidden.
#[must_use]
pub fn plan(solid: &Solid, from_below: bool, chamfer_mm: f64) -> Vec<(Layer, Trace)> {
    let eye = if from_below { Facing::Down } else { Facing::Up };
    let rings: Vec<(&Contour, f64)> = solid.rings().collect();
    let facing: Vec<usize> =
        solid.caps().filter(|(facing, _)| *facing == eye).flat_map(|(_, members)| members).collect();
    // A hidden line next to a visible one adds nothing.
    let feet: Vec<usize> = solid
        .walls()
        .filter(|(low, high)| {
            chamfer_mm > 0.0
                && rings[*low].0 != rings[*high].0
                && same(rings[*high].1 - rings[*low].1, chamfer_mm)
        })
        .map(|(low, _)| low)
        .collect();
    let letters = lettering(solid);
    let mut lines = Vec::new();
    let mut known: Vec<&Contour> = Vec::new();
    for is_visible in [true, false] {
        for (i, (contour, _)) in rings.iter().enumerate() {
            let is_lettering = letters[i];
            let is_skipped = is_visible != facing.contains(&i)
                || known.contains(contour)
                || (!is_visible && (feet.contains(&i) || is_lettering));
            if is_skipped {
                continue;
            }
            known.push(contour);
            let layer = match (is_visible, is_lettering) {
                (true, true) => Layer::Thin,
                (true, false) => Layer::Visible,
                (false, _) => Layer::Hidden,
            };
            let seen = if from_below { contour.mirrored() } else { (*contour).clone() };
            lines.extend(traces(&seen).into_iter().map(|t| (layer, t)));
        }
    }
    lines
}

/// The edges of a contour.
pub(crate) fn traces(contour: &Contour) -> Vec<Trace> {
    if let Some((centre, radius)) = circle(contour) {
        return vec![Trace::Circle(centre, radius)];
    }
    (0..contour.edges().len())
        .map(|i| {
            let (from, to) = contour.ends(i);
            match contour.edges()[i] {
                Edge::Line => Trace::Line(from, to),
                Edge::Arc(arc) => Trace::Arc(arc),
            }
        })
        .collect()
}

/// Draws the lines of a front view.
pub fn draw_plan(draft: &mut Draft, lines: &[(Layer, Trace)], place: &Place, view: usize) {
    let group = draft.group();
    for (layer, trace) in lines {
        draft.put(*layer, place.shape(trace), Some(view), group);
    }
}

/// The pieces of a trace within `radius_mm` of `centre`.
pub(crate) fn within(trace: &Trace, centre: Point2, radius_mm: f64) -> Vec<Trace> {
    match trace {
        Trace::Line(a, b) => {
            let (from, along) = (a - centre, b - a);
            let (p, q) = (from.dot(&along), along.norm_squared());
            let root = p * p - q * (from.norm_squared() - radius_mm * radius_mm);
            if root <= 0.0 {
                return Vec::new();
            }
            let (low, high) = (((-p - root.sqrt()) / q).max(0.0), ((-p + root.sqrt()) / q).min(1.0));
            if high - low < 1e-9 { Vec::new() } else { vec![Trace::Line(a + along * low, a + along * high)] }
        }
        Trace::Circle(middle, r) => {
            let whole = Arc { centre: *middle, radius_mm: *r, start_rad: 0.0, sweep_rad: TAU };
            let pieces = arc_within(&whole, centre, radius_mm);
            match pieces[..] {
                [arc] if (arc.sweep_rad - TAU).abs() < 1e-9 => vec![*trace],
                _ => pieces.into_iter().map(Trace::Arc).collect(),
            }
        }
        Trace::Arc(arc) => arc_within(arc, centre, radius_mm).into_iter().map(Trace::Arc).collect(),
    }
}

/// The pieces of an arc within `radius_mm` of `centre`.
fn arc_within(arc: &Arc, centre: Point2, radius_mm: f64) -> Vec<Arc> {
    let to: Vector2 = centre - arc.centre;
    let distance = to.norm();
    let mut shares = vec![0.0, 1.0];
    if distance > 1e-12 {
        let cosine = (distance * distance + arc.radius_mm.powi(2) - radius_mm * radius_mm)
            / (2.0 * distance * arc.radius_mm);
        if cosine.abs() < 1.0 {
            for side in [1.0, -1.0] {
                let angle = libm::atan2(to.y, to.x) + side * libm::acos(cosine);
                let forward = ((angle - arc.start_rad) * arc.sweep_rad.signum()).rem_euclid(TAU);
                shares.push(forward / arc.sweep_rad.abs());
            }
        }
    }
    shares.retain(|s| (0.0..=1.0).contains(s));
    shares.sort_by(f64::total_cmp);
    shares
        .windows(2)
        .filter(|s| s[1] - s[0] > 1e-9)
        .filter(|s| (arc.point_at(f64::midpoint(s[0], s[1]), arc.radius_mm) - centre).norm() < radius_mm)
        .map(|s| Arc {
            start_rad: arc.start_rad + arc.sweep_rad * s[0],
            sweep_rad: arc.sweep_rad * (s[1] - s[0]),
            ..*arc
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn traces_are_clipped_by_a_circle() {
        let line = Trace::Line(Point2::new(-5.0, 3.0), Point2::new(9.0, 3.0));
        assert_eq!(
            within(&line, Point2::origin(), 5.0),
            [Trace::Line(Point2::new(-4.0, 3.0), Point2::new(4.0, 3.0))]
        );
        assert!(within(&line, Point2::origin(), 2.0).is_empty());
        let circle = Trace::Circle(Point2::new(1.0, 0.0), 1.0);
        assert_eq!(within(&circle, Point2::origin(), 3.0), [circle]);
        // 120 degrees of a circle through the centre of an equal one are inside it.
        let length: f64 = within(&circle, Point2::origin(), 1.0)
            .iter()
            .map(|t| if let Trace::Arc(a) = t { a.length_mm() } else { 0.0 })
            .sum();
        assert!((length - TAU / 3.0).abs() < 1e-9, "{length}");
    }
}
