//! Down-weighting of readings that differ from their neighbours, so that single errors have no
//! influence.

use pinswitch_friction::sort_by_number;

use super::observations::{MIN_WEIGHT, Observations};
use crate::median::median;
use crate::table::Point;

/// Neighbours on either side with which a reading is compared.
const NEIGHBOURS: usize = 3;
/// Standard deviations above which a reading is down-weighted.
const STANDS_OUT: f64 = 3.2;
/// Fewest series of one condition to determine their common trend.
const LEAST_SERIES: usize = 5;

impl Observations {
    /// Down-weights rows whose residual differs from its neighbours in the same series and
    /// direction. Returns the standard deviation of a reading about its neighbours, in newtons.
    ///
    /// The running median of the neighbours follows any smooth trend, and the common deviation of
    /// all series of a condition at one repetition is not that of a single reading: neither counts
    /// as an outlier.
    pub fn weigh_outliers(&mut self, residual_n: &[f64]) -> f64 {
        let mut local = vec![0.0; residual_n.len()];
        for cell in &self.cells {
            for (i, row) in cell.iter().enumerate() {
                let (from, to) = (i.saturating_sub(NEIGHBOURS), (i + NEIGHBOURS + 1).min(cell.len()));
                let mut near: Vec<f64> = cell[from..to].iter().map(|r| residual_n[*r]).collect();
                local[*row] = residual_n[*row] - median(&mut near);
            }
        }
        // The spread may increase with load: medians over quarters of the loads, without the zeros
        // of the row itself.
        let spread = |local: &[f64], keep: &dyn Fn(f64) -> bool| {
            let mut size: Vec<f64> = local
                .iter()
                .zip(&self.points)
                .filter(|(v, p)| **v != 0.0 && keep(p.load_n))
                .map(|(v, _)| v.abs())
                .collect();
            (size.len() > 20).then(|| 1.4826 * median(&mut size) / 1.08)
        };
        let sd = spread(&local, &|_| true).unwrap_or(0.0).max(1e-9);
        let mut loads: Vec<f64> = self.points.iter().map(|p| p.load_n).collect();
        loads.sort_by(f64::total_cmp);
        let quarter = |i: usize| loads.get(i * loads.len() / 4).copied().unwrap_or(f64::INFINITY);
        let edges = [quarter(1), quarter(2), quarter(3)];
        let part = |load: f64| edges.iter().filter(|e| load >= **e).count();
        let parts: Vec<f64> =
            (0..4).map(|i| spread(&local, &|load| part(load) == i).unwrap_or(sd).max(0.3 * sd)).collect();
        let common = common_course(&self.points, &local);
        for (row, weight) in self.weights.iter_mut().enumerate() {
            let of_itself = local[row].abs().min((local[row] - common[row]).abs());
            let z = of_itself / parts[part(self.points[row].load_n)];
            *weight = self.counts[row]
                * if z <= STANDS_OUT { 1.0 } else { (STANDS_OUT / z).powi(3).max(MIN_WEIGHT) };
        }
        self.roots = self.weights.iter().map(|w| w.sqrt()).collect();
        self.apply_exclusions();
        sd
    }
}

/// Returns the common trend of the series of a condition at one repetition of one direction: a line
/// over the load, through medians.
fn common_course(points: &[Point], local: &[f64]) -> Vec<f64> {
    let mut groups = std::collections::BTreeMap::<_, Vec<usize>>::new();
    for (row, p) in points.iter().enumerate() {
        groups.entry((p.condition, p.sign > 0.0, p.repetition as u32)).or_default().push(row);
    }
    let mut common = vec![0.0; local.len()];
    for mut rows in groups.into_values().filter(|rows| rows.len() >= LEAST_SERIES) {
        sort_by_number(&mut rows, |row| points[*row].load_n);
        let (slope, at_zero) = robust_line(&rows, |row| (points[row].load_n, local[row]));
        rows.iter().for_each(|row| common[*row] = at_zero + slope * points[*row].load_n);
    }
    common
}

/// Returns slope and intercept of the line through `at`, for rows ascending in `x`: the median of
/// the slopes between the lower and the upper half (H. Theil, Proc. Kon. Ned. Akad. v. Wetensch. A
/// 53, 1950, the incomplete method), and the median of the residuals.
fn robust_line(rows: &[usize], at: impl Fn(usize) -> (f64, f64)) -> (f64, f64) {
    let half = rows.len().div_ceil(2);
    let mut slopes: Vec<f64> = rows
        .iter()
        .zip(&rows[half..])
        .map(|(low, high)| (at(*low), at(*high)))
        .filter(|(low, high)| high.0 > low.0)
        .map(|(low, high)| (high.1 - low.1) / (high.0 - low.0))
        .collect();
    let slope = if slopes.is_empty() { 0.0 } else { median(&mut slopes) };
    let mut rest: Vec<f64> = rows.iter().map(|row| at(*row)).map(|(x, y)| y - slope * x).collect();
    (slope, median(&mut rest))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::table::Frame;
    use crate::test_session::session;

    fn weights(change: impl Fn(usize, &crate::table::PlateauRow) -> f64) -> (Observations, Vec<f64>) {
        let rows = session(3);
        let mut data = Observations::new(&Frame::new(&rows), &rows).unwrap();
        let residual: Vec<f64> = (0..rows.len())
            .map(|i| 0.05 * libm::sin(12.9898 * i as f64 + 78.2 * libm::cos(i as f64)) + change(i, &rows[i]))
            .collect();
        data.weigh_outliers(&residual);
        let weights = data.weights.clone();
        (data, weights)
    }

    #[test]
    fn only_single_errors_are_down_weighted() {
        let (_, slipped) = weights(|i, _| if i == 100 { 2.0 } else { 0.0 });
        assert!(slipped[100] < 0.01 && slipped.iter().filter(|w| **w < 0.5).count() <= 3);
        // A worn spot of the tendon: one repetition of every series, in proportion to the load.
        let (data, spot) = weights(|_, r| if r.repetition == 9 { 0.04 * r.load_n } else { 0.0 });
        let at = |i: &usize| data.points[*i].repetition == 9.0;
        let down = (0..spot.len()).filter(at).filter(|i| spot[*i] < 0.5).count();
        assert!(down * 20 < (0..spot.len()).filter(at).count(), "{down}");
        let (_, both) = weights(|i, r| {
            f64::from(u8::from(i == 100)) * 2.0 + if r.repetition == 9 { 0.04 * r.load_n } else { 0.0 }
        });
        assert!(both[100] < 0.01);
    }

    #[test]
    fn lines_are_robust_against_outliers() {
        let y = |x: f64| if x == 3.0 || x == 8.0 { 100.0 } else { 1.0 + 0.5 * x };
        let (slope, at_zero) = robust_line(&(0..12).collect::<Vec<_>>(), |i| (i as f64, y(i as f64)));
        assert!((slope - 0.5).abs() < 1e-12 && (at_zero - 1.0).abs() < 1e-12, "{slope} {at_zero}");
        assert_eq!(robust_line(&[0, 1, 2], |i| (1.0, i as f64)), (0.0, 1.0));
    }
}
