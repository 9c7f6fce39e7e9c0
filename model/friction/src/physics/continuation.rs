//! States of one switch at loads that are not known in advance, each from the states before.

use super::coupled::Workspace;
use super::error::PhysicsError;
use super::switch::PhysicsSwitch;
use crate::switch::SwitchState;

/// Numerical continuation over the load: computes a state from those computed before. Loads may
/// come in any order; those near to one before are fastest.
///
/// ```
/// use pinswitch_friction::physics::{Constants, PhysicsSwitch};
/// use pinswitch_friction::{Contact, PinPattern, Substrate, published};
///
/// let pins = PinPattern::new(vec![-0.2, 0.2]);
/// let contact = Contact::new(Substrate::Silicone, pins, published::wrap_angle_rad())?;
/// let mut continuation = PhysicsSwitch::new(&contact, Constants::published()).continuation();
/// let (heavy, light) = (continuation.state(50.0)?, continuation.state(10.0)?);
/// assert!(light.silicone_share < heavy.silicone_share);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Continuation {
    switch: PhysicsSwitch,
    workspace: Option<Workspace>,
}

impl PhysicsSwitch {
    /// Starts a continuation, without a state.
    pub fn continuation(self) -> Continuation {
        Continuation { workspace: self.workspace(), switch: self }
    }
}

impl Continuation {
    /// Computes the state at `load_n` newtons.
    ///
    /// # Errors
    /// [`PhysicsError`] if the model does not converge.
    pub fn state(&mut self, load_n: f64) -> Result<SwitchState, PhysicsError> {
        Ok(self.switch.state_from(load_n, self.workspace.as_mut())?.0)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use crate::physics::{Constants, PhysicsSwitch};
    use crate::{Contact, PinPattern, Substrate, published};

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(40))]
        /// The order of the loads is without effect on a state.
        #[test]
        fn states_do_not_depend_on_the_order(
            pins in prop::collection::vec(-0.6..0.6f64, 1..5),
            loads in prop::collection::vec(1.0..80.0f64, 1..6),
        ) {
            let mut pins = pins;
            pins.sort_by(f64::total_cmp);
            pins.dedup_by(|a, b| (*a - *b).abs() < 0.08);
            let contact = Contact::new(Substrate::Silicone, PinPattern::new(pins), published::wrap_angle_rad()).unwrap();
            let switch = PhysicsSwitch::new(&contact, Constants::published());
            let mut continuation = switch.clone().continuation();
            for load in loads {
                let (one, alone) = (continuation.state(load).unwrap(), switch.states(&[load]).unwrap()[0]);
                prop_assert!((one.friction_n / alone.friction_n - 1.0).abs() < 1e-6, "{load}: {one:?} {alone:?}");
                prop_assert!((one.silicone_share - alone.silicone_share).abs() < 1e-6, "{load}: {one:?} {alone:?}");
            }
        }
    }
}
