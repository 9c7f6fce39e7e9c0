//! Walls that are thinner than a printer can lay down.

use super::facet_tree::{Bounds, FacetTree, boxes_meet, corner_box};
use super::{Fault, place};
use crate::mesh::{Mesh, Point3, Vector3};
use crate::parallel;

/// Two facets bound a wall if their normals are this nearly opposite (cosine).
const OPPOSITE: f64 = -0.7;

/// The walls under some facets.
struct Thin {
    count: usize,
    /// The thinnest with the number of its facet; of equal ones that with the least number.
    worst: Option<(f64, usize)>,
}

/// Looks inward from the middle of every facet for a facing one closer than `min_wall_mm`.
pub(super) fn thin_walls(mesh: &Mesh, tree: &FacetTree, min_wall_mm: f64) -> Option<Fault> {
    let parts = parallel::in_chunks(tree.leaves(), |leaves| {
        let mut found = Thin { count: 0, worst: None };
        let mut near = Vec::new();
        for leaf in leaves {
            let rays = || tree.slots(leaf).filter_map(|slot| Ray::inward(mesh, tree, slot, min_wall_mm));
            let Some(reach) = rays().map(|ray| ray.bounds).reduce(Bounds::joined) else { continue };
            tree.leaves_meeting(&reach, 0, &mut near);
            for ray in rays() {
                let nearest = ray.nearest_mm(mesh, tree, &near);
                if nearest < min_wall_mm * (1.0 - 1e-6) {
                    found.count += 1;
                    found.worst = thinner(found.worst, Some((nearest, ray.facet)));
                }
            }
        }
        found
    });
    let count: usize = parts.iter().map(|part| part.count).sum();
    let (thickness, facet) = parts.iter().map(|part| part.worst).fold(None, thinner)?;
    Some(Fault {
        check: "thin wall",
        count,
        at_mm: place(middle(mesh, facet)),
        detail: format!(
            "walls under {count} facets are thinner than {min_wall_mm} mm, the thinnest {thickness:.3} mm"
        ),
    })
}

fn thinner(a: Option<(f64, usize)>, b: Option<(f64, usize)>) -> Option<(f64, usize)> {
    match (a, b) {
        (Some(x), Some(y)) => Some(if (y.0, y.1) < (x.0, x.1) { y } else { x }),
        (one, other) => one.or(other),
    }
}

fn middle(mesh: &Mesh, f: usize) -> Point3 {
    let [a, b, c] = mesh.corners(mesh.triangles[f]);
    Point3::from((a.coords + b.coords + c.coords) / 3.0)
}

/// From the middle of a facet straight into the body, as far as the least wall.
struct Ray {
    facet: usize,
    from: Point3,
    along: Vector3,
    /// The exact box of the ray.
    reach: (Point3, Point3),
    bounds: Bounds,
}

impl Ray {
    fn inward(mesh: &Mesh, tree: &FacetTree, slot: usize, length_mm: f64) -> Option<Self> {
        let normal = tree.plane(slot).normal.try_normalize(0.0)?;
        let facet = tree.facet(slot);
        let (from, along) = (middle(mesh, facet), -normal);
        let end = from + along * length_mm;
        let reach = (from.inf(&end), from.sup(&end));
        Some(Self { facet, from, along, reach, bounds: Bounds::around(reach.0, reach.1) })
    }

    /// How far it is to the nearest facing facet in the leaves `near`; infinite if there is none.
    fn nearest_mm(&self, mesh: &Mesh, tree: &FacetTree, near: &[usize]) -> f64 {
        let mut nearest = f64::INFINITY;
        tree.slots_meeting(&self.bounds, near, |slot| {
            // The starting facet looks back along the ray (-1): one that bounds the other side looks ahead.
            let normal = tree.plane(slot).normal;
            if self.along.dot(&normal) <= 0.0 {
                return;
            }
            let Some(normal) = normal.try_normalize(0.0) else { return };
            if -self.along.dot(&normal) > OPPOSITE {
                return;
            }
            let other = tree.facet(slot);
            let Some(distance) = self.distance_mm(mesh.corners(mesh.triangles[other])) else { return };
            // The tree's boxes are rounded outward: what lies beyond the reach must not count.
            if distance < nearest && boxes_meet(self.reach, corner_box(mesh, other)) {
                nearest = distance;
            }
        });
        nearest
    }

    /// Distance along the ray to a triangle that it passes through (Möller & Trumbore).
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
