//! Columns in interleaved lanes: a pass over the rows of a table processes several columns at once
//! with contiguous memory access.

/// Number of columns that are processed together.
pub(crate) const LANES: usize = 8;

/// Up to [`LANES`] columns, row by row; unused lanes are zero.
#[derive(Clone, Debug, Default)]
pub(crate) struct Lanes {
    rows: Vec<[f64; LANES]>,
}

impl Lanes {
    /// Returns zeros.
    pub(crate) fn zeros(len: usize) -> Self {
        Self { rows: vec![[0.0; LANES]; len] }
    }

    /// Returns the rows.
    pub(crate) fn rows(&self) -> &[[f64; LANES]] {
        &self.rows
    }

    /// Returns the rows.
    pub(crate) fn rows_mut(&mut self) -> &mut [[f64; LANES]] {
        &mut self.rows
    }

    /// Sets every column to zero.
    pub(crate) fn clear(&mut self) {
        self.rows.fill([0.0; LANES]);
    }

    /// Extends the columns with zeros, or truncates them.
    pub(crate) fn resize(&mut self, len: usize) {
        self.rows.resize(len, [0.0; LANES]);
    }

    /// Copies columns of one length into the lanes.
    pub(crate) fn take(&mut self, columns: &[Vec<f64>]) {
        self.rows.clear();
        self.rows.resize(columns.first().map_or(0, Vec::len), [0.0; LANES]);
        for (lane, column) in columns.iter().enumerate() {
            self.rows.iter_mut().zip(column).for_each(|(row, v)| row[lane] = *v);
        }
    }

    /// Copies the lanes back to the columns.
    pub(crate) fn give(&self, columns: &mut [Vec<f64>]) {
        for (lane, column) in columns.iter_mut().enumerate() {
            column.iter_mut().zip(&self.rows).for_each(|(v, row)| *v = row[lane]);
        }
    }

    /// Returns one column.
    pub(crate) fn column(&self, lane: usize) -> Vec<f64> {
        self.rows.iter().map(|row| row[lane]).collect()
    }

    /// Returns the squared norm of each column.
    pub(crate) fn squares(&self) -> [f64; LANES] {
        let mut sums = [0.0; LANES];
        for row in &self.rows {
            sums.iter_mut().zip(row).for_each(|(sum, v)| *sum += v * v);
        }
        sums
    }

    /// Returns the inner product of each column with another one.
    pub(crate) fn dots(&self, other: &[f64]) -> [f64; LANES] {
        let mut sums = [0.0; LANES];
        for (row, o) in self.rows.iter().zip(other) {
            sums.iter_mut().zip(row).for_each(|(sum, v)| *sum += o * v);
        }
        sums
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_copied_unchanged() {
        let mut columns = vec![vec![1.0, 2.0, 3.0], vec![-4.0, 5.0, 6.0]];
        let mut lanes = Lanes::zeros(0);
        lanes.take(&columns);
        assert_eq!(lanes.column(1), columns[1]);
        assert_eq!(lanes.squares()[..3], [14.0, 77.0, 0.0]);
        assert_eq!(lanes.dots(&[1.0, 0.0, 2.0])[..3], [7.0, 8.0, 0.0]);
        lanes.rows_mut()[0][0] = 9.0;
        lanes.give(&mut columns);
        assert_eq!(columns, [vec![9.0, 2.0, 3.0], vec![-4.0, 5.0, 6.0]]);
    }
}
