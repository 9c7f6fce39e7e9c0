//! The map of a file: every decision of an import, as a person may write it and as it is written
//! next to a table.

use std::collections::BTreeMap;

use pinswitch_diagnostic::{Diagnostic, Location};
use pinswitch_friction::Direction;
use pinswitch_measurements::{locate_field, toml_error};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::Deserialize;

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
const CONSTANTS: [&str; 17] = [
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

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct MapFile {
    /// Name and version of this kind of file.
    #[schemars(extend("const" = SCHEMA))]
    schema: String,
    /// What the file is; by default what its columns show.
    #[schemars(extend("enum" = ["table", "log"]))]
    kind: Option<String>,
    /// Encoding of a text, such as `utf-8`.
    encoding: Option<String>,
    /// Delimiter: a sign or its word, such as `semicolon`.
    delimiter: Option<String>,
    /// Decimal sign.
    #[schemars(extend("enum" = ["point", "comma"]))]
    decimal: Option<String>,
    /// Line of the names of the columns, from 1; 0 without names.
    header_line: Option<usize>,
    /// Names of the columns, in place of those of the file.
    names: Option<Vec<String>>,
    /// Sheet of a workbook.
    sheet: Option<String>,
    /// Order of day and month.
    #[schemars(extend("enum" = ["dmy", "mdy"]))]
    date: Option<String>,
    /// Times of two parts.
    #[schemars(extend("enum" = ["hh:mm", "mm:ss"]))]
    clock: Option<String>,
    /// -1 if the cell reads a tension as negative.
    #[schemars(extend("enum" = [1, -1]))]
    force_sign: Option<i64>,
    /// Unit of the columns of forces without one.
    force_unit: Option<String>,
    /// Samples per second of a log without times.
    sample_rate_hz: Option<f64>,
    /// Speed at 100 %, in millimetres per second.
    full_speed_mm_s: Option<f64>,
    /// What happens to rows with a cell that is not a number.
    #[schemars(extend("enum" = ["skip", "refuse"]))]
    bad_rows: Option<String>,
    /// Values of columns that the file lacks.
    #[serde(default)]
    #[schemars(schema_with = "constants_schema")]
    constants: BTreeMap<String, toml::Value>,
    /// Direction of each word of the file.
    #[serde(default)]
    #[schemars(schema_with = "directions_schema")]
    directions: BTreeMap<String, String>,
    /// Columns of the file.
    #[serde(default)]
    column: Vec<ColumnEntry>,
}

/// The schema of constants: the known names with texts or numbers.
fn constants_schema(_: &mut SchemaGenerator) -> Schema {
    let value = serde_json::json!({ "type": ["string", "number"] });
    let properties: serde_json::Map<String, serde_json::Value> =
        CONSTANTS.iter().map(|name| ((*name).to_owned(), value.clone())).collect();
    json_schema!({ "type": "object", "properties": properties, "additionalProperties": false })
}

fn directions_schema(_: &mut SchemaGenerator) -> Schema {
    json_schema!({ "type": "object", "additionalProperties": { "enum": ["concentric", "eccentric"] } })
}

/// The schema of a quantity: its words.
fn quantity_schema(_: &mut SchemaGenerator) -> Schema {
    json_schema!({ "enum": Quantity::all_words() })
}

/// Returns the JSON Schema of a map.
pub fn map_schema() -> Schema {
    schemars::schema_for!(MapFile)
}

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct ColumnEntry {
    /// Name in the file, or number of the column, from 1.
    name: String,
    /// What it contains.
    #[serde(default)]
    #[schemars(schema_with = "quantity_schema")]
    quantity: Option<String>,
    /// Unit, such as `kN`.
    unit: Option<String>,
    /// Unit in the row of units of the file from which the map was made.
    row_unit: Option<String>,
    /// Written value of 1.
    factor: Option<f64>,
    /// Written value of 0.
    offset: Option<f64>,
    /// Direction of all its readings, in a wide table.
    #[schemars(extend("enum" = ["concentric", "eccentric"]))]
    direction: Option<String>,
    /// Load of all its readings, such as `2 kg`.
    load: Option<String>,
    /// Wrap angle of all its readings, in degrees.
    wrap_angle_deg: Option<f64>,
    /// Trial of all its readings, from 1.
    repetition: Option<u32>,
    /// `down`: an empty cell has the value above.
    #[schemars(extend("enum" = ["down"]))]
    fill: Option<String>,
}

impl Map {
    /// Parses a map. `file` is its name in errors.
    ///
    /// # Errors
    /// A [`Diagnostic`] with the line of the field.
    pub fn parse(text: &str, file: &str) -> Result<Self, Diagnostic> {
        let entries: MapFile = toml::from_str(text).map_err(|e| toml_error(file, text, &e))?;
        Self::from_entries(entries).map_err(|diagnostic| locate_field(diagnostic, file, text))
    }

    fn from_entries(entries: MapFile) -> Result<Self, Diagnostic> {
        if entries.schema != SCHEMA {
            return Err(Diagnostic::new("unknown schema")
                .with_location(Location::field("schema", format!("{:?}", entries.schema)))
                .with_help(format!("write schema = \"{SCHEMA}\"")));
        }
        let mut map = Self {
            header_line: entries.header_line,
            names: entries.names,
            sheet: entries.sheet,
            ..Self::default()
        };
        let words = [
            ("kind", entries.kind),
            ("encoding", entries.encoding),
            ("delimiter", entries.delimiter),
            ("decimal", entries.decimal),
            ("date", entries.date),
            ("clock", entries.clock),
            ("bad_rows", entries.bad_rows),
            ("force_unit", entries.force_unit),
            ("force_sign", entries.force_sign.map(|sign| sign.to_string())),
            ("sample_rate_hz", entries.sample_rate_hz.map(|rate| rate.to_string())),
            ("full_speed_mm_s", entries.full_speed_mm_s.map(|speed| speed.to_string())),
        ];
        for (key, value) in words {
            if let Some(value) = value {
                map.set_key(key, &value)?;
            }
        }
        for (key, value) in entries.constants {
            let text = match value {
                toml::Value::String(text) => text,
                toml::Value::Integer(number) => number.to_string(),
                toml::Value::Float(number) => number.to_string(),
                other => {
                    return Err(refused(
                        &format!("constants.{key}"),
                        &other.to_string(),
                        "expected a string or a number",
                        "",
                    ));
                }
            };
            map.set_constant(&key, &text).map_err(|d| in_table("constants", d))?;
        }
        for (word, direction) in entries.directions {
            map.directions.insert(word.clone(), parse_direction(&format!("directions.{word}"), &direction)?);
        }
        for (i, entry) in entries.column.into_iter().enumerate() {
            let at = |key: &str| format!("column[{i}].{key}");
            let choice = ColumnChoice {
                quantity: entry.quantity.map(|word| parse_quantity(&at("quantity"), &word)).transpose()?,
                unit: entry
                    .unit
                    .filter(|unit| !unit.is_empty())
                    .map(|unit| parse_unit(&at("unit"), &unit))
                    .transpose()?,
                row_unit: entry.row_unit.map(|unit| parse_unit(&at("row_unit"), &unit)).transpose()?,
                is_unit_decided: false,
                is_factor_decided: false,
                is_filled: match entry.fill.as_deref() {
                    None => false,
                    Some("down") => true,
                    Some(other) => return Err(refused(&at("fill"), &quoted(other), "expected \"down\"", "")),
                },
                factor: entry.factor.map(|f| parse_number(&at("factor"), &f.to_string())).transpose()?,
                offset: entry.offset.map(|f| parse_number(&at("offset"), &f.to_string())).transpose()?,
                direction: entry
                    .direction
                    .map(|word| parse_direction(&at("direction"), &word))
                    .transpose()?,
                load: entry.load,
                angle: entry
                    .wrap_angle_deg
                    .map(|angle| parse_number(&at("wrap_angle_deg"), &angle.to_string()))
                    .transpose()?,
                repetition: entry.repetition,
            };
            if map.columns.iter().any(|(name, _)| *name == entry.name) {
                return Err(refused(
                    &at("name"),
                    &format!("{:?}", entry.name),
                    "the column is listed twice",
                    "list each column once",
                ));
            }
            map.columns.push((entry.name, choice));
        }
        Ok(map)
    }

    /// Sets one value, written `KEY=VALUE`, such as `decimal=comma` or `unit.Kraft=kN`.
    ///
    /// # Errors
    /// A [`Diagnostic`] for an unknown key or an invalid value.
    pub fn set(&mut self, assignment: &str) -> Result<(), Diagnostic> {
        let Some((key, value)) = assignment.split_once('=') else {
            return Err(Diagnostic::new(format!("'{assignment}' is not KEY=VALUE"))
                .with_help(format!("the keys are {KEYS}")));
        };
        self.set_key(key.trim(), value.trim())
    }

    fn set_key(&mut self, key: &str, value: &str) -> Result<(), Diagnostic> {
        let words = |expected: &str| refused(key, value, &format!("expected {expected}"), "");
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
                _ => return Err(refused(key, value, "expected down", "")),
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
                    Diagnostic::new("not a whole number")
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

    fn set_constant(&mut self, key: &str, value: &str) -> Result<(), Diagnostic> {
        let Some(key) = CONSTANTS.iter().find(|known| known.eq_ignore_ascii_case(key)) else {
            return Err(unknown(key, value));
        };
        let is_number = key.contains('_') || *key == "repetition";
        let value = if is_number { parse_number(key, value)?.to_string() } else { value.to_owned() };
        match *key {
            "substrate" if !matches!(value.as_str(), "plain" | "silicone" | "abs") => {
                return Err(refused(key, &value, "expected plain, silicone or abs", ""));
            }
            "sweep" if !matches!(value.as_str(), "up" | "down") => {
                return Err(refused(key, &value, "expected up or down", ""));
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

    /// Writes the map as TOML, which [`Map::parse`] reads.
    pub fn to_toml(&self) -> String {
        let mut out = format!("schema = {}\n", quoted(SCHEMA));
        let mut line = |key: &str, value: Option<String>| {
            if let Some(value) = value {
                out.push_str(&format!("{key} = {value}\n"));
            }
        };
        line("kind", self.kind.map(|kind| quoted(kind.as_str())));
        line("encoding", self.encoding.as_deref().map(quoted));
        line("delimiter", self.delimiter.map(|delimiter| quoted(&delimiter.as_str())));
        line("decimal", self.decimal.map(|sign| quoted(sign.as_str())));
        line("header_line", self.header_line.map(|line| line.to_string()));
        line(
            "names",
            self.names
                .as_ref()
                .map(|names| format!("[{}]", names.iter().map(|n| quoted(n)).collect::<Vec<_>>().join(", "))),
        );
        line("sheet", self.sheet.as_deref().map(quoted));
        line(
            "date",
            self.date_order.map(|order| quoted(if order == DateOrder::DayFirst { "dmy" } else { "mdy" })),
        );
        line("clock", self.is_in_minutes.map(|is| quoted(if is { "mm:ss" } else { "hh:mm" })));
        line(
            "force_sign",
            self.force_sign.map(|is_negative| if is_negative { "-1" } else { "1" }.to_owned()),
        );
        line("force_unit", self.force_unit.map(|unit| quoted(unit.name)));
        line("sample_rate_hz", self.sample_rate_hz.map(number));
        line("full_speed_mm_s", self.full_speed_mm_s.map(number));
        line("bad_rows", self.skip_bad_rows.then(|| quoted("skip")));
        if !self.constants.is_empty() {
            out.push_str("\n[constants]\n");
            for (key, value) in &self.constants {
                out.push_str(&format!("{key} = {}\n", quoted(value)));
            }
        }
        if !self.directions.is_empty() {
            out.push_str("\n[directions]\n");
            for (word, direction) in &self.directions {
                out.push_str(&format!("{} = {}\n", quoted(word), quoted(direction.as_str())));
            }
        }
        for (name, choice) in &self.columns {
            out.push_str(&format!("\n[[column]]\nname = {}\n", quoted(name)));
            let mut line = |key: &str, value: Option<String>| {
                if let Some(value) = value {
                    out.push_str(&format!("{key} = {value}\n"));
                }
            };
            line("quantity", choice.quantity.map(|quantity| quoted(quantity.as_str())));
            line("unit", choice.unit.map(|unit| quoted(unit.name)));
            line("row_unit", choice.row_unit.map(|unit| quoted(unit.name)));
            line("factor", choice.factor.map(number));
            line("offset", choice.offset.map(number));
            line("direction", choice.direction.map(|direction| quoted(direction.as_str())));
            line("wrap_angle_deg", choice.angle.map(number));
            line("load", choice.load.as_deref().map(quoted));
            line("repetition", choice.repetition.map(|n| n.to_string()));
            line("fill", choice.is_filled.then(|| quoted("down")));
        }
        out
    }
}

/// Returns the letters, digits and signs of a name, without case, blanks and brackets.
fn letters(name: &str) -> String {
    let is_kept = |c: &char| c.is_alphanumeric() || matches!(c, '+' | '-' | '%' | '°');
    name.chars().filter(is_kept).flat_map(char::to_lowercase).collect()
}

/// Writes a number as TOML, with a fraction or an exponent.
fn number(value: Decimal) -> String {
    let value = value.to_f64();
    format!("{value:?}")
}

/// Writes a text as a TOML string.
pub(crate) fn quoted(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}

fn refused(key: &str, value: &str, problem: &str, help: &str) -> Diagnostic {
    Diagnostic::new(problem).with_location(Location::field(key, value)).with_help(help)
}

fn in_table(table: &str, diagnostic: Diagnostic) -> Diagnostic {
    match diagnostic.location().cloned() {
        Some(Location { field: Some(field), value, .. }) if !field.starts_with(table) => {
            diagnostic.with_location(Location::field(format!("{table}.{field}"), value.unwrap_or_default()))
        }
        _ => diagnostic,
    }
}

fn unknown(key: &str, value: &str) -> Diagnostic {
    refused(key, value, "unknown key", &format!("the keys are {KEYS}"))
}

fn parse_quantity(key: &str, word: &str) -> Result<Quantity, Diagnostic> {
    Quantity::parse(word)
        .ok_or_else(|| refused(key, word, "unknown quantity", &format!("use one of {}", Quantity::words())))
}

fn parse_unit(key: &str, word: &str) -> Result<&'static Unit, Diagnostic> {
    Unit::parse(word).ok_or_else(|| {
        refused(key, word, "unknown unit", "use a unit such as N, kN, kgf, lbf, kg, ms, mm, deg or counts")
    })
}

fn parse_number(key: &str, text: &str) -> Result<Decimal, Diagnostic> {
    let number = Decimal::parse(text).filter(|number| number.to_f64().is_finite());
    number.ok_or_else(|| refused(key, text, "not a number", "write it like 12.5"))
}

fn positive(key: &str, text: &str) -> Result<Decimal, Diagnostic> {
    let number = parse_number(key, text)?;
    if number.to_f64() > 0.0 {
        Ok(number)
    } else {
        Err(refused(key, text, "not above 0", "give a value above 0"))
    }
}

fn parse_direction(key: &str, word: &str) -> Result<Direction, Diagnostic> {
    match word {
        "concentric" => Ok(Direction::Concentric),
        "eccentric" => Ok(Direction::Eccentric),
        _ => Err(refused(key, word, "expected concentric or eccentric", "")),
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
