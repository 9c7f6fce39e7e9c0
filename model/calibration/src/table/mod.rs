//! Plateau tables with their rows ([`pinswitch_measurements::table`]), and the quantities of a whole
//! session that a model needs.

mod change;
mod frame;

pub use change::{Change, Changing, Grouping};
pub use frame::{Condition, Frame, Point};
pub(crate) use frame::{groups, interpolate};
pub use pinswitch_measurements::table::*;
