//! Runs every block of README, of cad/doc/tutorial.md and of model/doc/any-rig.md, in order and in
//! one folder, and compares its output.

use std::path::Path;

use crate::harness::{binary, repository};

/// A command of a document and the output below it; a last line `...` matches any further lines.
struct Shown {
    command: String,
    output: Option<Vec<String>>,
}

/// Returns the commands of all `sh` and `console` blocks, in order.
fn commands(readme: &str) -> Vec<Shown> {
    let mut all: Vec<Shown> = Vec::new();
    let mut block = "";
    for line in readme.lines() {
        match (block, line.trim_end()) {
            ("", fence) => block = fence.strip_prefix("```").unwrap_or_default(),
            (_, "```") => block = "",
            ("sh", command) => all.push(Shown { command: command.to_owned(), output: None }),
            ("console", line) => match line.strip_prefix("$ ") {
                Some(command) => {
                    all.push(Shown { command: command.to_owned(), output: Some(Vec::new()) });
                }
                None => {
                    let shown = all.last_mut().and_then(|s| s.output.as_mut());
                    shown.expect("a block starts with a command").push(line.to_owned());
                }
            },
            _ => {}
        }
    }
    all
}

/// Runs a command in a folder and returns its output. Returns `None` for the test command, which
/// runs this test.
fn run(folder: &Path, slicer: Option<&Path>, command: &str) -> Option<String> {
    let command = command.split(" #").next().unwrap_or(command).trim();
    if command.starts_with("cargo test") {
        let ci = std::fs::read_to_string(repository(".ci/run")).unwrap();
        assert!(ci.contains("'^cargo test'"), "CI takes its test command from README");
        return None;
    }
    let arguments = command.strip_prefix("cargo run -- ").or(command.strip_prefix("pinswitch "));
    let arguments = arguments.unwrap_or_else(|| panic!("{command:?} is not a pinswitch command"));
    let mut program = binary();
    program.args(arguments.split_whitespace()).current_dir(folder);
    if let Some(slicer) = slicer {
        program.env("PINSWITCH_SLICER", slicer);
    }
    let run = program.output().unwrap();
    Some(String::from_utf8([run.stderr, run.stdout].concat()).unwrap())
}

#[test]
fn readme_blocks_match_their_output() {
    follow("README.md", 15, None);
}

#[test]
fn rigs_of_the_document_have_their_friction_coefficients() {
    follow("model/doc/any-rig.md", 9, None);
}

/// Uses a substitute slicer, for speed. The tutorial shows the table of the real one as text, which
/// is not compared.
#[cfg(unix)]
#[test]
fn tutorial_blocks_match_their_output() {
    let folder = tempfile::tempdir().unwrap();
    follow("cad/doc/tutorial.md", 6, Some(&crate::slicing::substitute_slicer(folder.path())));
}

/// Runs all commands of a document, at least `least`, and compares their output with the output
/// that it shows.
fn follow(document: &str, least: usize, slicer: Option<&Path>) {
    let readme = std::fs::read_to_string(repository(document)).unwrap();
    let folder = tempfile::tempdir().unwrap();
    // The templates of the repository, as in a clone.
    std::fs::create_dir(folder.path().join("templates")).unwrap();
    for entry in std::fs::read_dir(repository("templates")).unwrap().map(Result::unwrap) {
        if entry.path().is_file() {
            std::fs::copy(entry.path(), folder.path().join("templates").join(entry.file_name())).unwrap();
        }
    }
    for entry in std::fs::read_dir(repository("model/doc/examples")).unwrap().map(Result::unwrap) {
        std::fs::copy(entry.path(), folder.path().join(entry.file_name())).unwrap();
    }
    let shown = commands(&readme);
    assert!(shown.len() >= least, "{document} shows {} commands", shown.len());
    for Shown { command, output } in shown {
        let Some(printed) = run(folder.path(), slicer, &command) else { continue };
        let Some(output) = output else {
            assert!(!printed.contains("error"), "{command}: {printed}");
            continue;
        };
        let printed: Vec<_> = printed.lines().map(str::trim_end).collect();
        let (expected, whole) = match output.split_last() {
            Some((last, before)) if last == "..." => (before, false),
            _ => (&output[..], true),
        };
        let expected: Vec<_> = expected.iter().map(|l| l.trim_end()).collect();
        assert!(printed.len() >= expected.len(), "{command}: {printed:#?}");
        assert_eq!(printed[..expected.len()], expected[..], "{command}");
        assert!(!whole || printed.len() == expected.len(), "{command}: {printed:#?}");
    }
}
