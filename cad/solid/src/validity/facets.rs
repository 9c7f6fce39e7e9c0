//! Single facets: finite, not degenerate, not repeated.

use super::stars::Star;
use super::{Fault, MeshFacts, place};
use crate::mesh::{Mesh, Point3};
use crate::parallel;

/// Least height of a triangle in mm: twice its area over its longest side.
pub(super) fn height_mm([a, b, c]: [Point3; 3]) -> f64 {
    let longest = (b - a).norm().max((c - b).norm()).max((a - c).norm());
    if longest == 0.0 { 0.0 } else { (b - a).cross(&(c - a)).norm() / longest }
}

pub(super) fn empty(mesh: &Mesh) -> Option<Fault> {
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
pub(super) fn implausible_size(facts: &MeshFacts, (least, most): (f64, f64)) -> Option<Fault> {
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

/// Heights of all facets.
pub(super) struct Heights {
    /// The least of them, mm; infinite without a facet.
    pub(super) min_thickness_mm: f64,
    degenerate: usize,
    /// The thinnest degenerate facet, the first of equal ones, with its height.
    worst: Option<(usize, f64)>,
}

pub(super) fn heights(mesh: &Mesh, min_height_mm: f64) -> Heights {
    let parts = parallel::in_chunks(mesh.triangles.len(), |range| {
        let mut found = Heights { min_thickness_mm: f64::INFINITY, degenerate: 0, worst: None };
        for f in range {
            let height = height_mm(mesh.corners(mesh.triangles[f]));
            found.min_thickness_mm = found.min_thickness_mm.min(height);
            if height < min_height_mm {
                found.degenerate += 1;
                found.worst = thinner(found.worst, Some((f, height)));
            }
        }
        found
    });
    Heights {
        min_thickness_mm: parts.iter().map(|part| part.min_thickness_mm).fold(f64::INFINITY, f64::min),
        degenerate: parts.iter().map(|part| part.degenerate).sum(),
        worst: parts.iter().map(|part| part.worst).fold(None, thinner),
    }
}

fn thinner(first: Option<(usize, f64)>, later: Option<(usize, f64)>) -> Option<(usize, f64)> {
    match (first, later) {
        (Some(a), Some(b)) => Some(if b.1 < a.1 { b } else { a }),
        (one, other) => one.or(other),
    }
}

pub(super) fn degenerate(mesh: &Mesh, heights: &Heights, min_height_mm: f64) -> Option<Fault> {
    let (count, (worst, height)) = (heights.degenerate, heights.worst?);
    Some(Fault {
        check: "degenerate facet",
        count,
        at_mm: place(mesh.corners(mesh.triangles[worst])[0]),
        detail: format!("{count} facets are thinner than {min_height_mm:e} mm, the thinnest {height:e} mm"),
    })
}

/// Facets on the same three vertices as one before them, whichever way they turn.
#[derive(Default)]
pub(super) struct Repeats {
    count: usize,
    /// The least number of such a facet.
    first: Option<u32>,
    /// Room to work in: the greater two corners of the facets of a star.
    keys: Vec<([u32; 2], u32)>,
}

impl Repeats {
    /// Counts the facets whose least vertex is the middle of the star.
    pub(super) fn see(&mut self, mesh: &Mesh, star: &Star) {
        self.keys.clear();
        for f in star.facets.chunk_by(|f, g| f == g).filter_map(|same| same.first()) {
            let mut t = mesh.triangles[*f as usize];
            t.sort_unstable();
            if t[0] == star.middle {
                self.keys.push(([t[1], t[2]], *f));
            }
        }
        self.keys.sort_unstable();
        for two in self.keys.windows(2).filter(|two| two[0].0 == two[1].0) {
            self.count += 1;
            self.first = Some(self.first.map_or(two[1].1, |first| first.min(two[1].1)));
        }
    }

    /// Adds what other stars show.
    pub(super) fn append(&mut self, other: Self) {
        self.count += other.count;
        self.first = self.first.into_iter().chain(other.first).min();
    }

    pub(super) fn fault(self, mesh: &Mesh) -> Option<Fault> {
        let count = self.count;
        self.first.map(|f| Fault {
            check: "repeated facet",
            count,
            at_mm: place(mesh.corners(mesh.triangles[f as usize])[0]),
            detail: format!("{count} facets lie on the corners of another"),
        })
    }
}
