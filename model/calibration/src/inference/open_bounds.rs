//! Detection of bounds that the data do not exclude. The prior of the logit of a bounded constant,
//! and its curvature in the middle of the range, contain no information about the ends.

use super::fit::{Fit, fit};
use super::weighed::Weighed;
use crate::parallel::map_each;

/// Increase of the deviance up to which a bound is within the 95 % interval: the quantile of
/// chi-square with one degree of freedom.
const NOT_EXCLUDED: f64 = 3.84;
/// Distance from the bound at which the constant is fixed, since the logit diverges at the bound:
/// at most this share of the range, and this share of the distance from the bound to the estimate,
/// which may be close to a bound of a wide range such as 0.05 to 200 s.
const BESIDE_THE_BOUND: (f64, f64) = (0.02, 0.1);

/// Returns whether the lower and the upper bound of each constant are within its interval, by the
/// likelihood with all other constants refitted; `false` for constants without bounds, and for
/// fixed ones.
pub(super) fn open_bounds(fitted: &Fit, weighed: &Weighed<'_>) -> Vec<[bool; 2]> {
    let model = &fitted.model;
    let prior = |i: usize| ((model.coordinates[i] - model.priors()[i].mean) / model.priors()[i].sd).powi(2);
    let is_open = |i: usize, share: f64| {
        if model.is_held(i) {
            return false;
        }
        let held = model.held_at(i, share).map(|held| fit(&held, weighed));
        held.is_some_and(|held| held.cost - (fitted.cost - prior(i)) < NOT_EXCLUDED)
    };
    let beside = |way: f64| BESIDE_THE_BOUND.0.min(BESIDE_THE_BOUND.1 * way);
    let indices = (0..model.coordinates.len()).collect();
    map_each(indices, |i| {
        // Share of the distance between the bounds; unused for a constant without bounds.
        let (low, high) = model.bounds_of(i);
        let way = (model.value(i).0 - low) / (high - low);
        [is_open(i, beside(way)), is_open(i, 1.0 - beside(1.0 - way))]
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::effect_named;
    use crate::inference::{Model, Noise, Observations, Term};
    use crate::table::Frame;
    use crate::test_session::session_with;

    /// Friction that saturates as a power law (h = 0) or as a hyperbola (h = 1): its true bound is
    /// not excluded, and the other one is if the effect is large.
    #[test]
    fn a_true_bound_is_not_excluded() {
        let saturation = effect_named("substrate_saturation").unwrap();
        for h in [0.0, 1.0] {
            let rows = session_with(3, &[(Term::Named(saturation), &[0.33, h])]);
            let frame = Frame::new(&rows);
            let data = Observations::new(&frame, &rows).unwrap();
            let fitted = |sd| {
                let weighed = Weighed::new(&data, Noise::constant(sd, 0.001));
                let model = Model::baseline(frame.clone()).with_term(Term::Named(saturation), &[0.3, 0.5]);
                let found = fit(&model, &weighed);
                *open_bounds(&found, &weighed).last().unwrap()
            };
            let (plain, noisy) = (fitted(0.5), fitted(6.0));
            assert_eq!(plain, [h == 0.0, h == 1.0], "h = {h}");
            assert_eq!(noisy, [true, true], "h = {h}: strong noise excludes nothing");
        }
        // A share of the range is a large distance if the estimate is close to a bound.
        let drift = effect_named("wear_drift").unwrap();
        let rows = session_with(3, &[(Term::Named(drift), &[0.5, 0.12])]);
        let frame = Frame::new(&rows);
        let data = Observations::new(&frame, &rows).unwrap();
        let weighed = Weighed::new(&data, Noise::constant(0.05, 0.001));
        let found = fit(&Model::baseline(frame.clone()).with_term(Term::Named(drift), &[0.4, 0.3]), &weighed);
        let (low, _) = found.model.bounds_of(found.model.values().len() - 1);
        assert!(found.model.values().last().unwrap() - low < 0.1, "{:?}", found.model.values());
        assert_eq!(open_bounds(&found, &weighed).last(), Some(&[false, false]));
        let model = Model::baseline(Frame::new(&session_with(1, &[])));
        assert!(model.held_at(0, 0.5).is_none(), "friction coefficients have no upper bound");
    }
}
