//! The sheet of one part.

use super::angles::{Places, angles};
use super::callouts::{Subject, callouts, of_detail};
use super::detail::{Detail, cut_x, details, draw_detail};
use super::dimension::Dimension;
use super::features::Features;
use super::fit::{FaceDatum, Fits, RadialSize};
use super::notes::{Terms, first_notes, reading_notes};
use super::{hole_table, sides, text};
use crate::contour::same;
use crate::view::{
    Body, CROWDED_MM, Elevation, Face, HATCH_MM, Letter, Place, Side, draw_plan, draw_section_mark,
    draw_strokes, elevation, joined, legible, plan,
};
use crate::{
    ABOVE_MM, DatumMark, Draft, Extent, Layer, Layout, Linear, Paper, Point, Projection, Shape, Sheet, Sizes,
    Table, TitleBlock, part_formats,
};
use pinswitch_solid::mesh::Point3;
use pinswitch_solid::pose::Pose;
use pinswitch_solid::profile::Point2;
use pinswitch_solid::solid::Solid;

/// Least scale that is tried, as a share of the largest at which the views fit.
const LEAST_SHARE: f64 = 0.5;
/// The axis is drawn if it is not farther below the part, mm on paper.
const AXIS_NEAR_MM: f64 = 26.0;

/// A part to draw: its solid, and what the solid does not show.
#[derive(Clone, Debug)]
pub struct PartDrawing<'a> {
    /// Name of the sheet.
    pub name: String,
    /// The solid, with its axis at the origin. The front view shows its upper face.
    pub solid: &'a Solid,
    /// Chamfer of the bottom edges, mm; 0 without. It is a note, and not dimensioned.
    pub chamfer_mm: f64,
    /// The ends of a sector are parallel to the planes at plus and minus this angle from +y; `None` for other parts.
    pub half_span_rad: Option<f64>,
    /// Whether it has a section. Pins and shafts have none (ISO 128-44): they get a side view.
    pub is_cut: bool,
    /// Tolerances and purposes of its features.
    pub fits: Fits,
    /// Names of its features.
    pub terms: Terms,
    /// Content of its engravings, as the first note.
    pub engraving: Option<String>,
    /// Notes about its manufacture.
    pub notes: Vec<String>,
    /// What its marks mean, and other notes at the end.
    pub legend: Vec<String>,
}

impl<'a> PartDrawing<'a> {
    /// The drawing of a solid without fits and notes.
    #[must_use]
    pub fn new(name: impl Into<String>, solid: &'a Solid) -> Self {
        Self {
            name: name.into(),
            solid,
            chamfer_mm: 0.0,
            half_span_rad: None,
            is_cut: true,
            fits: Fits::default(),
            terms: Terms::default(),
            engraving: None,
            notes: Vec::new(),
            legend: Vec::new(),
        }
    }

    /// Draws the sheet, on `paper` or, where the part needs it, on a larger one. The scale of `title` is ignored.
    ///
    /// Dimensions that find no space near their features become notes. `None` for a solid without extent, and for one that
    /// is too large for any paper and scale.
    #[must_use]
    pub fn sheet(&self, title: &TitleBlock, paper: Paper) -> Option<Sheet> {
        let (low, high) = self.solid.bounds()?;
        let mut features = Features::new(self.solid, self.chamfer_mm, self.half_span_rad);
        features.bores = self.fits.split(features.bores);
        let side = if title.projection == Projection::First { Side::Left } else { Side::Right };
        let cut_x = cut_x(&features, side, (low, high));
        let cut = if side == Side::Left { -cut_x } else { cut_x };
        let seen = |side| Body::new(self.solid, Pose::upright(-low.z), side);
        let above = elevation(&[seen(Side::Above)], None);
        let body = seen(side);
        let face = Face::new(&body, cut);
        let behind = elevation(&[body], Some(cut));
        let views = Views { part: self, title, features, above, cut_x, face, behind, low, high };
        views.sheet(paper)
    }
}

/// The views of a part.
struct Views<'a> {
    part: &'a PartDrawing<'a>,
    title: &'a TitleBlock,
    features: Features,
    /// The view from above.
    above: Elevation,
    cut_x: f64,
    /// The cut face, and the view behind the cut.
    face: Face,
    behind: Elevation,
    low: Point3,
    high: Point3,
}

/// The views of a sheet, drawn.
struct Drawn {
    layout: Layout,
    place: Place,
    front: Extent,
    section: Extent,
    /// Details with their places and letters.
    details: Vec<(Detail, Place, String)>,
}

/// A way to draw the sheet.
#[derive(Clone, Copy, Debug)]
struct Format {
    paper: Paper,
    scale: f64,
    letter: Letter,
}

impl Views<'_> {
    /// The first sheet with space for all dimensions. Where no scale near the largest one has it, the sheet at that scale,
    /// with the other dimensions as notes.
    fn sheet(&self, paper: Paper) -> Option<Sheet> {
        let mut largest: Option<(Format, Vec<Dimension>)> = None;
        let formats = part_formats(paper).into_iter().flat_map(|(paper, scale)| {
            [Letter::BehindLine, Letter::BeforeArrow].map(|letter| Format { paper, scale, letter })
        });
        for format in formats {
            if largest.as_ref().is_some_and(|(largest, _)| format.scale < LEAST_SHARE * largest.scale) {
                break;
            }
            let Some((sheet, left)) = self.attempt(format, &[]) else { continue };
            if left.is_empty() {
                return Some(sheet);
            }
            largest.get_or_insert((format, left));
        }
        let (format, left) = largest?;
        self.attempt(format, &left).map(|(sheet, _)| sheet)
    }

    /// The sheet in a format, with `noted` dimensions as notes, and the dimensions without space. `None` if the views do not
    /// fit.
    fn attempt(&self, format: Format, noted: &[Dimension]) -> Option<(Sheet, Vec<Dimension>)> {
        let title = TitleBlock { scale: Sheet::scale_text(format.scale), ..self.title.clone() };
        let mut draft = Draft::new(format.paper, &title);
        let drawn = self.draw(&mut draft, format, noted)?;
        let mut left = Vec::new();
        for dimension in self.dimensions(&drawn) {
            let is_noted = noted.iter().any(|d| d.key == dimension.key);
            if !is_noted && !dimension.place(&mut draft) {
                left.push(dimension);
            }
        }
        Some((draft.into_sheet(self.part.name.clone(), format.scale), left))
    }

    /// Draws all views with their titles and marks, and the notes.
    fn draw(&self, draft: &mut Draft, format: Format, noted: &[Dimension]) -> Option<Drawn> {
        let Format { paper, scale, letter } = format;
        let details = details(&self.features, scale);
        let table = hole_table::table(&self.features);
        let reach = if paper == Paper::A4 { 20.0 } else { 27.0 };
        let sizes = Sizes {
            front: self.front_extent(scale),
            depth_mm: (self.high.z - self.low.z) * scale,
            detail_mm: reach,
            details: details.len(),
            above_mm: ABOVE_MM,
            table_mm: 0.0,
            right_table_mm: table.as_ref().map_or([0.0, 0.0], Table::size_mm),
        };
        let layout = Layout::new(draft, &sizes, self.title.projection)?;
        if let Some(table) = table {
            table.draw(draft, layout.right_table);
        }
        let place = Place::straight(layout.front, scale);
        let lines = plan(self.part.solid, false, self.part.chamfer_mm);
        let view = draft.view("FRONT", layout.front, scale);
        draw_plan(draft, &lines, &place, view);
        self.draw_view_from_above(draft, &layout, scale);
        let section = self.draw_section(draft, &layout, scale);
        let front = Extent { low: sizes.front.low + layout.front, high: sizes.front.high + layout.front };
        self.draw_centre_lines(draft, &place, front);
        if self.part.is_cut {
            let x = place.at(Point2::new(self.cut_x, 0.0)).x;
            let ends = [front.low.y - 2.0, self.mark_top(front)];
            draw_section_mark(draft, x, ends, layout.section_sense, letter);
            if !draft.place_title("section title", "A-A", 3.5, section, true) {
                return None;
            }
        }
        let mut notes = self.notes();
        notes.extend(noted.iter().map(Dimension::to_note));
        let room = draft.sheet().title_block.low.x - paper.frame().low.x - 6.0;
        draft.notes(&notes, room);
        let mut placed = Vec::new();
        for ((detail, middle), letter) in details.into_iter().zip(&layout.details).zip('B'..) {
            let letter = letter.to_string();
            let larger = draw_detail(draft, &detail, *middle, reach, &lines, &letter)?;
            placed.push((detail, larger, letter));
        }
        Some(Drawn { layout, place, front, section, details: placed })
    }

    fn notes(&self) -> Vec<String> {
        let part = self.part;
        let mut notes: Vec<String> = part.engraving.iter().cloned().collect();
        notes.extend(first_notes(&self.features, part.chamfer_mm));
        notes.extend(part.notes.iter().cloned());
        notes.extend(reading_notes(&self.features, &part.terms, part.fits.has_positions()));
        notes.extend(part.legend.iter().cloned());
        notes
    }

    /// Every dimension, in the order in which they are placed.
    fn dimensions(&self, drawn: &Drawn) -> Vec<Dimension> {
        let f = &self.features;
        let places = Places::new(f, drawn.place);
        let subject = Subject {
            features: f,
            fits: &self.part.fits,
            half_span_rad: self.part.half_span_rad,
            boss: &self.part.terms.boss,
        };
        let mut all = self.heights(drawn);
        all.extend(self.radial_sizes(drawn));
        all.extend(angles(f, &self.part.fits, self.part.half_span_rad, &places));
        for (detail, place, _) in &drawn.details {
            all.extend(of_detail(&subject, detail, place));
        }
        for (detail, _, letter) in &drawn.details {
            let radius = detail.radius_mm * drawn.place.scale;
            all.push(Dimension::mark_of_detail(places.last.at(detail.middle), radius, letter));
        }
        let bounds = (self.low, self.high);
        all.extend(sides::lengths(
            f,
            &self.part.terms.pocket,
            &drawn.place,
            drawn.front,
            self.room_mm(drawn),
            bounds,
        ));
        let details: Vec<Detail> = drawn.details.iter().map(|d| d.0).collect();
        all.extend(callouts(&subject, &places, &details));
        all.extend(hole_table::names(f, &drawn.place));
        all.extend(self.datum_of_face(drawn));
        all
    }

    /// The position of a height over the bottom in the section.
    fn section_x(drawn: &Drawn, z_mm: f64) -> f64 {
        drawn.layout.section_mm + drawn.layout.section_sense * z_mm * drawn.place.scale
    }

    /// Thicknesses along a radius, right of the section.
    fn radial_sizes(&self, drawn: &Drawn) -> Vec<Dimension> {
        let section = drawn.section;
        let dimension = |size: &RadialSize| {
            let at = |radius_mm: f64| {
                Point::new(section.high.x, drawn.place.at(Point2::new(self.cut_x, radius_mm)).y)
            };
            let (from, to) = (at(size.inner_mm), at(size.outer_mm));
            Dimension::linear(Linear {
                key: size.key.clone(),
                text: text::joined(&[&text::number(size.outer_mm - size.inner_mm), &size.tolerance]),
                from,
                to,
                upright: true,
                edge_mm: section.high.x,
                outward: 1.0,
                room_mm: f64::INFINITY,
                clear_of: [from.y, to.y],
            })
        };
        self.part.fits.sizes.iter().map(dimension).collect()
    }

    /// The datum of an end face, at its edge in the section.
    fn datum_of_face(&self, drawn: &Drawn) -> Option<Dimension> {
        let FaceDatum { letter, z_mm, is_upper } = self.part.fits.face?;
        let x = Self::section_x(drawn, z_mm);
        let sense = if is_upper { drawn.layout.section_sense } else { -drawn.layout.section_sense };
        let outward = Point::new(sense, 0.0);
        let section = drawn.section;
        let foot = |share: f64| Point::new(x, section.low.y + share * section.height());
        let feet = [0.35, 0.45, 0.25, 0.55, 0.15, 0.65, 0.08].map(|share| (foot(share), outward)).to_vec();
        Some(Dimension::datum(DatumMark { key: format!("datum {letter}"), letter, feet }))
    }

    /// Space below and above the front view, up to the view from above, mm.
    fn room_mm(&self, drawn: &Drawn) -> [f64; 2] {
        let (front, top_mm) = (drawn.front, drawn.layout.above_mm);
        match self.title.projection {
            Projection::First => [front.low.y - top_mm, f64::INFINITY],
            Projection::Third => {
                let height_mm = (self.high.z - self.low.z) * drawn.place.scale;
                [f64::INFINITY, top_mm - height_mm - front.high.y]
            }
        }
    }

    /// The front view on paper about the origin of the part, with the axis if it is near.
    fn front_extent(&self, scale: f64) -> Extent {
        let mut extent = Extent {
            low: Point::new(self.low.x, self.low.y) * scale,
            high: Point::new(self.high.x, self.high.y) * scale,
        };
        if self.features.is_axial() && extent.low.y > -3.0 && extent.low.y < AXIS_NEAR_MM {
            extent.low.y = -3.0;
        }
        extent
    }

    fn draw_view_from_above(&self, draft: &mut Draft, layout: &Layout, scale: f64) {
        let origin = Point::new(layout.front.x, layout.above_mm);
        let view = draft.view("ABOVE", origin, scale);
        let apart = CROWDED_MM / scale;
        let visible = legible(&self.above.visible, &[], apart);
        let hidden = legible(&self.above.hidden, &self.above.visible, apart);
        // z grows toward the observer of the front view: down on paper.
        let at = |p: [f64; 2]| origin + Point::new(p[0], -p[1]) * scale;
        let group = draft.group();
        for (layer, strokes) in [(Layer::Visible, &visible), (Layer::Hidden, &hidden)] {
            draw_strokes(draft, layer, strokes, at, Some(view), group);
        }
    }

    /// Draws the section with its hatching, or the side view of a part that is not cut; returns its extent.
    fn draw_section(&self, draft: &mut Draft, layout: &Layout, scale: f64) -> Extent {
        let origin = Point::new(layout.section_mm, layout.front.y);
        let view = draft.view("SECTION_A", origin, scale);
        let sense = layout.section_sense;
        let at = |p: [f64; 2]| origin + Point::new(sense * p[1], p[0]) * scale;
        let group = draft.group();
        let outline = self.face.outline();
        let behind = legible(&self.behind.visible, &outline, CROWDED_MM / scale);
        let visible = joined(&[outline, behind].concat(), &[]);
        draw_strokes(draft, Layer::Visible, &visible, at, Some(view), group);
        if self.part.is_cut {
            draw_strokes(
                draft,
                Layer::Hatch,
                &self.face.hatch(HATCH_MM / scale, true),
                at,
                Some(view),
                group,
            );
        }
        let ends = visible.iter().flatten().map(|p| Extent::between(at(*p), at(*p)));
        ends.reduce(Extent::union).unwrap_or(Extent::between(origin, origin))
    }

    /// Lower end of the mark of the section above the front view: beyond the angles.
    fn mark_top(&self, front: Extent) -> f64 {
        let f = &self.features;
        let patterns = usize::from(!f.ends.is_empty())
            + f.roundings.iter().filter(|r| r.is_half_round && r.arcs.len() > 2).count()
            + f.slots.iter().filter(|s| s.places.len() > 2).count();
        let angles = if f.is_axial() && patterns > 0 { 7.0 + 8.0 * patterns as f64 } else { 0.0 };
        front.high.y + 2.0 + angles
    }

    /// Draws the plane of symmetry, the axis, and the centres of holes and bosses.
    fn draw_centre_lines(&self, draft: &mut Draft, place: &Place, front: Extent) {
        let group = draft.group();
        let f = &self.features;
        let mut line =
            |from: Point, to: Point| draft.put(Layer::Centre, Shape::Line { from, to }, None, group);
        let axis = place.at(Point2::origin());
        if f.is_axial() {
            if self.cut_x.abs() > 1e-6 || !self.part.is_cut {
                line(Point::new(axis.x, front.low.y - 2.0), Point::new(axis.x, front.high.y + 3.0));
            }
            if axis.y > front.low.y - 1.0 {
                // Over the whole part, whose middle may be beside the axis.
                let [from, to] = if front.low.y < axis.y - 4.0 {
                    [front.low.x - 3.0, front.high.x + 3.0]
                } else {
                    [axis.x - 8.0, axis.x + 8.0]
                };
                line(Point::new(from, axis.y), Point::new(to, axis.y));
            }
        }
        let bosses = f.bosses.iter().map(|b| (&b.centres, b.levels.iter().map(|l| l.1).fold(0.0, f64::max)));
        for (centres, radius_mm) in bosses.chain(f.bores.iter().map(|b| (&b.centres, b.reach_mm()))) {
            for centre in centres {
                let (at, reach) = (place.at(*centre), radius_mm * place.scale + 1.5);
                let is_on_axis = same(centre.coords.norm(), 0.0);
                let along =
                    if is_on_axis || !f.is_axial() { Point::new(0.0, 1.0) } else { (at - axis).unit() };
                line(at - along * reach, at + along * reach);
                line(at - along.left() * reach, at + along.left() * reach);
            }
        }
    }

    /// Heights of the outer faces over the bottom, in the section.
    fn heights(&self, drawn: &Drawn) -> Vec<Dimension> {
        let section = drawn.section;
        let foot = section.low.y;
        let x = |z: f64| Self::section_x(drawn, z);
        let all = &self.features.heights_mm;
        all.iter()
            .map(|z| {
                let text = text::number(*z);
                let (key, text) = if Some(z) == all.last() {
                    ("overall height".to_owned(), text::joined(&[&text, &self.part.fits.height_tolerance]))
                } else {
                    (format!("height {text}"), text)
                };
                Dimension::linear(Linear {
                    key,
                    text,
                    from: Point::new(x(0.0), foot),
                    to: Point::new(x(*z), foot),
                    upright: false,
                    edge_mm: foot,
                    outward: -1.0,
                    room_mm: f64::INFINITY,
                    clear_of: [section.low.x, section.high.x],
                })
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::collisions;
    use pinswitch_solid::profile::Contour;
    use pinswitch_solid::solid::Facing;
    use std::f64::consts::FRAC_PI_3;

    fn sheet(corners: &[(f64, f64)], holes: &[Contour]) -> Sheet {
        let outline = Contour::polygon(corners.iter().map(|(x, y)| Point2::new(*x, *y)).collect());
        let solid = Solid::prism(&outline, holes, 0.0, 6.0, 0.0).unwrap();
        PartDrawing::new("part", &solid).sheet(&TitleBlock::default(), Paper::A4).unwrap()
    }

    fn text<'a>(sheet: &'a Sheet, key: &str) -> Option<&'a str> {
        sheet.annotations.iter().find(|a| a.key == key).map(|a| a.text.as_str())
    }

    /// Every corner of an L, which no part of a switch has, is measured from its left and lower side.
    #[test]
    fn corners_of_an_angle_are_dimensioned() {
        let corners = [(0.0, 0.0), (40.0, 0.0), (40.0, 12.0), (15.0, 12.0), (15.0, 30.0), (0.0, 30.0)];
        for holes in [vec![], vec![Contour::circle(Point2::new(28.0, 6.0), 2.0).reversed()]] {
            let sheet = sheet(&corners, &holes);
            assert_eq!(collisions(&sheet), []);
            for (key, length) in [
                ("from the left side, 15", "15"),
                ("from the lower side, 12", "12"),
                ("length", "40"),
                ("width", "30"),
                ("overall height", "6"),
            ] {
                assert_eq!(text(&sheet, key), Some(length), "{key}: {:?}", sheet.annotations);
            }
            assert_eq!(text(&sheet, "hole 1").is_some(), !holes.is_empty());
            assert!(text(&sheet, "places of the holes").is_none());
        }
    }

    #[test]
    fn flats_of_a_hexagon_have_an_angle() {
        let corner = |i: u32| {
            let angle = f64::from(i) * FRAC_PI_3 + 10f64.to_radians();
            Point2::new(10.0 + 3.0 * libm::cos(angle), 10.0 + 3.0 * libm::sin(angle))
        };
        let hexagon = Contour::polygon((0..6).map(corner).collect()).reversed();
        let outline = [(0.0, 0.0), (20.0, 0.0), (20.0, 20.0), (0.0, 20.0)].map(|(x, y)| Point2::new(x, y));
        let mut solid = Solid::new();
        let (bottom, top) = solid.extrude(&Contour::polygon(outline.to_vec()), 0.0, 6.0);
        let mouth = solid.pocket(&hexagon, &[], 2.0, 6.0);
        solid.cap(Facing::Down, bottom, &[]);
        solid.cap(Facing::Up, top, &[mouth]);
        let sheet = PartDrawing::new("part", &solid).sheet(&TitleBlock::default(), Paper::A4).unwrap();
        let hole = text(&sheet, "hole 1").unwrap();
        assert_eq!(hole, "hexagon AF 5.196, 4 deep\ntwo flats at 10\u{b0} from X");
    }
}
