//! What is believed of a switch before it is made: its curve, and how wrong that may be.

use nalgebra::Matrix3;
use pinswitch_friction::physics::{Constants, PhysicsSwitch};
use pinswitch_friction::{Contact, FrictionCurve, Law, PredictionStatus, Transition, predict_by};

use super::curve::Curve;

/// Quantile of the normal distribution that a band of 95 % reaches.
const BAND_QUANTILE: f64 = 1.96;

/// A switch as a belief sees it: grooves, and what the tendon touches.
#[derive(Clone, Debug)]
pub struct Part {
    /// Occupied grooves, ascending, numbered from 1.
    pub pins: Vec<usize>,
    /// What the tendon touches.
    pub contact: Contact,
}

/// What a model may be wrong by beyond its constants. All loads share one standard normal: a model that is too low at one
/// load is too low at the others. Standard deviations are of logarithms, one for each side.
#[derive(Clone, Debug, PartialEq)]
pub struct ModelError {
    /// Of the friction at each load, upwards.
    pub up: Vec<f64>,
    /// Of the friction at each load, downwards.
    pub down: Vec<f64>,
    /// Of the threshold where the friction is higher than believed: it comes earlier by this.
    pub threshold_earlier: f64,
    /// Of the threshold where the friction is lower than believed: it comes later by this.
    pub threshold_later: f64,
}

impl ModelError {
    /// The curve as it is if the model errs by `z`, and the factor on its threshold.
    pub fn applied(&self, curve: Curve, z: f64) -> (Curve, f64) {
        let side = if z > 0.0 { &self.up } else { &self.down };
        let threshold = if z > 0.0 { self.threshold_earlier } else { self.threshold_later };
        (curve.scaled(side.iter().map(|sd| sd * z)), libm::exp(-z * threshold))
    }
}

/// The best guess of a part, its constants moved one by one, and what the model may be wrong by.
#[derive(Clone, Debug)]
pub struct Believed {
    /// How far the model is to be trusted.
    pub trust: PredictionStatus,
    /// The best guess.
    pub middle: Curve,
    /// The curve with each constant's standard normal at one.
    pub moved: Vec<Curve>,
    /// What the model may be wrong by.
    pub error: ModelError,
}

/// A model with what is uncertain about it. A second one stands behind `design --model`.
pub trait Belief: Sync {
    /// How many standard normals draw its constants.
    fn constants(&self) -> usize;

    /// The curve of `part` with constants drawn by `z`; all zero is the best guess. `None` if it cannot be computed.
    fn curve(&self, part: &Part, loads_n: &[f64], z: &[f64]) -> Option<Curve>;

    /// The curve of the best guess with its band and trust.
    fn banded(&self, part: &Part, loads_n: &[f64]) -> Option<FrictionCurve>;

    /// All that is believed of `part`: the model error is what the band holds beyond the constants, whose variance is taken
    /// out in quadrature.
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
                // The band may end above the friction of the threshold at all loads: then the other side stands in.
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

/// The physics with the constants fitted to the published maxima, lognormal with the covariance of their fit.
#[derive(Clone, Debug)]
pub struct PublishedPhysics {
    root: Matrix3<f64>,
}

impl Default for PublishedPhysics {
    fn default() -> Self {
        let covariance = Matrix3::from_row_slice(&Constants::published_covariance().concat());
        // A covariance that is no longer positive would leave the constants as they are.
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

    /// Constants and model error together are the band again.
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
        // Far from what was measured, so that the model error is more than the constants'.
        part.contact = part.contact.with_unmodelled(vec!["another mix".to_owned()]);
        let Believed { error, middle, .. } = belief.believed(&part, &loads).unwrap();
        let (up, earlier) = error.applied(middle.clone(), 1.0);
        let (down, later) = error.applied(middle.clone(), -1.0);
        assert!(up.friction_n[10] > middle.friction_n[10] && middle.friction_n[10] > down.friction_n[10]);
        assert!(earlier < 1.0 && later > 1.0);
    }
}
