//! Isometric views with hidden lines removed (ISO 5456-3).
//!
//! Edges are those of walls, their hard corners, and their silhouettes. Faces are drawn into a grid of depths; a point of
//! an edge is visible if a cell next to it has nothing nearer.

use super::strokes::Stroke;
use crate::contour::lettering;
use pinswitch_solid::pose::Pose;
use pinswitch_solid::profile::{Contour, Edge, Point2};
use pinswitch_solid::solid::Solid;

/// Cosine and sine of the angle of the axes x and z on paper.
const AXIS: [f64; 2] = [0.866_025_403_784_438_6, 0.5];
/// Side of a cell of the grid, as a share of the larger side of the view.
const CELL_SHARE: f64 = 1.0 / 900.0;
/// Largest distance of a chord from its arc, in cells.
const CHORD_CELLS: f64 = 0.5;
/// Material may be nearer than an edge by this without hiding it, in cells: the slope of a face next to its edge.
const NEARER_CELLS: f64 = 2.5;
/// Shortest visible piece of an edge, and longest gap that is bridged, in cells.
const LEAST_RUN_CELLS: usize = 3;
/// Most chords of an arc.
const MAX_CHORDS: f64 = 64.0;
/// Cosine of the largest angle between the tangents at a smooth corner.
const SMOOTH: f64 = 0.985;

/// A body in an isometric view.
#[derive(Clone, Copy, Debug)]
pub struct Shifted<'a> {
    /// Its solid.
    pub solid: &'a Solid,
    /// Its pose in the assembly.
    pub pose: Pose,
    /// Its displacement from there, mm.
    pub by: [f64; 3],
}

/// Point on paper, and its depth toward the observer.
#[derive(Clone, Copy, Debug)]
struct Seen {
    at: [f64; 2],
    depth: f64,
}

/// Projects a point. The observer is at equal and positive x, y and z; y is up on paper, x to the lower right, z to the
/// lower left. Lengths along the axes are true.
fn seen([x, y, z]: [f64; 3]) -> Seen {
    // The depth has the scale of the axes: sqrt(3/2) times the distance along the line of sight.
    Seen {
        at: [(x - z) * AXIS[0], y - (x + z) * AXIS[1]],
        depth: (x + y + z) * std::f64::consts::FRAC_1_SQRT_2,
    }
}

/// Wall of a body: its lower and its upper ring with as many points, and whether each point is a hard corner.
struct Wall {
    lower: Vec<Seen>,
    upper: Vec<Seen>,
    is_hard: Vec<bool>,
}

/// Walls and caps of a body.
struct Surface {
    walls: Vec<Wall>,
    /// Rings of each cap that faces the observer.
    caps: Vec<Vec<Vec<Seen>>>,
}

/// Returns the number of chords of each edge, so that they are close to the arcs.
fn chords(contour: &Contour, chord_mm: f64) -> Vec<usize> {
    let number = |edge: &Edge| match edge {
        Edge::Line => 1,
        Edge::Arc(arc) => {
            let step = (8.0 * chord_mm / arc.radius_mm.max(1e-6)).sqrt();
            (arc.sweep_rad.abs() / step).ceil().clamp(2.0, MAX_CHORDS) as usize
        }
    };
    contour.edges().iter().map(number).collect()
}

/// Returns whether the corner at the start of an edge is hard.
fn is_hard(contour: &Contour, edge: usize) -> bool {
    let number = contour.edges().len();
    let tangent = |i: usize, at_start: bool| {
        let (from, to) = contour.ends(i);
        match &contour.edges()[i] {
            Edge::Line => (to - from).normalize(),
            Edge::Arc(arc) => {
                let radius = if at_start { from - arc.centre } else { to - arc.centre };
                Point2::new(-radius.y, radius.x).coords.normalize() * arc.sweep_rad.signum()
            }
        }
    };
    tangent((edge + number - 1) % number, false).dot(&tangent(edge, true)) < SMOOTH
}

impl Surface {
    fn new(body: &Shifted<'_>, chord_mm: f64) -> Self {
        let rings: Vec<(&Contour, f64)> = body.solid.rings().collect();
        let letters = lettering(body.solid);
        let place = |p: Point2, z: f64| {
            let (x, z) = if body.pose.flipped { (-p.x, -z) } else { (p.x, z) };
            seen([x + body.by[0], p.y + body.by[1], z + body.pose.z_mm + body.by[2]])
        };
        let points = |i: usize, chords: &[usize]| -> Vec<Seen> {
            let (contour, z) = rings[i];
            contour.flattened(chords).into_iter().map(|p| place(p, z)).collect()
        };
        let walls = body
            .solid
            .walls()
            .filter(|(lower, _)| !letters[*lower])
            .map(|(lower, upper)| {
                let contour = rings[lower].0;
                let chords = chords(contour, chord_mm);
                let hard = (0..chords.len()).flat_map(|edge| {
                    std::iter::once(is_hard(contour, edge))
                        .chain(std::iter::repeat_n(false, chords[edge] - 1))
                });
                Wall { lower: points(lower, &chords), upper: points(upper, &chords), is_hard: hard.collect() }
            })
            .filter(|wall| wall.lower.len() == wall.upper.len() && wall.lower.len() == wall.is_hard.len())
            .collect();
        let caps = body.solid.caps().map(|(_, members)| {
            let shown = members.into_iter().filter(|i| !letters[*i]);
            shown.map(|i| points(i, &chords(rings[i].0, chord_mm))).collect()
        });
        Self { walls, caps: caps.collect() }
    }
}

/// Grid of the depths of the nearest faces.
struct Depths {
    low: [f64; 2],
    cell_mm: f64,
    size: [usize; 2],
    nearest: Vec<f64>,
}

impl Depths {
    fn new(low: [f64; 2], high: [f64; 2]) -> Self {
        let side = (high[0] - low[0]).max(high[1] - low[1]).max(1e-6);
        let cell_mm = side * CELL_SHARE;
        let low = low.map(|x| x - 2.0 * cell_mm);
        let size = [0, 1].map(|i| ((high[i] - low[i]) / cell_mm).ceil() as usize + 3);
        Self { low, cell_mm, size, nearest: vec![f64::NEG_INFINITY; size[0] * size[1]] }
    }

    /// Fills a planar polygon with holes, by the even-odd rule along the rows of the grid.
    fn fill(&mut self, rings: &[Vec<Seen>]) {
        let Some(plane) = plane(rings) else { return };
        let row_of = |v: f64| (v - self.low[1]) / self.cell_mm;
        let ends = rings.iter().flatten().map(|p| row_of(p.at[1]));
        let (first, last) = ends.fold((f64::INFINITY, 0.0f64), |(a, b), r| (a.min(r), b.max(r)));
        let mut crossings = Vec::new();
        for row in first.max(0.0) as usize..=(last as usize).min(self.size[1] - 1) {
            let v = self.low[1] + (row as f64 + 0.5) * self.cell_mm;
            crossings.clear();
            for ring in rings {
                for (i, a) in ring.iter().enumerate() {
                    let b = &ring[(i + 1) % ring.len()];
                    if (a.at[1] <= v) != (b.at[1] <= v) {
                        let share = (v - a.at[1]) / (b.at[1] - a.at[1]);
                        crossings.push(a.at[0] + share * (b.at[0] - a.at[0]));
                    }
                }
            }
            crossings.sort_by(f64::total_cmp);
            for pair in crossings.chunks_exact(2) {
                let column = |u: f64| ((u - self.low[0]) / self.cell_mm - 0.5).ceil().max(0.0) as usize;
                for cell in column(pair[0])..column(pair[1]).min(self.size[0]) {
                    let u = self.low[0] + (cell as f64 + 0.5) * self.cell_mm;
                    let depth = plane[0] + plane[1] * u + plane[2] * v;
                    let nearest = &mut self.nearest[row * self.size[0] + cell];
                    *nearest = nearest.max(depth);
                }
            }
        }
    }

    /// Whether a cell next to a point has nothing nearer.
    fn is_visible(&self, point: &Seen) -> bool {
        let near = point.depth + NEARER_CELLS * self.cell_mm;
        let cell = |i: usize| ((point.at[i] - self.low[i]) / self.cell_mm) as usize;
        let (column, row) = (cell(0), cell(1));
        (row.saturating_sub(1)..=row + 1).any(|r| {
            (column.saturating_sub(1)..=column + 1)
                .any(|c| r >= self.size[1] || c >= self.size[0] || self.nearest[r * self.size[0] + c] <= near)
        })
    }

    /// Adds the visible pieces of an edge.
    fn add_visible(&self, from: &Seen, to: &Seen, strokes: &mut Vec<Stroke>) {
        let length = libm::hypot(to.at[0] - from.at[0], to.at[1] - from.at[1]);
        let steps = ((length / self.cell_mm).ceil() as usize).max(1);
        let at = |share: f64| Seen {
            at: [0, 1].map(|i| from.at[i] + share * (to.at[i] - from.at[i])),
            depth: from.depth + share * (to.depth - from.depth),
        };
        let share = |step: usize| step as f64 / steps as f64;
        let mut start: Option<usize> = None;
        let mut hidden = 0;
        for step in 0..=steps {
            // The middle of each piece; an end may be on a face of another body.
            let is_visible = step < steps && self.is_visible(&at(share(step) + 0.5 / steps as f64));
            match (is_visible, start) {
                (true, None) => (start, hidden) = (Some(step), 0),
                (true, Some(_)) => hidden = 0,
                (false, Some(first)) => {
                    hidden += 1;
                    if hidden > LEAST_RUN_CELLS || step == steps {
                        let end = step + 1 - hidden;
                        if end - first >= LEAST_RUN_CELLS.min(steps) {
                            strokes.push([at(share(first)).at, at(share(end)).at]);
                        }
                        start = None;
                    }
                }
                (false, None) => {}
            }
        }
    }
}

/// Returns the depth of the plane of rings as `a + b u + c v`; `None` for a plane along the line of sight.
fn plane(rings: &[Vec<Seen>]) -> Option<[f64; 3]> {
    let ring = rings.first()?;
    let origin = ring.first()?;
    let from = |p: &Seen| [p.at[0] - origin.at[0], p.at[1] - origin.at[1], p.depth - origin.depth];
    // The normal of a polygon is the sum of the cross products of its corners (Newell).
    let mut normal = [0.0; 3];
    for (i, p) in ring.iter().enumerate() {
        let (a, b) = (from(p), from(&ring[(i + 1) % ring.len()]));
        normal[0] += a[1] * b[2] - a[2] * b[1];
        normal[1] += a[2] * b[0] - a[0] * b[2];
        normal[2] += a[0] * b[1] - a[1] * b[0];
    }
    let size = normal.iter().map(|n| n * n).sum::<f64>().sqrt();
    if normal[2].abs() < 1e-6 * size || size == 0.0 {
        return None;
    }
    let (b, c) = (-normal[0] / normal[2], -normal[1] / normal[2]);
    Some([origin.depth - b * origin.at[0] - c * origin.at[1], b, c])
}

/// Twice the signed area of a quad on paper: its sign is the side that faces the observer.
fn facing(quad: [&Seen; 4]) -> f64 {
    (0..4).map(|i| quad[i].at[0] * quad[(i + 1) % 4].at[1] - quad[(i + 1) % 4].at[0] * quad[i].at[1]).sum()
}

/// Returns the visible edges of `bodies` in an isometric view, mm: y is up, x to the lower right, and z to the lower left.
/// Lengths along the axes are true.
#[must_use]
pub fn isometric(bodies: &[Shifted<'_>]) -> Vec<Stroke> {
    let bounds = |surfaces: &[Surface]| {
        let points = surfaces.iter().flat_map(|s| &s.walls).flat_map(|w| w.lower.iter().chain(&w.upper));
        points.fold(([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]), |(low, high), p| {
            ([0, 1].map(|i| low[i].min(p.at[i])), [0, 1].map(|i| high[i].max(p.at[i])))
        })
    };
    let surfaces =
        |chord_mm: f64| -> Vec<Surface> { bodies.iter().map(|body| Surface::new(body, chord_mm)).collect() };
    let (low, high) = bounds(&surfaces(f64::INFINITY));
    if !(low[0] < high[0] && low[1] < high[1]) {
        return Vec::new();
    }
    let mut depths = Depths::new(low, high);
    let surfaces = surfaces(CHORD_CELLS * depths.cell_mm);
    for surface in &surfaces {
        for wall in &surface.walls {
            for i in 0..wall.lower.len() {
                let next = (i + 1) % wall.lower.len();
                depths.fill(&[vec![wall.lower[i], wall.lower[next], wall.upper[next], wall.upper[i]]]);
            }
        }
        surface.caps.iter().for_each(|rings| depths.fill(rings));
    }
    let mut strokes = Vec::new();
    for wall in surfaces.iter().flat_map(|surface| &surface.walls) {
        let number = wall.lower.len();
        let side = |i: usize| {
            let next = (i + 1) % number;
            facing([&wall.lower[i], &wall.lower[next], &wall.upper[next], &wall.upper[i]])
        };
        for i in 0..number {
            let next = (i + 1) % number;
            depths.add_visible(&wall.lower[i], &wall.lower[next], &mut strokes);
            depths.add_visible(&wall.upper[i], &wall.upper[next], &mut strokes);
            let is_silhouette = (side(i) > 0.0) != (side((i + number - 1) % number) > 0.0);
            if wall.is_hard[i] || is_silhouette {
                depths.add_visible(&wall.lower[i], &wall.upper[i], &mut strokes);
            }
        }
    }
    // The ring between two walls is an edge of both.
    let mut drawn = std::collections::BTreeSet::new();
    strokes.retain(|stroke| {
        let mut ends = stroke.map(|p| p.map(|x| (x * 1e4).round() as i64));
        ends.sort_unstable();
        drawn.insert(ends)
    });
    strokes
}

#[cfg(test)]
mod tests {
    use super::*;

    fn length(strokes: &[Stroke]) -> f64 {
        strokes.iter().map(|[a, b]| libm::hypot(b[0] - a[0], b[1] - a[1])).sum()
    }

    fn block(low: [f64; 2], high: [f64; 2], height: f64) -> Solid {
        let corners = [(low[0], low[1]), (high[0], low[1]), (high[0], high[1]), (low[0], high[1])];
        let outline = Contour::polygon(corners.map(|(x, y)| Point2::new(x, y)).to_vec());
        Solid::prism(&outline, &[], 0.0, height, 0.0).unwrap()
    }

    /// Nine of the twelve edges of a cube are visible, and each has its true length.
    #[test]
    fn cubes_show_nine_edges() {
        let cube = block([0.0, 0.0], [10.0, 10.0], 10.0);
        let strokes = isometric(&[Shifted { solid: &cube, pose: Pose::upright(0.0), by: [0.0; 3] }]);
        assert!((length(&strokes) - 90.0).abs() < 1.0, "{}", length(&strokes));
    }

    /// A block in front, at larger z, hides a smaller one behind.
    #[test]
    fn nearer_blocks_hide_others() {
        let (near, far) = (block([-20.0, -20.0], [20.0, 20.0], 5.0), block([-1.0, -1.0], [1.0, 1.0], 2.0));
        let shifted = |solid, z| Shifted { solid, pose: Pose::upright(0.0), by: [0.0, 0.0, z] };
        let alone = isometric(&[shifted(&near, 0.0)]);
        let both = isometric(&[shifted(&near, 0.0), shifted(&far, -4.0)]);
        assert!((length(&both) - length(&alone)).abs() < 0.01 * length(&alone));
        let apart = isometric(&[shifted(&near, 0.0), shifted(&far, 8.0)]);
        assert!((length(&apart) - length(&alone) - 18.0).abs() < 2.0);
    }

    /// A cylinder has two ends and two silhouettes; half of its far end is hidden.
    #[test]
    fn cylinders_have_silhouettes() {
        let disc = Contour::circle(Point2::origin(), 5.0);
        let cylinder = Solid::prism(&disc, &[], 0.0, 20.0, 0.0).unwrap();
        let strokes = isometric(&[Shifted { solid: &cylinder, pose: Pose::upright(0.0), by: [0.0; 3] }]);
        // An isometric circle is an ellipse with axes of 1.2247 and 0.7071 of its diameter.
        let (a, b) = (5.0 * 1.5f64.sqrt(), 5.0 * 0.5f64.sqrt());
        let h = ((a - b) / (a + b)).powi(2);
        let ellipse = std::f64::consts::PI * (a + b) * (1.0 + 3.0 * h / (10.0 + (4.0 - 3.0 * h).sqrt()));
        let expected = 1.5 * ellipse + 2.0 * 20.0;
        assert!((length(&strokes) / expected - 1.0).abs() < 0.03, "{} for {expected}", length(&strokes));
    }

    #[test]
    fn nothing_has_no_edges() {
        assert!(isometric(&[]).is_empty());
    }
}
