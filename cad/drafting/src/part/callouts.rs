//! Callouts of features, and the dimensions of enlarged details.

use std::f64::consts::FRAC_PI_2;

use super::angles::Places;
use super::detail::Detail;
use super::dimension::{Dimension, numbered};
use super::features::{Features, Slot};
use super::fit::{Fit, Fits};
use super::hole_table;
use super::text;
use crate::contour::{same, same_point};
use crate::view::Place;
use crate::{Leader, Linear, Point};
use pinswitch_solid::profile::{Arc, Point2};

/// Additional length of a leader rather than end on the other side of an arc, mm.
const OTHER_SIDE_MM: f64 = 4.0;
/// The same for the inner edge of a ring segment, mm.
const INNER_EDGE_MM: f64 = 8.0;
/// The same for the outermost radius from inside, and the innermost from outside, mm.
const WRONG_SIDE_MM: f64 = 18.0;

/// The features of a part with what the texts of its dimensions need.
pub(super) struct Subject<'a> {
    pub(super) features: &'a Features,
    pub(super) fits: &'a Fits,
    pub(super) half_span_rad: Option<f64>,
    /// What bosses with a fit are called.
    pub(super) boss: &'a str,
}

/// Returns the dimensions of a detail.
pub(super) fn of_detail(subject: &Subject<'_>, detail: &Detail, place: &Place) -> Vec<Dimension> {
    let f = subject.features;
    let mut all = Vec::new();
    if !detail.is_slot {
        let of_kind = f.roundings.iter().filter(|r| r.is_half_round).enumerate();
        for (i, rounding) in of_kind {
            let Some(arc) = rounding.arcs.iter().find(|a| same_point(a.centre, detail.middle)) else {
                continue;
            };
            all.push(Dimension::fitted_callout(
                numbered("groove", i),
                text::rounding(subject.fits, rounding, f),
                on_arc(arc, place, &[0.25, 0.4, 0.5, 0.6, 0.75], OTHER_SIDE_MM),
                &subject.fits.half_rounds,
            ));
        }
        return all;
    }
    let of_detail = f.slots.iter().enumerate().find(|(_, s)| is_enlarged_in(s, detail));
    let Some((i, slot)) = of_detail else { return all };
    let (half, travel) = (slot.width_mm / 2.0 * place.scale, slot.travel_mm() * place.scale);
    let outer = place.origin + Point::new(0.0, travel / 2.0);
    let radius = detail.radius_mm * place.scale;
    all.push(Dimension::linear(Linear {
        key: numbered("slot width", i),
        text: text::slot_width(subject.fits, slot),
        from: outer - Point::new(half, 0.0),
        to: outer + Point::new(half, 0.0),
        upright: false,
        edge_mm: place.origin.y + radius - 3.0,
        outward: 1.0,
        room_mm: f64::INFINITY,
        clear_of: [place.origin.x - half, place.origin.x + half],
    }));
    all.push(Dimension::linear(Linear {
        key: numbered("slot travel", i),
        text: text::number(slot.travel_mm()),
        from: outer,
        to: outer - Point::new(0.0, travel),
        upright: true,
        edge_mm: place.origin.x - radius + 3.0,
        outward: -1.0,
        room_mm: f64::INFINITY,
        clear_of: [outer.y - travel, outer.y],
    }));
    let sides = [1.0, -1.0].into_iter().flat_map(|side| {
        (-2..=2).flat_map(move |step| {
            let tip = place.origin + Point::new(side * half, f64::from(step) * travel / 5.0);
            [-0.7, -0.35, 0.0, 0.35].map(|rise| Leader {
                tip,
                direction: Point::new(side, rise).unit(),
                cost_mm: if side > 0.0 { 0.0 } else { OTHER_SIDE_MM },
            })
        })
    });
    let lines = text::slot(subject.fits, slot);
    all.push(Dimension::fitted_callout(numbered("slot", i), lines, sides.collect(), &subject.fits.slots));
    all
}

/// Returns whether a detail shows one of these slots.
fn is_enlarged_in(slot: &Slot, detail: &Detail) -> bool {
    slot.places.iter().any(|(a, b)| same_point(nalgebra::center(a, b), detail.middle))
}

/// Leaders to an arc along its radius: from the side of its centre, or from outside for `other_mm` more.
fn on_arc(arc: &Arc, place: &Place, shares: &[f64], other_mm: f64) -> Vec<Leader> {
    shares
        .iter()
        .flat_map(|share| {
            let tip = place.at(arc.point_at(*share, arc.radius_mm));
            let inward = (place.at(arc.centre) - tip).unit();
            [(inward, 0.0), (inward * -1.0, other_mm)].map(|(direction, cost_mm)| Leader {
                tip,
                direction,
                cost_mm,
            })
        })
        .collect()
}

/// Returns all callouts of the front view: holes, bosses, slots, grooves, corners, ring segments, ends and radii.
pub(super) fn callouts(subject: &Subject<'_>, places: &Places, details: &[Detail]) -> Vec<Dimension> {
    let (f, place) = (subject.features, &places.first);
    let mut all = Vec::new();
    bores(subject, place, &mut all);
    bosses(subject, place, &mut all);
    slots(subject, place, details, &mut all);
    roundings(subject, place, details, &mut all);
    segments(f, place, &mut all);
    for (i, slot) in f.arc_slots.iter().enumerate() {
        let leaders = on_arc(&slot.outer_edge, place, &[0.2, 0.4, 0.6, 0.8], 0.0);
        all.push(Dimension::callout(numbered("arc slot", i), text::arc_slot(slot), leaders));
    }
    ends(subject, place, &mut all);
    if f.is_axial() {
        radii(subject, places, &mut all);
    }
    all
}

/// Callouts of ring segments.
fn segments(f: &Features, place: &Place, all: &mut Vec<Dimension>) {
    let slots: Vec<f64> =
        f.slots.iter().flat_map(|s| s.places.iter().map(|p| text::angle_rad(p.0))).collect();
    for (i, segments) in f.segments.iter().enumerate() {
        let leaders = segments.spans_rad.iter().flat_map(|(from, to)| {
            let arc = Arc {
                centre: Point2::origin(),
                radius_mm: segments.outer_mm,
                start_rad: FRAC_PI_2 - from,
                sweep_rad: from - to,
            };
            // Leaders to the outer edge may be inclined, to pass other dimensions.
            on_arc(&arc, place, &[0.4, 0.6], INNER_EDGE_MM)
                .into_iter()
                .flat_map(|leader| {
                    [-0.7, -0.3, 0.0, 0.3, 0.7].map(|turn: f64| {
                        let direction = Point::towards(leader.direction.angle_rad() + turn);
                        Leader { direction, cost_mm: INNER_EDGE_MM - leader.cost_mm, ..leader }
                    })
                })
                .collect::<Vec<_>>()
        });
        let lines = text::segments(segments, &slots);
        all.push(Dimension::callout(numbered("lip", i), lines, leaders.collect()));
    }
}

/// Callouts of ends of a sector that are not in a plane through the axis.
fn ends(subject: &Subject<'_>, place: &Place, all: &mut Vec<Dimension>) {
    let f = subject.features;
    // The copies of a horizontal pattern are on the right.
    let is_free = |(a, _): &&(Point2, Point2)| f.pattern.is_none_or(|p| p.is_upright() || a.x < 0.0);
    for ends in f.ends.iter().filter(|e| !same(e.shift_mm, 0.0)) {
        let leaders = ends.lines.iter().filter(is_free).flat_map(|(a, b)| {
            [0.3, 0.5, 0.7].into_iter().flat_map(move |share| {
                let tip = place.at(a + (b - a) * share);
                let outward = Point::new(if tip.x > place.origin.x { 1.0 } else { -1.0 }, 0.0);
                [-0.5, 0.0, 0.5].map(|rise| Leader {
                    tip,
                    direction: (outward + Point::new(0.0, rise)).unit(),
                    cost_mm: 0.0,
                })
            })
        });
        let key = format!("end {}", text::number(ends.shift_mm));
        let lines = text::ends(ends.shift_mm, subject.half_span_rad.unwrap_or_default());
        all.push(Dimension::callout(key, lines, leaders.collect()));
    }
}

/// Callouts of bores.
fn bores(subject: &Subject<'_>, place: &Place, all: &mut Vec<Dimension>) {
    let f = subject.features;
    for (i, bore) in f.bores.iter().enumerate() {
        let radius = bore.front_radius_mm() * place.scale;
        let leaders = bore.centres.iter().flat_map(|c| Leader::to_circle(place.at(*c), radius)).collect();
        let mut lines = text::bore(subject.fits, bore, f.is_axial());
        if let (Some(name), Some(first)) = (hole_table::letter(f, i), lines.first_mut()) {
            *first = format!("{name}: {first}");
        }
        // The geometrical tolerance of a bore is that of any of its stages.
        let of_stage = |stage| subject.fits.of_stage(*bore.centres.first()?, stage);
        let fits = bore.stages.iter().filter_map(of_stage);
        let fit = fits.max_by_key(|fit| (fit.indicators.len(), fit.datum.is_some())).cloned();
        let key = format!("hole {}", i + 1);
        all.push(Dimension::fitted_callout(key, lines, leaders, &fit.unwrap_or_default()));
    }
}

/// Callouts of bosses, and of the diameters of a round part.
fn bosses(subject: &Subject<'_>, place: &Place, all: &mut Vec<Dimension>) {
    let f = subject.features;
    for (i, boss) in f.bosses.iter().enumerate() {
        let mut radii: Vec<f64> = boss.levels.iter().map(|l| l.1).collect();
        radii.dedup_by(|a, b| same(*a, *b));
        // A rim of several diameters has a callout for each; a peg has one.
        if radii.len() > 2 && f.is_round_body() {
            radii.sort_by(f64::total_cmp);
            radii.dedup_by(|a, b| same(*a, *b));
            for radius in radii {
                let leaders = Leader::to_circle(place.at(boss.centres[0]), radius * place.scale);
                let diameter = text::number(2.0 * radius);
                let text = format!("\u{d8}{diameter}");
                all.push(Dimension::callout(format!("diameter {diameter}"), vec![text], leaders));
            }
            continue;
        }
        let radius = boss.levels[0].1 * place.scale;
        let leaders = boss.centres.iter().flat_map(|c| Leader::to_circle(place.at(*c), radius)).collect();
        let lines = text::boss(subject.fits, boss, subject.boss, f.is_round_body(), f.is_axial());
        all.push(Dimension::callout(format!("round {}", i + 1), lines, leaders));
    }
}

/// Callouts of slots that no detail shows.
fn slots(subject: &Subject<'_>, place: &Place, details: &[Detail], all: &mut Vec<Dimension>) {
    let f = subject.features;
    if let Some((lines, tips)) = slot_row(f) {
        let leaders = tips.iter().flat_map(|tip| {
            [-1.0, -0.5, 0.0, 0.5, 1.0].map(|lean| Leader {
                tip: place.at(*tip),
                direction: Point::new(lean, 1.0).unit(),
                cost_mm: 0.0,
            })
        });
        all.push(Dimension::callout("slots", lines, leaders.collect()));
        return;
    }
    let is_enlarged = |slot: &Slot| details.iter().any(|d| d.is_slot && is_enlarged_in(slot, d));
    for (i, slot) in f.slots.iter().enumerate().filter(|(_, slot)| !is_enlarged(slot)) {
        let leaders = slot.places.iter().flat_map(|(a, b)| {
            let middle = place.at(nalgebra::center(a, b));
            [1.0, -1.0].into_iter().flat_map(move |side| {
                [-1.0, 1.0, -0.4, 0.4].map(|rise| Leader {
                    tip: middle + Point::new(side * slot.width_mm / 2.0 * place.scale, 0.0),
                    direction: Point::new(side * 0.5, rise).unit(),
                    cost_mm: 0.0,
                })
            })
        });
        let width = text::slot_width(subject.fits, slot);
        let mut lines = vec![format!("{width} \u{d7} {}", text::number(slot.travel_mm()))];
        if f.is_axial() {
            lines.extend(text::slot(subject.fits, slot));
        }
        all.push(Dimension::fitted_callout(
            numbered("slot", i),
            lines,
            leaders.collect(),
            &subject.fits.slots,
        ));
    }
}

/// Callouts of grooves, ribs and corners that no detail shows.
fn roundings(subject: &Subject<'_>, place: &Place, details: &[Detail], all: &mut Vec<Dimension>) {
    let f = subject.features;
    let mut half_rounds = 0;
    for rounding in &f.roundings {
        let is_enlarged = rounding.is_half_round
            && details.iter().any(|d| rounding.arcs.iter().any(|a| same_point(a.centre, d.middle)));
        half_rounds += usize::from(rounding.is_half_round);
        if is_enlarged {
            continue;
        }
        let key = if rounding.is_half_round {
            numbered("groove", half_rounds - 1)
        } else {
            format!("corner {}", text::number(rounding.radius_mm))
        };
        let leaders = rounding.arcs.iter().flat_map(|a| on_arc(a, place, &[0.3, 0.5, 0.7], 0.0)).collect();
        let fit = if rounding.is_half_round { subject.fits.half_rounds.clone() } else { Fit::default() };
        all.push(Dimension::fitted_callout(key, text::rounding(subject.fits, rounding, f), leaders, &fit));
    }
}

/// One callout for a row of slots that differ in their widths only, with the upper ends of the slots.
fn slot_row(f: &Features) -> Option<(Vec<String>, Vec<Point2>)> {
    let first = f.slots.first()?;
    let is_equal = |s: &Slot| {
        s.places.len() == 1
            && same(s.travel_mm(), first.travel_mm())
            && same(s.places[0].0.y, first.places[0].0.y)
    };
    if f.slots.len() < 2 || f.is_axial() || !f.slots.iter().all(is_equal) {
        return None;
    }
    let mut slots: Vec<&Slot> = f.slots.iter().collect();
    slots.sort_by(|a, b| a.places[0].0.x.total_cmp(&b.places[0].0.x));
    let widths: Vec<String> = slots.iter().map(|s| text::number(s.width_mm)).collect();
    let lines = vec![
        format!("{} \u{d7} slot, widths from the left", slots.len()),
        widths.join(", "),
        format!("each {} between end centres", text::number(first.travel_mm())),
    ];
    let upper = |s: &Slot| {
        let (a, b) = s.places[0];
        let end = if a.y > b.y { a } else { b };
        Point2::new(end.x, end.y + s.width_mm / 2.0)
    };
    Some((lines, slots.into_iter().map(upper).collect()))
}

/// Callouts of radii about the axis, the outermost from outside and the innermost from inside. With a pattern, leaders from
/// inside end at its first pocket and those from outside at its last, so that none crosses another pocket.
fn radii(subject: &Subject<'_>, places: &Places, all: &mut Vec<Dimension>) {
    let f = subject.features;
    for (i, arcs) in f.axis_arcs.iter().enumerate() {
        let radius = arcs[0].radius_mm;
        let shares: &[f64] = if arcs.len() > 4 {
            &[0.5]
        } else {
            &[0.06, 0.12, 0.18, 0.24, 0.3, 0.36, 0.43, 0.57, 0.64, 0.7, 0.76, 0.82, 0.88, 0.94]
        };
        let is_inner = i + 1 == f.axis_arcs.len();
        let on = |place: &Place, is_possible: &dyn Fn(Point, bool) -> bool| -> Vec<Leader> {
            let ends = arcs.iter().flat_map(|a| on_arc(a, place, shares, 0.0));
            ends.filter_map(|leader| {
                let outward = (leader.tip - place.origin).unit();
                let is_outward = outward.x * leader.direction.x + outward.y * leader.direction.y > 0.0;
                let cost_mm = if is_outward == is_inner { WRONG_SIDE_MM } else { 0.0 };
                is_possible(leader.direction, is_outward).then_some(Leader { cost_mm, ..leader })
            })
            .collect()
        };
        let leaders = match f.pattern {
            None => on(&places.first, &|_, _| true),
            Some(pattern) if pattern.is_upright() => {
                let outside = on(&places.last, &|_, is_outward| is_outward);
                [on(&places.first, &|_, is_outward| !is_outward), outside].concat()
            }
            // The others are on the right.
            Some(_) => on(&places.first, &|direction, is_outward| !is_outward || direction.x < 0.0),
        };
        let key = format!("radius {}", text::number(radius));
        let (fit, is_auxiliary) = subject.fits.of_radius(radius);
        let text = format!("R{}", text::number(radius));
        let fit = fit.cloned().unwrap_or_default();
        let text = if is_auxiliary { format!("({text})") } else { text::joined(&[&text, &fit.tolerance]) };
        all.push(Dimension::fitted_callout(key, vec![text], leaders, &fit));
    }
}
