//! Optional columns of the simulated table.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Optional columns of the simulated table (`model/doc/file-formats.md`).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct ColumnsPlan {
    /// `mount`: the number of the mount.
    pub mount: bool,
    /// `operator`: 1 or 2.
    pub operator: bool,
}

impl ColumnsPlan {
    /// Whether the plan has no optional columns.
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }
}
