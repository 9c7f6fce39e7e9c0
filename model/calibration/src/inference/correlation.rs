//! Correlation of consecutive repetitions: AR(1) in each series and direction.

use nalgebra::DMatrix;

use super::Observations;

/// Smallest correlation that matters; estimates of uncorrelated noise are smaller.
const MIN: f64 = 0.05;
/// Shortest chain for the estimate, since mean and trend are removed from each.
const MIN_LENGTH: usize = 5;
/// Largest correlation considered.
const MAX: f64 = 0.95;

/// Whitens the rows of one cell in place, given at unit variance, by subtracting the prediction
/// from the previous row. A lost repetition leaves a gap, over which the correlation is `rho^gap`.
pub(super) fn unchain<const N: usize>(
    rho: f64,
    data: &Observations,
    cell: &[usize],
    values: &mut [[f64; N]],
) {
    let rest = |phi: f64| (1.0 - phi * phi).sqrt().recip();
    let next = (rho, rest(rho));
    for i in (1..cell.len()).rev() {
        let gap = gap(data, cell, i);
        // Gaps are rare, and this is called for every column of every fit.
        let (phi, scale) = if gap == 1.0 { next } else { (libm::pow(rho, gap), rest(libm::pow(rho, gap))) };
        let before = values[cell[i - 1]];
        values[cell[i]].iter_mut().zip(before).for_each(|(v, b)| *v = (*v - phi * b) * scale);
    }
}

/// Returns `ln det` of the covariance that [`unchain`] whitens, relative to uncorrelated rows. A
/// row counts as its number of readings.
pub(super) fn chain_log_det(rho: f64, data: &Observations) -> f64 {
    let own = |cell: &[usize], i: usize| {
        let phi = libm::pow(rho, gap(data, cell, i));
        data.weights[cell[i]] * libm::log1p(-phi * phi)
    };
    data.cells.iter().flat_map(|cell| (1..cell.len()).map(move |i| own(cell, i))).sum()
}

fn gap(data: &Observations, cell: &[usize], i: usize) -> f64 {
    (data.points[cell[i]].repetition - data.points[cell[i - 1]].repetition).max(1.0)
}

/// Estimates the correlation of consecutive repetitions from residuals at unit variance in the
/// order of the rows.
///
/// A deviation at one place of the stroke that all series share is not noise: per condition,
/// direction and repetition, a line over the load is fitted across the series and removed, which
/// preserves the correlation along each. Then mean and trend of each series and direction are
/// removed, for offsets and slow drifts; the bias of this step is corrected exactly.
pub(super) fn estimate(data: &Observations, white: &[f64]) -> f64 {
    let values = without_common_course(data, white);
    let (mut product, mut square) = (0.0, 0.0);
    let mut lengths = std::collections::BTreeMap::new();
    for cell in &data.cells {
        let whole = (1..cell.len()).all(|i| gap(data, cell, i) == 1.0);
        let sound = cell.iter().all(|r| data.weights[*r] == data.counts[*r]);
        if cell.len() < MIN_LENGTH || !whole || !sound {
            continue;
        }
        let along: Vec<f64> = cell.iter().map(|r| values[*r]).collect();
        let rest = without_line(&along, &(0..cell.len()).map(|i| i as f64).collect::<Vec<_>>());
        product += rest.windows(2).map(|w| w[0] * w[1]).sum::<f64>();
        square += rest.iter().map(|v| v * v).sum::<f64>();
        *lengths.entry(cell.len()).or_insert(0.0) += 1.0;
    }
    let rows: f64 = lengths.iter().map(|(n, count)| *n as f64 * count).sum();
    if square <= 0.0 || rows < 100.0 {
        return 0.0;
    }
    // The expected ratio increases with rho: bisection.
    let (mut low, mut high) = (0.0, MAX);
    if expected_ratio(&lengths, low) >= product / square {
        return 0.0;
    }
    for _ in 0..20 {
        let middle = 0.5 * (low + high);
        if expected_ratio(&lengths, middle) < product / square { low = middle } else { high = middle }
    }
    if low > MIN.max(3.0 / rows.sqrt()) { low } else { 0.0 }
}

/// Returns the ratio of lag-one product to sum of squares for chains of these lengths after removal
/// of mean and trend: `tr(L M R M)/tr(M R)`.
fn expected_ratio(lengths: &std::collections::BTreeMap<usize, f64>, rho: f64) -> f64 {
    let (mut product, mut square) = (0.0, 0.0);
    for (n, count) in lengths {
        let lines: Vec<Vec<f64>> = (0..*n)
            .map(|i| {
                let mut unit = vec![0.0; *n];
                unit[i] = 1.0;
                without_line(&unit, &(0..*n).map(|i| i as f64).collect::<Vec<_>>())
            })
            .collect();
        let m = DMatrix::from_fn(*n, *n, |i, j| lines[j][i]);
        let r = DMatrix::from_fn(*n, *n, |i, j| rho.powi(i.abs_diff(j) as i32));
        let left = &m * r * &m;
        product += count * (1..*n).map(|i| left[(i, i - 1)]).sum::<f64>();
        square += count * left.trace();
    }
    product / square
}

/// Removes a line over the load from each condition, direction and repetition.
fn without_common_course(data: &Observations, white: &[f64]) -> Vec<f64> {
    let mut groups = std::collections::BTreeMap::<_, Vec<usize>>::new();
    for (row, p) in data.points.iter().enumerate().filter(|(row, _)| data.weights[*row] == data.counts[*row])
    {
        groups.entry((p.condition, p.sign > 0.0, p.repetition as u32)).or_default().push(row);
    }
    let mut out = white.to_vec();
    for rows in groups.values().filter(|rows| rows.len() >= 4) {
        let values: Vec<f64> = rows.iter().map(|r| white[*r]).collect();
        let loads: Vec<f64> = rows.iter().map(|r| data.points[*r].load_n).collect();
        for (row, rest) in rows.iter().zip(without_line(&values, &loads)) {
            out[*row] = rest;
        }
    }
    out
}

/// Returns the residuals of a straight line over `at`.
fn without_line(values: &[f64], at: &[f64]) -> Vec<f64> {
    let n = values.len() as f64;
    let (mean, middle) = (values.iter().sum::<f64>() / n, at.iter().sum::<f64>() / n);
    let spread: f64 = at.iter().map(|x| (x - middle).powi(2)).sum();
    let along: f64 = values.iter().zip(at).map(|(v, x)| v * (x - middle)).sum();
    let slope = if spread > 0.0 { along / spread } else { 0.0 };
    values.iter().zip(at).map(|(v, x)| v - mean - slope * (x - middle)).collect()
}
