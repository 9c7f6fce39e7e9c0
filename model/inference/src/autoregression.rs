//! AR(1) process of the rows of a series, by its one state.
//!
//! The state `z` has the variance `a` and decays by `rho` per step of the order; row `i` reads `h_i z`. Products with the
//! covariance, and the innovations of the rows with independent noise in addition (Kalman filter), take one pass each.

/// A process at the rows of a series.
#[derive(Clone, Debug)]
pub(crate) struct Process {
    share: f64,
    /// The rows in their order, each with the decay of the state since the one before.
    states: Vec<(usize, f64)>,
    /// `h`.
    sd: Vec<f64>,
}

impl Process {
    /// Returns the process of rows with these orders and standard deviations.
    pub(crate) fn new(order: &[usize], sd: Vec<f64>, share: f64, correlation: f64) -> Self {
        let mut rows: Vec<usize> = (0..order.len()).collect();
        rows.sort_by_key(|row| order[*row]);
        let decay = |place: usize| match place {
            0 => 0.0,
            // Most rows follow each other, which needs no power.
            _ => match order[rows[place]] - order[rows[place - 1]] {
                1 => correlation,
                lag => libm::pow(correlation, lag as f64),
            },
        };
        let states = (0..rows.len()).map(|place| (rows[place], decay(place))).collect();
        Self { share, states, sd }
    }

    /// Returns the product of its covariance and a vector.
    pub(crate) fn times(&self, vector: &[f64]) -> Vec<f64> {
        let mut product = vec![0.0; vector.len()];
        let mut sum = 0.0;
        for (row, decay) in &self.states {
            sum = decay * sum + self.sd[*row] * vector[*row];
            product[*row] = self.share * self.sd[*row] * sum;
        }
        sum = 0.0;
        for (row, decay) in self.states.iter().rev() {
            product[*row] += self.share * self.sd[*row] * sum;
            sum = decay * (sum + self.sd[*row] * vector[*row]);
        }
        product
    }

    /// Returns the filter of the process with independent noise of these variances in addition.
    pub(crate) fn filter(&self, independent: &[f64]) -> Filter {
        let mut variance = 0.0;
        let step = |(row, decay): &(usize, f64)| {
            variance = decay * decay * variance + self.share * (1.0 - decay * decay);
            let reads = self.sd[*row];
            let innovation = reads * reads * variance + independent[*row];
            let gain = reads * variance / innovation;
            variance -= gain * reads * variance;
            Step { row: *row, decay: *decay, reads, gain, sd: innovation.sqrt() }
        };
        Filter { steps: self.states.iter().map(step).collect() }
    }
}

/// Kalman filter of a series: the root `L^-1` of the precision of its rows, where `L` is lower triangular in their order.
#[derive(Clone, Debug)]
pub(crate) struct Filter {
    steps: Vec<Step>,
}

#[derive(Clone, Copy, Debug)]
struct Step {
    row: usize,
    /// Of the state since the step before.
    decay: f64,
    /// Reading of a state of 1.
    reads: f64,
    /// Change of the state by an innovation of 1.
    gain: f64,
    /// Standard deviation of the innovation.
    sd: f64,
}

impl Filter {
    /// Replaces `x` by `L^-1 x`.
    pub(crate) fn whiten(&self, x: &mut [f64]) {
        let mut state = 0.0;
        for step in &self.steps {
            state *= step.decay;
            let innovation = x[step.row] - step.reads * state;
            x[step.row] = innovation / step.sd;
            state += step.gain * innovation;
        }
    }

    /// Replaces `x` by `L'^-1 x`.
    pub(crate) fn whiten_transposed(&self, x: &mut [f64]) {
        let mut of_state = 0.0;
        for step in self.steps.iter().rev() {
            let innovation = x[step.row] / step.sd + step.gain * of_state;
            x[step.row] = innovation;
            of_state = step.decay * (of_state - step.reads * innovation);
        }
    }

    /// Replaces `x` by `L x`.
    pub(crate) fn colour(&self, x: &mut [f64]) {
        let mut state = 0.0;
        for step in &self.steps {
            state *= step.decay;
            let innovation = step.sd * x[step.row];
            x[step.row] = innovation + step.reads * state;
            state += step.gain * innovation;
        }
    }

    /// Returns the diagonal of `L'^-1 L^-1`.
    pub(crate) fn precision_diagonal(&self) -> Vec<f64> {
        let mut diagonal = vec![0.0; self.steps.len()];
        // Sum of the squares of what a state of 1 adds to the white rows after a step.
        let mut after = 0.0;
        for step in self.steps.iter().rev() {
            let gain = step.gain;
            diagonal[step.row] = (1.0 / step.sd).powi(2) + gain * gain * after;
            let rest = 1.0 - gain * step.reads;
            after = step.decay * step.decay * ((step.reads / step.sd).powi(2) + rest * rest * after);
        }
        diagonal
    }

    /// Returns `ln det L`.
    pub(crate) fn log_determinant(&self) -> f64 {
        self.steps.iter().map(|step| libm::log(step.sd)).sum()
    }
}
