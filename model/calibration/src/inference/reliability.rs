//! Uncertainty of the noise, and the resulting degrees of freedom of sizes.

use std::sync::Arc;

use nalgebra::{DMatrix, DVector};

use super::noise::Noise;
use super::observations::{CellMeans, Observations};
use super::projection::Projection;
use super::variance_components::{Block, blocks, directions, sizes};
use super::walk::Wandering;
use super::weighed::Weighed;

/// Uncertainty of the noise, for the degrees of freedom of a size (Satterthwaite's approximation).
pub(crate) struct Reliability {
    means: Arc<CellMeans>,
    noise: Noise,
    /// The model's own columns, whitened, as means.
    own: Projection,
    /// Inverse of the information on the nonzero variances, with their indices.
    covariance: DMatrix<f64>,
    places: Vec<usize>,
}

/// Factors of the 95 % intervals of the components' sizes, to either side; `None` for an absent
/// component.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct NoiseFactors {
    /// Offset of a series and direction.
    pub cell: Option<f64>,
    /// Offset of a series.
    pub common: Option<f64>,
    /// Friction scale of a series.
    pub scale: Option<f64>,
    /// Friction scale of a mount.
    pub mount: Option<f64>,
}

impl Reliability {
    /// Returns the uncertainties of the components.
    pub(crate) fn factors(&self) -> NoiseFactors {
        let theta = sizes(self.noise);
        // A standard deviation has half the relative error of the variance.
        let of = |place: usize| {
            let at = self.places.iter().position(|p| *p == place)?;
            let relative = self.covariance[(at, at)].max(0.0).sqrt() / theta[place];
            Some(libm::exp(1.96 * 0.5 * relative))
        };
        let last = self.places.len();
        let mount = self.noise.mount_scale;
        NoiseFactors {
            cell: of(1).or(of(0)),
            common: of(3).or(of(2)),
            scale: of(4),
            mount: (mount > 0.0).then(|| {
                libm::exp(1.96 * 0.5 * self.covariance[(last, last)].max(0.0).sqrt() / (mount * mount))
            }),
        }
    }

    /// Computes the uncertainty of a noise, with the model's own columns projected out.
    pub(crate) fn new(data: &Observations, noise: Noise, own: &[Vec<f64>]) -> Self {
        let means = Arc::new(data.cell_means(noise));
        let own = means.means_of(data, own);
        Self::of_means(means, data.mounts.len(), noise, &own)
    }

    /// Returns the degrees of freedom of the size of each column, with the other columns projected
    /// out, whose projected parts have these squared norms.
    pub(crate) fn degrees_of_each(
        data: &Observations,
        noise: Noise,
        columns: &[Vec<f64>],
        length2: &[f64],
    ) -> Vec<f64> {
        let means = Arc::new(data.cell_means(noise));
        let columns = means.means_of(data, columns);
        (0..columns.len())
            .zip(length2)
            .map(|(i, length2)| {
                let others: Vec<Vec<f64>> =
                    columns.iter().enumerate().filter(|(j, _)| *j != i).map(|(_, c)| c.clone()).collect();
                let beside = Self::of_means(Arc::clone(&means), data.mounts.len(), noise, &others);
                beside.degrees_of_mean(columns[i].clone(), *length2)
            })
            .collect()
    }

    /// The same for columns of cell means.
    fn of_means(means: Arc<CellMeans>, mounts: usize, noise: Noise, own: &[Vec<f64>]) -> Self {
        let local = Noise {
            mount_scale: 0.0,
            walk: Wandering::default(),
            group_offset_n: 0.0,
            specimen_scale: 0.0,
            ..noise
        };
        let zeros = vec![0.0; means.observations.points.len()];
        let blocks = blocks(&means.observations, local, &zeros, own);
        let theta = sizes(noise);
        let places: Vec<usize> = (0..5).filter(|i| theta[*i] > 0.0).collect();
        let mut information = DMatrix::zeros(places.len() + 1, places.len() + 1);
        for block in &blocks {
            let all = directions(&means.observations, block);
            for (a, i) in places.iter().enumerate() {
                for (b, j) in places.iter().enumerate() {
                    for g in &all[*i] {
                        for h in &all[*j] {
                            information[(a, b)] += 0.5 * (&block.p * g).dot(h).powi(2);
                        }
                    }
                }
            }
        }
        // The mount effect has as many degrees of freedom as mounts, less one for each friction
        // coefficient.
        let last = places.len();
        let mounts = (mounts as f64 - 2.0).max(1.0);
        information[(last, last)] =
            if noise.mount_scale > 0.0 { 0.5 * mounts / noise.mount_scale.powi(4) } else { 1e30 };
        let scale = DVector::from_fn(last + 1, |i, _| 1.0 / information[(i, i)].max(1e-300).sqrt());
        let scaled = DMatrix::from_fn(last + 1, last + 1, |i, j| information[(i, j)] * scale[i] * scale[j]);
        let inverse = scaled.try_inverse().unwrap_or_else(|| DMatrix::identity(last + 1, last + 1));
        let covariance = DMatrix::from_fn(last + 1, last + 1, |i, j| inverse[(i, j)] * scale[i] * scale[j]);
        let weighed = Weighed::new(&means.observations, noise);
        let own = Projection::of_whitened(own, zeros.len(), &weighed);
        Self { means, noise, own, covariance, places }
    }

    /// Returns the degrees of freedom of the size of a column in newtons, whose projected part has
    /// this squared norm.
    pub(crate) fn degrees(&self, data: &Observations, column_n: &[f64], length2: f64) -> f64 {
        self.degrees_of_mean(self.means.mean_of(data, column_n), length2)
    }

    /// The same for a column of means.
    fn degrees_of_mean(&self, mut white: Vec<f64>, length2: f64) -> f64 {
        let means = &self.means.observations;
        let weighed = Weighed::new(means, self.noise);
        weighed.whiten(&mut white);
        self.own.remove(&mut white);
        let px = weighed.whiten_transposed(white);
        let total = length2.max(1e-300);
        let mut w = DVector::zeros(self.places.len() + 1);
        for rows in &means.series_rows {
            let block = Block { members: rows.clone(), p: DMatrix::zeros(0, 0), pr: DVector::zeros(0) };
            let all = directions(means, &block);
            let local = DVector::from_fn(rows.len(), |i, _| px[rows[i]]);
            for (a, i) in self.places.iter().enumerate() {
                w[a] += all[*i].iter().map(|g| g.dot(&local).powi(2)).sum::<f64>() / total;
            }
        }
        let last = self.places.len();
        for rows in &means.mounts {
            w[last] += rows.iter().map(|r| means.friction_n[*r] * px[*r]).sum::<f64>().powi(2) / total;
        }
        let spread = (&self.covariance * &w).dot(&w);
        (2.0 / spread.max(1e-6)).clamp(2.0, 1e6)
    }
}
