//! Bodies: connected surfaces, which way each one faces, and what lies inside what.

use std::f64::consts::TAU;

use super::{Fault, place};
use crate::mesh::{Mesh, Point3};

/// How a closed mesh falls apart.
pub(super) struct Split {
    pub(super) bodies: usize,
    pub(super) voids: usize,
    pub(super) fault: Option<Fault>,
}

/// Splits a closed mesh into its connected surfaces. One that lies in no other, or in an even number of others,
/// bounds a body and must face outward; one in an odd number bounds a void and must face inward.
pub(super) fn split(mesh: &Mesh) -> Split {
    let surfaces = surfaces(mesh);
    let mut split = Split { bodies: 0, voids: 0, fault: None };
    let mut wrong = Vec::new();
    for (i, surface) in surfaces.iter().enumerate() {
        let inside_of = surfaces.iter().enumerate().filter(|(j, other)| *j != i && encloses(other, surface));
        let is_void = inside_of.count() % 2 == 1;
        if is_void {
            split.voids += 1
        } else {
            split.bodies += 1
        }
        if is_void == (surface.volume_mm3() > 0.0) {
            wrong.push((surface, is_void));
        }
    }
    split.fault = wrong.first().map(|(surface, is_void)| Fault {
        check: "inside out",
        count: wrong.len(),
        at_mm: surface.facets().next().and_then(|c| place(c[0])),
        detail: if *is_void {
            format!("{} bodies lie inside another body", wrong.len())
        } else {
            format!("{} bodies face inward: their volume is {:.4} mm3", wrong.len(), surface.volume_mm3())
        },
    });
    split
}

pub(super) fn unexpected(found: usize, expected: Option<usize>) -> Option<Fault> {
    let expected = expected?;
    (found != expected).then(|| Fault {
        check: "bodies",
        count: found,
        at_mm: None,
        detail: format!("the mesh has {found} bodies, expected are {expected}"),
    })
}

/// The surfaces that hang together through shared vertices.
fn surfaces(mesh: &Mesh) -> Vec<Mesh> {
    let mut parent: Vec<u32> = (0u32..).take(mesh.positions.len()).collect();
    for t in &mesh.triangles {
        let root = find(&mut parent, t[0]);
        for v in &t[1..] {
            let other = find(&mut parent, *v);
            parent[other as usize] = root;
        }
    }
    let mut numbers = std::collections::BTreeMap::new();
    let mut surfaces: Vec<Vec<[u32; 3]>> = Vec::new();
    for t in &mesh.triangles {
        let root = find(&mut parent, t[0]);
        let number = *numbers.entry(root).or_insert(surfaces.len());
        if number == surfaces.len() {
            surfaces.push(Vec::new());
        }
        surfaces[number].push(*t);
    }
    match surfaces.len() {
        1 => vec![mesh.clone()],
        _ => surfaces.into_iter().map(|t| Mesh::new(mesh.positions.clone(), t)).collect(),
    }
}

fn find(parent: &mut [u32], mut v: u32) -> u32 {
    while parent[v as usize] != v {
        let up = parent[parent[v as usize] as usize];
        parent[v as usize] = up;
        v = up;
    }
    v
}

/// Whether `inner` lies inside `outer` as a whole; surfaces that cross are left to the intersection check.
fn encloses(outer: &Mesh, inner: &Mesh) -> bool {
    let (Some((low, high)), Some((inner_low, inner_high))) = (corner_bounds(outer), corner_bounds(inner))
    else {
        return false;
    };
    low <= inner_low
        && inner_high <= high
        && inner.facets().next().is_some_and(|corners| winding(outer, corners[0]).abs() > 0.5)
}

/// Bounds of the vertices that the facets use.
fn corner_bounds(mesh: &Mesh) -> Option<(Point3, Point3)> {
    mesh.facets().flatten().map(|p| (p, p)).reduce(|(a, b), (c, d)| (a.inf(&c), b.sup(&d)))
}

/// Winding number of a closed surface about `point`: its solid angle over a full sphere (van Oosterom & Strackee).
fn winding(mesh: &Mesh, point: Point3) -> f64 {
    let half_angles: f64 = mesh
        .facets()
        .map(|corners| {
            let [a, b, c] = corners.map(|p| p - point);
            let (la, lb, lc) = (a.norm(), b.norm(), c.norm());
            let down = la * lb * lc + a.dot(&b) * lc + b.dot(&c) * la + c.dot(&a) * lb;
            a.dot(&b.cross(&c)).atan2(down)
        })
        .sum();
    half_angles / TAU
}
