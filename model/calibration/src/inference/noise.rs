//! Hierarchical noise: repetition noise, possibly autocorrelated, and components that rows share.
//!
//! The components are estimated in `variance_components`, and `weighed` whitens rows with them.

use serde::{Deserialize, Serialize};

use super::observations::Observations;
use super::walk::Wandering;
use crate::median::median;

/// A variance that increases with the square of the load: `constant^2 + (per_load F)^2`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Spread {
    /// Standard deviation at zero load, in newtons.
    pub constant_n: f64,
    /// Increase with load, dimensionless.
    pub per_load: f64,
}

impl Spread {
    /// Returns the standard deviation at a load, in newtons.
    pub fn at(self, load_n: f64) -> f64 {
        libm::hypot(self.constant_n, self.per_load * load_n)
    }

    /// Fits both to squares that scatter about the variance, by least squares relative to it. A
    /// square counts for at most nine times its expectation, so that single bad series do not
    /// dominate. `squares` are (load, square, `known` part of it with another explanation, weight).
    pub(super) fn estimate(squares: &[(f64, f64, f64, f64)], least_n: f64) -> Self {
        let mut typical: Vec<f64> = squares.iter().map(|s| s.1).collect();
        let start = (median(&mut typical) / 0.455).max(least_n * least_n);
        let (mut c2, mut p2) = (start, 0.0);
        for _ in 0..12 {
            let (mut a11, mut a12, mut a22, mut b1, mut b2) = (0.0, 0.0, 0.0, 0.0, 0.0);
            for (load, square, known, weight) in squares {
                let f2 = load * load;
                let expected = (c2 + p2 * f2 + known).max(1e-12);
                let w = weight / (expected * expected);
                // The cap reduces the mean of a chi-square variate by 2 %, which is restored here.
                let value = 1.02 * square.min(9.0 * expected) - known;
                a11 += w;
                a12 += w * f2;
                a22 += w * f2 * f2;
                b1 += w * value;
                b2 += w * f2 * value;
            }
            let det = a11 * a22 - a12 * a12;
            let (mut c, mut p) = if det > 1e-9 * a11 * a22 {
                ((a22 * b1 - a12 * b2) / det, (a11 * b2 - a12 * b1) / det)
            } else {
                (b1 / a11.max(1e-300), 0.0)
            };
            if c < least_n * least_n {
                c = least_n * least_n;
                p = if a22 > 0.0 { (b2 - c * a12) / a22 } else { 0.0 };
            }
            if p < 0.0 {
                p = 0.0;
                c = (b1 / a11.max(1e-300)).max(least_n * least_n);
            }
            (c2, p2) = (0.5 * (c2 + c), 0.5 * (p2 + p));
        }
        Self { constant_n: c2.sqrt(), per_load: p2.sqrt() }
    }
}

/// Noise of a table. A component is zero if it was not detected or not estimated.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Noise {
    /// Noise of one repetition.
    pub repetition: Spread,
    /// Offset common to the rows of one series and direction.
    pub series: Spread,
    /// Correlation of consecutive repetitions in a series and direction.
    #[serde(default)]
    pub correlation: f64,
    /// Offset common to both directions of a series.
    #[serde(default)]
    pub series_common: Spread,
    /// Relative variation of the friction exponent between series (tendon seating).
    #[serde(default)]
    pub series_scale: f64,
    /// Relative variation of the friction exponent, or the wrap, between mounts.
    #[serde(default)]
    pub mount_scale: f64,
    /// Drifting part of the offsets of series.
    #[serde(default)]
    pub walk: Wandering,
    /// Variation of the reading between operators and between sessions, in newtons.
    #[serde(rename = "group_offset_N", default)]
    pub group_offset_n: f64,
    /// Relative variation of the friction exponent between specimens.
    #[serde(default)]
    pub specimen_scale: f64,
}

impl Noise {
    /// Returns noise that is independent of the load, in newtons.
    pub fn constant(repetition_n: f64, series_n: f64) -> Self {
        let same = |constant_n| Spread { constant_n, per_load: 0.0 };
        Self {
            repetition: same(repetition_n),
            series: same(series_n),
            correlation: 0.0,
            series_common: same(0.0),
            series_scale: 0.0,
            mount_scale: 0.0,
            walk: Wandering::default(),
            group_offset_n: 0.0,
            specimen_scale: 0.0,
        }
    }

    /// Returns the share of the offsets' standard deviations that does not drift.
    pub(crate) fn white(self) -> f64 {
        if self.walk.is_any() { self.walk.white } else { 1.0 }
    }

    /// Returns the standard deviation in newtons of the drifting part of an offset.
    pub fn wandering_n(self, load_n: f64) -> f64 {
        if !self.walk.is_any() {
            return 0.0;
        }
        libm::hypot(
            self.walk.common * self.series_common.at(load_n),
            self.walk.direction * self.series.at(load_n),
        )
    }

    /// Returns the standard deviation in newtons of one reading around the model, where
    /// `friction_n` is the change of friction in newtons per relative change of its exponent.
    pub fn at(self, load_n: f64, friction_n: f64) -> f64 {
        let scale = libm::hypot(libm::hypot(self.series_scale, self.mount_scale), self.specimen_scale);
        let parts = [
            self.repetition.at(load_n),
            self.white() * self.series.at(load_n),
            self.white() * self.series_common.at(load_n),
            self.wandering_n(load_n),
            self.group_offset_n,
            scale * friction_n,
        ];
        parts.into_iter().fold(0.0, libm::hypot)
    }

    /// Returns the root mean square of [`Noise::at`] over a table, in newtons.
    pub fn floor_n(self, data: &Observations) -> f64 {
        let sum: f64 =
            data.points.iter().zip(&data.friction_n).map(|(p, u)| self.at(p.load_n, *u).powi(2)).sum();
        (sum / data.points.len().max(1) as f64).sqrt()
    }
}

/// A component of the noise that rows share: one random effect per group.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Part {
    /// Offset of a series and direction.
    Cell,
    /// Offset of a series.
    SeriesOffset,
    /// Friction of a series.
    SeriesScale,
    /// Friction, or wrap, of a mount.
    Mount,
    /// Reading of an operator.
    Operator,
    /// Reading of a session.
    Session,
    /// Friction of a specimen.
    Specimen,
}

impl Part {
    /// Components of groups wider than a cell, the smallest first.
    pub(crate) const WIDER: [Part; 6] =
        [Part::SeriesOffset, Part::SeriesScale, Part::Mount, Part::Operator, Part::Session, Part::Specimen];

    /// Returns the rows of its groups.
    pub(crate) fn groups(self, data: &Observations) -> &[Vec<usize>] {
        match self {
            Part::Cell => &data.cells,
            Part::SeriesOffset | Part::SeriesScale => &data.series_rows,
            Part::Mount => &data.mounts,
            Part::Operator => &data.operators,
            Part::Session => &data.sessions,
            Part::Specimen => &data.specimens,
        }
    }

    /// Returns the change of a row in newtons per standard deviation of a group's random effect.
    pub(crate) fn direction_n(self, noise: Noise, data: &Observations, row: usize) -> f64 {
        let load_n = data.points[row].load_n;
        match self {
            Part::Cell => noise.white() * noise.series.at(load_n),
            Part::SeriesOffset => noise.white() * noise.series_common.at(load_n),
            Part::SeriesScale => noise.series_scale * data.friction_n[row],
            Part::Mount => noise.mount_scale * data.friction_n[row],
            Part::Operator | Part::Session => noise.group_offset_n,
            Part::Specimen => noise.specimen_scale * data.friction_n[row],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_spread_is_estimated_from_squares() {
        let truth = Spread { constant_n: 0.05, per_load: 0.004 };
        // Two squares per load, at 0.5 and 1.5 times the variance.
        let squares: Vec<_> = (1..60)
            .flat_map(|i| {
                let load = f64::from(i);
                let variance = truth.at(load).powi(2);
                [(load, 0.5 * variance, 0.0, 1.0), (load, 1.5 * variance, 0.0, 1.0)]
            })
            .collect();
        let found = Spread::estimate(&squares, 1e-6);
        assert!((found.constant_n / truth.constant_n - 1.0).abs() < 0.05, "{found:?}");
        assert!((found.per_load / truth.per_load - 1.0).abs() < 0.05, "{found:?}");
    }
}
