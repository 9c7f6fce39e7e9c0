//! The noise hierarchy: repetition noise, which may hang together from one to the next, and an offset per series and
//! direction; both may grow with load.

use serde::{Deserialize, Serialize};

use super::Observations;
use super::correlation::{self, unchain};
use super::projection::Projection;
use crate::median::median;

/// A variance that grows with the square of the load: `constant^2 + (per_load F)^2`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Spread {
    /// Standard deviation at zero load, in newtons.
    pub constant_n: f64,
    /// Growth with load, dimensionless.
    pub per_load: f64,
}

impl Spread {
    /// Standard deviation at a load, in newtons.
    pub fn at(self, load_n: f64) -> f64 {
        self.constant_n.hypot(self.per_load * load_n)
    }

    /// Fits both to squares that scatter about the variance, by least squares relative to it. A square counts
    /// for at most nine times what is expected, so that single bad series do not decide.
    /// `squares` are (load, square of which `known` is explained otherwise, known, weight).
    fn estimate(squares: &[(f64, f64, f64, f64)], least_n: f64) -> Self {
        let mut typical: Vec<f64> = squares.iter().map(|s| s.1).collect();
        let start = (median(&mut typical) / 0.455).max(least_n * least_n);
        let (mut c2, mut p2) = (start, 0.0);
        for _ in 0..12 {
            let (mut a11, mut a12, mut a22, mut b1, mut b2) = (0.0, 0.0, 0.0, 0.0, 0.0);
            for (load, square, known, weight) in squares {
                let f2 = load * load;
                let expected = (c2 + p2 * f2 + known).max(1e-12);
                let w = weight / (expected * expected);
                // The cap loses 2 % of a chi-square's mean; restored here.
                let value = 1.02 * square.min(9.0 * expected) - known;
                a11 += w;
                a12 += w * f2;
                a22 += w * f2 * f2;
                b1 += w * value;
                b2 += w * f2 * value;
            }
            let det = a11 * a22 - a12 * a12;
            let (mut c, mut p) = if det > 1e-9 * a11 * a22 {
                ((a22 * b1 - a12 * b2) / det, (a11 * b2 - a12 * b1) / det)
            } else {
                (b1 / a11.max(1e-300), 0.0)
            };
            if c < least_n * least_n {
                c = least_n * least_n;
                p = if a22 > 0.0 { (b2 - c * a12) / a22 } else { 0.0 };
            }
            if p < 0.0 {
                p = 0.0;
                c = (b1 / a11.max(1e-300)).max(least_n * least_n);
            }
            (c2, p2) = (0.5 * (c2 + c), 0.5 * (p2 + p));
        }
        Self { constant_n: c2.sqrt(), per_load: p2.sqrt() }
    }
}

/// The noise of a table.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Noise {
    /// Of one repetition.
    pub repetition: Spread,
    /// Of the offset that the rows of one series and direction share.
    pub series: Spread,
    /// Correlation of a repetition with the next one of its series and direction.
    #[serde(default)]
    pub correlation: f64,
}

impl Noise {
    /// The same noise at every load, in newtons.
    pub fn constant(repetition_n: f64, series_n: f64) -> Self {
        Self {
            repetition: Spread { constant_n: repetition_n, per_load: 0.0 },
            series: Spread { constant_n: series_n, per_load: 0.0 },
            correlation: 0.0,
        }
    }

    /// Standard deviation of one reading about the model in newtons.
    pub fn at(self, load_n: f64) -> f64 {
        self.repetition.at(load_n).hypot(self.series.at(load_n))
    }

    /// Root mean square of [`Noise::at`] over a table, in newtons.
    pub fn floor_n(self, data: &Observations) -> f64 {
        let sum: f64 = data.points.iter().map(|p| self.at(p.load_n).powi(2)).sum();
        (sum / data.points.len().max(1) as f64).sqrt()
    }

    /// Whitens one value per row in place, `V^-1/2 v`: rows of one cell have covariance `sigma^2 W^-1/2 R W^-1/2 +
    /// tau^2 1 1'` with `R` that of a chain. Once the chain is undone, what is left of `1` is one direction, and the
    /// inverse root takes a part of it out.
    pub(crate) fn whiten(self, data: &Observations, values: &mut [f64]) {
        let (mut white, mut axis) = (Vec::new(), Vec::new());
        for (cell, load) in data.cells.iter().zip(&data.cell_load_n) {
            let (s, t2) = (self.repetition.at(*load), self.series.at(*load).powi(2));
            self.offset_axis(data, cell, &mut axis);
            white.clear();
            white.extend(cell.iter().map(|r| data.roots[*r] * values[*r]));
            if self.correlation > 0.0 {
                unchain(self.correlation, data, cell, &mut white);
            }
            let (mut weight, mut sum) = (0.0, 0.0);
            for (a, v) in axis.iter().zip(&white) {
                weight += a * a;
                sum += a * v;
            }
            let removed = 1.0 - s / (s * s + t2 * weight).sqrt();
            let shift = removed * sum / weight;
            for ((row, a), v) in cell.iter().zip(axis.iter()).zip(&white) {
                values[*row] = (v - shift * a) / s;
            }
        }
    }

    /// Direction of a cell's offset among its rows at unit variance, and so in the whitened scale.
    fn offset_axis(self, data: &Observations, cell: &[usize], axis: &mut Vec<f64>) {
        axis.clear();
        axis.extend(cell.iter().map(|r| data.roots[*r]));
        if self.correlation > 0.0 {
            unchain(self.correlation, data, cell, axis);
        }
    }

    /// Estimates both from residuals out of which everything explainable has been projected: the spread
    /// inside the cells, and what the cells' means have beyond it. `explainable` are columns in newtons;
    /// without their removal a missing effect would inflate its own noise (`model/doc/naming-an-effect.md`).
    pub(crate) fn estimate(
        data: &Observations,
        residual_n: &[f64],
        explainable: &[Vec<f64>],
        start: Self,
    ) -> Self {
        let mut noise = Self { correlation: 0.0, ..start };
        let mut last = Vec::new();
        for _ in 0..3 {
            (noise, last) = noise.round(data, residual_n, explainable);
        }
        let correlation = correlation::estimate(data, &last);
        if correlation > 0.0 {
            noise.correlation = correlation;
            for _ in 0..2 {
                (noise, _) = noise.round(data, residual_n, explainable);
            }
        }
        noise
    }

    /// One round of the estimate, with the whitened residuals that it was made from.
    fn round(self, data: &Observations, residual_n: &[f64], explainable: &[Vec<f64>]) -> (Self, Vec<f64>) {
        let mut projection = Projection::new(residual_n.len());
        for column in explainable {
            let mut white = column.clone();
            self.whiten(data, &mut white);
            projection.absorb(white);
        }
        let mut white = residual_n.to_vec();
        self.whiten(data, &mut white);
        projection.remove(&mut white);
        (self.updated(data, &white, &projection), white)
    }

    /// One step of the estimate from whitened, projected residuals.
    fn updated(self, data: &Observations, white: &[f64], projection: &Projection) -> Self {
        let (mut inside, mut between) = (Vec::new(), Vec::new());
        let mut axis = Vec::new();
        for (cell, load) in data.cells.iter().zip(&data.cell_load_n) {
            if cell.first().is_some_and(|r| data.is_excluded(*r)) {
                continue;
            }
            self.offset_axis(data, cell, &mut axis);
            let weight: f64 = axis.iter().map(|a| a * a).sum();
            let root = weight.sqrt();
            // In the whitened scale one direction carries the cell's offset; what the projection took from it and
            // from the rest is given back.
            let part = |v: &[f64]| {
                let along = cell.iter().zip(&axis).map(|(r, a)| v[*r] * a).sum::<f64>() / root;
                (along * along, (cell.iter().map(|r| v[*r] * v[*r]).sum::<f64>() - along * along).max(0.0))
            };
            let (along2, rest2) = part(white);
            let (mut lost_along, mut lost_rest) = (0.0, 0.0);
            for axis in projection.basis() {
                let (a, r) = part(axis);
                lost_along += a;
                lost_rest += r;
            }
            let (s2, t2) = (self.repetition.at(*load).powi(2), self.series.at(*load).powi(2));
            let degrees = cell.len() as f64 - 1.0 - lost_rest;
            if degrees > 0.5 {
                inside.push((*load, s2 * rest2 / degrees, 0.0, degrees));
            }
            let kept = 1.0 - lost_along;
            if kept > 0.1 {
                between.push((*load, (s2 / weight + t2) * along2 / kept, weight, kept));
            }
        }
        let repetition = if inside.len() > 3 { Spread::estimate(&inside, 1e-6) } else { self.repetition };
        let between: Vec<_> = between
            .into_iter()
            .map(|(load, square, weight, kept)| (load, square, repetition.at(load).powi(2) / weight, kept))
            .collect();
        let least_n = 0.05 * repetition.constant_n;
        let series = if between.len() > 3 { Spread::estimate(&between, least_n) } else { self.series };
        Self { repetition, series, ..self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::table::Frame;
    use crate::test_session::session;

    /// `V^-1/2 V V^-1/2' = 1` for the covariance that the documentation of `whiten` names.
    #[test]
    fn whitening_undoes_the_covariance() {
        let rows: Vec<_> = session(1).into_iter().take(9).collect();
        let frame = Frame::new(&rows);
        let mut data = Observations::new(&frame, &rows).unwrap();
        let n = rows.len();
        data.weights = (0..n).map(|i| if i == 3 { 0.2 } else { 1.0 }).collect();
        data.roots = data.weights.iter().map(|w| w.sqrt()).collect();
        let noise = Noise { correlation: 0.6, ..Noise::constant(0.1, 0.3) };
        let cell = data.cells[0].clone();
        assert_eq!(cell.len(), n, "one series, one direction");
        let covariance = nalgebra::DMatrix::from_fn(n, n, |i, j| {
            let chain = 0.6f64.powi(i.abs_diff(j) as i32) / (data.roots[i] * data.roots[j]);
            0.01 * chain + 0.09
        });
        let mut root = nalgebra::DMatrix::zeros(n, n);
        for j in 0..n {
            let mut unit = vec![0.0; n];
            unit[j] = 1.0;
            noise.whiten(&data, &mut unit);
            (0..n).for_each(|i| root[(i, j)] = unit[i]);
        }
        let one = &root * covariance * root.transpose();
        assert!((one - nalgebra::DMatrix::identity(n, n)).amax() < 1e-9);
    }

    #[test]
    fn a_spread_is_found_in_squares_that_follow_it() {
        let truth = Spread { constant_n: 0.05, per_load: 0.004 };
        // Two squares per load at half and one and a half times the variance.
        let squares: Vec<_> = (1..60)
            .flat_map(|i| {
                let load = f64::from(i);
                let variance = truth.at(load).powi(2);
                [(load, 0.5 * variance, 0.0, 1.0), (load, 1.5 * variance, 0.0, 1.0)]
            })
            .collect();
        let found = Spread::estimate(&squares, 1e-6);
        assert!((found.constant_n / truth.constant_n - 1.0).abs() < 0.05, "{found:?}");
        assert!((found.per_load / truth.per_load - 1.0).abs() < 0.05, "{found:?}");
    }
}
