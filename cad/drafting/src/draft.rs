//! A sheet under construction, on which annotations find free space.

use super::geometry::{Extent, Point, lines_cross, lines_overlap};
use super::index::{Index, Piece};
use super::sheet::{Annotation, Entity, Layer, Paper, Shape, Sheet, View};

/// Width and height of the title block, mm (ISO 7200).
pub(super) const TITLE_BLOCK_MM: [f64; 2] = [180.0, 34.0];
/// Distance of a new text from lines, and of a new line from texts, mm.
const LINE_GAP_MM: f64 = 0.6;
/// Distance of a new text from other texts, mm.
const TEXT_GAP_MM: f64 = 0.9;
/// Additional length of a leader rather than cross a line of another annotation, mm.
const CROSSING_MM: f64 = 7.0;
/// The same rather than cross an edge, mm.
const EDGE_CROSSING_MM: f64 = 2.5;
/// The same rather than run along another line, mm.
const COVERING_MM: f64 = 30.0;

/// The shapes of an annotation.
pub(super) type Shapes = Vec<(Layer, Shape)>;
/// A possible position of an annotation: its cost in mm of leader length, and its shapes.
pub(super) type Candidate = (f64, Shapes);

/// A sheet under construction.
#[derive(Clone, Debug)]
pub struct Draft {
    sheet: Sheet,
    texts: Index<(Extent, usize)>,
    pieces: Index<Piece>,
    /// Sides of arrow heads.
    arrows: Index<[Point; 2]>,
    groups: usize,
}

impl Draft {
    /// An empty sheet with its frame, and the space of its title block kept free.
    #[must_use]
    pub fn without_title(paper: Paper) -> Self {
        let frame = paper.frame();
        let corner = Point::new(frame.high.x, frame.low.y);
        let title_block = Extent::between(corner, corner + Point::new(-TITLE_BLOCK_MM[0], TITLE_BLOCK_MM[1]));
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
        let mut draft =
            Self { sheet, texts: Index::new(), pieces: Index::new(), arrows: Index::new(), groups: 1 };
        draft.rectangle(Layer::Frame, frame, 0);
        draft
    }

    /// Starts a group of entities that belong together; returns its number.
    pub const fn group(&mut self) -> usize {
        self.groups += 1;
        self.groups - 1
    }

    /// Ends frame and title block. What follows must not touch them.
    pub(super) fn begin_content(&mut self) {
        self.sheet.first_group = self.groups;
    }

    /// Adds a view; returns its number.
    pub fn view(&mut self, name: impl Into<String>, origin: Point, scale: f64) -> usize {
        self.sheet.views.push(View { name: name.into(), origin, scale });
        self.sheet.views.len() - 1
    }

    /// Draws a shape, also over others.
    pub fn put(&mut self, layer: Layer, shape: Shape, view: Option<usize>, group: usize) {
        if let Shape::Text(text) = &shape {
            self.texts.insert(text.extent(), (text.extent(), group));
        }
        if let Shape::Arrow { tip, direction } = shape {
            for [a, b] in Shape::arrow_sides(tip, direction) {
                self.arrows.insert(Extent::between(a, b), [a, b]);
            }
        }
        for ends in shape.pieces() {
            // Cutting planes and engraved letters are as important as dimensions.
            let is_annotation = match layer {
                Layer::Thin => true,
                Layer::Dimension | Layer::Frame => view.is_none(),
                _ => false,
            };
            self.pieces.insert(Extent::between(ends[0], ends[1]), Piece { ends, group, is_annotation });
        }
        self.sheet.entities.push(Entity { layer, shape, view, group });
    }

    /// Draws a rectangle.
    pub fn rectangle(&mut self, layer: Layer, extent: Extent, group: usize) {
        let (low, high) = (extent.low, extent.high);
        let corners = [low, Point::new(high.x, low.y), high, Point::new(low.x, high.y)];
        for i in 0..4 {
            self.put(layer, Shape::Line { from: corners[i], to: corners[(i + 1) % 4] }, None, group);
        }
    }

    /// Whether an area inside the frame has no text and no line, and does not touch the title block.
    #[must_use]
    pub fn is_free(&self, extent: Extent) -> bool {
        self.sheet.paper.frame().contains(extent)
            && !extent.overlaps(self.sheet.title_block)
            && !self.texts.any(extent, |(other, _)| extent.overlaps(*other))
            && !self.pieces.any(extent, |piece| extent.is_crossed_by(piece.ends[0], piece.ends[1]))
    }

    /// The sheet.
    #[must_use]
    pub const fn sheet(&self) -> &Sheet {
        &self.sheet
    }

    /// The finished sheet with its name and the scale of its main views.
    #[must_use]
    pub fn into_sheet(mut self, name: impl Into<String>, scale: f64) -> Sheet {
        self.sheet.name = name.into();
        self.sheet.scale = scale;
        self.sheet
    }

    /// Adds the content of a group of entities.
    pub(super) fn annotate(&mut self, annotation: Annotation) {
        self.sheet.annotations.push(annotation);
    }

    /// The cost of the lines that these shapes cross; `None` if they touch a text, the frame or the title block.
    pub(super) fn cost(&self, shapes: &[(Layer, Shape)]) -> Option<f64> {
        let room = self.sheet.paper.frame().grown(-1.0);
        for (_, shape) in shapes {
            if let Shape::Text(text) = shape {
                let extent = text.extent();
                let wide = extent.grown(LINE_GAP_MM);
                let is_out = !room.contains(extent) || extent.grown(1.0).overlaps(self.sheet.title_block);
                if is_out
                    || self.texts.any(extent.grown(TEXT_GAP_MM), |(other, _)| {
                        extent.grown(TEXT_GAP_MM).overlaps(*other)
                    })
                    || self.pieces.any(wide, |p| wide.is_crossed_by(p.ends[0], p.ends[1]))
                {
                    return None;
                }
            }
        }
        if self.meets_arrows(shapes) {
            return None;
        }
        let mut cost = 0.0;
        for (_, shape) in shapes {
            for [a, b] in shape.pieces() {
                let extent = Extent::between(a, b);
                let block = self.sheet.title_block.grown(1.0);
                if !room.contains(extent)
                    || block.is_crossed_by(a, b)
                    || self.texts.any(extent.grown(LINE_GAP_MM), |(other, _)| {
                        other.grown(LINE_GAP_MM).is_crossed_by(a, b)
                    })
                {
                    return None;
                }
                // A long line is in several cells of the index, and counts once.
                let mut counted: Vec<[Point; 2]> = Vec::new();
                self.pieces.any(extent, |p| {
                    if !counted.contains(&p.ends) {
                        if lines_cross(p.ends, [a, b]) {
                            counted.push(p.ends);
                            cost += if p.is_annotation { CROSSING_MM } else { EDGE_CROSSING_MM };
                        } else if lines_overlap([a, b], p.ends) {
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

    /// Whether a line of these shapes crosses an arrow head, or one of their arrow heads a line of an annotation.
    fn meets_arrows(&self, shapes: &[(Layer, Shape)]) -> bool {
        shapes.iter().any(|(_, shape)| match *shape {
            Shape::Arrow { tip, direction } => Shape::arrow_sides(tip, direction).iter().any(|[a, b]| {
                self.pieces.any(Extent::between(*a, *b), |p| p.is_annotation && lines_cross(p.ends, [*a, *b]))
            }),
            _ => shape
                .pieces()
                .iter()
                .any(|[a, b]| self.arrows.any(Extent::between(*a, *b), |side| lines_cross(*side, [*a, *b]))),
        })
    }

    /// Draws the cheapest of `candidates` that touches nothing; returns whether there is one.
    pub(super) fn place(&mut self, key: &str, candidates: Vec<Candidate>) -> bool {
        self.place_with_content(key, None, candidates, |shapes| shapes)
    }

    /// As [`Draft::place`], with the content of the annotation where it is not that of its texts, and with shapes that are made
    /// of a position only when its turn comes: most positions are dearer than the one that is taken.
    pub(super) fn place_with_content<P>(
        &mut self,
        key: &str,
        content: Option<String>,
        mut positions: Vec<(f64, P)>,
        shapes_at: impl Fn(P) -> Shapes,
    ) -> bool {
        positions.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut best: Option<Candidate> = None;
        for (base, position) in positions {
            if best.as_ref().is_some_and(|b| b.0 <= base) {
                break;
            }
            let shapes = shapes_at(position);
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
        let text = content.unwrap_or_else(|| lines.join("\n"));
        self.sheet.annotations.push(Annotation { group, key: key.to_owned(), text });
        for (layer, shape) in shapes {
            self.put(layer, shape, None, group);
        }
        true
    }
}
