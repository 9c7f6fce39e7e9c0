//! Change points of a signal by the pruned exact linear time method (R. Killick, P. Fearnhead and
//! I. A. Eckley, "Optimal detection of changepoints with a linear computational cost", J. Am. Stat.
//! Assoc. 107, 2012).

/// Returns the first index of each segment after the first, for a signal with piecewise constant
/// mean and normal noise of standard deviation `noise`.
///
/// The cost of a segment is its sum of squares about its mean, over the variance. Each change adds
/// `3 ln n`, the modified Bayesian information criterion of N. R. Zhang and D. O. Siegmund
/// (Biometrics 63, 2007).
///
/// The time is linear in the number of changes, but quadratic between two of them. A long signal is
/// therefore searched in windows, of which each begins at the last change of the one before: the
/// result is the same, unless a segment is longer than half a window.
pub(super) fn change_points(values: &[f64], noise: f64) -> Vec<usize> {
    changes_in_windows(values, noise, WINDOW)
}

/// Most values that are searched at once: 200 s in blocks of 0.05 s.
const WINDOW: usize = 4_000;

fn changes_in_windows(values: &[f64], noise: f64, window: usize) -> Vec<usize> {
    let penalty = 3.0 * libm::log((values.len() as f64).max(2.0));
    let (mut all, mut from) = (Vec::new(), 0);
    loop {
        let to = values.len().min(from + window);
        let mut changes = changes_within(&values[from..to], noise, penalty);
        if to == values.len() {
            all.extend(changes.iter().map(|at| from + at));
            return all;
        }
        // The last change may be an effect of the end of the window.
        if changes.len() > 1 {
            changes.pop();
        }
        all.extend(changes.iter().map(|at| from + at));
        from += changes.last().copied().unwrap_or(window / 2);
    }
}

fn changes_within(values: &[f64], noise: f64, penalty: f64) -> Vec<usize> {
    let count = values.len();
    let centre = values.first().copied().unwrap_or(0.0);
    let scale = noise.max(f64::MIN_POSITIVE);
    let mut sums = vec![(0.0, 0.0)];
    for value in values {
        let x = (value - centre) / scale;
        let (sum, squares) = sums[sums.len() - 1];
        sums.push((sum + x, squares + x * x));
    }
    let cost = |from: usize, to: usize| {
        let (sum, squares) = (sums[to].0 - sums[from].0, sums[to].1 - sums[from].1);
        squares - sum * sum / (to - from) as f64
    };
    let mut best = vec![-penalty];
    let mut previous = vec![0];
    let mut candidates = vec![0];
    for to in 1..=count {
        let costs: Vec<f64> = candidates.iter().map(|from| best[*from] + cost(*from, to)).collect();
        let (at, least) = costs
            .iter()
            .enumerate()
            .fold((0, f64::INFINITY), |least, (i, c)| if *c < least.1 { (i, *c) } else { least });
        best.push(least + penalty);
        previous.push(candidates[at]);
        // A start that is worse by the penalty now is worse for ever.
        let mut costs = costs.into_iter();
        candidates.retain(|_| costs.next().is_some_and(|c| c <= least + penalty));
        candidates.push(to);
    }
    let mut changes = Vec::new();
    let mut at = previous[count];
    while at > 0 {
        changes.push(at);
        at = previous[at];
    }
    changes.reverse();
    changes
}

/// Whether an exponential decay to a constant describes a signal as well as a step at `split`: then
/// the change is a relaxation of the force, not a move.
pub(super) fn is_relaxation(values: &[f64], split: usize, noise: f64) -> bool {
    let about_mean = |v: &[f64]| {
        let mean = v.iter().sum::<f64>() / v.len() as f64;
        v.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>()
    };
    let step = about_mean(&values[..split]) + about_mean(&values[split..]);
    let count = values.len() as f64;
    // Time constants from an eighth of the interval to the whole.
    [0.125, 0.25, 0.5, 1.0].into_iter().any(|share| {
        let decay: Vec<f64> = (0..values.len()).map(|i| libm::exp(-(i as f64) / (share * count))).collect();
        let (mean_d, mean_x) = (decay.iter().sum::<f64>() / count, values.iter().sum::<f64>() / count);
        let (mut dd, mut dx, mut xx) = (0.0, 0.0, 0.0);
        for (d, x) in decay.iter().zip(values) {
            let (d, x) = (d - mean_d, x - mean_x);
            (dd, dx, xx) = (dd + d * d, dx + d * x, xx + x * x);
        }
        xx - dx * dx / dd <= step + 2.0 * libm::log(count) * noise * noise
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A signal with a repeatable noise of standard deviation 0.3.
    fn signal(level: impl Fn(usize) -> f64, count: usize) -> Vec<f64> {
        (0..count).map(|i| level(i) + 0.42 * libm::sin(37.0 * (i * i) as f64)).collect()
    }

    #[test]
    fn steps_are_located() {
        let values = signal(|i| if (40..90).contains(&i) { 2.0 } else { 0.0 }, 200);
        assert_eq!(change_points(&values, 0.3), [40, 90]);
        assert!(change_points(&signal(|_| 5.0, 200), 0.3).is_empty());
        assert!(change_points(&[], 0.3).is_empty());
    }

    #[test]
    fn windows_do_not_change_the_steps() {
        let values = signal(|i| f64::from(u32::from(i / 37 % 2 == 1)) * 5.0, 900);
        let whole = change_points(&values, 0.3);
        assert_eq!(whole, (1..25).map(|i| 37 * i).take_while(|i| *i < 900).collect::<Vec<_>>());
        for window in [100, 150, 333] {
            assert_eq!(changes_in_windows(&values, 0.3, window), whole, "{window}");
        }
        assert!(changes_in_windows(&signal(|_| 5.0, 900), 0.3, 100).is_empty());
    }

    #[test]
    fn relaxations_are_not_steps() {
        let decay = signal(|i| 2.0 * libm::exp(-(i as f64) / 50.0), 200);
        assert!(is_relaxation(&decay, 60, 0.3));
        let step = signal(|i| if i < 100 { 2.0 } else { 0.0 }, 200);
        assert!(!is_relaxation(&step, 100, 0.3));
    }
}
