//! Bounds on the work of a search, which depend only on the mesh.

/// Units of work that any search may do: the test of a pair of boxes and planes, some 30 ns with
/// all optimisations and 80 ns with those of development.
const FREE_UNITS: usize = 6_000_000;
/// Units of work for each facet; meshes without crowds of facets need fewer.
const UNITS_PER_FACET: usize = 512;

/// Units of work for the facets in each byte of a file. A 3MF of a flat grid, in which each facet
/// touches twelve others in its plane, needs 22 for both searches. A file of 1 MB may so need 30
/// million units in all, which take some 0.9 s with all optimisations.
const UNITS_PER_BYTE: usize = 24;

/// Work that a part of a search may still do. Each part has its own budget, so that the outcome
/// does not depend on the number of threads.
#[derive(Clone, Copy, Debug)]
pub(super) struct Budget {
    left: usize,
    /// Units for the facets of the part.
    own: usize,
    /// Units in all.
    most: usize,
}

/// Work that the searches may still do for all meshes of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Pool {
    /// Units in addition to those for each facet.
    free: usize,
    /// Units for facets.
    own: usize,
}

impl Pool {
    /// The work of a mesh that is not part of a file.
    pub(super) const UNSHARED: Self = Self { free: FREE_UNITS, own: usize::MAX };

    /// The work of all searches over a mesh of `facets` facets.
    pub(super) fn of_mesh(self, facets: usize) -> Self {
        Self { own: self.own.min(UNITS_PER_FACET * facets), ..self }
    }

    /// Subtracts the work that was done from `before` to `after`.
    pub(super) fn spend(&mut self, before: Self, after: Self) {
        self.free = self.free.saturating_sub(before.free - after.free);
        self.own = self.own.saturating_sub(before.own - after.own);
    }

    /// Units that a search over a mesh of `facets` facets may do in all.
    pub(super) fn units(self, facets: usize) -> usize {
        self.free + self.own.min(UNITS_PER_FACET * facets)
    }

    /// Subtracts the work of the parts of a search.
    pub(super) fn subtract(&mut self, parts: impl Iterator<Item = Budget>) {
        for part in parts {
            let used = part.most - part.left;
            self.free = self.free.saturating_sub(used.saturating_sub(part.own));
            self.own = self.own.saturating_sub(used.min(part.own));
        }
    }
}

/// Work that the searches for intersections and thin walls may do together for all meshes of a file,
/// so that many small crowds of facets are bounded as one large crowd is.
#[derive(Clone, Copy, Debug)]
pub struct Allowance(pub(super) Pool);

impl Allowance {
    /// The allowance of a file of this length. A short file may unpack to many facets.
    pub fn of_bytes(bytes: usize) -> Self {
        Self(Pool { own: UNITS_PER_BYTE.saturating_mul(bytes), ..Pool::UNSHARED })
    }
}

impl Default for Allowance {
    fn default() -> Self {
        Self(Pool::UNSHARED)
    }
}

impl Budget {
    /// The budget of one of `parts` parts of a search, with `facets` of the `all` facets of the mesh.
    pub(super) fn of_part(pool: Pool, parts: usize, facets: usize, all: usize) -> Self {
        let share = pool.own as f64 * facets as f64 / all.max(1) as f64;
        let own = (UNITS_PER_FACET * facets).min(share as usize);
        let most = pool.free / parts.max(1) + own;
        Self { left: most, own, most }
    }

    /// The budget of facets around one vertex, without units in addition to those for each facet.
    pub(super) fn of_hub(pool: Pool, facets: usize, all: usize) -> Self {
        Self::of_part(Pool { free: 0, ..pool }, 1, facets, all)
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
pub(super) fn bound(pool: Pool, facets: usize, pairs: &str) -> String {
    format!("more than {} {pairs}", pool.units(facets))
}
