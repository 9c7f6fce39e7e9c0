//! Basis of a kernel at the rows of a table. Rows with the same covariate are equal, and are kept once.

use std::collections::HashMap;

use nalgebra::DMatrix;

/// One row per reading, and one column per coefficient.
#[derive(Clone, Debug, PartialEq)]
pub struct Basis {
    /// The different rows, one after the other.
    values: Vec<f64>,
    columns: usize,
    /// Number of the row among them, for each reading.
    of_reading: Vec<u32>,
}

impl Basis {
    /// Returns the number of readings.
    pub fn readings(&self) -> usize {
        self.of_reading.len()
    }

    /// Returns the number of coefficients.
    pub fn coefficients(&self) -> usize {
        self.columns
    }

    /// Returns the values at a reading.
    pub fn at(&self, reading: usize) -> &[f64] {
        let row = self.of_reading[reading] as usize;
        &self.values[row * self.columns..(row + 1) * self.columns]
    }

    /// Returns the function with these coefficients at each reading.
    pub fn function(&self, coefficients: &[f64]) -> Vec<f64> {
        let value = |reading| self.at(reading).iter().zip(coefficients).map(|(x, c)| x * c).sum();
        (0..self.readings()).map(value).collect()
    }

    /// Returns the basis at some of the readings.
    #[must_use]
    pub fn select(&self, readings: &[usize]) -> Self {
        Self { of_reading: readings.iter().map(|i| self.of_reading[*i]).collect(), ..self.clone() }
    }

    /// Returns the columns, multiplied by a factor for each reading.
    pub(crate) fn times(&self, factors: &[f64]) -> DMatrix<f64> {
        DMatrix::from_fn(self.readings(), self.columns, |i, j| self.at(i)[j] * factors[i])
    }
}

impl From<DMatrix<f64>> for Basis {
    fn from(matrix: DMatrix<f64>) -> Self {
        let (columns, rows) = (matrix.ncols(), matrix.transpose());
        let (mut values, mut of_reading): (Vec<f64>, Vec<u32>) = (Vec::new(), Vec::new());
        let mut known: HashMap<u64, u32> = HashMap::new();
        for row in rows.column_iter() {
            let next = u32::try_from(values.len() / columns.max(1)).unwrap_or(u32::MAX);
            let key = row.iter().fold(0, |key, x| fold(key, x.to_bits()));
            let seen = *known.entry(key).or_insert(next);
            let is_equal = seen < next && {
                let before = &values[seen as usize * columns..][..columns];
                before.iter().zip(&row).all(|(a, b)| a.to_bits() == b.to_bits())
            };
            of_reading.push(if is_equal { seen } else { next });
            if !is_equal {
                // The first row of its key, or one that only has the key of another.
                values.extend(&row);
            }
        }
        Self { values, columns, of_reading }
    }
}

/// Adds a number to a key of numbers: different ones rarely have the same key.
fn fold(key: u64, number: u64) -> u64 {
    (key.rotate_left(5) ^ number).wrapping_mul(0x9e37_79b9_7f4a_7c15)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_rows_are_kept_once() {
        let matrix = DMatrix::from_row_slice(4, 2, &[1.0, 2.0, 3.0, 4.0, 1.0, 2.0, 3.0, 5.0]);
        let basis = Basis::from(matrix.clone());
        assert_eq!(basis.values.len(), 6);
        assert_eq!(basis.times(&[1.0; 4]), matrix);
        assert_eq!(basis.function(&[1.0, -1.0]), [-1.0, -1.0, -1.0, -2.0]);
        assert_eq!(
            basis.select(&[3, 0]).times(&[1.0, 2.0]),
            DMatrix::from_row_slice(2, 2, &[3.0, 5.0, 2.0, 4.0])
        );
    }
}
