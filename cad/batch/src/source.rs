//! The texts of a sweep: its own file, its base configuration and its rows. `batch.json` contains
//! them, so that a batch can be resumed or merged without the files that it was started from.

use std::io::{Error, ErrorKind};
use std::ops::Range;
use std::path::Path;

use pinswitch_diagnostic::{Diagnostic, Location, codes};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use toml_edit::{Document, Item, TomlError};

use pinswitch_store::read_at_most;

use super::diagnostics::{at_span, field_error};
use super::hexadecimal;
use pinswitch_switch::config::{Configuration, Name, read, text, to_toml};
use pinswitch_switch::templates;

/// Most bytes of a sweep: every value of its lists takes about a hundred times its length in
/// memory.
const MAX_SWEEP_BYTES: u64 = 1 << 20;
/// Most bytes of a table of rows, for which only the offsets of rows are kept.
const MAX_ROWS_BYTES: u64 = 256 << 20;

/// The texts of a sweep.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct SweepSource {
    /// Name of the sweep: as given, or the stem of its file.
    pub name: String,
    /// Name of the sweep's file, for errors.
    pub file: String,
    /// Text of the sweep's file.
    pub sweep: String,
    /// The base configuration over its preset, as TOML.
    pub base: String,
    /// Name and text of the CSV of rows.
    pub rows: Option<(String, String)>,
    /// Whether a slicer estimates the print time of every variant. The command line decides this,
    /// not the sweep's file.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub slice: bool,
    /// Whether every mesh is verified by a second kernel: an option of the run, not of the sweep's file.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub verify: bool,
}

/// Which files a sweep may name.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Reach {
    /// Files in the sweep's folder and below.
    #[default]
    SweepFolder,
    /// Any file.
    Anywhere,
}

impl Reach {
    /// Checks that a sweep in `folder` may read the existing file `name` of `field`. Symlinks are
    /// resolved first.
    fn check(self, field: &str, name: &str, folder: &Path) -> Result<(), Diagnostic> {
        let is_below =
            || Some(folder.join(name).canonicalize().ok()?.starts_with(folder.canonicalize().ok()?));
        if self == Self::Anywhere || is_below() != Some(false) {
            return Ok(());
        }
        let help = "copy it to the sweep's folder, or allow it with --read-outside";
        Err(field_error(
            codes::OUTSIDE_THE_FOLDER,
            field,
            Some(&format!("{name:?}")),
            "outside the sweep's folder",
            help,
        ))
    }
}

impl SweepSource {
    /// Reads the sweep at `path` and every file that it names in its folder or below: a sweep from
    /// an untrusted source cannot read any other file.
    ///
    /// # Errors
    /// A file that cannot be read or may not be named, with the field that names it.
    pub fn read(path: &Path) -> Result<Self, Diagnostic> {
        Self::read_within(path, Reach::SweepFolder)
    }

    /// Reads the sweep at `path` and the files that it names, within `reach`.
    ///
    /// # Errors
    /// As [`Self::read`].
    pub fn read_within(path: &Path, reach: Reach) -> Result<Self, Diagnostic> {
        let file = path.display().to_string();
        let bytes = read_at_most(path, MAX_SWEEP_BYTES).map_err(|e| unreadable_file(&file, e))?;
        let sweep = text(bytes, &file)?;
        let document = parse(&sweep, &file)?;
        let item = |table: &str, key: &str| document.get(table)?.as_table_like()?.get(key);
        let string = |table: &str, key: &str| {
            item(table, key).map(|item| item.as_str().unwrap_or_default().to_owned())
        };
        let at = |table: &str, key: &str| {
            let span = item(table, key).and_then(Item::span).unwrap_or_default();
            let (file, sweep) = (&file, &sweep);
            move |e: Diagnostic| at_span(e, file, sweep, span.clone())
        };
        let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or_else(|| Path::new("."));
        let base = match string("sweep", "base") {
            Some(name) => read_text("sweep.base", &name, folder, reach).map_err(at("sweep", "base"))?,
            None => (String::new(), "defaults".to_owned()),
        };
        let preset = string("sweep", "preset")
            .map(|name| read_text("sweep.preset", &name, folder, reach).map_err(at("sweep", "preset")))
            .transpose()?;
        let rows = string("rows", "file")
            .map(|name| read_rows(name, folder, reach).map_err(at("rows", "file")))
            .transpose()?;
        let stem = path.file_stem().map_or_else(|| "batch".into(), |s| s.to_string_lossy());
        Ok(Self {
            name: string("sweep", "name").unwrap_or_else(|| Name::cleaned(&stem).to_string()),
            base: to_toml(&over_preset(&base, preset.as_ref())?),
            file,
            sweep,
            rows,
            slice: false,
            verify: false,
        })
    }

    /// Parses the sweep's file.
    ///
    /// # Errors
    /// Invalid TOML.
    pub(super) fn document(&self) -> Result<Document<String>, Diagnostic> {
        parse(&self.sweep, &self.file)
    }

    /// The same diagnostic at a span of the sweep's file, unless it has a file already.
    pub(super) fn locate(&self, diagnostic: Diagnostic, span: Option<Range<usize>>) -> Diagnostic {
        at_span(diagnostic, &self.file, &self.sweep, span.unwrap_or_default())
    }

    /// Returns the SHA-256 of everything that determines the variants, including the program's
    /// version.
    pub fn digest(&self) -> String {
        let mut hash = Sha256::new();
        let rows = self.rows.as_ref().map_or("", |(_, text)| text);
        for text in [env!("CARGO_PKG_VERSION"), &self.name, &self.sweep, &self.base, rows] {
            hash.update((text.len() as u64).to_le_bytes());
            hash.update(text);
        }
        if self.slice {
            hash.update("slice");
        }
        if self.verify {
            hash.update("verify");
        }
        hexadecimal(&hash.finalize())
    }
}

fn parse(sweep: &str, file: &str) -> Result<Document<String>, Diagnostic> {
    sweep.parse().map_err(|e: TomlError| {
        let problem = format!("syntax: {}", e.message().trim().replace('\n', ", "));
        let error = Diagnostic::new(codes::INVALID_TOML, problem)
            .with_help("correct the line; `pinswitch init sweep` writes an example");
        at_span(error, file, sweep, e.span().unwrap_or_default())
    })
}

/// Reads the base and its preset; fields that the base sets take precedence.
fn over_preset(
    (base, file): &(String, String),
    preset: Option<&(String, String)>,
) -> Result<Configuration, Diagnostic> {
    let (over, given) = read(base, file)?;
    let Some((text, name)) = preset else { return Ok(over) };
    let (mut all, _) = read(text, name)?;
    for parameter in Configuration::PARAMETERS.iter().filter(|p| given.contains(&p.path())) {
        (parameter.set)(&mut all, &(parameter.get)(&over))
            .map_err(|error| error.in_field(parameter.path(), ""))?;
    }
    Ok(all)
}

/// Reads a file in the sweep's folder, or a template; returns its name and text.
fn read_text(field: &str, name: &str, folder: &Path, reach: Reach) -> Result<(String, String), Diagnostic> {
    let path = folder.join(name);
    if path.is_file() {
        reach.check(field, name, folder)?;
        let bytes = read_at_most(&path, MAX_SWEEP_BYTES).map_err(|e| unreadable_file(name, e))?;
        return Ok((text(bytes, name)?, name.to_owned()));
    }
    let template = templates::text(name).map(|text| (text, name.to_owned()));
    template.ok_or_else(|| {
        let problem = "neither a file in the sweep's folder nor a template";
        field_error(codes::FILE_NOT_FOUND, field, Some(&format!("{name:?}")), problem, RELATIVE_PATH)
    })
}

/// Reads the CSV of rows; returns its name and text.
fn read_rows(name: String, folder: &Path, reach: Reach) -> Result<(String, String), Diagnostic> {
    reach.check("rows.file", &name, folder)?;
    let bytes = read_at_most(&folder.join(&name), MAX_ROWS_BYTES).map_err(|e| {
        field_error(
            codes::CANNOT_READ,
            "rows.file",
            Some(&format!("{name:?}")),
            "cannot read the file",
            RELATIVE_PATH,
        )
        .with_source(e)
    })?;
    let text = text(bytes, &name)?;
    Ok((name, text))
}

/// Help for a file that a sweep names.
const RELATIVE_PATH: &str =
    "give a path relative to the sweep's file; `pinswitch layouts` lists the templates";

/// The error for a file that the system cannot read.
fn unreadable_file(file: &str, error: Error) -> Diagnostic {
    let help = match error.kind() {
        ErrorKind::IsADirectory => "give a file instead of a folder",
        ErrorKind::FileTooLarge => {
            "put the values into a CSV with one variant a line, and name it as rows.file"
        }
        _ => "give the path of a sweep; see `pinswitch batch --help`",
    };
    Diagnostic::new(codes::CANNOT_READ, "cannot read the file")
        .with_location(Location::file(file))
        .with_help(help)
        .with_source(error)
}
