//! `datapackage.json`: the files of a calibration as a Data Package (<https://specs.frictionlessdata.io/data-package>, version 1), by which
//! repositories of research data list and check them.

use std::collections::BTreeSet;

use pinswitch_calibration::table::column_unit;
use pinswitch_diagnostic::{Diagnostic, codes};
use serde::Serialize;
use sha2::{Digest, Sha256};

/// Name of the file.
pub const DATA_PACKAGE: &str = "datapackage.json";
/// Columns that a calibration adds to those of the plateau table, in newtons or without a unit.
const ADDED: [(&str, &str); 5] = [
    ("baseline_N", "N"),
    ("residual_baseline_N", "N"),
    ("model_N", "N"),
    ("residual_model_N", "N"),
    ("weight", "1"),
];

#[derive(Serialize)]
struct DataPackage {
    profile: &'static str,
    name: &'static str,
    title: String,
    description: &'static str,
    sources: Vec<Source>,
    resources: Vec<Resource>,
}

#[derive(Serialize)]
struct Source {
    title: String,
    hash: String,
}

#[derive(Serialize)]
struct Resource {
    profile: &'static str,
    name: String,
    path: String,
    /// Not part of the standard: its reference implementation takes any `report.json` for one of its own without it.
    #[serde(rename = "type")]
    kind: &'static str,
    description: &'static str,
    format: &'static str,
    mediatype: &'static str,
    encoding: &'static str,
    bytes: usize,
    hash: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    schema: Option<Schema>,
}

#[derive(Serialize)]
struct Schema {
    fields: Vec<Field>,
}

#[derive(Serialize)]
struct Field {
    name: String,
    #[serde(rename = "type")]
    kind: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    unit: Option<&'static str>,
}

/// Returns the descriptor of the files of a calibration of `title`. `sources` are the names of the files that it was made
/// from, each with its SHA-256 in hexadecimal digits; `files` are names and contents.
///
/// # Errors
/// A [`Diagnostic`] if it cannot be written as JSON.
pub fn data_package(
    title: &str,
    sources: &BTreeSet<(String, String)>,
    files: &[(String, Vec<u8>)],
) -> Result<(String, Vec<u8>), Diagnostic> {
    let source = |(title, sha256): &(String, String)| Source {
        title: title.clone(),
        hash: format!("sha256:{sha256}"),
    };
    let package = DataPackage {
        profile: "data-package",
        name: "calibration",
        title: format!("Calibration of {title}"),
        description: "Friction of a switch on a test rig: fitted models, residuals of each reading, and the report. \
                      Written by pinswitch.",
        sources: sources.iter().map(source).collect(),
        resources: files.iter().map(|(name, bytes)| resource(name, bytes)).collect(),
    };
    let text = serde_json::to_string_pretty(&package)
        .map_err(|e| Diagnostic::from_error(codes::INTERNAL_ERROR, e))?;
    Ok((DATA_PACKAGE.to_owned(), (text + "\n").into_bytes()))
}

/// SHA-256 in hexadecimal digits.
fn sha256(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect()
}

fn resource(name: &str, bytes: &[u8]) -> Resource {
    let format = name.rsplit('.').next().unwrap_or_default();
    let (format, mediatype) = match format {
        "csv" => ("csv", "text/csv"),
        "html" => ("html", "text/html"),
        "json" => ("json", "application/json"),
        "svg" => ("svg", "image/svg+xml"),
        _ => ("toml", "application/toml"),
    };
    let is_table = format == "csv";
    Resource {
        profile: if is_table { "tabular-data-resource" } else { "data-resource" },
        name: name.to_lowercase(),
        path: name.to_owned(),
        kind: if is_table { "table" } else { "file" },
        description: description(name),
        format,
        mediatype,
        encoding: "utf-8",
        bytes: bytes.len(),
        hash: format!("sha256:{}", sha256(bytes)),
        schema: is_table.then(|| table_schema(bytes)),
    }
}

fn description(name: &str) -> &'static str {
    match name {
        "report.json" => "The results: verdict, effects with probabilities and intervals, errors",
        "report.html" => "The results as a page",
        "residuals.csv" => "The plateau table with predictions and residuals of both models",
        "baseline.toml" => "The paper's model, fitted",
        "model.toml" => "The best model, for predictions",
        "discovered.toml" => "A formula for structure without a name",
        _ => "A plot of the report",
    }
}

/// Returns the fields of a table from its header. Columns of a laboratory's own may have any type.
fn table_schema(bytes: &[u8]) -> Schema {
    let field = |name: &str| {
        let added = || ADDED.iter().find(|(added, _)| *added == name).map(|(_, unit)| *unit);
        let unit = column_unit(name).or_else(added);
        // Whole numbers, too: frames with gaps store a repetition as 1.0.
        let kind = if unit.is_some() { "number" } else { "any" };
        Field { name: name.to_owned(), kind, unit: unit.filter(|unit| *unit != "1") }
    };
    let mut reader = csv::Reader::from_reader(bytes);
    Schema { fields: reader.headers().map_or_else(|_| Vec::new(), |names| names.iter().map(field).collect()) }
}
