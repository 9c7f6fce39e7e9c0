//! The files that a release is made from agree with each other, and the shell step of the GitHub Action runs.

use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;

use crate::harness::repository;

fn text(path: &str) -> String {
    std::fs::read_to_string(repository(path)).unwrap()
}

fn yaml(path: &str) -> Value {
    serde_saphyr::from_str(&text(path)).unwrap()
}

#[test]
fn image_names_and_versions_agree() {
    let job = yaml("templates/batch/kubernetes-job.yaml");
    let container = &job["spec"]["template"]["spec"]["containers"][0];
    let image = container["image"].as_str().unwrap();
    let (_, version) = image.rsplit_once(':').unwrap();
    assert_eq!(version, env!("CARGO_PKG_VERSION"));
    let dockerfile = text("cad/Dockerfile");
    let names: Vec<_> = dockerfile.split_whitespace().filter(|w| w.contains("/pinswitch:")).collect();
    assert!(names.len() > 1 && names.iter().all(|name| name.trim_end_matches(',') == image), "{names:?}");
    assert!(text("action.yml").contains(&format!("pinswitch@v{version}\n")));
    assert_eq!(yaml("CITATION.cff")["version"], version);
    let python: toml_edit::DocumentMut = text("cad/python/Cargo.toml").parse().unwrap();
    assert_eq!(python["package"]["version"].as_str(), Some(version));
}

/// The Job's command is one of a shell, and its pods are not run by the administrator.
#[test]
fn dockerfile_suits_the_job() {
    let dockerfile = text("cad/Dockerfile");
    let instructions: Vec<_> = dockerfile
        .lines()
        .filter(|line| !line.is_empty() && !line.starts_with('#'))
        .map(|line| line.split_once(' ').unwrap())
        .collect();
    let value = |name: &str| instructions.iter().find(|(key, _)| *key == name).unwrap().1;
    let (_, tag) = value("FROM").split_once(':').expect("the base image has a tag");
    assert!(tag != "latest" && value("FROM").starts_with("alpine:"), "{instructions:?}");
    assert_eq!(value("COPY"), "--chmod=755 pinswitch /usr/local/bin/pinswitch");
    assert!(!value("USER").starts_with('0') && value("USER") != "root");
    let entry: Vec<String> = serde_json::from_str(value("ENTRYPOINT")).unwrap();
    assert_eq!(entry, ["pinswitch"]);
}

/// Runs the step of the Action that makes the files, as a runner does.
fn run_action(folder: &Path, configurations: &str, options: &str) -> (Output, String) {
    let action = yaml("action.yml");
    let inputs = action["inputs"].as_object().unwrap();
    let steps = action["runs"]["steps"].as_array().unwrap();
    let step = steps.iter().find(|step| step["name"] == "Make parts and curves").unwrap();
    assert_eq!(step["shell"], "bash");
    let script = folder.join("step.sh");
    std::fs::write(&script, step["run"].as_str().unwrap()).unwrap();
    let summary = folder.join("summary");
    let mut command = Command::new("bash");
    command.args(["--noprofile", "--norc", "-eo", "pipefail"]).arg(&script).current_dir(folder);
    command.env("GITHUB_STEP_SUMMARY", &summary);
    for (variable, expression) in step["env"].as_object().unwrap() {
        let expression = expression.as_str().unwrap();
        let input = expression.strip_prefix("${{ inputs.").and_then(|e| e.split([' ', '}']).next()).unwrap();
        let value = match input {
            "configurations" => configurations,
            "options" => options,
            "program" => env!("CARGO_BIN_EXE_pinswitch"),
            _ => inputs[input]["default"].as_str().unwrap(),
        };
        command.env(variable, value);
    }
    let output = command.output().unwrap();
    (output, std::fs::read_to_string(summary).unwrap_or_default())
}

#[test]
fn action_makes_sets_and_curves() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    std::fs::create_dir_all(path.join("switches/arm")).unwrap();
    for name in ["three-double", "six-single"] {
        let switches = path.join("switches");
        std::fs::copy(repository(&format!("templates/{name}.toml")), switches.join(format!("{name}.toml")))
            .unwrap();
    }
    let options = "--format stl --set friction.points=3";
    let (output, summary) = run_action(path, "switches/**/*.toml", options);
    let message = String::from_utf8([output.stdout, output.stderr].concat()).unwrap();
    assert!(output.status.success(), "{message}");
    for name in ["switches-three-double", "switches-six-single"] {
        assert!(path.join(format!("pinswitch/sets/{name}/shell.stl")).exists(), "{message}");
        let curve = std::fs::read_to_string(path.join(format!("pinswitch/curves/{name}.csv"))).unwrap();
        assert_eq!(curve.lines().filter(|line| line.starts_with(|c: char| c.is_ascii_digit())).count(), 3);
    }
    assert!(summary.contains("| switches/six-single.toml | 8 parts"), "{summary}");
}

/// The others are made, and the message is on one line.
#[test]
fn action_reports_refused_configurations() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    std::fs::write(path.join("a.toml"), "[segment]\ngrooves = 60\n").unwrap();
    std::fs::write(path.join("b.toml"), "[friction]\npoints = 3\n").unwrap();
    let (output, summary) = run_action(path, "a.toml\nb.toml", "--format stl");
    assert_eq!(output.status.code(), Some(1));
    let message = String::from_utf8(output.stdout).unwrap();
    let error = message.lines().find(|line| line.starts_with("::error file=a.toml::")).unwrap();
    assert!(error.contains("segment.grooves = 60") && error.contains("%0A  help: "), "{error}");
    assert!(path.join("pinswitch/curves/b.csv").exists());
    assert!(summary.contains("| a.toml | refused |"), "{summary}");
    let (output, _) = run_action(path, "none/*.toml", "");
    assert_eq!(output.status.code(), Some(1));
}

/// Expressions in a script would make the text of an input a part of it.
#[test]
fn action_keeps_inputs_out_of_scripts() {
    let action = yaml("action.yml");
    assert_eq!(action["runs"]["using"], "composite");
    for step in action["runs"]["steps"].as_array().unwrap() {
        assert!(step["run"].is_string() != step["uses"].is_string(), "{step}");
        assert!(!step["run"].as_str().unwrap_or_default().contains("${{"), "{step}");
    }
}
