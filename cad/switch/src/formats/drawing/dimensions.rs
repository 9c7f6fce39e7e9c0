//! The dimensions of a part, each once: what is written where is decided here, and room for it found by the sheet.

use std::f64::consts::FRAC_PI_2;

use pinswitch_friction::sort_by_number;

use super::angles::Places;
use super::bore::bore as words_of_bore;
use super::cut::Detail;
use super::features::{Features, Slot, same};
use super::hole_table;
use super::words;
use crate::design::Design;
use crate::parts::Part;
use pinswitch_drafting::view::Place;
use pinswitch_drafting::{Angular, Callout, Draft, Extent, Label, Leader, Linear, Point};
use pinswitch_solid::profile::{Arc, Point2};

/// A dimension that is to be written.
#[derive(Clone, Debug)]
pub(super) struct Wanted {
    /// What it is of: unique on a sheet.
    pub(super) key: String,
    /// What it says.
    pub(super) lines: Vec<String>,
    form: Form,
}

#[derive(Clone, Debug)]
enum Form {
    /// A length, and the same on the other side of the view where it may stand there.
    Linear(Linear, Option<Linear>),
    Angular(Angular),
    Callout(Callout),
    Label(Label),
}

impl Wanted {
    /// The dimension among the notes, where it found no room beside its feature.
    pub(super) fn in_words(&self) -> String {
        let said = self.lines.join(", ");
        // Some keys end in what is said, so that they are unique.
        if self.key.ends_with(&said) { self.key.clone() } else { format!("{}: {said}", self.key) }
    }

    pub(super) fn linear(linear: Linear) -> Self {
        Self { key: linear.key.clone(), lines: vec![linear.text.clone()], form: Form::Linear(linear, None) }
    }

    /// The same, but on the other side of the view where it finds no room on the first.
    pub(super) fn or(mut self, other: Linear) -> Self {
        if let Form::Linear(_, otherwise) = &mut self.form {
            *otherwise = Some(other);
        }
        self
    }

    pub(super) fn angular(angular: Angular) -> Self {
        Self { key: angular.key.clone(), lines: vec![angular.text.clone()], form: Form::Angular(angular) }
    }

    pub(super) fn label(label: Label) -> Self {
        Self { key: label.key.clone(), lines: vec![label.text.clone()], form: Form::Label(label) }
    }

    fn callout(key: impl Into<String>, lines: Vec<String>, leaders: Vec<Leader>) -> Self {
        let key = key.into();
        let callout = Callout {
            key: key.clone(),
            lines: lines.clone(),
            leaders,
            is_balloon: false,
            avoid: Vec::new(),
            around: None,
        };
        Self { key, lines, form: Form::Callout(callout) }
    }

    /// Whether it is a length that stands below a front view.
    pub(super) fn is_below(&self, front: Extent) -> bool {
        matches!(&self.form, Form::Linear(l, _) if !l.upright && l.outward < 0.0 && l.edge_mm == front.low.y)
    }

    /// Writes it; whether there was room.
    pub(super) fn place(&self, draft: &mut Draft) -> bool {
        match &self.form {
            Form::Linear(l, other) => {
                l.place(draft) || other.as_ref().is_some_and(|other| other.place(draft))
            }
            Form::Angular(a) => a.place(draft),
            Form::Callout(c) => c.place(draft),
            Form::Label(l) => l.place(draft),
        }
    }
}

/// `key`, or `key 2` for the second of its kind.
pub(super) fn numbered(key: &str, index: usize) -> String {
    if index == 0 { key.to_owned() } else { format!("{key} {}", index + 1) }
}

/// What is dimensioned in a detail.
pub(super) fn of_detail(
    design: &Design,
    part: &Part,
    f: &Features,
    detail: &Detail,
    place: &Place,
) -> Vec<Wanted> {
    let mut all = Vec::new();
    if !detail.is_slot {
        let of_kind = f.roundings.iter().filter(|r| r.is_half_round).enumerate();
        for (i, rounding) in of_kind {
            let Some(arc) = rounding.arcs.iter().find(|a| (a.centre - detail.middle).norm() < 1e-6) else {
                continue;
            };
            let lines = words::rounding(part, rounding, f);
            all.push(Wanted::callout(
                numbered("groove", i),
                lines,
                on_arc(arc, place, &[0.25, 0.4, 0.5, 0.6, 0.75], 4.0),
            ));
        }
        return all;
    }
    let of_detail =
        f.slots.iter().enumerate().find(|(_, s)| {
            s.places.iter().any(|(a, b)| (nalgebra::center(a, b) - detail.middle).norm() < 1e-6)
        });
    let Some((i, slot)) = of_detail else { return all };
    let (half, travel) = (slot.width_mm / 2.0 * place.scale, slot.travel_mm() * place.scale);
    let outer = place.origin + Point::new(0.0, travel / 2.0);
    let radius = detail.radius_mm * place.scale;
    all.push(Wanted::linear(Linear {
        key: numbered("slot width", i),
        text: words::slot_width(part, slot),
        from: outer - Point::new(half, 0.0),
        to: outer + Point::new(half, 0.0),
        upright: false,
        edge_mm: place.origin.y + radius - 3.0,
        outward: 1.0,
        room_mm: f64::INFINITY,
        clear_of: [place.origin.x - half, place.origin.x + half],
    }));
    all.push(Wanted::linear(Linear {
        key: numbered("slot travel", i),
        text: words::number(slot.travel_mm()),
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
                cost_mm: if side > 0.0 { 0.0 } else { 4.0 },
            })
        })
    });
    all.push(Wanted::callout(numbered("slot", i), words::slot(design, part, slot), sides.collect()));
    all
}

/// The circle around what a detail shows, with its letter.
pub(super) fn mark_of_detail(at: Point, radius_mm: f64, letter: &str) -> Wanted {
    let leaders = Leader::around(at, radius_mm);
    let mut mark = Wanted::callout(format!("mark of detail {letter}"), vec![letter.to_owned()], leaders);
    if let Form::Callout(callout) = &mut mark.form {
        callout.around = Some((at, radius_mm));
    }
    mark
}

/// Leaders that end on an arc, along its radius: from the side of its centre, or from outside for `other_mm` more.
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

/// Everything that a leader points at in the front view: radii, holes, pegs, corners, lips, ends.
pub(super) fn callouts(
    design: &Design,
    part: &Part,
    f: &Features,
    places: &Places,
    details: &[Detail],
) -> Vec<Wanted> {
    let place = &places.first;
    let mut all = Vec::new();
    let is_axial = !f.axis_arcs.is_empty();
    holes_and_rounds(design, part, f, place, &mut all);
    slots_and_roundings(design, part, f, place, details, &mut all);
    for (i, pieces) in f.pieces.iter().enumerate() {
        let slots: Vec<f64> =
            f.slots.iter().flat_map(|s| s.places.iter().map(|p| words::angle_rad(p.0))).collect();
        let leaders = pieces.spans_rad.iter().flat_map(|(from, to)| {
            let arc = |radius: f64| Arc {
                centre: Point2::origin(),
                radius_mm: radius,
                start_rad: FRAC_PI_2 - from,
                sweep_rad: from - to,
            };
            // The outer edge may be pointed at aslant, so as to pass what is written there.
            on_arc(&arc(pieces.outer_mm), place, &[0.4, 0.6], 8.0)
                .into_iter()
                .flat_map(|leader| {
                    [-0.7, -0.3, 0.0, 0.3, 0.7].map(|turn: f64| {
                        let angle = leader.direction.angle_rad() + turn;
                        Leader { direction: Point::towards(angle), cost_mm: 8.0 - leader.cost_mm, ..leader }
                    })
                })
                .collect::<Vec<_>>()
        });
        all.push(Wanted::callout(numbered("lip", i), words::pieces(pieces, &slots), leaders.collect()));
    }
    for (i, slot) in f.arc_slots.iter().enumerate() {
        let leaders = on_arc(&slot.edge, place, &[0.2, 0.4, 0.6, 0.8], 0.0);
        all.push(Wanted::callout(numbered("arc slot", i), words::arc_slot(slot), leaders));
    }
    // Copies beside each other stand on the right.
    let is_free = |(a, _): &&(Point2, Point2)| f.copies.is_none_or(|c| c.are_nested() || a.x < 0.0);
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
        let key = format!("end {}", words::number(ends.shift_mm));
        all.push(Wanted::callout(key, words::ends(ends.shift_mm, design.half_span_rad()), leaders.collect()));
    }
    if is_axial {
        radii(f, places, &mut all);
    }
    all
}

fn holes_and_rounds(design: &Design, part: &Part, f: &Features, place: &Place, all: &mut Vec<Wanted>) {
    let is_axial = !f.axis_arcs.is_empty();
    for (i, bore) in f.bores.iter().enumerate() {
        let radius = bore.shown_mm() * place.scale;
        let leaders = bore.centres.iter().flat_map(|c| Leader::around(place.at(*c), radius)).collect();
        let mut lines = words_of_bore(design, part, bore, is_axial);
        if let (Some(name), Some(first)) = (hole_table::letter(f, i), lines.first_mut()) {
            *first = format!("{name}: {first}");
        }
        all.push(Wanted::callout(format!("hole {}", i + 1), lines, leaders));
    }
    for (i, round) in f.rounds.iter().enumerate() {
        let mut radii: Vec<f64> = round.levels.iter().map(|l| l.1).collect();
        radii.dedup_by(|a, b| same(*a, *b));
        // A rim of several diameters has a callout for each; a peg is told in one.
        if radii.len() > 2 && f.is_round_body() {
            radii.sort_by(f64::total_cmp);
            radii.dedup_by(|a, b| same(*a, *b));
            for radius in radii {
                let leaders = Leader::around(place.at(round.centres[0]), radius * place.scale);
                let diameter = words::number(2.0 * radius);
                let text = format!("\u{d8}{diameter}");
                all.push(Wanted::callout(format!("diameter {diameter}"), vec![text], leaders));
            }
            continue;
        }
        let radius = round.levels[0].1 * place.scale;
        let leaders = round.centres.iter().flat_map(|c| Leader::around(place.at(*c), radius)).collect();
        let lines = words::round(design, part, round, f.is_round_body(), is_axial);
        all.push(Wanted::callout(format!("round {}", i + 1), lines, leaders));
    }
}

fn slots_and_roundings(
    design: &Design,
    part: &Part,
    f: &Features,
    place: &Place,
    details: &[Detail],
    all: &mut Vec<Wanted>,
) {
    let is_axial = !f.axis_arcs.is_empty();
    let is_enlarged = |slot: &Slot| {
        let middles = slot.places.iter().map(|(a, b)| nalgebra::center(a, b));
        middles.into_iter().any(|m| details.iter().any(|d| d.is_slot && (d.middle - m).norm() < 1e-6))
    };
    let row = slot_row(f);
    if let Some((lines, tips)) = &row {
        let leaders = tips.iter().flat_map(|tip| {
            [-1.0, -0.5, 0.0, 0.5, 1.0].map(|lean| Leader {
                tip: place.at(*tip),
                direction: Point::new(lean, 1.0).unit(),
                cost_mm: 0.0,
            })
        });
        all.push(Wanted::callout("slots", lines.clone(), leaders.collect()));
    }
    for (i, slot) in f.slots.iter().enumerate().filter(|(_, slot)| row.is_none() && !is_enlarged(slot)) {
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
        let mut lines =
            vec![format!("{} \u{d7} {}", words::slot_width(part, slot), words::number(slot.travel_mm()))];
        if is_axial {
            lines.extend(words::slot(design, part, slot));
        }
        all.push(Wanted::callout(numbered("slot", i), lines, leaders.collect()));
    }
    let mut half_rounds = 0;
    for rounding in &f.roundings {
        let is_drawn_larger = rounding.is_half_round
            && details.iter().any(|d| rounding.arcs.iter().any(|a| (a.centre - d.middle).norm() < 1e-6));
        half_rounds += usize::from(rounding.is_half_round);
        if is_drawn_larger {
            continue;
        }
        let key = if rounding.is_half_round {
            numbered("groove", half_rounds - 1)
        } else {
            format!("corner {}", words::number(rounding.radius_mm))
        };
        let leaders = rounding.arcs.iter().flat_map(|a| on_arc(a, place, &[0.3, 0.5, 0.7], 0.0)).collect();
        all.push(Wanted::callout(key, words::rounding(part, rounding, f), leaders));
    }
}

/// Slots of one length in a row that differ in nothing but their widths, in one callout, and where it may point at: their
/// upper ends. `None` of others.
fn slot_row(f: &Features) -> Option<(Vec<String>, Vec<Point2>)> {
    let first = f.slots.first()?;
    let is_alike = |s: &Slot| {
        s.places.len() == 1
            && same(s.travel_mm(), first.travel_mm())
            && same(s.places[0].0.y, first.places[0].0.y)
    };
    if f.slots.len() < 2 || !f.axis_arcs.is_empty() || !f.slots.iter().all(is_alike) {
        return None;
    }
    let mut slots: Vec<&Slot> = f.slots.iter().collect();
    sort_by_number(&mut slots, |slot| slot.places[0].0.x);
    let widths: Vec<String> = slots.iter().map(|s| words::number(s.width_mm)).collect();
    let lines = vec![
        format!("{} \u{d7} slot, widths from the left", slots.len()),
        widths.join(", "),
        format!("each {} between the centres of its ends", words::number(first.travel_mm())),
    ];
    let upper = |s: &Slot| {
        let (a, b) = s.places[0];
        let end = if a.y > b.y { a } else { b };
        Point2::new(end.x, end.y + s.width_mm / 2.0)
    };
    Some((lines, slots.into_iter().map(upper).collect()))
}

/// Radii about the axis, the outermost from outside and the innermost from inside. Where there are copies, no leader passes
/// another: from inside it ends at the first, from outside at the last.
fn radii(f: &Features, places: &Places, all: &mut Vec<Wanted>) {
    for (i, arcs) in f.axis_arcs.iter().enumerate() {
        let radius = arcs[0].radius_mm;
        let shares: &[f64] = if arcs.len() > 4 {
            &[0.5]
        } else {
            &[0.06, 0.12, 0.18, 0.24, 0.3, 0.36, 0.43, 0.57, 0.64, 0.7, 0.76, 0.82, 0.88, 0.94]
        };
        let is_inner = i + 1 == f.axis_arcs.len();
        let on = |place: &Place, is_wanted: &dyn Fn(Point, bool) -> bool| -> Vec<Leader> {
            let ends = arcs.iter().flat_map(|a| on_arc(a, place, shares, 0.0));
            ends.filter_map(|leader| {
                let outward = (leader.tip - place.origin).unit();
                let is_outward = outward.x * leader.direction.x + outward.y * leader.direction.y > 0.0;
                let cost_mm = if is_outward == is_inner { 18.0 } else { 0.0 };
                is_wanted(leader.direction, is_outward).then_some(Leader { cost_mm, ..leader })
            })
            .collect()
        };
        let leaders = match f.copies {
            None => on(&places.first, &|_, _| true),
            Some(copies) if copies.are_nested() => {
                let outside = on(&places.last, &|_, is_outward| is_outward);
                [on(&places.first, &|_, is_outward| !is_outward), outside].concat()
            }
            // The others stand on the right.
            Some(_) => on(&places.first, &|direction, is_outward| !is_outward || direction.x < 0.0),
        };
        let key = format!("radius {}", words::number(radius));
        all.push(Wanted::callout(key, vec![format!("R{}", words::number(radius))], leaders));
    }
}
