//! Vertices: the facets around each one form a single fan.

use super::stars::Star;
use super::tally::Tally;
use super::{Fault, place};
use crate::mesh::Mesh;

/// Vertices in which two parts of the surface touch without sharing an edge.
#[derive(Default)]
pub(super) struct Fans {
    split: Tally<u32>,
    /// Room to work in: for each facet of a star one that it hangs together with; itself if it leads its group.
    leaders: Vec<usize>,
}

impl Fans {
    pub(super) fn see(&mut self, star: &Star) {
        if self.groups(star) > 1 {
            self.split.add(star.middle);
        }
    }

    /// Number of groups of facets that hang together through edges at the middle.
    fn groups(&mut self, star: &Star) -> usize {
        self.leaders.clear();
        self.leaders.extend(0..star.facets.len());
        let mut groups = star.facets.len();
        for (_, spokes) in star.edges().filter(|(far, _)| *far != star.middle) {
            for two in spokes.windows(2) {
                let (a, b) = (self.leader(two[0].place()), self.leader(two[1].place()));
                groups -= usize::from(a != b);
                self.leaders[b] = a;
            }
        }
        groups
    }

    fn leader(&mut self, mut place: usize) -> usize {
        while self.leaders[place] != place {
            self.leaders[place] = self.leaders[self.leaders[place]];
            place = self.leaders[place];
        }
        place
    }

    /// Adds what the stars further on show.
    pub(super) fn append(&mut self, later: Self) {
        self.split.append(later.split);
    }

    pub(super) fn fault(self, mesh: &Mesh) -> Option<Fault> {
        let Tally { count, first } = self.split;
        first.map(|v| Fault {
            check: "non-manifold vertex",
            count,
            at_mm: place(mesh.positions[v as usize]),
            detail: format!("{count} vertices join parts of the surface that share no edge there"),
        })
    }
}
