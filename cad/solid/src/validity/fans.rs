//! Vertices: the facets around each one form a single fan.

use super::{Fault, place};
use crate::mesh::Mesh;

/// Vertices in which two parts of the surface touch without sharing an edge.
pub(super) fn split_vertices(mesh: &Mesh) -> Option<Fault> {
    let around = facets_around(mesh);
    let split: Vec<usize> = (0..mesh.positions.len()).filter(|v| fans(mesh, &around, *v) > 1).collect();
    split.first().map(|v| Fault {
        check: "non-manifold vertex",
        count: split.len(),
        at_mm: place(mesh.positions[*v]),
        detail: format!("{} vertices join parts of the surface that share no edge there", split.len()),
    })
}

/// Facet numbers around each vertex, packed: those of vertex `v` are `facets[starts[v]..starts[v + 1]]`.
struct Around {
    starts: Vec<usize>,
    facets: Vec<usize>,
}

fn facets_around(mesh: &Mesh) -> Around {
    let mut starts = vec![0; mesh.positions.len() + 1];
    for v in mesh.triangles.iter().flatten() {
        starts[*v as usize + 1] += 1;
    }
    for v in 1..starts.len() {
        starts[v] += starts[v - 1];
    }
    let mut next = starts.clone();
    let mut facets = vec![0; 3 * mesh.triangles.len()];
    for (f, t) in mesh.triangles.iter().enumerate() {
        for v in t {
            facets[next[*v as usize]] = f;
            next[*v as usize] += 1;
        }
    }
    Around { starts, facets }
}

/// Number of groups of facets around vertex `v` that hang together through edges at `v`.
fn fans(mesh: &Mesh, around: &Around, v: usize) -> usize {
    let facets = &around.facets[around.starts[v]..around.starts[v + 1]];
    let shares_edge = |f: usize, g: usize| {
        let others = mesh.triangles[f].iter().filter(|i| **i as usize != v);
        others.filter(|i| mesh.triangles[g].contains(i)).count() > 0
    };
    let mut left: Vec<usize> = facets.to_vec();
    let mut groups = 0;
    while let Some(seed) = left.pop() {
        groups += 1;
        let mut front = vec![seed];
        while let Some(f) = front.pop() {
            let (joined, rest) = left.into_iter().partition(|g| shares_edge(f, *g));
            left = rest;
            front.extend::<Vec<usize>>(joined);
        }
    }
    groups
}
