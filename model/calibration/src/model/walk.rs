//! Offsets that drift from series to series: each series' offset, and each direction's, is an AR(1)
//! process, whitened by a Kalman filter over the series in the order of time. The cost is linear in
//! the series.
//!
//! A white offset and the friction scale of a series are states without memory in the same filter:
//! if they were whitened afterwards, they would also be removed from the following series.

use serde::{Deserialize, Serialize};

use super::noise::Noise;
use super::observations::Observations;
use super::weighed::Weighed;

/// Drifting part of the offsets of series. Sizes are shares of the offsets' standard deviations as
/// estimated without drift.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Wandering {
    /// Correlation with the previous series; 0 without drift.
    pub correlation: f64,
    /// Size of the part that does not drift.
    pub white: f64,
    /// Size of the drifting offset common to both directions.
    pub common: f64,
    /// Size of the drifting offset of each direction.
    pub direction: f64,
}

impl Wandering {
    /// Returns whether there is any drift.
    pub(crate) fn is_any(&self) -> bool {
        self.correlation > 0.0 && (self.common > 0.0 || self.direction > 0.0)
    }
}

/// Number of states: the offset of the series and of each direction, with memory, and the white
/// offset and the friction scale of the series, without memory.
const STATES: usize = 5;
const REMEMBERED: usize = 3;

type State = [f64; STATES];

/// One cell in the filter.
#[derive(Clone, Copy, Debug)]
struct Step {
    cell: usize,
    /// Correlation of the states with memory with those of the previous cell; `None` within a
    /// series.
    memory: Option<f64>,
    /// Change along the cell's direction per standard deviation of each state.
    reach: State,
    gain: State,
    /// Variance of the innovation.
    variance: f64,
}

/// The filter of a table.
#[derive(Clone, Debug)]
pub(super) struct Walk {
    steps: Vec<Step>,
    /// Direction of each row's cell, of unit norm in each cell.
    axis: Vec<f64>,
}

fn along(state: &State, reach: &State) -> f64 {
    state.iter().zip(reach).map(|(s, r)| s * r).sum()
}

/// Propagates the states with memory, and resets the others.
fn remembered(state: &State, memory: f64) -> State {
    std::array::from_fn(|i| if i < REMEMBERED { memory * state[i] } else { 0.0 })
}

impl Walk {
    /// Builds the filter for cells that are whitened individually.
    pub(super) fn new(weighed: &Weighed<'_>) -> Self {
        let (data, noise) = (weighed.data, weighed.noise);
        let mut axis = vec![1.0; data.points.len()];
        weighed.whiten(&mut axis);
        let mut scale = data.friction_n.clone();
        weighed.whiten(&mut scale);
        let mut length = vec![0.0; data.cells.len()];
        let mut friction = vec![0.0; data.cells.len()];
        for (index, cell) in data.cells.iter().enumerate() {
            let length2: f64 = cell.iter().map(|r| axis[*r] * axis[*r]).sum();
            if length2 > 1e-24 {
                length[index] = length2.sqrt();
                cell.iter().for_each(|r| axis[*r] /= length[index]);
                friction[index] = cell.iter().map(|r| axis[*r] * scale[*r]).sum();
            }
        }
        let mut known = [[0.0; STATES]; STATES];
        known.iter_mut().enumerate().for_each(|(i, row)| row[i] = 1.0);
        let mut steps = Vec::with_capacity(data.cells.len());
        for turn in &data.turns {
            let memory = noise.walk.correlation.powi(turn.since);
            for (place, cell) in turn.cells.iter().enumerate() {
                let memory = (place == 0).then_some(memory);
                if let Some(memory) = memory {
                    for (i, row) in known.iter_mut().enumerate() {
                        for (j, value) in row.iter_mut().enumerate() {
                            let both = if i < REMEMBERED && j < REMEMBERED { memory * memory } else { 0.0 };
                            let own = if i == j { 1.0 - both } else { 0.0 };
                            *value = both * *value + own;
                        }
                    }
                }
                let sign = data.cells[*cell].first().map_or(1.0, |r| data.points[*r].sign);
                let reach = reach(noise, data.cell_load_n[*cell], sign, length[*cell], friction[*cell]);
                let shared: State = std::array::from_fn(|i| along(&known[i], &reach));
                let variance = along(&shared, &reach) + 1.0;
                let gain = shared.map(|s| s / variance);
                for (row, gain) in known.iter_mut().zip(&gain) {
                    row.iter_mut().zip(&shared).for_each(|(value, shared)| *value -= gain * shared);
                }
                steps.push(Step { cell: *cell, memory, reach, gain, variance });
            }
        }
        Self { steps, axis }
    }

    fn along(&self, cell: &[usize], values: &[f64]) -> f64 {
        cell.iter().map(|r| self.axis[*r] * values[*r]).sum()
    }

    /// Replaces the component along each cell's direction by its innovation.
    pub(super) fn whiten<const N: usize>(&self, data: &Observations, values: &mut [[f64; N]]) {
        let mut states = [[0.0; STATES]; N];
        for step in &self.steps {
            let cell = &data.cells[step.cell];
            let mut change = [0.0; N];
            for row in cell {
                change.iter_mut().zip(&values[*row]).for_each(|(sum, v)| *sum += self.axis[*row] * v);
            }
            let sd = step.variance.sqrt();
            for (state, change) in states.iter_mut().zip(&mut change) {
                if let Some(memory) = step.memory {
                    *state = remembered(state, memory);
                }
                let value = *change;
                let innovation = value - along(state, &step.reach);
                state.iter_mut().zip(&step.gain).for_each(|(s, g)| *s += g * innovation);
                *change = innovation / sd - value;
            }
            for row in cell {
                values[*row].iter_mut().zip(&change).for_each(|(v, c)| *v += c * self.axis[*row]);
            }
        }
    }

    /// Applies the adjoint of [`Walk::whiten`].
    pub(super) fn whiten_transposed(&self, data: &Observations, values: &mut [f64]) {
        let mut state = [0.0; STATES];
        for step in self.steps.iter().rev() {
            let cell = &data.cells[step.cell];
            let value = self.along(cell, values);
            let innovation = value / step.variance.sqrt() + along(&state, &step.gain);
            state.iter_mut().zip(&step.reach).for_each(|(s, r)| *s -= r * innovation);
            if let Some(memory) = step.memory {
                state = remembered(&state, memory);
            }
            let change = innovation - value;
            cell.iter().for_each(|r| values[*r] += change * self.axis[*r]);
        }
    }

    /// Returns `ln det` of the covariance that it whitens.
    pub(super) fn log_det(&self) -> f64 {
        self.steps.iter().map(|step| libm::log(step.variance)).sum()
    }
}

/// Returns the change along a cell's direction, whose norm is that of one newton, per standard
/// deviation of each state.
fn reach(noise: Noise, load_n: f64, sign: f64, length: f64, friction: f64) -> State {
    let common = length * noise.series_common.at(load_n);
    let direction = length * noise.walk.direction * noise.series.at(load_n);
    let (down, up) = if sign < 0.0 { (direction, 0.0) } else { (0.0, direction) };
    [noise.walk.common * common, down, up, noise.walk.white * common, noise.series_scale * friction]
}
