//! Counts of faults with their first occurrence.

/// A count, and the first of the counted items.
#[derive(Clone, Copy)]
pub(super) struct Occurrences<T> {
    pub(super) count: usize,
    pub(super) first: Option<T>,
}

impl<T> Default for Occurrences<T> {
    fn default() -> Self {
        Self { count: 0, first: None }
    }
}

impl<T> Occurrences<T> {
    pub(super) fn add(&mut self, item: T) {
        self.count += 1;
        self.first.get_or_insert(item);
    }

    /// Adds the occurrences of a later range.
    pub(super) fn append(&mut self, later: Self) {
        self.count += later.count;
        self.first = self.first.take().or(later.first);
    }
}
