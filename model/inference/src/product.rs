//! Products of tall matrices, in a fixed order of additions: equal inputs give equal bytes on every processor.

use nalgebra::DMatrix;

/// Rows of a block: as many as the processor's cache holds of some ten columns.
const BLOCK_ROWS: usize = 256;
/// Partial sums of an inner product, which a processor adds side by side.
const LANES: usize = 4;
/// Columns whose inner products with another one are computed together.
const TOGETHER: usize = 4;

/// Returns `A'B`.
pub(crate) fn cross_products(a: &DMatrix<f64>, b: &DMatrix<f64>) -> DMatrix<f64> {
    let (rows, mut products) = (a.nrows(), DMatrix::zeros(a.ncols(), b.ncols()));
    let column = |matrix: &DMatrix<f64>, j: usize| j * matrix.nrows();
    for first in (0..rows).step_by(BLOCK_ROWS) {
        let last = (first + BLOCK_ROWS).min(rows);
        for j in 0..b.ncols() {
            let right = &b.as_slice()[column(b, j) + first..column(b, j) + last];
            let left = |i: usize| &a.as_slice()[column(a, i) + first..column(a, i) + last];
            let mut i = 0;
            while i < a.ncols() {
                // The last few columns repeat the very last one.
                let columns = std::array::from_fn(|k| left((i + k).min(a.ncols() - 1)));
                for (k, sum) in inner_products(columns, right).into_iter().enumerate() {
                    if i + k < a.ncols() {
                        products[(i + k, j)] += sum;
                    }
                }
                i += TOGETHER;
            }
        }
    }
    products
}

/// Returns the inner products of some columns with another one, all of one length.
#[inline(always)]
fn inner_products(left: [&[f64]; TOGETHER], right: &[f64]) -> [f64; TOGETHER] {
    let whole = right.len() / LANES * LANES;
    let mut sums = [[0.0; LANES]; TOGETHER];
    for at in (0..whole).step_by(LANES) {
        for (sums, left) in sums.iter_mut().zip(left) {
            for lane in 0..LANES {
                sums[lane] += left[at + lane] * right[at + lane];
            }
        }
    }
    std::array::from_fn(|k| {
        let rest = (whole..right.len()).map(|at| left[k][at] * right[at]).sum::<f64>();
        (sums[k][0] + sums[k][1]) + (sums[k][2] + sums[k][3]) + rest
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    #[test]
    fn products_agree_with_those_of_nalgebra() {
        let mut random = Random::new(3);
        for (rows, left, right) in [(1, 1, 1), (3, 5, 2), (257, 4, 3), (1030, 9, 7)] {
            let mut matrix = |columns: usize| DMatrix::from_fn(rows, columns, |_, _| random.normal());
            let (a, b) = (matrix(left), matrix(right));
            let off = cross_products(&a, &b) - a.tr_mul(&b);
            assert!(off.amax() < 1e-11 * rows as f64, "{rows}");
        }
    }
}
