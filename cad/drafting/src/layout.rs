//! Positions of views, details and tables on a sheet, and the papers and scales to try.

use crate::{Draft, Extent, Paper, Point, Projection};

/// Scales of views (ISO 5455), the largest first.
const SCALES: [f64; 9] = [5.0, 2.0, 1.0, 0.5, 0.2, 0.1, 0.05, 0.02, 0.01];
/// Space for dimensions left of the front view, mm.
const LEFT_MM: f64 = 38.0;
/// Space above the front view for angles and the mark of the section, mm.
pub const ABOVE_MM: f64 = 36.0;
/// Space above the front view for the mark of the section and a balloon, mm.
pub const ABOVE_ASSEMBLY_MM: f64 = 22.0;
/// Space between the front view and the view from above, mm.
const BETWEEN_MM: f64 = 17.0;
/// Space between the front view and the section, mm.
const BESIDE_MM: f64 = 32.0;
/// Space right of the section, mm.
const RIGHT_MM: f64 = 24.0;
/// Space below the lowest view, mm.
const BELOW_MM: f64 = 8.0;
/// Space around a detail for its dimensions and its title, mm: across and up.
const AROUND_DETAIL_MM: (f64, f64) = (32.0, 26.0);
/// Space around a table next to the views, mm.
const AROUND_TABLE_MM: f64 = 5.0;

/// Returns papers and scales for a part, in the order to try them.
///
/// A part that does not fit on A4 at 2:1 gets A3, at 5:1 if possible, so that its views fill the sheet, and else at 2:1.
/// Other parts are drawn at 1:1 on A4 before they are reduced.
#[must_use]
pub fn part_formats(preferred: Paper) -> Vec<(Paper, f64)> {
    let on_a3 = SCALES.iter().map(|s| (Paper::A3, *s));
    if preferred == Paper::A3 {
        return on_a3.collect();
    }
    let first = [(Paper::A4, 5.0), (Paper::A4, 2.0), (Paper::A3, 5.0), (Paper::A3, 2.0), (Paper::A4, 1.0)];
    first.into_iter().chain(on_a3.filter(|(_, s)| *s <= 1.0)).collect()
}

/// Returns papers, scales and numbers of columns of the parts list for an assembly, in the order to try them: the list is
/// split into two columns before the views are reduced.
#[must_use]
pub fn assembly_formats(preferred: Paper) -> Vec<(Paper, f64, usize)> {
    let on_a4 = [(Paper::A4, 5.0, 1), (Paper::A4, 2.0, 1)].into_iter().filter(|_| preferred == Paper::A4);
    let columns = |scale: f64| if scale > 1.0 { 1..=1 } else { 1..=2 };
    on_a4.chain(SCALES.iter().flat_map(|s| columns(*s).map(|n| (Paper::A3, *s, n)))).collect()
}

/// Sizes on paper of what a sheet contains, mm.
#[derive(Clone, Copy, Debug)]
pub struct Sizes {
    /// The front view, about the origin of the part.
    pub front: Extent,
    /// Height of the part along its axis: the height of the view from above and the width of the section.
    pub depth_mm: f64,
    /// Radius of the circle of a detail.
    pub detail_mm: f64,
    /// Number of details.
    pub details: usize,
    /// Space above the front view.
    pub above_mm: f64,
    /// Height of a table on the title block.
    pub table_mm: f64,
    /// Width and height of a table at the upper right; 0 without one.
    pub right_table_mm: [f64; 2],
}

/// Positions of the views of a sheet.
#[derive(Clone, Debug)]
pub struct Layout {
    /// Origin of the part in the front view.
    pub front: Point,
    /// Height on paper of the plane z = 0 in the view from above, in which z grows downward. Its x is that of the front view.
    pub above_mm: f64,
    /// Position on paper of the plane z = 0 in the section, whose y is that of the front view.
    pub section_mm: f64,
    /// +1 if z grows to the right in the section, -1 to the left.
    pub section_sense: f64,
    /// Centres of the details.
    pub details: Vec<Point>,
    /// Lower right corner of the table next to the views.
    pub right_table: Point,
}

impl Layout {
    /// Lays out an empty sheet; `None` if it is too small.
    #[must_use]
    pub fn new(draft: &Draft, sizes: &Sizes, projection: Projection) -> Option<Self> {
        let frame = draft.sheet().paper.frame();
        let floor = draft.sheet().title_block.high.y + 3.0 + sizes.table_mm;
        let (width, height) = (sizes.front.width(), sizes.front.height());
        let detail_column = if sizes.details == 0 { 0.0 } else { 2.0 * sizes.detail_mm + AROUND_DETAIL_MM.0 };
        let [table_wide, table_high] = sizes.right_table_mm;
        let table_column = if table_wide > 0.0 { table_wide + AROUND_TABLE_MM } else { 0.0 };
        let needed =
            LEFT_MM + width + BESIDE_MM + sizes.depth_mm + RIGHT_MM + detail_column.max(table_column);
        let spare_x = frame.width() - needed;
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
            // The view from above needs no space above it; the angles of the front view come between.
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
        // From the left, z grows to the right; from the right, to the left.
        let (section_mm, section_sense) = match projection {
            Projection::First => (section_left, 1.0),
            Projection::Third => (section_left + sizes.depth_mm, -1.0),
        };
        let right_table =
            Point::new(frame.high.x - AROUND_TABLE_MM, frame.high.y - AROUND_TABLE_MM - table_high);
        Some(Self { front, above_mm: above_top, section_mm, section_sense, details, right_table })
    }
}
