//! Estimation of the drift of series offsets and of its correlation, by restricted likelihood over
//! the means of the series and directions.

use super::noise::Noise;
use super::observations::Observations;
use super::projection::{Projection, dot};
use super::walk::Wandering;
use super::weighed::Weighed;

/// Fewest series to separate a drift from independent offsets.
const LEAST_SERIES: usize = 12;
/// Correlations that are tried. With the last, a session of about eighty series drifts to and fro
/// two or three times.
const CORRELATIONS: [f64; 5] = [0.5, 0.7, 0.83, 0.92, 0.97];
/// Sizes that are tried for the part that does not drift, as shares of the offsets' standard
/// deviation.
const WHITE: [f64; 4] = [0.05, 0.5, 0.75, 1.0];
/// The same for the drifting part. A slow drift is partly absorbed by the levels of the conditions,
/// so that the offsets were underestimated without it.
const WALKING: [f64; 8] = [0.0, 0.5, 0.75, 1.0, 1.4, 2.0, 3.0, 4.5];
/// Accessor of one constant of the drift.
type Constant = fn(&mut Wandering) -> &mut f64;

/// Number of passes over the constants.
const SWEEPS: usize = 3;
/// Typical standard deviation in newtons of the drift, and its largest value.
const USUAL_N: f64 = 0.2;
const MOST_N: f64 = 0.5;
/// Penalty for its constants: the gain that a drift needs over white offsets.
const TOLL: f64 = 8.0;

/// Returns minus twice the log prior density of a drift, up to a constant.
pub(super) fn walk_cost(noise: Noise, data: &Observations) -> f64 {
    if !noise.walk.is_any() {
        return 0.0;
    }
    TOLL + (noise.wandering_n(data.mean_load_n()) / USUAL_N).powi(2)
}

/// Returns the drift with the largest restricted likelihood, if white offsets are less probable.
/// `own` are columns in newtons that the model may absorb.
pub(super) fn wandering(
    data: &Observations,
    residual_n: &[f64],
    own: &[Vec<f64>],
    noise: Noise,
) -> Wandering {
    let none = Wandering::default();
    if data.series < LEAST_SERIES {
        return none;
    }
    let noise = Noise { walk: none, ..noise };
    let means = data.cell_means(noise);
    let residual = means.mean_of(data, residual_n);
    let columns: Vec<Vec<f64>> = own.iter().map(|c| means.mean_of(data, c)).collect();
    let cost = |walk: Wandering| {
        let noise = Noise { walk, ..noise };
        if noise.wandering_n(data.mean_load_n()) > MOST_N {
            return f64::INFINITY;
        }
        let weighed = Weighed::new(&means.observations, noise);
        restricted(&weighed, &residual, &columns) + walk_cost(noise, data)
    };
    let mut best = (f64::INFINITY, Wandering { correlation: 0.83, white: 0.5, common: 1.0, direction: 1.0 });
    for _ in 0..SWEEPS {
        let before = best.0;
        let tries: [(&[f64], Constant); 4] = [
            (&WALKING, |w| &mut w.common),
            (&WALKING, |w| &mut w.direction),
            (&WHITE, |w| &mut w.white),
            (&CORRELATIONS, |w| &mut w.correlation),
        ];
        for (values, constant) in tries {
            for value in values {
                let mut walk = best.1;
                *constant(&mut walk) = *value;
                let cost = if walk == best.1 && best.0.is_finite() { best.0 } else { cost(walk) };
                if cost < best.0 {
                    best = (cost, walk);
                }
            }
        }
        if best.0 >= before - 0.1 {
            break;
        }
    }
    if best.1.is_any() && best.0 < cost(none) { best.1 } else { none }
}

/// Returns minus twice the log restricted likelihood, up to a constant.
fn restricted(weighed: &Weighed<'_>, residual: &[f64], columns: &[Vec<f64>]) -> f64 {
    let mut projection = Projection::new(residual.len());
    let mut log_det = weighed.shared_log_det();
    let mut columns = columns.to_vec();
    weighed.whiten_all(&mut columns);
    for white in columns {
        // Determinant of the projection's columns: the loss of their norm to those before.
        let mut rest = white.clone();
        projection.remove(&mut rest);
        let length2 = dot(&rest, &rest);
        if projection.absorb(white) && length2 > 0.0 {
            log_det += libm::log(length2);
        }
    }
    let mut white = residual.to_vec();
    weighed.whiten(&mut white);
    projection.remove(&mut white);
    dot(&white, &white) + log_det
}
