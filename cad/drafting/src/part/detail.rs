//! Enlarged details, and the place of the section.

use super::features::Features;
use super::text;
use crate::view::{Place, Side, Trace, draw_plan, within};
use crate::{Draft, Extent, Layer, Point, Shape, Sheet};
use pinswitch_solid::mesh::Point3;
use pinswitch_solid::profile::{Point2, polar};

/// Scales of details, the largest first.
const DETAIL_SCALES: [f64; 6] = [20.0, 10.0, 5.0, 2.0, 1.0, 0.5];
/// Most details on a sheet.
const MOST_DETAILS: usize = 2;
/// A feature is enlarged if its detail has a smaller radius than this in the front view, mm on paper.
const MOST_RADIUS_MM: f64 = 40.0;

/// A part of the front view that is enlarged.
#[derive(Clone, Copy, Debug)]
pub(super) struct Detail {
    pub(super) middle: Point2,
    pub(super) radius_mm: f64,
    pub(super) turn_rad: f64,
    pub(super) is_slot: bool,
}

/// Returns the grooves and slots to enlarge, rotated so that the axis is below them.
pub(super) fn details(f: &Features, scale: f64) -> Vec<Detail> {
    let mut all = Vec::new();
    let nearest = |points: &[Point2]| {
        points.iter().copied().min_by(|a, b| text::angle_rad(*a).abs().total_cmp(&text::angle_rad(*b).abs()))
    };
    let turn = |p: Point2| if f.is_axial() { text::angle_rad(p) } else { 0.0 };
    for rounding in f.roundings.iter().filter(|r| r.is_half_round) {
        let centres: Vec<Point2> = rounding.arcs.iter().map(|a| a.centre).collect();
        if let Some(middle) = nearest(&centres) {
            let radius_mm = 2.4 * rounding.radius_mm;
            all.push(Detail { middle, radius_mm, turn_rad: turn(middle), is_slot: false });
        }
    }
    for slot in f.slots.iter().filter(|_| f.is_axial()) {
        let centres: Vec<Point2> = slot.places.iter().map(|p| p.0).collect();
        let Some(outer) = nearest(&centres) else { continue };
        let half = f64::midpoint(slot.travel_mm(), slot.width_mm);
        let angle = text::angle_rad(outer);
        let middle = polar(outer.coords.norm() - slot.travel_mm() / 2.0, angle);
        all.push(Detail { middle, radius_mm: 1.6 * half, turn_rad: turn(outer), is_slot: true });
    }
    all.retain(|d| d.radius_mm * scale < MOST_RADIUS_MM);
    all.truncate(MOST_DETAILS);
    all
}

/// Returns the x of the cutting plane: through the features with most to show, as near to the middle as possible.
pub(super) fn cut_x(f: &Features, side: Side, (low, high): (Point3, Point3)) -> f64 {
    let bottom = low.z;
    let bosses = f.bosses.iter().filter(|b| b.levels[0].0 > bottom + 1e-9);
    let blind = f.bores.iter().filter(|b| !b.is_plain());
    let holes = f.bores.iter().filter(|b| b.is_plain());
    let xs = |points: Vec<Point2>| points.into_iter().map(|p| p.x).collect::<Vec<f64>>();
    let slots = |is_blind: bool| {
        let of_kind = f.slots.iter().filter(move |s| s.is_blind == is_blind);
        xs(of_kind.flat_map(|s| s.places.iter().map(|p| p.0)).collect())
    };
    let ranked = [
        xs(bosses.flat_map(|b| b.centres.clone()).collect()),
        xs(blind.flat_map(|b| b.centres.clone()).collect()),
        slots(true),
        xs(holes.flat_map(|b| b.centres.clone()).collect()),
        slots(false),
        if f.arc_slots.is_empty() { Vec::new() } else { vec![0.0] },
        xs(f.roundings
            .iter()
            .filter(|r| r.is_half_round)
            .flat_map(|r| r.arcs.iter().map(|a| a.centre))
            .collect()),
    ];
    let sense = if side == Side::Left { 1.0 } else { -1.0 };
    let middle = if f.is_axial() { 0.0 } else { f64::midpoint(low.x, high.x) };
    let nearest = |all: &Vec<f64>| {
        // Of two at equal distances, the one with more behind it.
        let key = |x: f64| (x - middle).abs() + 1e-6 * sense * (x - middle);
        all.iter().copied().min_by(|a, b| key(*a).total_cmp(&key(*b)))
    };
    ranked.iter().find_map(nearest).unwrap_or(middle)
}

/// Draws a detail about `middle` on paper; returns its place, or `None` without space.
pub(super) fn draw_detail(
    draft: &mut Draft,
    detail: &Detail,
    middle: Point,
    reach_mm: f64,
    lines: &[(Layer, Trace)],
    letter: &str,
) -> Option<Place> {
    let scale = DETAIL_SCALES.into_iter().find(|s| detail.radius_mm * s <= reach_mm)?;
    let place = Place { origin: middle, scale, about: detail.middle, turn_rad: detail.turn_rad };
    let pieces: Vec<(Layer, Trace)> = lines
        .iter()
        .flat_map(|(layer, t)| within(t, detail.middle, detail.radius_mm).into_iter().map(|t| (*layer, t)))
        .collect();
    let view = draft.view(format!("DETAIL_{letter}"), middle, scale);
    draw_plan(draft, &pieces, &place, view);
    let group = draft.group();
    let radius_mm = detail.radius_mm * scale;
    draft.put(Layer::Thin, Shape::Circle { centre: middle, radius_mm }, None, group);
    let reach = radius_mm + 2.0;
    // A slot has a centre line along it only.
    for half in [Point::new(reach, 0.0), Point::new(0.0, reach)] {
        if !(detail.is_slot && half.y == 0.0) {
            let (from, to) = (middle - half, middle + half);
            draft.put(Layer::Centre, Shape::Line { from, to }, None, group);
        }
    }
    let corner = Point::new(radius_mm, radius_mm);
    let around = Extent { low: middle - corner, high: middle + corner };
    let title = format!("{letter} ({})", Sheet::scale_text(scale));
    draft.place_title(&format!("title of detail {letter}"), &title, 3.5, around, false).then_some(place)
}
