//! A grid index of the items on a sheet.

use super::geometry::{Extent, Point};

/// Side of a cell, mm.
const CELL_MM: f64 = 8.0;
/// Cells along each side: an A3 sheet with a margin.
const CELLS: usize = 60;

/// Items by the cells that their boxes touch.
#[derive(Clone, Debug)]
pub(super) struct Index<T> {
    items: Vec<(Extent, T)>,
    cells: Vec<Vec<u32>>,
}

fn cell(mm: f64) -> usize {
    // Positions outside of the sheet are in the cells of its edge.
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

    /// Returns whether `is_hit` is true for an item whose box touches `extent`. It may be called several times for an item.
    pub(super) fn any(&self, extent: Extent, mut is_hit: impl FnMut(&T) -> bool) -> bool {
        Self::cells_of(extent).flat_map(|c| &self.cells[c]).any(|n| {
            let (around, item) = &self.items[*n as usize];
            around.grown(1e-9).overlaps(extent.grown(1e-9)) && is_hit(item)
        })
    }
}

/// A straight piece of a line, with its group.
#[derive(Clone, Copy, Debug)]
pub(super) struct Piece {
    pub(super) ends: [Point; 2],
    pub(super) group: usize,
    /// Whether it belongs to an annotation, which leaders avoid to cross.
    pub(super) is_annotation: bool,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn items_are_found_inside_and_outside() {
        let mut index = Index::new();
        let at = |x: f64, y: f64| Extent::between(Point::new(x, y), Point::new(x + 1.0, y + 1.0));
        for (i, (x, y)) in [(5.0, 5.0), (100.0, 40.0), (-50.0, 900.0)].into_iter().enumerate() {
            index.insert(at(x, y), i);
        }
        let touched = |extent: Extent| {
            let mut all = Vec::new();
            index.any(extent, |i| {
                all.push(*i);
                false
            });
            all.dedup();
            all
        };
        assert_eq!(touched(at(5.5, 5.5)), [0]);
        assert_eq!(touched(at(-50.5, 900.5)), [2]);
        assert!(touched(at(50.0, 50.0)).is_empty());
    }
}
