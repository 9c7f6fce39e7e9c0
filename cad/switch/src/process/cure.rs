//! One cure: a temperature and a duration.

use schemars::JsonSchema;
use serde::Serialize;

/// A cure.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Cure {
    /// Temperature, °C.
    pub temperature_c: f64,
    /// Duration, h.
    pub hours: f64,
}

impl std::fmt::Display for Cure {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if self.hours < 1.0 {
            write!(f, "{:.0} min at {} \u{b0}C", 60.0 * self.hours, self.temperature_c)
        } else {
            write!(f, "{} h at {} \u{b0}C", self.hours, self.temperature_c)
        }
    }
}
