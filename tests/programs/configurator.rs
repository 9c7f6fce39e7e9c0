//! The configurator in a real browser, driven as a person would drive it (`tests/browser`), with `pinswitch view` and with
//! the module; what both give is what the command line writes, byte for byte.
//!
//! Needs chromium, node, and puppeteer-core and axe-core in `/tmp/pinswitch-browser`, where `.ci/run` puts them. The module
//! is that of the site in `PINSWITCH_SITE`, a folder that `cad/app/build` made, which takes many minutes.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::harness::{browser, pinswitch, repository, say_skipped};

const TOOLS: &str = "/tmp/pinswitch-browser";
/// Lines of a table that a calibration takes a moment for.
const LINES: usize = 300;

/// The folder of a site with its module.
fn site() -> Option<PathBuf> {
    let site = std::env::var_os("PINSWITCH_SITE");
    if site.is_none() {
        say_skipped(
            "the module is not tried, the server is: run cad/app/build site, and give PINSWITCH_SITE=site as an absolute path",
        );
    }
    site.map(PathBuf::from)
}

/// A table of plateaus of a rig with one effect.
fn table(folder: &Path) -> PathBuf {
    let made = pinswitch(
        folder,
        &["-q", "simulate", "--randomised", "--effect", "coating_ploughing=0.024", "--out", "rig"],
    );
    assert!(made.status.success(), "{}", String::from_utf8_lossy(&made.stderr));
    let text = std::fs::read_to_string(folder.join("rig/plateaus.csv")).unwrap();
    let short = folder.join("plateaus.csv");
    std::fs::write(&short, text.lines().take(LINES).collect::<Vec<_>>().join("\n")).unwrap();
    short
}

#[test]
fn the_configurator_does_in_a_browser_what_a_person_asks() {
    let Some(browser) = browser() else {
        return say_skipped("no chromium here; Debian's package is called chromium");
    };
    if !Command::new("node").arg("--version").output().is_ok_and(|output| output.status.success()) {
        return say_skipped("no node here; Debian's package is called nodejs");
    }
    if !["puppeteer-core", "axe-core"]
        .iter()
        .all(|name| Path::new(TOOLS).join("node_modules").join(name).is_dir())
    {
        return say_skipped(
            "puppeteer-core and axe-core are not in /tmp/pinswitch-browser; .ci/run installs them",
        );
    }
    let folder = tempfile::tempdir().unwrap();
    let job = serde_json::json!({
        "binary": env!("CARGO_BIN_EXE_pinswitch"),
        "browser": browser_path(browser),
        "tools": TOOLS,
        "table": table(folder.path()),
        "pictures": repository("out/configurator"),
        "site": site(),
    });
    let file = folder.path().join("job.json");
    std::fs::write(&file, job.to_string()).unwrap();
    let run = Command::new("node").arg(repository("tests/browser/run.mjs")).arg(&file).output().unwrap();
    let said = String::from_utf8_lossy(&run.stdout);
    println!("{said}{}", String::from_utf8_lossy(&run.stderr));
    assert!(run.status.success(), "the configurator does not do what it should: {said}");
}

/// Where the browser is, since node looks nothing up.
fn browser_path(name: &str) -> PathBuf {
    let path = std::env::var_os("PATH").unwrap_or_default();
    std::env::split_paths(&path).map(|folder| folder.join(name)).find(|file| file.is_file()).unwrap()
}
