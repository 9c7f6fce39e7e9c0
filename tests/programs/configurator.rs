//! The configurator in Chromium (`tests/browser`), with `pinswitch view` and with the module; the
//! files of both equal those of the command line, byte for byte. Five walks through the published page in Firefox, too.
//!
//! The tests need chromium, firefox-esr, node, and puppeteer-core and axe-core in `/tmp/pinswitch-browser`,
//! where `.ci/run` installs them. The module is that of the site in `PINSWITCH_SITE`, a folder that
//! `cad/app/build` writes in many minutes.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::harness::{browser, pinswitch, report_skipped, repository};

const TOOLS: &str = "/tmp/pinswitch-browser";
/// Every such series is in the table: all conditions, and few enough rows for a calibration within seconds.
const EVERY: usize = 10;

/// Returns the folder of a site with the module, if there is one.
fn site() -> Option<PathBuf> {
    let site = std::env::var_os("PINSWITCH_SITE");
    if site.is_none() {
        report_skipped(
            "only the server is tested; to test the module, run cad/app/build site and set PINSWITCH_SITE to its absolute path",
        );
    }
    site.map(PathBuf::from)
}

/// Simulates a table of plateaus of a rig with one effect.
fn table(folder: &Path) -> PathBuf {
    let made = pinswitch(
        folder,
        &["-q", "simulate", "--randomised", "--effect", "coating_ploughing=0.024", "--out", "rig"],
    );
    assert!(made.status.success(), "{}", String::from_utf8_lossy(&made.stderr));
    let text = std::fs::read_to_string(folder.join("rig/plateaus.csv")).unwrap();
    let short = folder.join("plateaus.csv");
    let is_kept = |line: &&str| {
        line.split(',').next().unwrap().parse::<usize>().map_or(true, |series| series % EVERY == 0)
    };
    std::fs::write(&short, text.lines().filter(is_kept).collect::<Vec<_>>().join("\n")).unwrap();
    short
}

#[test]
fn the_configurator_works_in_a_browser() {
    let Some(browser) = browser() else {
        return report_skipped("no chromium here; Debian's package is called chromium");
    };
    run_scenarios(&executable(browser).unwrap(), "");
}

#[test]
fn five_walks_end_well_in_firefox() {
    let Some(firefox) = ["firefox-esr", "firefox"].into_iter().find_map(executable) else {
        return report_skipped("no Firefox here; Debian's package is called firefox-esr");
    };
    if std::env::var_os("PINSWITCH_SITE").is_none() {
        return report_skipped("the walks need the published page: PINSWITCH_SITE is not set");
    }
    run_scenarios(&firefox, "walk");
}

/// Runs the scenarios in a browser whose names contain a word.
fn run_scenarios(browser: &Path, only: &str) {
    if !Command::new("node").arg("--version").output().is_ok_and(|output| output.status.success()) {
        return report_skipped("no node here; Debian's package is called nodejs");
    }
    if !["puppeteer-core", "axe-core"]
        .iter()
        .all(|name| Path::new(TOOLS).join("node_modules").join(name).is_dir())
    {
        return report_skipped(
            "puppeteer-core and axe-core are not in /tmp/pinswitch-browser; .ci/run installs them",
        );
    }
    let folder = tempfile::tempdir().unwrap();
    let job = serde_json::json!({
        "binary": env!("CARGO_BIN_EXE_pinswitch"),
        "browser": browser,
        "tools": TOOLS,
        "table": table(folder.path()),
        "pictures": repository("out/configurator"),
        "site": site(),
        "only": only,
    });
    let file = folder.path().join("job.json");
    std::fs::write(&file, job.to_string()).unwrap();
    let run = Command::new("node").arg(repository("tests/browser/run.mjs")).arg(&file).output().unwrap();
    let output = String::from_utf8_lossy(&run.stdout);
    println!("{output}{}", String::from_utf8_lossy(&run.stderr));
    assert!(run.status.success(), "checks of the configurator failed: {output}");
}

/// Returns the path of a program, since puppeteer does not search PATH.
fn executable(name: &str) -> Option<PathBuf> {
    let path = std::env::var_os("PATH").unwrap_or_default();
    std::env::split_paths(&path).map(|folder| folder.join(name)).find(|file| file.is_file())
}
