//! A test over the whole vocabulary that needs no noise model: signs of whole series flipped, largest score taken.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Draws; the smallest probability is one over their number.
const DRAWS: usize = 999;
/// Seed of the draws: the same table has the same probability.
const SEED: u64 = 0x5EED;

/// Probability that the largest score arises without any effect. `contributions` has, for each candidate, what each
/// series adds to its score; under the null a series may as well have the opposite sign (Westfall and Young's
/// largest score with Hemerik, Goeman and Finos' flipped scores), whatever the noise inside it.
pub(crate) fn family_probability(contributions: &[&[f64]]) -> f64 {
    let scaled: Vec<Vec<f64>> = contributions
        .iter()
        .filter_map(|c| {
            let length = c.iter().map(|v| v * v).sum::<f64>().sqrt();
            (length > 1e-9).then(|| c.iter().map(|v| v / length).collect())
        })
        .collect();
    let series = scaled.first().map_or(0, Vec::len);
    let largest = |signs: &[f64]| {
        scaled.iter().map(|c| c.iter().zip(signs).map(|(v, s)| v * s).sum::<f64>().abs()).fold(0.0, f64::max)
    };
    let observed = largest(&vec![1.0; series]);
    let mut random = ChaCha8Rng::seed_from_u64(SEED);
    let mut signs = vec![1.0; series];
    let mut as_large = 0;
    for _ in 0..DRAWS {
        signs.iter_mut().for_each(|s| *s = if random.random::<bool>() { 1.0 } else { -1.0 });
        if largest(&signs) >= observed - 1e-12 {
            as_large += 1;
        }
    }
    f64::from(as_large + 1) / (DRAWS + 1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn agreement_of_the_series_is_told_from_chance() {
        let agree = vec![1.0; 40];
        let mixed: Vec<f64> = (0..40).map(|i| if i % 2 == 0 { 1.0 } else { -1.0 }).collect();
        assert!(family_probability(&[&agree, &mixed]) < 0.01);
        assert!(family_probability(&[&mixed]) > 0.5);
        // A single series cannot decide.
        let mut alone = vec![0.0; 40];
        alone[3] = 5.0;
        assert!(family_probability(&[&alone]) > 0.5);
    }
}
