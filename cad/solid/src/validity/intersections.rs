//! Facets that pass through each other.

use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{AABB, RTree};

use super::triangle_pair::{Corners, meet};
use super::{Fault, place};
use crate::mesh::{Mesh, Point3};

/// The bounding box of a facet with its number.
pub(super) type FacetBox = GeomWithData<Rectangle<[f64; 3]>, usize>;

/// All facets by their bounding boxes.
pub(super) fn facet_tree(mesh: &Mesh) -> RTree<FacetBox> {
    let boxes = mesh.facets().enumerate().map(|(i, [a, b, c])| {
        let (low, high) = (a.inf(&b).inf(&c), a.sup(&b).sup(&c));
        GeomWithData::new(Rectangle::from_corners(low.coords.into(), high.coords.into()), i)
    });
    RTree::bulk_load(boxes.collect())
}

pub(super) fn crossing_facets(mesh: &Mesh) -> Option<Fault> {
    let tree = facet_tree(mesh);
    let corners = |i: usize| -> Corners {
        let t = mesh.triangles[i];
        t.map(|v| (v, mesh.positions[v as usize]))
    };
    let same = |i: usize, j: usize| mesh.triangles[i].iter().all(|v| mesh.triangles[j].contains(v));
    let mut count = 0;
    let mut first: Option<Point3> = None;
    for i in 0..mesh.triangles.len() {
        let s = corners(i);
        let (low, high) = (s[0].1.inf(&s[1].1).inf(&s[2].1).coords, s[0].1.sup(&s[1].1).sup(&s[2].1).coords);
        let near = tree.locate_in_envelope_intersecting(&AABB::from_corners(low.into(), high.into()));
        // Facets on the same corners are counted as repeated, not as crossing.
        for j in near.map(|other| other.data).filter(|j| *j > i && !same(i, *j)) {
            if meet(&s, &corners(j)) {
                count += 1;
                first.get_or_insert(s[0].1);
            }
        }
    }
    first.map(|at| Fault {
        check: "self-intersection",
        count,
        at_mm: place(at),
        detail: format!("{count} pairs of facets pass through each other"),
    })
}
