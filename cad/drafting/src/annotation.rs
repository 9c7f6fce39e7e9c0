//! Dimensions, callouts, labels, titles and notes. Each has many candidate positions, and takes the cheapest one that
//! touches nothing.

use std::f64::consts::{FRAC_PI_2, TAU};

use super::draft::{Candidate, Draft, Shapes};
use super::font::{fit_text, text_width_mm};
use super::geometry::{Extent, Point};
use super::indicator::{INDICATOR_MM, Indicator, datum, rectangle};
use super::sheet::{ARROW_MM, Layer, Shape, Text};

/// Height of the text of dimensions, mm (ISO 3098).
pub(super) const TEXT_MM: f64 = 2.5;
/// Distance of the lines of a note, mm.
const LINE_MM: f64 = 4.2;
/// Distance of an indicator from the baseline above it, mm.
const BELOW_TEXT_MM: f64 = 1.6;
/// Length of the stem of a datum below a callout, mm.
const DATUM_STEM_MM: f64 = 1.5;
/// Distance of the frame around a theoretically exact dimension from its text, mm.
const EXACT_MM: f64 = 0.8;
/// Distance of an extension line from its edge, mm.
const EXTENSION_GAP_MM: f64 = 0.8;
/// Length of an extension line beyond the dimension line, mm.
const EXTENSION_MM: f64 = 1.5;
/// Distance of the first dimension line from its view, mm.
const FIRST_TIER_MM: f64 = 7.0;
/// Distance of dimension lines, mm.
const TIER_MM: f64 = 6.0;
/// Distance of the arcs of angles, mm: horizontal text reaches beyond its arc.
const ARC_TIER_MM: f64 = 8.0;
/// Least radius of the arc of an angle, mm.
const LEAST_ARC_MM: f64 = 5.0;
/// Number of dimension lines that are tried.
const TIERS: u32 = 14;
/// Least distance of a dimension line from another view.
const VIEW_GAP_MM: f64 = 2.0;

fn text(at: Point, content: &str, upright: bool) -> Shape {
    Shape::Text(Text { at, height_mm: TEXT_MM, content: content.to_owned(), upright })
}

fn line(from: Point, to: Point) -> (Layer, Shape) {
    (Layer::Dimension, Shape::Line { from, to })
}

fn arrow(tip: Point, direction: Point) -> (Layer, Shape) {
    (Layer::Dimension, Shape::Arrow { tip, direction })
}

/// The distance of two points, along x or y.
#[derive(Clone, Debug)]
pub struct Linear {
    /// What it measures.
    pub key: String,
    /// Its text.
    pub text: String,
    /// One end, on paper.
    pub from: Point,
    /// The other end.
    pub to: Point,
    /// Whether it measures along y.
    pub upright: bool,
    /// Edge of the view from which dimension lines keep their distance: x of an upright one, else y.
    pub edge_mm: f64,
    /// +1 if dimension lines are above or right of the edge, -1 below or left of it.
    pub outward: f64,
    /// Distance of another view from the edge, mm. Dimension lines keep 2 mm from it.
    pub room_mm: f64,
    /// Range along the dimension line, with extension lines of others, that a text next to the line keeps clear of.
    pub clear_of: [f64; 2],
}

impl Linear {
    /// Draws it; returns whether there was space.
    pub fn place(&self, draft: &mut Draft) -> bool {
        draft.place(&self.key, self.candidates())
    }

    fn candidates(&self) -> Vec<Candidate> {
        // As if horizontal: `along` and `level` swap for an upright dimension, whose text reads from the right.
        let along = |p: Point| if self.upright { p.y } else { p.x };
        let level = |p: Point| if self.upright { p.x } else { p.y };
        let at = |along: f64, level: f64| {
            if self.upright { Point::new(level, along) } else { Point::new(along, level) }
        };
        let (first, last) =
            if along(self.from) <= along(self.to) { (self.from, self.to) } else { (self.to, self.from) };
        let (a, b) = (along(first), along(last));
        let width = text_width_mm(&self.text, TEXT_MM);
        // Text is above its line, and left of an upright one.
        let above = if self.upright { -0.8 } else { 0.8 };
        let mut all = Vec::new();
        let has_room = |tier: &u32| FIRST_TIER_MM + TIER_MM * f64::from(*tier) + VIEW_GAP_MM <= self.room_mm;
        for tier in (0..TIERS).take_while(has_room) {
            let height = self.edge_mm + self.outward * (FIRST_TIER_MM + TIER_MM * f64::from(tier));
            let base = TIER_MM * f64::from(tier);
            let mut common = Vec::new();
            for end in [first, last] {
                let from = level(end) + (height - level(end)).signum() * EXTENSION_GAP_MM;
                common.push(line(at(along(end), from), at(along(end), height + self.outward * EXTENSION_MM)));
            }
            let fits_arrows = b - a > 2.0 * ARROW_MM + 1.0;
            let step = at(1.0, 0.0);
            if fits_arrows {
                common.push(arrow(at(a, height), step * -1.0));
                common.push(arrow(at(b, height), step));
                common.push(line(at(a, height), at(b, height)));
            } else {
                common.push(arrow(at(a, height), step));
                common.push(arrow(at(b, height), step * -1.0));
                common.push(line(at(a - 5.0, height), at(b + 5.0, height)));
            }
            if fits_arrows && b - a > width + 1.0 {
                for shift in [0.0, -0.15, 0.15, -0.25, 0.25, -0.4, 0.4] {
                    let start = f64::midpoint(a, b) - width / 2.0 + shift * (b - a - width);
                    let mut shapes = common.clone();
                    shapes.push((Layer::Text, text(at(start, height + above), &self.text, self.upright)));
                    all.push((base + shift.abs(), shapes));
                }
            }
            // Next to the arrows, on an extended line.
            for after in [true, false] {
                let [low, high] = self.clear_of;
                let start = if after { b.max(high) + 3.5 } else { a.min(low) - 3.5 - width };
                let (from, to) = if after { (b, start + width) } else { (start, a) };
                let mut shapes = common.clone();
                shapes.push(line(at(from, height), at(to, height)));
                shapes.push((Layer::Text, text(at(start, height + above), &self.text, self.upright)));
                all.push((base + if after { 5.0 } else { 5.5 }, shapes));
            }
        }
        all
    }
}

/// An angle about a centre.
#[derive(Clone, Debug)]
pub struct Angular {
    /// What it measures.
    pub key: String,
    /// Its text.
    pub text: String,
    /// Vertex of the angle, on paper.
    pub centre: Point,
    /// First side, radians counter-clockwise from +x.
    pub from_rad: f64,
    /// Last side, greater than the first.
    pub to_rad: f64,
    /// Distance of the feet of the extension lines from the vertex, mm on paper.
    pub begins_mm: f64,
    /// Distance of the edge of the view from the vertex, mm on paper: arcs are beyond it.
    pub edge_mm: f64,
    /// Whether arcs are on the side of the vertex, and not beyond the edge.
    pub is_inside: bool,
    /// Whether the angle is theoretically exact: it has a frame (ISO 1101).
    pub is_exact: bool,
}

impl Angular {
    /// Draws it; returns whether there was space.
    pub fn place(&self, draft: &mut Draft) -> bool {
        draft.place(&self.key, self.candidates())
    }

    fn candidates(&self) -> Vec<Candidate> {
        let sweep = self.to_rad - self.from_rad;
        let width = text_width_mm(&self.text, TEXT_MM);
        let frame = if self.is_exact { EXACT_MM } else { 0.0 };
        let mut all = Vec::new();
        let outward = if self.is_inside { -1.0 } else { 1.0 };
        for tier in 0..TIERS {
            let radius = self.edge_mm + outward * (FIRST_TIER_MM + ARC_TIER_MM * f64::from(tier));
            if radius < LEAST_ARC_MM {
                break;
            }
            let on = |angle: f64, r: f64| self.centre + Point::towards(angle) * r;
            let mut common = vec![(
                Layer::Dimension,
                Shape::Arc {
                    centre: self.centre,
                    radius_mm: radius,
                    start_rad: self.from_rad,
                    sweep_rad: sweep,
                },
            )];
            // An arrow head points along the chord of its length.
            let turn = (ARROW_MM / 2.0 / radius).min(1.0);
            let inside = sweep * radius > 2.0 * ARROW_MM + 1.0;
            for (angle, sense) in [(self.from_rad, -1.0), (self.to_rad, 1.0)] {
                let sense = if inside { sense } else { -sense };
                common.push(line(
                    on(angle, self.begins_mm + outward * EXTENSION_GAP_MM),
                    on(angle, radius + outward * EXTENSION_MM),
                ));
                common.push(arrow(on(angle, radius), Point::towards(angle + sense * (FRAC_PI_2 - turn))));
            }
            for share in [0.5, 0.42, 0.58, 0.34, 0.66, 0.25, 0.75, 0.15, 0.85] {
                let angle = self.from_rad + sweep * share;
                // The nearest position outside the arc in which a horizontal text does not touch it.
                let towards = Point::towards(angle);
                let clear = (0..60).map(|i| radius + 0.5 + 0.5 * f64::from(i)).find(|r| {
                    let middle = on(angle, *r);
                    let half = Point::new(width / 2.0 + 0.7 + frame, TEXT_MM / 2.0 + 0.7 + frame);
                    let nearest = Point::new(
                        (self.centre.x - middle.x).clamp(-half.x, half.x),
                        (self.centre.y - middle.y).clamp(-half.y, half.y),
                    );
                    (middle + nearest - self.centre).length() > radius
                });
                let Some(r) = clear else { continue };
                let middle = self.centre + towards * r;
                let mut shapes = common.clone();
                let at = middle - Point::new(width / 2.0, TEXT_MM / 2.0);
                shapes.push((Layer::Text, text(at, &self.text, false)));
                if self.is_exact {
                    let half = Point::new(width / 2.0, TEXT_MM / 2.0);
                    let framed = Extent { low: middle - half, high: middle + half }.grown(EXACT_MM);
                    shapes.extend(rectangle(framed));
                }
                all.push((
                    ARC_TIER_MM * f64::from(tier) + 6.0 * (share - 0.5).abs() + (r - radius - 2.0).max(0.0),
                    shapes,
                ));
            }
        }
        all
    }
}

/// A possible leader: its tip and its direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Leader {
    /// Its tip, on paper.
    pub tip: Point,
    /// Unit vector from the tip along the leader.
    pub direction: Point,
    /// Cost over the best leader, mm of leader length.
    pub cost_mm: f64,
}

impl Leader {
    /// Leaders to a circle from outside, from all directions.
    #[must_use]
    pub fn to_circle(centre: Point, radius_mm: f64) -> Vec<Self> {
        (0..24)
            .map(|i| {
                let direction = Point::towards(TAU * (f64::from(i) + 0.5) / 24.0);
                Self { tip: centre + direction * radius_mm, direction, cost_mm: 0.0 }
            })
            .collect()
    }
}

/// Lines of text, or the number of a balloon, at the end of a leader.
#[derive(Clone, Debug)]
pub struct Callout {
    /// What it describes.
    pub key: String,
    /// Its lines of text.
    pub lines: Vec<String>,
    /// Possible leaders.
    pub leaders: Vec<Leader>,
    /// Whether the text is the number of a balloon, in a circle.
    pub is_balloon: bool,
    /// Areas to avoid if possible.
    pub avoid: Vec<Extent>,
    /// Centre and radius of a circle around the feature: the mark of a detail.
    pub around: Option<(Point, f64)>,
    /// Geometrical tolerances, below the text.
    pub indicators: Vec<Indicator>,
    /// Datum of which the feature is, below the text.
    pub datum: Option<char>,
}

/// A name next to a round feature, without a leader.
#[derive(Clone, Debug)]
pub struct Label {
    /// What it names.
    pub key: String,
    /// Its text.
    pub text: String,
    /// Centre of the feature, on paper.
    pub middle: Point,
    /// Radius of the feature, mm on paper.
    pub reach_mm: f64,
}

/// Number of distances of a label from its feature that are tried, in steps of 1 mm.
const LABEL_STEPS: u32 = 5;

impl Label {
    /// Draws it; returns whether there was space.
    pub fn place(&self, draft: &mut Draft) -> bool {
        draft.place(&self.key, self.candidates())
    }

    fn candidates(&self) -> Vec<Candidate> {
        let half = Point::new(text_width_mm(&self.text, TEXT_MM) / 2.0, TEXT_MM / 2.0);
        let mut all = Vec::new();
        for step in 0..LABEL_STEPS {
            for i in 0..16 {
                let direction = Point::towards(TAU * (f64::from(i) + 0.5) / 16.0);
                let away = self.reach_mm + 1.0 + f64::from(step);
                // The box of the text is clear of the circle.
                let half_width = half.x * direction.x.abs() + half.y * direction.y.abs();
                let at = self.middle + direction * (away + half_width) - half;
                all.push((f64::from(step), vec![(Layer::Text, text(at, &self.text, false))]));
            }
        }
        all
    }
}

/// A possible position of a callout: its leader, the end of that, and the side of its shelf, +1 right and -1 left.
#[derive(Clone, Copy, Debug)]
struct Position {
    leader: Leader,
    elbow: Point,
    side: f64,
}

/// Additional length of a leader rather than end in an area to avoid, mm.
const AVOID_MM: f64 = 40.0;

/// Radius of a balloon, mm.
const BALLOON_MM: f64 = 4.0;
/// Lengths of leader that are tried, mm.
const REACHES_MM: [f64; 20] = [
    4.0, 6.0, 8.0, 10.0, 12.0, 14.5, 17.0, 20.0, 23.0, 26.0, 30.0, 34.0, 38.0, 43.0, 48.0, 54.0, 60.0, 68.0,
    78.0, 90.0,
];

impl Callout {
    /// Draws it; returns whether there was space.
    pub fn place(&self, draft: &mut Draft) -> bool {
        let content = Some(self.content().join("\n"));
        draft.place_with_content(&self.key, content, self.positions(), |position| self.shapes_at(&position))
    }

    /// Returns its lines, with the geometrical tolerances and the datum in words.
    pub(super) fn content(&self) -> Vec<String> {
        let indicators = self.indicators.iter().map(Indicator::words);
        let datum = self.datum.iter().map(|letter| format!("datum {letter}"));
        self.lines.iter().cloned().chain(indicators).chain(datum).collect()
    }

    /// Its possible positions, each with its cost.
    fn positions(&self) -> Vec<(f64, Position)> {
        let mut all = Vec::new();
        for leader in &self.leaders {
            for reach in REACHES_MM {
                let elbow = leader.tip + leader.direction * reach;
                let around = Extent::between(elbow, elbow).grown(BALLOON_MM);
                let is_avoided = self.avoid.iter().any(|a| a.overlaps(around));
                let cost = leader.cost_mm + reach + if is_avoided { AVOID_MM } else { 0.0 };
                let at = |side: f64| (cost, Position { leader: *leader, elbow, side });
                if self.is_balloon {
                    all.push(at(1.0));
                    continue;
                }
                // The shelf continues to the side to which the leader leans; an upright leader has both.
                all.extend([1.0, -1.0].into_iter().filter(|side| leader.direction.x * side >= -0.15).map(at));
            }
        }
        all
    }

    fn shapes_at(&self, position: &Position) -> Shapes {
        if self.is_balloon { self.balloon(position) } else { self.note(position) }
    }

    fn note(&self, Position { leader, elbow, side }: &Position) -> Shapes {
        let (elbow, side) = (*elbow, *side);
        let shelf = elbow + Point::new(2.0 * side, 0.0);
        let mut shapes =
            vec![arrow(leader.tip, leader.direction * -1.0), line(leader.tip, elbow), line(elbow, shelf)];
        if let Some((centre, radius_mm)) = self.around {
            shapes.push((Layer::Thin, Shape::Circle { centre, radius_mm }));
        }
        let widest = self.lines.iter().map(|l| text_width_mm(l, TEXT_MM)).fold(0.0, f64::max);
        let x = if side > 0.0 { shelf.x + 0.8 } else { shelf.x - 0.8 - widest };
        for (content, y) in self.lines.iter().zip(baselines(shelf.y)) {
            let width = text_width_mm(content, TEXT_MM);
            // Lines left of the shelf end at it.
            let x = if side > 0.0 { x } else { shelf.x - 0.8 - width };
            shapes.push((Layer::Text, text(Point::new(x, y), content, false)));
        }
        let widest = self.indicators.iter().map(Indicator::width_mm).fold(0.0, f64::max);
        let left = if side > 0.0 { x } else { shelf.x - 0.8 - widest };
        let last = LINE_MM * (self.lines.len() as f64 - 1.0);
        let mut low = Point::new(left, shelf.y - TEXT_MM / 2.0 - last - BELOW_TEXT_MM);
        for indicator in &self.indicators {
            low.y -= INDICATOR_MM;
            shapes.extend(indicator.shapes(low));
        }
        if let Some(letter) = self.datum {
            let foot = low + Point::new(INDICATOR_MM / 2.0, 0.0);
            shapes.extend(datum(foot, Point::new(0.0, -1.0), DATUM_STEM_MM, letter));
        }
        shapes
    }

    fn balloon(&self, Position { leader, elbow, .. }: &Position) -> Shapes {
        let number = self.lines.join(" ");
        let centre = *elbow + leader.direction * BALLOON_MM;
        let at = centre - Point::new(text_width_mm(&number, TEXT_MM) / 2.0, TEXT_MM / 2.0);
        vec![
            arrow(leader.tip, leader.direction * -1.0),
            line(leader.tip, *elbow),
            (Layer::Dimension, Shape::Circle { centre, radius_mm: BALLOON_MM }),
            (Layer::Text, text(at, &number, false)),
        ]
    }
}

/// Baselines of the lines of a note whose first line is centred on `y`.
fn baselines(y: f64) -> impl Iterator<Item = f64> {
    (0..).map(move |i| y - TEXT_MM / 2.0 - LINE_MM * f64::from(i))
}

impl Draft {
    /// Draws the title of a view, with capitals of `height_mm`, above or below `around`; returns whether there was space.
    pub fn place_title(
        &mut self,
        key: &str,
        content: &str,
        height_mm: f64,
        around: Extent,
        is_above: bool,
    ) -> bool {
        let width = text_width_mm(content, height_mm);
        let middle = around.middle();
        let mut all = Vec::new();
        for step in 0..40 {
            let away = 3.0 + f64::from(step);
            let (below, above) = if is_above { (8.0, 0.0) } else { (0.0, 8.0) };
            for (cost, y) in [(below, around.low.y - away - height_mm), (above, around.high.y + away)] {
                for shift in [0.0, -10.0, 10.0, -20.0, 20.0, -35.0, 35.0] {
                    let at = Point::new(middle.x - width / 2.0 + shift, y);
                    let shape =
                        Shape::Text(Text { at, height_mm, content: content.to_owned(), upright: false });
                    all.push((cost + away + shift.abs() / 2.0, vec![(Layer::Text, shape)]));
                }
            }
        }
        self.place(key, all)
    }

    /// Draws general notes upward from the lower left corner of the sheet, at most `width_mm` wide.
    pub fn notes(&mut self, lines: &[String], width_mm: f64) {
        let frame = self.sheet().paper.frame();
        let group = self.group();
        let mut y = frame.low.y + 3.0;
        for content in lines.iter().rev() {
            let (broken, height_mm) = fit_text(content, TEXT_MM, 1.8, [width_mm, 6.0 * LINE_MM]);
            for content in broken.into_iter().rev() {
                let at = Point::new(frame.low.x + 3.0, y);
                self.put(
                    Layer::Text,
                    Shape::Text(Text { at, height_mm, content, upright: false }),
                    None,
                    group,
                );
                y += LINE_MM;
            }
        }
    }
}
