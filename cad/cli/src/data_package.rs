//! `datapackage.json`: the files of a calibration as a Data Package (<https://specs.frictionlessdata.io/data-package>, version 1), by which
//! repositories of research data list and check them.

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

use pinswitch_calibration::table::column_unit;
use pinswitch_diagnostic::{Diagnostic, Location, codes};
use pinswitch_switch::output::OutputFile;
use serde::Serialize;

use crate::Failure;
use crate::input::InputFile;
use crate::provenance::sha256;
use crate::terminal::to_json;
use crate::write::SetFolder;

/// Name of the file.
pub(crate) const DATA_PACKAGE: &str = "datapackage.json";
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

/// Returns the descriptor of the files of a calibration of `title`, made from the files that were read.
///
/// # Errors
/// [`Failure`] if it cannot be written as JSON.
pub(crate) fn data_package(
    title: &str,
    read: &BTreeMap<PathBuf, InputFile>,
    files: &[OutputFile],
) -> Result<OutputFile, Failure> {
    let sources: BTreeSet<(String, &str)> = read
        .iter()
        .filter_map(|(path, input)| {
            Some((path.file_name()?.to_string_lossy().into_owned(), input.sha256.as_str()))
        })
        .collect();
    let package = DataPackage {
        profile: "data-package",
        name: "calibration",
        title: format!("Calibration of {title}"),
        description: "Friction of a switch on a test rig: fitted models, residuals of each reading, and the report. \
                      Written by pinswitch.",
        sources: sources
            .into_iter()
            .map(|(title, sha256)| Source { title, hash: format!("sha256:{sha256}") })
            .collect(),
        resources: files.iter().map(resource).collect(),
    };
    Ok(OutputFile { name: DATA_PACKAGE.to_owned(), bytes: to_json(&package)? })
}

/// Returns whether the folder contains a descriptor that `command` wrote.
///
/// # Errors
/// [`Failure`] of another descriptor: repositories take this name only, so that it may be a person's own, or one of ours with
/// authors and licence added.
pub(crate) fn has_own_descriptor(folder: &SetFolder, command: &str) -> Result<bool, Failure> {
    if folder.existing(DATA_PACKAGE)?.is_none() {
        return Ok(false);
    }
    if folder.written_by(command)?.iter().any(|name| name == DATA_PACKAGE) {
        return Ok(true);
    }
    let path = folder.folder().join(DATA_PACKAGE);
    Err(Failure::bad_input(
        Diagnostic::new(codes::FILE_IN_THE_WAY, "pinswitch did not write this file, or it was changed since")
            .with_location(Location::file(path.display().to_string()))
            .with_help("give another folder with --out, or move the file away"),
    ))
}

fn resource(file: &OutputFile) -> Resource {
    let format = file.name.rsplit('.').next().unwrap_or_default();
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
        name: file.name.to_lowercase(),
        path: file.name.clone(),
        kind: if is_table { "table" } else { "file" },
        description: description(&file.name),
        format,
        mediatype,
        encoding: "utf-8",
        bytes: file.bytes.len(),
        hash: format!("sha256:{}", sha256(&file.bytes)),
        schema: is_table.then(|| table_schema(&file.bytes)),
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
        let kind = match (unit, name) {
            (Some(_), "repetition") => "integer",
            (Some(_), _) => "number",
            (None, _) => "any",
        };
        Field { name: name.to_owned(), kind, unit: unit.filter(|unit| *unit != "1") }
    };
    let mut reader = csv::Reader::from_reader(bytes);
    Schema { fields: reader.headers().map_or_else(|_| Vec::new(), |names| names.iter().map(field).collect()) }
}
