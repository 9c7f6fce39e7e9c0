//! Steps of the levels of sessions: how far the next session may be from the level that is expected of it.

use crate::half_t::HalfT;
use crate::problem::{Kernel, SessionLevels};
use crate::quadrature::Mixture;
use crate::random::Random;
use crate::sd_posterior::SdPosterior;

/// Largest distance of the logarithms of the standard deviations over which a posterior is summed.
const SPACING: f64 = 0.125;
/// Degrees of freedom of the prior of the standard deviation of steps, as of other predictions. After `n` steps far above its
/// scale the next one has Student's t distribution with three more.
const DEGREES: f64 = 3.0;
/// Differences of levels that are smaller than this share of the scale of their prior may be those of rounding.
const ROUNDING: f64 = 1e-6;

/// Differences of the levels of sessions from the levels that were to be expected.
pub(crate) struct Steps {
    /// Level that a new session is expected to have.
    pub(crate) expected: f64,
    /// Probability of a difference.
    share: f64,
    /// Variance of the difference of a new session from its expected level, over that of the differences.
    widening: f64,
    /// Standard deviation of the differences.
    sd: SdPosterior,
    /// Mean square of the differences so far, for that of a new session, in the square of the unit of the channel; zero where
    /// most sessions have none.
    square: f64,
    /// Change of each reading per unit of the level.
    pub(crate) channel: Vec<f64>,
}

impl Steps {
    /// Returns those of a curve that is constant in each session. A new session may differ from its expected level as the
    /// sessions did: from the level before, from their mean, which is known from as many sessions, or as one of them did.
    pub(crate) fn of_curve(curve: &[f64], of: SessionLevels, prior: HalfT, channel: Vec<f64>) -> Self {
        let mut levels = curve.to_vec();
        if of == SessionLevels::Independent {
            levels.sort_by(f64::total_cmp);
        }
        levels.dedup();
        let expected = of.expected(&levels);
        let steps = || levels.windows(2).map(|pair| (pair[1] - pair[0]).powi(2));
        let count = levels.len().saturating_sub(1);
        let (sum, count, share, widening) = match of {
            SessionLevels::Independent => {
                let squares = levels.iter().map(|level| (level - expected).powi(2));
                (squares.sum(), count, 1.0, 1.0 + 1.0 / levels.len().max(1) as f64)
            }
            SessionLevels::RandomWalk => (steps().sum::<f64>(), count, 1.0, 1.0),
            SessionLevels::OneChange(sessions) | SessionLevels::OneSession(sessions) => {
                (steps().next().unwrap_or(0.0), count.min(1), 1.0 / sessions.max(1) as f64, 1.0)
            }
        };
        let sd = SdPosterior::new(terms(sum, count, prior));
        // What most sessions do not have is not expected of a new one, but its interval contains it.
        let square = if share < 1.0 { 0.0 } else { widening * (sum / f64::max(count as f64, 1.0)) };
        Self { expected, share, widening, sd, square, channel }
    }

    /// Draws the difference of a new session.
    pub(crate) fn draw(&self, random: &mut Random) -> f64 {
        if random.uniform() >= self.share {
            return 0.0;
        }
        self.sd.draw(random).map_or(0.0, |sd| sd * self.widening.sqrt() * random.normal())
    }

    /// Mean square by which a reading of a new session differs from the one with the expected level.
    pub(crate) fn square_at(&self, row: usize) -> f64 {
        self.square * self.channel[row].powi(2)
    }
}

/// Returns the prior of the standard deviation of the steps of a kernel, given the largest change of its level by a
/// coefficient: half-t, in the place of the half-Cauchy prior by which hypotheses are compared, whose tail is so heavy that
/// after one step the variance of the next one is infinite.
pub(crate) fn prior_of_steps(kernel: &Kernel, change: f64) -> HalfT {
    HalfT { scale: kernel.scale * change, degrees: DEGREES }
}

/// Returns standard deviations of this many differences with the sum `sum` of their squares, each with the logarithm of its
/// posterior probability, up to a constant; none without differences.
fn terms(sum: f64, count: usize, prior: HalfT) -> Vec<(f64, f64)> {
    if count == 0 {
        return Vec::new();
    }
    let count = count as f64;
    // Nodes as far from the differences as from the scale of the prior.
    let size = (sum / count).sqrt().max(ROUNDING * prior.scale);
    let nodes = Mixture::half_t_over(prior, SPACING, [size.min(prior.scale), size.max(prior.scale)]);
    let log = |(sd, weight): (&f64, &f64)| weight - count * libm::log(*sd) - 0.5 * sum / (sd * sd);
    nodes.nodes.iter().zip(&nodes.log_weights).map(|node| (*node.0, log(node))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const WIDE: HalfT = HalfT { scale: 1e-3, degrees: DEGREES };

    #[test]
    fn steps_between_sessions_are_counted_once_each() {
        let of = |curve: &[f64], levels| {
            let steps = Steps::of_curve(curve, levels, WIDE, vec![1.0; curve.len()]);
            (steps.expected, steps.square)
        };
        let curve = [0.0, 0.0, 0.0, 1.0, 3.0, 3.0, -4.0];
        use SessionLevels::{Independent, OneChange, OneSession, RandomWalk};
        assert_eq!(of(&curve, RandomWalk), (-4.0, (1.0 + 4.0 + 49.0) / 3.0));
        assert_eq!(of(&curve, Independent), (0.0, 26.0 / 3.0 * 1.25));
        assert_eq!(of(&[0.0, 0.0, 2.0, 2.0], OneChange(4)), (2.0, 0.0));
        assert_eq!(of(&[0.0, 0.0, 2.0, 0.0], OneSession(4)), (0.0, 0.0));
        for levels in [Independent, RandomWalk, OneChange(3), OneSession(3)] {
            assert_eq!(of(&[0.3, 0.3, 0.3], levels), (0.3, 0.0));
            assert_eq!(of(&[], levels), (0.0, 0.0));
        }
    }

    /// Far above its scale the prior falls with the fourth power, so that two thirds and nine tenths of the levels of a new
    /// session are within the tabulated quantiles of Student's t distribution with three degrees of freedom more than
    /// differences.
    #[test]
    fn the_step_of_a_new_session_has_the_t_distribution_of_few_steps() {
        let mut random = Random::new(8);
        for (curve, quantiles) in
            [(&[0.0, 1.0][..], [1.0994, 2.1318]), (&[0.0, 1.0, 0.0, 1.0][..], [1.0519, 1.9432])]
        {
            let steps = Steps::of_curve(curve, SessionLevels::RandomWalk, WIDE, Vec::new());
            let count = (curve.len() - 1) as f64;
            let scale = (count / (count + 3.0)).sqrt();
            for (quantile, share) in quantiles.into_iter().zip([2.0 / 3.0, 0.9]) {
                let within = (0..9000).filter(|_| steps.draw(&mut random).abs() < scale * quantile).count();
                let expected = 9000.0 * share;
                assert!((within as f64 - expected).abs() < 150.0, "{count} steps: {within} for {expected}");
            }
        }
    }

    /// After one step far below the scale of the prior most steps are small, but larger ones remain probable.
    #[test]
    fn one_small_step_does_not_exclude_larger_ones() {
        let prior = HalfT { scale: 1.0, degrees: DEGREES };
        let steps = Steps::of_curve(&[0.0, 0.01], SessionLevels::RandomWalk, prior, Vec::new());
        let mut random = Random::new(4);
        let above =
            |limit: f64, random: &mut Random| (0..9000).filter(|_| steps.draw(random).abs() > limit).count();
        let (of_its_size, of_the_scale) = (above(0.02, &mut random), above(1.0, &mut random));
        assert!(of_its_size > 4500 && (450..1800).contains(&of_the_scale), "{of_its_size}, {of_the_scale}");
    }
}
