//! Programs that nobody here wrote judge every file of the corpus of hardware: nut traps, screws, inserts, dowels, mounts, gang moulds.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

use crate::harness::{beside_repository, done, files, repository, say_skipped};
use crate::judges::{NONE_COULD_RUN, judges_python, only_touches};

const OF_MESHES: &str =
    "admesh,prusa_info,prusa_slice,slic3r,cura,trimesh,manifold3d,pymeshlab,assimp,libigl";
const OF_PACKAGES: &str = "prusa_info,prusa_slice,lib3mf,opc3mf,manifold3d";

/// Walls that a chamfer or a draft twists are ruled surfaces in STEP, and their volume is right to 4e-6 of itself; all else is exact.
const SHARE_OF_VOLUME: &str = "1e-5";

/// PrusaSlicer lays 94.8 to 95.1 % of the volume of these tall thin arches, the judge asks for 95 %: their walls of 0.64 mm, which the
/// program warns of, leave gaps between two lines. Everything else that a judge refuses of them is an error.
const LEAST_FILAMENT_OF_PROXIES: f64 = 0.945;

#[test]
#[ignore = "an hour: every file of 37 sets with hardware, each judged by up to ten programs"]
fn judges_accept_hardware_corpus() {
    let Some(judge) = beside_repository("tools/judge_mesh.py") else { return };
    let Some(python) = judges_python() else { return };
    let folder = tempfile::tempdir().unwrap();
    let mut asked = BTreeSet::new();
    let mut wrong = Vec::new();
    let mut judged = 0;
    let mut ask = |path: &Path, extra: &[&str]| {
        let output = Command::new(python).arg(&judge).arg(path).args(extra).output().unwrap();
        let said = String::from_utf8_lossy(&output.stdout).into_owned();
        let name = path.strip_prefix(folder.path()).unwrap().display().to_string();
        let touching =
            ["assembly.step", "mould.step"].iter().any(|n| name.ends_with(n)) && only_touches(&said);
        let thin = name.ends_with("/proxy.stl") && lays_little_filament(&said);
        match output.status.code() {
            Some(0) => judged += 1,
            Some(NONE_COULD_RUN) => say_skipped(&format!("{name}: no judge of {} is installed", extra[1])),
            _ if touching || thin => judged += 1,
            _ => wrong.push(format!("{name}: {said}")),
        }
    };
    for configuration in hardware() {
        let set = configuration.file_stem().unwrap().to_string_lossy().into_owned();
        let given = configuration.to_string_lossy();
        done(folder.path(), &["-q", "generate", &given, "--format", "stl,3mf,step", "--out", &set]);
        let written = files(&folder.path().join(&set));
        let manifest: Value = serde_json::from_slice(&written["manifest.json"]).unwrap();
        let volume = |file: &str| {
            let mesh = file.replace(".step", ".stl");
            manifest["parts"]
                .as_array()
                .unwrap()
                .iter()
                .find(|p| p["file"] == mesh.as_str())
                .map(|p| p["volume_mm3"].to_string())
        };
        for (name, bytes) in &written {
            let path = folder.path().join(&set).join(name);
            if !name.ends_with(".stl") && !name.ends_with(".3mf") && !name.ends_with(".step")
                || !asked.insert(bytes.clone())
            {
                continue;
            }
            match (path.extension().and_then(|e| e.to_str()), volume(name)) {
                (Some("stl"), _) => ask(&path, &["--only", OF_MESHES]),
                (Some("3mf"), _) => ask(&path, &["--only", OF_PACKAGES]),
                (_, Some(volume)) => {
                    ask(&path, &["--only", "ocp", "--volume", &volume, "--rtol", SHARE_OF_VOLUME])
                }
                (_, None) => ask(&path, &["--only", "ocp"]),
            }
        }
    }
    assert!(wrong.is_empty(), "{} of {} files:\n{}", wrong.len(), judged + wrong.len(), wrong.join("\n"));
    assert!(judged > 200, "only {judged} files were judged");
}

/// Whether all that failed is the share of the volume that the slicer lays, and only just.
fn lays_little_filament(said: &str) -> bool {
    let mut failed = said.lines().filter(|line| line.contains(" FAIL ")).peekable();
    failed.peek().is_some()
        && failed.all(|line| {
            let share =
                line.contains("filament volume / mesh volume").then(|| line.rsplit_once("= ")).flatten();
            share
                .and_then(|(_, s)| s.split([' ', ')', ';', ',']).next()?.parse::<f64>().ok())
                .is_some_and(|s| s >= LEAST_FILAMENT_OF_PROXIES)
        })
}

/// The configurations of the corpus that use hardware.
fn hardware() -> Vec<PathBuf> {
    let mut found: Vec<_> = std::fs::read_dir(repository("tests/corpus"))
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.file_name().is_some_and(|n| n.to_string_lossy().starts_with("hardware-")))
        .collect();
    found.sort();
    assert!(found.len() >= 30, "{} configurations", found.len());
    found
}
