//! Columns side by side: a step that goes through a table's rows does so once for several columns, and the processor works
//! on neighbours in memory.

/// Columns that are worked on together.
pub(crate) const LANES: usize = 8;

/// Up to [`LANES`] columns, row by row; lanes that hold no column are zero.
#[derive(Clone, Debug, Default)]
pub(crate) struct Lanes {
    rows: Vec<[f64; LANES]>,
}

impl Lanes {
    /// Zeros.
    pub(crate) fn zeros(len: usize) -> Self {
        Self { rows: vec![[0.0; LANES]; len] }
    }

    /// The rows.
    pub(crate) fn rows(&self) -> &[[f64; LANES]] {
        &self.rows
    }

    /// The rows.
    pub(crate) fn rows_mut(&mut self) -> &mut [[f64; LANES]] {
        &mut self.rows
    }

    /// Makes every column zero.
    pub(crate) fn clear(&mut self) {
        self.rows.fill([0.0; LANES]);
    }

    /// Lets the columns end with zeros, or without them.
    pub(crate) fn resize(&mut self, len: usize) {
        self.rows.resize(len, [0.0; LANES]);
    }

    /// Takes columns of one length in.
    pub(crate) fn take(&mut self, columns: &[Vec<f64>]) {
        self.rows.clear();
        self.rows.resize(columns.first().map_or(0, Vec::len), [0.0; LANES]);
        for (lane, column) in columns.iter().enumerate() {
            self.rows.iter_mut().zip(column).for_each(|(row, v)| row[lane] = *v);
        }
    }

    /// Gives columns back that were taken in.
    pub(crate) fn give(&self, columns: &mut [Vec<f64>]) {
        for (lane, column) in columns.iter_mut().enumerate() {
            column.iter_mut().zip(&self.rows).for_each(|(v, row)| *v = row[lane]);
        }
    }

    /// One column.
    pub(crate) fn column(&self, lane: usize) -> Vec<f64> {
        self.rows.iter().map(|row| row[lane]).collect()
    }

    /// Squared length of each column.
    pub(crate) fn squares(&self) -> [f64; LANES] {
        let mut sums = [0.0; LANES];
        for row in &self.rows {
            sums.iter_mut().zip(row).for_each(|(sum, v)| *sum += v * v);
        }
        sums
    }

    /// Inner product of each column with another one.
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
    fn columns_come_back_as_they_were() {
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
