//! Friction of the contacts with which bands compare a contact, such as the published rig with the
//! same pins. The contacts of a sweep share most of them, so that the last ones are kept.

use std::cell::RefCell;
use std::collections::VecDeque;

use crate::bed::Bed;
use crate::contact::Contact;
use crate::physics::{Constants, PhysicsError, PhysicsSwitch};
use crate::substrate::Substrate;

/// Number of contacts whose friction a thread keeps, about 1 kB each.
const KEPT: usize = 256;

thread_local! {
    /// The last references of this thread, the newest first.
    static LAST: RefCell<VecDeque<Reference>> = const { RefCell::new(VecDeque::new()) };
}

/// Friction with all that it depends on.
struct Reference {
    substrate: Substrate,
    pins_rad: Vec<f64>,
    wrap_rad: f64,
    bed: Bed,
    load_n: Vec<f64>,
    friction_n: Result<Vec<f64>, PhysicsError>,
}

impl Reference {
    fn is_of(&self, contact: &Contact, load_n: &[f64]) -> bool {
        self.bed == *contact.bed()
            && self.wrap_rad == contact.wrap_rad()
            && self.pins_rad == contact.all_pins().angles_rad()
            && self.substrate == contact.substrate()
            && self.load_n == load_n
    }
}

/// Computes the friction of `contact` at `load_n` newtons by the physics with the published
/// constants, unless it is one of the last that this thread has computed.
///
/// # Errors
/// [`PhysicsError`] if the model does not converge.
pub(crate) fn reference_friction_n(contact: &Contact, load_n: &[f64]) -> Result<Vec<f64>, PhysicsError> {
    let known = LAST.with_borrow(|last| {
        let reference = last.iter().find(|reference| reference.is_of(contact, load_n))?;
        Some(reference.friction_n.clone())
    });
    if let Some(friction_n) = known {
        return friction_n;
    }
    let states = PhysicsSwitch::new(contact, Constants::published()).states(load_n);
    let friction_n = states.map(|states| states.iter().map(|s| s.friction_n).collect::<Vec<_>>());
    LAST.with_borrow_mut(|last| {
        last.truncate(KEPT - 1);
        last.push_front(Reference {
            substrate: contact.substrate(),
            pins_rad: contact.all_pins().angles_rad().to_vec(),
            wrap_rad: contact.wrap_rad(),
            bed: *contact.bed(),
            load_n: load_n.to_vec(),
            friction_n: friction_n.clone(),
        });
    });
    friction_n
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pattern::PinPattern;

    /// Each number of a contact changes what is returned.
    #[test]
    fn kept_friction_is_of_the_same_contact() {
        let contact = |pitch: f64, wrap: f64| {
            Contact::new(Substrate::Silicone, PinPattern::even(3, pitch), wrap).unwrap()
        };
        let base = contact(0.3, 1.1);
        let thick = base.clone().with_bed(Bed { layer_mm: 2.5, ..*base.bed() });
        let loads = [5.0, 20.0];
        for _ in 0..2 {
            for contact in [&base, &thick, &contact(0.31, 1.1), &contact(0.3, 1.2)] {
                let states = PhysicsSwitch::new(contact, Constants::published()).states(&loads).unwrap();
                let fresh: Vec<f64> = states.iter().map(|s| s.friction_n).collect();
                assert_eq!(reference_friction_n(contact, &loads).unwrap(), fresh);
            }
        }
        assert_ne!(
            reference_friction_n(&base, &[5.0]).unwrap(),
            reference_friction_n(&base, &[6.0]).unwrap()
        );
    }
}
