//! Angles about the axis: pitches of grooves and slots, and the span of a sector.

use std::f64::consts::FRAC_PI_2;

use super::dimension::{Dimension, numbered};
use super::features::Features;
use super::fit::{Fit, Fits};
use super::text;
use crate::Angular;
use crate::view::Place;
use pinswitch_solid::profile::Point2;

/// The front view of a part, and the same view with the last pocket of its pattern in the place of the first: nothing is
/// beyond the last one in the direction of the pattern.
#[derive(Clone, Copy, Debug)]
pub(super) struct Places {
    pub(super) first: Place,
    pub(super) last: Place,
}

impl Places {
    pub(super) fn new(f: &Features, first: Place) -> Self {
        let extent = f.pattern.map_or_else(Point2::origin, |p| Point2::from(p.extent()));
        Self { first, last: Place { origin: first.at(extent), ..first } }
    }
}

/// An angle to dimension: from and to, and the radius in mm of what it measures.
struct Sector {
    key: String,
    text: String,
    from_rad: f64,
    to_rad: f64,
    radius_mm: f64,
    is_exact: bool,
}

/// Returns all angles. In an upright pattern they are beyond the last pocket, in another one inside the bow of the first.
pub(super) fn angles(
    f: &Features,
    fits: &Fits,
    half_span_rad: Option<f64>,
    places: &Places,
) -> Vec<Dimension> {
    let radius = |arcs: Option<&Vec<pinswitch_solid::profile::Arc>>| arcs.map_or(0.0, |a| a[0].radius_mm);
    let (outermost, innermost) = (radius(f.axis_arcs.first()), radius(f.axis_arcs.last()));
    if outermost <= 0.0 {
        return Vec::new();
    }
    let is_inside = f.pattern.is_some_and(|p| !p.is_upright());
    let place = if is_inside { places.first } else { places.last };
    let centre = place.at(Point2::origin());
    let edge_mm = if is_inside { innermost } else { outermost };
    let dimension = |sector: Sector| {
        // Angles of the part are from +y toward +x, those of paper from +x toward +y.
        Dimension::angular(Angular {
            key: sector.key,
            text: sector.text,
            centre,
            from_rad: FRAC_PI_2 - sector.to_rad,
            to_rad: FRAC_PI_2 - sector.from_rad,
            begins_mm: sector.radius_mm * place.scale,
            edge_mm: edge_mm * place.scale,
            is_inside,
            is_exact: sector.is_exact,
        })
    };
    let mut all = pitches(f, fits);
    if let Some(half_span_rad) = half_span_rad.filter(|_| !f.ends.is_empty()) {
        all.push(Sector {
            key: "span".to_owned(),
            text: text::degrees(2.0 * half_span_rad),
            from_rad: -half_span_rad,
            to_rad: half_span_rad,
            radius_mm: edge_mm,
            is_exact: false,
        });
    }
    all.into_iter().map(dimension).collect()
}

/// Pitches of evenly spaced grooves and slots.
fn pitches(f: &Features, fits: &Fits) -> Vec<Sector> {
    let mut all = Vec::new();
    let mut pitch = |key: String, points: &[Point2], radius_mm: f64, fit: &Fit| {
        let angles: Vec<f64> = points.iter().map(|p| text::angle_rad(*p)).collect();
        if let Some((first, step)) = text::even_step(&angles) {
            let steps = (angles.len() - 1) as f64;
            let total = step * steps;
            let text = format!("{steps} \u{d7} {} = {}", text::degrees(step), text::degrees(total));
            // The positions of toleranced features are theoretically exact.
            let is_exact = !fit.indicators.is_empty();
            all.push(Sector { key, text, from_rad: first, to_rad: first + total, radius_mm, is_exact });
        }
    };
    for (i, rounding) in f.roundings.iter().filter(|r| r.is_half_round).enumerate() {
        let centres: Vec<Point2> = rounding.arcs.iter().map(|a| a.centre).collect();
        let radius = centres.first().map_or(0.0, |p| p.coords.norm());
        pitch(numbered("groove pitch", i), &centres, radius, &fits.half_rounds);
    }
    for (i, slot) in f.slots.iter().enumerate() {
        let centres: Vec<Point2> = slot.places.iter().map(|p| p.0).collect();
        let radius = centres.first().map_or(0.0, |p| p.coords.norm()) + slot.width_mm / 2.0;
        pitch(numbered("slot pitch", i), &centres, radius, &fits.slots);
    }
    all
}
