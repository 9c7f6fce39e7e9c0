//! The noise hierarchy: repetition noise and an offset per series and direction; whitening by it.

use super::Observations;
use super::projection::Projection;

/// Standard deviations of the noise in newtons.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Noise {
    /// Of one repetition.
    pub repetition_n: f64,
    /// Of the offset that the rows of one series and direction share.
    pub series_n: f64,
}

impl Noise {
    /// Standard deviation of one reading about the model in newtons.
    pub fn floor_n(self) -> f64 {
        self.repetition_n.hypot(self.series_n)
    }

    /// Whitens one value per row in place, `V^-1/2 v`: rows of one cell have covariance
    /// `sigma^2 W^-1 + tau^2 1 1'`, whose inverse root is a weighted mean removed in part.
    pub(crate) fn whiten(self, data: &Observations, values: &mut [f64]) {
        let (s, t2) = (self.repetition_n, self.series_n.powi(2));
        for cell in &data.cells {
            let (mut weight, mut sum) = (0.0, 0.0);
            for &row in cell {
                weight += data.weights[row];
                sum += data.weights[row] * values[row];
            }
            let removed = 1.0 - s / (s * s + t2 * weight).sqrt();
            let shift = removed * sum / weight;
            for &row in cell {
                values[row] = data.weights[row].sqrt() * (values[row] - shift) / s;
            }
        }
    }

    /// Estimates both from residuals out of which everything explainable has been projected: pooled spread
    /// inside the cells, and what the cells' means have beyond it. `explainable` are columns in newtons;
    /// without their removal a missing effect would inflate its own noise (attribution.md 2).
    pub(crate) fn estimate(data: &Observations, residual_n: &[f64], explainable: &[Vec<f64>], start_n: f64) -> Self {
        let mut noise = Self { repetition_n: start_n.max(1e-6), series_n: 0.3 * start_n.max(1e-6) };
        for _ in 0..2 {
            let mut projection = Projection::new(residual_n.len());
            for column in explainable {
                let mut white = column.clone();
                noise.whiten(data, &mut white);
                projection.absorb(white);
            }
            let mut white = residual_n.to_vec();
            noise.whiten(data, &mut white);
            projection.remove(&mut white);
            noise = noise.updated(data, &white, projection.rank());
        }
        noise
    }

    /// One step of the estimate from whitened, projected residuals.
    fn updated(self, data: &Observations, white: &[f64], rank: usize) -> Self {
        let (mut inside, mut inside_n) = (0.0, 0.0);
        let mut means = Vec::with_capacity(data.cells.len());
        for cell in &data.cells {
            let n = cell.len() as f64;
            let weight: f64 = cell.iter().map(|r| data.weights[*r]).sum();
            // In the whitened scale the direction of sqrt(weight) carries the cell's offset.
            let along: f64 = cell.iter().map(|r| white[*r] * data.weights[*r].sqrt()).sum::<f64>() / weight.sqrt();
            let total: f64 = cell.iter().map(|r| white[*r].powi(2)).sum();
            inside += total - along * along;
            inside_n += n - 1.0;
            let spread2 = self.repetition_n.powi(2) / weight + self.series_n.powi(2);
            means.push((along * along * spread2, weight));
        }
        let cells = means.len() as f64;
        // Most of what is projected out lives between the cells: load, condition, time, speed.
        let lost_between = (0.8 * rank as f64).min(0.6 * cells);
        let lost_inside = 0.2 * rank as f64;
        let repetition2 = if inside_n > lost_inside + 5.0 {
            self.repetition_n.powi(2) * inside / (inside_n - lost_inside)
        } else {
            self.repetition_n.powi(2)
        };
        let correction = cells / (cells - lost_between).max(1.0);
        let mean_square = |values: &[(f64, f64)]| {
            values.iter().map(|(m2, w)| m2 * correction - repetition2 / w).sum::<f64>() / values.len().max(1) as f64
        };
        // A tenth of the cells may be wrong without deciding: cap each square at 6 times the median's scale.
        let mut squares: Vec<f64> = means.iter().map(|m| m.0).collect();
        let typical = super::observations::median(&mut squares) / 0.455;
        let capped: Vec<(f64, f64)> = means.iter().map(|(m2, w)| (m2.min(9.0 * typical), *w)).collect();
        let series2 = mean_square(&capped).max(0.0);
        let repetition_n = repetition2.sqrt().max(1e-6);
        Self { repetition_n, series_n: series2.sqrt().max(0.05 * repetition_n) }
    }
}
