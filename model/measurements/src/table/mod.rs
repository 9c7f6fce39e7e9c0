//! Plateau tables and their rows (`model/doc/file-formats.md`).

mod columns;
mod csv_line;
mod follows;
mod friction_gap;
mod joined;
mod plateau_table;
mod plausible_table;
mod readings;
mod row;
mod row_cells;
pub mod substrate_word;
mod swapped_columns;
mod table_error;
mod units;
mod unknown;
mod whole_series;

pub use columns::column_unit;
pub use csv_line::push_line;
pub use plateau_table::PlateauTable;
pub use plateau_table::{MAX_N, MAX_PERCENT, MAX_WRAP_DEG, MIN_WRAP_DEG};
pub use readings::readings_by_session;
pub use readings::{is_fingerprint, matching_sessions};
pub use row::{Labels, PlateauRow, Sweep};
pub use substrate_word::substrate_word;
pub use table_error::TableError;
pub use unknown::{Optional, Unknown, with_complete_columns};
