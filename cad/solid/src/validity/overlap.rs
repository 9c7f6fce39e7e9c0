//! Whether two solids of an assembly share space: meshes of their own, which may touch.

use super::bodies::winding;
use crate::mesh::{Mesh, Point3, Vector3};

/// Samples along the longest edge of a facet, at most.
const FINEST: usize = 12;
/// Samples along the diagonal of the smaller solid.
const ACROSS: f64 = 24.0;

/// Each sample asks every facet of the other solid: of large meshes only some samples do, so that it ends within seconds.
const MOST_FACETS_ASKED: usize = 300_000_000;

/// A place at which two closed meshes share space, further than `depth_mm` below the surface of one of them; `None` if
/// none is found. Solids that touch do not share space, and neither do curved ones whose facets cut into each other by
/// less than that.
///
/// Surfaces are sampled: a corner that dips in beside all samples is not seen.
pub fn shared_place(one: &Mesh, other: &Mesh, depth_mm: f64) -> Option<[f64; 3]> {
    let (Some(a), Some(b)) = (one.bounds(), other.bounds()) else { return None };
    let (low, high) = (a.0.sup(&b.0), a.1.inf(&b.1));
    if (high - low).iter().any(|side| *side <= depth_mm) {
        return None;
    }
    let step = ((a.1 - a.0).norm()).min((b.1 - b.0).norm()) / ACROSS;
    let is_near = |p: &Point3| (0..3).all(|i| p[i] >= low[i] && p[i] <= high[i]);
    let within = |of: &Mesh, among: &Mesh| {
        let near: Vec<Point3> = samples(of, step, depth_mm).filter(is_near).collect();
        let every = (near.len().saturating_mul(among.triangles.len()) / MOST_FACETS_ASKED).max(1);
        let found = near.into_iter().step_by(every).find(|p| winding(among.facets(), *p).abs() > 0.5);
        found.map(|p| [p.x, p.y, p.z])
    };
    within(one, other).or_else(|| within(other, one))
}

/// Points a little below every facet.
fn samples(mesh: &Mesh, step: f64, depth_mm: f64) -> impl Iterator<Item = Point3> + '_ {
    mesh.facets().flat_map(move |[a, b, c]| {
        let normal = (b - a).cross(&(c - a)).try_normalize(0.0).unwrap_or_else(Vector3::zeros);
        let longest = (b - a).norm().max((c - b).norm()).max((a - c).norm());
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        let n = ((longest / step).ceil() as usize).clamp(1, FINEST);
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
    fn solids_that_touch_share_nothing_and_those_that_cross_do() {
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
            assert_eq!(shared_place(&block, &other, 0.05).is_some(), shared, "{low:?}");
            assert_eq!(shared_place(&other, &block, 0.05).is_some(), shared, "{low:?}");
        }
    }
}
