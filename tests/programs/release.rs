//! `cad/dist`: the Debian package and the archive of a substitute program, and the bill of materials
//! of the binary under test; linters of the recipes.

use std::collections::BTreeSet;
use std::io::Read;
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

use crate::harness::{binary, hashes, report_skipped, repository};

const TARGET: &str = "x86_64-unknown-linux-musl";

/// Runs a program in the repository and returns its standard output.
fn output(command: &mut Command) -> String {
    let output = command.current_dir(repository("")).output().unwrap();
    let message = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{command:?}: {message}");
    String::from_utf8(output.stdout).unwrap()
}

/// Reports a skipped test if one of the programs cannot be run.
fn lacks(programs: &[(&str, &[&str])]) -> bool {
    let runs = |program: &str, arguments: &[&str]| {
        Command::new(program).args(arguments).output().is_ok_and(|output| output.status.success())
    };
    let missing = programs.iter().find(|(program, arguments)| !runs(program, arguments));
    if let Some((program, arguments)) = missing {
        report_skipped(&format!("`{program} {}` does not run", arguments.join(" ")));
    }
    missing.is_some()
}

const PYTHON: (&str, &[&str]) = ("python3", &["-c", "import tomllib"]);

/// Returns the crates of a bill of materials, `NAME-VERSION`.
fn names(document: &Value) -> BTreeSet<String> {
    let program = &document["metadata"]["component"];
    assert_eq!(program["name"], "pinswitch");
    let components = document["components"].as_array().unwrap().iter();
    let mut names: BTreeSet<_> = components
        .map(|c| format!("{}-{}", c["name"].as_str().unwrap(), c["version"].as_str().unwrap()))
        .collect();
    names.insert(format!("pinswitch-cli-{}", program["version"].as_str().unwrap()));
    names
}

/// Returns the folders of registry crates that the binary under test names in its messages.
fn crates_in_binary() -> BTreeSet<String> {
    let bytes = std::fs::read(binary().get_program()).unwrap();
    let text = String::from_utf8_lossy(&bytes);
    let paths = text.split("/registry/src/").skip(1).filter_map(|rest| rest.split('/').nth(1));
    paths.filter(|name| name.len() < 64).map(str::to_owned).collect()
}

#[test]
fn sbom_names_every_crate() {
    if lacks(&[PYTHON]) {
        return;
    }
    let text = output(Command::new(repository("cad/dependencies.py")).args([TARGET, "sbom"]));
    let document: Value = serde_json::from_str(&text).unwrap();

    let packed = include_bytes!("../data/cyclonedx/bom-1.5.json.gz");
    let mut schema = String::new();
    flate2::read::GzDecoder::new(&packed[..]).read_to_string(&mut schema).unwrap();
    let validator = jsonschema::validator_for(&serde_json::from_str(&schema).unwrap()).unwrap();
    let errors: Vec<_> = validator.iter_errors(&document).map(|e| e.to_string()).collect();
    assert!(errors.is_empty(), "{errors:?}");
    let misspelt: Value = serde_json::from_str(&text.replace("\"purl\"", "\"pirl\"")).unwrap();
    assert!(!validator.is_valid(&misspelt));

    // As cargo lists them, and as the binary shows them.
    let names = names(&document);
    let edges = ["-e", "normal,build", "--prefix", "none", "-f", "{p}"];
    let options = ["tree", "--locked", "-p", "pinswitch-cli", "--features", "cloud", "--target", TARGET];
    let tree = output(Command::new(env!("CARGO")).args(options).args(edges));
    let words = tree.lines().map(|line| line.split_whitespace().collect::<Vec<_>>());
    let listed: BTreeSet<_> =
        words.filter(|w| w.len() > 1).map(|w| format!("{}-{}", w[0], &w[1][1..])).collect();
    assert_eq!(names, listed);
    let compiled = crates_in_binary();
    assert!(compiled.len() > 30, "{compiled:?}");
    assert!(compiled.is_subset(&names), "{:?}", compiled.difference(&names).collect::<Vec<_>>());

    // With the checksums of Cargo.lock.
    let lock: toml_edit::DocumentMut =
        std::fs::read_to_string(repository("Cargo.lock")).unwrap().parse().unwrap();
    let packages = lock["package"].as_array_of_tables().unwrap();
    for component in document["components"].as_array().unwrap() {
        let package = packages
            .iter()
            .find(|p| {
                p["name"].as_str() == component["name"].as_str()
                    && p["version"].as_str() == component["version"].as_str()
            })
            .unwrap();
        let checksum = package.get("checksum").and_then(|sum| sum.as_str());
        assert_eq!(component["hashes"][0]["content"].as_str(), checksum, "{component}");
    }
}

/// Writes a shell script that can be run.
fn script(path: PathBuf, text: &str) -> PathBuf {
    std::fs::write(&path, format!("#!/bin/sh\n{text}\n")).unwrap();
    std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o755)).unwrap();
    path
}

/// Makes the archive and the package of a script that runs the binary under test: the binary itself
/// takes a minute to pack.
fn packed(folder: &Path, dist: &str) -> PathBuf {
    let text = format!("exec '{}' \"$@\"", env!("CARGO_BIN_EXE_pinswitch"));
    let program = script(folder.join("pinswitch"), &text);
    let dist = folder.join(dist);
    let mut command = Command::new(repository("cad/dist"));
    command.arg(&dist).args(["binary", "deb"]).env("PINSWITCH", &program);
    output(command.env("SOURCE_DATE_EPOCH", "1767225600"));
    dist
}

#[test]
fn packages_contain_program_and_documents() {
    if lacks(&[PYTHON, ("dpkg-deb", &["--version"]), ("bash", &["--version"]), ("tar", &["--version"])]) {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let dist = packed(folder.path(), "first");
    let version = env!("CARGO_PKG_VERSION");
    let package = dist.join(format!("pinswitch_{version}_amd64.deb"));
    let field =
        |name| output(Command::new("dpkg-deb").arg("--field").arg(&package).arg(name)).trim().to_owned();
    assert_eq!(field("Version"), version);
    assert_eq!((field("Package"), field("Architecture")), ("pinswitch".into(), "amd64".into()));
    assert_eq!(field("Depends"), "");

    let root = folder.path().join("root");
    output(Command::new("dpkg-deb").arg("--extract").arg(&package).arg(&root));
    let name = format!("pinswitch-{version}-x86_64-linux");
    let archive = dist.join(format!("{name}.tar.gz"));
    output(Command::new("tar").arg("--extract").arg("--file").arg(&archive).arg("--directory").arg(&root));
    for program in [root.join("usr/bin/pinswitch"), root.join(&name).join("pinswitch")] {
        assert_eq!(output(Command::new(program).arg("--version")), format!("pinswitch {version}\n"));
    }
    let share = root.join("usr/share");
    for page in crate::harness::files(&root.join(&name).join("man")).into_keys() {
        assert!(share.join(format!("man/man1/{page}.gz")).exists(), "{page}");
    }
    for (installed, file) in [
        ("bash-completion/completions/pinswitch", "pinswitch.bash"),
        ("fish/vendor_completions.d/pinswitch.fish", "pinswitch.fish"),
        ("zsh/vendor-completions/_pinswitch", "pinswitch.zsh"),
    ] {
        let script = std::fs::read(share.join(installed)).unwrap();
        assert_eq!(script, std::fs::read(root.join(&name).join("completions").join(file)).unwrap());
    }
    let copyright = std::fs::read_to_string(share.join("doc/pinswitch/copyright")).unwrap();
    assert!(copyright.contains("Permission is hereby granted"), "{copyright}");
    let licences = std::fs::read_to_string(root.join(&name).join("LICENCES-OF-DEPENDENCIES")).unwrap();
    assert!(licences.contains("\nserde 1") && licences.contains("\nrustls 0"));

    // The sums are those of the files, and a second run makes the same files.
    let mut made = hashes(&dist);
    let sums = std::fs::read_to_string(dist.join("SHA256SUMS")).unwrap();
    assert_eq!(made, hashes(&packed(folder.path(), "second")));
    made.remove("SHA256SUMS");
    let expected: String = made.iter().map(|(name, sum)| format!("{sum}  {name}\n")).collect();
    assert_eq!(sums, expected);
}

/// A substitute for docker prints its arguments, and the files of the folder that it is given.
#[test]
fn image_has_name_of_recipe() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    script(
        path.join("docker"),
        "echo \"docker $*\"; for folder; do :; done; [ ! -d \"$folder\" ] || ls \"$folder\"",
    );
    let search = format!("{}:{}", path.display(), std::env::var("PATH").unwrap());
    let mut command = Command::new(repository("cad/dist"));
    command.arg(path.join("dist")).arg("image").env("PATH", search);
    let message = output(command.env("PINSWITCH", path.join("docker")));
    let recipe = std::fs::read_to_string(repository("templates/batch/kubernetes-job.yaml")).unwrap();
    let name = recipe.lines().find_map(|line| line.trim().strip_prefix("image: ")).unwrap();
    assert!(message.contains(&format!("docker build --tag {name} --file ")), "{message}");
    assert!(message.contains("\nDockerfile\npinswitch\n"), "{message}");
}

/// What `.ci/install` installs: linters of Dockerfiles and shell scripts, and the schema of Actions.
#[test]
fn linters_accept_recipes() {
    let linters = Path::new("/tmp/pinswitch-linters/bin");
    let checks: [(&str, &[&str]); 3] = [
        ("hadolint", &["cad/Dockerfile"]),
        ("shellcheck", &["--severity=warning", "cad/dist"]),
        ("check-jsonschema", &["--builtin-schema", "vendor.github-actions", "action.yml"]),
    ];
    for (program, arguments) in checks {
        let program = linters.join(program);
        if lacks(&[(program.to_str().unwrap(), &["--version"])]) {
            return;
        }
        output(Command::new(program).args(arguments));
    }
}

#[test]
fn unknown_part_is_refused() {
    let output =
        Command::new(repository("cad/dist")).args(["/nonexistent", "binary", "debian"]).output().unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("debian is not a part"));
}
