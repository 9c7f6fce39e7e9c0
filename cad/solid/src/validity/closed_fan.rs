//! Closed fans: the ordinary one-ring, found without sorting its half-edges.

use crate::mesh::Mesh;

/// Facets around a vertex up to which a fan is walked, since every step compares all of them.
const MOST_FACETS: usize = 16;

/// Returns whether the `facets` around `centre` are a single closed fan of three or more, in which every edge from the centre
/// has one outgoing and one incoming half-edge. Such a one-ring has no fault, and all its facets are different. `false` also
/// for a fan of many facets.
pub(super) fn is_closed_fan(mesh: &Mesh, centre: u32, facets: &[u32]) -> bool {
    let count = facets.len();
    if !(3..=MOST_FACETS).contains(&count) {
        return false;
    }
    // Vertices after and before the centre, of each facet.
    let (mut after, mut before) = ([0; MOST_FACETS], [0; MOST_FACETS]);
    for (i, facet) in facets.iter().enumerate() {
        let [a, b, c] = mesh.triangles[*facet as usize];
        let corners = if a == centre {
            (b, c)
        } else if b == centre {
            (c, a)
        } else {
            (a, b)
        };
        (after[i], before[i]) = corners;
        if a == b || b == c || c == a {
            return false;
        }
    }
    let mut at = 0;
    for step in 1..=count {
        let mut next = (0..count).filter(|i| after[*i] == before[at]);
        let (Some(only), None) = (next.next(), next.next()) else { return false };
        if only == 0 {
            return step == count;
        }
        at = only;
    }
    false
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Point3;

    /// Facets around vertex 0, by their other two vertices.
    fn is_fan(facets: &[[u32; 2]]) -> bool {
        let triangles: Vec<[u32; 3]> = facets.iter().map(|[a, b]| [0, *a, *b]).collect();
        let mesh = Mesh::new(vec![Point3::origin(); 10], triangles);
        is_closed_fan(&mesh, 0, &(0..).take(facets.len()).collect::<Vec<_>>())
    }

    #[test]
    fn only_a_closed_fan_is_one() {
        assert!(is_fan(&[[1, 2], [2, 3], [3, 1]]));
        assert!(is_fan(&[[3, 4], [1, 2], [4, 1], [2, 3]]));
        // Open, turned over, twice the same, two fans, two fans with a common edge.
        assert!(!is_fan(&[[1, 2], [2, 3], [3, 4]]));
        assert!(!is_fan(&[[1, 2], [3, 2], [3, 1]]));
        assert!(!is_fan(&[[1, 2], [2, 1]]));
        assert!(!is_fan(&[[1, 2], [2, 3], [3, 1], [4, 5], [5, 6], [6, 4]]));
        assert!(!is_fan(&[[1, 2], [2, 3], [3, 1], [1, 4], [4, 5], [5, 1]]));
        assert!(!is_fan(&[[1, 2], [2, 3], [3, 0]]));
    }
}
