//! Transfer of a measured curve to a part with other dimensions: the physics predicts the ratio of
//! friction and the shift of the threshold.

use crate::band_source::NORMAL_95;
use crate::capstan::{Direction, capstan_tension_n};
use crate::contact::Contact;
use crate::curve::FrictionCurve;
use crate::deviation::deviations;
use crate::physics::{Constants, PhysicsError, PhysicsSwitch};
use crate::status::PredictionStatus;
use crate::transition::{Transition, interpolated};

/// Relative standard deviation of a change of `ln D` that the physics predicts. Chosen: no
/// calibration has measured a change of dimensions yet.
const CHANGE_UNCERTAINTY: f64 = 0.5;
/// Standard deviation of `ln D` from effects outside the physics, for a parameter that changes by a
/// factor e. Chosen.
const UNKNOWN_EFFECT: f64 = 0.1;
/// Range of loads for thresholds, as factors of the lightest and the heaviest load, and the number
/// of loads.
const THRESHOLD_LOADS: (f64, f64, usize) = (0.3, 4.0, 48);
/// Largest difference between equal pin angles, in radians.
const SAME_RAD: f64 = 1e-6;

/// Change of friction from one contact, that of the rig, to another, by the physics.
#[derive(Clone, Debug, PartialEq)]
pub struct Transfer {
    /// `ln` of the friction of the part over that of the rig, load by load; zeros if the contacts
    /// are equal.
    pub log_friction: Vec<f64>,
    /// Factor on the threshold.
    pub threshold_factor: f64,
    /// Half width of `ln D` at 95 % that the change adds, load by load.
    pub half_width: Vec<f64>,
    /// Differences between the contacts, as text; empty if they are equal.
    pub reasons: Vec<String>,
}

impl Transfer {
    /// Computes the transfer from `rig` to `part` at `loads_n` newtons, ascending.
    ///
    /// ```
    /// use pinswitch_friction::physics::Bed;
    /// use pinswitch_friction::{Transfer, Contact, PinPattern, Substrate, published};
    ///
    /// let pins = PinPattern::even(3, published::LAYOUTS[1].pitch_rad());
    /// let rig = Contact::new(Substrate::Silicone, pins, published::wrap_angle_rad())?;
    /// let thick = rig.clone().with_bed(Bed { layer_mm: 3.0, ..*rig.bed() });
    /// let transfer = Transfer::between(&rig, &thick, &[10.0, 49.671])?;
    /// assert!(transfer.log_friction[1] > 0.0);
    /// assert!(transfer.threshold_factor < 1.0, "a thick layer switches earlier");
    /// assert!(transfer.reasons[0].starts_with("layer thickness is 3 mm"));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`PhysicsError`] if the physics does not converge.
    pub fn between(rig: &Contact, part: &Contact, loads_n: &[f64]) -> Result<Self, PhysicsError> {
        let heaviest_n = loads_n.iter().copied().fold(0.0, f64::max);
        let deviations = deviations(part, &[heaviest_n]);
        let mut reasons: Vec<String> = deviations.iter().map(|d| d.reason(heaviest_n)).collect();
        reasons.extend(part.remarks());
        let moved = moved_pins(rig, part);
        reasons.extend(moved.then(|| pins_reason(rig, part)));
        let none = vec![0.0; loads_n.len()];
        if reasons.is_empty() {
            return Ok(Self { log_friction: none.clone(), threshold_factor: 1.0, half_width: none, reasons });
        }
        let switch = |contact: &Contact| PhysicsSwitch::new(contact, Constants::published());
        let (part_states, rig_states) = (switch(part).states(loads_n)?, switch(rig).states(loads_n)?);
        let log_friction: Vec<f64> = part_states
            .iter()
            .zip(&rig_states)
            .map(|(a, b)| libm::log(a.friction_n / b.friction_n))
            .map(|log| if log.is_finite() { log } else { 0.0 })
            .collect();
        let mut distance: f64 = deviations.iter().map(|d| d.log_ratio.powi(2)).sum();
        if let (true, Some(a), Some(b)) =
            (moved, part.all_pins().mean_pitch_rad(), rig.all_pins().mean_pitch_rad())
        {
            distance += libm::log(a / b).powi(2);
        }
        let half_width = log_friction
            .iter()
            .map(|log| NORMAL_95 * libm::hypot(CHANGE_UNCERTAINTY * log, UNKNOWN_EFFECT * distance.sqrt()))
            .collect();
        let threshold_factor = threshold_n(part, loads_n)? / threshold_n(rig, loads_n)?;
        Ok(Self { log_friction, threshold_factor, half_width, reasons })
    }

    /// Whether the contacts are equal.
    pub fn is_identity(&self) -> bool {
        self.reasons.is_empty()
    }

    /// Converts friction and silicone's share of it from the rig to the part, at the same loads.
    /// The share is that of the rig at the load divided by the threshold factor.
    pub fn friction_and_share(
        &self,
        loads_n: &[f64],
        friction_n: &[f64],
        silicone_share: &[f64],
    ) -> (Vec<f64>, Vec<f64>) {
        let friction = friction_n.iter().zip(&self.log_friction).map(|(d, by)| d * libm::exp(*by)).collect();
        let ends = loads_n.first().zip(loads_n.last());
        let within = |load: f64| ends.map_or(load, |(from, to)| load.max(*from).min(*to));
        let share = loads_n
            .iter()
            .map(|load| interpolated(loads_n, silicone_share, within(load / self.threshold_factor)))
            .collect();
        (friction, share)
    }

    /// Converts a curve of the rig to the part: scales the friction exponents of both directions
    /// and widens the band. The result is extrapolated, unless the contacts are equal.
    pub fn apply(&self, mut curve: FrictionCurve) -> FrictionCurve {
        if self.is_identity() {
            return curve;
        }
        let (friction_n, share) =
            self.friction_and_share(&curve.load_n, &curve.friction_n, &curve.silicone_share);
        for (i, &load) in curve.load_n.iter().enumerate() {
            let (down, up) = (
                libm::log(curve.friction_n[i] / curve.band_low_n[i].max(1e-9)).max(0.0),
                libm::log(curve.band_high_n[i] / curve.friction_n[i].max(1e-9)).max(0.0),
            );
            if load > 0.0 && curve.friction_n[i] > 0.0 {
                let by = libm::asinh(friction_n[i] / load) / libm::asinh(curve.friction_n[i] / load);
                let exponent = |tension: f64| by * libm::log(tension / load).abs();
                curve.eccentric_n[i] =
                    capstan_tension_n(load, exponent(curve.eccentric_n[i]), Direction::Eccentric);
                curve.concentric_n[i] =
                    capstan_tension_n(load, exponent(curve.concentric_n[i]), Direction::Concentric);
                curve.friction_n[i] = (curve.concentric_n[i] - curve.eccentric_n[i]) / 2.0;
            }
            curve.band_low_n[i] = curve.friction_n[i] * libm::exp(-libm::hypot(down, self.half_width[i]));
            curve.band_high_n[i] = curve.friction_n[i] * libm::exp(libm::hypot(up, self.half_width[i]));
        }
        curve.silicone_share = share;
        curve.status = PredictionStatus::Extrapolated;
        curve.reasons.extend(self.reasons.iter().cloned());
        curve
    }
}

/// Returns the threshold by the physics in newtons, limited to the range of [`THRESHOLD_LOADS`].
fn threshold_n(contact: &Contact, loads_n: &[f64]) -> Result<f64, PhysicsError> {
    let (lightest, heaviest) = (
        loads_n.iter().copied().filter(|l| *l > 0.0).fold(f64::INFINITY, f64::min),
        loads_n.iter().copied().fold(0.0, f64::max),
    );
    if !lightest.is_finite() {
        return Ok(1.0);
    }
    let (down, up, count) = THRESHOLD_LOADS;
    let (from, to) = (down * lightest, up * heaviest);
    let loads: Vec<f64> =
        (0..count).map(|i| from * libm::pow(to / from, i as f64 / (count - 1) as f64)).collect();
    let shares: Vec<f64> = PhysicsSwitch::new(contact, Constants::published())
        .states(&loads)?
        .iter()
        .map(|s| s.silicone_share)
        .collect();
    let on_silicone = shares.first().is_some_and(|share| *share >= 0.5);
    Ok(Transition::threshold_n(&loads, &shares).unwrap_or(if on_silicone { from } else { to }))
}

/// Whether the pins of both contacts differ.
fn moved_pins(rig: &Contact, part: &Contact) -> bool {
    let (a, b) = (rig.all_pins().angles_rad(), part.all_pins().angles_rad());
    a.len() != b.len() || a.iter().zip(b).any(|(a, b)| (a - b).abs() > SAME_RAD)
}

fn pins_reason(rig: &Contact, part: &Contact) -> String {
    let degrees = |contact: &Contact| {
        let all: Vec<_> =
            contact.all_pins().angles_rad().iter().map(|a| format!("{:.2}", a.to_degrees())).collect();
        all.join(", ")
    };
    format!("the pins are at {} deg, those of the calibrated rig at {} deg", degrees(part), degrees(rig))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bed::Bed;
    use crate::law::Law;
    use crate::pattern::PinPattern;
    use crate::prediction::predict_by;
    use crate::published;
    use crate::substrate::Substrate;

    fn rig() -> Contact {
        let pins = PinPattern::even(3, published::LAYOUTS[1].pitch_rad());
        Contact::new(Substrate::Silicone, pins, published::wrap_angle_rad()).unwrap()
    }

    fn loads() -> Vec<f64> {
        (1..=25).map(|i| 2.0 * f64::from(i)).collect()
    }

    #[test]
    fn equal_contacts_change_nothing() {
        let transfer = Transfer::between(&rig(), &rig(), &loads()).unwrap();
        let curve = predict_by(Law::Physics, &rig(), &loads()).unwrap();
        assert!(transfer.is_identity());
        assert_eq!(transfer.apply(curve.clone()), curve);
    }

    /// The transfer of a curve by the physics gives the curve that the physics predicts for the
    /// part.
    #[test]
    fn physics_curves_transfer_to_physics_curves() {
        for (bed, wrap) in [
            (Bed { layer_mm: 3.0, ..Bed::published() }, published::wrap_angle_rad()),
            (Bed { pin_diameter_mm: 0.8, layer_width_mm: 20.0, ..Bed::published() }, 1.3),
        ] {
            let part = rig().with_bed(bed).at_wrap(wrap).unwrap();
            let transfer = Transfer::between(&rig(), &part, &loads()).unwrap();
            let there = transfer.apply(predict_by(Law::Physics, &rig(), &loads()).unwrap());
            let known = predict_by(Law::Physics, &part, &loads()).unwrap();
            for i in 0..loads().len() {
                assert!(
                    (there.friction_n[i] / known.friction_n[i] - 1.0).abs() < 0.01,
                    "{i}: {} {}",
                    there.friction_n[i],
                    known.friction_n[i]
                );
                assert!(there.eccentric_n[i] <= there.load_n[i] && there.load_n[i] <= there.concentric_n[i]);
            }
            let threshold = |curve: &FrictionCurve| Transition::of(curve).unwrap().threshold_n;
            assert!((threshold(&there) / threshold(&known) - 1.0).abs() < 0.15);
            assert_eq!(there.status, PredictionStatus::Extrapolated);
            assert!(!there.reasons.is_empty());
        }
    }
}
