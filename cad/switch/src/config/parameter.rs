//! One parameter: its unit, range, origin and reason, and how it is read from and written to TOML.

use serde::Serialize;
use toml_edit::{Array, Value};

/// Where a value comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Origin {
    /// Printed in the paper.
    Published,
    /// Not published; named as an assumption wherever it is shown.
    Assumed,
    /// A choice of ours, with its reason.
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
    /// Where the default comes from.
    pub origin: Origin,
    /// Accepted values, in words or as `low..=high`.
    pub range: fn() -> String,
    /// Least and greatest value of a number; `None` for words and lists.
    pub ends: fn() -> Option<[f64; 2]>,
    /// What it is and why it has this default.
    pub reason: &'static str,
    /// The value in a configuration.
    pub get: fn(&C) -> Value,
    /// Sets the value, or says what would be accepted.
    pub set: fn(&mut C, &Value) -> Result<(), String>,
}

impl<C> Parameter<C> {
    /// `section.key`, as in a dotted TOML key.
    pub fn path(&self) -> String {
        if self.section.is_empty() { self.key.to_owned() } else { format!("{}.{}", self.section, self.key) }
    }

    /// The unit, from the key's ending; `1` for a plain number, empty for words.
    pub fn unit(&self) -> &'static str {
        const UNITS: [(&str, &str); 7] = [
            ("_g_cm3", "g/cm3"),
            ("_mm", "mm"),
            ("_deg", "deg"),
            ("_pct", "%"),
            ("_n", "N"),
            ("_g", "g"),
            ("_a", "Shore A"),
        ];
        UNITS.iter().find(|(ending, _)| self.key.ends_with(ending)).map_or("", |(_, unit)| unit)
    }
}

/// A type that a parameter can have.
pub trait ParameterValue: Sized {
    /// Bounds of the type: a range for numbers, nothing for words.
    type Bounds;
    /// Reads a TOML value within bounds, or says what would be accepted.
    fn read(value: &Value, bounds: &Self::Bounds) -> Result<Self, String>;
    /// The TOML value.
    fn write(&self) -> Value;
    /// The bounds in words.
    fn describe(bounds: &Self::Bounds) -> String;
    /// The bounds of a number.
    fn ends(_bounds: &Self::Bounds) -> Option<[f64; 2]> {
        None
    }
}

type Range<T> = std::ops::RangeInclusive<T>;

impl ParameterValue for f64 {
    type Bounds = Range<f64>;

    fn read(value: &Value, bounds: &Self::Bounds) -> Result<Self, String> {
        #[allow(clippy::cast_precision_loss)]
        let number = value.as_float().or_else(|| value.as_integer().map(|i| i as f64));
        match number {
            Some(number) if bounds.contains(&number) => Ok(number),
            Some(_) => Err(format!("give a number within {}", Self::describe(bounds))),
            None => Err(format!("give a number within {}, without quotes", Self::describe(bounds))),
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

    fn read(value: &Value, bounds: &Self::Bounds) -> Result<Self, String> {
        let number = value.as_integer().and_then(|i| usize::try_from(i).ok());
        number
            .filter(|n| bounds.contains(n))
            .ok_or_else(|| format!("give a whole number within {}", Self::describe(bounds)))
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

    fn read(value: &Value, (): &()) -> Result<Self, String> {
        value.as_bool().ok_or_else(|| "give true or false, without quotes".to_owned())
    }

    fn write(&self) -> Value {
        Value::from(*self)
    }

    fn describe((): &()) -> String {
        "true or false".to_owned()
    }
}

impl ParameterValue for String {
    /// Longest accepted text.
    type Bounds = usize;

    fn read(value: &Value, longest: &usize) -> Result<Self, String> {
        let printable =
            |text: &&str| text.len() <= *longest && text.chars().all(|c| (' '..='~').contains(&c));
        value
            .as_str()
            .filter(printable)
            .map(str::to_owned)
            .ok_or_else(|| format!("give {} in quotes", Self::describe(longest)))
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

    fn read(value: &Value, (): &()) -> Result<Self, String> {
        let whole = |v: &Value| v.as_integer().and_then(|i| usize::try_from(i).ok());
        value
            .as_array()
            .and_then(|list| list.iter().map(whole).collect())
            .ok_or_else(|| "give a list of groove numbers such as [5, 8, 11]".to_owned())
    }

    fn write(&self) -> Value {
        Value::from(self.iter().map(|i| i64::try_from(*i).unwrap_or(i64::MAX)).collect::<Array>())
    }

    fn describe((): &()) -> String {
        "a list of groove numbers".to_owned()
    }
}

/// A choice between words.
pub trait Choice: Sized + Copy + PartialEq + 'static {
    /// Every choice with its word.
    const NAMES: &'static [(Self, &'static str)];

    /// The word of this choice.
    fn as_str(self) -> &'static str {
        Self::NAMES.iter().find(|(choice, _)| *choice == self).map_or("", |(_, word)| word)
    }

    /// The choice that `word` names; the error lists the words.
    fn choose(word: Option<&str>) -> Result<Self, String> {
        let found = Self::NAMES.iter().find(|(_, w)| Some(*w) == word);
        found.map(|(choice, _)| *choice).ok_or_else(|| format!("give {}", Self::all()))
    }

    /// All words, quoted.
    fn all() -> String {
        Self::NAMES.iter().map(|(_, word)| format!("{word:?}")).collect::<Vec<_>>().join(" or ")
    }
}

/// Gives an enum names by which a parameter can be set.
macro_rules! choice_values {
    ($name:ident { $($variant:ident = $word:literal),+ $(,)? }) => {
        impl $crate::config::parameter::Choice for $name {
            const NAMES: &'static [(Self, &'static str)] = &[$((Self::$variant, $word)),+];
        }

        impl $crate::config::parameter::ParameterValue for $name {
            type Bounds = ();
            fn read(value: &toml_edit::Value, (): &()) -> Result<Self, String> {
                <Self as $crate::config::parameter::Choice>::choose(value.as_str())
            }
            fn write(&self) -> toml_edit::Value {
                toml_edit::Value::from($crate::config::parameter::Choice::as_str(*self))
            }
            fn describe((): &()) -> String {
                <Self as $crate::config::parameter::Choice>::all()
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
