//! Bounds on the work of a search, which depend only on the mesh.

/// Units of work that any search may do: the test of a pair of boxes and planes, some 30 ns with
/// all optimisations and 80 ns with those of development.
const FREE_UNITS: usize = 6_000_000;
/// Units of work for each facet; meshes without crowds of facets need fewer.
const UNITS_PER_FACET: usize = 128;

/// Work that a part of a search may still do. Each part has its own budget, so that the outcome
/// does not depend on the number of threads.
#[derive(Clone, Copy, Debug)]
pub(super) struct Budget {
    left: usize,
}

impl Budget {
    /// The budget of one of `parts` parts with `facets` facets.
    pub(super) fn of_part(parts: usize, facets: usize) -> Self {
        Self { left: FREE_UNITS / parts.max(1) + UNITS_PER_FACET * facets }
    }

    /// Spends units of work.
    pub(super) fn spend(&mut self, units: usize) {
        self.left = self.left.saturating_sub(units);
    }

    /// Whether nothing is left.
    pub(super) fn is_spent(self) -> bool {
        self.left == 0
    }
}

/// Describes the bound on pairs of a search over a mesh of `facets` facets.
pub(super) fn bound(facets: usize, pairs: &str) -> String {
    format!("more than {} {pairs}", FREE_UNITS + UNITS_PER_FACET * facets)
}
