//! `physics`: a tendon over sinking pins on silicone, for any layout.

use nalgebra::Matrix3;
use statrs::distribution::{ContinuousCDF, StudentsT};

use super::definition::{LawDefinition, UncertainFriction};
use super::error::LawError;
use crate::band_physics::FrictionWithSensitivities;
use crate::band_source::BandSource;
use crate::contact::Contact;
use crate::physics::{Constants, PUBLISHED_FIT, PhysicsSwitch};
use crate::published;
use crate::substrate::Substrate;

pub(super) static DEFINITION: LawDefinition = LawDefinition {
    word: "physics",
    title: "physics",
    summary: "Tendon over sinking pins on silicone: any layout; the default",
    source: "tendon over sinking pins on a silicone foundation, ploughing of the coating; three constants fitted to the \
             seven published maxima",
    needs_model: false,
    states: |contact, loads_n| Ok(PhysicsSwitch::new(contact, Constants::published()).states(loads_n)?),
    uncertain,
    remark: unexplained,
};

/// Coverage of a band.
const CONFIDENCE: f64 = 0.95;

/// Predicts the friction of `contact` with two sources of uncertainty: the constants, by their
/// covariance, and the model, by its leave-one-layout-out error on the published layouts.
fn uncertain(contact: &Contact, loads_n: &[f64]) -> Result<UncertainFriction, LawError> {
    let switch = PhysicsSwitch::new(contact, PUBLISHED_FIT.constants());
    let (states, sensitivities) = switch.states_and_sensitivities(loads_n, |_| true)?;
    let friction_n = states.iter().map(|s| s.friction_n).collect();
    Ok(with_uncertainty(FrictionWithSensitivities { friction_n, sensitivities }))
}

/// Adds both sources of uncertainty to known friction.
pub(crate) fn with_uncertainty(known: FrictionWithSensitivities) -> UncertainFriction {
    let fit = &PUBLISHED_FIT;
    let FrictionWithSensitivities { friction_n, sensitivities } = known;
    let covariance = Matrix3::from_row_slice(&fit.covariance.concat());
    let quantile = StudentsT::new(0.0, 1.0, fit.degrees_of_freedom)
        .map_or(2.78, |t| t.inverse_cdf(0.5 + CONFIDENCE / 2.0));
    let constants = sensitivities
        .iter()
        .map(|all| all.fixed_rows::<3>(0).into_owned())
        .map(|g| quantile * (g.transpose() * covariance * g)[(0, 0)].sqrt())
        .collect();
    let model = vec![quantile * fit.left_out_rms; friction_n.len()];
    UncertainFriction {
        friction_n,
        sources: vec![BandSource::symmetric("constants", constants), BandSource::symmetric("model", model)],
    }
}

/// Returns the known error of the physics for a published condition.
fn unexplained(contact: &Contact) -> Option<String> {
    let layout = contact.published_layout().filter(|_| contact.substrate() == Substrate::Silicone)?;
    (layout.pins == 3).then(|| {
        format!(
            "physics predicts nearly the same maximum for three-double and three-single, measured are {:.2} and {:.2} N",
            published::LAYOUTS[1].device_max_n,
            published::LAYOUTS[2].device_max_n
        )
    })
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;
    use crate::pattern::PinPattern;

    /// The approximate sensitivities of the band agree with those by finite differences.
    #[test]
    fn band_follows_the_sensitivities() {
        let layout = &published::LAYOUTS[1];
        let pins = PinPattern::even(layout.pins, layout.pitch_rad());
        let contact = Contact::new(Substrate::Silicone, pins, published::wrap_angle_rad()).unwrap();
        let loads = [10.0, 30.0, 49.671];
        let predicted = uncertain(&contact, &loads).unwrap();
        let constants = predicted.sources.iter().find(|s| s.name == "constants").unwrap();
        let covariance = Matrix3::from_row_slice(&PUBLISHED_FIT.covariance.concat());
        for (i, load) in loads.iter().enumerate() {
            let at = Constants::published().logarithms();
            let log_friction = |at: &Vector3<f64>| {
                libm::log(
                    PhysicsSwitch::new(&contact, Constants::from_logarithms(at)).friction_n(*load).unwrap(),
                )
            };
            let slope = Vector3::from_fn(|k, _| {
                let mut moved = at;
                moved[k] += 1e-3;
                (log_friction(&moved) - log_friction(&at)) / 1e-3
            });
            let exact = 2.776 * (slope.transpose() * covariance * slope)[(0, 0)].sqrt();
            assert!(
                (constants.up[i] / exact - 1.0).abs() < 0.15,
                "at {load} N: {} for {exact}",
                constants.up[i]
            );
        }
    }
}
