//! A sheet in the making: what is written on it finds room where nothing else lies.

use super::frame::{TITLE_HEIGHT_MM, TITLE_WIDTH_MM};
use super::geometry::{Extent, Point, lines_cover, lines_cross};
use super::index::{Index, Piece};
use super::sheet::{Annotation, Entity, Layer, Paper, Shape, Sheet, View};

/// What a new text keeps from lines, and a new line from texts, mm.
const LINE_GAP_MM: f64 = 0.6;
/// What a new text keeps from other texts, mm.
const TEXT_GAP_MM: f64 = 0.9;
/// How much further a leader goes rather than cross a line of another dimension, mm.
const CROSSING_MM: f64 = 7.0;
/// How much further rather than cross an edge, mm.
const EDGE_CROSSING_MM: f64 = 2.5;

/// How much further rather than lie on another line, mm.
const COVERING_MM: f64 = 30.0;

/// A way to write an annotation: how far it is from the best, mm, and its shapes.
pub(super) type Candidate = (f64, Vec<(Layer, Shape)>);

/// A sheet in the making.
#[derive(Clone, Debug)]
pub struct Draft {
    sheet: Sheet,
    texts: Index<(Extent, usize)>,
    pieces: Index<Piece>,
    groups: usize,
}

impl Draft {
    /// An empty sheet with its frame, and the place of its title block kept free.
    #[must_use]
    pub fn bare(paper: Paper) -> Self {
        let frame = paper.frame();
        let corner = Point::new(frame.high.x, frame.low.y);
        let title_block = Extent::between(corner, corner + Point::new(-TITLE_WIDTH_MM, TITLE_HEIGHT_MM));
        let sheet = Sheet {
            name: String::new(),
            paper,
            scale: 1.0,
            views: Vec::new(),
            entities: Vec::new(),
            annotations: Vec::new(),
            title_block,
            first_group: 1,
        };
        let mut draft = Self { sheet, texts: Index::new(), pieces: Index::new(), groups: 1 };
        draft.rectangle(Layer::Frame, frame, 0);
        draft
    }

    /// Begins a group of entities that belong together.
    pub const fn group(&mut self) -> usize {
        self.groups += 1;
        self.groups - 1
    }

    /// Ends frame and title block: whatever comes later must not touch them.
    pub(super) fn begin_content(&mut self) {
        self.sheet.first_group = self.groups;
    }

    /// Begins a view.
    pub fn view(&mut self, name: impl Into<String>, origin: Point, scale: f64) -> usize {
        self.sheet.views.push(View { name: name.into(), origin, scale });
        self.sheet.views.len() - 1
    }

    /// Draws `shape`, wherever it lies.
    pub fn put(&mut self, layer: Layer, shape: Shape, view: Option<usize>, group: usize) {
        if let Shape::Text(text) = &shape {
            self.texts.insert(text.extent(), (text.extent(), group));
        }
        for ends in shape.pieces() {
            // The planes of sections and engraved letters are read as dimensions are.
            let is_annotation = match layer {
                Layer::Thin => true,
                Layer::Dimension | Layer::Frame => view.is_none(),
                _ => false,
            };
            self.pieces.insert(Extent::between(ends[0], ends[1]), Piece { ends, group, is_annotation });
        }
        self.sheet.entities.push(Entity { layer, shape, view, group });
    }

    /// Draws the four sides of `extent`.
    pub fn rectangle(&mut self, layer: Layer, extent: Extent, group: usize) {
        let (low, high) = (extent.low, extent.high);
        let corners = [low, Point::new(high.x, low.y), high, Point::new(low.x, high.y)];
        for i in 0..4 {
            self.put(layer, Shape::Line { from: corners[i], to: corners[(i + 1) % 4] }, None, group);
        }
    }

    /// The sheet so far.
    #[must_use]
    pub const fn sheet(&self) -> &Sheet {
        &self.sheet
    }

    /// The sheet, called `name`, whose main views have this scale.
    #[must_use]
    pub fn finished(mut self, name: impl Into<String>, scale: f64) -> Sheet {
        self.sheet.name = name.into();
        self.sheet.scale = scale;
        self.sheet
    }

    /// Notes what a group of entities says.
    pub(super) fn annotate(&mut self, annotation: Annotation) {
        self.sheet.annotations.push(annotation);
    }

    /// Whether shapes could be put here without touching anything.
    pub(super) fn cost(&self, shapes: &[(Layer, Shape)]) -> Option<f64> {
        let room = self.sheet.paper.frame().grown(-1.0);
        for (_, shape) in shapes {
            if let Shape::Text(text) = shape {
                let extent = text.extent();
                let wide = extent.grown(LINE_GAP_MM);
                let is_out = !room.holds(extent) || extent.grown(1.0).meets(self.sheet.title_block);
                if is_out
                    || self
                        .texts
                        .any(extent.grown(TEXT_GAP_MM), |(other, _)| extent.grown(TEXT_GAP_MM).meets(*other))
                    || self.pieces.any(wide, |p| wide.is_crossed_by(p.ends[0], p.ends[1]))
                {
                    return None;
                }
            }
        }
        let mut cost = 0.0;
        for (_, shape) in shapes {
            for [a, b] in shape.pieces() {
                let extent = Extent::between(a, b);
                let block = self.sheet.title_block.grown(1.0);
                if !room.holds(extent)
                    || block.is_crossed_by(a, b)
                    || self.texts.any(extent.grown(LINE_GAP_MM), |(other, _)| {
                        other.grown(LINE_GAP_MM).is_crossed_by(a, b)
                    })
                {
                    return None;
                }
                // A long line lies in several cells of the index, and counts once.
                let mut counted: Vec<[Point; 2]> = Vec::new();
                self.pieces.any(extent, |p| {
                    if !counted.contains(&p.ends) {
                        if lines_cross(p.ends, [a, b]) {
                            counted.push(p.ends);
                            cost += if p.is_annotation { CROSSING_MM } else { EDGE_CROSSING_MM };
                        } else if lines_cover([a, b], p.ends) {
                            counted.push(p.ends);
                            cost += COVERING_MM;
                        }
                    }
                    false
                });
            }
        }
        Some(cost)
    }

    /// Draws the cheapest of `candidates` that touches nothing; whether there was one.
    pub(super) fn place(&mut self, key: &str, mut candidates: Vec<Candidate>) -> bool {
        candidates.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut best: Option<Candidate> = None;
        for (base, shapes) in candidates {
            if best.as_ref().is_some_and(|b| b.0 <= base) {
                break;
            }
            let Some(crossings) = self.cost(&shapes) else { continue };
            if best.as_ref().is_none_or(|b| base + crossings < b.0) {
                best = Some((base + crossings, shapes));
            }
        }
        let Some((_, shapes)) = best else { return false };
        let group = self.group();
        let lines: Vec<&str> = shapes
            .iter()
            .filter_map(|(_, s)| if let Shape::Text(t) = s { Some(t.content.as_str()) } else { None })
            .collect();
        self.sheet.annotations.push(Annotation { group, key: key.to_owned(), text: lines.join("\n") });
        for (layer, shape) in shapes {
            self.put(layer, shape, None, group);
        }
        true
    }
}
