//! Information of the readings on a known change of them.

use nalgebra::DMatrix;

use crate::fit::Fit;
use crate::leave_out::Linearised;
use crate::problem::Problem;

/// Returns the information `x'Px` on the size of a change `x` of the readings, in addition to a fit and
/// to other changes. `None` if the fit's design is not finite.
///
/// `P` is the precision of the readings with all coefficients of the fit integrated. The sizes of the
/// other changes are unknown too, with a prior standard deviation of 1. A change of size 1 is estimated
/// with a standard error of `1/sqrt(x'Px)`.
pub fn information(problem: &Problem, fit: &Fit, change: &[f64], others: &[Vec<f64>]) -> Option<f64> {
    let Linearised { point, .. } = Linearised::new(problem, fit)?;
    let columns = std::iter::once(change).chain(others.iter().map(Vec::as_slice)).flatten().copied();
    let columns = DMatrix::from_iterator(problem.len(), 1 + others.len(), columns);
    let white = point.marginal.whitening.whiten(&columns);
    let cross = &point.solution.root * point.marginal.white_design.transposed_times(&white);
    let all = white.tr_mul(&white) - cross.tr_mul(&cross);
    let known = others.len();
    let of_others = all.view((1, 1), (known, known)) + DMatrix::identity(known, known);
    let shared = all.view((1, 0), (known, 1)).into_owned();
    let explained = shared.dot(&of_others.cholesky()?.solve(&shared));
    Some(all[(0, 0)] - explained)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hypothesis::Hypothesis;
    use crate::test_problem::{fitted, problem};

    /// The fit has no constant for an offset of all readings, but two equal offsets cannot be separated.
    #[test]
    fn equal_changes_share_information() {
        let problem = problem(12, 0.0);
        let (fit, ..) = fitted(&problem, &Hypothesis::default());
        let offset = vec![0.3; problem.len()];
        let alone = information(&problem, &fit, &offset, &[]).unwrap();
        assert!(alone > 10.0, "{alone}");
        let shared = information(&problem, &fit, &offset, std::slice::from_ref(&offset)).unwrap();
        assert!((shared - alone / (1.0 + alone)).abs() < 1e-6 * alone, "{shared} of {alone}");
        let twice: Vec<f64> = offset.iter().map(|x| 2.0 * x).collect();
        let of_twice = information(&problem, &fit, &twice, &[]).unwrap();
        assert!((of_twice / alone - 4.0).abs() < 1e-9, "{of_twice} and {alone}");
    }
}
