//! Products of the columns of each series, in standard deviations of the noise of its rows.
//!
//! Rows `i` and `j` of a series at the loads `F` have the covariance
//!
//! ```text
//! V_ij = h_i h_j c^|i - j|  +  (o^2 + p^2 F_i F_j) [same direction]  +  o_s^2 + p_s^2 F_i F_j  +  s^2 g_i g_j
//! ```
//!
//! with the repetition noise `h` and its correlation `c`, the offset per series and direction
//! (`o`, `p`), the offset per series (`o_s`, `p_s`), the scale of friction per series `s`, and the
//! sensitivity `g` of a reading to friction ([`Noise`]). Rows of different series share the mount
//! and the specimen: random effects on friction with standard deviation `t`. With a column for one of
//! them, the products `M = X'V^-1 X` of all series that share it become `M - M_g M_g'/(M_gg + t^-2)`.

use std::collections::BTreeMap;

use nalgebra::{Cholesky, DMatrix};

use crate::model::{Model, Noise, Spread};
use crate::table::{PlateauRow, Point, groups};

/// Products of the columns of one series, friction last.
#[derive(Clone, Debug)]
pub(super) struct Series {
    products: DMatrix<f64>,
    mount: String,
    specimen: String,
}

/// Returns the series of a table in the order of their first rows, for columns of one number per
/// row. `None` if a number is not finite.
pub(super) fn white_series(
    model: &Model,
    noise: Noise,
    rows: &[PlateauRow],
    points: &[Point],
    columns: &[Vec<f64>],
) -> Option<Vec<Series>> {
    let (series_of, count) = groups(rows, |row| (row.labels.session.clone(), row.series.clone()));
    let mut members: Vec<Vec<usize>> = vec![Vec::new(); count];
    series_of.iter().enumerate().for_each(|(row, series)| members[*series].push(row));
    let friction = model.friction_n(points);
    let has_mounts = rows.iter().any(|row| !row.labels.mount.is_empty());
    let series = members.into_iter().map(|mut members| {
        members.sort_by(|a, b| rows[*a].time_s.total_cmp(&rows[*b].time_s));
        let white = |columns: &[&[f64]]| white_columns(noise, &members, points, columns);
        let own: Vec<&[f64]> = columns.iter().chain([&friction]).map(Vec::as_slice).collect();
        let shared = shared_columns(noise, points, &friction);
        let shared: Vec<&[f64]> = shared.iter().map(Vec::as_slice).collect();
        let (own, shared) = (white(&own), white(&shared));
        // Woodbury's identity: `V = R + U U'`.
        let cross = shared.tr_mul(&own);
        let capacity = DMatrix::identity(shared.ncols(), shared.ncols()) + shared.tr_mul(&shared);
        let products = own.tr_mul(&own) - cross.tr_mul(&Cholesky::new(capacity)?.solve(&cross));
        let row = &rows[*members.first()?];
        let labels = &row.labels;
        let mount = if has_mounts {
            format!("{}|{}", labels.session, labels.mount)
        } else {
            let condition = &model.frame.conditions[points[members[0]].condition];
            format!("{}|{}|{}", condition.name(), labels.session, labels.specimen)
        };
        let is_finite = products.iter().all(|x| x.is_finite());
        is_finite.then(|| Series { products, mount, specimen: labels.specimen.clone() })
    });
    series.collect()
}

/// Returns the information of each series alone, in a mount of its own.
pub(super) fn separate(series: &[Series], noise: Noise) -> Vec<DMatrix<f64>> {
    series.iter().map(|one| without_friction(&integrated(&one.products, noise.mount_scale))).collect()
}

/// Returns the information of all series together.
pub(super) fn together(series: &[Series], noise: Noise) -> DMatrix<f64> {
    let size = series.first().map_or(1, |one| one.products.nrows());
    let zeros = || DMatrix::zeros(size, size);
    let mut specimens: BTreeMap<&str, BTreeMap<&str, DMatrix<f64>>> = BTreeMap::new();
    for one in series {
        let mounts = specimens.entry(&one.specimen).or_default();
        *mounts.entry(&one.mount).or_insert_with(zeros) += &one.products;
    }
    let mut all = zeros();
    for mounts in specimens.into_values() {
        let mounts = mounts.into_values().map(|products| integrated(&products, noise.mount_scale));
        all += integrated(&mounts.fold(zeros(), |sum, one| sum + one), noise.specimen_scale);
    }
    without_friction(&all)
}

/// Integrates a random effect on friction, the last column, with this standard deviation. The column
/// remains, for effects that more series share.
fn integrated(products: &DMatrix<f64>, sd: f64) -> DMatrix<f64> {
    if sd <= 0.0 {
        return products.clone();
    }
    let last = products.ncols() - 1;
    let column = products.column(last).into_owned();
    products - &column * column.transpose() / (column[last] + sd.powi(-2))
}

fn without_friction(products: &DMatrix<f64>) -> DMatrix<f64> {
    let n = products.ncols() - 1;
    products.view((0, 0), (n, n)).into_owned()
}

/// Returns the columns of the offsets that the rows of a series share, and of its scale of friction, in newtons.
fn shared_columns(noise: Noise, points: &[Point], friction: &[f64]) -> Vec<Vec<f64>> {
    let of_points = |value: &dyn Fn(&Point) -> f64| points.iter().map(value).collect::<Vec<f64>>();
    let offsets = |spread: Spread, is_in: &dyn Fn(&Point) -> bool| {
        let inside = |point: &Point, value: f64| if is_in(point) { value } else { 0.0 };
        [
            of_points(&|point| inside(point, spread.constant_n)),
            of_points(&|point| inside(point, spread.per_load * point.load_n)),
        ]
    };
    let mut columns = Vec::new();
    columns.extend(offsets(noise.series, &|point| point.sign < 0.0));
    columns.extend(offsets(noise.series, &|point| point.sign >= 0.0));
    columns.extend(offsets(noise.series_common, &|_| true));
    columns.push(friction.iter().map(|g| noise.series_scale * g).collect());
    columns
}

/// Returns columns at the members of a series, in order, in standard deviations of the repetition noise: what a reading has
/// in addition to the one before, with which it correlates.
fn white_columns(noise: Noise, members: &[usize], points: &[Point], columns: &[&[f64]]) -> DMatrix<f64> {
    let sd: Vec<f64> = members.iter().map(|row| noise.repetition.at(points[*row].load_n)).collect();
    let innovation = (1.0 - noise.correlation.powi(2)).sqrt();
    DMatrix::from_fn(members.len(), columns.len(), |i, j| {
        let at = |i: usize| columns[j][members[i]] / sd[i];
        if i == 0 { at(0) } else { (at(i) - noise.correlation * at(i - 1)) / innovation }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::table::Frame;
    use crate::test_session::session;

    fn covariance(noise: Noise, block: &[usize], points: &[Point], friction: &[f64]) -> DMatrix<f64> {
        DMatrix::from_fn(block.len(), block.len(), |i, j| {
            let (a, b) = (&points[block[i]], &points[block[j]]);
            let offset = |part: Spread| part.constant_n.powi(2) + part.per_load.powi(2) * a.load_n * b.load_n;
            let correlation = noise.correlation.powi(i32::try_from(i.abs_diff(j)).unwrap_or(i32::MAX));
            let repetition = noise.repetition.at(a.load_n) * noise.repetition.at(b.load_n);
            let same_direction = if a.sign == b.sign { offset(noise.series) } else { 0.0 };
            repetition * correlation
                + same_direction
                + offset(noise.series_common)
                + noise.series_scale.powi(2) * friction[block[i]] * friction[block[j]]
        })
    }

    /// The products of columns agree with the covariance of all rows, inverted as a whole.
    #[test]
    fn products_agree_with_the_whole_covariance() {
        let mut rows: Vec<PlateauRow> = session(1).into_iter().take(72).collect();
        for row in &mut rows {
            let series: usize = row.series.parse().unwrap();
            row.labels.mount = (series / 2).to_string();
            row.labels.specimen = (series / 3).to_string();
        }
        // Two mounts of one specimen, and one mount of another.
        rows.retain(|row| row.series != "2");
        let model = Model::baseline(Frame::new(&rows));
        let points = model.frame.points(&rows).unwrap();
        let noise = Noise {
            correlation: 0.3,
            series_common: Spread { constant_n: 0.04, per_load: 0.0 },
            series_scale: 0.01,
            mount_scale: 0.02,
            specimen_scale: 0.05,
            ..Noise::constant(0.05, 0.03)
        };
        let columns: Vec<Vec<f64>> =
            vec![points.iter().map(|p| p.load_n).collect(), points.iter().map(|p| p.sign).collect()];
        let series = white_series(&model, noise, &rows, &points, &columns).unwrap();
        let friction = model.friction_n(&points);
        let rows_of = |name: &str| (0..rows.len()).filter(|i| rows[*i].series == name).collect::<Vec<_>>();
        let mut all = DMatrix::zeros(rows.len(), rows.len());
        for name in ["0", "1", "3"] {
            let block = rows_of(name);
            let part = covariance(noise, &block, &points, &friction);
            for (i, a) in block.iter().enumerate() {
                block.iter().enumerate().for_each(|(j, b)| all[(*a, *b)] = part[(i, j)]);
            }
        }
        for i in 0..rows.len() {
            for j in 0..rows.len() {
                let shared = |of: fn(&PlateauRow) -> &String, sd: f64| {
                    if of(&rows[i]) == of(&rows[j]) { sd * sd } else { 0.0 }
                };
                let scale = shared(|row| &row.labels.mount, 0.02) + shared(|row| &row.labels.specimen, 0.05);
                all[(i, j)] += scale * friction[i] * friction[j];
            }
        }
        let x = DMatrix::from_fn(rows.len(), 2, |i, j| columns[j][i]);
        let expected = x.transpose() * Cholesky::new(all).unwrap().solve(&x);
        let found = together(&series, noise);
        assert!((&found - &expected).amax() < 1e-6 * expected.amax(), "{found} {expected}");
        // Alone, a series has a mount of its own.
        let alone = &separate(&series, noise)[2];
        assert!((alone - together(&series[2..], Noise { specimen_scale: 0.0, ..noise })).amax() < 1e-9);
    }
}
