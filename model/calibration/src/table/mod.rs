//! Plateau tables, their rows, and quantities of a whole session (`model/doc/file-formats.md`).

mod change;
mod columns;
mod follows;
mod frame;
mod friction_gap;
mod joined;
mod plateau_table;
mod plausible_table;
mod readings;
mod row;
mod row_cells;
pub(crate) mod substrate_word;
mod swapped_columns;
mod table_error;
mod units;
mod whole_series;

pub use change::{Change, Changing, Grouping};
pub use frame::{Condition, Frame, Point};
pub(crate) use frame::{groups, interpolate};
pub use plateau_table::PlateauTable;
pub(crate) use plateau_table::{MAX_N, MAX_PERCENT, MAX_WRAP_DEG, MIN_WRAP_DEG};
pub use readings::readings_by_session;
pub(crate) use readings::{is_fingerprint, matching_sessions};
pub use row::{Labels, PlateauRow, Sweep};
pub use substrate_word::substrate_word;
pub use table_error::TableError;
