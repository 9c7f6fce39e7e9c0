//! Predictive distributions: the best estimate of the curve of a switch, and its uncertainty.

use nalgebra::Matrix3;
use pinswitch_friction::physics::{Constants, PhysicsSwitch};
use pinswitch_friction::{Contact, FrictionCurve, Law, Transition, predict_by};

use super::curve::{Curve, LoadState};

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
    pub fn applied<'a>(&'a self, mut curve: Curve<'a>, loads_n: &'a [f64], z: f64) -> (Curve<'a>, f64) {
        let side = if z > 0.0 { &self.up } else { &self.down };
        let threshold = if z > 0.0 { self.threshold_earlier } else { self.threshold_later };
        let scaled = move |i: usize| curve.state(i).map(|state| state.scaled(side[i] * z));
        (Curve::new(loads_n, scaled), libm::exp(-z * threshold))
    }
}

/// The predictive distribution of a part: the best estimate, its changes with each constant, and
/// the model error. The curves are computed where they are needed.
pub struct Believed<'a> {
    /// Best estimate with its band.
    pub banded: FrictionCurve,
    /// The best estimate.
    pub middle: Curve<'a>,
    /// One curve for each constant, whose standard normal variable is one.
    pub moved: Vec<Curve<'a>>,
}

impl<'a> Believed<'a> {
    /// Returns the standard deviation of the model error of the friction at the load with this
    /// index, upwards and downwards: the part of the band that the constants do not explain. Their
    /// variance is subtracted in quadrature.
    pub fn error_sd(&mut self, index: usize) -> Option<(f64, f64)> {
        let middle = self.middle.state(index)?.friction_n;
        let mut constants = 0.0;
        for moved in &mut self.moved {
            let moved = moved.state(index)?.friction_n;
            constants += if middle > 0.0 { libm::log(moved / middle).powi(2) } else { 0.0 };
        }
        let friction_n = self.banded.friction_n[index];
        let (low, high) = (self.banded.band_low_n[index], self.banded.band_high_n[index]);
        Some((beyond(high / friction_n, constants), beyond(friction_n / low, constants)))
    }

    /// Returns the standard deviation of the model error of the threshold, towards lighter and
    /// towards heavier loads.
    pub fn threshold_error_sd(&mut self) -> Option<(f64, f64)> {
        let middle = self.middle.switching()?;
        let mut constants = 0.0;
        for moved in &mut self.moved {
            constants += libm::log(moved.switching()?.threshold_n / middle.threshold_n).powi(2);
        }
        let Some(t) = Transition::of(&self.banded) else { return Some((0.0, 0.0)) };
        let earlier = beyond(t.threshold_n / t.low_n, constants);
        // The upper end of the band may be above all loads. Its distance is then assumed to be at
        // least that of the lower end.
        let is_cut = self.banded.load_n.last().is_some_and(|last| t.high_n >= *last);
        let later = beyond(t.high_n / t.threshold_n, constants);
        Some((earlier, if is_cut { later.max(earlier) } else { later }))
    }

    /// Returns the model error at all loads.
    pub fn error(&mut self) -> Option<ModelError> {
        let sides = (0..self.banded.load_n.len()).map(|i| self.error_sd(i)).collect::<Option<Vec<_>>>()?;
        let (up, down) = sides.into_iter().unzip();
        let (threshold_earlier, threshold_later) = self.threshold_error_sd()?;
        Some(ModelError { up, down, threshold_earlier, threshold_later })
    }

    /// Returns the best estimate for a model error of `z` standard deviations, and the factor on its
    /// threshold.
    pub fn with_error<'b>(&'b mut self, loads_n: &'b [f64], z: f64) -> Option<(Curve<'b>, f64)> {
        let (earlier, later) = self.threshold_error_sd()?;
        let factor = libm::exp(-z * if z > 0.0 { earlier } else { later });
        let next = self.middle.switching()?.next;
        let state = move |i: usize| {
            let (up, down) = self.error_sd(i)?;
            Some(self.middle.state(i)?.scaled(if z > 0.0 { up } else { down } * z))
        };
        Some((Curve::new(loads_n, state).expecting(next), factor))
    }
}

/// Returns the standard deviation that is left of a ratio at an end of a 95 % band without the
/// variance of the constants.
fn beyond(ratio: f64, constants: f64) -> f64 {
    let sd = if ratio.is_finite() && ratio > 1.0 { libm::log(ratio) / BAND_QUANTILE } else { 0.0 };
    (sd * sd - constants).max(0.0).sqrt()
}

/// A model with its uncertainty. `design --model` selects another implementation.
pub trait Belief: Sync {
    /// Returns the number of standard normal variables that determine the constants.
    fn constants(&self) -> usize;

    /// Returns the curve of `part` with the constants at `z`; the best estimate is at zero. `None`
    /// if the curve cannot be computed.
    fn curve<'a>(&'a self, part: &Part, loads_n: &'a [f64], z: &[f64]) -> Option<Curve<'a>>;

    /// Returns the best estimate of the curve with its band and status.
    fn banded(&self, part: &Part, loads_n: &[f64]) -> Option<FrictionCurve>;

    /// Returns the best estimate of the curve.
    fn best<'a>(&'a self, part: &Part, loads_n: &'a [f64]) -> Option<Curve<'a>> {
        self.curve(part, loads_n, &vec![0.0; self.constants()])
    }

    /// Returns the predictive distribution of `part`.
    fn believed<'a>(&'a self, part: &Part, loads_n: &'a [f64]) -> Option<Believed<'a>> {
        let banded = self.banded(part, loads_n)?;
        let mut middle = self.best(part, loads_n)?;
        let next = middle.switching()?.next;
        let one = |i: usize| {
            let z: Vec<f64> = (0..self.constants()).map(|k| f64::from(u8::from(k == i))).collect();
            Some(self.curve(part, loads_n, &z)?.expecting(next))
        };
        let moved = (0..self.constants()).map(one).collect::<Option<_>>()?;
        Some(Believed { banded, middle, moved })
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

    fn curve<'a>(&'a self, part: &Part, loads_n: &'a [f64], z: &[f64]) -> Option<Curve<'a>> {
        let z = nalgebra::Vector3::from_iterator(z.iter().copied().chain(std::iter::repeat(0.0)).take(3));
        let constants = Constants::from_logarithms(&(Constants::published().logarithms() + self.root * z));
        let mut continuation = PhysicsSwitch::new(&part.contact, constants).continuation();
        Some(Curve::new(loads_n, move |i| {
            let state = continuation.state(loads_n[i]).ok()?;
            Some(LoadState { friction_n: state.friction_n, silicone_share: state.silicone_share })
        }))
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
        let mut believed = belief.believed(&part, &loads).unwrap();
        let last = loads.len() - 1;
        let (up, _) = believed.error_sd(last).unwrap();
        let middle = believed.middle.state(last).unwrap().friction_n;
        assert!((middle / banded.friction_n[last] - 1.0).abs() < 1e-6);
        let moved = believed.moved.iter_mut().map(|m| m.state(last).unwrap().friction_n);
        let constants: f64 = moved.map(|m| libm::log(m / middle).powi(2)).sum();
        let sd = (constants + up.powi(2)).sqrt();
        let band = libm::log(banded.band_high_n[last] / banded.friction_n[last]) / BAND_QUANTILE;
        assert!((sd / band - 1.0).abs() < 0.01, "{sd} {band}");
    }

    #[test]
    fn more_friction_is_an_earlier_threshold() {
        let (belief, mut part, loads) = (PublishedPhysics::default(), part(), loads());
        // Far from the measured part, so that the model error exceeds that of the constants.
        part.contact = part.contact.with_unmodelled(vec!["another mix".to_owned()]);
        let mut believed = belief.believed(&part, &loads).unwrap();
        let error = believed.error().unwrap();
        let middle = believed.middle.state(10).unwrap().friction_n;
        let mut shifted = |z| {
            let (mut curve, factor) = believed.with_error(&loads, z).unwrap();
            let (mut same, same_factor) = error.applied(belief.best(&part, &loads).unwrap(), &loads, z);
            let friction_n = curve.state(10).unwrap().friction_n;
            assert!((friction_n / same.state(10).unwrap().friction_n - 1.0).abs() < 1e-6);
            assert!((factor - same_factor).abs() < 1e-12);
            (friction_n, factor)
        };
        let ((up, earlier), (down, later)) = (shifted(1.0), shifted(-1.0));
        assert!(up > middle && middle > down);
        assert!(earlier < 1.0 && later > 1.0);
    }
}
