//! One parameter: its unit, range, origin and reason, and its conversion from and to TOML.

use pinswitch_diagnostic::codes;
use schemars::JsonSchema;
use serde::Serialize;
use toml_edit::{Array, Value};

use super::ValueError;

/// The origin of a default value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Origin {
    /// Printed in the paper.
    Published,
    /// Not published; marked as an assumption wherever it is shown.
    Assumed,
    /// Chosen by this project, with a reason.
    Chosen,
}

impl std::fmt::Display for Origin {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Published => "published",
            Self::Assumed => "assumed",
            Self::Chosen => "chosen",
        })
    }
}

/// One parameter of a configuration of type `C`.
pub struct Parameter<C> {
    /// Table, such as `shell`; empty at the top level.
    pub section: &'static str,
    /// Key, such as `width_mm`.
    pub key: &'static str,
    /// Origin of the default.
    pub origin: Origin,
    /// Accepted values, in words or as `low to high`.
    pub range: fn() -> String,
    /// Least and greatest value of a number; `None` for texts, choices and lists.
    pub ends: fn() -> Option<[f64; 2]>,
    /// Every value of a choice as TOML; empty for any other parameter.
    pub choices: fn() -> Vec<Value>,
    /// Meaning of the parameter, and the reason for its default.
    pub reason: &'static str,
    /// Returns the value in a configuration.
    pub get: fn(&C) -> Value,
    /// Sets the value, or returns why it is not accepted.
    pub set: fn(&mut C, &Value) -> Result<(), ValueError>,
}

impl<C> Parameter<C> {
    /// Returns `section.key`, as in a dotted TOML key.
    pub fn path(&self) -> String {
        if self.section.is_empty() { self.key.to_owned() } else { format!("{}.{}", self.section, self.key) }
    }

    /// Returns the unit that the key ends in; empty for dimensionless numbers, texts, choices and lists.
    pub fn unit(&self) -> &'static str {
        const UNITS: [(&str, &str); 10] = [
            ("_g_cm3", "g/cm3"),
            ("_mm_s", "mm/s"),
            ("_hz", "Hz"),
            ("_mm", "mm"),
            ("_deg", "deg"),
            ("_pct", "%"),
            ("_n", "N"),
            ("_g", "g"),
            ("_a", "Shore A"),
            ("_c", "C"),
        ];
        UNITS.iter().find(|(ending, _)| self.key.ends_with(ending)).map_or("", |(_, unit)| unit)
    }
}

/// A number of a TOML value, whether it is written as a float or as an integer.
#[allow(clippy::cast_precision_loss)]
pub(crate) fn number(value: &Value) -> Option<f64> {
    value.as_float().or_else(|| value.as_integer().map(|i| i as f64))
}

/// A type that a parameter can have.
pub trait ParameterValue: Sized {
    /// Bounds of the type: a range for numbers, nothing for choices.
    type Bounds;
    /// Reads a TOML value within bounds.
    ///
    /// # Errors
    /// [`ValueError`] for a value of another type or outside the bounds.
    fn read(value: &Value, bounds: &Self::Bounds) -> Result<Self, ValueError>;
    /// Returns the TOML value.
    fn write(&self) -> Value;
    /// Describes the accepted values.
    fn describe(bounds: &Self::Bounds) -> String;
    /// Returns the bounds of a number.
    fn ends(_bounds: &Self::Bounds) -> Option<[f64; 2]> {
        None
    }
    /// Returns every value of a choice.
    fn choices() -> Vec<Value> {
        Vec::new()
    }
}

type Range<T> = std::ops::RangeInclusive<T>;

/// The error of a number outside `range`.
fn outside(range: &str, what: &str) -> ValueError {
    ValueError::new(codes::OUT_OF_RANGE, format!("outside {range}"), format!("give a {what} from {range}"))
}

impl ParameterValue for f64 {
    type Bounds = Range<f64>;

    fn read(value: &Value, bounds: &Self::Bounds) -> Result<Self, ValueError> {
        let range = Self::describe(bounds);
        match number(value) {
            Some(number) if bounds.contains(&number) => Ok(number),
            Some(_) => Err(outside(&range, "number")),
            None => Err(ValueError::new(
                codes::WRONG_TYPE,
                "not a number",
                format!("give a number from {range}, without quotes"),
            )),
        }
    }

    fn write(&self) -> Value {
        Value::from(*self)
    }

    fn describe(bounds: &Self::Bounds) -> String {
        format!("{} to {}", bounds.start(), bounds.end())
    }

    fn ends(bounds: &Self::Bounds) -> Option<[f64; 2]> {
        Some([*bounds.start(), *bounds.end()])
    }
}

impl ParameterValue for usize {
    type Bounds = Range<usize>;

    fn read(value: &Value, bounds: &Self::Bounds) -> Result<Self, ValueError> {
        let range = Self::describe(bounds);
        match value.as_integer().map(usize::try_from) {
            Some(Ok(number)) if bounds.contains(&number) => Ok(number),
            Some(_) => Err(outside(&range, "whole number")),
            None => {
                let help = format!("give a whole number from {range}, without quotes");
                Err(ValueError::new(codes::WRONG_TYPE, "not a whole number", help))
            }
        }
    }

    fn write(&self) -> Value {
        Value::from(i64::try_from(*self).unwrap_or(i64::MAX))
    }

    fn describe(bounds: &Self::Bounds) -> String {
        format!("{} to {}", bounds.start(), bounds.end())
    }

    #[allow(clippy::cast_precision_loss)]
    fn ends(bounds: &Self::Bounds) -> Option<[f64; 2]> {
        Some([*bounds.start() as f64, *bounds.end() as f64])
    }
}

impl ParameterValue for bool {
    type Bounds = ();

    fn read(value: &Value, (): &()) -> Result<Self, ValueError> {
        let error =
            || ValueError::new(codes::WRONG_TYPE, "not a boolean", "give true or false, without quotes");
        value.as_bool().ok_or_else(error)
    }

    fn write(&self) -> Value {
        Value::from(*self)
    }

    fn describe((): &()) -> String {
        "true or false".to_owned()
    }

    fn choices() -> Vec<Value> {
        vec![Value::from(false), Value::from(true)]
    }
}

impl ParameterValue for String {
    /// Longest accepted text.
    type Bounds = usize;

    fn read(value: &Value, longest: &usize) -> Result<Self, ValueError> {
        let is_printable = |text: &str| text.chars().all(|c| (' '..='~').contains(&c));
        let (code, problem) = match value.as_str() {
            None => (codes::WRONG_TYPE, "not a text"),
            Some(text) if text.len() > *longest => (codes::UNKNOWN_WORD, "too long"),
            Some(text) if !is_printable(text) => (codes::UNKNOWN_WORD, "not printable ASCII"),
            Some(text) => return Ok(text.to_owned()),
        };
        Err(ValueError::new(code, problem, format!("give {}, in quotes", Self::describe(longest))))
    }

    fn write(&self) -> Value {
        Value::from(self.as_str())
    }

    fn describe(longest: &usize) -> String {
        format!("a text of at most {longest} ASCII characters")
    }
}

impl ParameterValue for Vec<usize> {
    type Bounds = ();

    fn read(value: &Value, (): &()) -> Result<Self, ValueError> {
        let whole = |v: &Value| v.as_integer().and_then(|i| usize::try_from(i).ok());
        let error = || {
            ValueError::new(
                codes::WRONG_TYPE,
                "not a list of groove numbers",
                "give a list such as [5, 8, 11]",
            )
        };
        value.as_array().and_then(|list| list.iter().map(whole).collect()).ok_or_else(error)
    }

    fn write(&self) -> Value {
        Value::from(self.iter().map(|i| i64::try_from(*i).unwrap_or(i64::MAX)).collect::<Array>())
    }

    fn describe((): &()) -> String {
        "a list of groove numbers".to_owned()
    }
}

/// A parameter with a fixed set of named values.
pub trait Choice: Sized + Copy + PartialEq + 'static {
    /// Every value with its name.
    const NAMES: &'static [(Self, &'static str)];

    /// Returns the name of this value.
    fn as_str(self) -> &'static str {
        Self::NAMES.iter().find(|(choice, _)| *choice == self).map_or("", |(_, name)| name)
    }

    /// Returns the value called `name`.
    ///
    /// # Errors
    /// [`ValueError`] lists the names.
    fn from_name(name: Option<&str>) -> Result<Self, ValueError> {
        let choice = Self::NAMES.iter().find(|(_, n)| Some(*n) == name);
        let error = || ValueError::new(codes::UNKNOWN_WORD, "unknown value", format!("give {}", Self::all()));
        choice.map(|(choice, _)| *choice).ok_or_else(error)
    }

    /// Returns all names, quoted.
    fn all() -> String {
        Self::NAMES.iter().map(|(_, name)| format!("{name:?}")).collect::<Vec<_>>().join(" or ")
    }
}

/// Gives the values of an enum the names by which a parameter is set.
macro_rules! choice_values {
    ($name:ident { $($variant:ident = $word:literal),+ $(,)? }) => {
        impl $crate::config::parameter::Choice for $name {
            const NAMES: &'static [(Self, &'static str)] = &[$((Self::$variant, $word)),+];
        }

        impl $crate::config::parameter::ParameterValue for $name {
            type Bounds = ();
            fn read(value: &toml_edit::Value, (): &()) -> Result<Self, $crate::config::ValueError> {
                <Self as $crate::config::parameter::Choice>::from_name(value.as_str())
            }
            fn write(&self) -> toml_edit::Value {
                toml_edit::Value::from($crate::config::parameter::Choice::as_str(*self))
            }
            fn describe((): &()) -> String {
                <Self as $crate::config::parameter::Choice>::all()
            }
            fn choices() -> Vec<toml_edit::Value> {
                let names = <Self as $crate::config::parameter::Choice>::NAMES.iter();
                names.map(|(_, name)| toml_edit::Value::from(*name)).collect()
            }
        }
    };
}

/// Declares an enum whose variants a parameter can be set to.
macro_rules! choice {
    ($(#[$doc:meta])* $name:ident { $($(#[$vdoc:meta])* $variant:ident = $word:literal),+ $(,)? }) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum $name { $($(#[$vdoc])* $variant),+ }

        $crate::config::parameter::choice_values! { $name { $($variant = $word),+ } }
    };
}

/// Declares the tables of a configuration: one struct per table, and the list of all parameters.
macro_rules! configuration {
    (
        $(#[$doc:meta])* $name:ident {
            $($(#[$tdoc:meta])* $table:ident: $Table:ident {
                $($(#[$fdoc:meta])* $field:ident: $Type:ty = $default:expr, $bounds:expr, $origin:ident, $reason:literal;)*
            })*
        }
    ) => {
        $(
            $(#[$tdoc])*
            #[derive(Clone, Debug, PartialEq)]
            pub struct $Table { $($(#[$fdoc])* #[doc = $reason] pub $field: $Type),* }

            impl Default for $Table {
                fn default() -> Self { Self { $($field: $default),* } }
            }
        )*

        $(#[$doc])*
        #[derive(Clone, Debug, Default, PartialEq)]
        pub struct $name { $($(#[$tdoc])* pub $table: $Table),* }

        impl $name {
            /// Every parameter, table by table.
            pub const PARAMETERS: &'static [$crate::config::parameter::Parameter<Self>] = &[$($(
                $crate::config::parameter::Parameter {
                    section: stringify!($table),
                    key: stringify!($field),
                    origin: $crate::config::parameter::Origin::$origin,
                    range: || <$Type as $crate::config::parameter::ParameterValue>::describe(&$bounds),
                    ends: || <$Type as $crate::config::parameter::ParameterValue>::ends(&$bounds),
                    choices: <$Type as $crate::config::parameter::ParameterValue>::choices,
                    reason: $reason,
                    get: |c| $crate::config::parameter::ParameterValue::write(&c.$table.$field),
                    set: |c, value| {
                        c.$table.$field = <$Type as $crate::config::parameter::ParameterValue>::read(value, &$bounds)?;
                        Ok(())
                    },
                },
            )*)*];
        }
    };
}

pub(crate) use {choice, choice_values, configuration};
