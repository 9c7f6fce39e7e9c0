//! Forces and gaps along the wrap, for figures and checks.

use serde::Serialize;

use super::constants::PUBLISHED_FIT;
use super::error::PhysicsError;
use super::march::Sliding;
use super::switch::PhysicsSwitch;
use crate::capstan::Direction;
use crate::contact::Contact;

/// Tendon along the wrap at one load, sliding in one direction.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ContactProfile {
    /// Angles in radians, ascending; zero is the middle of the wrap.
    pub angle_rad: Vec<f64>,
    /// Gap between the tendon's underside and the undeformed silicone, mm.
    pub gap_mm: Vec<f64>,
    /// First and last angle at which silicone can touch the tendon, rad.
    pub silicone_rad: (f64, f64),
    /// Local tension, N.
    pub tension_n: Vec<f64>,
    /// Angle of each pin, rad.
    pub pin_angle_rad: Vec<f64>,
    /// Force of each pin, N.
    pub pin_n: Vec<f64>,
    /// Turn at each pin, rad.
    pub pin_turn_rad: Vec<f64>,
    /// Turn on the silicone, rad.
    pub silicone_turn_rad: f64,
}

/// Computes the profile of `contact` under `load_n` newtons, with the published constants.
///
/// # Errors
/// [`PhysicsError`] if the model does not converge.
pub fn contact_profile(
    contact: &Contact,
    load_n: f64,
    direction: Direction,
) -> Result<ContactProfile, PhysicsError> {
    let switch = PhysicsSwitch::new(contact, PUBLISHED_FIT.constants());
    Ok(profile(&switch, switch.sliding(load_n, direction, None)?))
}

/// Computes the profiles under several loads in newtons. Each starts from the previous one, which
/// is fast for similar loads.
///
/// # Errors
/// [`PhysicsError`] if the model does not converge.
pub fn contact_profiles(
    contact: &Contact,
    loads_n: &[f64],
    direction: Direction,
) -> Result<Vec<ContactProfile>, PhysicsError> {
    let switch = PhysicsSwitch::new(contact, PUBLISHED_FIT.constants());
    let mut states: Vec<Sliding> = Vec::with_capacity(loads_n.len());
    for load_n in loads_n {
        states.push(switch.sliding(*load_n, direction, states.last())?);
    }
    Ok(states.into_iter().map(|state| profile(&switch, state)).collect())
}

fn profile(switch: &PhysicsSwitch, sliding: Sliding) -> ContactProfile {
    ContactProfile {
        angle_rad: switch.angles_rad().to_vec(),
        silicone_rad: switch.silicone_rad(),
        gap_mm: sliding.shape.gap_mm,
        tension_n: sliding.tension_n,
        pin_angle_rad: switch.pins_rad(),
        pin_n: sliding.shape.pin_n,
        pin_turn_rad: sliding.pin_turn_rad,
        silicone_turn_rad: sliding.silicone_turn_rad,
    }
}
