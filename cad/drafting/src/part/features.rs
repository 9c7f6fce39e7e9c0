//! Features of a solid that are dimensioned: radii about the axis, bores, bosses, slots, grooves, ends and heights.
//!
//! They are recognised in the contours of the exact solid.

use super::bore::{Bore, add_stage, joined};
use super::chains::{Chain, chains};
use crate::contour::{arc_slot, is_about_axis, is_smooth, rectangle, ring_segment, same, same_point, slot};
use pinswitch_solid::profile::{Arc, Contour, Edge, Point2, Vector2};
use pinswitch_solid::solid::Solid;

/// Grooves and ribs sweep a greater angle than this and meet their neighbours at an edge; rounded corners do not.
const HALF_ROUND_RAD: f64 = 2.2;

/// A round boss, or the rim of a round part: height and radius in mm at each ring, from below.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Boss {
    /// Centres of all equal ones.
    pub(crate) centres: Vec<Point2>,
    pub(crate) levels: Vec<(f64, f64)>,
}

/// A linear pattern of equal pockets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Pattern {
    pub(crate) number: usize,
    /// From each to the next.
    pub(crate) step: Vector2,
}

/// Equal slots with round ends.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Slot {
    /// Centres of both ends of each, the one farther from the axis first.
    pub(crate) places: Vec<(Point2, Point2)>,
    pub(crate) width_mm: f64,
    pub(crate) depth_mm: f64,
    pub(crate) is_blind: bool,
}

impl Pattern {
    /// From the first to the last.
    pub(crate) fn extent(&self) -> Vector2 {
        self.step * (self.number - 1) as f64
    }

    /// Whether it runs along y.
    pub(crate) fn is_upright(&self) -> bool {
        same(self.step.x, 0.0)
    }
}

impl Slot {
    /// Distance of the centres of both ends.
    pub(crate) fn travel_mm(&self) -> f64 {
        self.places.first().map_or(0.0, |(a, b)| (a - b).norm())
    }
}

/// A slot along an arc about the axis.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ArcSlot {
    pub(crate) radius_mm: f64,
    /// Half of the angle between the centres of its ends.
    pub(crate) half_rad: f64,
    /// At the lower and at the upper end.
    pub(crate) widths_mm: (f64, f64),
    pub(crate) outer_edge: Arc,
}

/// Segments of one ring about the axis, such as those of a lip.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Segments {
    pub(crate) inner_mm: f64,
    pub(crate) outer_mm: f64,
    pub(crate) heights_mm: (f64, f64),
    /// First and last angle of each.
    pub(crate) spans_rad: Vec<(f64, f64)>,
}

/// Arcs of one radius that are not about the axis.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Rounding {
    pub(crate) radius_mm: f64,
    pub(crate) arcs: Vec<Arc>,
    /// Whether they are grooves or ribs, and not rounded corners.
    pub(crate) is_half_round: bool,
    /// Whether they are ribs, and not grooves.
    pub(crate) is_rib: bool,
}

/// Ends of a sector about the axis: lines parallel to a plane through the axis.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Ends {
    /// Distance from that plane, mm.
    pub(crate) shift_mm: f64,
    /// Both ends of each line.
    pub(crate) lines: Vec<(Point2, Point2)>,
}

/// The features of a solid.
#[derive(Clone, Debug, Default)]
pub(crate) struct Features {
    /// Arcs about the axis, one list for each radius, the largest radius first.
    pub(crate) axis_arcs: Vec<Vec<Arc>>,
    pub(crate) bosses: Vec<Boss>,
    pub(crate) bores: Vec<Bore>,
    pub(crate) slots: Vec<Slot>,
    pub(crate) arc_slots: Vec<ArcSlot>,
    pub(crate) segments: Vec<Segments>,
    pub(crate) roundings: Vec<Rounding>,
    pub(crate) ends: Vec<Ends>,
    /// Straight edges that are not ends of a sector.
    pub(crate) straight: Vec<(Point2, Point2)>,
    /// Opposite corners of a rectangular outline.
    pub(crate) block: Option<(Point2, Point2)>,
    /// Whether the outline has a corner.
    pub(crate) has_corners: bool,
    pub(crate) pattern: Option<Pattern>,
    /// Heights over the bottom of the ends of the outer walls, mm, ascending, without 0.
    pub(crate) heights_mm: Vec<f64>,
}

impl Features {
    /// Recognises the features of a solid whose bottom edges have a chamfer of `chamfer_mm`. Ends of a sector are parallel to
    /// the planes at plus and minus `half_span_rad`, from +y.
    pub(crate) fn new(solid: &Solid, chamfer_mm: f64, half_span_rad: Option<f64>) -> Self {
        let mut all = Self::default();
        let bottom = solid.bounds().map_or(0.0, |(low, _)| low.z);
        let mut segments: Vec<(&Contour, (f64, f64))> = Vec::new();
        let mut heights = Vec::new();
        let mut axes: Vec<Bore> = Vec::new();
        // Pockets that others may be copies of.
        let mut pockets: Vec<Chain<'_>> = Vec::new();
        for chain in chains(solid, chamfer_mm).into_iter().filter(|c| !c.is_lettering) {
            let (first, last) = (chain.rings[0], chain.rings[chain.rings.len() - 1]);
            let is_hole = chain.is_hole();
            if let Some((centre, stage)) = chain.stage() {
                add_stage(&mut axes, centre, stage);
            } else if let Some((centre, levels)) = chain.boss() {
                if same(chain.foot_mm, bottom) {
                    heights.extend(levels.iter().skip(1).map(|l| l.0));
                }
                all.add_boss(Boss { centres: vec![centre], levels });
            } else if let Some((a, b, radius)) = slot(first.0) {
                all.add_slot(a, b, 2.0 * radius, last.1 - first.1, chain.is_blind());
            } else if let (Some(low), Some(high)) = (arc_slot(first.0), arc_slot(last.0)) {
                all.arc_slots.push(ArcSlot {
                    radius_mm: low.radius_mm,
                    half_rad: low.half_rad,
                    widths_mm: (low.width_mm, high.width_mm),
                    outer_edge: low.outer_edge,
                });
            } else if let (true, Some(by)) = (is_hole, pockets.iter().find_map(|p| chain.displacement(p))) {
                all.add_copy(by);
            } else {
                // The bottom of the body is not a height.
                let from_bottom = usize::from(same(chain.foot_mm, bottom));
                heights.extend(chain.rings.iter().skip(from_bottom).map(|r| r.1));
                if ring_segment(first.0).is_some() && !is_hole && !same(chain.foot_mm, bottom) {
                    segments.push((first.0, (first.1, last.1)));
                } else {
                    for (contour, _) in &chain.rings {
                        all.add_outline(contour, half_span_rad);
                    }
                    all.block = all.block.or_else(|| rectangle(first.0).filter(|_| !is_hole));
                    let edges = first.0.edges().len();
                    all.has_corners |= !is_hole && (0..edges).any(|i| !is_smooth(first.0, i));
                }
                if is_hole {
                    pockets.push(chain);
                }
            }
        }
        all.bores = joined(axes);
        for (contour, z) in &segments {
            // A single segment is a body of its own.
            if segments.len() > 1 {
                all.add_segment(contour, *z);
            } else {
                all.add_outline(contour, half_span_rad);
            }
        }
        all.axis_arcs.sort_by(|a, b| b[0].radius_mm.total_cmp(&a[0].radius_mm));
        heights.retain(|z| !same(*z, bottom));
        heights.sort_by(f64::total_cmp);
        heights.dedup_by(|a, b| same(*a, *b));
        all.heights_mm = heights.into_iter().map(|z| z - bottom).collect();
        all
    }

    /// Whether diameters and heights describe the whole part.
    pub(crate) fn is_round_body(&self) -> bool {
        self.bosses.iter().any(|b| b.centres.len() == 1)
            && self.slots.is_empty()
            && self.roundings.is_empty()
            && self.axis_arcs.is_empty()
    }

    /// Whether the part has an axis: its radii and angles are about the origin.
    pub(crate) fn is_axial(&self) -> bool {
        !self.axis_arcs.is_empty()
    }

    /// Whether the corners of the outline are dimensioned from its sides: a rectangle, or any other shape with corners that
    /// is not a strip of slots and grooves.
    pub(crate) fn is_block(&self) -> bool {
        let is_strip = !self.slots.is_empty() || self.roundings.iter().any(|r| r.is_half_round);
        !self.is_axial() && (self.block.is_some() || (self.has_corners && !is_strip && !self.is_round_body()))
    }

    /// Whether holes have no other reference than each other: their places are in a table.
    pub(crate) fn has_hole_table(&self) -> bool {
        !self.is_axial() && !self.is_block() && !self.is_round_body() && !self.bores.is_empty()
    }

    /// Adds a pocket, `by` that far from the first of its kind: the nearest gives the step.
    fn add_copy(&mut self, by: Vector2) {
        let pattern = self.pattern.get_or_insert(Pattern { number: 1, step: by });
        if by.norm() < pattern.step.norm() - 1e-6 {
            pattern.step = by;
        }
        let steps = (by.norm() / pattern.step.norm()).round() as usize;
        pattern.number = pattern.number.max(steps + 1);
    }

    fn add_boss(&mut self, boss: Boss) {
        let equal = self.bosses.iter_mut().find(|other| {
            other.levels.len() == boss.levels.len()
                && other.levels.iter().zip(&boss.levels).all(|(a, b)| same(a.0, b.0) && same(a.1, b.1))
        });
        match equal {
            Some(other) => other.centres.extend(boss.centres),
            None => self.bosses.push(boss),
        }
    }

    fn add_slot(&mut self, far: Point2, near: Point2, width_mm: f64, depth_mm: f64, is_blind: bool) {
        let travel = (far - near).norm();
        let equal = self.slots.iter_mut().find(|s| {
            same(s.width_mm, width_mm)
                && same(s.depth_mm, depth_mm)
                && s.is_blind == is_blind
                && same(s.travel_mm(), travel)
        });
        match equal {
            Some(slot) => slot.places.push((far, near)),
            None => self.slots.push(Slot { places: vec![(far, near)], width_mm, depth_mm, is_blind }),
        }
    }

    fn add_segment(&mut self, contour: &Contour, heights_mm: (f64, f64)) {
        let Some((inner_mm, outer_mm, from, to)) = ring_segment(contour) else { return };
        let of_ring = self.segments.iter_mut().find(|s| {
            same(s.inner_mm, inner_mm) && same(s.outer_mm, outer_mm) && same(s.heights_mm.1, heights_mm.1)
        });
        match of_ring {
            Some(segments) => segments.spans_rad.push((from, to)),
            None => {
                let spans_rad = vec![(from, to)];
                self.segments.push(Segments { inner_mm, outer_mm, heights_mm, spans_rad });
            }
        }
    }

    fn add_outline(&mut self, contour: &Contour, half_span_rad: Option<f64>) {
        for (i, edge) in contour.edges().iter().enumerate() {
            match edge {
                Edge::Arc(arc) if is_about_axis(arc) => self.add_axis_arc(*arc),
                Edge::Arc(arc) => self.add_rounding(*arc, is_smooth(contour, i)),
                Edge::Line => self.add_line(contour.ends(i), half_span_rad),
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
        // Material is on the left: an arc that turns left bulges out of it.
        let is_rib = is_half_round && arc.sweep_rad > 0.0;
        let of_radius = self.roundings.iter_mut().find(|r| {
            same(r.radius_mm, arc.radius_mm) && r.is_half_round == is_half_round && r.is_rib == is_rib
        });
        match of_radius {
            Some(r) if r.arcs.iter().any(|a| same_point(a.centre, arc.centre)) => {}
            Some(r) => r.arcs.push(arc),
            None => {
                let arcs = vec![arc];
                self.roundings.push(Rounding { radius_mm: arc.radius_mm, arcs, is_half_round, is_rib });
            }
        }
    }

    fn add_line(&mut self, (from, to): (Point2, Point2), half_span_rad: Option<f64>) {
        let along = (to - from).normalize();
        let is_parallel = |a: f64| same(along.x * libm::cos(a) - along.y * libm::sin(a), 0.0);
        if !half_span_rad.is_some_and(|a| is_parallel(a) || is_parallel(-a)) {
            self.straight.push((from, to));
            return;
        }
        let shift_mm = (from.x * along.y - from.y * along.x).abs();
        match self.ends.iter_mut().find(|e| same(e.shift_mm, shift_mm)) {
            Some(ends) if ends.lines.iter().any(|l| same((l.0 - from).norm() + (l.1 - to).norm(), 0.0)) => {}
            Some(ends) => ends.lines.push((from, to)),
            None => self.ends.push(Ends { shift_mm, lines: vec![(from, to)] }),
        }
    }
}
