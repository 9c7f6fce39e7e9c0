//! Overlap of two solids of an assembly.

use super::components::winding_number;
use crate::mesh::{Mesh, Point3, Vector3};

/// Most samples along the longest edge of a facet.
const MAX_SAMPLES: usize = 12;
/// Samples along the diagonal of the smaller solid.
const SAMPLES_PER_DIAGONAL: f64 = 24.0;

/// Returns a place where two closed meshes overlap by more than `depth_mm`, measured from the
/// surface of one of them; `None` if no sample shows one. Solids that touch, or curved ones whose
/// facets intersect less deeply, do not overlap.
///
/// The surfaces are sampled: an overlap between the samples, such as of a single corner, is not
/// detected. All samples together are compared with at most `comparisons` facets, so that large
/// meshes get fewer samples.
pub fn shared_place(one: &Mesh, other: &Mesh, depth_mm: f64, comparisons: usize) -> Option<[f64; 3]> {
    let (Some(a), Some(b)) = (one.bounds(), other.bounds()) else { return None };
    let (low, high) = (a.0.sup(&b.0), a.1.inf(&b.1));
    if (high - low).iter().any(|side| *side <= depth_mm) {
        return None;
    }
    let step = ((a.1 - a.0).norm()).min((b.1 - b.0).norm()) / SAMPLES_PER_DIAGONAL;
    let is_near = |p: &Point3| (0..3).all(|i| p[i] >= low[i] && p[i] <= high[i]);
    let within = |of: &Mesh, among: &Mesh| {
        let near: Vec<Point3> = samples(of, step, depth_mm).filter(is_near).collect();
        let all = near.len().saturating_mul(among.triangles.len());
        let every = all.div_ceil(comparisons.max(1)).max(1);
        let mut sampled = near.into_iter().step_by(every);
        let inside = sampled.find(|p| winding_number(among.facets(), *p).abs() > 0.5);
        inside.map(|p| [p.x, p.y, p.z])
    };
    within(one, other).or_else(|| within(other, one))
}

/// Points at `depth_mm` below every facet.
fn samples(mesh: &Mesh, step: f64, depth_mm: f64) -> impl Iterator<Item = Point3> + '_ {
    mesh.facets().flat_map(move |[a, b, c]| {
        let normal = (b - a).cross(&(c - a)).try_normalize(0.0).unwrap_or_else(Vector3::zeros);
        let longest = (b - a).norm().max((c - b).norm()).max((a - c).norm());
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        let n = ((longest / step).ceil() as usize).clamp(1, MAX_SAMPLES);
        (0..n).flat_map(move |i| {
            (0..n - i).map(move |j| {
                let share = |k: usize| (k as f64 + 1.0 / 3.0) / n as f64;
                a + (b - a) * share(i) + (c - a) * share(j) - normal * depth_mm
            })
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cuboid(low: [f64; 3], high: [f64; 3]) -> Mesh {
        let corner = |i: usize| {
            Point3::from(std::array::from_fn::<f64, 3, _>(|d| if i >> d & 1 == 1 { high[d] } else { low[d] }))
        };
        let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let triangles = faces.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect();
        Mesh::new((0..8).map(corner).collect(), triangles)
    }

    #[test]
    fn only_crossing_solids_overlap() {
        let block = cuboid([0.0; 3], [20.0, 10.0, 5.0]);
        assert!((block.volume_mm3() - 1000.0).abs() < 1e-9);
        for (low, high, shared) in [
            ([20.0, 0.0, 0.0], [30.0, 10.0, 5.0], false),
            ([19.98, 0.0, 0.0], [30.0, 10.0, 5.0], false),
            ([19.0, 0.0, 0.0], [30.0, 10.0, 5.0], true),
            ([5.0, 2.0, 2.0], [35.0, 5.0, 4.0], true),
            ([8.0, 4.0, 2.0], [9.0, 5.0, 3.0], true),
            ([8.0, 4.0, -7.0], [9.0, 5.0, 9.0], true),
            ([0.0; 3], [20.0, 10.0, 5.0], true),
            ([50.0; 3], [51.0; 3], false),
        ] {
            let other = cuboid(low, high);
            assert_eq!(shared_place(&block, &other, 0.05, 1_000_000).is_some(), shared, "{low:?}");
            assert_eq!(shared_place(&other, &block, 0.05, 1_000_000).is_some(), shared, "{low:?}");
        }
    }
}
