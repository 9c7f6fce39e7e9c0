//! Symmetric positive definite systems with two off-diagonals, as of a bent string on a foundation.

/// Symmetric matrix of half-bandwidth 2, stored by row: the diagonal, and the entries one and two
/// columns to the right.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct BandedMatrix {
    /// `A[i][i]`.
    pub(super) diagonal: Vec<f64>,
    /// `A[i][i + 1]`; the last entry is unused.
    pub(super) first: Vec<f64>,
    /// `A[i][i + 2]`; the last two entries are unused.
    pub(super) second: Vec<f64>,
}

impl BandedMatrix {
    /// Creates a matrix of zeros with `n` rows.
    pub(super) fn zeros(n: usize) -> Self {
        Self { diagonal: vec![0.0; n], first: vec![0.0; n], second: vec![0.0; n] }
    }

    /// Returns `A u`.
    pub(super) fn times(&self, u: &[f64]) -> Vec<f64> {
        let mut out: Vec<f64> = self.diagonal.iter().zip(u).map(|(a, u)| a * u).collect();
        for (distance, entries) in [(1, &self.first), (2, &self.second)] {
            let n = u.len().saturating_sub(distance);
            for ((out, a), u) in out.iter_mut().zip(entries).zip(u.iter().skip(distance)) {
                *out += a * u;
            }
            for ((out, a), u) in out.iter_mut().skip(distance).zip(entries).zip(&u[..n]) {
                *out += a * u;
            }
        }
        out
    }

    /// Solves `A x = b` in place of `b` by the factors `L D L'`, and overwrites the matrix. Returns
    /// `false` if `A` is not positive definite; `b` is then meaningless.
    pub(super) fn solve(&mut self, b: &mut [f64]) -> bool {
        let n = b.len();
        let (diagonal, first, second) =
            (&mut self.diagonal[..n], &mut self.first[..n], &mut self.second[..n]);
        for i in 0..n {
            let pivot = diagonal[i];
            if pivot.is_nan() || pivot <= 0.0 {
                return false;
            }
            let inverse = 1.0 / pivot;
            diagonal[i] = inverse;
            let (one, two) = (first[i] * inverse, second[i] * inverse);
            if i + 1 < n {
                diagonal[i + 1] -= one * first[i];
                b[i + 1] -= one * b[i];
                if i + 2 < n {
                    first[i + 1] -= one * second[i];
                    diagonal[i + 2] -= two * second[i];
                    b[i + 2] -= two * b[i];
                }
            }
            (first[i], second[i]) = (one, two);
        }
        for i in (0..n).rev() {
            let mut x = b[i] * diagonal[i];
            if i + 1 < n {
                x -= first[i] * b[i + 1];
            }
            if i + 2 < n {
                x -= second[i] * b[i + 2];
            }
            b[i] = x;
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn solutions_multiply_back(
            rows in prop::collection::vec((0.1..2.0f64, -1.0..1.0f64, -1.0..1.0f64, -5.0..5.0f64), 1..40)
        ) {
            let n = rows.len();
            let mut a = BandedMatrix::zeros(n);
            for (i, (d, one, two, _)) in rows.iter().enumerate() {
                // Diagonally dominant, so positive definite.
                (a.diagonal[i], a.first[i], a.second[i]) = (4.0 + d, *one, *two);
            }
            let x: Vec<f64> = rows.iter().map(|r| r.3).collect();
            let mut b = a.times(&x);
            prop_assert!(a.solve(&mut b));
            for (solved, true_x) in b.iter().zip(&x) {
                prop_assert!((solved - true_x).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn indefinite_matrices_are_refused() {
        let mut a = BandedMatrix::zeros(3);
        a.diagonal = vec![1.0, -1.0, 1.0];
        assert!(!a.solve(&mut [1.0, 1.0, 1.0]));
    }
}
