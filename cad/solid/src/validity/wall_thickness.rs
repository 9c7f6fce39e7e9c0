//! Walls below the least thickness that a printer can produce.

use super::budget::{Budget, Pool, bound};
use super::bvh::{Bounds, Bvh, boxes_overlap, corner_box};
use super::fault::{Fault, Level};
use crate::mesh::{Mesh, Point3, Vector3};
use crate::parallel;

/// Two facets bound a wall if the cosine between their normals is at most this.
const OPPOSITE: f64 = -0.7;

/// Thin walls below a range of facets.
struct ThinWalls {
    count: usize,
    /// The least thickness with the index of its facet; of equal ones, the least index.
    worst: Option<(f64, usize)>,
    budget: Budget,
}

/// The outcome of the search.
pub(super) struct Search {
    pub(super) fault: Option<Fault>,
    /// The bound that was exceeded before all walls were measured.
    pub(super) bound: Option<String>,
    /// The work that is left.
    pub(super) left: Pool,
}

/// Searches inward from the centroid of every facet for a facing facet closer than `min_wall_mm`.
/// The search does work up to that of `pool`.
pub(super) fn search(mesh: &Mesh, bvh: &Bvh, min_wall_mm: f64, pool: Pool) -> Search {
    let chunks = parallel::chunks(bvh.leaves());
    let parts = parallel::in_chunks(bvh.leaves(), |leaves| {
        let facets = bvh.slots(leaves.start).start..bvh.slots(leaves.end - 1).end;
        let budget = Budget::of_part(pool, chunks, facets.len(), mesh.triangles.len());
        let mut part = ThinWalls { count: 0, worst: None, budget };
        let mut near = Vec::new();
        for leaf in leaves {
            if part.budget.is_spent() {
                break;
            }
            let rays = || bvh.slots(leaf).filter_map(|slot| Ray::inward(mesh, bvh, slot, min_wall_mm));
            let Some(reach) = rays().map(|ray| ray.bounds).reduce(Bounds::joined) else { continue };
            bvh.leaves_overlapping(&reach, 0, &mut near);
            part.budget.spend(near.len());
            for ray in rays() {
                let nearest = ray.nearest_mm(mesh, bvh, &near, &mut part.budget);
                if nearest < min_wall_mm * (1.0 - 1e-6) {
                    part.count += 1;
                    part.worst = thinner(part.worst, Some((nearest, ray.facet)));
                }
            }
        }
        part
    });
    let count: usize = parts.iter().map(|part| part.count).sum();
    let worst = parts.iter().map(|part| part.worst).fold(None, thinner);
    let fault = worst.map(|(thickness, facet)| {
        let detail = format!(
            "walls below {count} facets are thinner than {min_wall_mm} mm, the thinnest {thickness:.3} mm"
        );
        Fault::new("thin wall", Level::Warning, count, detail).at(centroid(mesh, facet))
    });
    let is_spent = parts.iter().any(|part| part.budget.is_spent());
    let facets = mesh.triangles.len();
    let mut left = pool;
    left.subtract(parts.iter().map(|part| part.budget));
    let bound = is_spent.then(|| bound(pool, facets, "facets are within reach of the walls"));
    Search { fault, bound, left }
}

fn thinner(a: Option<(f64, usize)>, b: Option<(f64, usize)>) -> Option<(f64, usize)> {
    match (a, b) {
        (Some(x), Some(y)) => Some(if (y.0, y.1) < (x.0, x.1) { y } else { x }),
        (one, other) => one.or(other),
    }
}

fn centroid(mesh: &Mesh, f: usize) -> Point3 {
    let [a, b, c] = mesh.corners(mesh.triangles[f]);
    Point3::from((a.coords + b.coords + c.coords) / 3.0)
}

/// A ray from the centroid of a facet along its inward normal, as long as the least thickness.
struct Ray {
    facet: usize,
    from: Point3,
    along: Vector3,
    length_mm: f64,
    /// The exact bounding box.
    reach: (Point3, Point3),
    bounds: Bounds,
}

impl Ray {
    fn inward(mesh: &Mesh, bvh: &Bvh, slot: usize, length_mm: f64) -> Option<Self> {
        let normal = bvh.plane(slot).normal.try_normalize(0.0)?;
        let facet = bvh.facet(slot);
        let (from, along) = (centroid(mesh, facet), -normal);
        let end = from + along * length_mm;
        let reach = (from.inf(&end), from.sup(&end));
        Some(Self { facet, from, along, length_mm, reach, bounds: Bounds::around(reach.0, reach.1) })
    }

    /// Distance to the nearest facing facet in the leaves `near`; infinite if there is none.
    fn nearest_mm(&self, mesh: &Mesh, bvh: &Bvh, near: &[usize], budget: &mut Budget) -> f64 {
        let mut nearest = f64::INFINITY;
        let end = self.from + self.along * self.length_mm;
        bvh.slots_along((self.from, end), &self.bounds, near, |slot| {
            // The starting facet faces back along the ray (-1); the other side of a wall faces
            // ahead.
            budget.spend(1);
            let normal = bvh.plane(slot).normal;
            if self.along.dot(&normal) <= 0.0 {
                return;
            }
            let Some(normal) = normal.try_normalize(0.0) else { return };
            if -self.along.dot(&normal) > OPPOSITE {
                return;
            }
            let other = bvh.facet(slot);
            let Some(distance) = self.distance_mm(mesh.corners(mesh.triangles[other])) else { return };
            // The boxes of the tree are rounded outward: facets beyond the ray must not count.
            if distance < nearest && boxes_overlap(self.reach, corner_box(mesh, other)) {
                nearest = distance;
            }
        });
        nearest
    }

    /// Distance along the ray to a triangle that it intersects (Möller & Trumbore).
    fn distance_mm(&self, [a, b, c]: [Point3; 3]) -> Option<f64> {
        let (u, v) = (b - a, c - a);
        let p = self.along.cross(&v);
        let determinant = u.dot(&p);
        let s = self.from - a;
        let q = s.cross(&u);
        let (x, y) = (s.dot(&p) / determinant, self.along.dot(&q) / determinant);
        let distance = v.dot(&q) / determinant;
        (x >= 0.0 && y >= 0.0 && x + y <= 1.0 && distance > 1e-9).then_some(distance)
    }
}
