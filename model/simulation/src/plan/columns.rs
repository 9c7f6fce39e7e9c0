//! Optional columns of the simulated table.

use serde::{Deserialize, Serialize};

/// Which optional columns are written beside those of every plateau table (`model/doc/file-formats.md`).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ColumnsPlan {
    /// `mount`: a number that grows each time another condition is put on.
    pub mount: bool,
    /// `operator`: 1 or 2.
    pub operator: bool,
}

impl ColumnsPlan {
    /// Whether no optional column is asked for.
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }
}
