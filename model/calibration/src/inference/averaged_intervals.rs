//! Intervals that account for missing effects: an effect that the data neither show nor exclude
//! shifts the constants of the model. The intervals are averaged over the model and its extensions
//! by one effect (Bayesian model averaging; Hoeting, Madigan, Raftery and Volinsky 1999).

use nalgebra::DVector;
use statrs::distribution::{ContinuousCDF, Normal};

use super::fit::{Fit, Slopes, interval_half_widths};
use super::model::{Model, Term};
use super::open_bounds::open_bounds;
use super::projection::dot;
use super::screening::{EffectScore, Screen};
use super::weighed::Weighed;

/// Normal quantile of a 95 % interval.
const NORMAL_95: f64 = 1.96;
/// Probability outside a 95 % interval on either side.
const TAIL: f64 = 0.025;
/// Largest distance of a quantile, in half widths.
const FURTHEST: f64 = 50.0;

/// Cosine of two whitened traces above which they count as equal.
const SAME_TRACE: f64 = 0.98;

/// An additional effect: its posterior odds, and the shifts of the coordinates.
struct OneMore {
    /// Posterior odds against the model without it.
    odds: f64,
    /// Shifts of the coordinates at the most probable size.
    shift: DVector<f64>,
    /// Standard deviations of the shifts from the uncertainty of the size.
    shift_sd: DVector<f64>,
}

/// Returns 95 % intervals of all constants as distances below and above their values, in their own
/// units; infinite where the data do not exclude a bound of the constant.
///
/// An additional effect of size `s` shifts the constants by `-(J' V^-1 J)^-1 J' V^-1 x s`, where
/// `x` is its trace per unit of size. The odds of an effect are the ratio of the marginal
/// likelihoods (linear in `s`, with a normal prior of the width of typical sizes) over the number
/// of effects in the vocabulary: a priori, one of them is as probable as none.
pub fn averaged_intervals(fitted: &Fit, weighed: &Weighed<'_>) -> Vec<[f64; 2]> {
    let half_widths = interval_half_widths(fitted, weighed);
    let predicted: Vec<f64> =
        weighed.data.force_n.iter().zip(&fitted.residual_n).map(|(y, r)| y - r).collect();
    let slopes = Slopes::new(&fitted.model, weighed, &predicted);
    let Some(solver) = slopes.normal.clone().cholesky() else {
        return half_widths.into_iter().map(|half| [half, half]).collect();
    };
    let choices = fitted.model.vocabulary.count().max(1) as f64;
    let sizes = sizes_of_names(&fitted.model);
    let others: Vec<OneMore> = Screen::new(fitted, weighed)
        .effects()
        .iter()
        .filter_map(|score| {
            let mut trace = score.trace_n.clone();
            weighed.whiten(&mut trace);
            let (along, length2) = (slopes.along(&trace), dot(&trace, &trace));
            // An effect with the same trace as one in the model is its rival: one of the two is
            // present, not both with the size divided between them.
            let is_a_name =
                |i: &usize| along[*i].powi(2) > SAME_TRACE.powi(2) * slopes.normal[(*i, *i)] * length2;
            if sizes.iter().any(is_a_name) {
                return None;
            }
            one_more(score, choices, -solver.solve(&along))
        })
        .collect();
    let open = open_bounds(fitted, weighed);
    half_widths
        .into_iter()
        .enumerate()
        .map(|(i, half)| {
            // Constants shift in proportion to their coordinates, to first order, including the
            // sign.
            let unit = fitted.model.value(i).1;
            let parts: Vec<[f64; 3]> = std::iter::once([1.0, 0.0, half / NORMAL_95])
                .chain(others.iter().map(|other| {
                    let sd = libm::hypot(half / NORMAL_95, other.shift_sd[i] * unit);
                    [other.odds, other.shift[i] * unit, sd]
                }))
                .collect();
            let reach = |side: f64| {
                let mirrored: Vec<[f64; 3]> = parts.iter().map(|[w, m, sd]| [*w, side * m, *sd]).collect();
                // A missing effect cannot reduce the uncertainty.
                quantile_above(&mirrored, half).max(half)
            };
            let to_bound = |is_open: bool, reach: f64| if is_open { f64::INFINITY } else { reach };
            [to_bound(open[i][0], reach(-1.0)), to_bound(open[i][1], reach(1.0))]
        })
        .collect()
}

/// Returns the indices of the first size of each effect among the constants.
fn sizes_of_names(model: &Model) -> Vec<usize> {
    let is_a_name =
        |i: &usize| matches!(&model.terms[*i], Term::Named(effect) if effect.description().scales);
    (0..model.terms.len()).filter(is_a_name).map(|i| model.term_offset(i)).collect()
}

/// Returns the extension by a scored effect; `None` if it is not identifiable or has an impossible
/// sign.
fn one_more(score: &EffectScore, choices: f64, shift_at_size: DVector<f64>) -> Option<OneMore> {
    let told = score.effect.description();
    if score.strength < 1e-6 {
        return None;
    }
    if !told.scales || told.parameters.is_empty() {
        // Present or absent: its size is certain.
        let odds = libm::exp(0.5 * score.gain) / choices;
        let shift_sd = DVector::zeros(shift_at_size.len());
        return Some(OneMore { odds, shift: shift_at_size, shift_sd });
    }
    if told.one_sided && score.share * score.size < 0.0 {
        return None;
    }
    // In units of the size for which the trace was computed.
    let typical = told.study.largest().filter(|size| *size > 0.0 && score.size != 0.0);
    let prior_sd = typical.map_or(1.0, |size| (size / score.size).abs());
    let ratio = (prior_sd * score.strength).powi(2);
    let kept = ratio / (1.0 + ratio);
    let odds = libm::exp(0.5 * (kept * score.gain - libm::log1p(ratio))) / choices;
    let share_sd = kept.sqrt() / score.strength;
    Some(OneMore {
        odds,
        shift: &shift_at_size * (kept * score.share),
        shift_sd: shift_at_size.abs() * share_sd,
    })
}

/// Returns the distance above zero at which a mixture of normal distributions (odds, mean, standard
/// deviation) leaves [`TAIL`]; at least zero.
fn quantile_above(parts: &[[f64; 3]], half: f64) -> f64 {
    let total: f64 = parts.iter().map(|part| part[0]).sum();
    if !total.is_finite() || half <= 0.0 {
        return half.max(0.0);
    }
    let beyond = |at: f64| -> f64 {
        let share = |[odds, mean, sd]: &[f64; 3]| {
            odds * Normal::new(*mean, *sd).map_or_else(|_| f64::from(u8::from(*mean > at)), |law| law.sf(at))
        };
        parts.iter().map(share).sum::<f64>() / total
    };
    let (mut low, mut high) = (0.0, FURTHEST * half);
    for _ in 0..50 {
        let middle = 0.5 * (low + high);
        if beyond(middle) > TAIL { low = middle } else { high = middle }
    }
    high
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_single_model_keeps_its_interval() {
        assert!((quantile_above(&[[1.0, 0.0, 1.0]], 1.96) - 1.96).abs() < 1e-3);
    }

    #[test]
    fn missing_effects_widen_one_side() {
        let parts = [[1.0, 0.0, 1.0], [0.25, 4.0, 1.0]];
        let mirrored = parts.map(|[w, m, sd]| [w, -m, sd]);
        let (above, below) = (quantile_above(&parts, 1.96), quantile_above(&mirrored, 1.96));
        // A fifth of the mixture has mean 4: an eighth of it is above 4 + 1.15.
        assert!((above - 5.15).abs() < 0.01, "{above}");
        assert!(below < 1.96 && below > 1.8, "{below}");
    }

    #[test]
    fn an_interval_contains_its_value() {
        assert!(quantile_above(&[[1.0, 0.0, 1.0], [1e6, -10.0, 1.0]], 1.96) < 1e-9);
    }
}
