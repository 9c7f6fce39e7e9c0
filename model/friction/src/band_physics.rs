//! The physics that the bands of all laws use, computed once for a contact.

use crate::band::spaced;
use crate::bed::{Bed, OutsidePins};
use crate::contact::Contact;
use crate::deviation::{Deviation, deviations_from, published_rig};
use crate::physics::{Constants, PhysicsError, PhysicsSwitch, Sensitivities};
use crate::reference::reference_friction_n;
use crate::substrate::Substrate;
use crate::switch::SwitchState;

/// Largest relative difference between equal loads.
const SAME_LOAD: f64 = 1e-12;

/// Physics of a contact at the loads of a band: friction with its sensitivities, the deviations
/// from the published rig, and the friction of the same pins on that rig.
///
/// [`predict_with_physics`](crate::predict_with_physics) returns it with a curve, so that
/// [`other_laws_with_physics`](crate::other_laws_with_physics) need not compute it again.
#[derive(Clone, Debug)]
pub struct BandPhysics {
    pub(crate) load_n: Vec<f64>,
    pub(crate) here: Result<FrictionWithSensitivities, PhysicsError>,
    /// Friction with free spans outside the pins, in newtons, if they differ.
    pub(crate) free_n: Option<Vec<f64>>,
    pub(crate) deviations: Vec<Deviation>,
    /// The same pins on the published rig, if the contact deviates from it.
    pub(crate) rig: Option<RigPhysics>,
}

/// Friction at the loads of a band, with its sensitivities.
#[derive(Clone, Debug)]
pub(crate) struct FrictionWithSensitivities {
    pub(crate) friction_n: Vec<f64>,
    pub(crate) sensitivities: Vec<Sensitivities>,
}

/// Physics of the published rig with the pins of a contact.
#[derive(Clone, Debug)]
pub(crate) struct RigPhysics {
    pub(crate) contact: Contact,
    pub(crate) friction_n: Result<Vec<f64>, PhysicsError>,
    /// Friction with free spans outside the pins, in newtons, if they differ.
    pub(crate) free_n: Option<Vec<f64>>,
}

impl BandPhysics {
    /// Computes the physics of `contact` for a band over the range of `loads_n` newtons.
    pub(crate) fn new(contact: &Contact, loads_n: &[f64]) -> Self {
        let load_n = spaced(loads_n);
        let switch = PhysicsSwitch::new(contact, Constants::published());
        let here = switch.states_and_sensitivities(&load_n, |_| true).map(|(states, sensitivities)| {
            FrictionWithSensitivities { friction_n: friction_n(&states), sensitivities }
        });
        Self::with_friction(contact, load_n, here)
    }

    /// Computes also the states at `loads_n` newtons: one pass over the loads of curve and band.
    pub(crate) fn with_states(
        contact: &Contact,
        loads_n: &[f64],
    ) -> Result<(Vec<SwitchState>, Self), PhysicsError> {
        let load_n = spaced(loads_n);
        // Curve and band in ascending order: load, position in the curve or in the band.
        let curve = loads_n.iter().enumerate().map(|(i, load)| (*load, i, false));
        let band = load_n.iter().enumerate().map(|(i, load)| (*load, i, true));
        let mut order: Vec<(f64, usize, bool)> = curve.chain(band).collect();
        order.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut loads: Vec<f64> = order.iter().map(|o| o.0).collect();
        loads.dedup_by(|a, b| (*a - *b).abs() <= SAME_LOAD * b.abs());
        let position = |load: f64| loads.partition_point(|l| *l < load * (1.0 - 2.0 * SAME_LOAD));
        let mut is_needed = vec![false; loads.len()];
        load_n.iter().for_each(|load| is_needed[position(*load).min(loads.len() - 1)] = true);
        let switch = PhysicsSwitch::new(contact, Constants::published());
        let (states, sensitivities) = switch.states_and_sensitivities(&loads, |i| is_needed[i])?;
        let at = |load: &f64| position(*load).min(states.len() - 1);
        let curve = loads_n.iter().map(|load| SwitchState { load_n: *load, ..states[at(load)] }).collect();
        let here = FrictionWithSensitivities {
            friction_n: load_n.iter().map(|load| states[at(load)].friction_n).collect(),
            sensitivities: load_n.iter().map(|load| sensitivities[at(load)]).collect(),
        };
        Ok((curve, Self::with_friction(contact, load_n, Ok(here))))
    }

    fn with_friction(
        contact: &Contact,
        load_n: Vec<f64>,
        here: Result<FrictionWithSensitivities, PhysicsError>,
    ) -> Self {
        let own = here.as_ref().ok().map(|here| here.friction_n.as_slice());
        let deviations = deviations_from(contact, &load_n, own);
        let rig = published_rig(contact).filter(|_| !deviations.is_empty()).map(|rig| RigPhysics {
            friction_n: reference_friction_n(&rig, &load_n),
            free_n: friction_with_free_spans(&rig, &load_n),
            contact: rig,
        });
        Self { free_n: friction_with_free_spans(contact, &load_n), load_n, here, deviations, rig }
    }

    /// Whether this is the physics of a band over the range of `loads_n` newtons.
    pub(crate) fn covers(&self, loads_n: &[f64]) -> bool {
        let load_n = spaced(loads_n);
        let is_same = |(a, b): (&f64, &f64)| (a - b).abs() <= SAME_LOAD * b.abs();
        self.load_n.len() == load_n.len() && self.load_n.iter().zip(&load_n).all(is_same)
    }
}

fn friction_n(states: &[SwitchState]) -> Vec<f64> {
    states.iter().map(|s| s.friction_n).collect()
}

/// Computes friction by the second likely hypothesis about the tendon's path, for pins on silicone.
fn friction_with_free_spans(contact: &Contact, load_n: &[f64]) -> Option<Vec<f64>> {
    if contact.substrate() == Substrate::Abs || contact.all_pins().count() == 0 {
        return None;
    }
    let free = Bed { outside: OutsidePins::Free, bending_n_mm2: 0.0, ..*contact.bed() };
    reference_friction_n(&contact.clone().with_bed(free), load_n).ok()
}
