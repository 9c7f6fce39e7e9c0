//! taplo, the TOML server of editors, reads the schemas that `init --schema` writes.

use std::path::Path;
use std::process::{Command, Output};

use pinswitch_switch::templates::EXAMPLES;

use crate::harness::{done, report_skipped};

const TAPLO: &str = "/tmp/pinswitch-linters/bin/taplo";

#[test]
fn taplo_checks_started_files() {
    if !Command::new(TAPLO).arg("--version").output().is_ok_and(|output| output.status.success()) {
        return report_skipped("taplo is not in /tmp/pinswitch-linters; .ci/install installs it");
    }
    let folder = tempfile::tempdir().unwrap();
    let path: &Path = folder.path();
    let lint = |file: &str| -> Output {
        Command::new(TAPLO).args(["lint", file]).current_dir(path).output().unwrap()
    };
    let names = EXAMPLES.iter().map(|example| example.0).filter(|name| *name != "configurations");
    for name in names.chain(["three-double", "reference"]) {
        let file = format!("{name}.toml");
        done(path, &["init", name, "--schema", "--out", &file]);
        let output = lint(&file);
        assert!(output.status.success(), "{file}: {}", String::from_utf8_lossy(&output.stderr));
    }
    // It has used the schema: a value that the schema refuses has its place.
    let text = std::fs::read_to_string(path.join("three-double.toml")).unwrap();
    let wrong = text.replace("pins = [5, 8, 11]", "pins = \"wide\"");
    assert_ne!(wrong, text);
    std::fs::write(path.join("wrong.toml"), wrong).unwrap();
    let output = lint("wrong.toml");
    let message = String::from_utf8_lossy(&output.stderr);
    assert!(!output.status.success() && message.contains("is not of type \"array\""), "{message}");
}
