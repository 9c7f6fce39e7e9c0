//! Bodies: connected surfaces, which way each one faces, and what lies inside what.

use std::borrow::Cow;
use std::f64::consts::TAU;

use super::{Fault, place};
use crate::mesh::{Mesh, Point3, axis_volumes_about, mean};
use crate::parallel;

/// How a closed mesh splits into bodies.
pub(super) struct BodySplit {
    pub(super) bodies: usize,
    pub(super) voids: usize,
    pub(super) fault: Option<Fault>,
}

/// Splits a closed mesh of that volume into its connected surfaces. One that lies in no other, or in an even number of
/// others, bounds a body and must face outward; one in an odd number bounds a void and must face inward.
pub(super) fn split(mesh: &Mesh, volume_mm3: f64) -> BodySplit {
    let triangles = by_surface(mesh);
    let surfaces: Vec<Surface> = match &triangles[..] {
        [triangles] => vec![Surface { mesh, triangles, bounds: None, volume_mm3 }],
        several => {
            let middle = mesh.middle();
            several.iter().map(|triangles| Surface::measured(mesh, triangles, middle)).collect()
        }
    };
    let depths = parallel::in_chunks(surfaces.len(), |range| {
        let depth =
            |i: usize| (0..surfaces.len()).filter(|j| *j != i && surfaces[*j].encloses(&surfaces[i])).count();
        range.map(depth).collect::<Vec<_>>()
    });
    let mut split = BodySplit { bodies: 0, voids: 0, fault: None };
    let mut wrong = Vec::new();
    for (surface, depth) in surfaces.iter().zip(depths.concat()) {
        let is_void = depth % 2 == 1;
        if is_void {
            split.voids += 1
        } else {
            split.bodies += 1
        }
        if is_void == (surface.volume_mm3 > 0.0) {
            wrong.push((surface, is_void));
        }
    }
    split.fault = wrong.first().map(|(surface, is_void)| Fault {
        check: "inside out",
        count: wrong.len(),
        at_mm: surface.first_corner().and_then(place),
        detail: if *is_void {
            format!("{} bodies lie inside another body", wrong.len())
        } else {
            format!("{} bodies face inward: their volume is {:.4} mm3", wrong.len(), surface.volume_mm3)
        },
    });
    split
}

pub(super) fn wrong_count(found: usize, expected: Option<usize>) -> Option<Fault> {
    let expected = expected?;
    (found != expected).then(|| Fault {
        check: "bodies",
        count: found,
        at_mm: None,
        detail: format!("the mesh has {found} bodies, expected are {expected}"),
    })
}

/// Triangles that hang together through shared vertices.
fn by_surface(mesh: &Mesh) -> Vec<Cow<'_, [[u32; 3]]>> {
    let mut parent: Vec<u32> = (0u32..).take(mesh.positions.len()).collect();
    for t in &mesh.triangles {
        let root = find(&mut parent, t[0]);
        for v in &t[1..] {
            let other = find(&mut parent, *v);
            parent[other as usize] = root;
        }
    }
    let root_of_first = mesh.triangles.first().map(|t| find(&mut parent, t[0]));
    if mesh.triangles.iter().all(|t| Some(find(&mut parent, t[0])) == root_of_first) {
        return vec![Cow::Borrowed(&mesh.triangles)];
    }
    // Surfaces are numbered as their first triangles come.
    let mut numbers = vec![None; mesh.positions.len()];
    let mut surfaces: Vec<Vec<[u32; 3]>> = Vec::new();
    for t in &mesh.triangles {
        let root = find(&mut parent, t[0]);
        let number = *numbers[root as usize].get_or_insert(surfaces.len());
        if number == surfaces.len() {
            surfaces.push(Vec::new());
        }
        surfaces[number].push(*t);
    }
    surfaces.into_iter().map(Cow::Owned).collect()
}

fn find(parent: &mut [u32], mut v: u32) -> u32 {
    while parent[v as usize] != v {
        let up = parent[parent[v as usize] as usize];
        parent[v as usize] = up;
        v = up;
    }
    v
}

/// A connected surface of a mesh.
struct Surface<'a> {
    mesh: &'a Mesh,
    triangles: &'a [[u32; 3]],
    /// Bounds of the vertices that its facets use.
    bounds: Option<(Point3, Point3)>,
    volume_mm3: f64,
}

impl<'a> Surface<'a> {
    /// One of several, its volume measured about `middle`.
    fn measured(mesh: &'a Mesh, triangles: &'a [[u32; 3]], middle: Point3) -> Self {
        let facets = || triangles.iter().map(|t| mesh.corners(*t));
        let bounds = facets().flatten().map(|p| (p, p)).reduce(|(a, b), (c, d)| (a.inf(&c), b.sup(&d)));
        Self { mesh, triangles, bounds, volume_mm3: mean(axis_volumes_about(middle, facets())) }
    }

    fn facets(&self) -> impl Iterator<Item = [Point3; 3]> + '_ {
        self.triangles.iter().map(|t| self.mesh.corners(*t))
    }

    fn first_corner(&self) -> Option<Point3> {
        self.facets().next().map(|corners| corners[0])
    }

    /// Whether `inner` lies inside as a whole; surfaces that cross are left to the intersection check.
    fn encloses(&self, inner: &Surface) -> bool {
        let (Some((low, high)), Some((inner_low, inner_high))) = (self.bounds, inner.bounds) else {
            return false;
        };
        low <= inner_low
            && inner_high <= high
            && inner.first_corner().is_some_and(|corner| winding(self.facets(), corner).abs() > 0.5)
    }
}

/// Winding number of a closed surface about `point`: its solid angle over a full sphere (van Oosterom & Strackee).
pub(super) fn winding(facets: impl Iterator<Item = [Point3; 3]>, point: Point3) -> f64 {
    let half_angles: f64 = facets
        .map(|corners| {
            let [a, b, c] = corners.map(|p| p - point);
            let (la, lb, lc) = (a.norm(), b.norm(), c.norm());
            let down = la * lb * lc + a.dot(&b) * lc + b.dot(&c) * la + c.dot(&a) * lb;
            libm::atan2(a.dot(&b.cross(&c)), down)
        })
        .sum();
    half_angles / TAU
}
