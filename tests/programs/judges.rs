//! External programs judge our parts, and `check` judges external meshes. The judges are in
//! `../shared/tools`; where they are absent or not installed, the tests print `SKIPPED` and pass.

use std::path::Path;
use std::process::Command;

use serde_json::Value;

use crate::harness::{done, ended, files, report_skipped, shared_file};

/// Exit code of the judges if none of the requested ones is installed.
pub(crate) const NONE_COULD_RUN: i32 = 3;

/// The Python that `../shared/tools/setup_judges.sh` installs the judges into.
pub(crate) fn judges_python() -> Option<&'static Path> {
    let python = Path::new("/tmp/judges-venv/bin/python");
    if !python.exists() {
        report_skipped(&format!(
            "{} is not here; ../shared/tools/setup_judges.sh makes it",
            python.display()
        ));
    }
    python.exists().then_some(python)
}

/// Returns whether the only failed check is that bodies touch, as those of an assembly do: the
/// analyser of boolean arguments counts that as self-interference. The file must still be readable
/// and valid, with closed shells. Bodies may overlap by `pierced_mm3`: a screw passes through the
/// membrane that closes its hole in the printed part, and that is cut open.
pub(crate) fn only_touches(output: &str, pierced_mm3: f64) -> bool {
    output.lines().filter(|l| l.contains(" FAIL ")).all(|line| {
        let mut parts = line.trim_end().split("; ");
        parts.next().is_some_and(|first| first.ends_with("(self-interference or small edges)"))
            && parts.all(|overlap| {
                let volume = overlap.rsplit_once(" by ").and_then(|(_, v)| v.strip_suffix(" mm3"));
                let volume = volume.and_then(|volume| volume.parse::<f64>().ok());
                volume.is_some_and(|volume| (volume - pierced_mm3).abs() < 0.01)
            })
    })
}

/// Volume of an M3 shank within a membrane of 0.4 mm.
const PIERCED_MM3: f64 = std::f64::consts::PI * 1.5 * 1.5 * 0.4;

#[test]
fn mesh_judges_accept_the_three_layouts() {
    let Some(judge) = shared_file("tools/judge_mesh.py") else { return };
    let installed = Command::new("prusa-slicer").arg("--help").output().is_ok_and(|o| o.status.success());
    if !installed {
        report_skipped("prusa-slicer is not installed; ../shared/tools/setup_judges.sh installs the judges");
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    // Except for supports and labels, parts are equal between the layouts: the others add those
    // that differ.
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
        done(folder.path(), &["-q", "generate", layout, "--out", layout]);
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
fn check_finds_every_defect() {
    let Some(maker) = shared_file("tools/make_test_meshes.py") else { return };
    let folder = tempfile::tempdir().unwrap();
    let Some(venv) = judges_python() else { return };
    let made = Command::new(venv).arg(&maker).arg(folder.path()).output().unwrap();
    assert!(made.status.success(), "{}", String::from_utf8_lossy(&made.stderr));
    let expected: serde_json::Value =
        serde_json::from_slice(&std::fs::read(folder.path().join("expected.json")).unwrap()).unwrap();
    let mut judged = 0;
    for (name, entry) in expected.as_object().unwrap().iter().filter(|(name, _)| name.ends_with(".stl")) {
        let good = entry["good"].as_bool().unwrap();
        // Some of the defects print all the same: they are warnings.
        let code = ended(folder.path(), &["check", "--strict", name]).0;
        assert_eq!(code == Some(0), good, "{name}: {}, exit code {code:?}", entry["defect"]);
        judged += 1;
    }
    assert!(judged >= 20, "only {judged} meshes");
}

/// Slicers, lib3mf's strict reader and OCCT judge the three layouts, where they are installed.
#[test]
fn foreign_readers_accept_the_layouts() {
    let Some(judge) = shared_file("tools/judge_mesh.py") else { return };
    let Some(python) = judges_python() else { return };
    for layout in ["six-single", "three-double", "three-single"] {
        let folder = tempfile::tempdir().unwrap();
        let files = {
            done(folder.path(), &["generate", layout, "--format", "3mf,step", "--out", "set"]);
            files(&folder.path().join("set"))
        };
        let manifest: Value = serde_json::from_slice(&files["manifest.json"]).unwrap();
        let ask = |file: &str, extra: &[&str]| {
            let output = Command::new(python)
                .arg(&judge)
                .arg(folder.path().join("set").join(file))
                .args(extra)
                .output()
                .unwrap();
            (output.status.code(), String::from_utf8_lossy(&output.stdout).into_owned())
        };
        let judged = |file: &str, extra: &[&str]| {
            let (code, message) = ask(file, extra);
            if code == Some(NONE_COULD_RUN) {
                report_skipped(&format!("{layout}: {file}: no judge of {} is installed", extra[1]));
            } else {
                assert_eq!(code, Some(0), "{layout}: {file}: {message}");
            }
        };
        // pymeshlab is omitted, since it reads only the last object of a package.
        judged("assembly.3mf", &["--only", "prusa_info,prusa_slice,lib3mf,opc3mf,manifold3d"]);
        for part in manifest["parts"].as_array().unwrap() {
            let file = part["file"].as_str().unwrap().replace(".stl", ".step");
            let volume = part["volume_mm3"].to_string();
            judged(&file, &["--only", "ocp", "--volume", &volume, "--rtol", "1e-9"]);
        }
        let (_, message) = ask("assembly.step", &["--only", "ocp"]);
        assert!(only_touches(&message, PIERCED_MM3), "{layout}: {message}");
    }
}

/// The installed slicer slices every plate without rearranging it; its filament matches the masses
/// of the set, up to rounding of walls and infill.
#[test]
fn the_slicer_reports_time_and_filament() {
    let path = std::env::var_os("PATH").unwrap_or_default();
    if !std::env::split_paths(&path).any(|folder| folder.join("prusa-slicer").is_file()) {
        return report_skipped("prusa-slicer is not installed");
    }
    let folder = tempfile::tempdir().unwrap();
    let output = done(
        folder.path(),
        &[
            "generate",
            "three-single",
            "--set",
            "print.bed_mm=80",
            "--set",
            "parts.coupon=false",
            "--slice",
            "--out",
            "set",
        ],
    );
    let set = files(&folder.path().join("set"));
    let read = |name: &str| -> Value { serde_json::from_slice(&set[name]).unwrap() };
    let (slicing, manifest) = (read("slicing.json"), read("manifest.json"));
    assert!(slicing["slicer"].as_str().unwrap().starts_with("PrusaSlicer "), "{output}");
    let list = |value: &Value| value.as_array().unwrap().clone();
    let grams = |entry: &Value| entry["filament_g"].as_f64().unwrap();
    for (sliced, part) in list(&slicing["parts"]).iter().zip(list(&manifest["parts"])) {
        assert_eq!(sliced["file"], part["file"]);
        let share = grams(sliced) / part["mass_g"].as_f64().unwrap();
        // The slicer adds a skirt.
        assert!((0.9..1.6).contains(&share), "{sliced} of {} g", part["mass_g"]);
        assert!(sliced["print_minutes"].as_f64().unwrap() > 1.0);
    }
    assert_eq!(slicing["plates"].as_array().unwrap().len(), manifest["plates"].as_array().unwrap().len());
    let together: f64 = list(&slicing["plates"]).iter().map(grams).sum();
    let alone: f64 = list(&slicing["parts"]).iter().map(grams).sum();
    assert!(together <= alone + 0.1, "{together} g on plates, {alone} g alone");
}
