//! Plateau tables, their rows, and what a session as a whole fixes (`model/doc/file-formats.md`).

mod columns;
mod frame;
mod plateau_table;
mod plausible_table;
mod row;
pub(crate) mod substrate_word;
mod table_error;

pub(crate) use frame::groups;
pub use frame::{Condition, Frame, Point};
pub use plateau_table::PlateauTable;
pub(crate) use plateau_table::{MAX_N, MAX_PERCENT, MAX_WRAP_DEG, MIN_WRAP_DEG};
pub use row::{PlateauRow, Sweep};
pub use substrate_word::substrate_word;
pub use table_error::TableError;
