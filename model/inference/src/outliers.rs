//! Gross errors: whole series, and single readings.
//!
//! A series may have an offset of its own in each direction that the noise does not explain. Its
//! probability follows from prior odds and the evidence of the offset, as for any other part of a
//! hypothesis. Single readings are tested one by one with Bonferroni's correction, against Student's t
//! distribution of the noise.

use std::collections::BTreeSet;

use nalgebra::{DMatrix, DVector};

use crate::covariance::Noise;
use crate::design::Component;
use crate::fit::Fit;
use crate::half_t::HalfT;
use crate::hypothesis::Member;
use crate::leave_out::{Leverage, Linearised};
use crate::noise::EXCLUDED;
use crate::problem::Problem;
use crate::quadrature::{log_sum_exp, student_tail};
use crate::variance_gain::VarianceGain;
use crate::white_design::WhiteDesign;
use crate::whitening::Whitening;

/// Prior probability that a series has a gross error, in one direction or both.
pub const SERIES_PROBABILITY: f64 = 0.01;
/// Scale of the half-Cauchy prior of the offset of such a series, in repetition noise.
const SERIES_SCALE: f64 = 10.0;
/// Posterior probability above which a series is listed, and excluded from the fits: a gross error inflates
/// the scatter between series, which hides it.
const LISTED_PROBABILITY: f64 = 0.5;
/// Forms of such an error, as one row of columns for each direction: one direction, the other, both alike, and each by an
/// amount of its own.
const FORMS: [[&[f64]; 2]; 4] =
    [[&[1.0], &[0.0]], [&[0.0], &[1.0]], [&[1.0], &[1.0]], [&[1.0, 0.0], &[0.0, 1.0]]];
/// Probability that any reading of a table without gross errors is listed.
const FAMILY_PROBABILITY: f64 = 0.05;

/// A series with a gross error in one direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OutlyingSeries {
    /// Number of the series.
    pub series: usize,
    /// Whether it is in the second direction.
    pub direction: bool,
    /// Probability of the error.
    pub probability: f64,
    /// Mean of reading minus prediction from the other series.
    pub offset: f64,
    /// Standard deviation of that mean without a gross error.
    pub sd: f64,
}

/// A reading with a gross error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OutlyingReading {
    /// Row of the reading.
    pub row: usize,
    /// Reading minus its expectation from all readings.
    pub offset: f64,
    /// Scale of the noise of a reading.
    pub sd: f64,
}

/// Gross errors of a table under a hypothesis.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Outliers {
    /// Series, in order.
    pub series: Vec<OutlyingSeries>,
    /// Readings, in order.
    pub readings: Vec<OutlyingReading>,
    /// Root mean square of the other readings about their expectation from all readings, in scales of
    /// the noise of a reading.
    pub scatter: f64,
    /// Every reading minus its expectation from all readings, in scales of the noise of a reading; not a
    /// number for rows that the fit excludes.
    pub standardised: Vec<f64>,
    rows: Vec<bool>,
}

impl Outliers {
    /// Finds the gross errors of a table under a fit.
    pub fn new(problem: &Problem, fit: &Fit) -> Self {
        Self::found(problem, fit).unwrap_or_default()
    }

    /// Returns the rows of series with a suspected gross error under a fit, which a more robust fit
    /// excludes.
    pub(crate) fn suspected(problem: &Problem, fit: &Fit) -> Vec<bool> {
        let found = Self::found(problem, fit).unwrap_or_default();
        let is_in = |row: usize| {
            let series = problem.rows.series[row];
            found.series.iter().any(|s| s.series == series)
        };
        (0..problem.len()).map(is_in).collect()
    }

    fn found(problem: &Problem, fit: &Fit) -> Option<Self> {
        let mut outliers = Self {
            rows: vec![false; problem.len()],
            standardised: vec![f64::NAN; problem.len()],
            ..Self::default()
        };
        let linearised = Linearised::new(problem, fit)?;
        outliers.find_readings(problem, fit, &linearised);
        outliers.find_series(problem, fit, &linearised)?;
        Some(outliers)
    }

    /// Adds the series whose gross error is a probable member of the best hypothesis.
    pub(crate) fn add_gross_errors(
        &mut self,
        problem: &Problem,
        best: &Fit,
        probability_of: impl Fn(Member) -> f64,
    ) {
        let kernels = best.hypothesis.kernels().filter(|(k, _)| problem.space.kernels[*k].is_gross_error);
        let probable: Vec<(usize, usize, f64)> = kernels
            .map(|(kernel, variant)| (kernel, variant, probability_of(Member::Kernel(kernel))))
            .filter(|(.., probability)| *probability > LISTED_PROBABILITY)
            .collect();
        if probable.is_empty() {
            return;
        }
        let Some(Linearised { design, point }) = Linearised::new(problem, best) else { return };
        for (kernel, variant, probability) in probable {
            let basis = &problem.rows.bases[kernel][variant];
            let rows: Vec<usize> = basis.support().collect();
            let columns = design.columns_of(Component::Kernel(kernel));
            let covariance = point.solution.covariance.select_rows(&columns).select_columns(&columns);
            let mean = point.solution.mean.select_rows(&columns);
            let mut found: BTreeSet<(usize, bool)> = BTreeSet::new();
            for row in &rows {
                let (series, direction) = (problem.rows.series[*row], problem.rows.direction[*row]);
                if found.insert((series, direction)) {
                    let values = DVector::from_column_slice(basis.at(*row));
                    let (offset, sd) = (values.dot(&mean), values.dot(&(&covariance * &values)).sqrt());
                    self.series.push(OutlyingSeries { series, direction, probability, offset, sd });
                }
            }
            rows.into_iter().for_each(|row| self.rows[row] = true);
        }
        self.series.sort_by_key(|of| (of.series, of.direction));
        self.series.dedup_by_key(|of| (of.series, of.direction));
    }

    /// Returns whether a row has a gross error, or belongs to a series that has one.
    pub fn contains(&self, row: usize) -> bool {
        self.rows.get(row).copied().unwrap_or(false)
    }

    fn find_readings(&mut self, problem: &Problem, fit: &Fit, linearised: &Linearised) {
        let point = &linearised.point;
        let noise = noise_of(problem, linearised, &fit.mode.weights);
        let white = point.marginal.white_residual(&point.solution.mean);
        let precise = point.marginal.whitening.whiten_transposed(&white);
        let quantum = noise.quantum_variance();
        let (mut squares, mut count) = (0.0, 0.0);
        for row in (0..problem.len()).filter(|row| fit.mode.weights[*row] != EXCLUDED) {
            let offset = (noise.own_variance(row) + quantum) * precise[row];
            let sd = (noise.independent_variance(row) + quantum).max(1e-24).sqrt();
            self.standardised[row] = offset / sd;
            if student_tail(offset / sd) * (problem.len() as f64) < FAMILY_PROBABILITY {
                self.readings.push(OutlyingReading { row, offset, sd });
                self.rows[row] = true;
            } else {
                squares += (offset / sd).powi(2);
                count += 1.0;
            }
        }
        self.scatter = (squares / f64::max(count, 1.0)).sqrt();
    }

    fn find_series(&mut self, problem: &Problem, fit: &Fit, linearised: &Linearised) -> Option<()> {
        let solution = &linearised.point.solution;
        // An excluded series is compared with its expectation from the others at the usual noise.
        let weights = fit.mode.weights.map(|weight| if weight == EXCLUDED { 1.0 } else { weight });
        let noise = noise_of(problem, linearised, &weights);
        let prior = libm::log(SERIES_PROBABILITY / (1.0 - SERIES_PROBABILITY));
        let whitening = Whitening::new(&noise, &problem.ranges)?;
        let design = &linearised.design;
        let white_design = WhiteDesign::new(&design.matrix, &design.of_series, &whitening);
        let parts = white_design.times(&solution.root.transpose());
        let difference = &linearised.design.target - &linearised.design.matrix * &solution.mean;
        let residual = whitening.whiten_vector(&difference);
        for (series, range) in whitening.ranges.iter().enumerate() {
            let (first, length) = (range.start, range.len());
            let part = parts.rows(first, length).into_owned();
            let leverage = Leverage::new(&part);
            let own = residual.rows(first, length).into_owned();
            // Precision of the residual given the other series, and its product with the residual.
            let is_excluded = fit.mode.weights[first] == EXCLUDED;
            let precision = |share: f64| if is_excluded { 1.0 / (1.0 + share) } else { 1.0 - share };
            let own = if is_excluded { leverage.apply(precision, &own) } else { own };
            let scored: Vec<_> = FORMS
                .into_iter()
                .filter_map(|form| {
                    let value = |row: usize, column: usize| {
                        form[usize::from(problem.rows.direction[first + row])][column]
                    };
                    let mut columns = DMatrix::from_fn(length, form[0].len(), value);
                    // One wrong reading is not a wrong series.
                    if columns.row_sum().iter().any(|count| *count < 1.5) {
                        return None;
                    }
                    columns
                        .column_iter_mut()
                        .for_each(|mut column| whitening.roots[series].whiten(column.as_mut_slice()));
                    let score = columns.tr_mul(&own);
                    let precise: Vec<DVector<f64>> = columns
                        .column_iter()
                        .map(|column| leverage.apply(precision, &column.into_owned()))
                        .collect();
                    let information = columns.tr_mul(&DMatrix::from_columns(&precise));
                    let covariance = information.clone().try_inverse()?;
                    let scale = SERIES_SCALE * problem.reference.repetition_sd;
                    let gain = VarianceGain::new(information, &score).integral(HalfT::cauchy(scale));
                    Some((gain, form, &covariance * score, covariance))
                })
                .collect();
            let total = log_sum_exp(&scored.iter().map(|(gain, ..)| *gain).collect::<Vec<f64>>());
            // The prior odds are spread over the forms.
            let odds = total - libm::log(scored.len().max(1) as f64) + prior;
            let probability = 1.0 / (1.0 + libm::exp(-odds));
            let best = scored.into_iter().max_by(|a, b| a.0.total_cmp(&b.0));
            let Some((_, form, sizes, covariance)) = best.filter(|_| probability > LISTED_PROBABILITY) else {
                continue;
            };
            for direction in [false, true] {
                let rows: Vec<usize> =
                    range.clone().filter(|row| problem.rows.direction[*row] == direction).collect();
                let values = DVector::from_column_slice(form[usize::from(direction)]);
                if rows.is_empty() || values.amax() == 0.0 {
                    continue;
                }
                let (offset, sd) = (values.dot(&sizes), values.dot(&(&covariance * &values)).sqrt());
                self.series.push(OutlyingSeries { series, direction, probability, offset, sd });
                rows.into_iter().for_each(|row| self.rows[row] = true);
            }
        }
        Some(())
    }
}

fn noise_of<'a>(problem: &'a Problem, linearised: &'a Linearised, weights: &'a DVector<f64>) -> Noise<'a> {
    Noise::new(
        &problem.rows,
        &problem.reference,
        &linearised.point.scales,
        weights,
        &linearised.design.channels[problem.space.series_scale_channel],
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_problem::{ROWS_PER_SERIES, problem, problem_with};
    use crate::{SearchOptions, infer};

    fn outliers(problem: &Problem) -> Outliers {
        infer(problem, SearchOptions::default(), 1).unwrap().outliers
    }

    #[test]
    fn clean_tables_have_no_outliers() {
        for count in [9, 12, 24] {
            let found = outliers(&problem(count, 0.3));
            assert!(found.series.is_empty() && found.readings.is_empty(), "{found:?}");
        }
    }

    #[test]
    fn a_wrong_series_is_listed_with_its_offset() {
        let wrong = problem_with(24, 0.3, |row| if row / ROWS_PER_SERIES == 7 { 3.0 } else { 0.0 });
        let found = outliers(&wrong);
        assert!(found.series.iter().all(|s| s.series == 7 && (s.offset - 3.0).abs() < 0.3), "{found:?}");
        assert!(!found.series.is_empty() && found.contains(7 * ROWS_PER_SERIES));
    }

    #[test]
    fn a_wrong_reading_is_listed() {
        let wrong = problem_with(24, 0.3, |row| if row == 31 { -4.0 } else { 0.0 });
        let found = outliers(&wrong);
        assert_eq!(found.readings.iter().map(|r| r.row).collect::<Vec<_>>(), [31]);
        assert!((found.readings[0].offset + 4.0).abs() < 0.3 && found.series.is_empty(), "{found:?}");
    }
}
