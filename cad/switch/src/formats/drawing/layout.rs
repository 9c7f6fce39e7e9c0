//! Where the views of a part lie on its sheet.

use pinswitch_drafting::{Draft, Extent, Paper, Point, Projection};

/// Scales of views (ISO 5455), the largest first.
const SCALES: [f64; 9] = [5.0, 2.0, 1.0, 0.5, 0.2, 0.1, 0.05, 0.02, 0.01];
/// Left of the front view: room for what is written there, mm.
const LEFT_MM: f64 = 38.0;
/// Above the front view: room for angles and the mark of the section, mm.
pub(super) const ABOVE_MM: f64 = 36.0;
/// The same without angles: room for the mark of the section and a balloon, mm.
pub(super) const ABOVE_ASSEMBLY_MM: f64 = 22.0;
/// Between the front view and the view below or above it, mm.
const BETWEEN_MM: f64 = 17.0;
/// Between the front view and the section, mm.
const BESIDE_MM: f64 = 32.0;
/// Right of the section, mm.
const RIGHT_MM: f64 = 24.0;
/// Below the lowest view, mm.
const BELOW_MM: f64 = 8.0;
/// Around a detail, for its dimensions and its title, mm: to the sides, and above and below.
const AROUND_DETAIL_MM: (f64, f64) = (32.0, 26.0);

/// Between a table beside the views and the frame or a detail, mm.
const AROUND_TABLE_MM: f64 = 5.0;

/// Sheets and scales in the order in which they are tried. A part that does not fit A4 at twice its size gets A3 for that,
/// a small one whose dimensions find no room there A3 at five times its size, and the others A4 before they are reduced.
pub(super) fn choices(asked: Paper) -> Vec<(Paper, f64)> {
    let on_a3 = SCALES.iter().map(|s| (Paper::A3, *s));
    if asked == Paper::A3 {
        return on_a3.collect();
    }
    let first = [(Paper::A4, 5.0), (Paper::A4, 2.0), (Paper::A3, 2.0), (Paper::A3, 5.0), (Paper::A4, 1.0)];
    first.into_iter().chain(on_a3.filter(|(_, s)| *s <= 1.0)).collect()
}

/// The same for the assembly, which needs more room beside its list of parts, and less exactness: a larger scale comes first.
/// Last, the columns in which the list stands: before an assembly is reduced, its list goes into two.
pub(super) fn choices_of_assembly(asked: Paper) -> Vec<(Paper, f64, usize)> {
    let on_a4 = [(Paper::A4, 5.0, 1), (Paper::A4, 2.0, 1)].into_iter().filter(|_| asked == Paper::A4);
    let columns = |scale: f64| if scale > 1.0 { 1..=1 } else { 1..=2 };
    on_a4.chain(SCALES.iter().flat_map(|s| columns(*s).map(|n| (Paper::A3, *s, n)))).collect()
}

/// What is to be laid out: sizes on paper, mm.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sizes {
    /// The front view, about the part's origin.
    pub(super) front: Extent,
    /// Thickness along the axis, which is the height of the view from above and the width of the section.
    pub(super) depth_mm: f64,
    /// Radius of the circle of a detail, and how many there are.
    pub(super) detail_mm: f64,
    pub(super) details: usize,
    /// Above the front view, mm.
    pub(super) above_mm: f64,
    /// Height over the title block that a table takes, mm.
    pub(super) table_mm: f64,
    /// Width and height of a table at the upper right, mm; 0 without one.
    pub(super) beside_mm: [f64; 2],
}

/// Where everything lies.
#[derive(Clone, Debug)]
pub(super) struct Layout {
    /// The part's origin in the front view.
    pub(super) front: Point,
    /// The plane z = 0 in the view from above, which grows downward with z; its x is that of the front view.
    pub(super) above_mm: f64,
    /// The plane z = 0 in the section, whose y is that of the front view.
    pub(super) section_mm: f64,
    /// +1 if z grows to the right in the section.
    pub(super) section_sense: f64,
    /// Middles of the details.
    pub(super) details: Vec<Point>,
    /// Lower right corner of the table beside the views.
    pub(super) beside: Point,
}

impl Layout {
    /// A layout on an empty sheet; nothing if it is too small.
    pub(super) fn on(draft: &Draft, sizes: &Sizes, projection: Projection) -> Option<Self> {
        let frame = draft.sheet().paper.frame();
        let floor = draft.sheet().title_block.high.y + 3.0 + sizes.table_mm;
        let (width, height) = (sizes.front.width(), sizes.front.height());
        let detail_column = if sizes.details == 0 { 0.0 } else { 2.0 * sizes.detail_mm + AROUND_DETAIL_MM.0 };
        let [table_wide, table_high] = sizes.beside_mm;
        let table_column = if table_wide > 0.0 { table_wide + AROUND_TABLE_MM } else { 0.0 };
        let wanted =
            LEFT_MM + width + BESIDE_MM + sizes.depth_mm + RIGHT_MM + detail_column.max(table_column);
        let spare_x = frame.width() - wanted;
        let stack = sizes.above_mm + height + BETWEEN_MM + sizes.depth_mm + BELOW_MM;
        let spare_y = frame.high.y - floor - stack;
        let ceiling = frame.high.y - if table_high > 0.0 { table_high + AROUND_TABLE_MM } else { 0.0 };
        let details_fit =
            sizes.details as f64 * (2.0 * sizes.detail_mm + AROUND_DETAIL_MM.1) <= ceiling - floor;
        if spare_x < 0.0 || spare_y < 0.0 || !details_fit {
            return None;
        }
        let left = frame.low.x + LEFT_MM + (spare_x * 0.3).min(30.0);
        let section_left = left + width + BESIDE_MM + (spare_x * 0.3).min(30.0);
        let (front_top, above_top) = match projection {
            Projection::First => {
                let front_top = frame.high.y - sizes.above_mm - spare_y * 0.35;
                (front_top, front_top - height - BETWEEN_MM - spare_y * 0.3)
            }
            // The view from above needs no room above it; the angles of the front view come between.
            Projection::Third => {
                let above_top = frame.high.y - BELOW_MM - spare_y * 0.2;
                (above_top - sizes.depth_mm - sizes.above_mm - spare_y * 0.3, above_top)
            }
        };
        let front = Point::new(left - sizes.front.low.x, front_top - sizes.front.high.y);
        let column = section_left + sizes.depth_mm + RIGHT_MM;
        let middle = f64::midpoint(column, frame.high.x);
        let each = (ceiling - floor) / sizes.details.max(1) as f64;
        let details =
            (0..sizes.details).map(|i| Point::new(middle, ceiling - each * (i as f64 + 0.5) - 1.0)).collect();
        // From the left, z runs to the right; from the right, to the left.
        let (section_mm, section_sense) = match projection {
            Projection::First => (section_left, 1.0),
            Projection::Third => (section_left + sizes.depth_mm, -1.0),
        };
        let beside = Point::new(frame.high.x - AROUND_TABLE_MM, frame.high.y - AROUND_TABLE_MM - table_high);
        Some(Self { front, above_mm: above_top, section_mm, section_sense, details, beside })
    }
}
