//! Lack of fit: whether repeated readings are as close to the model as to each other.
//!
//! Residuals are grouped by each covariate, and the variance between the groups is compared with the
//! pure error within them (Fisher's F test, with Bonferroni's correction over the covariates). Within a
//! series the groups are repetitions and positions, after the offset of the series and direction;
//! between series, the mean residuals of series and directions are grouped by load, condition, speed,
//! dwell and sweep.

use std::collections::BTreeMap;

use statrs::distribution::{ContinuousCDF, FisherSnedecor};

use crate::table::Point;

/// Probability that a table without lack of fit fails the test.
const LEVEL: f64 = 0.01;

/// A residual with its covariates.
pub(crate) struct Residual<'a> {
    /// Covariates of the reading.
    pub(crate) point: &'a Point,
    /// Number of the series.
    pub(crate) series: usize,
    /// Reading minus model in newtons.
    pub(crate) residual_n: f64,
}

/// Key of a group.
type Key = [i64; 2];

/// Returns whether the lack of fit is within the pure error; true if no readings are repeated.
pub(crate) fn is_adequate(residuals: &[Residual<'_>]) -> bool {
    let mut cells: BTreeMap<(usize, bool), Vec<&Residual<'_>>> = BTreeMap::new();
    for residual in residuals {
        cells.entry((residual.series, residual.point.sign > 0.0)).or_default().push(residual);
    }
    let mean = |cell: &[&Residual<'_>]| cell.iter().map(|r| r.residual_n).sum::<f64>() / cell.len() as f64;
    let within: Vec<(&Point, f64)> =
        cells.values().flat_map(|cell| cell.iter().map(|r| (r.point, r.residual_n - mean(cell)))).collect();
    let between: Vec<(&Point, f64)> =
        cells.values().filter_map(|cell| Some((cell.first()?.point, mean(cell)))).collect();
    let side = |p: &Point| i64::from(p.sign > 0.0);
    let tests = [
        p_value(&within, |p| [rounded(p.repetition), side(p)], cells.len()),
        p_value(&within, |p| [rounded(p.position), side(p)], cells.len()),
        p_value(&between, |p| [rounded(p.load_n), side(p)], 0),
        p_value(&between, |p| [rounded(p.condition as f64), side(p)], 0),
        p_value(&between, |p| [rounded(p.log_speed), side(p)], 0),
        p_value(&between, |p| [rounded(p.log_dwell), side(p)], 0),
        p_value(&between, |p| [rounded(p.descending), side(p)], 0),
    ];
    let tests: Vec<f64> = tests.into_iter().flatten().collect();
    tests.iter().all(|p| p * tests.len() as f64 > LEVEL)
}

/// Returns a covariate to a thousandth.
fn rounded(value: f64) -> i64 {
    #[expect(clippy::cast_possible_truncation, reason = "covariates of a checked table are small")]
    let thousandths = (1e3 * value).round() as i64;
    thousandths
}

/// Returns the probability of a variance between groups as large by chance, where `removed` means have
/// been removed from the values; `None` if fewer than two groups have repeated values.
fn p_value(values: &[(&Point, f64)], key: impl Fn(&Point) -> Key, removed: usize) -> Option<f64> {
    let mut groups: BTreeMap<Key, Vec<f64>> = BTreeMap::new();
    for (point, value) in values {
        groups.entry(key(point)).or_default().push(*value);
    }
    groups.retain(|_, group| group.len() > 1);
    let count: usize = groups.values().map(Vec::len).sum();
    let all = groups.values().flatten().sum::<f64>() / count.max(1) as f64;
    let (mut fit, mut pure) = (0.0, 0.0);
    for group in groups.values() {
        let mean = group.iter().sum::<f64>() / group.len() as f64;
        fit += group.len() as f64 * (mean - all).powi(2);
        pure += group.iter().map(|v| (v - mean).powi(2)).sum::<f64>();
    }
    let between = groups.len().checked_sub(1).filter(|n| *n > 0)? as f64;
    let within = count.checked_sub(groups.len() + removed).filter(|n| *n > 0)? as f64;
    let ratio = (fit / between) / (pure / within).max(1e-300);
    Some(FisherSnedecor::new(between, within).ok()?.sf(ratio))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Eight series of six repetitions in two directions, with noise of 0.1 N.
    fn points() -> Vec<(usize, Point, f64)> {
        let mut all = Vec::new();
        let mut state = 7u32;
        for series in 0..8usize {
            for (sign, repetition) in (0..12).map(|i| (if i % 2 == 0 { -1.0 } else { 1.0 }, 1 + i / 2)) {
                state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                let noise = 0.2 * (f64::from(state >> 8) / f64::from(1u32 << 24) - 0.5);
                let load_n = 5.0 * (1 + series % 4) as f64;
                let point = Point { load_n, sign, repetition: f64::from(repetition), ..Point::default() };
                all.push((series, point, noise));
            }
        }
        all
    }

    fn adequate(change: impl Fn(&Point) -> f64) -> bool {
        let points = points();
        let residuals: Vec<Residual<'_>> = points
            .iter()
            .map(|(series, point, noise)| Residual {
                point,
                series: *series,
                residual_n: noise + change(point),
            })
            .collect();
        is_adequate(&residuals)
    }

    #[test]
    fn noise_alone_is_adequate() {
        assert!(adequate(|_| 0.0));
    }

    #[test]
    fn alternating_readings_are_inadequate() {
        assert!(!adequate(|p| if p.repetition % 2.0 > 0.5 { 0.5 } else { -0.5 }));
    }

    #[test]
    fn a_trend_over_load_is_inadequate() {
        assert!(!adequate(|p| 0.05 * p.load_n));
    }
}
