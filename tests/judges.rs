//! Programs that nobody here wrote judge our parts, and our oracle judges meshes that nobody here made. The judges lie
//! in `../shared/tools`; where they are absent, or not installed, the tests say so and pass.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::path::{Path, PathBuf};
use std::process::Command;

fn tool(name: &str) -> Option<PathBuf> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/tools").join(name);
    if path.exists() {
        return Some(path);
    }
    println!("skipped: {} is not here", path.display());
    None
}

fn pinswitch(arguments: &[&str], folder: &Path) -> Option<i32> {
    let output =
        Command::new(env!("CARGO_BIN_EXE_pinswitch")).args(arguments).current_dir(folder).output().unwrap();
    output.status.code()
}

#[test]
fn slicers_and_mesh_checkers_accept_the_three_layouts() {
    let Some(judge) = tool("judge_mesh.py") else { return };
    let installed = Command::new("prusa-slicer").arg("--help").output().is_ok_and(|o| o.status.success());
    if !installed {
        println!(
            "skipped: prusa-slicer is not installed; ../shared/tools/setup_judges.sh installs the judges"
        );
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    // Parts but for the supports and their labels are equal between the layouts: the others add those that differ.
    for (layout, parts) in [
        (
            "three-double",
            &[
                "shell",
                "mould-core",
                "mould-ring",
                "mould-lid",
                "support-left",
                "support-right",
                "proxy",
                "coupon",
            ][..],
        ),
        ("six-single", &["shell", "support-left"][..]),
        ("three-single", &["shell", "support-right"][..]),
    ] {
        assert_eq!(pinswitch(&["-q", "generate", layout, "--out", layout], folder.path()), Some(0));
        let files: Vec<_> = parts.iter().map(|p| folder.path().join(format!("{layout}/{p}.stl"))).collect();
        let output = Command::new("python3")
            .arg(&judge)
            .args(&files)
            .args(["--only", "admesh,prusa_info,prusa_slice,trimesh,manifold3d,pymeshlab"])
            .args(["--require", "prusa_info,prusa_slice"])
            .output()
            .unwrap();
        assert!(output.status.success(), "{layout}: {}", String::from_utf8_lossy(&output.stdout));
    }
}

#[test]
fn our_oracle_finds_every_defect_of_the_test_meshes() {
    let Some(maker) = tool("make_test_meshes.py") else { return };
    let folder = tempfile::tempdir().unwrap();
    let venv = Path::new("/tmp/judges-venv/bin/python");
    if !venv.exists() {
        println!("skipped: the test meshes need {}", venv.display());
        return;
    }
    let made = Command::new(venv).arg(&maker).arg(folder.path()).output().unwrap();
    assert!(made.status.success(), "{}", String::from_utf8_lossy(&made.stderr));
    let expected: serde_json::Value =
        serde_json::from_slice(&std::fs::read(folder.path().join("expected.json")).unwrap()).unwrap();
    let mut judged = 0;
    for (name, entry) in expected.as_object().unwrap().iter().filter(|(name, _)| name.ends_with(".stl")) {
        let good = entry["good"].as_bool().unwrap();
        let code = pinswitch(&["check", name], folder.path());
        assert_eq!(code == Some(0), good, "{name}: {}, exit code {code:?}", entry["defect"]);
        judged += 1;
    }
    assert!(judged >= 20, "only {judged} meshes");
}
