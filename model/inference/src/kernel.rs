//! Low-rank bases of covariance kernels over one covariate.
//!
//! A basis `Phi` has one row per reading and one column per coefficient; with independent standard
//! normal coefficients its rows have the covariance `Phi Phi'` of the kernel.

use std::f64::consts::{PI, SQRT_2};

use nalgebra::DMatrix;

/// Returns the Karhunen-Loeve basis of Brownian motion that starts at zero: covariance
/// `min(u, v)` for covariates in 0..1.
pub fn brownian(u: &[f64], rank: usize) -> DMatrix<f64> {
    DMatrix::from_fn(u.len(), rank, |row, column| {
        let frequency = PI * (column as f64 + 0.5);
        SQRT_2 * libm::sin(frequency * u[row]) / frequency
    })
}

/// Returns the basis of Brownian motion with a start of unit variance: what settles may end at zero, as well as begin there.
pub fn brownian_from_any(u: &[f64], rank: usize) -> DMatrix<f64> {
    brownian(u, rank).insert_column(0, 1.0)
}

/// Returns a cosine basis of smooth functions over a covariate in 0..1, with a constant; the
/// amplitude of the `j`-th wave is `j^-decay`.
pub fn smooth(u: &[f64], rank: usize, decay: f64) -> DMatrix<f64> {
    DMatrix::from_fn(u.len(), rank + 1, |row, column| {
        let wave = column as f64;
        if column == 0 { 1.0 } else { libm::cos(PI * wave * u[row]) / libm::pow(wave, decay) }
    })
}

/// Returns independent levels of a factor: column `j` is 1 for rows at level `j`. Rows without a
/// level are zero.
pub fn levels(level_of: &[Option<usize>], count: usize) -> DMatrix<f64> {
    DMatrix::from_fn(
        level_of.len(),
        count,
        |row, column| if level_of[row] == Some(column) { 1.0 } else { 0.0 },
    )
}

/// Returns a basis with one column.
pub fn single(column: &[f64]) -> DMatrix<f64> {
    DMatrix::from_column_slice(column.len(), 1, column)
}

/// Returns the root mean square of the rows' norms: the standard deviation of the function at an
/// average row for standard normal coefficients.
pub fn rms_norm(basis: &DMatrix<f64>) -> f64 {
    (basis.norm_squared() / basis.nrows().max(1) as f64).sqrt()
}

/// Returns the basis of a wave with this number of cycles over a covariate in 0..1, of any phase.
pub fn wave(u: &[f64], cycles: f64) -> DMatrix<f64> {
    DMatrix::from_fn(u.len(), 2, |row, phase| {
        let angle = 2.0 * PI * cycles * u[row];
        if phase == 0 { libm::cos(angle) } else { libm::sin(angle) }
    })
}

/// Returns the basis of an AR(1) process with this correlation over `count` steps, at the step of each
/// row: cosines with the spectrum of the process, at most `rank` of them.
pub fn autoregressive(step: &[usize], count: usize, correlation: f64, rank: usize) -> DMatrix<f64> {
    let n = count.max(1) as f64;
    DMatrix::from_fn(step.len(), rank.min(count), |row, k| {
        let angle = std::f64::consts::PI * k as f64 / n;
        let spectrum = (1.0 - correlation * correlation)
            / (1.0 - 2.0 * correlation * libm::cos(angle) + correlation * correlation);
        let scale = if k == 0 { 1.0 } else { std::f64::consts::SQRT_2 };
        scale * (spectrum / n).sqrt() * libm::cos(angle * (step[row] as f64 + 0.5))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Steps in the middle of a long process have the correlation of their distance.
    #[test]
    fn autoregressive_basis_has_its_correlation() {
        let basis = autoregressive(&[100, 101, 105], 200, 0.6, 200);
        let covariance = &basis * basis.transpose();
        for (i, j, distance) in [(0, 0, 0), (0, 1, 1), (0, 2, 5)] {
            assert!((covariance[(i, j)] - 0.6f64.powi(distance)).abs() < 0.01, "{i} {j}: {covariance}");
        }
    }

    #[test]
    fn brownian_basis_has_its_covariance() {
        let u: Vec<f64> = (0..11).map(|i| f64::from(i) / 10.0).collect();
        let basis = brownian(&u, 2000);
        let covariance = &basis * basis.transpose();
        for i in 0..u.len() {
            for j in 0..u.len() {
                assert!((covariance[(i, j)] - u[i].min(u[j])).abs() < 2e-4, "{i} {j}");
            }
        }
    }

    #[test]
    fn rows_without_level_are_zero() {
        let basis = levels(&[Some(1), None], 2);
        assert_eq!(basis.row(0).iter().copied().collect::<Vec<_>>(), [0.0, 1.0]);
        assert_eq!(basis.row(1).norm(), 0.0);
    }
}
