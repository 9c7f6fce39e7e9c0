//! `--verify`: every mesh of a set or a batch is compared with that of a second kernel, and the
//! manifest records it.

use std::path::Path;

use crate::harness::{done, ended, files, repository};
use serde_json::Value;

/// Reads the manifest of a set.
fn manifest(set: &Path) -> Value {
    serde_json::from_slice(&std::fs::read(set.join("manifest.json")).unwrap()).unwrap()
}

/// Asserts that every part of a manifest agrees with the second kernel within its limits.
fn assert_verified(manifest: &Value) {
    let parts = manifest["parts"].as_array().unwrap();
    assert!(!parts.is_empty());
    for part in parts {
        let verification = &part["verification"];
        assert_eq!(verification["kernel"], "truck-modeling", "{part}");
        assert_eq!(verification["closed"], true, "{part}");
        let number = |key: &str| verification[key].as_f64().unwrap();
        let pair = |key: &str, i: usize| verification[key][i].as_f64().unwrap();
        for (difference, limit) in [
            (number("volume_relative"), number("volume_limit")),
            (number("area_relative"), number("area_limit")),
            (number("bounds_mm"), number("bounds_limit_mm")),
            (pair("distance_mm", 0), pair("distance_limit_mm", 0)),
            (pair("distance_mm", 1), pair("distance_limit_mm", 1)),
        ] {
            assert!(difference <= limit && limit > 0.0, "{}: {verification}", part["name"]);
        }
    }
}

#[test]
fn a_verified_set_records_the_agreement() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    done(path, &["-q", "generate", "three-double", "--format", "stl,3mf", "--out", "plain"]);
    let arguments = ["generate", "three-double", "--format", "stl,3mf", "--verify", "--out", "verified"];
    if !cfg!(feature = "truck") {
        let (code, output) = ended(path, &arguments);
        assert!(code == Some(2) && output.contains("--features truck"), "{output}");
        return;
    }
    let output = done(path, &arguments);
    assert!(output.contains("meshes agree with truck-modeling"), "{output}");
    let mut verified = manifest(&path.join("verified"));
    assert_verified(&verified);
    // The set without the record is otherwise equal.
    for part in verified["parts"].as_array_mut().unwrap() {
        part.as_object_mut().unwrap().remove("verification").unwrap();
    }
    assert_eq!(verified, manifest(&path.join("plain")));
    let (mut plain, mut verified) = (files(&path.join("plain")), files(&path.join("verified")));
    assert!(plain.remove("manifest.json") != verified.remove("manifest.json"));
    assert_eq!(plain, verified);
}

#[test]
fn parts_with_hardware_are_verified() {
    if !cfg!(feature = "truck") {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let source = repository("tests/corpus/hardware-all-at-once.toml");
    let source = source.to_string_lossy();
    done(folder.path(), &["-q", "generate", &source, "--format", "stl", "--verify", "--out", "set"]);
    assert_verified(&manifest(&folder.path().join("set")));
}

#[test]
fn a_verified_batch_records_the_agreement() {
    if !cfg!(feature = "truck") {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let sweep = "[sweep]\nname = \"small\"\nparts = [\"shell\", \"coupon\"]\n[set]\n\"friction.points\" = 2\n\
                 [axes]\n\"shell.width_mm\" = [13, 14]\n";
    std::fs::write(folder.path().join("sweep.toml"), sweep).unwrap();
    done(folder.path(), &["-q", "batch", "sweep.toml", "--verify", "--out", "all"]);
    let variants: Vec<_> = std::fs::read_dir(folder.path().join("all/variants")).unwrap().collect();
    assert_eq!(variants.len(), 2);
    for variant in variants {
        assert_verified(&manifest(&variant.unwrap().path()));
    }
    // A batch without the record is a different batch.
    let (code, output) = ended(folder.path(), &["batch", "sweep.toml", "--out", "all"]);
    assert_eq!(code, Some(2), "{output}");
}
