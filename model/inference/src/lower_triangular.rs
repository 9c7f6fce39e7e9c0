//! Products and inverses of lower triangular matrices, without their zeros.

use nalgebra::DMatrix;

/// Adds the product of a lower triangular matrix and a column to a column of zeros.
#[inline(always)]
pub(crate) fn add_lower_times(lower: &DMatrix<f64>, x: &[f64], sum: &mut [f64]) {
    let n = x.len();
    for (j, x) in x.iter().enumerate() {
        let column = &lower.as_slice()[j * n + j..(j + 1) * n];
        for (sum, entry) in sum[j..].iter_mut().zip(column) {
            *sum += entry * x;
        }
    }
}

/// Returns the inverse of a lower triangular matrix, whose diagonal is positive.
pub(crate) fn inverse(lower: &DMatrix<f64>) -> DMatrix<f64> {
    let n = lower.nrows();
    let mut inverse = DMatrix::identity(n, n);
    for j in 0..n {
        let column = &mut inverse.as_mut_slice()[j * n..(j + 1) * n];
        for k in j..n {
            let (known, rest) = column.split_at_mut(k + 1);
            known[k] /= lower[(k, k)];
            for (x, entry) in rest.iter_mut().zip(&lower.as_slice()[k * n + k + 1..(k + 1) * n]) {
                *x -= known[k] * entry;
            }
        }
    }
    inverse
}

#[cfg(test)]
mod tests {
    use nalgebra::DVector;

    use super::*;
    use crate::random::Random;

    #[test]
    fn lower_products_agree_with_those_of_nalgebra() {
        let mut random = Random::new(4);
        for n in [1, 2, 7, 40] {
            let lower = DMatrix::from_fn(n, n, |i, j| if i >= j { random.normal() } else { 0.0 });
            let x = DVector::from_fn(n, |_, _| random.normal());
            let mut sum = DVector::zeros(n);
            add_lower_times(&lower, x.as_slice(), sum.as_mut_slice());
            assert!((sum - &lower * &x).amax() < 1e-12 * n as f64, "{n}");
        }
    }

    #[test]
    fn a_product_with_the_inverse_is_the_identity() {
        let mut random = Random::new(5);
        for n in [1, 3, 30] {
            let entry =
                |i: usize, j: usize, x: f64| if i > j { x } else { f64::from(u8::from(i == j)) * 2.0 };
            let lower = DMatrix::from_fn(n, n, |i, j| entry(i, j, 0.3 * random.normal()));
            assert!((&lower * inverse(&lower) - DMatrix::identity(n, n)).amax() < 1e-9, "{n}");
        }
    }
}
