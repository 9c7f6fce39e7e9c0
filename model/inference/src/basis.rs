//! Basis of a kernel at the rows of a table. Rows with the same covariate are equal, and are kept once.

use std::collections::HashMap;
use std::hash::{Hash, Hasher};
use std::ops::Range;
use std::sync::Arc;

use nalgebra::DMatrix;

/// One row per reading, and one column per coefficient. Clones share their numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct Basis {
    /// The different rows, one after the other.
    values: Arc<[f64]>,
    columns: usize,
    /// Number of the row among them, for each reading.
    of_reading: Arc<[u32]>,
}

impl Basis {
    /// Returns a basis of readings in groups, by the row of each group and the number of each reading's group.
    pub fn of_groups(rows: &DMatrix<f64>, of_reading: Arc<[u32]>) -> Self {
        Self { values: rows.transpose().as_slice().into(), columns: rows.ncols(), of_reading }
    }

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

    /// Returns whether another basis of the same readings is a clone of this one.
    pub(crate) fn is_shared_with(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.values, &other.values)
    }

    /// Returns the largest size of a value.
    pub(crate) fn largest(&self) -> f64 {
        self.values.iter().fold(0.0, |most, value| most.max(value.abs()))
    }

    /// Returns the readings where it is not zero.
    pub(crate) fn support(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.readings()).filter(|reading| self.at(*reading).iter().any(|x| *x != 0.0))
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

    /// Returns one row per series, if the basis is constant within each.
    pub(crate) fn of_series(&self, ranges: &[Range<usize>]) -> Option<DMatrix<f64>> {
        let is_constant = |range: &Range<usize>| {
            let of_series = &self.of_reading[range.clone()];
            of_series.iter().all(|number| *number == of_series[0])
        };
        let value = |series: usize, column: usize| self.at(ranges[series].start)[column];
        ranges.iter().all(is_constant).then(|| DMatrix::from_fn(ranges.len(), self.columns, value))
    }

    /// Returns one row per series and direction, if the basis is constant in each: those of the first direction, then those of
    /// the second; zeros where a series has no reading.
    pub(crate) fn of_cells(&self, ranges: &[Range<usize>], is_second: &[bool]) -> Option<DMatrix<f64>> {
        let mut cells = DMatrix::zeros(2 * ranges.len(), self.columns);
        let mut numbers = vec![None; 2 * ranges.len()];
        for (series, range) in ranges.iter().enumerate() {
            for reading in range.clone() {
                let cell = if is_second[reading] { ranges.len() + series } else { series };
                match numbers[cell] {
                    Some(number) if number != self.of_reading[reading] => return None,
                    Some(_) => {}
                    None => {
                        numbers[cell] = Some(self.of_reading[reading]);
                        cells.row_mut(cell).copy_from_slice(self.at(reading));
                    }
                }
            }
        }
        Some(cells)
    }

    /// Returns the basis of the first coefficients, at most this many.
    pub(crate) fn first(&self, most: usize) -> Self {
        if self.columns <= most {
            return self.clone();
        }
        let rows = self.values.chunks_exact(self.columns).flat_map(|row| &row[..most]).copied();
        Self { values: rows.collect(), columns: most, of_reading: self.of_reading.clone() }
    }

    /// Returns the columns, multiplied by a factor for each reading.
    pub(crate) fn times(&self, factors: &[f64]) -> DMatrix<f64> {
        DMatrix::from_fn(self.readings(), self.columns, |i, j| self.at(i)[j] * factors[i])
    }
}

impl From<DMatrix<f64>> for Basis {
    fn from(matrix: DMatrix<f64>) -> Self {
        // Each column is a row of the basis, which is then contiguous.
        let (columns, rows) = (matrix.ncols(), matrix.transpose());
        let row = |reading: usize| Bits(&rows.as_slice()[reading * columns..(reading + 1) * columns]);
        let (mut values, mut known, mut of_reading) = (Vec::new(), HashMap::new(), Vec::<u32>::new());
        for reading in 0..matrix.nrows() {
            // Most rows are equal to the one before, which needs no hash.
            let number = match of_reading.last() {
                Some(last) if row(reading) == row(reading - 1) => *last,
                _ => {
                    let next = u32::try_from(known.len()).unwrap_or(u32::MAX);
                    *known.entry(row(reading)).or_insert_with(|| {
                        values.extend(row(reading).0);
                        next
                    })
                }
            };
            of_reading.push(number);
        }
        Self { values: values.into(), columns, of_reading: of_reading.into() }
    }
}

/// Numbers that are equal if their bits are.
struct Bits<'a>(&'a [f64]);

impl PartialEq for Bits<'_> {
    fn eq(&self, other: &Self) -> bool {
        self.0.iter().map(|x| x.to_bits()).eq(other.0.iter().map(|x| x.to_bits()))
    }
}

impl Eq for Bits<'_> {}

impl Hash for Bits<'_> {
    fn hash<H: Hasher>(&self, state: &mut H) {
        self.0.iter().for_each(|x| state.write_u64(x.to_bits()));
    }
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
        let groups = DMatrix::from_row_slice(3, 2, &[1.0, 2.0, 3.0, 4.0, 3.0, 5.0]);
        assert_eq!(Basis::of_groups(&groups, [0, 1, 0, 2].into()), basis);
        assert_eq!(
            basis.select(&[3, 0]).times(&[1.0, 2.0]),
            DMatrix::from_row_slice(2, 2, &[3.0, 5.0, 2.0, 4.0])
        );
        assert_eq!(basis.first(1).times(&[1.0; 4]), matrix.columns(0, 1));
        assert_eq!(basis.first(2), basis);
    }
}
