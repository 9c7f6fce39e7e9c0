//! Single facets: finite, not degenerate, not repeated.

use super::fault::{Fault, Level};
use super::one_ring::OneRing;
use crate::mesh::{Mesh, Point3};
use crate::parallel;

/// Least height of a triangle in mm: twice its area over its longest side.
pub(super) fn height_mm([a, b, c]: [Point3; 3]) -> f64 {
    let longest = (b - a).norm().max((c - b).norm()).max((a - c).norm());
    if longest == 0.0 { 0.0 } else { (b - a).cross(&(c - a)).norm() / longest }
}

/// A mesh without facets.
pub(super) fn empty(mesh: &Mesh) -> Option<Fault> {
    let fault = || Fault::new("empty", Level::Error, 0, "the mesh has no facet".to_owned());
    mesh.triangles.is_empty().then(fault)
}

/// Greatest coordinate whose products are finite, with room for those of five factors.
const MAX_COORDINATE_MM: f64 = 1e36;

/// Coordinates that are NaN, infinite, or too large to compute with.
pub(super) fn not_finite(mesh: &Mesh) -> Option<Fault> {
    let is_finite = |c: &f64| c.abs() <= MAX_COORDINATE_MM;
    let count = mesh.positions.iter().filter(|p| !p.coords.iter().all(is_finite)).count();
    let detail = format!(
        "{count} vertices have a coordinate that is NaN, infinite or beyond {MAX_COORDINATE_MM:e} mm"
    );
    (count > 0).then(|| Fault::new("not finite", Level::Error, count, detail))
}

/// Units that files are written in by mistake, with their length in mm.
const OTHER_UNITS: [(&str, f64); 4] =
    [("inches", 25.4), ("metres", 1000.0), ("feet", 304.8), ("micrometres", 1e-3)];

/// A bounding box that is too small or too large for millimetres.
pub(super) fn implausible_size(low: [f64; 3], high: [f64; 3], (least, most): (f64, f64)) -> Option<Fault> {
    let longest = (0..3).map(|i| high[i] - low[i]).fold(0.0, f64::max);
    if longest >= least && longest <= most {
        return None;
    }
    let plausible = OTHER_UNITS.iter().filter(|(_, mm)| (least..=most).contains(&(longest * mm)));
    let units: Vec<_> = plausible.map(|(unit, mm)| format!("{unit} ({:.4} mm)", longest * mm)).collect();
    let other = if units.is_empty() { String::new() } else { format!(", or {}", units.join(", ")) };
    let detail = format!(
        "the longest side is {longest:.4} mm, expected {least} to {most} mm; is the unit millimetres{other}?"
    );
    Some(Fault::new("size", Level::Warning, 1, detail))
}

/// Facets that are finer than any printer can produce, of a part smaller than a hand: the file is
/// probably a scan in metres or inches.
pub(super) fn implausible_resolution(mesh: &Mesh, longest: f64) -> Option<Fault> {
    let facets = mesh.triangles.len();
    let side = (mesh.surface_mm2() / facets as f64).sqrt();
    let detail = format!(
        "the longest side is {longest:.4} mm, and {facets} facets have a mean size of {side:.5} mm, finer than a \
         printer; is the unit millimetres, or metres ({:.4} mm)?",
        longest * 1000.0
    );
    let is_fine = facets > FINE_FACETS && side < FINE_SIDE_MM && longest < FINE_PART_MM;
    is_fine.then(|| Fault::new("size", Level::Warning, 1, detail))
}

/// Least number of facets of a scan. Parts of fewer facets may have tiny ones.
const FINE_FACETS: usize = 5000;
/// Mean size of a facet below which the unit is questioned, mm: a tenth of the line of a printer.
const FINE_SIDE_MM: f64 = 0.04;
/// Longest side up to which the unit is questioned, mm.
const FINE_PART_MM: f64 = 25.0;

/// Heights of all facets.
pub(super) struct Heights {
    /// The least height, mm; infinite without facets.
    pub(super) least_mm: f64,
    degenerate: usize,
    /// The thinnest degenerate facet, the first of equal ones, and its height.
    worst: Option<(usize, f64)>,
}

/// Measures all facets, and counts those thinner than `min_height_mm`.
pub(super) fn heights(mesh: &Mesh, min_height_mm: f64) -> Heights {
    let parts = parallel::in_chunks(mesh.triangles.len(), |range| {
        let mut part = Heights { least_mm: f64::INFINITY, degenerate: 0, worst: None };
        for f in range {
            let height = height_mm(mesh.corners(mesh.triangles[f]));
            part.least_mm = part.least_mm.min(height);
            if height < min_height_mm {
                part.degenerate += 1;
                part.worst = thinner(part.worst, Some((f, height)));
            }
        }
        part
    });
    Heights {
        least_mm: parts.iter().map(|part| part.least_mm).fold(f64::INFINITY, f64::min),
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

/// Facets whose corners may be equal in single precision.
pub(super) fn degenerate(mesh: &Mesh, heights: &Heights, min_height_mm: f64) -> Option<Fault> {
    let (count, (worst, height)) = (heights.degenerate, heights.worst?);
    let detail = format!("{count} facets are thinner than {min_height_mm:e} mm, the thinnest {height:e} mm");
    let level = if count == mesh.triangles.len() { Level::Error } else { Level::Warning };
    let fault = Fault::new("degenerate facet", level, count, detail);
    Some(fault.at(mesh.corners(mesh.triangles[worst])[0]))
}

/// Facets with the same three vertices as an earlier one, in either orientation.
#[derive(Default)]
pub(super) struct RepeatedFacets {
    count: usize,
    /// The least index of such a facet.
    first: Option<u32>,
    /// The greater two corners of the facets of a one-ring, reused for every vertex.
    keys: Vec<([u32; 2], u32)>,
}

impl RepeatedFacets {
    /// Counts the facets whose least vertex is the centre of the one-ring.
    pub(super) fn check(&mut self, mesh: &Mesh, ring: &OneRing) {
        self.keys.clear();
        for f in ring.facets.chunk_by(|f, g| f == g).filter_map(|same| same.first()) {
            let mut t = mesh.triangles[*f as usize];
            t.sort_unstable();
            if t[0] == ring.centre {
                self.keys.push(([t[1], t[2]], *f));
            }
        }
        self.keys.sort_unstable();
        for pair in self.keys.windows(2).filter(|pair| pair[0].0 == pair[1].0) {
            self.count += 1;
            self.first = Some(self.first.map_or(pair[1].1, |first| first.min(pair[1].1)));
        }
    }

    /// Adds the facets of other vertices.
    pub(super) fn append(&mut self, other: Self) {
        self.count += other.count;
        self.first = self.first.into_iter().chain(other.first).min();
    }

    pub(super) fn fault(self, mesh: &Mesh) -> Option<Fault> {
        let count = self.count;
        let detail = format!("{count} facets have the same corners as another");
        let corner = |f: u32| mesh.corners(mesh.triangles[f as usize])[0];
        self.first.map(|f| Fault::new("repeated facet", Level::Error, count, detail).at(corner(f)))
    }
}
