//! Measured data of the friction rig: plateau tables, their rows, and what a session as a whole fixes.

mod frame;
mod plateau_table;
mod plausible_table;
mod row;
mod table_error;

pub(crate) use frame::groups;
pub use frame::{Condition, Frame, Point};
pub use plateau_table::PlateauTable;
pub use row::{PlateauRow, Surface, Sweep};
pub use table_error::TableError;
