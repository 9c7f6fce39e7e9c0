//! The sizes of the noise's parts, by restricted maximum likelihood (REML).
//!
//! Repetition noise is read off the spread inside each series and direction. What rows share is read off the means of
//! the series and directions, of which a table has hundreds at most: out of them everything explainable is projected,
//! and the update `theta <- theta r'P V_i P r / tr(P V_i)` is repeated, which keeps every variance positive (the MM
//! algorithm of Zhou, Hu, Zhou and Lange, J. Comput. Graph. Stat. 28, 2019, without its square root). A square counts
//! for at most nine times what is expected, so that a single bad series does not decide.

use nalgebra::{DMatrix, DVector};

use super::correlation;
use super::noise::{Noise, Spread};
use super::observations::Observations;
use super::projection::{Projection, dot};
use super::walk::Wandering;
use super::wandering::{walk_cost, wandering};
use super::weighed::Weighed;

/// Rounds of the update: parts far from their start need some tens.
const ROUNDS: usize = 24;
/// Shares of friction below which a scatter changes no decision.
const LEAST_SCALE: f64 = 2e-4;
/// Fewer means than this beyond what is projected out tell nothing of what series share.
const LEAST_DEGREES: f64 = 8.0;
/// Largest scatter of the friction from mount to mount that is called scatter: beyond it, something is wrong.
pub(super) const MOST_MOUNT_SCALE: f64 = 0.06;

/// A square beyond nine times its expectation counts as nine; the cap loses 2 % of a chi-square's mean.
fn capped(square: f64, expected: f64) -> f64 {
    1.02 * square.min(9.0 * expected)
}

/// The noise of residuals in newtons out of which everything explainable has been projected. `explainable` are columns
/// in newtons; without their removal a missing effect would inflate its own noise
/// (`model/doc/naming-an-effect.md`). The mounts' scatter is kept from the start.
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
    [Scatter::Groups, Scatter::Specimens]
        .iter()
        .fold(noise, |noise, labelled| labelled.estimated(data, residual_n, &[], noise))
}

/// The same with the repetition noise and the scatter that competes with effects as they are: what series share, beside
/// columns that were thought to be explained by more than noise.
pub(super) fn shared_again(
    data: &Observations,
    residual_n: &[f64],
    explainable: &[Vec<f64>],
    noise: Noise,
) -> Noise {
    let found = between(data, residual_n, explainable, noise).unwrap_or(noise);
    Noise { mount_scale: noise.mount_scale, walk: noise.walk, ..found }
}

/// The repetition noise, with the whitened residuals that it was read from.
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

/// Per block of means that belong to one series: `P` and `P r`.
pub(super) struct Block {
    pub(super) members: Vec<usize>,
    pub(super) p: DMatrix<f64>,
    pub(super) pr: DVector<f64>,
}

/// Blocks of the projected weight matrix over the means, exact within each series. `mounts` of the noise must be zero,
/// or series would be mixed.
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
    // Whitening mixes no two series: the j-th mean of every series is whitened in one go.
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

/// Directions of the parts that series share, in the order of [`sizes`]: the means' own offset at zero load and its
/// growth, one for each mean, then the series' offset, its growth, and its scale.
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

/// Variances of those parts.
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

/// What rows of a series share; `None` with too few series to tell.
fn between(data: &Observations, residual_n: &[f64], explainable: &[Vec<f64>], noise: Noise) -> Option<Noise> {
    let noise = Noise { mount_scale: 0.0, walk: Wandering::default(), ..noise };
    let means = data.cell_means(noise);
    let residual = means.mean_of(data, residual_n);
    let mut columns = means.means_of(data, explainable);
    // Operators, sessions and specimens are few: each has its own level here.
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
    // What cannot change a reading by a twentieth of its noise is nothing.
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

/// Variance of one mean given all parts, for counting degrees of freedom.
fn means_variance(means: &Observations, noise: Noise, block: &Block, a: &DVector<f64>) -> f64 {
    let Some(at) = (0..a.len()).find(|i| a[*i] != 0.0) else { return 0.0 };
    let row = block.members[at];
    let load = means.points[row].load_n;
    noise.repetition.at(load).powi(2) / means.weights[row]
        + noise.series.at(load).powi(2)
        + noise.series_common.at(load).powi(2)
        + (noise.series_scale * means.friction_n[row]).powi(2)
}

fn indicator(len: usize, rows: &[usize], value: impl Fn(usize) -> f64) -> Vec<f64> {
    let mut column = vec![0.0; len];
    rows.iter().for_each(|r| column[*r] = value(*r));
    column
}

/// A scatter that competes with effects, since few groups tell it: its effects are alike to its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Scatter {
    /// The friction of each mount.
    Mounts,
    /// Offsets that wander from series to series.
    Walk,
    /// The reading of each operator and of each session, where the table names them.
    Groups,
    /// The friction of each specimen, where the table names them.
    Specimens,
}

impl Scatter {
    /// Those that compete with effects. The others are known by the table's own labels.
    pub(super) const ALL: [Scatter; 2] = [Scatter::Mounts, Scatter::Walk];

    /// The noise with this scatter as it is in another one.
    pub(super) fn taken_from(self, other: Noise, noise: Noise) -> Noise {
        match self {
            Scatter::Mounts => Noise { mount_scale: other.mount_scale, ..noise },
            Scatter::Walk => Noise { walk: other.walk, ..noise },
            Scatter::Groups => Noise { group_offset_n: other.group_offset_n, ..noise },
            Scatter::Specimens => Noise { specimen_scale: other.specimen_scale, ..noise },
        }
    }

    /// The noise without this scatter.
    pub(super) fn left_out(self, noise: Noise) -> Noise {
        self.taken_from(Noise::constant(0.0, 0.0), noise)
    }

    /// The noise with this scatter as residuals in newtons show it beside what `own` columns can take over. Everything
    /// else of the noise stays.
    pub(super) fn estimated(
        self,
        data: &Observations,
        residual_n: &[f64],
        own: &[Vec<f64>],
        noise: Noise,
    ) -> Noise {
        let without = self.left_out(noise);
        if self == Scatter::Walk {
            return Noise { walk: wandering(data, residual_n, own, without), ..without };
        }
        self.in_noise(without, scatter_size(self, data, residual_n, own, without))
    }

    /// Those but the walk have one size.
    fn in_noise(self, noise: Noise, size: f64) -> Noise {
        match self {
            Scatter::Mounts => Noise { mount_scale: size, ..noise },
            Scatter::Walk => noise,
            Scatter::Groups => Noise { group_offset_n: size, ..noise },
            Scatter::Specimens => Noise { specimen_scale: size, ..noise },
        }
    }

    fn groups(self, data: &Observations) -> Vec<&Vec<usize>> {
        match self {
            Scatter::Mounts => data.mounts.iter().collect(),
            Scatter::Walk => Vec::new(),
            Scatter::Groups => data.operators.iter().chain(&data.sessions).collect(),
            Scatter::Specimens => data.specimens.iter().collect(),
        }
    }

    /// Groups without which nothing can be told of the scatter between them.
    fn least_groups(self) -> usize {
        match self {
            Scatter::Mounts => 3,
            Scatter::Walk => 0,
            Scatter::Groups | Scatter::Specimens => 2,
        }
    }

    /// What a row of a group does when the group is off by one, in newtons.
    fn direction_n(self, data: &Observations, row: usize) -> f64 {
        match self {
            Scatter::Mounts | Scatter::Specimens => data.friction_n[row],
            Scatter::Walk | Scatter::Groups => 1.0,
        }
    }

    /// Sizes: the least that changes a decision, one to start from, what is typical, the largest that is called scatter.
    fn scale(self) -> [f64; 4] {
        match self {
            Scatter::Mounts => [LEAST_SCALE, 0.02, 0.045, MOST_MOUNT_SCALE],
            Scatter::Walk => [0.0; 4],
            Scatter::Groups => [2e-3, 0.2, 0.5, 10.0],
            Scatter::Specimens => [LEAST_SCALE, 0.05, 0.1, 1.0],
        }
    }

    /// Minus twice the logarithm of how probable this scatter is before any data, a half-normal law of its size, up to a
    /// constant.
    pub(super) fn cost(self, noise: Noise, data: &Observations) -> f64 {
        let size = match self {
            Scatter::Mounts => noise.mount_scale,
            Scatter::Walk => return walk_cost(noise, data),
            Scatter::Groups => noise.group_offset_n,
            Scatter::Specimens => noise.specimen_scale,
        };
        (size / self.scale()[2]).powi(2)
    }
}

/// The size of a scatter by restricted maximum likelihood.
fn scatter_size(
    scatter: Scatter,
    data: &Observations,
    residual_n: &[f64],
    own: &[Vec<f64>],
    noise: Noise,
) -> f64 {
    let [least, start, _, most] = scatter.scale();
    let none = (0..data.points.len()).all(|r| scatter.direction_n(data, r) == 0.0);
    if scatter.groups(data).len() < scatter.least_groups() || none {
        return 0.0;
    }
    let means = data.cell_means(noise);
    let residual = means.mean_of(data, residual_n);
    let columns = means.means_of(data, own);
    let means = &means.observations;
    let groups: Vec<Vec<f64>> = scatter
        .groups(means)
        .iter()
        .map(|rows| indicator(residual.len(), rows, |r| scatter.direction_n(means, r)))
        .collect();
    let mut theta = start * start;
    for _ in 0..ROUNDS {
        let weighed = Weighed::new(means, scatter.in_noise(noise, theta.sqrt()));
        let projection = Projection::of_whitened(&columns, residual.len(), &weighed);
        let mut rest = residual.clone();
        weighed.whiten(&mut rest);
        projection.remove(&mut rest);
        let (mut found, mut expected) = (0.0, 0.0);
        let mut white = groups.clone();
        weighed.whiten_all(&mut white);
        for mut white in white {
            projection.remove(&mut white);
            let expect = dot(&white, &white);
            found += dot(&white, &rest).powi(2);
            expected += expect;
        }
        if expected <= 0.0 {
            return 0.0;
        }
        theta *= (found / expected).clamp(0.05, 20.0);
        if theta < least * least {
            return 0.0;
        }
    }
    theta.sqrt().min(most)
}
