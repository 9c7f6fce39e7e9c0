//! The map of a file: every decision of an import, in the form that a person may write and that is written
//! next to a table.

use std::collections::BTreeMap;

use pinswitch_diagnostic::{Code, Diagnostic, Location, codes};
use pinswitch_friction::Direction;

use crate::clock::DateOrder;
use crate::decimal::Decimal;
use crate::dialect::Delimiter;
use crate::number::DecimalSign;
use crate::quantity::Quantity;
use crate::unit::Unit;

/// Schema of a map.
pub const SCHEMA: &str = "pinswitch.import/1";

/// What a file is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// One reading of the steady force in each row, or several in a wide row.
    Table,
    /// Force over time.
    Log,
}

impl Kind {
    /// Returns the word of the option `kind`.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Table => "table",
            Self::Log => "log",
        }
    }
}

/// What a person decides about one column; what is `None` follows from the file.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct ColumnChoice {
    pub(crate) quantity: Option<Quantity>,
    pub(crate) unit: Option<&'static Unit>,
    /// Whether the unit was decided for the file at hand, whatever its row of units is.
    pub(crate) is_unit_decided: bool,
    /// Unit in the row of units of the file from which the map was made; another file may have another.
    pub(crate) row_unit: Option<&'static Unit>,
    pub(crate) factor: Option<Decimal>,
    /// Whether the factor was decided for the file at hand.
    pub(crate) is_factor_decided: bool,
    /// Whether an empty cell has the value of the one above.
    pub(crate) is_filled: bool,
    pub(crate) offset: Option<Decimal>,
    pub(crate) direction: Option<Direction>,
    pub(crate) load: Option<String>,
    pub(crate) angle: Option<Decimal>,
    pub(crate) repetition: Option<u32>,
}

/// Decisions about a file. Those that are absent follow from the file itself.
///
/// ```
/// use pinswitch_import::Map;
///
/// let mut map = Map::default();
/// map.set("decimal=comma")?;
/// map.set("unit.Kraft=kN")?;
/// assert!(map.set("decimal=dot").is_err());
/// # Ok::<(), pinswitch_diagnostic::Diagnostic>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Map {
    pub(crate) kind: Option<Kind>,
    pub(crate) encoding: Option<String>,
    pub(crate) delimiter: Option<Delimiter>,
    pub(crate) decimal: Option<DecimalSign>,
    pub(crate) header_line: Option<usize>,
    pub(crate) names: Option<Vec<String>>,
    pub(crate) sheet: Option<String>,
    pub(crate) date_order: Option<DateOrder>,
    /// Whether times of two parts are minutes and seconds, and not hours and minutes.
    pub(crate) is_in_minutes: Option<bool>,
    pub(crate) is_swapped: Option<bool>,
    pub(crate) force_sign: Option<bool>,
    /// Unit of the columns of forces without one.
    pub(crate) force_unit: Option<&'static Unit>,
    pub(crate) sample_rate_hz: Option<Decimal>,
    pub(crate) full_speed_mm_s: Option<Decimal>,
    pub(crate) skip_bad_rows: bool,
    /// Values of columns that the file lacks, by the name of the column.
    pub(crate) constants: BTreeMap<String, String>,
    /// Directions by word.
    pub(crate) directions: BTreeMap<String, Direction>,
    /// Columns by name.
    pub(crate) columns: Vec<(String, ColumnChoice)>,
}

/// Names that `constants` may have.
pub(crate) const CONSTANTS: [&str; 17] = [
    "series",
    "substrate",
    "pins",
    "sweep",
    "load_mass_g",
    "load_N",
    "load_kg",
    "load_g",
    "speed_pct",
    "dwell_s",
    "direction",
    "wrap_angle_deg",
    "session",
    "mount",
    "operator",
    "specimen",
    "repetition",
];

/// Keys of `--set`, for messages.
const KEYS: &str = "kind, encoding, delimiter, decimal, header, names, sheet, date, clock, directions, force_sign, force_unit, \
    sample_rate_hz, full_speed_mm_s, bad_rows, concentric, eccentric, column.NAME, unit.NAME, factor.NAME, offset.NAME, fill.NAME, \
    direction.NAME, load.NAME, wrap_angle_deg.NAME, repetition.NAME, and constants such as substrate, wrap_angle_deg and load_N";

impl Map {
    /// Sets one value, written `KEY=VALUE`, such as `decimal=comma` or `unit.Kraft=kN`.
    ///
    /// # Errors
    /// A [`Diagnostic`] for an unknown key or an invalid value.
    pub fn set(&mut self, assignment: &str) -> Result<(), Diagnostic> {
        let Some((key, value)) = assignment.split_once('=') else {
            return Err(Diagnostic::new(codes::MALFORMED_VALUE, format!("'{assignment}' is not KEY=VALUE"))
                .with_help(format!("the keys are {KEYS}")));
        };
        self.set_key(key.trim(), value.trim())
    }

    pub(crate) fn set_key(&mut self, key: &str, value: &str) -> Result<(), Diagnostic> {
        let words =
            |expected: &str| refused(codes::UNKNOWN_WORD, key, value, &format!("expected {expected}"), "");
        match key {
            "kind" => {
                self.kind = Some(match value {
                    "table" => Kind::Table,
                    "log" => Kind::Log,
                    _ => return Err(words("table or log")),
                });
            }
            "encoding" => self.encoding = Some(value.split(' ').next().unwrap_or_default().to_owned()),
            "delimiter" => {
                let delimiter = Delimiter::parse(value);
                self.delimiter =
                    Some(delimiter.ok_or_else(|| words("comma, semicolon, tab, pipe, blanks or none"))?);
            }
            "decimal" => {
                self.decimal = Some(match value {
                    "point" | "." => DecimalSign::Point,
                    "comma" | "," => DecimalSign::Comma,
                    _ => return Err(words("point or comma")),
                });
            }
            "header" | "header_line" => {
                let line = if value == "none" { Ok(0) } else { value.parse::<usize>() };
                self.header_line = Some(line.map_err(|_| words("the line of the column names, or none"))?);
            }
            "names" => {
                self.names = Some(value.split(',').map(|name| name.trim().to_owned()).collect());
                self.header_line.get_or_insert(0);
            }
            "sheet" => self.sheet = Some(value.to_owned()),
            "date" => {
                self.date_order = Some(match value {
                    "dmy" => DateOrder::DayFirst,
                    "mdy" => DateOrder::MonthFirst,
                    _ => return Err(words("dmy or mdy")),
                });
            }
            "clock" => {
                self.is_in_minutes = Some(match value {
                    "mm:ss" => true,
                    "hh:mm" => false,
                    _ => return Err(words("hh:mm or mm:ss")),
                });
            }
            "directions" => {
                self.is_swapped = Some(match value {
                    "swapped" => true,
                    "as-named" => false,
                    _ => return Err(words("as-named or swapped")),
                });
            }
            "force_sign" => {
                self.force_sign = Some(match value {
                    "1" | "+1" => false,
                    "-1" => true,
                    _ => return Err(words("1 or -1")),
                });
            }
            "force_unit" => self.force_unit = Some(parse_unit(key, value)?),
            "sample_rate_hz" => self.sample_rate_hz = Some(positive(key, value)?),
            "full_speed_mm_s" => self.full_speed_mm_s = Some(positive(key, value)?),
            "bad_rows" => {
                self.skip_bad_rows = match value {
                    "skip" => true,
                    "refuse" => false,
                    _ => return Err(words("skip or refuse")),
                };
            }
            "concentric" | "eccentric" => {
                self.directions.insert(value.to_owned(), parse_direction(key, key)?);
            }
            _ => return self.set_other(key, value),
        }
        Ok(())
    }

    /// Sets a value of a column, such as `unit.Kraft`, or a constant.
    fn set_other(&mut self, key: &str, value: &str) -> Result<(), Diagnostic> {
        let Some((property, name)) = key.split_once('.') else { return self.set_constant(key, value) };
        let choice = match property {
            "column" => {
                ColumnChoice { quantity: Some(parse_quantity(key, value)?), ..ColumnChoice::default() }
            }
            "unit" => ColumnChoice { unit: Some(parse_unit(key, value)?), ..ColumnChoice::default() },
            "factor" => ColumnChoice { factor: Some(parse_number(key, value)?), ..ColumnChoice::default() },
            "fill" => match value {
                "down" => ColumnChoice { is_filled: true, ..ColumnChoice::default() },
                _ => return Err(refused(codes::UNKNOWN_WORD, key, value, "expected down", "")),
            },
            "offset" => ColumnChoice { offset: Some(parse_number(key, value)?), ..ColumnChoice::default() },
            "direction" => {
                ColumnChoice { direction: Some(parse_direction(key, value)?), ..ColumnChoice::default() }
            }
            "wrap_angle_deg" => {
                ColumnChoice { angle: Some(parse_number(key, value)?), ..ColumnChoice::default() }
            }
            "load" => ColumnChoice { load: Some(value.to_owned()), ..ColumnChoice::default() },
            "repetition" => ColumnChoice {
                repetition: Some(value.parse().map_err(|_| {
                    Diagnostic::new(codes::MALFORMED_VALUE, "not a whole number")
                        .with_location(Location::field(key, value))
                        .with_help("give the number of the trial, from 1 on")
                })?),
                ..ColumnChoice::default()
            },
            _ => return Err(unknown(key, value)),
        };
        let at = match self.columns.iter().position(|(other, _)| other == name) {
            Some(at) => at,
            None => {
                self.columns.push((name.to_owned(), ColumnChoice::default()));
                self.columns.len() - 1
            }
        };
        let old = &mut self.columns[at].1;
        // A new quantity or unit has its own factor.
        if choice.quantity.is_some() || choice.unit.is_some() {
            old.factor = old.factor.filter(|_| old.is_factor_decided);
            old.is_unit_decided = true;
        }
        old.is_factor_decided |= choice.factor.is_some();
        old.is_filled |= choice.is_filled;
        old.quantity = choice.quantity.or(old.quantity);
        old.unit = choice.unit.or(old.unit);
        old.factor = choice.factor.or(old.factor);
        old.offset = choice.offset.or(old.offset);
        old.direction = choice.direction.or(old.direction);
        old.angle = choice.angle.or(old.angle);
        old.load = choice.load.or(old.load.take());
        old.repetition = choice.repetition.or(old.repetition);
        Ok(())
    }

    pub(crate) fn set_constant(&mut self, key: &str, value: &str) -> Result<(), Diagnostic> {
        let Some(key) = CONSTANTS.iter().find(|known| known.eq_ignore_ascii_case(key)) else {
            return Err(unknown(key, value));
        };
        let is_number = key.contains('_') || *key == "repetition";
        let value = if is_number { parse_number(key, value)?.to_string() } else { value.to_owned() };
        match *key {
            "substrate" if !matches!(value.as_str(), "plain" | "silicone" | "abs") => {
                return Err(refused(codes::UNKNOWN_WORD, key, &value, "expected plain, silicone or abs", ""));
            }
            "sweep" if !matches!(value.as_str(), "up" | "down") => {
                return Err(refused(codes::UNKNOWN_WORD, key, &value, "expected up or down", ""));
            }
            "direction" => {
                parse_direction(key, &value)?;
            }
            _ => {}
        }
        self.constants.insert((*key).to_owned(), value);
        Ok(())
    }

    /// Returns the decisions about the column with this name, or with this number from 1.
    pub(crate) fn column(&self, name: &str, number: usize) -> Option<&ColumnChoice> {
        let number = number.to_string();
        let named = self.columns.iter().find(|(other, _)| other == name);
        let same = |other: &str| !name.is_empty() && letters(other) == letters(name);
        let similar = || self.columns.iter().find(|(other, _)| same(other));
        // The name alone, of a column that is named with its unit: "torque" for "torque [Nm]".
        let stem = name.split(['[', '(', '/']).next().unwrap_or_default();
        let is_stem = |other: &str| !letters(stem).is_empty() && letters(other) == letters(stem);
        let by_stem = || self.columns.iter().find(|(other, _)| is_stem(other));
        named
            .or_else(similar)
            .or_else(by_stem)
            .or_else(|| self.columns.iter().find(|(other, _)| *other == number))
            .map(|(_, c)| c)
    }
}

/// Returns the letters, digits and signs of a name, without case, blanks and brackets.
fn letters(name: &str) -> String {
    let is_kept = |c: &char| c.is_alphanumeric() || matches!(c, '+' | '-' | '%' | '°');
    name.chars().filter(is_kept).flat_map(char::to_lowercase).collect()
}

/// Writes a text as a TOML string.
pub(crate) fn quoted(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}

pub(crate) fn refused(code: Code, key: &str, value: &str, problem: &str, help: &str) -> Diagnostic {
    Diagnostic::new(code, problem).with_location(Location::field(key, value)).with_help(help)
}

pub(crate) fn in_table(table: &str, diagnostic: Diagnostic) -> Diagnostic {
    match diagnostic.location().cloned() {
        Some(Location { field: Some(field), value, .. }) if !field.starts_with(table) => {
            diagnostic.with_location(Location::field(format!("{table}.{field}"), value.unwrap_or_default()))
        }
        _ => diagnostic,
    }
}

fn unknown(key: &str, value: &str) -> Diagnostic {
    refused(codes::UNKNOWN_FIELD, key, value, "unknown key", &format!("the keys are {KEYS}"))
}

pub(crate) fn parse_quantity(key: &str, word: &str) -> Result<Quantity, Diagnostic> {
    Quantity::parse(word).ok_or_else(|| {
        refused(
            codes::UNKNOWN_WORD,
            key,
            word,
            "unknown quantity",
            &format!("use one of {}", Quantity::words()),
        )
    })
}

pub(crate) fn parse_unit(key: &str, word: &str) -> Result<&'static Unit, Diagnostic> {
    Unit::parse(word).ok_or_else(|| {
        refused(
            codes::UNKNOWN_UNIT,
            key,
            word,
            "unknown unit",
            "use a unit such as N, kN, kgf, lbf, kg, ms, mm, deg or counts",
        )
    })
}

pub(crate) fn parse_number(key: &str, text: &str) -> Result<Decimal, Diagnostic> {
    let number = Decimal::parse(text).filter(|number| number.to_f64().is_finite());
    number.ok_or_else(|| refused(codes::MALFORMED_VALUE, key, text, "not a number", "write it like 12.5"))
}

fn positive(key: &str, text: &str) -> Result<Decimal, Diagnostic> {
    let number = parse_number(key, text)?;
    if number.to_f64() > 0.0 {
        Ok(number)
    } else {
        Err(refused(codes::OUT_OF_RANGE, key, text, "not above 0", "give a value above 0"))
    }
}

pub(crate) fn parse_direction(key: &str, word: &str) -> Result<Direction, Diagnostic> {
    match word {
        "concentric" => Ok(Direction::Concentric),
        "eccentric" => Ok(Direction::Eccentric),
        _ => Err(refused(codes::UNKNOWN_WORD, key, word, "expected concentric or eccentric", "")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_map_reads_what_it_wrote() {
        let mut map = Map::default();
        for assignment in [
            "kind=table",
            "encoding=utf-8",
            "delimiter=;",
            "decimal=comma",
            "header=3",
            "sheet=Tab \"1\"",
            "date=mdy",
            "force_sign=-1",
            "sample_rate_hz=83.3",
            "bad_rows=skip",
            "concentric=A",
            "eccentric=B",
            "column.Kraft [x]=force",
            "unit.Kraft [x]=counts",
            "factor.Kraft [x]=0.00125",
            "offset.Kraft [x]=-12",
            "direction.F1=eccentric",
            "load.F1=2 kg",
            "wrap_angle_deg.F1=90",
            "fill.F1=down",
            "substrate=silicone",
            "pins=5;8;11",
            "wrap_angle_deg=90",
        ] {
            map.set(assignment).unwrap();
        }
        let text = map.to_toml();
        let mut again = Map::parse(&text, "map.toml").unwrap();
        // Assignments decide for the file at hand; a map that is read does not.
        for (_, choice) in again.columns.iter_mut().chain(&mut map.columns) {
            (choice.is_unit_decided, choice.is_factor_decided) = (true, true);
        }
        assert_eq!(again, map, "{text}");
    }

    #[test]
    fn invalid_values_name_their_field() {
        for (text, field) in [
            ("schema = \"x\"", "schema"),
            ("schema = \"pinswitch.import/1\"\ndecimal = \"dot\"", "decimal"),
            ("schema = \"pinswitch.import/1\"\n[constants]\nsubstrate = \"wood\"", "constants.substrate"),
            ("schema = \"pinswitch.import/1\"\n[[column]]\nname = \"F\"\nunit = \"stone\"", "column[0].unit"),
        ] {
            let error = Map::parse(text, "map.toml").unwrap_err();
            let location = error.location().unwrap();
            assert_eq!(location.field.as_deref(), Some(field));
            assert!(location.line.is_some(), "{error}");
        }
        for assignment in
            ["x", "x=1", "unit.F=stone", "sample_rate_hz=0", "wrap_angle_deg=wide", "direction=up"]
        {
            assert!(Map::default().set(assignment).is_err(), "{assignment}");
        }
    }
}
