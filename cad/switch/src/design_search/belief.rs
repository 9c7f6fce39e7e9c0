//! Predictive distributions: the best estimate of the curve of a switch, and its uncertainty.

use nalgebra::Matrix3;
use pinswitch_friction::physics::{Constants, PhysicsSwitch};
use pinswitch_friction::{Contact, FrictionCurve, Law, PredictionStatus, Transition, predict_by};

use super::curve::Curve;

/// Quantile of the standard normal distribution at the ends of a 95 % band.
const BAND_QUANTILE: f64 = 1.96;

/// The input of a prediction: grooves, and the contact of the tendon.
#[derive(Clone, Debug)]
pub struct Part {
    /// Occupied grooves, ascending, numbered from 1.
    pub pins: Vec<usize>,
    /// Contact of the tendon.
    pub contact: Contact,
}

/// Errors of a model other than those of its constants. One standard normal variable scales the
/// errors at all loads: a model that is too low at one load is too low at every load. Each field is
/// a standard deviation of a logarithm.
#[derive(Clone, Debug, PartialEq)]
pub struct ModelError {
    /// Standard deviation of the friction at each load, upwards.
    pub up: Vec<f64>,
    /// Standard deviation of the friction at each load, downwards.
    pub down: Vec<f64>,
    /// Standard deviation of the threshold towards lighter loads, where the friction exceeds the
    /// best estimate.
    pub threshold_earlier: f64,
    /// Standard deviation of the threshold towards heavier loads, where the friction is below the
    /// best estimate.
    pub threshold_later: f64,
}

impl ModelError {
    /// Returns the curve for a model error of `z` standard deviations, and the factor on its
    /// threshold.
    pub fn applied(&self, curve: Curve, z: f64) -> (Curve, f64) {
        let side = if z > 0.0 { &self.up } else { &self.down };
        let threshold = if z > 0.0 { self.threshold_earlier } else { self.threshold_later };
        (curve.scaled(side.iter().map(|sd| sd * z)), libm::exp(-z * threshold))
    }
}

/// The best estimate of a part, its changes with each constant, and the model error.
#[derive(Clone, Debug)]
pub struct Believed {
    /// Prediction status.
    pub trust: PredictionStatus,
    /// The best estimate.
    pub middle: Curve,
    /// One curve for each constant, whose standard normal variable is one.
    pub moved: Vec<Curve>,
    /// The model error.
    pub error: ModelError,
}

/// A model with its uncertainty. `design --model` selects another implementation.
pub trait Belief: Sync {
    /// Returns the number of standard normal variables that determine the constants.
    fn constants(&self) -> usize;

    /// Returns the curve of `part` with the constants at `z`; the best estimate is at zero. `None`
    /// if the curve cannot be computed.
    fn curve(&self, part: &Part, loads_n: &[f64], z: &[f64]) -> Option<Curve>;

    /// Returns the best estimate of the curve with its band and status.
    fn banded(&self, part: &Part, loads_n: &[f64]) -> Option<FrictionCurve>;

    /// Returns the predictive distribution of `part`. The model error is the part of the band that
    /// the constants do not explain; their variance is subtracted in quadrature.
    fn believed(&self, part: &Part, loads_n: &[f64]) -> Option<Believed> {
        let banded = self.banded(part, loads_n)?;
        let zeros = vec![0.0; self.constants()];
        let middle = self.curve(part, loads_n, &zeros)?;
        let (mut friction, mut threshold) = (vec![0.0; loads_n.len()], 0.0);
        let mut all_moved = Vec::with_capacity(self.constants());
        for i in 0..self.constants() {
            let mut z = zeros.clone();
            z[i] = 1.0;
            let moved = self.curve(part, loads_n, &z)?;
            for (variance, (m, d)) in friction.iter_mut().zip(moved.friction_n.iter().zip(&middle.friction_n))
            {
                *variance += if *d > 0.0 { libm::log(m / d).powi(2) } else { 0.0 };
            }
            threshold += libm::log(moved.switching().threshold_n / middle.switching().threshold_n).powi(2);
            all_moved.push(moved);
        }
        let beyond = |ratio: f64, constants: f64| {
            let sd = if ratio.is_finite() && ratio > 1.0 { libm::log(ratio) / BAND_QUANTILE } else { 0.0 };
            (sd * sd - constants).max(0.0).sqrt()
        };
        let side = |from: &[f64], to: &[f64]| -> Vec<f64> {
            from.iter().zip(to).zip(&friction).map(|((a, b), v)| beyond(b / a, *v)).collect()
        };
        let (earlier, later) = match Transition::of(&banded) {
            Some(t) => {
                let earlier = beyond(t.threshold_n / t.low_n, threshold);
                // The upper end of the band may be above all loads. Its distance is then assumed to
                // be at least that of the lower end.
                let is_cut = banded.load_n.last().is_some_and(|last| t.high_n >= *last);
                let later = beyond(t.high_n / t.threshold_n, threshold);
                (earlier, if is_cut { later.max(earlier) } else { later })
            }
            None => (0.0, 0.0),
        };
        let error = ModelError {
            up: side(&banded.friction_n, &banded.band_high_n),
            down: side(&banded.band_low_n, &banded.friction_n),
            threshold_earlier: earlier,
            threshold_later: later,
        };
        Some(Believed { trust: banded.status, middle, moved: all_moved, error })
    }
}

/// The physics with constants fitted to the published maxima. The constants are lognormal, with the
/// covariance of the fit.
#[derive(Clone, Debug)]
pub struct PublishedPhysics {
    root: Matrix3<f64>,
}

impl Default for PublishedPhysics {
    fn default() -> Self {
        let covariance = Matrix3::from_row_slice(&Constants::published_covariance().concat());
        // If the covariance is not positive definite, the constants have no uncertainty.
        let root = covariance.cholesky().map_or_else(Matrix3::zeros, |c| c.l());
        Self { root }
    }
}

impl Belief for PublishedPhysics {
    fn constants(&self) -> usize {
        3
    }

    fn curve(&self, part: &Part, loads_n: &[f64], z: &[f64]) -> Option<Curve> {
        let z = nalgebra::Vector3::from_iterator(z.iter().copied().chain(std::iter::repeat(0.0)).take(3));
        let constants = Constants::from_logarithms(&(Constants::published().logarithms() + self.root * z));
        let states = PhysicsSwitch::new(&part.contact, constants).states(loads_n).ok()?;
        Some(Curve {
            load_n: loads_n.to_vec(),
            friction_n: states.iter().map(|s| s.friction_n).collect(),
            silicone_share: states.iter().map(|s| s.silicone_share).collect(),
        })
    }

    fn banded(&self, part: &Part, loads_n: &[f64]) -> Option<FrictionCurve> {
        predict_by(Law::DEFAULT, &part.contact, loads_n).ok()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use pinswitch_friction::{PinPattern, Substrate, published};

    fn part() -> Part {
        let pins = PinPattern::even(4, 0.25);
        let contact = Contact::new(Substrate::Silicone, pins, published::wrap_angle_rad()).unwrap();
        Part { pins: vec![3, 6, 9, 12], contact }
    }

    fn loads() -> Vec<f64> {
        (0..20).map(|i| 3.0 * libm::pow(50.0f64 / 3.0, f64::from(i) / 19.0)).collect()
    }

    /// Constants and model error together reproduce the band.
    #[test]
    fn belief_and_band_agree() {
        let (belief, part, loads) = (PublishedPhysics::default(), part(), loads());
        let banded = belief.banded(&part, &loads).unwrap();
        let Believed { error, middle, moved, .. } = belief.believed(&part, &loads).unwrap();
        let last = loads.len() - 1;
        let constants: f64 =
            moved.iter().map(|m| libm::log(m.friction_n[last] / middle.friction_n[last]).powi(2)).sum();
        let sd = (constants + error.up[last].powi(2)).sqrt();
        let band = libm::log(banded.band_high_n[last] / banded.friction_n[last]) / BAND_QUANTILE;
        assert!((sd / band - 1.0).abs() < 0.01, "{sd} {band}");
    }

    #[test]
    fn more_friction_is_an_earlier_threshold() {
        let (belief, mut part, loads) = (PublishedPhysics::default(), part(), loads());
        // Far from the measured part, so that the model error exceeds that of the constants.
        part.contact = part.contact.with_unmodelled(vec!["another mix".to_owned()]);
        let Believed { error, middle, .. } = belief.believed(&part, &loads).unwrap();
        let (up, earlier) = error.applied(middle.clone(), 1.0);
        let (down, later) = error.applied(middle.clone(), -1.0);
        assert!(up.friction_n[10] > middle.friction_n[10] && middle.friction_n[10] > down.friction_n[10]);
        assert!(earlier < 1.0 && later > 1.0);
    }
}
