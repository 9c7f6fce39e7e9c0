//! The sheet of one part: front view, view from above, section, details, and every dimension once.

use super::angles::{Places, angles};
use super::cut::{Detail, cut_x, draw_detail, enlarged};
use super::dimensions::{self, Wanted};
use super::features::{Features, features};
use super::fits;
use super::hole_table;
use super::sides;
use super::words;
use crate::design::Design;
use crate::parts::{Part, Role};
use pinswitch_drafting::view::{
    Body, CROWDED_MM, Elevation, Face, HATCH_MM, Letter, Place, Side, draw_plan, draw_section_mark,
    draw_strokes, elevation, joined, legible, plan,
};
use pinswitch_drafting::{
    ABOVE_MM, Draft, Extent, Layer, Layout, Linear, Paper, Point, Projection, Shape, Sheet, Sizes, Table,
    TitleBlock, lettering, part_formats,
};
use pinswitch_solid::pose::Pose;
use pinswitch_solid::profile::Point2;

/// Scale down to which room is looked for, as a share of the largest at which the views fit.
const LEAST_SHARE: f64 = 0.5;
/// The axis is shown where it lies no further from the part, mm on paper.
const AXIS_NEAR_MM: f64 = 26.0;

/// What is drawn on a sheet.
pub(super) struct Subject<'a> {
    pub(super) design: &'a Design,
    pub(super) part: &'a Part,
    pub(super) title: TitleBlock,
    features: Features,
    /// What is seen from above.
    above: Elevation,
    /// Where the section is cut, its face, and what is seen behind it.
    cut_x: f64,
    face: Face,
    behind: Elevation,
    low: nalgebra::Point3<f64>,
    high: nalgebra::Point3<f64>,
}

/// The views of a sheet, drawn.
struct Views {
    layout: Layout,
    place: Place,
    front: Extent,
    section: Extent,
    /// What is drawn larger, where, and its letter.
    details: Vec<(Detail, Place, String)>,
}

/// A sheet that may hold a part.
#[derive(Clone, Copy, Debug)]
struct Form {
    paper: Paper,
    scale: f64,
    letter: Letter,
}

/// The sheet of `part`; nothing for a part without extent. It is drawn as a workshop holds it, where that differs from how
/// it lies in the set.
pub(super) fn part_sheet(design: &Design, part: &Part, title: TitleBlock, asked: Paper) -> Option<Sheet> {
    let turned = part.drawn.as_ref().map(|solid| part.with_solid(solid.clone()));
    let part = turned.as_ref().unwrap_or(part);
    let (low, high) = part.solid.bounds()?;
    let chamfer_mm = design.configuration().print.elephant_foot_mm;
    let mut features = features(&part.solid, chamfer_mm, design.half_span_rad());
    features.bores = fits::parted(design, part, features.bores);
    let side = if title.projection == Projection::First { Side::Left } else { Side::Right };
    let cut_x = cut_x(&features, side, (low, high));
    let cut = if side == Side::Left { -cut_x } else { cut_x };
    let seen = |side| Body::new(&part.solid, Pose::upright(-low.z), side);
    let above = elevation(&[seen(Side::Above)], None);
    let body = seen(side);
    let face = Face::new(&body, cut);
    let behind = elevation(&[body], Some(cut));
    let subject = Subject { design, part, title, features, above, cut_x, face, behind, low, high };
    // The first sheet that holds the views with all that is to be said. A part is not drawn smaller and smaller until
    // nothing is in the way of anything.
    let mut first: Option<(Form, Vec<Wanted>)> = None;
    let forms = part_formats(asked).into_iter().flat_map(|(paper, scale)| {
        [Letter::BehindLine, Letter::BeforeArrow].map(|letter| Form { paper, scale, letter })
    });
    for form in forms {
        if first.as_ref().is_some_and(|(largest, _)| form.scale < LEAST_SHARE * largest.scale) {
            break;
        }
        let Some((sheet, left)) = subject.attempt(form, &[]) else { continue };
        if left.is_empty() {
            return Some(sheet);
        }
        first.get_or_insert((form, left));
    }
    // What finds no room is written among the notes of the first that holds the views.
    let (form, left) = first?;
    subject.attempt(form, &left).map(|(sheet, _)| sheet)
}

impl Subject<'_> {
    /// The sheet in this size, and what found no room on it. `written` stands among the notes.
    fn attempt(&self, form: Form, written: &[Wanted]) -> Option<(Sheet, Vec<Wanted>)> {
        let title = TitleBlock { scale: Sheet::scale_text(form.scale), ..self.title.clone() };
        let mut draft = Draft::new(form.paper, &title);
        let views = self.views(&mut draft, form, written)?;
        let mut left = Vec::new();
        for wanted in self.wanted(&views) {
            let is_written = written.iter().any(|w| w.key == wanted.key);
            if !is_written && !wanted.place(&mut draft) {
                left.push(wanted);
            }
        }
        Some((draft.finished(self.part.name.clone(), form.scale), left))
    }

    /// Draws all views with their titles and marks, and the notes; nothing if they do not fit.
    fn views(&self, draft: &mut Draft, form: Form, written: &[Wanted]) -> Option<Views> {
        let Form { paper, scale, letter } = form;
        let details = enlarged(&self.features, scale);
        let table = hole_table::table(&self.features);
        let reach = if paper == Paper::A4 { 20.0 } else { 27.0 };
        let sizes = Sizes {
            front: self.front_extent(scale),
            depth_mm: (self.high.z - self.low.z) * scale,
            detail_mm: reach,
            details: details.len(),
            above_mm: ABOVE_MM,
            table_mm: 0.0,
            beside_mm: table.as_ref().map_or([0.0, 0.0], Table::size_mm),
        };
        let layout = Layout::new(draft, &sizes, self.title.projection)?;
        if let Some(table) = table {
            table.draw(draft, layout.beside);
        }
        let place = Place::straight(layout.front, scale);
        let lines = plan(&self.part.solid, false, self.design.configuration().print.elephant_foot_mm);
        let view = draft.view("FRONT", layout.front, scale);
        draw_plan(draft, &lines, &place, view);
        self.view_from_above(draft, &layout, scale);
        let section = self.section(draft, &layout, scale);
        let front = Extent { low: sizes.front.low + layout.front, high: sizes.front.high + layout.front };
        self.centre_lines(draft, &place, front);
        if self.is_cut() {
            let x = place.at(Point2::new(self.cut_x, 0.0)).x;
            let ends = [front.low.y - 2.0, self.mark_top(front)];
            draw_section_mark(draft, x, ends, layout.section_sense, letter);
            if !draft.place_title("section title", "A-A", 3.5, section, true) {
                return None;
            }
        }
        let mut notes = words::notes(self.design, self.part, &self.features, self.has_lettering());
        notes.extend(written.iter().map(Wanted::in_words));
        let room = draft.sheet().title_block.low.x - paper.frame().low.x - 6.0;
        draft.notes(&notes, room);
        let mut placed = Vec::new();
        for ((detail, middle), letter) in details.into_iter().zip(&layout.details).zip('B'..) {
            let letter = letter.to_string();
            let larger = draw_detail(draft, &detail, *middle, reach, &lines, &letter)?;
            placed.push((detail, larger, letter));
        }
        let views = Views { layout, place, front, section, details: placed };
        Some(views)
    }

    /// Every dimension, in the order in which they look for room.
    fn wanted(&self, views: &Views) -> Vec<Wanted> {
        let f = &self.features;
        let places = Places::of(f, views.place);
        let mut all = self.heights(&views.layout, views.place.scale, views.section);
        all.extend(angles(f, self.design.half_span_rad(), &places));
        for (detail, place, _) in &views.details {
            all.extend(dimensions::of_detail(self.design, self.part, f, detail, place));
        }
        for (detail, _, letter) in &views.details {
            let radius = detail.radius_mm * views.place.scale;
            all.push(dimensions::mark_of_detail(places.last.at(detail.middle), radius, letter));
        }
        all.extend(sides::of_part(f, &views.place, views.front, self.room_mm(views), (self.low, self.high)));
        let details: Vec<Detail> = views.details.iter().map(|d| d.0).collect();
        all.extend(dimensions::callouts(self.design, self.part, f, &places, &details));
        all.extend(hole_table::names(f, &views.place));
        all
    }

    /// What is free below and above the front view, up to the view from above, mm.
    fn room_mm(&self, views: &Views) -> [f64; 2] {
        let (front, top_mm) = (views.front, views.layout.above_mm);
        match self.title.projection {
            Projection::First => [front.low.y - top_mm, f64::INFINITY],
            Projection::Third => {
                let height_mm = (self.high.z - self.low.z) * views.place.scale;
                [f64::INFINITY, top_mm - height_mm - front.high.y]
            }
        }
    }

    /// The front view on paper about the part's origin, with the axis if it is near.
    fn front_extent(&self, scale: f64) -> Extent {
        let mut extent = Extent {
            low: Point::new(self.low.x, self.low.y) * scale,
            high: Point::new(self.high.x, self.high.y) * scale,
        };
        let is_about_axis = !self.features.axis_arcs.is_empty();
        if is_about_axis && extent.low.y > -3.0 && extent.low.y < AXIS_NEAR_MM {
            extent.low.y = -3.0;
        }
        extent
    }

    /// A plain pin is not cut lengthwise (ISO 128-44): its section is a view.
    fn is_cut(&self) -> bool {
        !matches!(self.part.role, Role::Pin { .. })
    }

    fn has_lettering(&self) -> bool {
        lettering(&self.part.solid).contains(&true)
    }

    fn view_from_above(&self, draft: &mut Draft, layout: &Layout, scale: f64) {
        let origin = Point::new(layout.front.x, layout.above_mm);
        let view = draft.view("ABOVE", origin, scale);
        let apart = CROWDED_MM / scale;
        let visible = legible(&self.above.visible, &[], apart);
        let hidden = legible(&self.above.hidden, &self.above.visible, apart);
        // Above, z grows toward the eye of the front view: down on paper.
        let at = |p: [f64; 2]| origin + Point::new(p[0], -p[1]) * scale;
        let group = draft.group();
        for (layer, strokes) in [(Layer::Visible, &visible), (Layer::Hidden, &hidden)] {
            draw_strokes(draft, layer, strokes, at, Some(view), group);
        }
    }

    /// The section with its hatching, of a pin the view from the side; returns what it covers.
    fn section(&self, draft: &mut Draft, layout: &Layout, scale: f64) -> Extent {
        let origin = Point::new(layout.section_mm, layout.front.y);
        let view = draft.view("SECTION_A", origin, scale);
        let sense = layout.section_sense;
        let at = |p: [f64; 2]| origin + Point::new(sense * p[1], p[0]) * scale;
        let group = draft.group();
        let outline = self.face.outline();
        let behind = legible(&self.behind.visible, &outline, CROWDED_MM / scale);
        let visible = joined(&[outline, behind].concat(), &[]);
        draw_strokes(draft, Layer::Visible, &visible, at, Some(view), group);
        if self.is_cut() {
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
        ends.reduce(Extent::joined).unwrap_or(Extent::between(origin, origin))
    }

    /// Where the mark of the section begins above the front view: beyond the angles that are written there.
    fn mark_top(&self, front: Extent) -> f64 {
        let f = &self.features;
        let patterns = usize::from(!f.ends.is_empty())
            + f.roundings.iter().filter(|r| r.is_half_round && r.arcs.len() > 2).count()
            + f.slots.iter().filter(|s| s.places.len() > 2).count();
        let angles = if f.axis_arcs.is_empty() || patterns == 0 { 0.0 } else { 7.0 + 8.0 * patterns as f64 };
        front.high.y + 2.0 + angles
    }

    /// The plane of symmetry, the axis, pitch circles and middles of holes.
    fn centre_lines(&self, draft: &mut Draft, place: &Place, front: Extent) {
        let group = draft.group();
        let f = &self.features;
        let mut line =
            |from: Point, to: Point| draft.put(Layer::Centre, Shape::Line { from, to }, None, group);
        let axis = place.at(Point2::origin());
        if !f.axis_arcs.is_empty() {
            if self.cut_x.abs() > 1e-6 || !self.is_cut() {
                line(Point::new(axis.x, front.low.y - 2.0), Point::new(axis.x, front.high.y + 3.0));
            }
            if axis.y > front.low.y - 1.0 {
                let half = if front.low.y < axis.y - 4.0 { front.width() / 2.0 + 3.0 } else { 8.0 };
                line(axis - Point::new(half, 0.0), axis + Point::new(half, 0.0));
            }
        }
        let rounds = f.rounds.iter().map(|r| (&r.centres, r.levels.iter().map(|l| l.1).fold(0.0, f64::max)));
        for (centres, radius_mm) in rounds.chain(f.bores.iter().map(|b| (&b.centres, b.reach_mm()))) {
            for centre in centres {
                let (at, reach) = (place.at(*centre), radius_mm * place.scale + 1.5);
                let is_on_axis = centre.coords.norm() < 1e-6;
                let along = if is_on_axis || f.axis_arcs.is_empty() {
                    Point::new(0.0, 1.0)
                } else {
                    (at - axis).unit()
                };
                line(at - along * reach, at + along * reach);
                line(at - along.left() * reach, at + along.left() * reach);
            }
        }
    }

    /// The heights of the part's own faces over its bottom, measured in the section.
    fn heights(&self, layout: &Layout, scale: f64, section: Extent) -> Vec<Wanted> {
        let foot = section.low.y;
        let x = |z: f64| layout.section_mm + layout.section_sense * z * scale;
        let all = &self.features.heights_mm;
        all.iter()
            .map(|z| {
                let key = if Some(z) == all.last() {
                    "overall height".to_owned()
                } else {
                    format!("height {}", words::number(*z))
                };
                Wanted::linear(Linear {
                    key,
                    text: words::number(*z),
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
