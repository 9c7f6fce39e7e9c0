//! `cad/book/build`: the book shows every template with the numbers of its set, and is complete
//! without the network; links that lead nowhere and documents outside the navigation end the build.
//!
//! The tests need git, and Sphinx in `/tmp/pinswitch-book`, where `.ci/install` installs it.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::Value;

use crate::harness::{pinswitch, report_skipped, repository};

const PYTHON: &str = "/tmp/pinswitch-book/bin/python";

/// Builds the book of a checkout, or reports that the test is skipped.
fn build(checkout: &Path, site: &Path) -> Option<Output> {
    let has_theme = Command::new(PYTHON).args(["-c", "import sphinx, furo"]).output();
    if !has_theme.is_ok_and(|output| output.status.success()) {
        report_skipped("no Sphinx in /tmp/pinswitch-book; .ci/install installs it");
        return None;
    }
    let mut command = Command::new(PYTHON);
    command.arg(checkout.join("cad/book/build")).arg(site);
    Some(command.env("PINSWITCH", env!("CARGO_BIN_EXE_pinswitch")).output().unwrap())
}

fn git(folder: &Path, arguments: &[&str]) -> String {
    let output = Command::new("git").args(arguments).current_dir(folder).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

/// Copies the files of the repository into a new one.
fn checkout(folder: &Path) {
    for file in git(&repository(""), &["ls-files", "-z"]).split_terminator('\0') {
        let copied = folder.join(file);
        std::fs::create_dir_all(copied.parent().unwrap()).unwrap();
        std::fs::copy(repository(file), copied).unwrap();
    }
    git(folder, &["init", "--quiet"]);
}

fn read_json(text: &[u8]) -> Value {
    serde_json::from_slice(text).unwrap()
}

/// Collects the HTML pages of a folder.
fn pages(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            pages(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "html") {
            found.push(path);
        }
    }
}

#[test]
fn book_shows_every_template() {
    let folder = tempfile::tempdir().unwrap();
    let site = folder.path().join("book");
    let Some(output) = build(&repository(""), &site) else { return };
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));

    let gallery = std::fs::read_to_string(site.join("templates.html")).unwrap();
    let listed = read_json(&pinswitch(folder.path(), &["layouts", "--json"]).stdout);
    for template in listed["conditions"].as_array().unwrap() {
        let name = template["name"].as_str().unwrap();
        for picture in [format!("{name}-assembly.png"), format!("{name}-friction.svg")] {
            assert!(gallery.contains(&picture) && site.join("_images").join(&picture).exists(), "{picture}");
        }
    }
    pinswitch(folder.path(), &["generate", "three-double", "--format", "page", "--out", "set"]);
    let manifest = read_json(&std::fs::read(folder.path().join("set/manifest.json")).unwrap());
    for (field, digits) in [("threshold_n", 1), ("friction_n", 2)] {
        let number = manifest["friction"][field].as_f64().unwrap();
        assert!(gallery.contains(&format!("<p>{number:.digits$}</p>")), "{field} {number}");
    }

    // A document of each folder, and a file that is linked only.
    for page in ["index", "cad/doc/batch", "model/doc/glossary", "source/cad/examples/sweep.rs"] {
        assert!(site.join(format!("{page}.html")).exists(), "{page}");
    }
    let mut found = Vec::new();
    pages(&site, &mut found);
    for page in &found {
        let text = std::fs::read_to_string(page).unwrap();
        let tags = text.split('<').filter(|t| ["script", "link", "img"].iter().any(|n| t.starts_with(n)));
        for tag in tags.filter_map(|tag| tag.split('>').next()) {
            assert!(!tag.contains("\"http") && !tag.contains("\"//"), "{}: <{tag}>", page.display());
        }
    }
}

#[test]
fn broken_links_end_the_build() {
    let folder = tempfile::tempdir().unwrap();
    let copied = folder.path().join("checkout");
    checkout(&copied);
    let append = |file: &str, text: &str| {
        let path = copied.join(file);
        let old = std::fs::read_to_string(&path).unwrap_or_default();
        std::fs::write(path, format!("{old}\n{text}\n")).unwrap();
    };
    append("README.md", "[a file](cad/cli/src/no-such-file.rs)");
    append("cad/doc/rig.md", "[a heading](#no-such-heading)");
    append("cad/doc/design.md", "[a heading of another document](../../cad/doc/batch.md#no-such-place)");
    append("model/doc/physics.md", "![a picture](no-such-picture.svg)");
    append(&format!("cad/doc/unlisted.{}", "md"), "# A document outside the navigation");
    git(&copied, &["add", "--all"]);

    let site = folder.path().join("book");
    let Some(output) = build(&copied, &site) else { return };
    let message = String::from_utf8(output.stderr).unwrap();
    assert!(!output.status.success() && !site.exists(), "{message}");
    let warnings: Vec<_> = message.lines().filter(|line| line.contains("WARNING")).collect();
    let expected = ["no-such-file.rs", "no-such-heading", "no-such-place", "no-such-picture.svg", "unlisted"];
    for fault in expected {
        assert!(warnings.iter().any(|line| line.contains(fault)), "{fault}: {message}");
    }
    assert_eq!(warnings.len(), expected.len(), "{message}");
}
