//! Bases of kernels by cell: most are constant within each direction of a series, and their rows there do not depend on a fit.

use std::ops::Range;

use nalgebra::DMatrix;

use crate::basis::Basis;

/// A basis, by cell if it is constant in each.
#[derive(Debug)]
pub(crate) struct BasisByCell {
    pub(crate) basis: Basis,
    pub(crate) cells: Option<Cells>,
}

impl BasisByCell {
    pub(crate) fn new(basis: &Basis, ranges: &[Range<usize>], is_second: &[bool]) -> Self {
        Self { basis: basis.clone(), cells: basis.of_cells(ranges, is_second).map(Cells::new) }
    }
}

/// Kernels that have the same bases through different channels.
#[derive(Debug)]
pub(crate) struct KernelsOfBases {
    pub(crate) kernels: Vec<usize>,
    /// One for each form.
    pub(crate) bases: Vec<BasisByCell>,
}

impl KernelsOfBases {
    /// Groups kernels by the bases of each; those that share their bases follow each other.
    pub(crate) fn new(bases: &[Vec<Basis>], ranges: &[Range<usize>], is_second: &[bool]) -> Vec<Self> {
        let is_shared = |a: &usize, b: &usize| match (bases[*a].first(), bases[*b].first()) {
            (Some(a), Some(b)) => a.is_shared_with(b),
            _ => false,
        };
        let by_cell = |basis: &Basis| BasisByCell::new(basis, ranges, is_second);
        let kernels: Vec<usize> = (0..bases.len()).collect();
        kernels
            .chunk_by(is_shared)
            .map(|kernels| Self {
                kernels: kernels.to_vec(),
                bases: bases[kernels[0]].iter().map(by_cell).collect(),
            })
            .collect()
    }
}

/// A basis with one row per cell.
#[derive(Debug)]
pub(crate) struct Cells {
    pub(crate) rows: DMatrix<f64>,
    /// Largest entry of each row.
    pub(crate) largest: Vec<f64>,
}

impl Cells {
    fn new(rows: DMatrix<f64>) -> Self {
        let largest = rows.row_iter().map(|row| row.amax()).collect();
        Self { rows, largest }
    }

    /// Returns the sum over the cells `i`, `j` of each series of `phi_i m_ij phi_j`, for a basis of one column.
    pub(crate) fn quadratic_form(&self, products: &DMatrix<f64>) -> f64 {
        let series = products.nrows();
        let of_series = |at: usize| {
            let phi = [self.rows[at], self.rows[series + at]];
            (0..4).map(|i| phi[i / 2] * products[(at, i)] * phi[i % 2]).sum::<f64>()
        };
        (0..series).map(of_series).sum()
    }
}
