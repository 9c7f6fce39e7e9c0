//! Orthogonal projection: an orthonormal basis that grows column by column.

use super::lanes::{LANES, Lanes};
use super::weighed::Weighed;

/// An orthonormal basis of the columns absorbed so far.
#[derive(Clone, Debug)]
pub(crate) struct Projection {
    len: usize,
    basis: Vec<Vec<f64>>,
}

/// Smallest share of its norm that a column must keep to add a direction.
const INDEPENDENT: f64 = 1e-5;

impl Projection {
    pub(crate) fn new(len: usize) -> Self {
        Self { len, basis: Vec::new() }
    }

    /// Returns the basis of columns that are whitened first.
    pub(crate) fn of_whitened(columns: &[Vec<f64>], len: usize, weighed: &Weighed<'_>) -> Self {
        let mut white = columns.to_vec();
        weighed.whiten_all(&mut white);
        let mut projection = Self::new(len);
        white.into_iter().for_each(|column| {
            projection.absorb(column);
        });
        projection
    }

    /// Returns the length of the columns.
    pub(crate) fn len(&self) -> usize {
        self.len
    }

    /// Adds the new direction of a column; returns whether it had one.
    pub(crate) fn absorb(&mut self, mut column: Vec<f64>) -> bool {
        debug_assert_eq!(column.len(), self.len);
        let before = dot(&column, &column).sqrt();
        self.remove(&mut column);
        self.remove(&mut column);
        let after = dot(&column, &column).sqrt();
        let independent = after > INDEPENDENT * before && after > 1e-12;
        if independent {
            column.iter_mut().for_each(|v| *v /= after);
            self.basis.push(column);
        }
        independent
    }

    /// Subtracts the projection onto the basis from a column.
    pub(crate) fn remove(&self, column: &mut [f64]) {
        // Four directions at a time, so that the column is read and written once for all of them.
        let mut groups = self.basis.chunks_exact(4);
        for group in &mut groups {
            let [a, b, c, d] = [0, 1, 2, 3].map(|i| &group[i][..column.len()]);
            let [i, j, k, l] = dots([a, b, c, d], column);
            for (row, v) in column.iter_mut().enumerate() {
                *v -= i * a[row] + j * b[row] + (k * c[row] + l * d[row]);
            }
        }
        for axis in groups.remainder() {
            let share = dot(axis, column);
            if share != 0.0 {
                column.iter_mut().zip(axis).for_each(|(v, a)| *v -= share * a);
            }
        }
    }

    /// Subtracts the projections onto the basis from several columns.
    pub(crate) fn remove_lanes(&self, lanes: &mut Lanes) {
        let shares = self.shares(lanes);
        for (axis, shares) in self.basis.iter().zip(&shares) {
            for (values, a) in lanes.rows_mut().iter_mut().zip(axis) {
                values.iter_mut().zip(shares).for_each(|(v, share)| *v -= a * share);
            }
        }
    }

    /// Returns the components of several columns along each direction.
    pub(crate) fn shares(&self, lanes: &Lanes) -> Vec<[f64; LANES]> {
        let mut shares = Vec::with_capacity(self.basis.len());
        // Two directions at a time, as many sums as there are registers.
        let mut pairs = self.basis.chunks_exact(2);
        for pair in &mut pairs {
            let (mut first, mut second) = ([0.0; LANES], [0.0; LANES]);
            for ((values, a), b) in lanes.rows().iter().zip(&pair[0]).zip(&pair[1]) {
                for lane in 0..LANES {
                    first[lane] += a * values[lane];
                    second[lane] += b * values[lane];
                }
            }
            shares.extend([first, second]);
        }
        shares.extend(pairs.remainder().iter().map(|axis| lanes.dots(axis)));
        shares
    }

    /// Returns the directions.
    pub(crate) fn basis(&self) -> &[Vec<f64>] {
        &self.basis
    }

    /// Returns the number of directions.
    #[cfg(test)]
    pub(crate) fn rank(&self) -> usize {
        self.basis.len()
    }
}

/// Returns inner products of four columns with one.
fn dots(axes: [&[f64]; 4], column: &[f64]) -> [f64; 4] {
    let mut sums = [[0.0; 4]; 4];
    let [a, b, c, d] = axes.map(|axis| axis.chunks_exact(4));
    let whole = column.chunks_exact(4);
    let rest = whole.remainder();
    for ((((x, a), b), c), d) in whole.zip(a).zip(b).zip(c).zip(d) {
        for lane in 0..4 {
            sums[0][lane] += a[lane] * x[lane];
            sums[1][lane] += b[lane] * x[lane];
            sums[2][lane] += c[lane] * x[lane];
            sums[3][lane] += d[lane] * x[lane];
        }
    }
    let done = column.len() - rest.len();
    std::array::from_fn(|i| {
        sums[i].iter().sum::<f64>() + axes[i][done..].iter().zip(rest).map(|(a, x)| a * x).sum::<f64>()
    })
}

/// Returns the inner product, in four independent sums.
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; 4];
    let (a4, b4) = (a.chunks_exact(4), b.chunks_exact(4));
    let rest: f64 = a4.remainder().iter().zip(b4.remainder()).map(|(x, y)| x * y).sum();
    for (x, y) in a4.zip(b4) {
        for i in 0..4 {
            sums[i] += x[i] * y[i];
        }
    }
    sums.iter().sum::<f64>() + rest
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn what_is_left_is_orthogonal(a in prop::collection::vec(-1.0..1.0f64, 7), b in prop::collection::vec(-1.0..1.0f64, 7)) {
            let mut projection = Projection::new(7);
            prop_assume!(projection.absorb(a.clone()));
            let mut rest = b;
            projection.remove(&mut rest);
            prop_assert!(dot(&rest, &a).abs() < 1e-9);
        }
    }

    #[test]
    fn a_copy_adds_no_direction() {
        let mut projection = Projection::new(3);
        assert!(projection.absorb(vec![1.0, 2.0, 3.0]));
        assert!(!projection.absorb(vec![2.0, 4.0, 6.0]));
        assert_eq!(projection.rank(), 1);
    }
}
