//! `provenance.json`: what the files of a folder were made from.
//!
//! A command that writes a table, a calibration or a plan lists each file with its SHA-256 and the SHA-256 of every file
//! that it read. The manifest is in the folder of the files and serves all commands that write there. A file that no
//! manifest lists is an external input.

use std::path::{Component, Path, PathBuf};

use pinswitch_batch::{has_valid_checksum, with_checksum};
use pinswitch_diagnostic::{Diagnostic, Location, codes};
use pinswitch_switch::output::OutputFile;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

/// Name of the manifest.
pub(crate) const PROVENANCE: &str = "provenance.json";
/// Name and version of its schema.
const SCHEMA: &str = "pinswitch.provenance/1";
/// Word that every manifest of this program contains several times. A JSON file of this name without it belongs to
/// another program; a single damaged byte does not remove it.
const PROGRAM: &[u8] = b"pinswitch";
/// Digits of a hash that an error shows.
const SHOWN_DIGITS: usize = 8;
/// Commands whose files are out of date once their inputs change. Plans and simulated tables stay valid.
const DERIVING: [&str; 3] = ["import", "segment", "calibrate"];

/// The content of a manifest.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub(crate) struct Provenance {
    /// Name and version of the format.
    schema: String,
    /// One for each run of a command.
    records: Vec<ProvenanceRecord>,
}

/// The files that one run of a command wrote.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub(crate) struct ProvenanceRecord {
    /// Name of the subcommand.
    command: String,
    /// Program and version.
    generator: String,
    /// Every file that the command read.
    sources: Vec<SourceFile>,
    /// Every file that it wrote and that no later command has replaced.
    files: Vec<HashedFile>,
}

/// A file that a command read.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
pub(crate) struct SourceFile {
    /// Path from the folder of the manifest, with `/` on every machine.
    pub(crate) file: String,
    /// SHA-256 of its content, in hexadecimal digits.
    pub(crate) sha256: String,
    /// Whether no manifest listed the file.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub(crate) external: bool,
}

/// A file that a command wrote.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
struct HashedFile {
    /// Name in the folder of the manifest.
    file: String,
    /// SHA-256 of its content, in hexadecimal digits.
    sha256: String,
}

/// Why a manifest cannot be used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ManifestError {
    /// It was changed since it was written.
    Damaged,
    /// Another program wrote it.
    Foreign,
}

impl ManifestError {
    /// Returns the diagnostic of the manifest at `path`.
    pub(crate) fn diagnostic(self, path: &Path) -> Diagnostic {
        let (code, problem, help) = match self {
            Self::Damaged => (
                codes::CHANGED_FILE,
                "was changed since pinswitch wrote it",
                "restore it, or remove it to accept the files of its folder as external inputs",
            ),
            Self::Foreign => (
                codes::FILE_IN_THE_WAY,
                "is not a manifest of pinswitch",
                "move it away, or give another --out",
            ),
        };
        Diagnostic::new(code, problem)
            .with_location(Location::file(path.display().to_string()))
            .with_help(help)
    }
}

impl Default for Provenance {
    fn default() -> Self {
        Self { schema: SCHEMA.to_owned(), records: Vec::new() }
    }
}

impl Provenance {
    /// Parses a manifest.
    ///
    /// # Errors
    /// [`ManifestError`] if this program did not write these bytes.
    pub(crate) fn parse(bytes: &[u8]) -> Result<Self, ManifestError> {
        let is_named = bytes.windows(PROGRAM.len()).any(|window| window == PROGRAM);
        if !is_named && serde_json::from_slice::<serde_json::Value>(bytes).is_ok() {
            return Err(ManifestError::Foreign);
        }
        let parsed = has_valid_checksum(bytes).then(|| serde_json::from_slice::<Self>(bytes).ok()).flatten();
        parsed.filter(|manifest| manifest.schema == SCHEMA).ok_or(ManifestError::Damaged)
    }

    /// Returns the manifest as indented JSON that ends with the SHA-256 of the text before it.
    ///
    /// # Errors
    /// The error of the JSON library.
    pub(crate) fn to_bytes(&self) -> serde_json::Result<Vec<u8>> {
        serde_json::to_vec_pretty(self).map(with_checksum)
    }

    /// Returns the manifest without the entries of files for which `is_current` is false.
    pub(crate) fn retaining(mut self, is_current: impl Fn(&str) -> bool) -> Self {
        for record in &mut self.records {
            record.files.retain(|entry| is_current(&entry.file));
        }
        self.records.retain(|record| !record.files.is_empty());
        self
    }

    /// Returns the manifest with the files that `command` made from `sources`, in place of earlier entries of the same
    /// names.
    pub(crate) fn with_files(self, command: &str, sources: Vec<SourceFile>, files: &[OutputFile]) -> Self {
        let mut all = self.retaining(|name| files.iter().all(|file| file.name != name));
        all.records.push(ProvenanceRecord {
            command: command.to_owned(),
            generator: concat!("pinswitch ", env!("CARGO_PKG_VERSION")).to_owned(),
            sources,
            files: files
                .iter()
                .map(|file| HashedFile { file: file.name.clone(), sha256: sha256(&file.bytes) })
                .collect(),
        });
        all
    }

    /// Returns name and SHA-256 of each file that `command` wrote.
    pub(crate) fn files_of(&self, command: &str) -> impl Iterator<Item = (&str, &str)> {
        let records = self.records.iter().filter(move |record| record.command == command);
        records.flat_map(|record| &record.files).map(|entry| (entry.file.as_str(), entry.sha256.as_str()))
    }

    /// Compares a file of the folder with its entry. Returns the record of the command that wrote it; `None` if the
    /// manifest does not list `name`.
    ///
    /// # Errors
    /// [`ChangedFile`] if its SHA-256 differs from that of its entry.
    pub(crate) fn check(&self, name: &str, sha256: &str) -> Result<Option<&ProvenanceRecord>, ChangedFile> {
        for record in &self.records {
            let Some(entry) = record.files.iter().find(|entry| entry.file == name) else { continue };
            if entry.sha256 == sha256 {
                return Ok(Some(record));
            }
            return Err(ChangedFile {
                command: record.command.clone(),
                written: entry.sha256.clone(),
                current: sha256.to_owned(),
            });
        }
        Ok(None)
    }
}

impl ProvenanceRecord {
    /// Returns the sources whose change makes the files of this record out of date.
    pub(crate) fn sources_to_compare(&self) -> &[SourceFile] {
        if DERIVING.contains(&self.command.as_str()) { &self.sources } else { &[] }
    }

    /// Returns the warning that `path`, a file of this record, is older than one of its sources.
    pub(crate) fn outdated(&self, path: &Path, source: &Path) -> Diagnostic {
        Diagnostic::new(
            codes::OUTDATED_RESULT,
            format!("was made from {}, which has changed since", source.display()),
        )
        .with_location(Location::file(path.display().to_string()))
        .with_help(format!("run `pinswitch {}` again", self.command))
    }
}

/// A file whose content differs from that of its entry.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct ChangedFile {
    /// Command that wrote the file.
    command: String,
    /// SHA-256 of the written content.
    written: String,
    /// SHA-256 of the current content.
    current: String,
}

impl ChangedFile {
    /// Returns the diagnostic of the file at `path`.
    pub(crate) fn diagnostic(&self, path: &Path) -> Diagnostic {
        let digits = |hash: &str| hash.chars().take(SHOWN_DIGITS).collect::<String>();
        let problem = format!(
            "was changed since `pinswitch {}` wrote it (SHA-256 {}..., not {}...)",
            self.command,
            digits(&self.current),
            digits(&self.written)
        );
        let help = format!("restore it; to use the changed file, rename it or remove {PROVENANCE}");
        Diagnostic::new(codes::CHANGED_FILE, problem)
            .with_location(Location::file(path.display().to_string()))
            .with_help(help)
    }
}

/// Returns the SHA-256 in hexadecimal digits.
pub(crate) fn sha256(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|b| format!("{b:02x}")).collect()
}

/// Returns the path from `folder` to `file`, both absolute; `file` itself if they have no root in common.
pub(crate) fn path_from(folder: &Path, file: &Path) -> PathBuf {
    let shared = file.components().zip(folder.components()).take_while(|(a, b)| a == b).count();
    if shared == 0 {
        return file.to_owned();
    }
    let up = folder.components().skip(shared).map(|_| Component::ParentDir);
    up.chain(file.components().skip(shared)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn manifest() -> Provenance {
        let source =
            |file: &str, external| SourceFile { file: file.to_owned(), sha256: sha256(b"s"), external };
        let files = [OutputFile::new("a.csv", "1.5"), OutputFile::new("b.toml", "x = 1")];
        Provenance::default()
            .with_files("segment", vec![source("../run.toml", true)], &files[..1])
            .with_files("calibrate", vec![source("a.csv", false)], &files[1..])
    }

    #[test]
    fn any_damaged_byte_is_found() {
        let bytes = manifest().to_bytes().unwrap();
        assert_eq!(Provenance::parse(&bytes), Ok(manifest()));
        for at in 0..bytes.len() {
            for flip in [1, 2, 16, 32] {
                let mut damaged = bytes.clone();
                damaged[at] ^= flip;
                assert_eq!(Provenance::parse(&damaged), Err(ManifestError::Damaged), "byte {at}");
            }
            assert_eq!(Provenance::parse(&bytes[..at]), Err(ManifestError::Damaged), "{at} bytes");
        }
    }

    #[test]
    fn manifests_of_other_programs_are_foreign() {
        for text in ["{}", "{\"prefix\": {}, \"entity\": []}"] {
            assert_eq!(Provenance::parse(text.as_bytes()), Err(ManifestError::Foreign), "{text}");
        }
    }

    #[test]
    fn listed_files_are_compared() {
        let manifest = manifest();
        let command = |name: &str, content: &str| {
            let record = manifest.check(name, &sha256(content.as_bytes()));
            record.map(|record| record.map(|record| record.command.clone()))
        };
        assert_eq!(command("a.csv", "1.5"), Ok(Some("segment".to_owned())));
        assert_eq!(command("b.toml", "x = 1"), Ok(Some("calibrate".to_owned())));
        assert_eq!(command("mine.toml", "x = 2"), Ok(None));
        let changed = command("a.csv", "1.6").unwrap_err();
        let diagnostic = changed.diagnostic(Path::new("t/a.csv"));
        assert_eq!(diagnostic.location().and_then(|l| l.file.as_deref()), Some("t/a.csv"));
        assert!(diagnostic.problem().contains("`pinswitch segment`"), "{diagnostic}");
    }

    #[test]
    fn new_entries_replace_earlier_ones() {
        let files = [OutputFile::new("a.csv", "2.5")];
        let manifest = manifest().with_files("simulate", Vec::new(), &files);
        assert_eq!(manifest.records.len(), 2, "{manifest:?}");
        assert!(manifest.check("a.csv", &sha256(b"2.5")).unwrap().is_some());
        assert!(manifest.check("a.csv", &sha256(b"1.5")).is_err());
        let manifest = manifest.retaining(|name| name != "b.toml");
        assert_eq!(manifest.check("b.toml", ""), Ok(None));
    }

    #[test]
    fn a_file_is_named_from_the_folder() {
        let from =
            |file: &str, folder: &str| path_from(Path::new(folder), Path::new(file)).display().to_string();
        assert_eq!(from("/a/b/x.toml", "/a/b"), "x.toml");
        assert_eq!(from("/a/c/x.toml", "/a/b"), "../c/x.toml");
        assert_eq!(from("/x.toml", "/a/b"), "../../x.toml");
    }
}
