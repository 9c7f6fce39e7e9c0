//! The file of a map: reading, writing, and its JSON Schema.

use std::collections::BTreeMap;

use pinswitch_diagnostic::{Diagnostic, Location, codes};
use pinswitch_measurements::{locate_field, toml_error};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::Deserialize;

use crate::clock::DateOrder;
use crate::decimal::Decimal;
use crate::map::{
    CONSTANTS, ColumnChoice, Map, SCHEMA, in_table, parse_direction, parse_number, parse_quantity,
    parse_unit, quoted, refused,
};
use crate::quantity::Quantity;

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
            return Err(Diagnostic::new(codes::OTHER_KIND_OF_FILE, "unknown schema")
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
                        codes::WRONG_TYPE,
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
                    Some(other) => {
                        return Err(refused(
                            codes::UNKNOWN_WORD,
                            &at("fill"),
                            &quoted(other),
                            "expected \"down\"",
                            "",
                        ));
                    }
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
                    codes::DUPLICATE_ENTRY,
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

/// Writes a number as TOML, with a fraction or an exponent.
fn number(value: Decimal) -> String {
    let value = value.to_f64();
    format!("{value:?}")
}
