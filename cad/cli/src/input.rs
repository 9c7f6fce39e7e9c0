//! Reads the files that the user names, compares them with the manifest of their folder, and records which were read:
//! no command overwrites its own input, and the files that it writes list their sources.

use std::collections::{BTreeMap, BTreeSet};
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use pinswitch_diagnostic::{Code, Diagnostic, Location, codes};
use pinswitch_switch::config::text;

use super::Failure;
use super::terminal::warn;
use crate::provenance::{
    ManifestError, PROVENANCE, Provenance, ProvenanceRecord, SourceFile, path_from, sha256,
};

/// Longest configuration, plan, model or report, in bytes: some hundred times the longest in practice.
const MAX_TEXT: u64 = 16 << 20;
/// Longest 3MF that contains a configuration, in bytes.
const MAX_PACKAGE: u64 = 256 << 20;
/// Longest table or log, in bytes: some million rows.
const MAX_TABLE: u64 = 1 << 30;

/// Reads a text file, such as a configuration, a plan or a model.
///
/// # Errors
/// [`Failure::bad_input`] if the file cannot be read, is too long, or is not UTF-8; the last with the line.
pub(super) fn read_text_file(path: &Path) -> Result<String, Failure> {
    let bytes = read_at_most(path, MAX_TEXT)?;
    text(bytes, &path.display().to_string()).map_err(Failure::bad_input)
}

/// Reads the bytes of a configuration: a text, or the 3MF of a set.
///
/// # Errors
/// [`Failure::bad_input`] if the file cannot be read or is too long.
pub(super) fn read_configuration(path: &Path) -> Result<Vec<u8>, Failure> {
    let mut begin = [0; 2];
    let is_package = path.is_file()
        && File::open(path).and_then(|mut f| f.read_exact(&mut begin)).is_ok()
        && begin == *b"PK";
    read_at_most(path, if is_package { MAX_PACKAGE } else { MAX_TEXT })
}

/// A file that was read.
#[derive(Clone, Debug)]
pub(super) struct InputFile {
    /// SHA-256 of its content, in hexadecimal digits.
    pub(super) sha256: String,
    /// Whether no manifest lists the file.
    pub(super) is_external: bool,
}

/// Every file that was read, by its canonical path.
static READ: Mutex<BTreeMap<PathBuf, InputFile>> = Mutex::new(BTreeMap::new());

/// Sources whose change was reported.
static REPORTED: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

/// Whether this process has read the file at `path`, through this path or another one.
pub(super) fn was_read(path: &Path) -> bool {
    let Ok(real) = path.canonicalize() else { return false };
    READ.lock().unwrap_or_else(PoisonError::into_inner).contains_key(&real)
}

/// Returns the SHA-256 of the file at `path` in hexadecimal digits; `None` if this process has not read it.
pub(super) fn sha256_read(path: &Path) -> Option<String> {
    let real = path.canonicalize().ok()?;
    READ.lock().unwrap_or_else(PoisonError::into_inner).get(&real).map(|input| input.sha256.clone())
}

/// Returns the files that this process has read, by their canonical paths.
pub(super) fn files_read() -> BTreeMap<PathBuf, InputFile> {
    READ.lock().unwrap_or_else(PoisonError::into_inner).clone()
}

/// Returns the files that this process has read as the sources in a manifest in `folder`, which exists.
pub(super) fn sources_from(folder: &Path) -> Vec<SourceFile> {
    let folder = folder.canonicalize().unwrap_or_else(|_| folder.to_owned());
    let source = |(path, InputFile { sha256, is_external }): (PathBuf, InputFile)| SourceFile {
        file: path_from(&folder, &path).to_string_lossy().replace('\\', "/"),
        sha256,
        external: is_external,
    };
    let mut sources: Vec<SourceFile> = files_read().into_iter().map(source).collect();
    sources.sort();
    sources
}

/// Reads the manifest in `folder`; `None` if there is none, or only one of another program.
///
/// # Errors
/// A [`Diagnostic`] if it cannot be read or was changed.
fn manifest_in(folder: &Path) -> Result<Option<Provenance>, Diagnostic> {
    let path = folder.join(PROVENANCE);
    let bytes = match pinswitch_store::read_own(&path, MAX_TEXT) {
        Ok(Some(bytes)) => bytes,
        Ok(None) => return Ok(None),
        Err(e) => {
            return Err(Diagnostic::new(codes::CANNOT_READ, "cannot read")
                .with_location(Location::file(path.display().to_string()))
                .with_help("make it readable, or move it away")
                .with_source(e));
        }
    };
    match Provenance::parse(&bytes) {
        Ok(manifest) => Ok(Some(manifest)),
        Err(ManifestError::Foreign) => Ok(None),
        Err(e) => Err(e.diagnostic(&path)),
    }
}

/// Compares the file `real` with its entry in the manifest of its folder and records it as input. `path` is its name in
/// errors. Warns about sources that have changed.
fn record_input(path: &Path, real: &Path, bytes: &[u8]) -> Result<(), Diagnostic> {
    let hash = sha256(bytes);
    let mut is_external = true;
    if let (Some(folder), Some(name)) = (real.parent(), real.file_name().and_then(|name| name.to_str())) {
        // A person knows the folder by the path that they gave.
        let shown = if path.is_symlink() { folder } else { path.parent().unwrap_or(folder) };
        if let Some(manifest) = manifest_in(shown)? {
            let record = manifest.check(name, &hash).map_err(|changed| changed.diagnostic(path))?;
            is_external = record.is_none();
            record.into_iter().for_each(|record| warn_of_changed_sources(record, path, shown));
        }
    }
    let input = InputFile { sha256: hash, is_external };
    READ.lock().unwrap_or_else(PoisonError::into_inner).insert(real.to_owned(), input);
    Ok(())
}

/// Warns once about each source of `path` that exists and has another content than it had.
fn warn_of_changed_sources(record: &ProvenanceRecord, path: &Path, folder: &Path) {
    for source in record.sources_to_compare() {
        let of = folder.join(&source.file);
        let Ok(real) = of.canonicalize() else { continue };
        let is_new = REPORTED.lock().unwrap_or_else(PoisonError::into_inner).insert(real);
        if !is_new || !of.is_file() {
            continue;
        }
        let Ok(bytes) = pinswitch_store::read_at_most(&of, MAX_TABLE) else { continue };
        if sha256(&bytes) != source.sha256 {
            warn(record.outdated(path, &of));
        }
    }
}

/// Reads the bytes of a table or log.
///
/// # Errors
/// [`Failure::bad_input`] if the file cannot be read or is too long.
pub(super) fn read_file(path: &Path) -> Result<Vec<u8>, Failure> {
    read_at_most(path, MAX_TABLE)
}

/// Reads a file of at most `most` bytes, compares it with the manifest of its folder and records it as input. A file
/// without an end, such as `/dev/zero`, is too long.
fn read_at_most(path: &Path, most: u64) -> Result<Vec<u8>, Failure> {
    let refused = |code: Code, problem: &str, help: &str| {
        Diagnostic::new(code, problem)
            .with_location(Location::file(path.display().to_string()))
            .with_help(help)
    };
    if path.is_dir() {
        return Err(Failure::bad_input(refused(codes::NOT_A_FILE, "is a folder", "give a file")));
    }
    // A run that was killed may have left the folder between two results.
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    pinswitch_store::recover(folder).map_err(|e| {
        let problem = "cannot complete the changes of an interrupted run in its folder";
        Failure::bad_input(
            refused(codes::CANNOT_WRITE, problem, "run that command again, or restore the folder")
                .with_source(e),
        )
    })?;
    let bytes = pinswitch_store::read_at_most(path, most).map_err(|e| {
        Failure::bad_input(match e.kind() {
            std::io::ErrorKind::FileTooLarge => refused(
                codes::FILE_TOO_LARGE,
                &format!("is longer than {most} bytes"),
                "check that this is the right file",
            ),
            _ => refused(codes::CANNOT_READ, "cannot read", "give a file that exists and can be read")
                .with_source(e),
        })
    })?;
    // A pipe is neither overwritten nor listed.
    if path.is_file()
        && let Ok(real) = path.canonicalize()
    {
        record_input(path, &real, &bytes).map_err(Failure::bad_input)?;
    }
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_too_long_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("a.toml");
        // A sparse file: it takes no room on the disk.
        std::fs::File::create(&file).unwrap().set_len(MAX_TEXT + 1).unwrap();
        for path in [file.as_path(), Path::new("/dev/zero")] {
            let error = read_text_file(path).unwrap_err().to_string();
            assert!(error.contains("longer than 16777216 bytes"), "{error}");
        }
    }

    #[test]
    fn a_byte_outside_utf8_has_its_line() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("a.toml");
        std::fs::write(&file, b"a = 1\nb = \"\xff\"\n").unwrap();
        let error = read_text_file(&file).unwrap_err();
        let [diagnostic] = error.diagnostics() else { panic!("{error}") };
        let location = diagnostic.location().unwrap();
        assert_eq!((location.file.as_deref(), location.line), (Some(&*file.to_string_lossy()), Some(2)));
        assert!(error.to_string().contains("byte 0xff"), "{error}");
        assert_eq!(diagnostic.help(), Some("save the file as UTF-8 text"));
    }

    #[test]
    fn a_folder_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let error = read_text_file(folder.path()).unwrap_err().to_string();
        assert!(error.ends_with(": is a folder; give a file"), "{error}");
    }
}
