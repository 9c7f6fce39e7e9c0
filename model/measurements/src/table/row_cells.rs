//! Compact storage of the original cells of a line, since tables have up to a million lines.

/// Cells of one line, concatenated in one text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct RowCells {
    text: Box<str>,
    /// End of each cell in the text, in bytes.
    ends: Box<[u32]>,
}

impl RowCells {
    /// Returns the cells in the order of the header.
    pub(super) fn iter(&self) -> impl Iterator<Item = &str> {
        let begins = std::iter::once(0).chain(self.ends.iter().copied());
        begins
            .zip(&self.ends)
            .map(|(from, to)| self.text.get(from as usize..*to as usize).unwrap_or_default())
    }

    /// Returns the cell of an index; empty where there is none.
    pub(super) fn get(&self, index: usize) -> &str {
        self.iter().nth(index).unwrap_or_default()
    }

    /// Appends a cell.
    pub(super) fn push(&mut self, cell: &str) {
        *self = self.iter().chain([cell]).collect();
    }
}

impl<'a> FromIterator<&'a str> for RowCells {
    fn from_iter<I: IntoIterator<Item = &'a str>>(cells: I) -> Self {
        let (mut text, mut ends) = (String::new(), Vec::new());
        for cell in cells {
            text.push_str(cell);
            // Files are smaller than 4 GB.
            ends.push(u32::try_from(text.len()).unwrap_or(u32::MAX));
        }
        Self { text: text.into(), ends: ends.into() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_are_returned_unchanged() {
        let all = ["", "5;8", "µ", "", "2.5", ""];
        let mut cells: RowCells = all.into_iter().collect();
        assert!(cells.iter().eq(all));
        cells.push("x,y");
        assert_eq!((cells.get(2), cells.get(6), cells.get(7)), ("µ", "x,y", ""));
        assert_eq!(RowCells::from_iter([]).iter().count(), 0);
    }
}
