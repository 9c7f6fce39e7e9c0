//! Identifiability of an effect in a session, independent of the method of search.

use statrs::distribution::{ContinuousCDF, Normal};

use super::fit::jacobian;
use super::levels::Levels;
use super::model::Model;
use super::projection::{Projection, dot};
use super::significance::gain_at;
use super::weighed::Weighed;

/// Probability above which an effect counts as detectable.
pub const VISIBLE: f64 = 0.95;

/// Returns the expected reduction of the deviance by an effect that changes the readings by
/// `change_n` (newtons, one for each row): the residual of generalised least squares after the
/// constants of `model` have absorbed what they can. It is the noncentrality of the test.
pub fn expected_gain(model: &Model, weighed: &Weighed<'_>, change_n: &[f64]) -> f64 {
    let predicted = model.predict(&weighed.data.points);
    let mut own = Projection::new(predicted.len());
    for mut column in jacobian(model, weighed.data, &predicted) {
        weighed.whiten(&mut column);
        own.absorb(column);
    }
    let mut change = change_n.to_vec();
    weighed.whiten(&mut change);
    own.remove(&mut change);
    dot(&change, &change)
}

/// Returns the probability that a test with that expected gain detects the effect among `tried`
/// candidates at the level of the first effect.
///
/// ```
/// use pinswitch_calibration::inference::{Levels, VISIBLE, probability_found};
///
/// let found = |gain| probability_found(gain, Levels::default(), 21, 60.0);
/// assert!(found(2.0) < 0.05 && found(60.0) > VISIBLE);
/// ```
pub fn probability_found(expected_gain: f64, levels: Levels, tried: usize, degrees: f64) -> f64 {
    probability_beyond(gain_at(levels.first_p, tried, degrees), expected_gain)
}

/// The same at the level of unattributed structure, over this number of shapes.
pub fn probability_structure_found(expected_gain: f64, levels: Levels, tried: usize, degrees: f64) -> f64 {
    let chance = gain_at(levels.structure_p, tried.max(1), degrees);
    probability_beyond(levels.structure.max(chance), expected_gain)
}

/// Returns the probability that a gain with this expectation exceeds a bound: the square of a
/// normal variate.
fn probability_beyond(bound: f64, expected_gain: f64) -> f64 {
    let (middle, bound) = (expected_gain.max(0.0).sqrt(), bound.max(0.0).sqrt());
    let normal = Normal::standard();
    normal.sf(bound - middle) + normal.cdf(-bound - middle)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::inference::{Noise, Observations};
    use crate::table::Frame;
    use crate::test_session::session;

    #[test]
    fn absorbed_changes_are_not_detectable() {
        let rows = session(1);
        let frame = Frame::new(&rows);
        let data = Observations::new(&frame, &rows).unwrap();
        let model = Model::baseline(frame.clone());
        let weighed = Weighed::new(&data, Noise::constant(0.1, 0.0));
        let predicted = model.predict(&data.points);
        // More friction of the silicone is a constant of the model; a sawtooth along the rows is
        // not.
        let mut other = model.clone();
        other.set_values(&{
            let mut values = model.values();
            values[0] *= 1.001;
            values
        });
        let constant: Vec<f64> =
            other.predict(&data.points).iter().zip(&predicted).map(|(a, b)| a - b).collect();
        let sawtooth: Vec<f64> = (0..rows.len()).map(|row| if row % 2 == 0 { 0.1 } else { -0.1 }).collect();
        let bare: f64 = constant.iter().map(|v| (v / 0.1).powi(2)).sum();
        assert!(expected_gain(&model, &weighed, &constant) < 1e-3 * bare);
        let gain = expected_gain(&model, &weighed, &sawtooth);
        assert!(gain > 0.9 * rows.len() as f64 && gain < 1.01 * rows.len() as f64, "{gain}");
    }

    #[test]
    fn probability_at_the_bound_is_half() {
        let levels = Levels::default();
        let bound = gain_at(levels.first_p, 21, 60.0);
        assert!((probability_found(bound, levels, 21, 60.0) - 0.5).abs() < 1e-3);
        let shape = levels.structure.max(gain_at(levels.structure_p, 300, 60.0));
        assert!((probability_structure_found(shape, levels, 300, 60.0) - 0.5).abs() < 1e-3);
        let by_chance = probability_found(0.0, levels, 21, 60.0);
        assert!(by_chance < levels.first_p / 21.0 * 1.1, "{by_chance}");
    }
}
