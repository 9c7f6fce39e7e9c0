//! The isometric and the exploded view of the assembly, in the free space of its sheet.

use crate::built::Built;
use crate::hardware::{Hardware, HardwareKind, hardware};
use crate::parts::{Part, Role};
use pinswitch_drafting::view::{Shifted, Stroke, draw_strokes, isometric, legible};
use pinswitch_drafting::{Draft, Extent, Layer, Point, Sheet};
use pinswitch_solid::pose::Pose;

/// Scales of the pictures relative to that of the main views, the largest first.
const SCALES: [f64; 9] = [5.0, 2.0, 1.0, 0.5, 0.2, 0.1, 0.05, 0.02, 0.01];
/// Least scale, as a share of that of the main views.
const LEAST_SHARE: f64 = 0.2;
/// Free space around a picture, mm on paper.
const AROUND_MM: f64 = 4.0;
/// Least distance between parallel lines, mm on paper.
const APART_MM: f64 = 0.45;
/// Height of the title and space for it below the picture, mm on paper.
const TITLE_MM: f64 = 3.5;
const TITLE_SPACE_MM: f64 = 8.0;
/// Step of the positions that are tried, mm on paper.
const STEP_MM: f64 = 4.0;
/// Distance of screws, dowels and inserts from the exploded parts, and of nuts, mm.
const SCREW_APART_MM: f64 = 18.0;
const NUT_APART_MM: f64 = 22.0;
/// Additional distance of screws from a mounting plate, mm.
const MOUNT_APART_MM: f64 = 16.0;

/// A picture of the assembly.
pub(super) struct Picture {
    view: &'static str,
    title: &'static str,
    strokes: Vec<Stroke>,
    low: [f64; 2],
    high: [f64; 2],
}

/// Returns the exploded and the isometric view of these bodies with the bought hardware.
pub(super) fn pictures(built: &Built, bodies: &[(&Part, Pose)]) -> Vec<Picture> {
    let design = built.design();
    // The sheet omits the stand: with it, the switch would be too small.
    let bought: Vec<Hardware> =
        hardware(design).into_iter().filter(|body| !body.kind.is_of_stand()).collect();
    let has_mount = bodies.iter().any(|(part, _)| part.role == Role::Mount);
    let of = |view, title, explosion: f64| {
        let parts = bodies.iter().map(|(part, pose)| {
            let by = part.role.explode_offset_mm() * explosion;
            Shifted { solid: &part.solid, pose: *pose, by: [by.x, by.y, by.z] }
        });
        let hardware = bought.iter().map(|body| {
            let length_mm = body.solid.bounds().map_or(0.0, |(low, high)| high.z - low.z);
            let apart_mm = match body.kind {
                HardwareKind::Nut | HardwareKind::BoltNut | HardwareKind::Washer => NUT_APART_MM,
                _ => length_mm + SCREW_APART_MM,
            };
            let z = if body.from_right {
                apart_mm
            } else {
                -apart_mm - if has_mount { MOUNT_APART_MM } else { 0.0 }
            };
            Shifted { solid: &body.solid, pose: Pose::upright(0.0), by: [0.0, 0.0, z * explosion] }
        });
        let all: Vec<Shifted<'_>> = parts.chain(hardware).collect();
        Picture::new(view, title, isometric(&all))
    };
    [of("EXPLODED", "Exploded view", 1.0), of("ISOMETRIC", "Isometric view", 0.0)]
        .into_iter()
        .flatten()
        .collect()
}

impl Picture {
    /// Creates a picture; `None` without lines.
    fn new(view: &'static str, title: &'static str, strokes: Vec<Stroke>) -> Option<Self> {
        let ends = |i: usize| {
            let all = strokes.iter().flatten().map(move |p| p[i]);
            all.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)))
        };
        let [(left, right), (foot, top)] = [ends(0), ends(1)];
        (left < right && foot < top).then_some(Self {
            view,
            title,
            low: [left, foot],
            high: [right, top],
            strokes,
        })
    }

    /// Draws the picture in free space, at the largest scale that has it and not larger than `most`; returns whether
    /// there was space.
    pub(super) fn place(&self, draft: &mut Draft, most: f64) -> bool {
        let scales = SCALES.into_iter().filter(|scale| (LEAST_SHARE * most..=most).contains(scale));
        let found = scales.filter_map(|scale| Some((scale, self.free(draft, scale)?))).next();
        let Some((scale, low)) = found else { return false };
        let origin = low + Point::new(AROUND_MM, AROUND_MM + TITLE_SPACE_MM)
            - Point::new(self.low[0], self.low[1]) * scale;
        let view = draft.view(self.view, origin, scale);
        let at = |p: [f64; 2]| origin + Point::new(p[0], p[1]) * scale;
        let group = draft.group();
        // Thin lines: a picture is smaller than the main views, and has no dimensions.
        let strokes = legible(&self.strokes, &[], APART_MM / scale);
        draw_strokes(draft, Layer::Thin, &strokes, at, Some(view), group);
        let title = format!("{} ({})", self.title, Sheet::scale_text(scale));
        let around = Extent { low: at(self.low), high: at(self.high) };
        draft.place_title(&self.title.to_lowercase(), &title, TITLE_MM, around, false)
    }

    /// Returns the lower left corner of free space for the picture with its title: of all such places, the one nearest
    /// to their middle. `None` without one.
    fn free(&self, draft: &Draft, scale: f64) -> Option<Point> {
        let size = Point::new(
            (self.high[0] - self.low[0]) * scale + 2.0 * AROUND_MM,
            (self.high[1] - self.low[1]) * scale + 2.0 * AROUND_MM + TITLE_SPACE_MM,
        );
        let frame = draft.sheet().paper.frame();
        let steps = |room: f64| if room < 0.0 { 0 } else { (room / STEP_MM) as u32 + 1 };
        let (columns, rows) = (steps(frame.width() - size.x), steps(frame.height() - size.y));
        let at = |column: u32, row: u32| {
            frame.low + Point::new(f64::from(column) * STEP_MM, f64::from(row) * STEP_MM)
        };
        let places: Vec<Point> = (0..rows)
            .flat_map(|row| (0..columns).map(move |column| at(column, row)))
            .filter(|low| draft.is_free(Extent { low: *low, high: *low + size }))
            .collect();
        let number = places.len() as f64;
        let middle = places.iter().fold(Point::new(0.0, 0.0), |sum, p| sum + *p * (1.0 / number));
        places.into_iter().min_by(|a, b| (*a - middle).length().total_cmp(&(*b - middle).length()))
    }
}
