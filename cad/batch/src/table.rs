//! The table of all variants: one row each, whether made, refused or failed. The columns depend on
//! the sweep only.

use serde_json::Value as Json;
use sha2::{Digest, Sha256};

use super::hexadecimal;
use super::make::VariantOutcome;
use super::sweep::Sweep;
use super::variant::Variant;
use pinswitch_switch::config::Configuration;
use pinswitch_switch::design::Design;
use pinswitch_switch::documents::{derived, toml_to_json};

/// Type of a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ColumnType {
    /// Text.
    Text,
    /// A number; the column's name ends with its unit.
    Real,
    /// A count.
    Integer,
    /// True or false.
    Boolean,
}

/// One column.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Column {
    /// Its name; fields have the names of a configuration.
    pub name: String,
    /// Its type.
    pub kind: ColumnType,
}

/// One cell; empty if the variant has no such value.
#[derive(Clone, Debug, PartialEq)]
pub enum Cell {
    /// No value.
    Empty,
    /// Text.
    Text(String),
    /// A number.
    Real(f64),
    /// A count.
    Integer(i64),
    /// True or false.
    Boolean(bool),
}

/// A row, with one cell per column.
pub type Row = Vec<Cell>;

/// Columns of a variant's friction, by their keys in the manifest.
const FRICTION: [(&str, ColumnType); 5] = [
    ("law", ColumnType::Text),
    ("trust", ColumnType::Text),
    ("load_n", ColumnType::Real),
    ("friction_n", ColumnType::Real),
    ("threshold_n", ColumnType::Real),
];
/// Columns of every part.
const PART: [(&str, ColumnType); 5] = [
    ("volume_mm3", ColumnType::Real),
    ("mass_g", ColumnType::Real),
    ("mesh_volume_mm3", ColumnType::Real),
    ("bytes", ColumnType::Integer),
    ("sha256", ColumnType::Text),
];

/// Columns of the slicer's estimate, summed over the parts of a variant; only in a sweep with a
/// slicer.
const PRINT: [&str; 3] = ["print_minutes", "filament_g", "filament_m"];

/// The columns of a table.
#[derive(Clone, Debug)]
pub struct Schema {
    columns: Vec<Column>,
    parts: Vec<&'static str>,
    slice: bool,
}

impl Schema {
    /// The columns for `sweep`.
    pub fn new(sweep: &Sweep) -> Self {
        let mut columns = Vec::new();
        let mut add = |name: String, kind: ColumnType| columns.push(Column { name, kind });
        add("index".to_owned(), ColumnType::Integer);
        for name in ["id", "label", "status", "reason"] {
            add(name.to_owned(), ColumnType::Text);
        }
        for parameter in Configuration::PARAMETERS.iter().filter(|p| p.path() != "switch.name") {
            add(parameter.path(), kind_of(&(parameter.get)(&Configuration::default())));
        }
        for name in dimensions() {
            add(name, ColumnType::Real);
        }
        for (key, kind) in FRICTION {
            add(if key.contains("_n") { key.to_owned() } else { format!("friction_{key}") }, kind);
        }
        for name in
            ["band_low_n", "band_high_n", "printed_mass_g", "silicone_pour_ml", "largest_volume_error"]
        {
            add(name.to_owned(), ColumnType::Real);
        }
        add("warnings".to_owned(), ColumnType::Integer);
        for part in &sweep.parts {
            for (key, kind) in PART {
                add(format!("{part}.{key}"), kind);
            }
        }
        for name in PRINT.into_iter().filter(|_| sweep.slice) {
            add(name.to_owned(), ColumnType::Real);
        }
        add("manifest_sha256".to_owned(), ColumnType::Text);
        Self { columns, parts: sweep.parts.clone(), slice: sweep.slice }
    }

    /// Returns all columns.
    pub fn columns(&self) -> &[Column] {
        &self.columns
    }

    /// Returns the parts that have columns.
    pub fn parts(&self) -> &[&'static str] {
        &self.parts
    }

    /// Returns the index of column `name`.
    pub fn position(&self, name: &str) -> Option<usize> {
        self.columns.iter().position(|c| c.name == name)
    }

    /// Returns the cell of `row` in column `name`.
    pub fn cell<'r>(&self, row: &'r [Cell], name: &str) -> &'r Cell {
        self.position(name).and_then(|i| row.get(i)).unwrap_or(&Cell::Empty)
    }

    /// Returns the row of a variant.
    pub fn row(&self, variant: &Variant, outcome: &VariantOutcome) -> Row {
        let (status, reason, manifest) = match outcome {
            VariantOutcome::Made { manifest, .. } => ("made", Cell::Empty, Some(manifest)),
            VariantOutcome::Refused(refusal) => ("refused", Cell::Text(refusal.to_string()), None),
            VariantOutcome::Failed(reason) => ("failed", Cell::Text(reason.to_string()), None),
        };
        let text = |t: &str| Cell::Text(t.to_owned());
        let mut row = vec![
            Cell::Integer(i64::try_from(variant.index).unwrap_or(i64::MAX)),
            text(&variant.id),
            text(&variant.label),
            text(status),
            reason,
        ];
        for parameter in Configuration::PARAMETERS.iter().filter(|p| p.path() != "switch.name") {
            let value = (parameter.get)(&variant.configuration);
            row.push(cell(&toml_to_json(&value), kind_of(&value)));
        }
        if let Some(bytes) = manifest {
            // A manifest of this program is valid JSON.
            let facts: Json = serde_json::from_slice(bytes).unwrap_or_default();
            self.add_facts(&mut row, &facts);
            row.push(Cell::Text(hexadecimal(&Sha256::digest(bytes))));
        }
        row.resize(self.columns.len(), Cell::Empty);
        row
    }

    fn add_facts(&self, row: &mut Row, facts: &Json) {
        let all = |list: &'static str| facts[list].as_array().map(Vec::as_slice).unwrap_or_default();
        row.extend(all("derived").iter().map(|d| cell(&d["value"], ColumnType::Real)));
        let friction = &facts["friction"];
        row.extend(FRICTION.iter().map(|(key, kind)| cell(&friction[*key], *kind)));
        row.extend((0..2).map(|i| cell(&friction["band_n"][i], ColumnType::Real)));
        let parts = all("parts");
        row.push(Cell::Real(parts.iter().filter_map(|p| p["mass_g"].as_f64()).sum()));
        row.push(cell(&facts["bill_of_materials"]["silicone"]["pour_ml"], ColumnType::Real));
        row.push(cell(&facts["mesh"]["largest_volume_error"], ColumnType::Real));
        row.push(Cell::Integer(i64::try_from(all("warnings").len()).unwrap_or(0)));
        for name in &self.parts {
            let part = parts.iter().find(|p| p["name"] == *name).unwrap_or(&Json::Null);
            let file = all("files").iter().find(|f| f["file"] == part["file"] && !part.is_null());
            let file = file.unwrap_or(&Json::Null);
            for (key, kind) in PART {
                let fact = match key {
                    "mesh_volume_mm3" => &part["mesh"]["volume_mm3"],
                    "bytes" | "sha256" => &file[key],
                    _ => &part[key],
                };
                row.push(cell(fact, kind));
            }
        }
        let print = PRINT.into_iter().filter(|_| self.slice);
        row.extend(print.map(|name| cell(&facts["print"][name], ColumnType::Real)));
    }
}

/// Returns the names of the derived dimensions with their units.
fn dimensions() -> Vec<String> {
    let design = Design::new(Configuration::default());
    design.iter().flat_map(derived).map(|d| format!("{}_{}", d.name, d.unit)).collect()
}

pub(super) fn kind_of(value: &toml_edit::Value) -> ColumnType {
    match value {
        toml_edit::Value::Integer(_) => ColumnType::Integer,
        toml_edit::Value::Float(_) => ColumnType::Real,
        toml_edit::Value::Boolean(_) => ColumnType::Boolean,
        _ => ColumnType::Text,
    }
}

pub(super) fn cell(value: &Json, kind: ColumnType) -> Cell {
    let cell = match kind {
        ColumnType::Real => value.as_f64().map(Cell::Real),
        ColumnType::Integer => value.as_i64().map(Cell::Integer),
        ColumnType::Boolean => value.as_bool().map(Cell::Boolean),
        ColumnType::Text if value.is_null() => None,
        ColumnType::Text => Some(Cell::Text(value.as_str().map_or_else(|| value.to_string(), str::to_owned))),
    };
    cell.unwrap_or(Cell::Empty)
}

impl std::fmt::Display for Cell {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Empty => Ok(()),
            Self::Text(text) => f.write_str(text),
            // The shortest text that parses to the same number.
            Self::Real(x) => write!(f, "{x}"),
            Self::Integer(i) => write!(f, "{i}"),
            Self::Boolean(b) => write!(f, "{b}"),
        }
    }
}

impl Cell {
    /// Returns its number.
    #[allow(clippy::cast_precision_loss)]
    pub fn number(&self) -> Option<f64> {
        match self {
            Self::Real(x) => Some(*x),
            Self::Integer(i) => Some(*i as f64),
            _ => None,
        }
    }

    /// Returns its text.
    pub fn text(&self) -> Option<&str> {
        match self {
            Self::Text(text) => Some(text),
            _ => None,
        }
    }
}
