//! `physics`: a string over sinking pins on silicone, for any layout.

use super::{Definition, Support};
use crate::physics::physics_curve;

pub(super) static DEFINITION: Definition = Definition {
    word: "physics",
    title: "physics",
    summary: "A string over sinking pins on silicone: any layout",
    source: "string over sinking pins on a silicone foundation, ploughing of the coating; three constants fitted to the \
             seven published maxima",
    needs_model: false,
    support: |_| Support::General,
    curve: |contact, loads_n| Ok(physics_curve(contact, loads_n)?),
};
