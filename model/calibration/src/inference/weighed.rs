//! A table whitened by its noise: `V^-1/2`, row by row and group by group.
//!
//! `V` contains the repetition noise of each row, possibly autocorrelated, and the components that
//! rows share: the offset of a series and direction, the offset of a series, its friction scale,
//! the wrap of a mount, the zero of an operator. Each of those is one random effect per group times
//! a direction among the group's rows, so that `V` is whitened by one rank-one step after the
//! other; the cost is linear in rows.

use super::correlation::{chain_log_det, unchain};
use super::lanes::{LANES, Lanes};
use super::noise::{Noise, Part};
use super::observations::Observations;
use super::walk::Walk;

/// Component that the rows of each group of one kind share, in the scale of the previous whitening
/// steps.
#[derive(Clone, Debug)]
struct Shared {
    part: Part,
    /// Direction of each row's group, of unit norm in each group.
    axis: Vec<f64>,
    /// Share of that direction that whitening removes, by group.
    removed: Vec<f64>,
}

impl Shared {
    /// Builds the step of one component, if the noise has it; `whiten` applies the previous steps.
    fn new(part: Part, noise: Noise, data: &Observations, whiten: impl Fn(&mut [f64])) -> Option<Self> {
        let groups = part.groups(data);
        let mut axis: Vec<f64> =
            (0..data.points.len()).map(|row| part.direction_n(noise, data, row)).collect();
        if groups.is_empty() || axis.iter().all(|a| *a == 0.0) {
            return None;
        }
        whiten(&mut axis);
        let mut removed = vec![0.0; groups.len()];
        for (group, share) in groups.iter().zip(&mut removed) {
            let length2: f64 = group.iter().map(|r| axis[*r] * axis[*r]).sum();
            if length2 > 1e-24 {
                let length = length2.sqrt();
                group.iter().for_each(|r| axis[*r] /= length);
                *share = 1.0 - (1.0 + length2).sqrt().recip();
            }
        }
        Some(Self { part, axis, removed })
    }

    /// Applies the step, which is symmetric and thus its own adjoint.
    fn whiten<const N: usize>(&self, data: &Observations, values: &mut [[f64; N]]) {
        for (group, removed) in self.part.groups(data).iter().zip(&self.removed) {
            if *removed > 0.0 {
                let along = group.iter().map(|r| (*r, self.axis[*r]));
                remove_along(along, *removed, values);
            }
        }
    }
}

/// Removes a share of the component along a direction of unit norm, `v - removed a (a'v)`. The
/// direction is given as rows with their components.
fn remove_along<const N: usize>(
    axis: impl Iterator<Item = (usize, f64)> + Clone,
    removed: f64,
    values: &mut [[f64; N]],
) {
    let mut sums = [0.0; N];
    for (row, a) in axis.clone() {
        sums.iter_mut().zip(&values[row]).for_each(|(sum, v)| *sum += a * v);
    }
    let shifts = sums.map(|sum| removed * sum);
    for (row, a) in axis {
        values[row].iter_mut().zip(&shifts).for_each(|(v, shift)| *v -= a * shift);
    }
}

/// Component of one group of series with drifting offsets, which whitening has carried into the
/// following series.
#[derive(Clone, Debug)]
struct Carried {
    /// Rows with their components of a direction of unit norm.
    axis: Vec<(usize, f64)>,
    /// Share of that direction that whitening removes.
    removed: f64,
}

/// Share of a direction's largest component below which a component is dropped.
const FORGOTTEN: f64 = 1e-8;

impl Carried {
    /// Builds the step of rows that `whiten` has prepared, if there are any.
    fn new(
        part: Part,
        rows: &[usize],
        noise: Noise,
        data: &Observations,
        whiten: impl Fn(&mut [f64]),
    ) -> Option<Self> {
        let mut axis = vec![0.0; data.points.len()];
        rows.iter().for_each(|row| axis[*row] = part.direction_n(noise, data, *row));
        whiten(&mut axis);
        let largest = axis.iter().fold(0.0f64, |most, a| most.max(a.abs()));
        let length2: f64 = axis.iter().map(|a| a * a).sum();
        if length2 <= 1e-24 {
            return None;
        }
        let length = length2.sqrt();
        let axis = axis.into_iter().enumerate().filter(|(_, a)| a.abs() > FORGOTTEN * largest);
        Some(Self {
            axis: axis.map(|(row, a)| (row, a / length)).collect(),
            removed: 1.0 - (1.0 + length2).sqrt().recip(),
        })
    }

    /// Applies the step, which is symmetric and thus its own adjoint.
    fn whiten<const N: usize>(&self, values: &mut [[f64; N]]) {
        remove_along(self.axis.iter().copied(), self.removed, values);
    }
}

/// Observations with their noise.
#[derive(Clone, Debug)]
pub struct Weighed<'a> {
    /// The rows.
    pub data: &'a Observations,
    /// The noise.
    pub noise: Noise,
    /// Inverse of the repetition's standard deviation, times the root of the weight, by row.
    scale: Vec<f64>,
    cells: Option<Shared>,
    /// Drift of the offsets, whitened before components that mix cells.
    walk: Option<Walk>,
    shared: Vec<Shared>,
    carried: Vec<Carried>,
}

impl<'a> Weighed<'a> {
    /// Prepares the whitening of a table.
    pub fn new(data: &'a Observations, noise: Noise) -> Self {
        let scale = data
            .points
            .iter()
            .zip(&data.roots)
            .map(|(p, root)| root / noise.repetition.at(p.load_n).max(1e-12))
            .collect();
        let mut weighed =
            Self { data, noise, scale, cells: None, walk: None, shared: Vec::new(), carried: Vec::new() };
        weighed.cells = Shared::new(Part::Cell, noise, data, |v| weighed.whiten(v));
        if noise.walk.is_any() {
            weighed.walk = Some(Walk::new(&weighed));
        }
        for part in Part::WIDER {
            if weighed.walk.is_none() {
                let shared = Shared::new(part, noise, data, |v| weighed.whiten(v));
                weighed.shared.extend(shared);
                continue;
            }
            // White components of a series are part of the filter of a drift.
            if matches!(part, Part::SeriesOffset | Part::SeriesScale) {
                continue;
            }
            for rows in part.groups(data) {
                let carried = Carried::new(part, rows, noise, data, |v| weighed.whiten(v));
                weighed.carried.extend(carried);
            }
        }
        weighed
    }

    /// Whitens one value per row in place, `V^-1/2 v`.
    pub(crate) fn whiten(&self, values: &mut [f64]) {
        self.whiten_lanes(values.as_chunks_mut::<1>().0);
    }

    /// Whitens columns of one value per row in place, several in one pass.
    pub(crate) fn whiten_all(&self, columns: &mut [Vec<f64>]) {
        let mut lanes = Lanes::default();
        for several in columns.chunks_mut(LANES) {
            if let [one] = several {
                self.whiten(one);
                continue;
            }
            lanes.take(several);
            self.whiten_lanes(lanes.rows_mut());
            lanes.give(several);
        }
    }

    /// Whitens several values per row in place, lane by lane.
    pub(crate) fn whiten_lanes<const N: usize>(&self, values: &mut [[f64; N]]) {
        for (row, scale) in values.iter_mut().zip(&self.scale) {
            row.iter_mut().for_each(|v| *v *= scale);
        }
        if self.noise.correlation > 0.0 {
            for cell in &self.data.cells {
                unchain(self.noise.correlation, self.data, cell, values);
            }
        }
        self.cells.iter().for_each(|cells| cells.whiten(self.data, values));
        self.walk.iter().for_each(|walk| walk.whiten(self.data, values));
        self.shared.iter().for_each(|shared| shared.whiten(self.data, values));
        self.carried.iter().for_each(|carried| carried.whiten(values));
    }

    /// Applies `V^-1/2'` to values without autocorrelation, such as means of series.
    pub(crate) fn whiten_transposed(&self, mut values: Vec<f64>) -> Vec<f64> {
        let lanes = values.as_chunks_mut::<1>().0;
        self.carried.iter().rev().for_each(|carried| carried.whiten(lanes));
        self.shared.iter().rev().for_each(|shared| shared.whiten(self.data, lanes));
        self.walk.iter().for_each(|walk| walk.whiten_transposed(self.data, lanes.as_flattened_mut()));
        self.cells.iter().for_each(|cells| cells.whiten(self.data, lanes));
        values.iter_mut().zip(&self.scale).for_each(|(v, s)| *v *= s);
        values
    }

    /// Returns the contribution of the noise to minus twice the log likelihood, in addition to the
    /// deviance, up to a constant of the table: `ln det V`, and the squares of the readings about
    /// their mean for compacted rows. A row counts as its number of readings.
    pub(crate) fn log_det(&self) -> f64 {
        let own = |row: usize| {
            let variance = self.noise.repetition.at(self.data.points[row].load_n).max(1e-12).powi(2);
            self.data.weights[row] * (libm::log(variance) + self.data.within_n2[row] / variance)
        };
        let repetition: f64 = (0..self.data.points.len()).map(own).sum();
        let correlation = self.noise.correlation;
        let chain = if correlation > 0.0 { chain_log_det(correlation, self.data) } else { 0.0 };
        repetition + chain + self.shared_log_det()
    }

    /// Returns `ln det V` relative to the repetition noise alone.
    pub(crate) fn shared_log_det(&self) -> f64 {
        let shared: f64 = self
            .cells
            .iter()
            .chain(&self.shared)
            .flat_map(|s| &s.removed)
            .map(|removed| -2.0 * libm::log(1.0 - removed))
            .sum();
        let carried: f64 = self.carried.iter().map(|c| -2.0 * libm::log(1.0 - c.removed)).sum();
        shared + carried + self.walk.as_ref().map_or(0.0, Walk::log_det)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::inference::{Spread, Wandering};
    use crate::table::Frame;
    use crate::test_session::session;

    #[test]
    fn whitening_inverts_the_covariance() {
        whitens(Wandering::default(), 0.05, 1.0, 1e-9);
        whitens(Wandering::default(), 0.05, 0.2, 1e-9);
        let walk = Wandering { correlation: 0.8, white: 0.5, common: 1.5, direction: 0.7 };
        whitens(walk, 0.0, 0.2, 1e-9);
        whitens(walk, 0.05, 0.2, 1e-6);
    }

    /// Asserts `V^-1/2 V V^-1/2' = 1` within a bound, for a covariance with every component, where
    /// every ninth row has another weight.
    fn whitens(walk: Wandering, mount_scale: f64, weight: f64, bound: f64) {
        let rows: Vec<_> = session(1).into_iter().take(54).collect();
        let frame = Frame::new(&rows);
        let mut data = Observations::new(&frame, &rows).unwrap();
        let n = rows.len();
        data.weights = (0..n).map(|i| if i % 9 == 3 { weight } else { 1.0 }).collect();
        data.roots = data.weights.iter().map(|w| w.sqrt()).collect();
        // The filter uses one friction per cell: its rows have one load.
        let number = |r: usize| {
            if walk.is_any() { data.cells.iter().position(|c| c.contains(&r)).unwrap_or(0) } else { r }
        };
        data.friction_n = (0..n).map(|i| data.points[i].sign * (1.0 + 0.1 * number(i) as f64)).collect();
        let noise = Noise {
            correlation: 0.6,
            series_common: Spread { constant_n: 0.05, per_load: 0.0 },
            series_scale: 0.03,
            mount_scale,
            walk,
            ..Noise::constant(0.1, 0.3)
        };
        let white2 = noise.white().powi(2);
        let mut v = nalgebra::DMatrix::zeros(n, n);
        for i in 0..n {
            for j in 0..n {
                let same = |groups: &[Vec<usize>]| groups.iter().any(|g| g.contains(&i) && g.contains(&j));
                if same(&data.cells) {
                    let gap = data.points[i].repetition - data.points[j].repetition;
                    v[(i, j)] +=
                        0.01 * libm::pow(0.6f64, gap.abs()) / (data.roots[i] * data.roots[j]) + 0.09 * white2;
                }
                let apart = f64::from((data.series_of[i] as i32 - data.series_of[j] as i32).abs());
                if walk.is_any() {
                    let direction = if data.points[i].sign == data.points[j].sign { 0.09 } else { 0.0 };
                    v[(i, j)] += libm::pow(walk.correlation, apart)
                        * (walk.common.powi(2) * 0.0025 + walk.direction.powi(2) * direction);
                }
                let friction = data.friction_n[i] * data.friction_n[j];
                if same(&data.series_rows) {
                    v[(i, j)] += 0.0025 * white2 + 0.0009 * friction;
                }
                if same(&data.mounts) {
                    v[(i, j)] += mount_scale * mount_scale * friction;
                }
            }
        }
        let weighed = Weighed::new(&data, noise);
        let mut root = nalgebra::DMatrix::zeros(n, n);
        for j in 0..n {
            let mut unit = vec![0.0; n];
            unit[j] = 1.0;
            weighed.whiten(&mut unit);
            (0..n).for_each(|i| root[(i, j)] = unit[i]);
        }
        let one = &root * &v * root.transpose();
        let off = (one - nalgebra::DMatrix::identity(n, n)).amax();
        assert!(off < bound, "{off}");
        // Without autocorrelation the adjoint is that of the same map.
        let unchained = Weighed::new(&data, Noise { correlation: 0.0, ..noise });
        let (a, b): (Vec<f64>, Vec<f64>) = (0..n).map(|i| (libm::sin(i as f64), libm::cos(i as f64))).unzip();
        let mut white = a.clone();
        unchained.whiten(&mut white);
        let through: f64 = white.iter().zip(&b).map(|(x, y)| x * y).sum();
        let back: f64 = unchained.whiten_transposed(b).iter().zip(&a).map(|(x, y)| x * y).sum();
        assert!((through / back - 1.0).abs() < 1e-9, "{through} {back}");
        if data.weights.iter().all(|w| *w == 1.0) {
            let log_det: f64 = v.cholesky().unwrap().l().diagonal().iter().map(|d| 2.0 * libm::log(*d)).sum();
            assert!((weighed.log_det() - log_det).abs() < 1e-6, "{} {log_det}", weighed.log_det());
        }
        let repetition = Noise::constant(0.1, 0.0);
        let chained = Weighed::new(&data, Noise { correlation: 0.6, ..repetition });
        assert!(chained.shared_log_det() == 0.0);
        assert!(weighed.shared_log_det() > 0.0);
    }
}
