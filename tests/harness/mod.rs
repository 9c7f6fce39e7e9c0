//! Shared by the test binaries: the binary under test, files of the repository, folders and their
//! hashes, a small sweep.

#![allow(dead_code)]

pub(crate) mod flips;
pub(crate) mod preview;
#[path = "../../cad/solid/src/files/step/step_file/mod.rs"]
pub(crate) mod step_file;

use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::Value;
use sha2::{Digest, Sha256};

/// Returns the path of a file or folder of this repository.
pub(crate) fn repository(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(path)
}

/// Reports that a test is skipped, on the standard error that `cargo test` does not capture. In CI,
/// which installs every judge, a skipped test fails.
pub(crate) fn report_skipped(reason: &str) {
    let test = std::thread::current().name().unwrap_or("a test").to_owned();
    assert!(std::env::var_os("CI").is_none(), "{test} cannot be skipped in CI: {reason}");
    let _ = writeln!(std::io::stderr(), "SKIPPED {test}: {reason}");
}

/// Returns the path of a file in the folder `shared` next to this repository, which CI has.
pub(crate) fn shared_file(path: &str) -> Option<PathBuf> {
    let file = repository("../shared").join(path);
    if !file.exists() {
        let _ = writeln!(std::io::stderr(), "SKIPPED: {} is not here", file.display());
    }
    file.exists().then_some(file)
}

/// Returns the name of an installed browser.
pub(crate) fn browser() -> Option<&'static str> {
    ["chromium", "chromium-browser", "google-chrome"]
        .into_iter()
        .find(|name| Command::new(name).arg("--version").output().is_ok_and(|output| output.status.success()))
}

/// Returns a command that runs the binary under test.
pub(crate) fn binary() -> Command {
    Command::new(env!("CARGO_BIN_EXE_pinswitch"))
}

/// Variants of [`SWEEP`] that cannot be built or are forbidden: 60 grooves overlap, 12 mm is too
/// narrow.
pub(crate) const REFUSED: usize = 12;
/// All variants of [`SWEEP`].
pub(crate) const VARIANTS: usize = 24;

pub(crate) const SWEEP: &str = r#"
[sweep]
name = "small"
base = "three-double"
parts = ["shell", "mould-ring", "support-left", "coupon"]
[set]
"friction.points" = 11
[axes]
"segment.grooves" = [15, 60]
"shell.width_mm" = { from = 13, to = 15, step = 1 }
"layout.pins" = [[5, 8, 11], [4, 8, 12]]
"tendon.length_mm" = [200, 300]
[[constraints]]
require = "shell.width_mm >= 14 || tendon.length_mm > 0"
"#;

/// Runs the binary in a folder.
pub(crate) fn pinswitch<S: AsRef<OsStr>>(folder: &Path, arguments: &[S]) -> Output {
    binary().args(arguments).current_dir(folder).output().unwrap()
}

/// Runs the binary in a folder and asserts its exit code.
pub(crate) fn expect_code<S: AsRef<OsStr> + std::fmt::Debug>(
    code: i32,
    folder: &Path,
    arguments: &[S],
) -> Output {
    let output = pinswitch(folder, arguments);
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(code), "{arguments:?}: {message}");
    output
}

/// Returns the standard output of a successful run.
pub(crate) fn printed(folder: &Path, arguments: &[&str]) -> String {
    String::from_utf8(expect_code(0, folder, arguments).stdout).unwrap()
}

/// Returns the standard output of a successful run as JSON.
pub(crate) fn json(folder: &Path, arguments: &[&str]) -> Value {
    serde_json::from_str(&printed(folder, arguments)).unwrap()
}

/// Returns the bytes of every file of a folder, by name.
pub(crate) fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    std::fs::read_dir(folder)
        .unwrap()
        .map(|e| e.unwrap().path())
        .map(|p| (p.file_name().unwrap().to_string_lossy().into_owned(), std::fs::read(&p).unwrap()))
        .collect()
}

/// Returns the SHA-256 in hexadecimal.
pub(crate) fn sha256(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|b| format!("{b:02x}")).collect()
}

/// Returns the standard output and standard error of a successful run.
pub(crate) fn done(folder: &Path, arguments: &[&str]) -> String {
    let output = expect_code(0, folder, arguments);
    String::from_utf8([output.stdout, output.stderr].concat()).unwrap()
}

/// Returns the exit code, and the standard output and standard error.
pub(crate) fn ended(folder: &Path, arguments: &[&str]) -> (Option<i32>, String) {
    let output = pinswitch(folder, arguments);
    (output.status.code(), String::from_utf8([output.stdout, output.stderr].concat()).unwrap())
}

/// Creates a temporary folder that contains the sweep.
pub(crate) fn with_sweep(text: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("sweep.toml"), text).unwrap();
    folder
}

/// Returns the SHA-256 of every file under `folder`, by its path.
pub(crate) fn hashes(folder: &Path) -> BTreeMap<String, String> {
    let mut all = BTreeMap::new();
    let mut left = vec![folder.to_owned()];
    while let Some(next) = left.pop() {
        for entry in std::fs::read_dir(&next).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                left.push(path);
            } else {
                let name = path.strip_prefix(folder).unwrap().to_string_lossy().into_owned();
                all.insert(name, sha256(&std::fs::read(&path).unwrap()));
            }
        }
    }
    all
}

/// Returns the sorted paths at which the hashes of two folders differ.
pub(crate) fn differences(a: &BTreeMap<String, String>, b: &BTreeMap<String, String>) -> Vec<String> {
    let names = a.keys().chain(b.keys());
    let mut all: Vec<_> = names.filter(|n| a.get(*n) != b.get(*n)).cloned().collect();
    all.sort();
    all.dedup();
    all
}

/// Reads the rows of the table of a batch, by column.
pub(crate) fn table(folder: &Path) -> Vec<BTreeMap<String, String>> {
    let text = std::fs::read(folder.join("variants.csv")).unwrap();
    let mut reader = csv::Reader::from_reader(text.as_slice());
    let header = reader.headers().unwrap().clone();
    let row = |r: csv::StringRecord| {
        header.iter().map(str::to_owned).zip(r.iter().map(str::to_owned)).collect::<BTreeMap<_, _>>()
    };
    reader.records().map(|r| row(r.unwrap())).collect()
}
