//! Straight lines of a side view: joining, clipping, thinning and drawing.

use crate::{Draft, Layer, Point, Shape};

/// A straight line of a view: both ends as `[u, z]`, mm.
pub type Stroke = [[f64; 2]; 2];

/// Distances that differ by less are equal, mm: strokes that are alike on both sides are thinned alike.
const SAME_MM: f64 = 1e-3;
/// Strokes on one line are joined across a gap of this, and shorter ones are dropped, mm.
const JOIN_MM: f64 = 1e-4;
/// A stroke is crowded if a neighbour runs along more than this share of it.
const CROWDED_SHARE: f64 = 0.8;

/// An infinite line with the strokes on it.
struct Carrier {
    /// Unit vector.
    direction: [f64; 2],
    /// Signed distance from the origin, mm.
    offset: f64,
    /// First and last distance of each stroke along the line, mm.
    spans: Vec<[f64; 2]>,
}

/// Joins strokes that overlap or meet end to end, and clips them where `over` covers them.
#[must_use]
pub fn joined(strokes: &[Stroke], over: &[Stroke]) -> Vec<Stroke> {
    let mut all: Vec<Carrier> = Vec::new();
    for stroke in strokes {
        let (carrier, span) = place(stroke, &mut all);
        if let Some(span) = span {
            all[carrier].spans.push(span);
        }
    }
    let mut result = Vec::new();
    for carrier in &mut all {
        carrier.spans.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let mut kept: Vec<[f64; 2]> = Vec::new();
        for span in &carrier.spans {
            match kept.last_mut() {
                Some(last) if span[0] <= last[1] + JOIN_MM => last[1] = last[1].max(span[1]),
                _ => kept.push(*span),
            }
        }
        let covers = over.iter().filter_map(|o| along(carrier, o));
        for cover in covers.collect::<Vec<_>>() {
            kept = kept
                .into_iter()
                .flat_map(|s| [[s[0], s[1].min(cover[0])], [s[0].max(cover[1]), s[1]]])
                .filter(|s| s[1] - s[0] > JOIN_MM)
                .collect();
        }
        let [c, s] = carrier.direction;
        let at = |t: f64| [c * t - s * carrier.offset, s * t + c * carrier.offset];
        result.extend(kept.into_iter().filter(|k| k[1] - k[0] > JOIN_MM).map(|k| [at(k[0]), at(k[1])]));
    }
    result
}

/// Drops strokes that are closer than `apart_mm` to a parallel longer one, or to one of `kept`, over most of their length:
/// crowded lines print as a black patch. Strokes on the bounds of the view are always kept.
#[must_use]
pub fn legible(strokes: &[Stroke], kept: &[Stroke], apart_mm: f64) -> Vec<Stroke> {
    let length = |s: &Stroke| libm::hypot(s[1][0] - s[0][0], s[1][1] - s[0][1]);
    let reach = |axis: usize| {
        let ends = strokes.iter().flatten().map(|p| p[axis]);
        ends.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)))
    };
    let reaches = [reach(0), reach(1)];
    let is_bound = |s: &Stroke| {
        (0..2).any(|axis| {
            let at = |x: f64| s.iter().all(|p| (p[axis] - x).abs() < 1e-4);
            at(reaches[axis].0) || at(reaches[axis].1)
        })
    };
    let mut longest: Vec<&Stroke> = strokes.iter().collect();
    longest.sort_by(|a, b| length(b).total_cmp(&length(a)));
    let (bounds, inner): (Vec<&Stroke>, Vec<&Stroke>) = longest.into_iter().partition(|s| is_bound(s));
    let mut all: Vec<Stroke> = Vec::new();
    for stroke in bounds.into_iter().chain(inner) {
        let Some([c, s]) = direction_of(stroke) else { continue };
        let split = |p: [f64; 2]| (p[0] * c + p[1] * s, p[1] * c - p[0] * s);
        let ((a, off), (b, _)) = (split(stroke[0]), split(stroke[1]));
        let (low, high) = (a.min(b), a.max(b));
        let is_crowded = all.iter().chain(kept).any(|other| {
            let ((p, near), (q, far)) = (split(other[0]), split(other[1]));
            let is_parallel = (near - far).abs() < 1e-4;
            let shared = high.min(p.max(q)) - low.max(p.min(q));
            is_parallel && (near - off).abs() < apart_mm - SAME_MM && shared > CROWDED_SHARE * (high - low)
        });
        if !is_crowded {
            all.push(*stroke);
        }
    }
    all
}

/// Unit vector along a stroke, the same for both orders of its ends; `None` for a point.
fn direction_of(stroke: &Stroke) -> Option<[f64; 2]> {
    let d = [stroke[1][0] - stroke[0][0], stroke[1][1] - stroke[0][1]];
    let length = libm::hypot(d[0], d[1]);
    if length < 1e-6 {
        return None;
    }
    // Directions along the axes are exact.
    let sign = if d[0] < -1e-9 * length || (d[0].abs() <= 1e-9 * length && d[1] < 0.0) { -1.0 } else { 1.0 };
    let unit = [sign * d[0] / length, sign * d[1] / length];
    Some(if unit[1].abs() < 1e-9 {
        [1.0, 0.0]
    } else if unit[0].abs() < 1e-9 {
        [0.0, 1.0]
    } else {
        unit
    })
}

/// The span of a carrier that a stroke on it covers.
fn along(carrier: &Carrier, stroke: &Stroke) -> Option<[f64; 2]> {
    let [c, s] = carrier.direction;
    let split = |p: [f64; 2]| (p[0] * c + p[1] * s, p[1] * c - p[0] * s);
    let ((a, off), (b, far)) = (split(stroke[0]), split(stroke[1]));
    let is_on = (off - carrier.offset).abs() < 1e-4 && (far - carrier.offset).abs() < 1e-4;
    is_on.then_some([a.min(b), a.max(b)])
}

/// The number of the carrier of a stroke, added where it is new, and the span that the stroke covers of it.
fn place(stroke: &Stroke, all: &mut Vec<Carrier>) -> (usize, Option<[f64; 2]>) {
    let Some(direction) = direction_of(stroke) else { return (0, None) };
    for (i, carrier) in all.iter().enumerate() {
        let turn = carrier.direction[0] * direction[1] - carrier.direction[1] * direction[0];
        if turn.abs() < 1e-6
            && let Some(span) = along(carrier, stroke)
        {
            return (i, Some(span));
        }
    }
    let [c, s] = direction;
    let offset = stroke[0][1] * c - stroke[0][0] * s;
    let carrier = Carrier { direction, offset, spans: Vec::new() };
    let span = along(&carrier, stroke);
    all.push(carrier);
    (all.len() - 1, span)
}

/// Draws strokes of a side view, whose point `[u, z]` is at `at([u, z])` on paper.
pub fn draw_strokes(
    draft: &mut Draft,
    layer: Layer,
    strokes: &[Stroke],
    at: impl Fn([f64; 2]) -> Point,
    view: Option<usize>,
    group: usize,
) {
    for [from, to] in strokes {
        draft.put(layer, Shape::Line { from: at(*from), to: at(*to) }, view, group);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn crowded_lines_are_thinned() {
        let upright = |u: f64, high: f64| [[u, 0.0], [u, high]];
        let strokes =
            [upright(0.0, 5.0), upright(0.3, 5.0), upright(0.8, 20.0), upright(0.9, 5.0), upright(1.6, 5.0)];
        assert_eq!(legible(&strokes, &[], 0.5), [upright(0.0, 5.0), upright(1.6, 5.0), upright(0.8, 20.0)]);
        assert_eq!(legible(&strokes[..1], &[upright(0.2, 9.0)], 0.5), Vec::<Stroke>::new());
        // Crossing strokes are not crowded.
        assert_eq!(legible(&[upright(0.0, 5.0), [[-1.0, 2.0], [1.0, 2.0]]], &[], 0.5).len(), 2);
    }
}
