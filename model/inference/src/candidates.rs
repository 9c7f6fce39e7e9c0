//! Products of the columns of the elements that could be added to a fit with the precision of the noise.
//!
//! The columns of a kernel are its basis times the sensitivity `c` to its channel. Most bases are constant within each series.
//! With the row `phi_s` of the basis for series `s` their products follow from those of the one column `c`, for any columns `Z`:
//! `X'V^-1 Z = sum_s phi_s (c_s'V_s^-1 Z_s)`.

use std::collections::BTreeMap;

use nalgebra::{DMatrix, DVector};

use crate::basis::Basis;
use crate::hypothesis::Element;
use crate::marginal::Marginal;

/// Largest entry of columns that change no reading.
const LEAST_ENTRY: f64 = 1e-9;
/// Columns that are whitened together, so that each series' factor is read once for all of them.
const BLOCK_COLUMNS: usize = 64;

/// Products of the columns `x` of an element.
pub(crate) struct Candidate {
    pub(crate) element: Element,
    /// `x'V^-1 x`, before the coefficients of the fit are integrated.
    pub(crate) gram: DMatrix<f64>,
    /// `A'V^-1 x`.
    pub(crate) cross: DMatrix<f64>,
    /// `x'V^-1 r`.
    pub(crate) moment: DVector<f64>,
    /// Largest change of a reading per size, relative to the smallest relevant one.
    pub(crate) relevance: f64,
}

/// Collects candidates of a fit.
pub(crate) struct Candidates<'a> {
    marginal: &'a Marginal,
    channels: &'a [Vec<f64>],
    of_series: BTreeMap<usize, SeriesProducts>,
    /// Element, relevance and number of columns of each candidate of the block.
    waiting: Vec<(Element, f64, usize)>,
    /// Their columns, one after the other.
    columns: Vec<f64>,
    done: Vec<Candidate>,
}

impl<'a> Candidates<'a> {
    pub(crate) fn new(marginal: &'a Marginal, channels: &'a [Vec<f64>]) -> Self {
        Self {
            marginal,
            channels,
            of_series: BTreeMap::new(),
            waiting: Vec::new(),
            columns: Vec::new(),
            done: Vec::new(),
        }
    }

    /// Adds an effect by the change of the readings per size.
    pub(crate) fn add_effect(&mut self, element: Element, relevance: f64, column: &DVector<f64>) {
        self.columns.extend_from_slice(column.as_slice());
        self.waits(element, relevance, 1);
    }

    /// Adds a kernel that acts through a channel, unless it changes no reading.
    pub(crate) fn add_kernel(&mut self, element: Element, basis: &Basis, channel: usize) {
        let sensitivity = &self.channels[channel];
        if let Some(rows) = basis.of_series(&self.marginal.whitening.ranges) {
            let marginal = self.marginal;
            let products =
                self.of_series.entry(channel).or_insert_with(|| SeriesProducts::new(marginal, sensitivity));
            self.done.extend(products.candidate(element, &rows));
            return;
        }
        let columns = basis.times(sensitivity);
        if columns.amax() > LEAST_ENTRY {
            self.columns.extend_from_slice(columns.as_slice());
            self.waits(element, 0.0, columns.ncols());
        }
    }

    fn waits(&mut self, element: Element, relevance: f64, columns: usize) {
        self.waiting.push((element, relevance, columns));
        if self.columns.len() >= BLOCK_COLUMNS * self.marginal.white_target.len() {
            self.whiten();
        }
    }

    fn whiten(&mut self) {
        let count = self.waiting.iter().map(|(.., columns)| columns).sum();
        let mut columns = std::mem::take(&mut self.columns);
        self.marginal.whitening.whiten_mut(&mut columns);
        let white = DMatrix::from_vec(self.marginal.white_target.len(), count, columns);
        let cross = self.marginal.white_design.transposed_times(&white);
        let moment = white.tr_mul(&self.marginal.white_target);
        let mut first = 0;
        for (element, relevance, count) in self.waiting.drain(..) {
            let own = white.columns(first, count);
            self.done.push(Candidate {
                element,
                gram: own.tr_mul(&own),
                cross: cross.columns(first, count).into_owned(),
                moment: moment.rows(first, count).into_owned(),
                relevance,
            });
            first += count;
        }
    }

    pub(crate) fn finish(mut self) -> Vec<Candidate> {
        self.whiten();
        self.done
    }
}

/// Products of the sensitivity `c_s` to a channel of each series.
struct SeriesProducts {
    /// `c_s'V_s^-1 c_s`.
    gram: DVector<f64>,
    /// `A_s'V_s^-1 c_s`, one column per series.
    cross: DMatrix<f64>,
    /// `c_s'V_s^-1 r_s`.
    moment: DVector<f64>,
    /// Largest entry of `c_s`.
    largest: DVector<f64>,
}

impl SeriesProducts {
    fn new(marginal: &Marginal, sensitivity: &[f64]) -> Self {
        let white = marginal.whitening.whiten_vector(&DVector::from_column_slice(sensitivity));
        let ranges = &marginal.whitening.ranges;
        let part = |series: usize| white.rows(ranges[series].start, ranges[series].len());
        let largest = |series: usize| {
            sensitivity[ranges[series].clone()].iter().fold(0.0f64, |most, c| most.max(c.abs()))
        };
        let target = |series: usize| marginal.white_target.rows(ranges[series].start, ranges[series].len());
        Self {
            gram: DVector::from_fn(ranges.len(), |series, _| part(series).norm_squared()),
            cross: marginal.white_design.transposed_times_series(&white),
            moment: DVector::from_fn(ranges.len(), |series, _| part(series).dot(&target(series))),
            largest: DVector::from_fn(ranges.len(), |series, _| largest(series)),
        }
    }

    /// Returns the candidate of a basis with one row per series; `None` if it changes no reading.
    fn candidate(&self, element: Element, rows: &DMatrix<f64>) -> Option<Candidate> {
        let weighted = |weights: &DVector<f64>| {
            DMatrix::from_fn(rows.nrows(), rows.ncols(), |series, j| weights[series] * rows[(series, j)])
        };
        (weighted(&self.largest).amax() > LEAST_ENTRY).then(|| Candidate {
            element,
            gram: rows.tr_mul(&weighted(&self.gram)),
            cross: &self.cross * rows,
            moment: rows.tr_mul(&self.moment),
            relevance: 0.0,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hypothesis::Member;
    use crate::random::Random;
    use crate::test_problem::{fitted, full_hypothesis, long_problem};

    /// A basis that is constant within each series has the products of its columns.
    #[test]
    fn products_by_series_are_those_of_the_columns() {
        let problem = long_problem(7, 9, 0.4);
        let (_, design, point) = fitted(&problem, &full_hypothesis());
        let mut random = Random::new(3);
        let values = DMatrix::from_fn(7, 3, |_, _| random.normal());
        let rows = DMatrix::from_fn(problem.len(), 3, |row, j| values[(problem.rows.series[row], j)]);
        let basis = Basis::from(rows);
        let element = Element { member: Member::Kernel(0), form: 0 };
        let mut candidates = Candidates::new(&point.marginal, &design.channels);
        candidates.add_kernel(element, &basis, 1);
        let columns = basis.times(&design.channels[1]);
        for column in columns.column_iter() {
            candidates.add_effect(element, 0.0, &column.into_owned());
        }
        let zero = Basis::from(DMatrix::zeros(problem.len(), 2));
        candidates.add_kernel(element, &zero, 1);
        let found = candidates.finish();
        assert_eq!(found.len(), 1 + 3);
        for (j, single) in found[1..].iter().enumerate() {
            let scale = found[0].gram[(j, j)];
            assert!((found[0].gram[(j, j)] - single.gram[(0, 0)]).abs() < 1e-9 * scale);
            assert!((found[0].moment[j] - single.moment[0]).abs() < 1e-9 * scale);
            assert!((found[0].cross.column(j) - single.cross.column(0)).amax() < 1e-9 * scale);
        }
        let white = point.marginal.whitening.whiten(&columns);
        assert!((&found[0].gram - white.tr_mul(&white)).amax() < 1e-9 * found[0].gram.amax());
    }
}
