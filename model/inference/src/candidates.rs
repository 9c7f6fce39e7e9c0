//! Products of the columns of the elements that could be added to a fit with the precision of the noise.
//!
//! The columns of a kernel are its basis times the sensitivity `c` to its channel. Most bases are constant within each series, or
//! within each direction of it: a cell. With the row `phi` of the basis for each cell their products follow from those of the
//! part of `c` in the cell, for any columns `Z`: `X'V^-1 Z = sum phi (c'V^-1 Z)`. Two cells of one series are correlated.

use std::collections::BTreeMap;
use std::ops::Range;

use nalgebra::{DMatrix, DVector};

use crate::cells::{BasisByCell, Cells};
use crate::hypothesis::Element;
use crate::marginal::Marginal;
use crate::series_rows::SPARSE;

/// Largest entry of columns that change no reading.
const LEAST_ENTRY: f64 = 1e-9;
/// Columns that are whitened together, so that each series' factor is read once for all of them.
const BLOCK_COLUMNS: usize = 64;
/// Most columns of a kernel that count, if they vary within cells. Those of a process are in the order of their variance.
const MOST_SCORED: usize = 48;
/// Columns up to which a sum over cells is faster than a product of matrices that are copied for it.
const FEW_COLUMNS: usize = 2;

/// Products of the columns `x` of an element.
pub(crate) struct Candidate {
    pub(crate) element: Element,
    /// `x'V^-1 x`, before the coefficients of the fit are integrated.
    pub(crate) gram: DMatrix<f64>,
    /// `x'V^-1 r`.
    pub(crate) moment: DVector<f64>,
    /// Largest change of a reading per size, relative to the smallest relevant one.
    pub(crate) relevance: f64,
    /// Its columns among those of all candidates.
    pub(crate) columns: Range<usize>,
}

/// Two candidates of one column each, which have one basis through different channels.
pub(crate) struct Pair {
    /// Their places among all candidates.
    pub(crate) places: [usize; 2],
    /// `x'V^-1 y` of their columns.
    pub(crate) between: f64,
}

/// Collects candidates of a fit.
pub(crate) struct Candidates<'a> {
    marginal: &'a Marginal,
    channels: &'a [Vec<f64>],
    is_second: &'a [bool],
    /// Channels of the pairs.
    joint_channels: &'a [[usize; 2]],
    of_cells: BTreeMap<usize, CellProducts>,
    between_channels: BTreeMap<[usize; 2], DMatrix<f64>>,
    pairs: Vec<Pair>,
    /// Element, relevance and number of columns of each candidate of the block.
    waiting: Vec<(Element, f64, usize)>,
    /// Their columns, one after the other.
    columns: Vec<f64>,
    done: Vec<Candidate>,
    /// `A'V^-1 x` of these, one column after the other.
    cross: Vec<f64>,
}

impl<'a> Candidates<'a> {
    /// `is_second` has the direction of each row, `joint_channels` are those of the pairs.
    pub(crate) fn new(
        marginal: &'a Marginal,
        channels: &'a [Vec<f64>],
        is_second: &'a [bool],
        joint_channels: &'a [[usize; 2]],
    ) -> Self {
        Self {
            marginal,
            channels,
            is_second,
            joint_channels,
            of_cells: BTreeMap::new(),
            between_channels: BTreeMap::new(),
            pairs: Vec::new(),
            waiting: Vec::new(),
            columns: Vec::new(),
            done: Vec::new(),
            cross: Vec::new(),
        }
    }

    /// Adds an effect by the change of the readings per size.
    pub(crate) fn add_effect(&mut self, element: Element, relevance: f64, column: &DVector<f64>) {
        self.columns.extend_from_slice(column.as_slice());
        self.waits(element, relevance, 1);
    }

    /// Adds kernels of one basis, each with its channel, unless they change no reading.
    pub(crate) fn add_kernels(
        &mut self,
        kernels: impl Iterator<Item = (Element, usize)>,
        basis: &BasisByCell,
    ) {
        let mut of_one_column: Vec<(usize, usize)> = Vec::new();
        for (element, channel) in kernels {
            let sensitivity = &self.channels[channel];
            let Some(cells) = &basis.cells else {
                let columns = basis.basis.first(MOST_SCORED).times(sensitivity);
                if columns.amax() > LEAST_ENTRY {
                    self.columns.extend_from_slice(columns.as_slice());
                    self.waits(element, 0.0, columns.ncols());
                }
                continue;
            };
            let (marginal, is_second) = (self.marginal, self.is_second);
            let products = self
                .of_cells
                .entry(channel)
                .or_insert_with(|| CellProducts::new(marginal, sensitivity, is_second));
            if let Some((candidate, cross)) = products.candidate(element, cells) {
                if cross.ncols() == 1 {
                    of_one_column.push((channel, self.done.len()));
                }
                self.is_done(candidate, &cross);
            }
        }
        if let Some(cells) = &basis.cells {
            self.add_pairs(&of_one_column, cells);
        }
    }

    /// Adds the pairs among candidates of one basis by channel and place.
    fn add_pairs(&mut self, of_one_column: &[(usize, usize)], cells: &Cells) {
        let place =
            |of: usize| of_one_column.iter().find(|(channel, _)| *channel == of).map(|(_, place)| *place);
        for channels in self.joint_channels {
            let ([Some(first), Some(second)], [Some(a), Some(b)]) =
                (channels.map(place), channels.map(|channel| self.of_cells.get(&channel)))
            else {
                continue;
            };
            let ranges = &self.marginal.whitening.ranges;
            let between =
                self.between_channels.entry(*channels).or_insert_with(|| a.products_with(b, ranges));
            let between = cells.quadratic_form(between);
            self.pairs.push(Pair { places: [first, second], between });
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
        for (element, relevance, count) in std::mem::take(&mut self.waiting) {
            let own = white.columns(first, count);
            let (gram, moment) = (own.tr_mul(&own), moment.rows(first, count).into_owned());
            let candidate = Candidate { element, gram, moment, relevance, columns: 0..0 };
            self.is_done(candidate, &cross.columns(first, count).into_owned());
            first += count;
        }
    }

    fn is_done(&mut self, mut candidate: Candidate, cross: &DMatrix<f64>) {
        let first = self.done.last().map_or(0, |last| last.columns.end);
        candidate.columns = first..first + cross.ncols();
        self.cross.extend_from_slice(cross.as_slice());
        self.done.push(candidate);
    }

    /// Returns the candidates, their pairs, and `A'V^-1 x` of all their columns.
    pub(crate) fn finish(mut self) -> (Vec<Candidate>, Vec<Pair>, DMatrix<f64>) {
        self.whiten();
        let count = self.done.last().map_or(0, |last| last.columns.end);
        (self.done, self.pairs, DMatrix::from_vec(self.marginal.gram.nrows(), count, self.cross))
    }
}

/// Products of the part `c` of the sensitivity to a channel in each cell: those of the first direction of every series, then
/// those of the second.
struct CellProducts {
    /// `c` of each direction, whitened.
    white: [DVector<f64>; 2],
    /// `c'V^-1 c`.
    gram: DVector<f64>,
    /// `c'V^-1 c` of both cells of each series.
    between: DVector<f64>,
    /// `A'V^-1 c`, one column per cell.
    cross: DMatrix<f64>,
    /// Rows of it that may not be zero for the cells of each series, if they are few.
    entries: Option<Vec<Vec<usize>>>,
    /// `c'V^-1 r`.
    moment: DVector<f64>,
    /// Largest entry of `c`.
    largest: DVector<f64>,
}

impl CellProducts {
    fn new(marginal: &Marginal, sensitivity: &[f64], is_second: &[bool]) -> Self {
        let ranges = &marginal.whitening.ranges;
        let count = ranges.len();
        let part = |direction: bool| {
            let of_row = |row: usize, _| if is_second[row] == direction { sensitivity[row] } else { 0.0 };
            DVector::from_fn(sensitivity.len(), of_row)
        };
        let parts = [part(false), part(true)];
        let white = parts.each_ref().map(|part| marginal.whitening.whiten_vector(part));
        let mut cross = DMatrix::zeros(marginal.gram.nrows(), 2 * count);
        for (i, white) in white.iter().enumerate() {
            let of_direction = marginal.white_design.transposed_times_series(white);
            cross.columns_mut(i * count, count).copy_from(&of_direction);
        }
        let of_cells = DVector::zeros(2 * count);
        let (mut gram, mut moment, mut largest) = (of_cells.clone(), of_cells.clone(), of_cells);
        let mut between = DVector::zeros(count);
        for (series, range) in ranges.iter().enumerate() {
            let own = white.each_ref().map(|white| white.rows(range.start, range.len()));
            let target = marginal.white_target.rows(range.start, range.len());
            between[series] = own[0].dot(&own[1]);
            for (i, own) in own.iter().enumerate() {
                let cell = i * count + series;
                gram[cell] = own.norm_squared();
                moment[cell] = own.dot(&target);
                largest[cell] = parts[i].rows(range.start, range.len()).amax();
            }
        }
        let entries = (0..count).map(|series| marginal.white_design.columns_in(series));
        let entries = entries.collect::<Vec<_>>();
        let most = entries.iter().map(Vec::len).max().unwrap_or(0);
        let entries = (SPARSE * most < cross.nrows()).then_some(entries);
        Self { white, gram, between, cross, entries, moment, largest }
    }

    /// Returns `c'V^-1 d` with the parts `d` of another channel. Each series has one row; both directions of `c` follow each other,
    /// each with both of `d`.
    fn products_with(&self, other: &Self, ranges: &[Range<usize>]) -> DMatrix<f64> {
        DMatrix::from_fn(ranges.len(), 4, |series, column| {
            let Range { start, end } = ranges[series];
            let part = |white: &DVector<f64>| white.rows(start, end - start).into_owned();
            part(&self.white[column / 2]).dot(&part(&other.white[column % 2]))
        })
    }

    /// Returns the candidate of a basis with one row per cell, and its `A'V^-1 x`; `None` if it changes no reading.
    fn candidate(&self, element: Element, cells: &Cells) -> Option<(Candidate, DMatrix<f64>)> {
        let Cells { rows, largest } = cells;
        let (cells, count) = (rows.nrows(), self.between.len());
        let changes = |cell: usize| self.largest[cell] * largest[cell];
        // Most cells of a basis with many columns are in few of them, and a gross error is in one series.
        let own: Vec<usize> = (0..cells).filter(|cell| changes(*cell) > 0.0).collect();
        own.iter().any(|cell| changes(*cell) > LEAST_ENTRY).then(|| {
            let precise = DMatrix::from_fn(own.len(), rows.ncols(), |i, j| {
                let (cell, other) = (own[i], (own[i] + count) % cells);
                self.gram[cell] * rows[(cell, j)] + self.between[cell % count] * rows[(other, j)]
            });
            let cross = self.cross_of(&own, rows);
            let rows = rows.select_rows(&own);
            let (gram, moment) = (rows.tr_mul(&precise), rows.tr_mul(&self.moment.select_rows(&own)));
            (Candidate { element, gram, moment, relevance: 0.0, columns: 0..0 }, cross)
        })
    }

    /// Returns `A'V^-1 x` of a basis that is not zero in its `own` cells only.
    fn cross_of(&self, own: &[usize], rows: &DMatrix<f64>) -> DMatrix<f64> {
        if rows.ncols() > FEW_COLUMNS {
            return self.cross.select_columns(own) * rows.select_rows(own);
        }
        let mut cross = DMatrix::zeros(self.cross.nrows(), rows.ncols());
        for (j, mut column) in cross.column_iter_mut().enumerate() {
            for cell in own {
                let (value, of_cell) = (rows[(*cell, j)], self.cross.column(*cell));
                match &self.entries {
                    Some(entries) => entries[cell % self.between.len()]
                        .iter()
                        .for_each(|entry| column[*entry] += value * of_cell[*entry]),
                    None => column.axpy(value, &of_cell, 1.0),
                }
            }
        }
        cross
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::basis::Basis;
    use crate::hypothesis::Member;
    use crate::random::Random;
    use crate::test_problem::{fitted, full_hypothesis, long_problem};

    /// A basis that is constant within each direction of a series has the products of its columns.
    #[test]
    fn products_by_cell_are_those_of_the_columns() {
        let problem = long_problem(7, 9, 0.4);
        let (_, design, point) = fitted(&problem, &full_hypothesis());
        let mut random = Random::new(3);
        let values = DMatrix::from_fn(14, 3, |_, _| random.normal());
        let cell = |row: usize| 2 * problem.rows.series[row] + usize::from(problem.rows.direction[row]);
        let rows = DMatrix::from_fn(problem.len(), 3, |row, j| values[(cell(row), j)]);
        let basis = Basis::from(rows);
        let element = Element { member: Member::Kernel(0), form: 0 };
        let mut candidates = Candidates::new(&point.marginal, &design.channels, &problem.rows.direction, &[]);
        let kernels = || std::iter::once((element, 1));
        let by_cell = |basis| BasisByCell::new(basis, &problem.ranges, &problem.rows.direction);
        candidates.add_kernels(kernels(), &by_cell(&basis));
        let columns = basis.times(&design.channels[1]);
        for column in columns.column_iter() {
            candidates.add_effect(element, 0.0, &column.into_owned());
        }
        let zero = Basis::from(DMatrix::zeros(problem.len(), 2));
        candidates.add_kernels(kernels(), &by_cell(&zero));
        let (found, _, cross) = candidates.finish();
        assert_eq!(found.len(), 1 + 3);
        for (j, single) in found[1..].iter().enumerate() {
            let scale = found[0].gram[(j, j)];
            assert!((found[0].gram[(j, j)] - single.gram[(0, 0)]).abs() < 1e-9 * scale);
            assert!((found[0].moment[j] - single.moment[0]).abs() < 1e-9 * scale);
            assert!((cross.column(j) - cross.column(single.columns.start)).amax() < 1e-9 * scale);
        }
        let white = point.marginal.whitening.whiten(&columns);
        assert!((&found[0].gram - white.tr_mul(&white)).amax() < 1e-9 * found[0].gram.amax());
    }

    /// A pair of channels has the product of their columns.
    #[test]
    fn pairs_have_the_product_of_their_columns() {
        let problem = long_problem(7, 9, 0.4);
        let (_, design, point) = fitted(&problem, &full_hypothesis());
        let mut random = Random::new(4);
        let values = DMatrix::from_fn(14, 1, |_, _| random.normal());
        let cell = |row: usize| 2 * problem.rows.series[row] + usize::from(problem.rows.direction[row]);
        let basis = Basis::from(DMatrix::from_fn(problem.len(), 1, |row, _| values[cell(row)]));
        let by_cell = BasisByCell::new(&basis, &problem.ranges, &problem.rows.direction);
        let direction = &problem.rows.direction;
        let mut candidates = Candidates::new(&point.marginal, &design.channels, direction, &[[1, 0]]);
        let element = |kernel| Element { member: Member::Kernel(kernel), form: 0 };
        candidates.add_kernels([(element(0), 0), (element(1), 1)].into_iter(), &by_cell);
        let (_, pairs, _) = candidates.finish();
        let [pair] = pairs.as_slice() else { panic!("{}", pairs.len()) };
        assert_eq!(pair.places, [1, 0]);
        let white =
            [0, 1].map(|channel| point.marginal.whitening.whiten(&basis.times(&design.channels[channel])));
        let expected = white[0].column(0).dot(&white[1].column(0));
        assert!((pair.between / expected - 1.0).abs() < 1e-9, "{} {expected}", pair.between);
    }
}
