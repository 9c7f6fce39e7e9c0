//! Cells in rows, without meaning.

use pinswitch_diagnostic::{Diagnostic, codes};

use crate::number::is_missing;

/// Most cells of a row.
const MAX_COLUMNS: usize = 2_000;
/// Most characters of a cell: a longer one comes from a quote that is not closed.
const MAX_CELL: usize = 20_000;
/// Most rows: a day at a kilohertz has 86 million, but not in one text.
const MAX_ROWS: usize = 50_000_000;

/// The cells of a file. They share one text, so that a long log takes little more memory than its
/// bytes.
#[derive(Clone, Debug, Default)]
pub(crate) struct Sheet {
    text: String,
    /// End of each cell in `text`.
    ends: Vec<u32>,
    /// First cell and line of each row.
    rows: Vec<(u32, u32)>,
    /// First cell of the row that is not complete yet.
    open: u32,
}

impl Sheet {
    /// Appends a cell to the open row, without the blanks around it.
    pub(crate) fn push(&mut self, cell: &str) {
        self.text.push_str(cell.trim_matches(|c: char| c.is_whitespace() || c == '\u{feff}'));
        self.ends.push(u32::try_from(self.text.len()).unwrap_or(u32::MAX));
    }

    /// Ends the open row, which begins at `line`. A row without cells is dropped.
    ///
    /// # Errors
    /// A [`Diagnostic`] if the row or the sheet is too large.
    pub(crate) fn end_row(&mut self, line: usize) -> Result<(), Diagnostic> {
        let first = self.open as usize;
        let count = self.ends.len() - first;
        let at = |problem: String, help: &str| {
            Err(Diagnostic::new(codes::FILE_TOO_LARGE, format!("line {line}: {problem}")).with_help(help))
        };
        if count > MAX_COLUMNS {
            return at(
                format!("{count} cells in a row, at most {MAX_COLUMNS} are read"),
                "keep the columns of force, load, time and direction",
            );
        }
        let longest = (first..self.ends.len()).map(|i| self.span(i).len()).max().unwrap_or_default();
        if longest > MAX_CELL {
            return at(
                format!("a cell has {longest} bytes, at most {MAX_CELL} are read"),
                "close the quote that opens in this line",
            );
        }
        if self.rows.len() >= MAX_ROWS || self.text.len() >= u32::MAX as usize {
            return at(format!("more than {MAX_ROWS} rows"), "divide the file");
        }
        if count > 0 {
            self.rows.push((self.open, u32::try_from(line).unwrap_or(u32::MAX)));
        }
        self.open = u32::try_from(self.ends.len()).unwrap_or(u32::MAX);
        Ok(())
    }

    /// Number of rows.
    pub(crate) fn len(&self) -> usize {
        self.rows.len()
    }

    /// Line of a row in the file, from 1.
    pub(crate) fn line(&self, row: usize) -> usize {
        self.rows.get(row).map_or(0, |r| r.1 as usize)
    }

    /// Number of cells of a row.
    pub(crate) fn width(&self, row: usize) -> usize {
        let first = self.rows.get(row).map_or(self.open, |r| r.0);
        self.rows.get(row + 1).map_or(self.open, |r| r.0).saturating_sub(first) as usize
    }

    /// Returns a cell; empty if the row is shorter.
    pub(crate) fn cell(&self, row: usize, column: usize) -> &str {
        if column >= self.width(row) {
            return "";
        }
        let cell = self.rows.get(row).map_or(0, |r| r.0 as usize) + column;
        self.text.get(self.span(cell)).unwrap_or_default()
    }

    /// Returns the cells of a row.
    pub(crate) fn row(&self, row: usize) -> impl Iterator<Item = &str> {
        (0..self.width(row)).map(move |column| self.cell(row, column))
    }

    /// Fills the empty cells of a column, from a row on, with the cell above.
    ///
    /// # Errors
    /// A [`Diagnostic`] if the sheet becomes too large.
    pub(crate) fn fill_down(&self, column: usize, first_row: usize) -> Result<Self, Diagnostic> {
        let mut filled = Self::default();
        let mut above = "";
        for row in 0..self.len() {
            // An empty cell at the end of a row may be absent.
            let is_data = row >= first_row;
            let width = if is_data { self.width(row).max(column + 1) } else { self.width(row) };
            for (i, cell) in (0..width).map(|i| (i, self.cell(row, i))) {
                let is_filled = i == column && is_data;
                if is_filled && !is_missing(cell) {
                    above = cell;
                }
                filled.push(if is_filled { above } else { cell });
            }
            filled.end_row(self.line(row))?;
        }
        Ok(filled)
    }

    fn span(&self, cell: usize) -> std::ops::Range<usize> {
        let start = cell.checked_sub(1).and_then(|i| self.ends.get(i)).map_or(0, |e| *e as usize);
        start..self.ends.get(cell).map_or(start, |e| *e as usize)
    }
}
