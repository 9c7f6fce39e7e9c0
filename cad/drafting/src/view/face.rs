//! Cut faces: their outline and their hatching.

use super::body::Body;
use super::strokes::{Stroke, joined};

/// Distance of a section from the level above or below it, mm.
const INSIDE_MM: f64 = 1e-6;

/// Part of a cut face between two heights: its left and right end at the lower and at the upper one.
#[derive(Clone, Copy, Debug)]
struct Quad {
    low: [f64; 2],
    high: [f64; 2],
    z: [f64; 2],
}

/// The cut face of one body.
#[derive(Clone, Debug, Default)]
pub struct Face {
    quads: Vec<Quad>,
}

impl Face {
    /// The face of `body` in the plane `w = cut_mm`.
    #[must_use]
    pub fn new(body: &Body, cut_mm: f64) -> Self {
        let across = |z: f64| {
            let mut ends = Vec::new();
            body.crossings(1, cut_mm, z, &mut ends);
            ends.sort_by(f64::total_cmp);
            ends
        };
        let mut quads = Vec::new();
        for pair in body.levels_mm.windows(2) {
            let (from, to) = (pair[0], pair[1]);
            let (mut low, mut high) = (across(from + INSIDE_MM), across(to - INSIDE_MM));
            if low.len() != high.len() {
                let middle = across(f64::midpoint(from, to));
                (low, high) = (middle.clone(), middle);
            }
            for (a, b) in low.chunks_exact(2).zip(high.chunks_exact(2)) {
                quads.push(Quad { low: [a[0], a[1]], high: [b[0], b[1]], z: [from, to] });
            }
        }
        Self { quads }
    }

    /// Whether the plane misses the body.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.quads.is_empty()
    }

    /// A point `[u, z]` inside the widest part of the face; `None` for an empty one.
    #[must_use]
    pub fn inside(&self) -> Option<[f64; 2]> {
        let size = |q: &&Quad| (q.low[1] - q.low[0]).min(q.z[1] - q.z[0]);
        let widest = self.quads.iter().max_by(|a, b| size(a).total_cmp(&size(b)))?;
        Some([f64::midpoint(widest.low[0], widest.low[1]), f64::midpoint(widest.z[0], widest.z[1])])
    }

    /// The outline.
    #[must_use]
    pub fn outline(&self) -> Vec<Stroke> {
        let mut strokes = Vec::new();
        for quad in &self.quads {
            for side in 0..2 {
                strokes.push([[quad.low[side], quad.z[0]], [quad.high[side], quad.z[1]]]);
            }
        }
        // A level is an edge where material is on one side of it only.
        let mut levels: Vec<f64> = self.quads.iter().flat_map(|q| q.z).collect();
        levels.sort_by(f64::total_cmp);
        levels.dedup_by(|a, b| (*a - *b).abs() < 1e-9);
        for z in levels {
            let near = |a: f64| (a - z).abs() < 1e-9;
            let below: Vec<[f64; 2]> = self.quads.iter().filter(|q| near(q.z[1])).map(|q| q.high).collect();
            let above: Vec<[f64; 2]> = self.quads.iter().filter(|q| near(q.z[0])).map(|q| q.low).collect();
            let mut ends: Vec<f64> = below.iter().chain(&above).flatten().copied().collect();
            ends.sort_by(f64::total_cmp);
            for pair in ends.windows(2).filter(|p| p[1] - p[0] > 1e-6) {
                let middle = f64::midpoint(pair[0], pair[1]);
                let covers = |all: &[[f64; 2]]| all.iter().any(|s| s[0] < middle && middle < s[1]);
                if covers(&below) != covers(&above) {
                    strokes.push([[pair[0], z], [pair[1], z]]);
                }
            }
        }
        joined(&strokes, &[])
    }

    /// Hatching lines at 45 degrees, `apart_mm` from each other, rising or falling along `u`.
    #[must_use]
    pub fn hatch(&self, apart_mm: f64, rises: bool) -> Vec<Stroke> {
        let slope = if rises { 1.0 } else { -1.0 };
        // A line has constant z - slope u, a multiple of the step.
        let step = apart_mm * std::f64::consts::SQRT_2;
        let mut strokes = Vec::new();
        for quad in &self.quads {
            let corners = [
                [quad.low[0], quad.z[0]],
                [quad.low[1], quad.z[0]],
                [quad.high[1], quad.z[1]],
                [quad.high[0], quad.z[1]],
            ];
            let level = |p: [f64; 2]| p[1] - slope * p[0];
            let (least, most) = corners
                .iter()
                .map(|p| level(*p))
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), l| (a.min(l), b.max(l)));
            let mut number = (least / step).ceil();
            while number * step < most {
                let wanted = number * step + 1e-9;
                let mut ends = Vec::new();
                for i in 0..4 {
                    let (a, b) = (corners[i], corners[(i + 1) % 4]);
                    if (level(a) <= wanted) != (level(b) <= wanted) {
                        let share = (wanted - level(a)) / (level(b) - level(a));
                        ends.push([a[0] + (b[0] - a[0]) * share, a[1] + (b[1] - a[1]) * share]);
                    }
                }
                if let [a, b] = ends[..] {
                    strokes.push([a, b]);
                }
                number += 1.0;
            }
        }
        joined(&strokes, &[])
    }
}

#[cfg(test)]
mod tests {
    use super::super::body::Side;
    use super::*;
    use pinswitch_solid::pose::Pose;
    use pinswitch_solid::profile::{Contour, Point2};
    use pinswitch_solid::solid::Solid;

    #[test]
    fn a_cut_washer_has_two_faces() {
        let disc = Contour::circle(Point2::origin(), 5.0);
        let hole = Contour::circle(Point2::origin(), 2.0).reversed();
        let washer = Solid::prism(&disc, &[hole], 0.0, 4.0, 0.0).unwrap();
        let face = Face::new(&Body::new(&washer, Pose::upright(0.0), Side::Left), 0.0);
        let length = |s: &[Stroke]| s.iter().map(|[a, b]| libm::hypot(a[0] - b[0], a[1] - b[1])).sum::<f64>();
        assert!((length(&face.outline()) - 2.0 * 14.0).abs() < 1e-4, "{:?}", face.outline());
        // The length of a hatching is the area over the distance of its lines.
        let hatched = length(&face.hatch(0.01, true));
        assert!((hatched * 0.01 / 24.0 - 1.0).abs() < 0.01, "{hatched}");
    }
}
