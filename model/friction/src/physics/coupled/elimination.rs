//! Elimination of a symmetric matrix of half-bandwidth 2 from both ends, which meet in the middle.

use crate::physics::pair::Pair;

/// Returns the first of both rows at which the eliminations from both ends meet.
pub(super) fn middle_row(rows: usize) -> usize {
    (rows - 2) / 2
}

/// Solves for the unknowns from the middle to both ends.
#[inline(always)]
pub(super) fn substitute_back(factors: &[[Pair; 3]], right: &[Pair], x: &mut [Pair]) {
    let n = x.len();
    let (factors, right) = (&factors[..n], &right[..n]);
    let middle = middle_row(n);
    let at = |i: usize, near: Pair, far: Pair| right[i] - factors[i][2] * far - factors[i][1] * near;
    x[middle + 1] = right[middle + 1];
    x[middle] = at(middle, x[middle + 1], Pair::both(0.0));
    let (mut up, mut down) = ((x[middle], x[middle + 1]), (x[middle + 1], x[middle]));
    for k in 0..n - 2 - middle {
        if k < middle {
            let i = middle - 1 - k;
            x[i] = at(i, up.0, up.1);
            up = (x[i], up.0);
        }
        let i = middle + 2 + k;
        x[i] = at(i, down.0, down.1);
        down = (x[i], down.0);
    }
}

/// Elimination of rows of a symmetric matrix of half-bandwidth 2 from one end: what remains to be
/// subtracted from the next row and from the one after it.
#[derive(Clone, Copy, Default)]
pub(super) struct Elimination {
    pub(super) diagonal: [Pair; 2],
    /// Of the entry that couples both rows.
    pub(super) first: Pair,
    pub(super) right: [Pair; 2],
}

impl Elimination {
    /// Eliminates a row with its couplings to the next rows. Returns the inverse pivot, the factors
    /// of both couplings, and the right side over the pivot.
    #[inline(always)]
    pub(super) fn eliminate(
        &mut self,
        diagonal: Pair,
        first: Pair,
        second: Pair,
        b: Pair,
    ) -> ([Pair; 3], Pair) {
        let inverse = Pair::both(1.0) / (diagonal - self.diagonal[0]);
        let (first, b) = (first - self.first, b - self.right[0]);
        let (one, two) = (first * inverse, second * inverse);
        self.diagonal = [one * first + self.diagonal[1], two * second];
        self.first = one * second;
        self.right = [one * b + self.right[1], two * b];
        ([inverse, one, two], b * inverse)
    }
}
