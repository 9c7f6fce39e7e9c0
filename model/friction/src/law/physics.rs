//! `physics`: a string over sinking pins on silicone, for any layout.

use super::Definition;
use crate::physics::{states, uncertain};

pub(super) static DEFINITION: Definition = Definition {
    word: "physics",
    title: "physics",
    summary: "A tendon over sinking pins on silicone: any layout; the default",
    source: "tendon over sinking pins on a silicone foundation, ploughing of the coating; three constants fitted to the \
             seven published maxima",
    needs_model: false,
    states: |contact, loads_n| Ok(states(contact, loads_n)?),
    uncertain: |contact, loads_n| Ok(uncertain(contact, loads_n)?),
    remark: crate::physics::unexplained,
};
