//! Half-edges: every edge has exactly two facets, which run along it in opposite senses.

use super::stars::Star;
use super::tally::Tally;
use super::{Fault, place};
use crate::mesh::Mesh;

/// Edges that are not paired, by what is wrong with them. An edge is named by its lesser and its greater vertex.
#[derive(Default)]
pub(super) struct Edges {
    open: Tally<(u32, u32)>,
    crowded: Tally<(u32, u32)>,
    flipped: Tally<(u32, u32)>,
}

impl Edges {
    /// Counts the edges from the middle of the star to greater vertices.
    pub(super) fn see(&mut self, star: &Star) {
        for (far, spokes) in star.edges().filter(|(far, _)| *far >= star.middle) {
            let along = spokes.iter().filter(|s| s.outgoing()).count();
            let edge = (star.middle, far);
            // An edge from a vertex to itself has each of its half-edges here twice, as it leaves and as it arrives.
            let (along, facets) = if far == star.middle { (0, along) } else { (along, spokes.len()) };
            match facets {
                1 => self.open.add(edge),
                2 if along == 1 => {}
                2 => self.flipped.add(edge),
                _ => self.crowded.add(edge),
            }
        }
    }

    /// Adds what the stars further on show.
    pub(super) fn append(&mut self, later: Self) {
        self.open.append(later.open);
        self.crowded.append(later.crowded);
        self.flipped.append(later.flipped);
    }

    pub(super) fn faults(self, mesh: &Mesh) -> Vec<Fault> {
        let fault = |bad: Tally<(u32, u32)>, check, what: &str| {
            let edge = bad.first?;
            let [a, b] = [edge.0, edge.1].map(|i| mesh.positions[i as usize]);
            let count = bad.count;
            Some(Fault {
                check,
                count,
                at_mm: place(nalgebra::center(&a, &b)),
                detail: format!("{count} edges {what}, the first {:.4} mm long", (b - a).norm()),
            })
        };
        [
            fault(self.open, "open edge", "have one facet only: there is a hole"),
            fault(self.crowded, "non-manifold edge", "have more than two facets"),
            fault(self.flipped, "flipped facet", "have two facets that face opposite ways"),
        ]
        .into_iter()
        .flatten()
        .collect()
    }
}
