//! What a sheet cuts open, and what it draws larger.

use super::features::Features;
use super::words;
use pinswitch_drafting::view::{Place, Side, Trace, draw_plan, within};
use pinswitch_drafting::{Draft, Extent, Layer, Point, Shape, Sheet};
use pinswitch_solid::profile::{Point2, polar};

/// Scales of details, the largest first.
const DETAIL_SCALES: [f64; 6] = [20.0, 10.0, 5.0, 2.0, 1.0, 0.5];
/// So many details find room beside the views.
const MOST_DETAILS: usize = 2;

/// A part of the front view that is drawn larger.
#[derive(Clone, Copy, Debug)]
pub(super) struct Detail {
    pub(super) middle: Point2,
    pub(super) radius_mm: f64,
    pub(super) turn_rad: f64,
    pub(super) is_slot: bool,
}

/// Grooves and slots that are drawn larger, turned so that the axis lies below.
pub(super) fn enlarged(f: &Features, scale: f64) -> Vec<Detail> {
    let is_axial = !f.axis_arcs.is_empty();
    let mut all = Vec::new();
    let nearest = |points: &[Point2]| {
        points
            .iter()
            .copied()
            .min_by(|a, b| words::angle_rad(*a).abs().total_cmp(&words::angle_rad(*b).abs()))
    };
    let turn = |p: Point2| if is_axial { words::angle_rad(p) } else { 0.0 };
    for rounding in f.roundings.iter().filter(|r| r.is_half_round) {
        let centres: Vec<Point2> = rounding.arcs.iter().map(|a| a.centre).collect();
        if let Some(middle) = nearest(&centres) {
            let radius_mm = 2.4 * rounding.radius_mm;
            all.push(Detail { middle, radius_mm, turn_rad: turn(middle), is_slot: false });
        }
    }
    for slot in f.slots.iter().filter(|_| is_axial) {
        let centres: Vec<Point2> = slot.places.iter().map(|p| p.0).collect();
        let Some(outer) = nearest(&centres) else { continue };
        let half = f64::midpoint(slot.travel_mm(), slot.width_mm);
        let angle = words::angle_rad(outer);
        let middle = polar(outer.coords.norm() - slot.travel_mm() / 2.0, angle);
        all.push(Detail { middle, radius_mm: 1.6 * half, turn_rad: turn(outer), is_slot: true });
    }
    // A detail that would not be larger than the view itself is none.
    all.retain(|d| d.radius_mm * scale < 40.0);
    all.truncate(MOST_DETAILS);
    all
}

/// Where the section is cut: through what has most to show, as near to the middle as it lies.
pub(super) fn cut_x(
    f: &Features,
    side: Side,
    (low, high): (nalgebra::Point3<f64>, nalgebra::Point3<f64>),
) -> f64 {
    let bottom = low.z;
    let pegs = f.rounds.iter().filter(|r| r.levels[0].0 > bottom + 1e-9);
    let blind = f.bores.iter().filter(|b| !b.is_plain());
    let holes = f.bores.iter().filter(|b| b.is_plain());
    let xs = |points: Vec<Point2>| points.into_iter().map(|p| p.x).collect::<Vec<f64>>();
    let slots = |is_blind: bool| {
        let of_kind = f.slots.iter().filter(move |s| s.is_blind == is_blind);
        xs(of_kind.flat_map(|s| s.places.iter().map(|p| p.0)).collect())
    };
    let ranked = [
        xs(pegs.flat_map(|r| r.centres.clone()).collect()),
        xs(blind.flat_map(|r| r.centres.clone()).collect()),
        slots(true),
        xs(holes.flat_map(|r| r.centres.clone()).collect()),
        slots(false),
        if f.arc_slots.is_empty() { Vec::new() } else { vec![0.0] },
        xs(f.roundings
            .iter()
            .filter(|r| r.is_half_round)
            .flat_map(|r| r.arcs.iter().map(|a| a.centre))
            .collect()),
    ];
    let sense = if side == Side::Left { 1.0 } else { -1.0 };
    let middle = if f.axis_arcs.is_empty() { f64::midpoint(low.x, high.x) } else { 0.0 };
    let nearest = |all: &Vec<f64>| {
        // Of two that are as near, the one that leaves more to be seen behind it.
        let key = |x: f64| (x - middle).abs() + 1e-6 * sense * (x - middle);
        all.iter().copied().min_by(|a, b| key(*a).total_cmp(&key(*b)))
    };
    ranked.iter().find_map(nearest).unwrap_or(middle)
}

/// Draws a detail; returns where it lies.
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
    let kept: Vec<(Layer, Trace)> = lines
        .iter()
        .flat_map(|(layer, t)| within(t, detail.middle, detail.radius_mm).into_iter().map(|t| (*layer, t)))
        .collect();
    let view = draft.view(format!("DETAIL_{letter}"), middle, scale);
    draw_plan(draft, &kept, &place, view);
    let group = draft.group();
    let radius_mm = detail.radius_mm * scale;
    draft.put(Layer::Thin, Shape::Circle { centre: middle, radius_mm }, None, group);
    let reach = radius_mm + 2.0;
    for half in [Point::new(reach, 0.0), Point::new(0.0, reach)] {
        let shift = if detail.is_slot && half.y == 0.0 { None } else { Some(Point::default()) };
        if let Some(shift) = shift {
            let (from, to) = (middle - half + shift, middle + half + shift);
            draft.put(Layer::Centre, Shape::Line { from, to }, None, group);
        }
    }
    let corner = Point::new(radius_mm, radius_mm);
    let around = Extent { low: middle - corner, high: middle + corner };
    let title = format!("{letter} ({})", Sheet::scale_text(scale));
    draft.place_title(&format!("title of detail {letter}"), &title, 3.5, around, false).then_some(place)
}
