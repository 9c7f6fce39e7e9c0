//! Single facets: finite, not degenerate, not repeated.

use std::collections::HashMap;

use super::{Facts, Fault, place};
use crate::mesh::{Mesh, Point3};

/// Least height of a triangle in mm: twice its area over its longest side.
pub(super) fn height_mm([a, b, c]: [Point3; 3]) -> f64 {
    let longest = (b - a).norm().max((c - b).norm()).max((a - c).norm());
    if longest == 0.0 { 0.0 } else { (b - a).cross(&(c - a)).norm() / longest }
}

pub(super) fn none(mesh: &Mesh) -> Option<Fault> {
    mesh.triangles.is_empty().then(|| Fault {
        check: "empty",
        count: 0,
        at_mm: None,
        detail: "the mesh has no facet".to_owned(),
    })
}

pub(super) fn not_finite(mesh: &Mesh) -> Option<Fault> {
    let bad = mesh.positions.iter().filter(|p| !p.coords.iter().all(|c| c.is_finite())).count();
    (bad > 0).then(|| Fault {
        check: "not finite",
        count: bad,
        at_mm: None,
        detail: format!("{bad} vertices have a coordinate that is NaN or infinite"),
    })
}

/// A mesh that is far too small or too large to be in millimetres.
pub(super) fn wrong_unit(facts: &Facts, (least, most): (f64, f64)) -> Option<Fault> {
    let longest = (0..3).map(|i| facts.high_mm[i] - facts.low_mm[i]).fold(0.0, f64::max);
    (longest < least || longest > most).then(|| Fault {
        check: "size",
        count: 1,
        at_mm: None,
        detail: format!(
            "the longest side is {longest:.4} mm, expected are {least} to {most} mm: is it in millimetres?"
        ),
    })
}

pub(super) fn degenerate(mesh: &Mesh, min_height_mm: f64) -> Option<Fault> {
    let mut worst: Option<([Point3; 3], f64)> = None;
    let mut count = 0;
    for corners in mesh.facets() {
        let height = height_mm(corners);
        if height < min_height_mm {
            count += 1;
            if worst.is_none_or(|(_, least)| height < least) {
                worst = Some((corners, height));
            }
        }
    }
    worst.map(|(corners, height)| Fault {
        check: "degenerate facet",
        count,
        at_mm: place(corners[0]),
        detail: format!("{count} facets are thinner than {min_height_mm:e} mm, the thinnest {height:e} mm"),
    })
}

/// Facets on the same three vertices, whichever way they turn.
pub(super) fn repeated(mesh: &Mesh) -> Option<Fault> {
    let mut seen: HashMap<[u32; 3], usize> = HashMap::with_capacity(mesh.triangles.len());
    let mut first = None;
    let mut count = 0;
    for t in &mesh.triangles {
        let mut key = *t;
        key.sort_unstable();
        let times = seen.entry(key).or_default();
        *times += 1;
        if *times > 1 {
            count += 1;
            first.get_or_insert(*t);
        }
    }
    first.map(|t| Fault {
        check: "repeated facet",
        count,
        at_mm: place(mesh.corners(t)[0]),
        detail: format!("{count} facets lie on the corners of another"),
    })
}
