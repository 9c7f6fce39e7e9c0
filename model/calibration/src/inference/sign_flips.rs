//! Test over the whole vocabulary that needs no noise model: signs of whole series are flipped, and
//! the largest score is taken.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::lanes::LANES;

/// Number of draws; the smallest probability is its inverse.
const DRAWS: usize = 999;
/// Seed of the draws, so that the same table gives the same probability.
const SEED: u64 = 0x5EED;

/// Returns the probability that the largest score arises without any effect. `contributions`
/// contains, for each candidate, the contribution of each series to its score. Under the null
/// hypothesis a series may have the opposite sign (Westfall and Young's largest score with the
/// flipped scores of Hemerik, Goeman and Finos), whatever the noise within it.
pub(crate) fn family_probability(contributions: &[&[f64]]) -> f64 {
    let scaled: Vec<Vec<f64>> = contributions
        .iter()
        .filter_map(|c| {
            let length = c.iter().map(|v| v * v).sum::<f64>().sqrt();
            (length > 1e-9).then(|| c.iter().map(|v| v / length).collect())
        })
        .collect();
    let series = scaled.first().map_or(0, Vec::len);
    let observed = largest(&scaled, &vec![[1.0; LANES]; series])[0];
    let mut random = ChaCha8Rng::seed_from_u64(SEED);
    let mut signs = vec![[1.0; LANES]; series];
    let (mut as_large, mut drawn) = (0, 0);
    while drawn < DRAWS {
        let draws = LANES.min(DRAWS - drawn);
        for draw in 0..draws {
            signs.iter_mut().for_each(|s| s[draw] = if random.random::<bool>() { 1.0 } else { -1.0 });
        }
        let found = largest(&scaled, &signs);
        as_large += found[..draws].iter().map(|score| i32::from(*score >= observed - 1e-12)).sum::<i32>();
        drawn += draws;
    }
    f64::from(as_large + 1) / (DRAWS + 1) as f64
}

/// Returns the largest score of several draws of signs.
fn largest(scaled: &[Vec<f64>], signs: &[[f64; LANES]]) -> [f64; LANES] {
    let mut largest = [0.0f64; LANES];
    for contributions in scaled {
        let mut sums = [0.0; LANES];
        for (value, signs) in contributions.iter().zip(signs) {
            sums.iter_mut().zip(signs).for_each(|(sum, sign)| *sum += value * sign);
        }
        largest.iter_mut().zip(sums).for_each(|(most, sum)| *most = most.max(sum.abs()));
    }
    largest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn agreement_of_series_is_significant() {
        let agree = vec![1.0; 40];
        let mixed: Vec<f64> = (0..40).map(|i| if i % 2 == 0 { 1.0 } else { -1.0 }).collect();
        assert!(family_probability(&[&agree, &mixed]) < 0.01);
        assert!(family_probability(&[&mixed]) > 0.5);
        // A single series is not conclusive.
        let mut alone = vec![0.0; 40];
        alone[3] = 5.0;
        assert!(family_probability(&[&alone]) > 0.5);
    }
}
