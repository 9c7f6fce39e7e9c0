//! What lies near a box of a sheet, without looking at everything.

use super::geometry::{Extent, Point};

/// Side of a cell, mm.
const CELL_MM: f64 = 8.0;
/// Cells along each side: a sheet of A3 and what reaches beyond it.
const CELLS: usize = 60;

/// Items by the cells of the sheet that their boxes touch.
#[derive(Clone, Debug)]
pub(super) struct Index<T> {
    items: Vec<(Extent, T)>,
    cells: Vec<Vec<u32>>,
}

fn cell(mm: f64) -> usize {
    // What lies outside the sheet falls into the cells of its edge.
    (mm / CELL_MM).clamp(0.0, (CELLS - 1) as f64) as usize
}

impl<T> Index<T> {
    pub(super) fn new() -> Self {
        Self { items: Vec::new(), cells: vec![Vec::new(); CELLS * CELLS] }
    }

    fn cells_of(extent: Extent) -> impl Iterator<Item = usize> {
        let (left, right) = (cell(extent.low.x), cell(extent.high.x));
        (cell(extent.low.y)..=cell(extent.high.y))
            .flat_map(move |row| (left..=right).map(move |column| row * CELLS + column))
    }

    pub(super) fn insert(&mut self, extent: Extent, item: T) {
        let number = u32::try_from(self.items.len()).unwrap_or(u32::MAX);
        self.items.push((extent, item));
        for c in Self::cells_of(extent) {
            self.cells[c].push(number);
        }
    }

    /// Whether `is_hit` holds for an item whose box touches `extent`; an item may be asked more than once.
    pub(super) fn any(&self, extent: Extent, mut is_hit: impl FnMut(&T) -> bool) -> bool {
        Self::cells_of(extent).flat_map(|c| &self.cells[c]).any(|n| {
            let (around, item) = &self.items[*n as usize];
            around.grown(1e-9).meets(extent.grown(1e-9)) && is_hit(item)
        })
    }
}

/// A straight piece of a line, and the group it belongs to.
#[derive(Clone, Copy, Debug)]
pub(super) struct Piece {
    pub(super) ends: [Point; 2],
    pub(super) group: usize,
    /// Whether a leader had better not cross it.
    pub(super) is_annotation: bool,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_touches_a_box_is_found_wherever_it_lies() {
        let mut index = Index::new();
        let at = |x: f64, y: f64| Extent::between(Point::new(x, y), Point::new(x + 1.0, y + 1.0));
        for (i, (x, y)) in [(5.0, 5.0), (100.0, 40.0), (-50.0, 900.0)].into_iter().enumerate() {
            index.insert(at(x, y), i);
        }
        let found = |extent: Extent| {
            let mut all = Vec::new();
            index.any(extent, |i| {
                all.push(*i);
                false
            });
            all.dedup();
            all
        };
        assert_eq!(found(at(5.5, 5.5)), [0]);
        assert_eq!(found(at(-50.5, 900.5)), [2]);
        assert!(found(at(50.0, 50.0)).is_empty());
    }
}
