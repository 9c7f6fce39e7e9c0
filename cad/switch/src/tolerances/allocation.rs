//! Allocation of tolerances: the cheapest ones with which the threshold scatters as little as wanted.
//!
//! The cost of a tolerance `t` is `n t0/t`: `n` occurrences, each at a cost of one with the tolerance `t0` of the process
//! (the reciprocal cost model). The variance of the threshold is `sum S² t²/4`, with `S²` the sum of the squared slopes of
//! the occurrences. Lagrange's multiplier gives `t = m (n t0/S²)^(1/3)`, between the tolerance of the best process and
//! that of the process, which costs nothing to keep. The variance increases with `m`, so that bisection finds the optimum
//! (Loosli, Manufacturing Tolerance Cost Minimization Using Discrete Optimization, ADCATS report 87-4, 1987).

use super::chain::{DEVIATIONS_PER_TOLERANCE, Link};

/// Number of bisections of the multiplier: its range of 60 decades to rounding.
const BISECTIONS: usize = 256;
/// Range of the decimal logarithm of the multiplier.
const MULTIPLIER: (f64, f64) = (-30.0, 30.0);

/// Returns the standard deviation of the threshold in N, to first order: `squares` are the sums of the squared slopes of
/// each link, `tolerances` their tolerances.
pub(super) fn standard_deviation_n(squares: &[f64], tolerances: &[f64]) -> f64 {
    let variance =
        |(square, tolerance): (&f64, &f64)| square * (tolerance / DEVIATIONS_PER_TOLERANCE).powi(2);
    squares.iter().zip(tolerances).map(variance).sum::<f64>().sqrt()
}

/// Returns the cheapest tolerances with which the standard deviation of the threshold is at most `wanted_n`; `None` if the
/// best processes do not reach it.
pub(super) fn allocate(chain: &[Link], squares: &[f64], wanted_n: f64) -> Option<Vec<f64>> {
    let best: Vec<f64> = chain.iter().map(|link| link.best.plus_minus).collect();
    let process: Vec<f64> = chain.iter().map(|link| link.process.plus_minus).collect();
    if standard_deviation_n(squares, &best) > wanted_n {
        return None;
    }
    if standard_deviation_n(squares, &process) <= wanted_n {
        return Some(process);
    }
    let at = |log: f64| -> Vec<f64> {
        let multiplier = libm::pow(10.0, log);
        let optimum = |(link, square): (&Link, &f64)| {
            let (low, high) = (link.best.plus_minus, link.process.plus_minus);
            if *square == 0.0 {
                return high;
            }
            (multiplier * libm::cbrt(link.count as f64 * high / square)).clamp(low, high)
        };
        chain.iter().zip(squares).map(optimum).collect()
    };
    let (mut low, mut high) = MULTIPLIER;
    for _ in 0..BISECTIONS {
        let middle = (low + high) / 2.0;
        if standard_deviation_n(squares, &at(middle)) <= wanted_n {
            low = middle;
        } else {
            high = middle;
        }
    }
    let rounded = chain.iter().zip(at(low)).map(|(link, t)| rounded_down(t).max(link.best.plus_minus));
    Some(rounded.collect())
}

/// Rounds a tolerance down to two digits, as a drawing prints it.
fn rounded_down(tolerance: f64) -> f64 {
    if !(tolerance > 0.0 && tolerance.is_finite()) {
        return tolerance;
    }
    let step = libm::pow(10.0, libm::floor(libm::log10(tolerance)) - 1.0);
    // The small term keeps 0.13 if it was computed as 0.12999...
    let steps = libm::floor(tolerance / step + 1e-9);
    // A step below one is exact as a quotient: 13/100, not 13 * 0.01.
    if step < 1.0 { steps / libm::round(1.0 / step) } else { steps * step }
}

#[cfg(test)]
mod tests {
    use super::super::chain::{ChainDimension, SourcedTolerance};
    use super::*;

    fn link(process: f64, best: f64, count: usize) -> Link {
        let tolerance = |plus_minus| SourcedTolerance { plus_minus, source: "test" };
        Link {
            dimension: ChainDimension::PinDiameter,
            nominal: 1.0,
            drawing: process,
            count,
            process: tolerance(process),
            best: tolerance(best),
        }
    }

    fn cost(chain: &[Link], tolerances: &[f64]) -> f64 {
        let of = |(link, t): (&Link, &f64)| link.count as f64 * link.process.plus_minus / t;
        chain.iter().zip(tolerances).map(of).sum()
    }

    /// No other tolerances with the same scatter are cheaper: random changes that keep the variance.
    #[test]
    fn the_allocation_is_cheapest() {
        let chain = [link(0.2, 0.01, 1), link(0.1, 0.01, 3), link(0.05, 0.01, 1)];
        let squares = [9.0, 4.0, 100.0];
        let wanted_n = 0.5 * standard_deviation_n(&squares, &[0.2, 0.1, 0.05]);
        let optimum = allocate(&chain, &squares, wanted_n).unwrap();
        let reached_n = standard_deviation_n(&squares, &optimum);
        assert!(reached_n <= wanted_n && reached_n > 0.9 * wanted_n, "{reached_n} for {wanted_n}");
        for change in [0.8, 0.9, 1.1, 1.2] {
            for (i, j) in [(0, 1), (0, 2), (1, 2)] {
                let mut other = optimum.clone();
                other[i] *= change;
                let freed = squares[i] * (optimum[i].powi(2) - other[i].powi(2));
                let square = optimum[j].powi(2) + freed / squares[j];
                if square <= 0.0 {
                    continue;
                }
                other[j] = square.sqrt();
                let bounds =
                    |k: usize| (chain[k].best.plus_minus..=chain[k].process.plus_minus).contains(&other[k]);
                // Rounding to two digits costs at most a few percent.
                assert!(!bounds(i) || !bounds(j) || cost(&chain, &other) > 0.97 * cost(&chain, &optimum));
            }
        }
    }

    #[test]
    fn unreachable_scatter_is_refused() {
        let chain = [link(0.2, 0.05, 1)];
        assert_eq!(allocate(&chain, &[1.0], 0.01), None);
        assert_eq!(allocate(&chain, &[1.0], 0.025), Some(vec![0.05]));
        assert_eq!(allocate(&chain, &[1.0], 1.0), Some(vec![0.2]), "the process is good enough");
    }

    #[test]
    fn tolerances_are_rounded_down() {
        for (exact, rounded) in [(0.1299, 0.12), (0.13, 0.13), (2.59, 2.5), (0.00456, 0.0045), (12.9, 12.0)] {
            assert_eq!(rounded_down(exact), rounded);
        }
    }
}
