//! What lies under the pins: silicone or its rigid proxy.

use serde::{Deserialize, Serialize};

/// What lies under the pins.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Substrate {
    /// The cast silicone layer: pins sink as load grows.
    Silicone,
    /// The rigid printed proxy of that layer: the pins alone carry the tendon.
    Abs,
}

impl Substrate {
    /// The word in tables and configurations: `silicone` or `abs`.
    pub fn as_str(self) -> &'static str {
        match self {
            Substrate::Silicone => "silicone",
            Substrate::Abs => "abs",
        }
    }
}
