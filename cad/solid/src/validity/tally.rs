//! How many of a kind were found, and the first of them.

/// A count with the first of what was counted.
#[derive(Clone, Copy)]
pub(super) struct Tally<T> {
    pub(super) count: usize,
    pub(super) first: Option<T>,
}

impl<T> Default for Tally<T> {
    fn default() -> Self {
        Self { count: 0, first: None }
    }
}

impl<T> Tally<T> {
    pub(super) fn add(&mut self, item: T) {
        self.count += 1;
        self.first.get_or_insert(item);
    }

    /// Adds what was found further on.
    pub(super) fn append(&mut self, later: Self) {
        self.count += later.count;
        self.first = self.first.take().or(later.first);
    }
}
