//! What a solid has that is dimensioned: radii about the axis, bores, pegs, slots, grooves, ends and heights.
//!
//! They are found in the contours of the exact solid, so that a part that nobody has drawn yet has its dimensions, too.

use pinswitch_friction::sort_by_number;

use super::bore::{Bore, add_stage, gathered};
use super::chains::{Chain, chains};
use pinswitch_solid::profile::{Arc, Contour, Edge, Point2, Vector2};
use pinswitch_solid::solid::Solid;
use std::f64::consts::PI;

/// Contours of lines alone with more corners than this are letters.
const MOST_CORNERS: usize = 12;
/// What is nearer than this is the same, mm.
const SAME_MM: f64 = 1e-6;
/// Half-round grooves and ribs turn by more than this, and meet their neighbours at an edge; corners do not.
const HALF_ROUND_RAD: f64 = 2.2;

/// Which rings of a solid are outlines of engraved letters, or of islands in them.
pub(super) fn lettering(solid: &Solid) -> Vec<bool> {
    let rings: Vec<&Contour> = solid.rings().map(|(contour, _)| contour).collect();
    let is_straight = |c: &Contour| c.edges().iter().all(|e| matches!(e, Edge::Line));
    let is_letter = |c: &Contour| c.edges().len() > MOST_CORNERS && is_straight(c);
    let letters: Vec<_> = rings.iter().filter(|c| is_letter(c)).map(|c| c.bounds()).collect();
    rings
        .iter()
        .map(|contour| {
            let (low, high) = contour.bounds();
            let lies_in =
                |(a, b): &(Point2, Point2)| a.x < low.x && a.y < low.y && high.x < b.x && high.y < b.y;
            is_letter(contour) || (is_straight(contour) && letters.iter().any(lies_in))
        })
        .collect()
}

/// Whether two lengths or angles are the same.
pub(super) fn same(a: f64, b: f64) -> bool {
    (a - b).abs() < SAME_MM
}

/// A peg or a rim: radii at heights, from below.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Round {
    pub(super) centres: Vec<Point2>,
    pub(super) levels: Vec<(f64, f64)>,
}

/// Hollows that are there more than once, all alike, each a step from the one before: the basins of a gang mould.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Copies {
    pub(super) number: usize,
    pub(super) step: Vector2,
}

/// Slots with round ends, all alike.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Slot {
    /// Centres of both round ends of each; the first lies farther from the axis.
    pub(super) places: Vec<(Point2, Point2)>,
    pub(super) width_mm: f64,
    pub(super) depth_mm: f64,
    pub(super) is_blind: bool,
}

impl Copies {
    /// From the first to the last.
    pub(super) fn reach(&self) -> Vector2 {
        self.step * (self.number - 1) as f64
    }

    /// Whether each lies in the bow of the one before it, and not beside it.
    pub(super) fn are_nested(&self) -> bool {
        same(self.step.x, 0.0)
    }
}

impl Slot {
    /// Distance of the centres of its ends.
    pub(super) fn travel_mm(&self) -> f64 {
        self.places.first().map_or(0.0, |(a, b)| (a - b).norm())
    }
}

/// A slot along an arc about the axis, at its lower and its upper end.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ArcSlot {
    pub(super) radius_mm: f64,
    pub(super) half_rad: f64,
    pub(super) widths_mm: (f64, f64),
    pub(super) edge: Arc,
}

/// Pieces of one ring, such as those of a lip.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Pieces {
    pub(super) inner_mm: f64,
    pub(super) outer_mm: f64,
    pub(super) heights_mm: (f64, f64),
    /// First and last angle of each.
    pub(super) spans_rad: Vec<(f64, f64)>,
}

/// Arcs of one radius that are not about the axis.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Rounding {
    pub(super) radius_mm: f64,
    pub(super) arcs: Vec<Arc>,
    /// Grooves and ribs, which are half round; otherwise rounded corners.
    pub(super) is_half_round: bool,
    /// A rib stands out of the material, a groove is sunk into it.
    pub(super) is_rib: bool,
}

/// Ends of sectors: lines that are parallel to a plane through the axis.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Ends {
    /// Distance from that plane, mm.
    pub(super) shift_mm: f64,
    /// Both ends of each line.
    pub(super) lines: Vec<(Point2, Point2)>,
}

/// All of them.
#[derive(Clone, Debug, Default)]
pub(super) struct Features {
    /// Arcs about the axis, one list per radius, the largest radius first.
    pub(super) axis_arcs: Vec<Vec<Arc>>,
    pub(super) rounds: Vec<Round>,
    pub(super) bores: Vec<Bore>,
    pub(super) slots: Vec<Slot>,
    pub(super) arc_slots: Vec<ArcSlot>,
    pub(super) pieces: Vec<Pieces>,
    pub(super) roundings: Vec<Rounding>,
    pub(super) ends: Vec<Ends>,
    /// Straight edges that are no such ends.
    pub(super) straight: Vec<(Point2, Point2)>,
    /// Opposite corners of an outline that is a rectangle along the paper.
    pub(super) block: Option<(Point2, Point2)>,
    pub(super) copies: Option<Copies>,
    /// Heights over the bottom at which the body's own walls begin or end, ascending, without 0.
    pub(super) heights_mm: Vec<f64>,
}

/// The features of `solid`, whose bottom edges have a chamfer of `chamfer_mm` and whose ends are parallel to the planes at
/// plus and minus `half_span_rad`.
pub(super) fn features(solid: &Solid, chamfer_mm: f64, half_span_rad: f64) -> Features {
    let mut all = Features::default();
    let bottom = solid.bounds().map_or(0.0, |(low, _)| low.z);
    let mut pieces: Vec<(&Contour, (f64, f64))> = Vec::new();
    let mut heights = Vec::new();
    let mut axes: Vec<Bore> = Vec::new();
    // Hollows that were seen, which others may be copies of.
    let mut hollows: Vec<Chain<'_>> = Vec::new();
    for chain in chains(solid, chamfer_mm).into_iter().filter(|c| !c.is_lettering) {
        let (first, last) = (chain.rings[0], chain.rings[chain.rings.len() - 1]);
        let is_hole = chain.is_hole();
        if let Some((centre, stage)) = chain.stage() {
            add_stage(&mut axes, centre, stage);
        } else if let Some((centre, _)) = circle(first.0) {
            let radius = |c: &Contour| circle(c).map_or(0.0, |(_, r)| r);
            let levels: Vec<(f64, f64)> = chain.rings.iter().map(|(c, z)| (*z, radius(c))).collect();
            if same(chain.foot_mm, bottom) {
                heights.extend(levels.iter().skip(1).map(|l| l.0));
            }
            all.add_round(Round { centres: vec![centre], levels });
        } else if let Some((a, b, radius)) = slot(first.0) {
            all.add_slot(a, b, 2.0 * radius, last.1 - first.1, chain.is_blind());
        } else if let (Some(low), Some(high)) = (arc_slot(first.0), arc_slot(last.0)) {
            all.arc_slots.push(ArcSlot { widths_mm: (low.widths_mm.0, high.widths_mm.0), ..low });
        } else if let (true, Some(by)) = (is_hole, hollows.iter().find_map(|h| chain.moved_from(h))) {
            all.add_copy(by);
        } else {
            // Of the body itself, what begins on the bed is no height.
            let from_bed = usize::from(same(chain.foot_mm, bottom));
            heights.extend(chain.rings.iter().skip(from_bed).map(|r| r.1));
            if piece(first.0).is_some() && !is_hole && !same(chain.foot_mm, bottom) {
                pieces.push((first.0, (first.1, last.1)));
            } else {
                for (contour, _) in &chain.rings {
                    all.add_outline(contour, half_span_rad);
                }
                all.block = all.block.or_else(|| rectangle(first.0).filter(|_| !is_hole));
            }
            if is_hole {
                hollows.push(chain);
            }
        }
    }
    all.bores = gathered(axes);
    for (contour, z) in &pieces {
        // One piece alone is a body of its own.
        if pieces.len() > 1 { all.add_piece(contour, *z) } else { all.add_outline(contour, half_span_rad) }
    }
    sort_by_number(&mut all.axis_arcs, |arcs| -arcs[0].radius_mm);
    heights.retain(|z| !same(*z, bottom));
    heights.sort_by(f64::total_cmp);
    heights.dedup_by(|a, b| same(*a, *b));
    all.heights_mm = heights.into_iter().map(|z| z - bottom).collect();
    all
}

/// Centre and radius of a contour that is a whole circle.
pub(super) fn circle(contour: &Contour) -> Option<(Point2, f64)> {
    let mut arcs = contour.edges().iter().map(|e| if let Edge::Arc(a) = e { Some(a) } else { None });
    match (arcs.next()?, arcs.next()?, arcs.next()) {
        (Some(a), Some(b), None) if (a.centre - b.centre).norm() < SAME_MM => Some((a.centre, a.radius_mm)),
        _ => None,
    }
}

/// Centres of the ends, the one farther from the axis first, and their radius, of a straight slot with round ends.
fn slot(contour: &Contour) -> Option<(Point2, Point2, f64)> {
    let arcs: Vec<&Arc> =
        contour.edges().iter().filter_map(|e| if let Edge::Arc(a) = e { Some(a) } else { None }).collect();
    let [a, b] = arcs[..] else { return None };
    let is_slot = contour.edges().len() == 4
        && same(a.radius_mm, b.radius_mm)
        && [a, b].iter().all(|arc| (arc.sweep_rad.abs() - PI).abs() < 1e-6);
    let far_first = a.centre.coords.norm() >= b.centre.coords.norm();
    let (far, near) = if far_first { (a.centre, b.centre) } else { (b.centre, a.centre) };
    is_slot.then_some((far, near, a.radius_mm))
}

/// A slot along an arc about the axis, both widths as this contour has them.
fn arc_slot(contour: &Contour) -> Option<ArcSlot> {
    let arcs: Vec<&Arc> =
        contour.edges().iter().filter_map(|e| if let Edge::Arc(a) = e { Some(a) } else { None }).collect();
    let (sides, caps): (Vec<&Arc>, Vec<&Arc>) = arcs.iter().partition(|a| a.centre.coords.norm() < SAME_MM);
    let ([a, b], [cap, _], 4) = (&sides[..], &caps[..], contour.edges().len()) else { return None };
    let outer = if a.radius_mm > b.radius_mm { a } else { b };
    Some(ArcSlot {
        radius_mm: cap.centre.coords.norm(),
        half_rad: libm::asin((cap.centre.x / cap.centre.coords.norm()).abs()),
        widths_mm: ((a.radius_mm - b.radius_mm).abs(), (a.radius_mm - b.radius_mm).abs()),
        edge: **outer,
    })
}

/// Inner and outer radius and both angles of a piece of a ring about the axis.
fn piece(contour: &Contour) -> Option<(f64, f64, f64, f64)> {
    let arcs: Vec<&Arc> =
        contour.edges().iter().filter_map(|e| if let Edge::Arc(a) = e { Some(a) } else { None }).collect();
    let [a, b] = arcs[..] else { return None };
    if contour.edges().len() != 4 || [a, b].iter().any(|arc| arc.centre.coords.norm() > SAME_MM) {
        return None;
    }
    let (inner, outer) = (a.radius_mm.min(b.radius_mm), a.radius_mm.max(b.radius_mm));
    let angles: Vec<f64> = contour
        .corners()
        .iter()
        .filter(|p| (p.coords.norm() - inner).abs() < SAME_MM)
        .map(|p| libm::atan2(p.x, p.y))
        .collect();
    let (from, to) =
        angles.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), a| (l.min(*a), h.max(*a)));
    Some((inner, outer, from, to))
}

/// Opposite corners of a rectangle along the paper.
fn rectangle(contour: &Contour) -> Option<(Point2, Point2)> {
    let is_straight = contour.edges().len() == 4
        && (0..4).all(|i| {
            let (from, to) = contour.ends(i);
            matches!(contour.edges()[i], Edge::Line) && (same(from.x, to.x) || same(from.y, to.y))
        });
    is_straight.then(|| contour.bounds())
}

/// Where an edge goes, at its beginning and at its end: unit vectors.
fn directions(contour: &Contour, i: usize) -> [Vector2; 2] {
    let (from, to) = contour.ends(i);
    match contour.edges()[i] {
        Edge::Line => [(to - from).normalize(); 2],
        Edge::Arc(arc) => [from, to].map(|p| {
            let out = (p - arc.centre).normalize() * arc.sweep_rad.signum();
            Vector2::new(-out.y, out.x)
        }),
    }
}

/// Whether an edge passes into both of its neighbours without a corner.
fn is_smooth(contour: &Contour, i: usize) -> bool {
    let n = contour.edges().len();
    let [begins, ends] = directions(contour, i);
    let (before, after) = (directions(contour, (i + n - 1) % n)[1], directions(contour, (i + 1) % n)[0]);
    (begins - before).norm() < 1e-6 && (ends - after).norm() < 1e-6
}

impl Features {
    /// Whether the part is round itself: diameters and heights say it all.
    pub(super) fn is_round_body(&self) -> bool {
        self.rounds.iter().any(|r| r.centres.len() == 1)
            && self.slots.is_empty()
            && self.roundings.is_empty()
            && self.axis_arcs.is_empty()
    }

    /// Another hollow, `by` that far from the first of its kind: the nearest tells the step.
    fn add_copy(&mut self, by: Vector2) {
        let copies = self.copies.get_or_insert(Copies { number: 1, step: by });
        if by.norm() < copies.step.norm() - SAME_MM {
            copies.step = by;
        }
        let steps = (by.norm() / copies.step.norm()).round() as usize;
        copies.number = copies.number.max(steps + 1);
    }

    fn add_round(&mut self, round: Round) {
        let alike = self.rounds.iter_mut().find(|other| {
            other.levels.len() == round.levels.len()
                && other.levels.iter().zip(&round.levels).all(|(a, b)| same(a.0, b.0) && same(a.1, b.1))
        });
        match alike {
            Some(other) => other.centres.extend(round.centres),
            None => self.rounds.push(round),
        }
    }

    fn add_slot(&mut self, far: Point2, near: Point2, width_mm: f64, depth_mm: f64, is_blind: bool) {
        let travel = (far - near).norm();
        let alike = self.slots.iter_mut().find(|s| {
            same(s.width_mm, width_mm)
                && same(s.depth_mm, depth_mm)
                && s.is_blind == is_blind
                && same(s.travel_mm(), travel)
        });
        match alike {
            Some(slot) => slot.places.push((far, near)),
            None => self.slots.push(Slot { places: vec![(far, near)], width_mm, depth_mm, is_blind }),
        }
    }

    fn add_piece(&mut self, contour: &Contour, heights_mm: (f64, f64)) {
        let Some((inner_mm, outer_mm, from, to)) = piece(contour) else { return };
        let alike = self.pieces.iter_mut().find(|p| {
            same(p.inner_mm, inner_mm) && same(p.outer_mm, outer_mm) && same(p.heights_mm.1, heights_mm.1)
        });
        match alike {
            Some(pieces) => pieces.spans_rad.push((from, to)),
            None => self.pieces.push(Pieces { inner_mm, outer_mm, heights_mm, spans_rad: vec![(from, to)] }),
        }
    }

    fn add_outline(&mut self, contour: &Contour, half_span_rad: f64) {
        for (i, edge) in contour.edges().iter().enumerate() {
            match edge {
                Edge::Arc(arc) if arc.centre.coords.norm() < SAME_MM => self.add_axis_arc(*arc),
                Edge::Arc(arc) => self.add_rounding(*arc, is_smooth(contour, i)),
                Edge::Line => self.add_end(contour.ends(i), half_span_rad),
            }
        }
    }

    fn add_axis_arc(&mut self, arc: Arc) {
        match self.axis_arcs.iter_mut().find(|all| same(all[0].radius_mm, arc.radius_mm)) {
            Some(all) => all.push(arc),
            None => self.axis_arcs.push(vec![arc]),
        }
    }

    fn add_rounding(&mut self, arc: Arc, is_smooth: bool) {
        let is_half_round = arc.sweep_rad.abs() > HALF_ROUND_RAD && !is_smooth;
        // Material lies to the left: an arc that turns left bulges out of it.
        let is_rib = is_half_round && arc.sweep_rad > 0.0;
        let alike = self.roundings.iter_mut().find(|r| {
            same(r.radius_mm, arc.radius_mm) && r.is_half_round == is_half_round && r.is_rib == is_rib
        });
        match alike {
            Some(r) if r.arcs.iter().any(|a| (a.centre - arc.centre).norm() < SAME_MM) => {}
            Some(r) => r.arcs.push(arc),
            None => {
                self.roundings.push(Rounding {
                    radius_mm: arc.radius_mm,
                    arcs: vec![arc],
                    is_half_round,
                    is_rib,
                });
            }
        }
    }

    fn add_end(&mut self, (from, to): (Point2, Point2), half_span_rad: f64) {
        let along = (to - from).normalize();
        let is_end = [half_span_rad, -half_span_rad]
            .iter()
            .any(|a| (along.x * libm::cos(*a) - along.y * libm::sin(*a)).abs() < 1e-6);
        if !is_end {
            self.straight.push((from, to));
            return;
        }
        let shift_mm = (from.x * along.y - from.y * along.x).abs();
        match self.ends.iter_mut().find(|e| same(e.shift_mm, shift_mm)) {
            Some(ends) if ends.lines.iter().any(|l| (l.0 - from).norm() + (l.1 - to).norm() < SAME_MM) => {}
            Some(ends) => ends.lines.push((from, to)),
            None => self.ends.push(Ends { shift_mm, lines: vec![(from, to)] }),
        }
    }
}
