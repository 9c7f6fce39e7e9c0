//! Offsets that wander from series to series: a chain of first order over the cells of each direction, whitened by a
//! Kalman filter, whose cost is linear in the cells.

use super::observations::Observations;
use super::weighed::Weighed;

/// Correlation of the wandering offset from one series to the next.
const CORRELATION: f64 = 0.75;

/// One step of the filter.
#[derive(Clone, Copy, Debug)]
struct Step {
    cell: usize,
    /// Standard deviation of the offset in the whitened scale of its cell.
    offset: f64,
    gain: f64,
    /// Variance of the innovation.
    variance: f64,
}

/// The filter of a table.
#[derive(Clone, Debug)]
pub(super) struct Walk {
    chains: Vec<Vec<Step>>,
    /// Direction of each row's cell, of unit length in each cell.
    axis: Vec<f64>,
}

impl Walk {
    /// For cells that are whitened, each by itself.
    pub(super) fn new(weighed: &Weighed<'_>) -> Self {
        let data = weighed.data;
        let mut axis = vec![weighed.noise.walk_n; data.points.len()];
        weighed.whiten(&mut axis);
        let lengths: Vec<f64> = data
            .cells
            .iter()
            .map(|cell| cell.iter().map(|r| axis[*r] * axis[*r]).sum::<f64>().sqrt())
            .collect();
        for (cell, length) in data.cells.iter().zip(&lengths).filter(|(_, length)| **length > 0.0) {
            cell.iter().for_each(|r| axis[*r] /= length);
        }
        let chains = data
            .walks
            .iter()
            .map(|walk| {
                let mut known = 1.0;
                walk.iter()
                    .map(|cell| {
                        let offset = lengths[*cell];
                        let before = CORRELATION * CORRELATION * known + 1.0 - CORRELATION * CORRELATION;
                        let variance = offset * offset * before + 1.0;
                        let gain = before * offset / variance;
                        known = (1.0 - gain * offset) * before;
                        Step { cell: *cell, offset, gain, variance }
                    })
                    .collect()
            })
            .collect();
        Self { chains, axis }
    }

    fn along(&self, cell: &[usize], values: &[f64]) -> f64 {
        cell.iter().map(|r| self.axis[*r] * values[*r]).sum()
    }

    /// Replaces what lies along each cell's direction by its innovation.
    pub(super) fn whiten(&self, data: &Observations, values: &mut [f64]) {
        for chain in &self.chains {
            let mut state = 0.0;
            for step in chain {
                let cell = &data.cells[step.cell];
                let along = self.along(cell, values);
                let before = CORRELATION * state;
                let innovation = along - step.offset * before;
                state = before + step.gain * innovation;
                let change = innovation / step.variance.sqrt() - along;
                cell.iter().for_each(|r| values[*r] += change * self.axis[*r]);
            }
        }
    }

    /// The adjoint of [`Walk::whiten`].
    pub(super) fn whiten_transposed(&self, data: &Observations, values: &mut [f64]) {
        for chain in &self.chains {
            let mut state = 0.0;
            for step in chain.iter().rev() {
                let cell = &data.cells[step.cell];
                let along = self.along(cell, values);
                let innovation = along / step.variance.sqrt() + step.gain * state;
                state = CORRELATION * (state - step.offset * innovation);
                let change = innovation - along;
                cell.iter().for_each(|r| values[*r] += change * self.axis[*r]);
            }
        }
    }

    /// `ln det` of what it whitens.
    pub(super) fn log_det(&self) -> f64 {
        self.chains.iter().flatten().map(|step| step.variance.ln()).sum()
    }
}
