//! Bayesian comparison of hypotheses about series of readings: the probability of named effects and
//! of unnamed structure, and the expected error of a new session.
//!
//! The crate knows statistics only. The caller supplies a forward model, named effects with typical
//! sizes, and bases of kernels; every hypothesis is a set of effects and kernels and gets one number,
//! `ln p(y | H) + ln p(H)`. The Occam factor in the evidence and the prior odds replace thresholds on
//! gains and corrections for multiple tests.
//!
//! # Model
//!
//! ```text
//! y = f(x; q, s) + sum_e B_e(x) b_e + sum_k c_k(x) Phi_k(x) w_k + sum_j c_j(x) Z_j m_j + r(x) + e
//! ```
//!
//! | symbol | meaning | prior or law, given the hypothesis | here |
//! | --- | --- | --- | --- |
//! | `y` | readings in consecutive series | | [`Problem::new`] |
//! | `f` | forward model | | [`ForwardModel::readings`] |
//! | `q` | constants of the baseline | normal | [`Constant`] |
//! | `s_e` | size of an effect, for each of its discrete shapes | Cauchy with quartiles at the typical size; half-Cauchy if one-sided | [`Effect`] |
//! | | shifts of the constants of its shape | normal, sd 1 | [`SizedEffect::shifts`] |
//! | `B_e b_e` | discrepancy of an effect: its contribution times columns where its form may be wrong | normal, sd 0.15 | [`Rows::discrepancies`] |
//! | `Phi_k w_k` | unnamed structure over one covariate | normal with sd `tau_k`, half-Cauchy | [`Kernel`], [`kernel`] |
//! | `c_k` | sensitivity of the reading to a channel, such as friction | | [`ForwardModel::channels`] |
//! | `Z_j m_j` | random effects, such as mounts | normal with sd half-normal | [`RandomEffect`] |
//! | `r` | offsets per series and per series and direction, scale per series, AR(1) | scales half-Cauchy | [`Scales`] |
//! | `e` | repetition noise that grows with load, plus the quantum of the instrument | Student's t with 5 degrees of freedom | [`Scales`] |
//!
//! | quantity | method |
//! | --- | --- |
//! | mode of `q`, `s` | Gauss-Newton steps; sizes are practically free in the first ones |
//! | weights of the t noise | EM for its scale mixture |
//! | scales of noise and components | Newton steps with the average information matrix |
//! | `ln p(y \| H)` | all coefficients exactly (Woodbury); Cauchy priors, signs and `tau` by quadrature |
//! | intervals of `q` and `s` | corrected for weights and scales that are not known: Fisher information of the t noise, Kackar and Harville, Satterthwaite |
//! | `P(H \| y)` | `exp(score)` over the sum in Occam's window ([`SearchOptions::window`]) |
//! | expected error | exact leave-one-series-out, hypotheses weighed without the series ([`ExpectedError`]) |
//!
//! Results are deterministic: the only random numbers come from the seed of [`infer`].
//!
//! # Example
//!
//! Readings of a slope with an offset that the baseline lacks:
//!
//! ```
//! use pinswitch_inference::{
//!     Constant, Effect, ForwardModel, Member, Problem, Rows, SearchOptions, SizedEffect, Space, infer,
//! };
//!
//! struct Line(Vec<f64>);
//!
//! impl ForwardModel for Line {
//!     fn readings(&self, constants: &[f64], effects: &[SizedEffect]) -> Vec<f64> {
//!         let offset: f64 = effects.iter().map(|e| e.size).sum();
//!         self.0.iter().map(|load| constants[0] * load + offset).collect()
//!     }
//!
//!     fn channels(&self, constants: &[f64], _: &[SizedEffect]) -> Vec<Vec<f64>> {
//!         vec![self.0.iter().map(|load| constants[0] * load).collect()]
//!     }
//!
//!     fn of_rows(&self, rows: &[usize]) -> Box<dyn ForwardModel> {
//!         Box::new(Self(rows.iter().map(|row| self.0[*row]).collect()))
//!     }
//! }
//!
//! let load: Vec<f64> = (0..40).map(|i| f64::from(1 + i / 10)).collect();
//! let noise = |i: usize| 0.02 * ((i * 7919 % 13) as f64 - 6.0) / 4.0;
//! let readings = load.iter().enumerate().map(|(i, load)| 2.0 * load + 0.5 + noise(i)).collect();
//! let space = Space {
//!     constants: vec![Constant { name: "slope".to_owned(), mean: 1.0, sd: 1.0 }],
//!     effects: vec![Effect {
//!         name: "offset".to_owned(),
//!         typical_size: Some(0.5),
//!         is_one_sided: false,
//!         probability: 0.05,
//!         starts: vec![0.1],
//!         shape_probabilities: vec![],
//!         shape_constants: 0,
//!     }],
//!     ..Space::default()
//! };
//! let rows = Rows {
//!     series: (0..40).map(|i| i / 10).collect(),
//!     direction: vec![false; 40],
//!     sessions: vec![0; 40],
//!     order: (0..40).map(|i| i % 10).collect(),
//!     load: load.clone(),
//!     levels: vec![],
//!     bases: vec![],
//!     discrepancies: vec![vec![]],
//!     relevant: vec![vec![0.05; 40]],
//!     is_new_session: false,
//!     forward: Box::new(Line(load)),
//! };
//! let problem = Problem::new(space, rows, readings)?;
//! let posterior = infer(&problem, SearchOptions::default(), 1).ok_or("no finite readings")?;
//! assert_eq!(posterior.reported[0].member, Member::Effect(0));
//! assert!(posterior.probability(Member::Effect(0)) > 0.99);
//! assert!((posterior.size(0).ok_or("not in the window")?.mean - 0.5).abs() < 0.05);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

#![warn(clippy::disallowed_methods)]

mod autoregression;
mod basis;
mod candidates;
mod cells;
mod coefficients;
mod covariance;
mod curved_channels;
mod design;
mod evidence;
mod expected_error;
mod fit;
mod half_t;
mod hypothesis;
mod information;
pub mod kernel;
mod leave_out;
mod marginal;
mod noise;
mod outliers;
mod posterior;
mod prediction;
mod problem;
mod quadrature;
mod random;
mod scales;
mod score;
mod sd_posterior;
mod search;
mod series_rows;
mod session_steps;
mod session_view;
mod simulated_sessions;
#[cfg(test)]
mod test_problem;
mod thinning;
mod traces;
mod uncertainty;
mod variance_gain;
mod white_design;
mod whitening;

pub use basis::Basis;
pub use coefficients::{Coefficient, Coefficients};
pub use design::Mode;
pub use evidence::SizePosterior;
pub use expected_error::ExpectedError;
pub use fit::Fit;
pub use hypothesis::{Element, Hypothesis, Member};
pub use information::information;
pub use leave_out::leave_groups_out;
pub use noise::{NoiseReference, Scales};
pub use outliers::{Outliers, OutlyingReading, OutlyingSeries, SERIES_PROBABILITY};
pub use posterior::{
    Candidate, Posterior, REPORTED_PROBABILITY, Reported, SizeEstimate, best_additions, infer,
};
pub use prediction::Prediction;
pub use problem::{
    Constant, Effect, ForwardModel, Kernel, MOST_SHAPE_CONSTANTS, Problem, ProblemError, RandomEffect, Rows,
    SessionLevels, SizedEffect, Space,
};
pub use score::SizeLimits;
pub use search::SearchOptions;
