//! Material under the pins.

use serde::{Deserialize, Serialize};

/// Material under the pins.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Substrate {
    /// Cast silicone layer, into which the pins sink as the load grows.
    Silicone,
    /// Rigid printed proxy of that layer: the pins alone support the tendon.
    Abs,
}

impl Substrate {
    /// Returns the word of tables and configurations: `silicone` or `abs`.
    pub fn as_str(self) -> &'static str {
        match self {
            Substrate::Silicone => "silicone",
            Substrate::Abs => "abs",
        }
    }
}
