//! What the tests of batches share: a small sweep, the real binary, and the hash of every file of a folder.

#![allow(dead_code, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::collections::BTreeMap;
use std::path::Path;
use std::process::{Command, Output};

use sha2::{Digest, Sha256};

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

pub(crate) fn pinswitch(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_pinswitch")).args(arguments).current_dir(folder).output().unwrap()
}

pub(crate) fn done(folder: &Path, arguments: &[&str]) -> String {
    let output = pinswitch(folder, arguments);
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
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
                let digest = Sha256::digest(std::fs::read(&path).unwrap());
                let name = path.strip_prefix(folder).unwrap().to_string_lossy().into_owned();
                all.insert(name, digest.iter().map(|b| format!("{b:02x}")).collect());
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
