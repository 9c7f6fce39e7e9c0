//! What the test binaries share: the real binary, the repository's files, folders and their hashes, a small sweep.

#![allow(dead_code)]

pub(crate) mod preview;
#[path = "../../cad/solid/src/files/step/step_file.rs"]
pub(crate) mod step_file;

use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::Value;
use sha2::{Digest, Sha256};

/// A file or folder of this repository.
pub(crate) fn repository(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(path)
}

/// Says that a test is skipped. Written past the capture of passing tests' output, so that it is always heard.
pub(crate) fn say_skipped(reason: &str) {
    let test = std::thread::current().name().unwrap_or("a test").to_owned();
    let _ = writeln!(std::io::stderr(), "SKIPPED {test}: {reason}");
}

/// A file that lies beside this repository in CI only.
pub(crate) fn beside_repository(path: &str) -> Option<PathBuf> {
    let found = repository("../shared").join(path);
    if !found.exists() {
        say_skipped(&format!("{} is not here", found.display()));
    }
    found.exists().then_some(found)
}

/// The browser of this machine, if there is one.
pub(crate) fn browser() -> Option<&'static str> {
    ["chromium", "chromium-browser", "google-chrome"]
        .into_iter()
        .find(|name| Command::new(name).arg("--version").output().is_ok_and(|output| output.status.success()))
}

/// The command of the real binary.
pub(crate) fn binary() -> Command {
    Command::new(env!("CARGO_BIN_EXE_pinswitch"))
}

/// Variants of [`SWEEP`] that cannot be built or are forbidden: 60 grooves overlap, 12 mm is too narrow.
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

/// Runs the binary in a folder; it must end with this exit code.
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

/// What a successful run prints on standard output.
pub(crate) fn printed(folder: &Path, arguments: &[&str]) -> String {
    String::from_utf8(expect_code(0, folder, arguments).stdout).unwrap()
}

/// What a successful run prints, as JSON.
pub(crate) fn json(folder: &Path, arguments: &[&str]) -> Value {
    serde_json::from_str(&printed(folder, arguments)).unwrap()
}

/// Every file of a folder, by name.
pub(crate) fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    std::fs::read_dir(folder)
        .unwrap()
        .map(|e| e.unwrap().path())
        .map(|p| (p.file_name().unwrap().to_string_lossy().into_owned(), std::fs::read(&p).unwrap()))
        .collect()
}

/// SHA-256 in hexadecimal.
pub(crate) fn sha256(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|b| format!("{b:02x}")).collect()
}

/// Everything that a successful run says.
pub(crate) fn done(folder: &Path, arguments: &[&str]) -> String {
    let output = expect_code(0, folder, arguments);
    String::from_utf8([output.stdout, output.stderr].concat()).unwrap()
}

/// Exit code and everything that was said.
pub(crate) fn ended(folder: &Path, arguments: &[&str]) -> (Option<i32>, String) {
    let output = pinswitch(folder, arguments);
    (output.status.code(), String::from_utf8([output.stdout, output.stderr].concat()).unwrap())
}

/// A folder with the sweep in it.
pub(crate) fn with_sweep(text: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("sweep.toml"), text).unwrap();
    folder
}

/// SHA-256 of every file under `folder`, by its path.
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

/// Differences between two folders, for a message.
pub(crate) fn differences(a: &BTreeMap<String, String>, b: &BTreeMap<String, String>) -> Vec<String> {
    let names = a.keys().chain(b.keys());
    let mut all: Vec<_> = names.filter(|n| a.get(*n) != b.get(*n)).cloned().collect();
    all.sort();
    all.dedup();
    all
}

/// The rows of a table, by column.
pub(crate) fn table(folder: &Path) -> Vec<BTreeMap<String, String>> {
    let text = std::fs::read(folder.join("variants.csv")).unwrap();
    let mut reader = csv::Reader::from_reader(text.as_slice());
    let header = reader.headers().unwrap().clone();
    let row = |r: csv::StringRecord| {
        header.iter().map(str::to_owned).zip(r.iter().map(str::to_owned)).collect::<BTreeMap<_, _>>()
    };
    reader.records().map(|r| row(r.unwrap())).collect()
}
