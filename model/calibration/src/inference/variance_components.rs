//! Variance components by restricted maximum likelihood (REML).
//!
//! Repetition noise is estimated from the spread within each series and direction. Components that
//! rows share are estimated from the means of the series and directions (hundreds at most):
//! everything explainable is projected out, and the update `theta <- theta r'P V_i P r / tr(P V_i)`
//! is iterated, which keeps every variance positive (the MM algorithm of Zhou, Hu, Zhou and Lange,
//! J. Comput. Graph. Stat. 28, 2019, without its square root). A square counts for at most nine
//! times its expectation, so that a single bad series does not dominate.

use nalgebra::{DMatrix, DVector};

use super::correlation;
use super::noise::{Noise, Spread};
use super::observations::Observations;
use super::projection::Projection;
use super::scatter::Scatter;
use super::walk::Wandering;
use super::weighed::Weighed;

/// Number of iterations: components far from their start need some tens.
pub(super) const ROUNDS: usize = 24;
/// Smallest relevant random effect of friction, as a share.
pub(super) const LEAST_SCALE: f64 = 2e-4;
/// Fewest means beyond the projected columns for an estimate.
const LEAST_DEGREES: f64 = 8.0;
/// Caps a square at nine times its expectation; the cap reduces the mean of a chi-square variate by
/// 2 %.
fn capped(square: f64, expected: f64) -> f64 {
    1.02 * square.min(9.0 * expected)
}

/// Estimates the noise from residuals in newtons. The `explainable` columns in newtons are
/// projected out, since a missing effect would otherwise inflate the noise
/// (`model/doc/naming-an-effect.md`). The mount effect of the start is kept.
pub(super) fn estimate(
    data: &Observations,
    residual_n: &[f64],
    explainable: &[Vec<f64>],
    start: Noise,
) -> Noise {
    let mut noise = Noise { correlation: 0.0, ..start };
    let (repetition, white) = inside(data, residual_n, explainable, noise);
    noise.repetition = repetition;
    noise.correlation = correlation::estimate(data, &white);
    if noise.correlation > 0.0 {
        noise.repetition = inside(data, residual_n, explainable, noise).0;
    }
    let noise = between(data, residual_n, explainable, noise).unwrap_or(noise);
    [Scatter::Groups, Scatter::Specimens].iter().fold(noise, |noise, labelled| {
        // A common value of all groups is not scatter between them: an offset that recurs in every
        // session is that of the load cell.
        let common = (0..data.points.len()).map(|row| labelled.direction_n(data, row)).collect();
        labelled.estimated(data, residual_n, &[common], noise)
    })
}

/// The same with fixed repetition noise and competing random effects: only the components that
/// series share are estimated.
pub(super) fn shared_again(
    data: &Observations,
    residual_n: &[f64],
    explainable: &[Vec<f64>],
    noise: Noise,
) -> Noise {
    let found = between(data, residual_n, explainable, noise).unwrap_or(noise);
    Noise { mount_scale: noise.mount_scale, walk: noise.walk, ..found }
}

/// Estimates the repetition noise; also returns the whitened residuals.
fn inside(
    data: &Observations,
    residual_n: &[f64],
    explainable: &[Vec<f64>],
    noise: Noise,
) -> (Spread, Vec<f64>) {
    let mut noise = noise;
    let mut last = Vec::new();
    for _ in 0..2 {
        let weighed = Weighed::new(data, noise);
        let projection = Projection::of_whitened(explainable, residual_n.len(), &weighed);
        let mut white = residual_n.to_vec();
        weighed.whiten(&mut white);
        projection.remove(&mut white);
        let mut squares = Vec::new();
        let mut one = vec![1.0; residual_n.len()];
        Weighed::new(data, Noise { correlation: noise.correlation, ..only_repetition(noise) })
            .whiten(&mut one);
        for (cell, load) in data.cells.iter().zip(&data.cell_load_n) {
            if cell.len() < 2 || cell.first().is_some_and(|r| data.is_excluded(*r)) {
                continue;
            }
            let root = cell.iter().map(|r| one[*r] * one[*r]).sum::<f64>().sqrt();
            let rest = |v: &[f64]| {
                let along = cell.iter().map(|r| v[*r] * one[*r]).sum::<f64>() / root;
                (cell.iter().map(|r| v[*r] * v[*r]).sum::<f64>() - along * along).max(0.0)
            };
            let lost: f64 = projection.basis().iter().map(|axis| rest(axis)).sum();
            let degrees = cell.len() as f64 - 1.0 - lost;
            if degrees > 0.5 {
                let variance = noise.repetition.at(*load).powi(2);
                squares.push((*load, variance * rest(&white) / degrees, 0.0, degrees));
            }
        }
        if squares.len() > 3 {
            noise.repetition = Spread::estimate(&squares, 1e-6);
        }
        last = white;
    }
    (noise.repetition, last)
}

fn only_repetition(noise: Noise) -> Noise {
    Noise { repetition: noise.repetition, correlation: noise.correlation, ..Noise::constant(0.0, 0.0) }
}

/// Block of means of one series: `P` and `P r`.
pub(super) struct Block {
    pub(super) members: Vec<usize>,
    pub(super) p: DMatrix<f64>,
    pub(super) pr: DVector<f64>,
}

/// Returns blocks of the projected weight matrix over the means, exact within each series. `mounts`
/// of the noise must be zero, or series would be mixed.
pub(super) fn blocks(
    means: &Observations,
    noise: Noise,
    residual: &[f64],
    columns: &[Vec<f64>],
) -> Vec<Block> {
    let weighed = Weighed::new(means, noise);
    let projection = Projection::of_whitened(columns, residual.len(), &weighed);
    let mut white = residual.to_vec();
    weighed.whiten(&mut white);
    projection.remove(&mut white);
    let most = means.series_rows.iter().map(Vec::len).max().unwrap_or(0);
    // Whitening does not mix series, so the j-th mean of every series is whitened in one pass.
    let units: Vec<Vec<f64>> = (0..most)
        .map(|j| {
            let mut unit = vec![0.0; residual.len()];
            means.series_rows.iter().filter_map(|rows| rows.get(j)).for_each(|r| unit[*r] = 1.0);
            weighed.whiten(&mut unit);
            unit
        })
        .collect();
    means
        .series_rows
        .iter()
        .filter(|rows| rows.first().is_some_and(|r| !means.is_excluded(*r)))
        .map(|rows| {
            let k = rows.len();
            let w = DMatrix::from_fn(k, k, |i, j| units[j][rows[i]]);
            let mut inner = DMatrix::identity(k, k);
            for axis in projection.basis() {
                let q = DVector::from_fn(k, |i, _| axis[rows[i]]);
                inner -= &q * q.transpose();
            }
            let rest = DVector::from_fn(k, |i, _| white[rows[i]]);
            Block { members: rows.clone(), p: w.transpose() * inner * &w, pr: w.transpose() * rest }
        })
        .collect()
}

/// Returns the directions of the components that series share, in the order of [`sizes`]: the
/// means' own offset at zero load and its growth, one for each mean, then the series' offset, its
/// growth, and its scale.
pub(super) fn directions(means: &Observations, block: &Block) -> [Vec<DVector<f64>>; 5] {
    let k = block.members.len();
    let load = |i: usize| means.points[block.members[i]].load_n;
    let single = |i: usize, value: f64| DVector::from_fn(k, |j, _| if i == j { value } else { 0.0 });
    [
        (0..k).map(|i| single(i, 1.0)).collect(),
        (0..k).map(|i| single(i, load(i))).collect(),
        vec![DVector::from_element(k, 1.0)],
        vec![DVector::from_fn(k, |i, _| load(i))],
        vec![DVector::from_fn(k, |i, _| means.friction_n[block.members[i]])],
    ]
}

/// Returns the variances of those components.
pub(super) fn sizes(noise: Noise) -> [f64; 5] {
    [
        noise.series.constant_n.powi(2),
        noise.series.per_load.powi(2),
        noise.series_common.constant_n.powi(2),
        noise.series_common.per_load.powi(2),
        noise.series_scale.powi(2),
    ]
}

fn with_sizes(noise: Noise, sizes: [f64; 5]) -> Noise {
    let [constant, per_load, common, common_per_load, scale] = sizes.map(f64::sqrt);
    Noise {
        series: Spread { constant_n: constant, per_load },
        series_common: Spread { constant_n: common, per_load: common_per_load },
        series_scale: scale,
        ..noise
    }
}

/// Estimates the components that rows of a series share; `None` with too few series.
fn between(data: &Observations, residual_n: &[f64], explainable: &[Vec<f64>], noise: Noise) -> Option<Noise> {
    let noise = Noise { mount_scale: 0.0, walk: Wandering::default(), ..noise };
    let means = data.cell_means(noise);
    let residual = means.mean_of(data, residual_n);
    let mut columns = means.means_of(data, explainable);
    // Operators, sessions and specimens are few, so each has its own level here.
    for groups in [&means.observations.operators, &means.observations.sessions] {
        columns.extend(groups.iter().map(|g| indicator(residual.len(), g, |_| 1.0)));
    }
    let friction = &means.observations.friction_n;
    columns
        .extend(means.observations.specimens.iter().map(|g| indicator(residual.len(), g, |r| friction[r])));
    let means = &means.observations;
    let has_friction = friction.iter().any(|u| *u != 0.0);
    let least = (0.05 * noise.repetition.constant_n).powi(2).max(1e-12);
    let typical = (0.3 * noise.repetition.at(20.0)).powi(2).max(4.0 * least);
    let mut theta = [typical, 1e-6, typical, 1e-6, if has_friction { 1e-4 } else { 0.0 }];
    for round in 0..ROUNDS {
        let blocks = blocks(
            means,
            Noise { group_offset_n: 0.0, specimen_scale: 0.0, ..with_sizes(noise, theta) },
            &residual,
            &columns,
        );
        let (mut found, mut expected) = ([0.0; 5], [0.0; 5]);
        let mut degrees = 0.0;
        for block in &blocks {
            for (i, of_part) in directions(means, block).iter().enumerate() {
                for a in of_part {
                    let expect = (&block.p * a).dot(a).max(0.0);
                    found[i] += capped(a.dot(&block.pr).powi(2), expect);
                    expected[i] += expect;
                    if i == 0 {
                        let v = means_variance(means, with_sizes(noise, theta), block, a);
                        degrees += expect * v;
                    }
                }
            }
        }
        if round == 0 && degrees < LEAST_DEGREES {
            return None;
        }
        for i in 0..5 {
            if expected[i] > 0.0 {
                theta[i] *= (found[i] / expected[i]).clamp(0.05, 20.0);
            }
        }
        theta[0] = theta[0].max(least);
    }
    // A component that changes a reading by less than 5 % of its noise is dropped.
    let mut found = with_sizes(noise, theta);
    if found.series_scale < LEAST_SCALE {
        found.series_scale = 0.0;
    }
    let seen = 0.05 * noise.repetition.at(data.mean_load_n());
    for spread in [&mut found.series, &mut found.series_common] {
        if spread.per_load * data.mean_load_n() < seen {
            spread.per_load = 0.0;
        }
    }
    if found.series_common.constant_n < seen {
        found.series_common.constant_n = 0.0;
    }
    Some(found)
}

/// Returns the variance of one mean given all components, for counting degrees of freedom.
fn means_variance(means: &Observations, noise: Noise, block: &Block, a: &DVector<f64>) -> f64 {
    let Some(at) = (0..a.len()).find(|i| a[*i] != 0.0) else { return 0.0 };
    let row = block.members[at];
    let load = means.points[row].load_n;
    noise.repetition.at(load).powi(2) / means.weights[row]
        + noise.series.at(load).powi(2)
        + noise.series_common.at(load).powi(2)
        + (noise.series_scale * means.friction_n[row]).powi(2)
}

pub(super) fn indicator(len: usize, rows: &[usize], value: impl Fn(usize) -> f64) -> Vec<f64> {
    let mut column = vec![0.0; len];
    rows.iter().for_each(|r| column[*r] = value(*r));
    column
}
