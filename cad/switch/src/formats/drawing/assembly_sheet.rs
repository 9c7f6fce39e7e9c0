//! The sheet of the assembly: front view, view from above and section, with balloons, overall dimensions, the wrap, and the
//! parts list; an isometric and an exploded view in the free space.

use super::assembly_hardware;
use super::assembly_pictures::{Picture, pictures};
use super::parts_list::{Item, items};
use super::words;
use crate::built::Built;
use crate::design::Design;
use crate::parts::{Part, Role};
use pinswitch_drafting::view::{
    Body, CROWDED_MM, Elevation, Face, HATCH_MM, Letter, Place, Placed, Side, Trace, draw_plan,
    draw_section_mark, draw_strokes, elevation, joined, legible, stacked_plan,
};
use pinswitch_drafting::{
    ABOVE_ASSEMBLY_MM, ABOVE_MM, Angular, Callout, Draft, Extent, Layer, Layout, Leader, Linear, Paper,
    Point, Projection, Shape, Sheet, Sizes, Table, TitleBlock, assembly_formats, lettering, number,
};
use pinswitch_solid::pose::Pose;
use pinswitch_solid::profile::{Arc, Contour, Point2, polar};
use std::f64::consts::FRAC_PI_2;

/// Height of the legend under the views, mm.
const LEGEND_MM: f64 = 2.5;

/// The assembly with its views.
struct Assembly<'a> {
    design: &'a Design,
    bodies: Vec<(&'a Part, Pose)>,
    items: Vec<Item>,
    title: TitleBlock,
    /// Lowest and highest z.
    z_mm: (f64, f64),
    above: Elevation,
    /// The x of the cutting plane, the cut face of each body, and the view behind the cut.
    cut_x: f64,
    faces: Vec<Face>,
    behind: Elevation,
    pictures: Vec<Picture>,
}

/// Returns the sheet of the assembly, on `paper` or a larger one; `None` if it is too large for any paper.
pub(super) fn assembly_sheet(built: &Built, title: TitleBlock, paper: Paper) -> Option<Sheet> {
    // Parts on the table would make the switch too small.
    let shown = built.assembly().filter(|b| b.part.role != Role::Stand);
    let bodies: Vec<(&Part, Pose)> = shown.filter_map(|b| Some((&b.part, b.part.pose?))).collect();
    let ends = bodies.iter().filter_map(|(part, pose)| {
        let (low, high) = part.solid.bounds()?;
        let height = |z: f64| if pose.flipped { pose.z_mm - z } else { pose.z_mm + z };
        Some((height(low.z).min(height(high.z)), height(low.z).max(height(high.z))))
    });
    let z_mm = ends.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))?;
    let design = built.design();
    let side = if title.projection == Projection::First { Side::Left } else { Side::Right };
    let cut_x = cut_x(design);
    let cut = if side == Side::Left { -cut_x } else { cut_x };
    let from_side = seen(&bodies, z_mm.0, side);
    let assembly = Assembly {
        design,
        items: items(built),
        above: elevation(&seen(&bodies, z_mm.0, Side::Above), None),
        cut_x,
        faces: from_side.iter().map(|body| Face::new(body, cut)).collect(),
        behind: elevation(&from_side, Some(cut)),
        pictures: pictures(built, &bodies),
        bodies,
        title,
        z_mm,
    };
    // On a sheet without space for them, the pictures are left out.
    [true, false].into_iter().find_map(|has_pictures| {
        let mut formats = assembly_formats(paper).into_iter();
        formats.find_map(|(paper, scale, columns)| assembly.attempt(paper, scale, columns, has_pictures))
    })
}

/// The x of the pin nearest to the middle.
fn cut_x(design: &Design) -> f64 {
    let radius = design.contact_radius_mm();
    let xs = design.pin_angles_rad().into_iter().map(|a| polar(radius, a).x);
    xs.min_by(|a, b| a.abs().total_cmp(&b.abs())).unwrap_or(0.0)
}

/// Formats an overall length, which follows from the dimensions of the parts, in tenths of a millimetre.
fn auxiliary(mm: f64) -> String {
    format!("({})", number((mm * 10.0).round() / 10.0))
}

/// The bodies viewed from a side, the lowest at z = 0.
fn seen(bodies: &[(&Part, Pose)], lowest_mm: f64, side: Side) -> Vec<Body> {
    let place = |pose: &Pose| Pose { z_mm: pose.z_mm - lowest_mm, ..*pose };
    bodies.iter().map(|(part, pose)| Body::new(&part.solid, place(pose), side)).collect()
}

impl Assembly<'_> {
    fn attempt(&self, paper: Paper, scale: f64, columns: usize, has_pictures: bool) -> Option<Sheet> {
        let title = TitleBlock { scale: Sheet::scale_text(scale), ..self.title.clone() };
        let projection = title.projection;
        let mut draft = Draft::new(paper, &title);
        let (block, frame) = (draft.sheet().title_block, paper.frame());
        let lists = self.lists(columns, block.height());
        // The first list is on the title block, the second one left of both.
        let list_mm = lists.iter().enumerate().fold(0.0f64, |most, (i, list)| {
            most.max(list.height_mm() - if i == 0 { 0.0 } else { block.height() })
        });
        let sizes = Sizes {
            front: self.front_extent(scale),
            depth_mm: (self.z_mm.1 - self.z_mm.0) * scale,
            detail_mm: 0.0,
            details: 0,
            above_mm: if columns == 1 { ABOVE_MM } else { ABOVE_ASSEMBLY_MM },
            table_mm: list_mm + 3.0,
            right_table_mm: [0.0, 0.0],
        };
        let layout = Layout::new(&draft, &sizes, projection)?;
        for (i, list) in lists.iter().enumerate() {
            let corner = if i == 0 {
                Point::new(block.high.x, block.high.y)
            } else {
                Point::new(block.low.x, frame.low.y)
            };
            list.draw(&mut draft, corner);
        }
        let cut_x = self.cut_x;
        let place = Place::straight(layout.front, scale);
        self.draw_front(&mut draft, &place);
        self.draw_view_from_above(&mut draft, &layout, scale);
        let (section, inside) = self.draw_section(&mut draft, &layout, scale);
        let front = Extent { low: sizes.front.low + layout.front, high: sizes.front.high + layout.front };
        let above = Extent {
            low: Point::new(front.low.x, layout.above_mm - sizes.depth_mm),
            high: Point::new(front.high.x, layout.above_mm),
        };
        let lowest = if above.low.y < front.low.y { above } else { front };
        let mark = [front.low.y - 2.0, front.high.y + 2.0];
        draw_section_mark(
            &mut draft,
            place.at(Point2::new(cut_x, 0.0)).x,
            mark,
            layout.section_sense,
            Letter::BehindLine,
        );
        if !draft.place_title("section title", "A-A", 3.5, section, true) {
            return None;
        }
        let is_placed = self.draw_overall(&mut draft, section)
            && self.draw_size(&mut draft, &place, front, lowest)
            && self.draw_wrap(&mut draft, &place, lowest)
            && self
                .items
                .iter()
                .all(|item| self.draw_balloon(&mut draft, item, &place, &inside, &[front, section]))
            && self.draw_legend(&mut draft, lowest)
            && (!has_pictures || self.pictures.iter().all(|picture| picture.place(&mut draft, scale)));
        is_placed.then(|| draft.into_sheet("assembly", scale))
    }

    fn front_extent(&self, scale: f64) -> Extent {
        let reach = self.design.contact_radius_mm() + self.design.tendon_diameter_mm();
        let axis = Point::new(0.0, 0.0);
        let mut extent = Extent::between(Point::new(0.0, reach * scale), Point::new(0.0, reach * scale));
        for (part, pose) in &self.bodies {
            let Some((low, high)) = part.solid.bounds() else { continue };
            let (left, right) = if pose.flipped { (-high.x, -low.x) } else { (low.x, high.x) };
            extent = extent
                .union(Extent::between(Point::new(left, low.y) * scale, Point::new(right, high.y) * scale));
        }
        if extent.low.y > 0.0 && extent.low.y < 26.0 {
            extent.union(Extent::between(axis, axis))
        } else {
            extent
        }
    }

    /// Draws the front view, with hardware and tendon.
    fn draw_front(&self, draft: &mut Draft, place: &Place) {
        let chamfer_mm = self.design.configuration().print.elephant_foot_mm;
        // The support on the far side is behind its equal.
        let placed = self.bodies.iter().map(|(part, pose)| Placed {
            solid: &part.solid,
            pose: *pose,
            is_drawn: !matches!(part.role, Role::Support { .. }),
        });
        let bodies: Vec<Placed<'_>> = placed.collect();
        let lines = stacked_plan(&bodies, self.z_mm.0, chamfer_mm);
        let view = draft.view("FRONT", place.origin, place.scale);
        draw_plan(draft, &lines, place, view);
        let group = draft.group();
        for (layer, trace) in assembly_hardware::front(self.design) {
            draft.put(layer, place.shape(&trace), None, group);
        }
        for trace in self.tendon() {
            draft.put(Layer::Phantom, place.shape(&trace), None, group);
        }
        let axis = place.at(Point2::origin());
        let frame = draft.sheet().paper.frame();
        if axis.y > frame.low.y + 40.0 && lines.len() > 1 {
            let half = Point::new(6.0, 0.0);
            draft.put(Layer::Centre, Shape::Line { from: axis - half, to: axis + half }, None, group);
        }
    }

    /// The axis of the tendon over the wrap.
    fn tendon(&self) -> Vec<Trace> {
        let c = self.design.configuration();
        let radius_mm = self.design.contact_radius_mm()
            + c.pins.diameter_mm / 2.0
            + self.design.tendon_diameter_mm() / 2.0;
        let wrap = c.layout.wrap_angle_deg.to_radians();
        vec![Trace::Arc(Arc {
            centre: Point2::origin(),
            radius_mm,
            start_rad: FRAC_PI_2 - wrap / 2.0,
            sweep_rad: wrap,
        })]
    }

    fn draw_view_from_above(&self, draft: &mut Draft, layout: &Layout, scale: f64) {
        let origin = Point::new(layout.front.x, layout.above_mm);
        let view = draft.view("ABOVE", origin, scale);
        let visible = legible(&self.above.visible, &[], CROWDED_MM / scale);
        let at = |p: [f64; 2]| origin + Point::new(p[0], -p[1]) * scale;
        let group = draft.group();
        draw_strokes(draft, Layer::Visible, &visible, at, Some(view), group);
        let screws = assembly_hardware::side_view(self.design, self.z_mm.0, |p| Some(p.x));
        draw_strokes(draft, Layer::Visible, &screws, at, None, group);
    }

    /// Draws the section, with a hatching for each body but the pins. Returns its extent, and a point in each body.
    fn draw_section(&self, draft: &mut Draft, layout: &Layout, scale: f64) -> (Extent, Vec<(String, Point)>) {
        let origin = Point::new(layout.section_mm, layout.front.y);
        let view = draft.view("SECTION_A", origin, scale);
        let at = |p: [f64; 2]| origin + Point::new(layout.section_sense * p[1], p[0]) * scale;
        let group = draft.group();
        let mut outlines: Vec<_> = self.faces.iter().flat_map(Face::outline).collect();
        let behind = legible(&self.behind.visible, &outlines, CROWDED_MM / scale);
        outlines.extend(behind);
        let mut inside = Vec::new();
        for (i, ((part, _), face)) in self.bodies.iter().zip(&self.faces).enumerate() {
            if let Some(place) = face.inside() {
                inside.push((part.name.clone(), at(place)));
            }
            if face.is_empty() || matches!(part.role, Role::Pin { .. }) {
                continue;
            }
            let apart = HATCH_MM / scale * if part.role == Role::Layer { 0.55 } else { 1.0 };
            draw_strokes(draft, Layer::Hatch, &face.hatch(apart, i % 2 == 0), at, Some(view), group);
        }
        let outlines = joined(&outlines, &[]);
        draw_strokes(draft, Layer::Visible, &outlines, at, Some(view), group);
        let is_behind = |x: f64| (x - self.cut_x) * if self.is_viewed_from_left() { 1.0 } else { -1.0 } > 0.0;
        let screws =
            assembly_hardware::side_view(self.design, self.z_mm.0, |p| is_behind(p.x).then_some(p.y));
        draw_strokes(draft, Layer::Visible, &screws, at, None, group);
        let corners = outlines.iter().flatten().map(|p| Extent::between(at(*p), at(*p)));
        (corners.reduce(Extent::union).unwrap_or(Extent::between(origin, origin)), inside)
    }

    /// Draws the meaning of the label and the marks on the supports; returns whether there is space.
    fn draw_legend(&self, draft: &mut Draft, lowest_view: Extent) -> bool {
        let is_right = |part: &Part| matches!(part.role, Role::Support { outwards_z } if outwards_z > 0.0);
        let right = self.bodies.iter().find(|(part, _)| is_right(part));
        let marks = right.and_then(|(part, _)| words::marks(&part.engraved));
        let all = [("layout", Some(words::layout(self.design))), ("marks", marks)];
        all.into_iter()
            .filter_map(|(key, words)| Some((key, words?)))
            .all(|(key, words)| draft.place_title(key, &words, LEGEND_MM, lowest_view, false))
    }

    /// Returns whether the section is viewed from the left.
    fn is_viewed_from_left(&self) -> bool {
        self.title.projection == Projection::First
    }

    /// Draws length and height of all parts but the tendon; returns whether there is space.
    fn draw_size(&self, draft: &mut Draft, place: &Place, front: Extent, lowest: Extent) -> bool {
        let solid = self.bodies.iter().filter(|(part, _)| part.role != Role::Tendon);
        let corners = solid.filter_map(|(part, pose)| {
            let (low, high) = part.solid.bounds()?;
            let (left, right) = if pose.flipped { (-high.x, -low.x) } else { (low.x, high.x) };
            Some([left, right, low.y, high.y])
        });
        let ends = corners.reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1]), a[2].min(b[2]), a[3].max(b[3])]);
        let Some([left, right, low, high]) = ends else { return true };
        let at = |x: f64, y: f64| place.at(Point2::new(x, y));
        let (foot, top) = (at(left, low), at(left, high));
        let height = Linear {
            key: "overall height".to_owned(),
            text: auxiliary(high - low),
            from: foot,
            to: top,
            upright: true,
            edge_mm: front.low.x,
            outward: -1.0,
            room_mm: f64::INFINITY,
            clear_of: [foot.y, top.y],
        };
        let (from, to) = (at(left, low).x, at(right, low).x);
        let length = Linear {
            key: "overall length".to_owned(),
            text: auxiliary(right - left),
            from: Point::new(from, lowest.low.y),
            to: Point::new(to, lowest.low.y),
            upright: false,
            edge_mm: lowest.low.y,
            outward: -1.0,
            room_mm: f64::INFINITY,
            clear_of: [from, to],
        };
        height.place(draft) && length.place(draft)
    }

    /// Draws the wrap angle and the radius of the contact, or their text below the views; returns whether there is space.
    fn draw_wrap(&self, draft: &mut Draft, place: &Place, lowest: Extent) -> bool {
        let (wrap_deg, radius_mm) =
            (self.design.configuration().layout.wrap_angle_deg, self.design.contact_radius_mm());
        let half = wrap_deg.to_radians() / 2.0;
        let angle = Angular {
            key: "wrap angle".to_owned(),
            text: format!("wrap {}\u{b0}", number(wrap_deg)),
            centre: place.origin,
            from_rad: FRAC_PI_2 - half,
            to_rad: FRAC_PI_2 + half,
            begins_mm: radius_mm * place.scale,
            edge_mm: self.design.support_radius_mm() * place.scale,
            is_inside: false,
            is_exact: false,
        };
        let leaders = [-0.95, -0.8, -0.6, -0.4, 0.4, 0.6, 0.8, 0.95].into_iter().flat_map(|share| {
            let tip = place.at(polar(radius_mm, share * half));
            let outward = (tip - place.origin).unit();
            [-0.5, 0.0, 0.5].map(|turn: f64| Leader {
                tip,
                direction: Point::towards(outward.angle_rad() + turn),
                cost_mm: 0.0,
            })
        });
        let radius = Callout {
            key: "contact radius".to_owned(),
            lines: vec![format!("contact R{}", number(radius_mm))],
            leaders: leaders.collect(),
            is_balloon: false,
            avoid: Vec::new(),
            around: None,
            indicators: Vec::new(),
            datum: None,
        };
        let mut words = Vec::new();
        if half >= std::f64::consts::PI || !angle.place(draft) {
            words.push(angle.text);
        }
        if !radius.place(draft) {
            words.extend(radius.lines);
        }
        words.is_empty() || draft.place_title("wrap", &words.join(", "), LEGEND_MM, lowest, false)
    }

    /// Draws the width over both supports; returns whether there is space.
    fn draw_overall(&self, draft: &mut Draft, section: Extent) -> bool {
        let corner = Point::new(section.high.x, section.low.y);
        let linear = Linear {
            key: "overall width".to_owned(),
            text: number(self.z_mm.1 - self.z_mm.0),
            from: section.low,
            to: corner,
            upright: false,
            edge_mm: section.low.y,
            outward: -1.0,
            room_mm: f64::INFINITY,
            clear_of: [section.low.x, section.high.x],
        };
        linear.place(draft)
    }

    /// The parts list in one or two columns of equal height; the first is on a title block `block_mm` high.
    fn lists(&self, columns: usize, block_mm: f64) -> Vec<Table> {
        let whole = self.list(&self.items);
        let on_block = (whole.rows.len() as f64 - block_mm / Table::ROW_MM) / 2.0;
        let first = on_block.ceil().max(0.0) as usize;
        if columns == 1 || first == 0 || first >= self.items.len() {
            return vec![whole];
        }
        let (head, tail) = self.items.split_at(first);
        vec![self.list(head), self.list(tail)]
    }

    fn list(&self, items: &[Item]) -> Table {
        let columns =
            [("Item", 12.0), ("Qty", 12.0), ("Designation", 82.0), ("Part number", 44.0), ("Material", 30.0)];
        let rows = items.iter().map(|i| {
            let item = i.number.to_string();
            vec![item, i.quantity.clone(), i.designation.clone(), i.part_number.clone(), i.material.clone()]
        });
        Table {
            key: "bill of materials".to_owned(),
            columns: columns.map(|(word, width)| (word.to_owned(), width)).to_vec(),
            rows: rows.collect(),
            reads_down: false,
        }
    }

    /// Draws the balloon of an item; returns whether there is space. Items that are not visible have none.
    fn draw_balloon(
        &self,
        draft: &mut Draft,
        item: &Item,
        place: &Place,
        inside: &[(String, Point)],
        views: &[Extent],
    ) -> bool {
        let all_directions = |tip: Point| {
            (0..24).map(move |i| Leader {
                tip,
                direction: Point::towards(std::f64::consts::TAU * (f64::from(i) + 0.5) / 24.0),
                cost_mm: 0.0,
            })
        };
        let leaders: Vec<Leader> = match item.shown.as_str() {
            "" => return true,
            "tendon" => self
                .tendon()
                .iter()
                .filter_map(|t| if let Trace::Arc(arc) = t { Some(arc) } else { None })
                .flat_map(|arc| {
                    [0.02, 0.2, 0.35, 0.65, 0.8, 0.98].map(|share| {
                        let tip = place.at(arc.point_at(share, arc.radius_mm));
                        Leader { tip, direction: (tip - place.origin).unit(), cost_mm: 0.0 }
                    })
                })
                .collect(),
            kind if !assembly_hardware::places(self.design, kind).is_empty() => {
                assembly_hardware::places(self.design, kind)
                    .into_iter()
                    .flat_map(|(at, radius_mm)| Leader::to_circle(place.at(at), radius_mm * place.scale))
                    .collect()
            }
            name => match inside.iter().find(|(n, _)| n == name) {
                Some((_, tip)) => all_directions(*tip).collect(),
                None => self.on_front(name, place).into_iter().flat_map(all_directions).collect(),
            },
        };
        let balloon = Callout {
            key: format!("balloon {}", item.number),
            lines: vec![item.number.to_string()],
            leaders,
            is_balloon: true,
            avoid: views.to_vec(),
            around: None,
            indicators: Vec::new(),
            datum: None,
        };
        balloon.place(draft)
    }

    /// Corners of a body in the front view, for one that the section does not cut.
    fn on_front(&self, name: &str, place: &Place) -> Vec<Point> {
        let of_name = self.bodies.iter().filter(|(part, _)| part.name == name);
        of_name
            .flat_map(|(part, pose)| {
                let letters = lettering(&part.solid);
                let outline = part.solid.rings().zip(letters).find(|(_, is)| !is).map(|((c, _), _)| c);
                let corners = outline.map_or_else(Vec::new, |c: &Contour| c.corners().to_vec());
                let sign = if pose.flipped { -1.0 } else { 1.0 };
                corners.into_iter().map(move |p| place.at(Point2::new(sign * p.x, p.y)))
            })
            .collect()
    }
}
