//! Parts side by side on a print bed.

use crate::mesh::{Mesh, Vector3};

/// Space between parts, mm.
const GAP_MM: f64 = 6.0;
/// Width after which a new row starts, mm, unless one part is wider.
const ROW_MM: f64 = 130.0;

/// Displacements that lay `meshes` out in rows, all in the positive octant and standing on z = 0, in their order.
pub fn lay_out(meshes: &[&Mesh]) -> Vec<Vector3> {
    let (mut x, mut y, mut depth) = (0.0, 0.0, 0.0f64);
    meshes
        .iter()
        .map(|mesh| {
            let Some((low, high)) = mesh.bounds() else { return Vector3::zeros() };
            let size = high - low;
            if x > 0.0 && x + size.x > ROW_MM {
                (x, y, depth) = (0.0, y + depth + GAP_MM, 0.0);
            }
            let by = Vector3::new(x - low.x, y - low.y, -low.z);
            x += size.x + GAP_MM;
            depth = depth.max(size.y);
            by
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Point3;

    #[test]
    fn parts_stand_apart_in_the_positive_octant() {
        let square = |side: f64| {
            let at = |x: f64, y: f64| Point3::new(x - 50.0, y, -3.0);
            Mesh::new(vec![at(0.0, 0.0), at(side, 0.0), at(side, side)], vec![[0, 1, 2]])
        };
        let meshes: Vec<Mesh> = [60.0, 60.0, 200.0, 10.0].map(square).to_vec();
        let placed: Vec<_> = meshes
            .iter()
            .zip(lay_out(&meshes.iter().collect::<Vec<_>>()))
            .map(|(m, by)| m.clone().translated(by))
            .collect();
        let boxes: Vec<_> = placed.iter().filter_map(Mesh::bounds).collect();
        for (i, (low, high)) in boxes.iter().enumerate() {
            assert!(low.iter().all(|v| *v >= 0.0) && low.z == 0.0);
            for (other_low, other_high) in &boxes[..i] {
                let apart = low.x > other_high.x
                    || other_low.x > high.x
                    || low.y > other_high.y
                    || other_low.y > high.y;
                assert!(apart);
            }
        }
    }
}
