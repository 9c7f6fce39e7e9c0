//! Slender parts, which need a brim.

use crate::built::BuiltPart;
use pinswitch_solid::mesh::Mesh;

/// Ratio of height to mean width of the foot above which a part needs a brim (cad/doc/print-limits.md, "First layer").
const SLENDER: f64 = 6.0;
/// Width of the brim, mm.
const BRIM_MM: f64 = 5.0;
/// Points closer to the bed are on it, mm.
const ON_BED_MM: f64 = 1e-6;

/// Height of a part, and mean width of its face on the bed.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Footing {
    height_mm: f64,
    width_mm: f64,
}

impl Footing {
    /// Measures a mesh in print orientation. The mean width is twice the area of the foot over the length of its edge. `None`
    /// for a mesh without a foot.
    fn new(mesh: &Mesh) -> Option<Self> {
        let height_mm = mesh.bounds()?.1.z;
        let is_on_bed = |i: u32| mesh.positions[i as usize].z.abs() < ON_BED_MM;
        let foot = mesh.triangles.iter().filter(|t| t.iter().all(|i| is_on_bed(*i)));
        let (mut area, mut edges) = (0.0, std::collections::BTreeMap::new());
        for triangle in foot {
            let [a, b, c] = triangle.map(|i| mesh.positions[i as usize]);
            area += 0.5 * (b - a).cross(&(c - a)).norm();
            for (from, to) in [(0, 1), (1, 2), (2, 0)].map(|(i, j)| (triangle[i], triangle[j])) {
                *edges.entry((from.min(to), from.max(to))).or_insert(0) += 1;
            }
        }
        let length =
            |(from, to): &(u32, u32)| (mesh.positions[*from as usize] - mesh.positions[*to as usize]).norm();
        let around: f64 = edges.iter().filter(|(_, times)| **times == 1).map(|(edge, _)| length(edge)).sum();
        (around > 0.0).then(|| Self { height_mm, width_mm: 2.0 * area / around })
    }

    fn is_slender(self) -> bool {
        self.height_mm > SLENDER * self.width_mm
    }
}

/// Returns the instruction to add brims; `None` if no part needs one.
pub(super) fn brim(printed: &[BuiltPart]) -> Option<String> {
    let slender = printed.iter().filter_map(|part| Some((part, Footing::new(&part.print_mesh)?)));
    let parts: Vec<String> = slender
        .filter(|(_, footing)| footing.is_slender())
        .map(|(part, f)| {
            format!("`{}` ({:.1} mm high on a foot {:.1} mm wide)", part.part().name, f.height_mm, f.width_mm)
        })
        .collect();
    let (last, before) = parts.split_last()?;
    let names = if before.is_empty() { last.clone() } else { format!("{} and {last}", before.join(", ")) };
    Some(format!(
        "Slender parts: add a brim of {BRIM_MM} mm to {names} in the slicer, and remove it before assembly."
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use pinswitch_solid::profile::{ChordTolerance, Contour, Point2};
    use pinswitch_solid::solid::Solid;

    fn footing(width_mm: f64, height_mm: f64) -> Footing {
        let corners = [(0.0, 0.0), (100.0, 0.0), (100.0, width_mm), (0.0, width_mm)];
        let outline = Contour::polygon(corners.map(|(x, y)| Point2::new(x, y)).to_vec());
        let solid = Solid::prism(&outline, &[], 0.0, height_mm, 0.0).unwrap();
        Footing::new(&solid.mesh(ChordTolerance::new(0.01).unwrap()).unwrap()).unwrap()
    }

    #[test]
    fn the_width_of_a_wall_is_its_thickness() {
        let wall = footing(2.0, 14.0);
        assert!((wall.width_mm - 2.0 / 1.02).abs() < 1e-9 && wall.height_mm == 14.0, "{wall:?}");
        assert!(wall.is_slender() && !footing(3.0, 14.0).is_slender());
    }
}
