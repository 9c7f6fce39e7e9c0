//! Khronos' validator checks `assembly.glb`, where node and `gltf-validator` are installed.

use std::path::Path;
use std::process::Command;

use crate::harness::{done, report_skipped, repository};

/// Folder where `.ci/run` installs the validator.
const VALIDATOR: &str = "/tmp/pinswitch-gltf/node_modules/gltf-validator";

#[test]
fn assembly_passes_gltf_validator() {
    if !Path::new(VALIDATOR).is_dir() {
        return report_skipped("gltf-validator is not in /tmp/pinswitch-gltf; .ci/run installs it");
    }
    let folder = tempfile::tempdir().unwrap();
    let rig = "[layout]\npins = [5, 8, 11]\n[mount]\nkind = \"rig\"\n";
    let finger = "[layout]\npins = [6, 8, 10]\n[mount]\nkind = \"joint\"\n[fasteners]\nkind = \"insert\"\n";
    let mut made = vec![];
    for (name, text) in [("rig.toml", rig), ("finger.toml", finger)] {
        std::fs::write(folder.path().join(name), text).unwrap();
        let set = name.trim_end_matches(".toml");
        done(folder.path(), &["-q", "generate", name, "--format", "glb", "--out", set]);
        made.push(folder.path().join(set).join("assembly.glb"));
    }
    // The validator must refuse a truncated file.
    let broken = folder.path().join("broken.glb");
    std::fs::write(&broken, &std::fs::read(&made[0]).unwrap()[..2000]).unwrap();
    let judge = |file: &Path| {
        let script = repository("tests/programs/gltf.cjs");
        let output = Command::new("node").arg(script).arg(VALIDATOR).arg(file).output().unwrap();
        (output.status.success(), String::from_utf8_lossy(&output.stdout).into_owned())
    };
    for file in &made {
        let (is_valid, message) = judge(file);
        assert!(is_valid, "{}: {message}", file.display());
    }
    assert!(!judge(&broken).0, "a broken file passes");
}
