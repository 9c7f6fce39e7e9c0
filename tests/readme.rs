//! Everything that README shows is what the program does.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::path::Path;
use std::process::Command;

/// A command and the lines that README shows under it; `...` stands for any further lines.
struct Shown {
    command: String,
    output: Vec<String>,
}

fn shown(readme: &str) -> Vec<Shown> {
    let mut all: Vec<Shown> = Vec::new();
    let mut inside = false;
    for line in readme.lines() {
        match (inside, line) {
            (_, "```console") => inside = true,
            (_, "```") => inside = false,
            (true, line) => match line.strip_prefix("$ pinswitch ") {
                Some(command) => all.push(Shown { command: command.to_owned(), output: Vec::new() }),
                None => all.last_mut().expect("a command stands first").output.push(line.to_owned()),
            },
            (false, _) => {}
        }
    }
    all
}

#[test]
fn commands_print_what_readme_shows() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let readme = std::fs::read_to_string(root.join("README.md")).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let shown = shown(&readme);
    assert!(shown.len() >= 5, "README shows {} commands", shown.len());
    for Shown { command, output } in shown {
        let run = Command::new(env!("CARGO_BIN_EXE_pinswitch"))
            .args(command.split_whitespace())
            .current_dir(folder.path())
            .output()
            .unwrap();
        let printed = String::from_utf8([run.stderr, run.stdout].concat()).unwrap();
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

#[test]
fn files_that_readme_names_are_there() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let readme = std::fs::read_to_string(root.join("README.md")).unwrap();
    let links = readme.split("](").skip(1).filter_map(|rest| rest.split(')').next());
    for link in links {
        assert!(root.join(link).exists(), "{link}");
    }
    let first = "cargo run --release -- generate templates/three-double.toml";
    assert!(readme.contains(first) && root.join("templates/three-double.toml").exists());
}
