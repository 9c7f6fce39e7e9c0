//! What a sweep is made of, as text: its own file, the configuration under it, its rows. Kept in `batch.json`, so that
//! a batch can be resumed or merged without the files it was started from.

use std::io::Read;
use std::ops::Range;
use std::path::Path;

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use toml_edit::Document;

use super::hexadecimal;
use pinswitch_switch::config::{ConfigError, Configuration, Name, Place, read, text, to_toml};
use pinswitch_switch::templates;

/// Longest sweep: every value of its lists is held in memory, at a hundred times its length.
const MAX_SWEEP_BYTES: u64 = 1 << 20;
/// Longest table of rows, of which the places of the rows are kept.
const MAX_ROWS_BYTES: u64 = 256 << 20;

/// The bytes of a file that is no longer than `most`; no more than these are read of any.
///
/// # Errors
/// Those of the system, and [`std::io::ErrorKind::FileTooLarge`].
pub fn read_at_most(path: &Path, most: u64) -> std::io::Result<Vec<u8>> {
    let too_large = || {
        let problem = format!("holds more than {most} bytes");
        std::io::Error::new(std::io::ErrorKind::FileTooLarge, problem)
    };
    let file = std::fs::File::open(path)?;
    if file.metadata()?.len() > most {
        return Err(too_large());
    }
    let mut bytes = Vec::new();
    // A pipe has no length.
    file.take(most + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most { Err(too_large()) } else { Ok(bytes) }
}

/// The texts of a sweep.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct SweepSource {
    /// Name of the sweep: as given, or the stem of its file.
    pub name: String,
    /// Name of the sweep's file, for errors.
    pub file: String,
    /// The sweep's file.
    pub sweep: String,
    /// The base configuration with its preset, as TOML.
    pub base: String,
    /// Name and text of the CSV of rows.
    pub rows: Option<(String, String)>,
    /// Whether a slicer is asked of every variant: said by whoever runs it, not by the sweep's file.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub slice: bool,
    /// Whether every mesh is verified by a second kernel: an option of the run, not of the sweep's file.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub verify: bool,
}

/// The files that a sweep may name.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Reach {
    /// Those beside it or below.
    #[default]
    Beside,
    /// Any, on the word of whoever runs it.
    Anywhere,
}

impl Reach {
    /// Whether the existing file `name` of `field` may be read by a sweep in `folder`. Links are followed first.
    fn check(self, field: &str, name: &str, folder: &Path) -> Result<(), ConfigError> {
        let is_below =
            || Some(folder.join(name).canonicalize().ok()?.starts_with(folder.canonicalize().ok()?));
        if self == Self::Anywhere || is_below() != Some(false) {
            return Ok(());
        }
        Err(ConfigError {
            remedy: "copy it beside the sweep, or allow it with --read-outside".to_owned(),
            ..missing(field, name, "lies outside the folder of the sweep")
        })
    }
}

impl SweepSource {
    /// Reads the sweep at `path` and every file that it names: beside it or below. A sweep that came from elsewhere
    /// cannot make its reader open any other file.
    ///
    /// # Errors
    /// [`ConfigError`] names the file that cannot be read, or the field that names none.
    pub fn read(path: &Path) -> Result<Self, ConfigError> {
        Self::read_within(path, Reach::Beside)
    }

    /// As [`Self::read`], with the files that it may name.
    ///
    /// # Errors
    /// As [`Self::read`].
    pub fn read_within(path: &Path, reach: Reach) -> Result<Self, ConfigError> {
        let file = path.display().to_string();
        let sweep = text(read_at_most(path, MAX_SWEEP_BYTES).map_err(|e| unreadable(&file, &e))?, &file)?;
        let document: Document<String> = sweep.parse().map_err(|e: toml_edit::TomlError| {
            ConfigError::syntax(Place::new(&file, &sweep, e.span().map_or(0, |s| s.start)), e.message())
        })?;
        let item = |table: &str, key: &str| document.get(table)?.as_table_like()?.get(key);
        let word = |table: &str, key: &str| {
            item(table, key).map(|item| item.as_str().unwrap_or_default().to_owned())
        };
        let at = |table: &str, key: &str| {
            let span = item(table, key).and_then(toml_edit::Item::span);
            let place = Place::new(&file, &sweep, span.map_or(0, |s| s.start));
            move |e: ConfigError| e.at(place.clone())
        };
        let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or_else(|| Path::new("."));
        let base = match word("sweep", "base") {
            Some(name) => read_text("sweep.base", &name, folder, reach).map_err(at("sweep", "base"))?,
            None => (String::new(), "defaults".to_owned()),
        };
        let preset = word("sweep", "preset")
            .map(|name| read_text("sweep.preset", &name, folder, reach).map_err(at("sweep", "preset")))
            .transpose()?;
        let rows = word("rows", "file")
            .map(|name| {
                let path = folder.join(&name);
                reach.check("rows.file", &name, folder).map_err(at("rows", "file"))?;
                let bytes = read_at_most(&path, MAX_ROWS_BYTES).map_err(|e| {
                    at("rows", "file")(missing("rows.file", &name, &format!("cannot be read: {e}")))
                })?;
                Ok((name.clone(), text(bytes, &name)?))
            })
            .transpose()?;
        let stem = path.file_stem().map_or_else(|| "batch".into(), |s| s.to_string_lossy());
        Ok(Self {
            name: word("sweep", "name").unwrap_or_else(|| Name::cleaned(&stem).to_string()),
            base: to_toml(&with_preset(&base, preset.as_ref())?),
            file,
            sweep,
            rows,
            slice: false,
            verify: false,
        })
    }

    /// Where a span of the sweep's file begins.
    pub(super) fn place(&self, span: Option<Range<usize>>) -> Place {
        Place::new(&self.file, &self.sweep, span.map_or(0, |s| s.start))
    }

    /// SHA-256 of everything that decides what the variants are, and of the program's version.
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

/// The base over the preset: what the base sets wins.
fn with_preset(
    (base, file): &(String, String),
    preset: Option<&(String, String)>,
) -> Result<Configuration, ConfigError> {
    let (over, given) = read(base, file)?;
    let Some((text, name)) = preset else { return Ok(over) };
    let (mut all, _) = read(text, name)?;
    for parameter in Configuration::PARAMETERS.iter().filter(|p| given.sets(&p.path())) {
        (parameter.set)(&mut all, &(parameter.get)(&over))
            .map_err(|remedy| ConfigError::new(parameter.path(), "", remedy))?;
    }
    Ok(all)
}

/// The text of a file beside the sweep or of a template, with its name.
fn read_text(field: &str, name: &str, folder: &Path, reach: Reach) -> Result<(String, String), ConfigError> {
    let path = folder.join(name);
    if path.is_file() {
        reach.check(field, name, folder)?;
        let text = text(read_at_most(&path, MAX_SWEEP_BYTES).map_err(|e| unreadable(name, &e))?, name)?;
        return Ok((text, name.to_owned()));
    }
    templates::text(name)
        .map(|text| (text, name.to_owned()))
        .ok_or_else(|| missing(field, name, "is neither a file beside the sweep nor a template"))
}

fn missing(field: &str, name: &str, problem: &str) -> ConfigError {
    ConfigError {
        field: field.to_owned(),
        value: Some(format!("{name:?}")),
        problem: problem.to_owned(),
        remedy: "give a path relative to the sweep's file; `pinswitch layouts` lists the templates"
            .to_owned(),
        changes: Vec::new(),
        place: None,
    }
}

fn unreadable(file: &str, error: &std::io::Error) -> ConfigError {
    ConfigError {
        field: file.to_owned(),
        value: None,
        problem: format!("cannot be read: {error}"),
        remedy: match error.kind() {
            std::io::ErrorKind::IsADirectory => "it is a folder; give a file".to_owned(),
            std::io::ErrorKind::FileTooLarge => {
                "put the values into a CSV, one variant a line, and name that as rows.file".to_owned()
            }
            _ => "give the path of a sweep; see `pinswitch batch --help`".to_owned(),
        },
        changes: Vec::new(),
        place: None,
    }
}
