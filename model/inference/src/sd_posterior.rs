//! Posterior of a standard deviation on nodes, from which simulated sessions draw.

use crate::quadrature::log_sum_exp;
use crate::random::Random;

/// Standard deviations with their posterior probabilities; empty for a component without levels.
pub(crate) struct SdPosterior {
    nodes: Vec<(f64, f64)>,
}

impl SdPosterior {
    /// Returns the posterior with these standard deviations, each with the logarithm of its probability, up to a constant.
    pub(crate) fn new(terms: Vec<(f64, f64)>) -> Self {
        let total = log_sum_exp(&terms.iter().map(|(_, term)| *term).collect::<Vec<f64>>());
        Self { nodes: terms.into_iter().map(|(sd, term)| (sd, libm::exp(term - total))).collect() }
    }

    /// Draws a standard deviation; `None` if there is none.
    pub(crate) fn draw(&self, random: &mut Random) -> Option<f64> {
        let drawn = random.by_probability(self.nodes.iter().map(|(_, probability)| *probability))?;
        Some(self.nodes[drawn].0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nodes_are_drawn_by_probability() {
        let mut random = Random::new(2);
        let posterior =
            SdPosterior::new(vec![(0.1, 3.0), (0.2, 3.0 + libm::log(3.0)), (0.3, f64::NEG_INFINITY)]);
        let drawn: Vec<f64> = (0..4000).filter_map(|_| posterior.draw(&mut random)).collect();
        let second = drawn.iter().filter(|sd| **sd == 0.2).count();
        assert!(drawn.len() == 4000 && (2900..3100).contains(&second), "{second}");
        assert!(!drawn.contains(&0.3));
        assert_eq!(SdPosterior::new(Vec::new()).draw(&mut random), None);
    }
}
