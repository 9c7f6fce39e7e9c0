//! Lengths along the sides of the paper: of parts without an axis, and of blocks around an axis.

use super::dimension::Dimension;
use super::features::{Features, Slot};
use super::text::number;
use crate::contour::same;
use crate::view::Place;
use crate::{Extent, Linear};
use pinswitch_solid::mesh::Point3;
use pinswitch_solid::profile::Point2;

/// Most dimensions below the front view before its length goes above it, since another view may be below.
const MOST_BELOW: usize = 1;

/// The position of a front view, and the dimensions along its sides.
struct Frame<'a> {
    place: &'a Place,
    front: Extent,
    low: Point2,
    high: Point2,
    /// Space below and above the view, mm.
    room_mm: [f64; 2],
    all: Vec<Dimension>,
}

impl Frame<'_> {
    /// Adds the distance of two points along x, or along y if `upright`. It is below or left of the view, or on the other
    /// side if `is_far`.
    fn linear(
        &mut self,
        key: impl Into<String>,
        text: String,
        ends: [Point2; 2],
        upright: bool,
        is_far: bool,
    ) {
        let linear = self.measured(key.into(), text, ends, upright, is_far);
        self.all.push(Dimension::linear(linear));
    }

    /// Adds the same on the side where there is space, first the one that `is_far` names. `ends` gives the ends for a side.
    fn linear_on_a_side(
        &mut self,
        key: String,
        text: String,
        ends: impl Fn(bool) -> [Point2; 2],
        upright: bool,
        is_far: bool,
    ) {
        let on = |is_far| self.measured(key.clone(), text.clone(), ends(is_far), upright, is_far);
        let dimension = Dimension::linear(on(is_far)).or(on(!is_far));
        self.all.push(dimension);
    }

    fn measured(&self, key: String, text: String, ends: [Point2; 2], upright: bool, is_far: bool) -> Linear {
        let edge_mm = match (upright, is_far) {
            (true, true) => self.front.high.x,
            (true, false) => self.front.low.x,
            (false, true) => self.front.high.y,
            (false, false) => self.front.low.y,
        };
        let outward = if is_far { 1.0 } else { -1.0 };
        let room_mm = if upright { f64::INFINITY } else { self.room_mm[usize::from(is_far)] };
        let [from, to] = ends.map(|p| self.place.at(p));
        let ends = if upright { [from.y, to.y] } else { [from.x, to.x] };
        let clear_of = [ends[0].min(ends[1]), ends[0].max(ends[1])];
        Linear { key, text, from, to, upright, edge_mm, outward, room_mm, clear_of }
    }

    /// Adds overall length and width, in parentheses if they are auxiliary.
    fn overall(&mut self, is_auxiliary: bool) {
        let (low, high) = (self.low, self.high);
        let text = |mm: f64| if is_auxiliary { format!("({})", number(mm)) } else { number(mm) };
        let is_far = self.all.iter().filter(|d| d.is_below(self.front)).count() > MOST_BELOW;
        let ends = |is_far: bool| {
            let y = if is_far { high.y } else { low.y };
            [Point2::new(low.x, y), Point2::new(high.x, y)]
        };
        self.linear_on_a_side("length".to_owned(), text(high.x - low.x), ends, false, is_far);
        self.linear("width", text(high.y - low.y), [Point2::new(high.x, low.y), high], true, true);
    }
}

/// Returns the lengths of a part along the paper. A part with an axis is described by radii and angles. `pocket` is the name of
/// a pocket of a pattern.
pub(super) fn lengths(
    f: &Features,
    pocket: &str,
    place: &Place,
    front: Extent,
    room_mm: [f64; 2],
    (low, high): (Point3, Point3),
) -> Vec<Dimension> {
    let (low, high) = (Point2::new(low.x, low.y), Point2::new(high.x, high.y));
    let mut frame = Frame { place, front, low, high, room_mm, all: Vec::new() };
    if f.is_axial() {
        if f.block.is_some() {
            block_about_axis(&mut frame);
        }
    } else if f.is_block() {
        block(f, &mut frame);
    } else if f.has_hole_table() {
        // The arcs of the outline and the places of the holes give the lengths of a plate.
        frame.overall(true);
    } else if !f.is_round_body() {
        rows(f, &mut frame);
        frame.overall(false);
    }
    pattern(f, pocket, &mut frame);
    frame.all
}

/// Everything on a block: from its left side, and across its middle line where both sides are equal.
fn block(f: &Features, frame: &mut Frame<'_>) {
    let corners = f.straight.iter().flat_map(|(a, b)| [*a, *b]);
    let points: Vec<Point2> = corners.chain(f.bores.iter().flat_map(|b| b.centres.clone())).collect();
    let (low, high) = (frame.low, frame.high);
    let mut xs: Vec<f64> = points.iter().map(|p| p.x).filter(|x| !same(*x, low.x)).collect();
    xs.sort_by(f64::total_cmp);
    xs.dedup_by(|a, b| same(*a, *b));
    // Below and above in turn, so that all find space.
    for (i, x) in xs.iter().filter(|x| !same(**x, high.x)).enumerate() {
        let ends = |is_far: bool| {
            let ys = points.iter().filter(|p| same(p.x, *x)).map(|p| p.y);
            let y =
                if is_far { ys.fold(f64::NEG_INFINITY, f64::max) } else { ys.fold(f64::INFINITY, f64::min) };
            [Point2::new(low.x, if is_far { high.y } else { low.y }), Point2::new(*x, y)]
        };
        let text = number(x - low.x);
        frame.linear_on_a_side(format!("from the left side, {text}"), text, ends, false, i % 2 == 1);
    }
    let middle = f64::midpoint(low.y, high.y);
    let is_paired = |p: &Point2| points.iter().any(|q| same(p.x, q.x) && same(q.y - middle, middle - p.y));
    let mut above: Vec<Point2> = points.iter().copied().filter(|p| p.y > middle || !is_paired(p)).collect();
    // Of points at one height, the nearest to the side of the dimension.
    above.sort_by(|a, b| b.x.total_cmp(&a.x));
    above.sort_by(|a, b| a.y.total_cmp(&b.y));
    above.dedup_by(|a, b| same(a.y, b.y));
    for (i, p) in above.iter().filter(|p| !same(p.y, high.y) && !same(p.y, low.y)).enumerate() {
        if is_paired(p) {
            let text = number(2.0 * (p.y - middle));
            let ends = |is_far: bool| {
                let at_height = points.iter().filter(|q| same(q.y, p.y)).map(|q| q.x);
                let x = if is_far {
                    at_height.fold(f64::NEG_INFINITY, f64::max)
                } else {
                    at_height.fold(f64::INFINITY, f64::min)
                };
                [Point2::new(x, 2.0 * middle - p.y), Point2::new(x, p.y)]
            };
            frame.linear_on_a_side(format!("across the middle, {text}"), text, ends, true, i % 2 == 0);
        } else {
            let text = number(p.y - low.y);
            let ends = [Point2::new(p.x, low.y), *p];
            frame.linear(format!("from the lower side, {text}"), text, ends, true, false);
        }
    }
    frame.overall(false);
}

/// A block that contains something about the axis: its sides are measured from the axis.
fn block_about_axis(frame: &mut Frame<'_>) {
    let (low, high) = (frame.low, frame.high);
    frame.overall(false);
    let text = number(low.y.abs());
    frame.linear("lower side from the axis", text, [Point2::origin(), low], true, false);
    if !same(low.x, -high.x) {
        let text = number(low.x.abs());
        frame.linear("left side from the axis", text, [low, Point2::origin()], false, false);
    }
}

/// The steps of a pattern of pockets.
fn pattern(f: &Features, pocket: &str, frame: &mut Frame<'_>) {
    let Some(pattern) = f.pattern else { return };
    let steps = pattern.number - 1;
    // An upright pattern is measured at the outermost corners: nothing is between them and the dimension.
    let corners = f.ends.iter().flat_map(|e| e.lines.iter().flat_map(|(a, b)| [*a, *b]));
    let outermost = corners.max_by(|a, b| a.x.total_cmp(&b.x));
    let first = outermost.filter(|_| pattern.is_upright()).unwrap_or_else(Point2::origin);
    let last = first + pattern.extent();
    for (upright, step, word) in [(false, pattern.step.x, "along"), (true, pattern.step.y, "across")] {
        if !same(step, 0.0) {
            let (step, steps) = (step.abs(), steps as f64);
            let text = if steps > 1.0 {
                format!("{steps} \u{d7} {} = {}", number(step), number(steps * step))
            } else {
                number(step)
            };
            // Dimensions from the axis are on the left.
            frame.linear(format!("{pocket} pitch {word}"), text, [first, last], upright, upright);
        }
    }
}

/// Rows of slots and grooves: the first from the corner, the others from the first.
fn rows(f: &Features, frame: &mut Frame<'_>) {
    let (corner, high) = (frame.low, frame.high);
    let middle = |s: &(Point2, Point2)| nalgebra::center(&s.0, &s.1);
    let slots: Vec<Point2> = f.slots.iter().flat_map(|s: &Slot| s.places.iter().map(middle)).collect();
    let half_rounds = f.roundings.iter().filter(|r| r.is_half_round);
    let grooves = half_rounds.flat_map(|r| r.arcs.iter().map(|a| a.centre)).collect();
    for (word, mut points) in [("slots", slots), ("grooves", grooves)] {
        points.sort_by(|a, b| a.x.total_cmp(&b.x));
        let (Some(first), Some(last)) = (points.first().copied(), points.last().copied()) else { continue };
        // Above: below the slots, extension lines would cross engravings.
        let from = |p: Point2| [Point2::new(corner.x, p.y), p];
        frame.linear(format!("first of the {word}"), number(first.x - corner.x), from(first), false, true);
        let steps = points.len() - 1;
        let step = points.get(1).map_or(0.0, |p| p.x - first.x);
        if steps > 1 && points.windows(2).all(|w| same(w[1].x - w[0].x, step)) {
            let text = format!("{steps} \u{d7} {} = {}", number(step), number(last.x - first.x));
            frame.linear(format!("pitch of the {word}"), text, [first, last], false, true);
        } else {
            for (i, p) in points.iter().enumerate().skip(1) {
                let key = format!("{word} {}", i + 1);
                frame.linear(key, number(p.x - corner.x), from(*p), false, true);
            }
        }
        if !same(first.y, high.y) {
            let key = format!("level of the {word}");
            frame.linear(key, number(first.y - corner.y), [corner, first], true, false);
        }
    }
}
