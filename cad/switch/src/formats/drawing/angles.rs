//! Angles about the pulley's axis: pitch of grooves and of slots, and the span of the ends.

use std::f64::consts::FRAC_PI_2;

use super::dimensions::{Wanted, numbered};
use super::features::Features;
use super::words;
use pinswitch_drafting::Angular;
use pinswitch_drafting::view::Place;
use pinswitch_solid::profile::Point2;

/// Where a part lies in its front view, and where it would lie if the last of its copies were the first: nothing lies beyond
/// that one in the direction in which they follow each other.
#[derive(Clone, Copy, Debug)]
pub(super) struct Places {
    pub(super) first: Place,
    pub(super) last: Place,
}

impl Places {
    pub(super) fn of(f: &Features, first: Place) -> Self {
        let reach = f.copies.map_or_else(Point2::origin, |c| Point2::from(c.reach()));
        Self { first, last: Place { origin: first.at(reach), ..first } }
    }
}

/// An angle that is to be written: from and to, and where what it measures begins, mm.
struct Sector {
    key: String,
    text: String,
    from_rad: f64,
    to_rad: f64,
    begins_mm: f64,
}

/// All angles. Those of nested copies stand beyond the last; of copies beside each other within the bow of the first.
pub(super) fn angles(f: &Features, half_span_rad: f64, places: &Places) -> Vec<Wanted> {
    let radius =
        |arcs: Option<&Vec<_>>| arcs.map_or(0.0, |a: &Vec<pinswitch_solid::profile::Arc>| a[0].radius_mm);
    let (outermost, innermost) = (radius(f.axis_arcs.first()), radius(f.axis_arcs.last()));
    if outermost <= 0.0 {
        return Vec::new();
    }
    let is_inside = f.copies.is_some_and(|c| !c.are_nested());
    let place = if is_inside { places.first } else { places.last };
    let centre = place.at(Point2::origin());
    let written = |sector: Sector| {
        // Angles of the part run from +y toward +x, those of paper from +x toward +y.
        Wanted::angular(Angular {
            key: sector.key,
            text: sector.text,
            centre,
            from_rad: FRAC_PI_2 - sector.to_rad,
            to_rad: FRAC_PI_2 - sector.from_rad,
            begins_mm: sector.begins_mm * place.scale,
            edge_mm: if is_inside { innermost } else { outermost } * place.scale,
            is_inside,
        })
    };
    let mut all = pitches(f);
    if !f.ends.is_empty() {
        all.push(Sector {
            key: "span".to_owned(),
            text: words::degrees(2.0 * half_span_rad),
            from_rad: -half_span_rad,
            to_rad: half_span_rad,
            begins_mm: if is_inside { innermost } else { outermost },
        });
    }
    all.into_iter().map(written).collect()
}

/// Pitch of grooves and of slots that are evenly spaced.
fn pitches(f: &Features) -> Vec<Sector> {
    let mut all = Vec::new();
    let mut pitch = |key: String, points: &[Point2], reach_mm: f64| {
        let places: Vec<f64> = points.iter().map(|p| words::angle_rad(*p)).collect();
        if let Some((first, step)) = words::even_step(&places) {
            let steps = (places.len() - 1) as f64;
            let total = step * steps;
            let text = format!("{steps} \u{d7} {} = {}", words::degrees(step), words::degrees(total));
            all.push(Sector { key, text, from_rad: first, to_rad: first + total, begins_mm: reach_mm });
        }
    };
    for (i, rounding) in f.roundings.iter().filter(|r| r.is_half_round).enumerate() {
        let centres: Vec<Point2> = rounding.arcs.iter().map(|a| a.centre).collect();
        let reach = centres.first().map_or(0.0, |p| p.coords.norm());
        pitch(numbered("groove pitch", i), &centres, reach);
    }
    for (i, slot) in f.slots.iter().enumerate() {
        let centres: Vec<Point2> = slot.places.iter().map(|p| p.0).collect();
        let reach = centres.first().map_or(0.0, |p| p.coords.norm()) + slot.width_mm / 2.0;
        pitch(numbered("slot pitch", i), &centres, reach);
    }
    all
}
