//! Directions in which parameters change to satisfy a rule.

use crate::config::Configuration;
use crate::config::parameter::{Parameter, number};

/// A direction in which one parameter may change to satisfy a broken rule: a hint for [`crate::feasibility`], which
/// finds the value, if there is one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Direction {
    /// A smaller value of this parameter.
    Lower(&'static str),
    /// A larger value of this parameter.
    Raise(&'static str),
    /// A smaller value, down to the default: for parameters that are rarely below their default.
    Restore(&'static str),
    /// Another of these values: for parts that are sold in sizes.
    OneOf(&'static str, &'static [f64]),
    /// This value, as TOML.
    Set(&'static str, &'static str),
}

impl Direction {
    /// Returns the path of the parameter.
    pub const fn field(self) -> &'static str {
        match self {
            Self::Lower(field)
            | Self::Raise(field)
            | Self::Restore(field)
            | Self::OneOf(field, _)
            | Self::Set(field, _) => field,
        }
    }

    /// Returns the parameter; `None` for a path that does not exist.
    pub(crate) fn parameter(self) -> Option<&'static Parameter<Configuration>> {
        Configuration::PARAMETERS.iter().find(|p| p.path() == self.field())
    }

    /// Whether the parameter departs from its default against this direction, and is therefore a likely cause.
    pub(super) fn is_cause(self, c: &Configuration) -> bool {
        let Some(parameter) = self.parameter() else { return false };
        let value = |c: &Configuration| number(&(parameter.get)(c));
        let (Some(now), Some(default)) = (value(c), value(&Configuration::default())) else { return false };
        match self {
            Self::Lower(_) | Self::Restore(_) => now > default,
            Self::Raise(_) => now < default,
            Self::OneOf(..) => now != default,
            Self::Set(..) => false,
        }
    }
}
