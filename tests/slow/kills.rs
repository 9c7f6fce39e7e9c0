//! Commands that are killed (SIGKILL) at random moments, and at every file that they rename or remove, leave the old
//! result or the new one: without a manifest until the next run reads or writes in the folder, which completes what was
//! committed. A unit test of `cad/store/src/staging.rs` stops after every single change.

use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use crate::harness::{binary, differences, done, hashes, report_skipped};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Total number of kills.
const KILLS: usize = 60;

/// Sets that alternate, so that each run has files to remove and to replace.
const SETS: [&[&str]; 3] = [
    &["-q", "generate", "three-double", "--format", "stl,step,dxf"],
    &["-q", "generate", "three-double", "--format", "stl", "--set", "shell.width_mm=16"],
    &["-q", "generate", "three-double", "--format", "all", "--set", "parts.coupon=false"],
];

#[test]
fn killed_set_is_recognisably_incomplete() {
    let folder = tempfile::tempdir().unwrap();
    let out = |name: &'static str, set: usize| [SETS[set], &["--out", name]].concat();
    let mut whole_run_s = [0.0; SETS.len()];
    let whole: Vec<_> = (0..SETS.len())
        .map(|set| {
            let name = ["whole-0", "whole-1", "whole-2"][set];
            let start = Instant::now();
            done(folder.path(), &out(name, set));
            whole_run_s[set] = start.elapsed().as_secs_f64();
            hashes(&folder.path().join(name))
        })
        .collect();
    let place = folder.path().join("killed");
    let mut random = ChaCha8Rng::seed_from_u64(11);
    let (mut kills, mut without_manifest, mut run) = (0, 0, 0);
    while kills < KILLS {
        let set = run % SETS.len();
        run += 1;
        let mut child = binary()
            .args(out("killed", set))
            .current_dir(folder.path())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        // Half of the kills are near the end of the run, when files get their final names.
        let share =
            if run % 2 == 0 { random.random_range(0.0..1.0) } else { random.random_range(0.85..1.02) };
        std::thread::sleep(Duration::from_secs_f64(whole_run_s[set] * share));
        if child.try_wait().unwrap().is_none() {
            child.kill().unwrap();
            kills += 1;
        }
        child.wait().unwrap();
        without_manifest += usize::from(place.exists() && !has_complete_set(&place, &whole));
        if place.exists() {
            read_in(&place);
            let there = visible(&place);
            assert!(there.is_empty() || whole.contains(&there), "{:?}", there.keys());
        }
        if run % 5 == 0 {
            done(folder.path(), &out("killed", set));
            assert_eq!(differences(&whole[set], &hashes(&place)), Vec::<String>::new());
        }
        assert!(run < 20 * KILLS, "the runs end before they are killed");
    }
    println!("{kills} kills in {run} runs; {without_manifest} runs left no manifest");
}

/// Returns whether the folder has a manifest. Asserts that a folder with a manifest is one of the
/// complete sets, and that any folder is one after a command has read in it.
fn has_complete_set(place: &Path, whole: &[Files]) -> bool {
    let there = visible(place);
    let is_complete = there.contains_key("manifest.json");
    assert!(!is_complete || whole.contains(&there), "{:?}", there.keys());
    is_complete
}

type Files = std::collections::BTreeMap<String, String>;

/// Returns the files of a folder, without unfinished ones, with their hashes.
fn visible(place: &Path) -> Files {
    let mut there = if place.exists() { hashes(place) } else { Files::new() };
    there.retain(|name, _| !name.starts_with(".pinswitch-"));
    there
}

/// Reads in the folder, which completes what was committed.
fn read_in(place: &Path) {
    let _ = binary()
        .arg("power")
        .arg(place.join("none.toml"))
        .stderr(Stdio::null())
        .stdout(Stdio::null())
        .status();
}

/// Kills of the commands in [`WRITERS`] at random moments.
const WRITER_KILLS: usize = 165;

/// Commands that write, each with two different results for one folder.
const WRITERS: [[&[&str]; 2]; 12] = [
    [&["simulate", "one.toml", "--out", "o"], &["simulate", "two.toml", "--next", "--out", "o"]],
    [&["calibrate", "one/plateaus.csv", "--out", "o"], &["calibrate", "two/plateaus.csv", "--out", "o"]],
    [
        &["experiment", "c", "--minutes", "30", "--out", "o"],
        &["experiment", "c", "--minutes", "60", "--out", "o"],
    ],
    [
        &["import", "one.txt", "--yes", "--out", "o/t.csv"],
        &["import", "two.txt", "--yes", "--out", "o/t.csv"],
    ],
    [&["finger", "three-double", "--out", "o"], &["finger", "three-single", "--out", "o"]],
    [
        &["export", "three-double", "--to", "mujoco", "--draws", "3", "--out", "o"],
        &["export", "three-single", "--to", "urdf", "--draws", "1", "--out", "o"],
    ],
    [&["physics", "three-double", "--out", "o"], &["physics", "three-single", "--out", "o"]],
    [
        &["init", "three-double", "--out", "o/m.toml"],
        &["init", "three-single", "--force", "--out", "o/m.toml"],
    ],
    [&["render", "three-double", "--out", "o/p.png"], &["render", "three-single", "--out", "o/p.png"]],
    [&["man", "--out", "o"], &["man", "--out", "o"]],
    [
        &["generate", "three-double", "--format", "stl", "--out", "o"],
        &["generate", "three-double", "--format", "stl,page", "--set", "shell.width_mm=16", "--out", "o"],
    ],
    [&["calibrate", "two/plateaus.csv", "--out", "o"], &["experiment", "o", "--minutes", "30", "--out", "o"]],
];

/// A folder with the inputs of [`WRITERS`].
fn with_inputs() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    for (name, seed) in [("one", 1), ("two", 2)] {
        let plan = format!(
            "seed = {seed}\nlayouts = [[5, 8, 11]]\nweights_g = [503.6, 2005.0, 5002.5]\n\
             speeds_pct = [40, 52, 70]\nrepetitions = [3, 3]\n"
        );
        std::fs::write(path.join(format!("{name}.toml")), plan).unwrap();
        done(path, &["-q", "simulate", &format!("{name}.toml"), "--out", name]);
        let table = std::fs::read_to_string(path.join(name).join("plateaus.csv")).unwrap();
        std::fs::write(path.join(format!("{name}.txt")), table).unwrap();
    }
    done(path, &["-q", "calibrate", "one/plateaus.csv", "--out", "c"]);
    folder
}

#[test]
fn every_command_survives_kills() {
    let folder = with_inputs();
    let (path, place) = (folder.path(), folder.path().join("o"));
    let mut random = ChaCha8Rng::seed_from_u64(5);
    let (mut kills, mut completed, mut kept) = (0, 0, 0);
    let quiet = |command: &'static [&'static str]| [&["-q"], command].concat();
    for [first, second] in WRITERS {
        let _ = std::fs::remove_dir_all(&place);
        let mut whole = Vec::new();
        let mut time_s = 0.0;
        for command in [first, second] {
            // A single file needs its folder.
            std::fs::create_dir_all(&place).unwrap();
            let start = Instant::now();
            done(path, &quiet(command));
            time_s = start.elapsed().as_secs_f64();
            whole.push(visible(&place));
        }
        for _ in 0..WRITER_KILLS.div_ceil(WRITERS.len()) {
            let _ = std::fs::remove_dir_all(&place);
            std::fs::create_dir_all(&place).unwrap();
            done(path, &quiet(first));
            assert_eq!(visible(&place), whole[0], "{first:?} gives another result");
            let mut command = binary();
            command.args(quiet(second)).current_dir(path).stderr(Stdio::null()).stdout(Stdio::null());
            let mut child = command.spawn().unwrap();
            let share =
                if random.random() { random.random_range(0.0..1.0) } else { random.random_range(0.8..1.02) };
            std::thread::sleep(Duration::from_secs_f64(time_s * share));
            kills += usize::from(child.try_wait().unwrap().is_none());
            child.kill().unwrap();
            child.wait().unwrap();
            read_in(&place);
            let there = visible(&place);
            assert!(whole.contains(&there), "{second:?}: {:?}", there.keys());
            completed += usize::from(there == whole[1]);
            kept += usize::from(there == whole[0]);
            done(path, &quiet(second));
            assert_eq!(visible(&place), whole[1], "{second:?} after a kill");
            let unfinished = std::fs::read_dir(&place).unwrap().count() - whole[1].len();
            assert_eq!(unfinished, 0, "{second:?} leaves unfinished files");
        }
    }
    println!("{kills} kills; {kept} kept the old result, {completed} had the new one");
    assert!(kills > WRITER_KILLS / 2, "{kills}");
}

/// Library that is preloaded before the C library: kills the process before it renames or removes
/// the n-th file.
#[cfg(target_os = "linux")]
const KILLER: &str = r#"
#define _GNU_SOURCE
#include <dlfcn.h>
#include <signal.h>
#include <stdlib.h>
#include <unistd.h>
static void count(void) {
    static int done = 0;
    const char *at = getenv("PINSWITCH_KILL_AT");
    if (at && ++done == atoi(at)) kill(getpid(), SIGKILL);
}
int rename(const char *from, const char *to) {
    count();
    return ((int (*)(const char *, const char *))dlsym(RTLD_NEXT, "rename"))(from, to);
}
int unlink(const char *path) {
    count();
    return ((int (*)(const char *))dlsym(RTLD_NEXT, "unlink"))(path);
}
"#;

#[cfg(target_os = "linux")]
#[test]
fn set_survives_kill_at_every_file() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("killer.c"), KILLER).unwrap();
    let compiler = Command::new("cc")
        .args(["-shared", "-fPIC", "-o", "killer.so", "killer.c", "-ldl"])
        .current_dir(folder.path())
        .status();
    if !compiler.is_ok_and(|status| status.success()) {
        return report_skipped("no C compiler here");
    }
    let whole: Vec<_> = ["whole-0", "whole-1"]
        .iter()
        .zip(SETS)
        .map(|(name, set)| {
            done(folder.path(), &[set, &["--out", name]].concat());
            hashes(&folder.path().join(name))
        })
        .collect();
    let place = folder.path().join("killed");
    let (mut kills, mut without_manifest) = (0, 0);
    for at in 1.. {
        done(folder.path(), &[SETS[0], &["--out", "killed"]].concat());
        assert_eq!(differences(&whole[0], &hashes(&place)), Vec::<String>::new(), "before kill {at}");
        let status = binary()
            .args([SETS[1], &["--out", "killed"]].concat())
            .current_dir(folder.path())
            .env("LD_PRELOAD", folder.path().join("killer.so"))
            .env("PINSWITCH_KILL_AT", at.to_string())
            .stderr(Stdio::null())
            .status()
            .unwrap();
        if status.success() {
            break;
        }
        assert_eq!(status.code(), None, "the run failed without a kill");
        kills += 1;
        without_manifest += usize::from(!has_complete_set(&place, &whole));
        read_in(&place);
        assert!(whole.contains(&visible(&place)), "kill {at}");
        done(folder.path(), &[SETS[1], &["--out", "killed"]].concat());
        assert_eq!(differences(&whole[1], &hashes(&place)), Vec::<String>::new(), "after kill {at}");
    }
    println!("{kills} kills; {without_manifest} left no manifest");
    // At least one kill for each file of the set.
    assert!(kills > whole[1].len() && without_manifest > 0, "{kills} {without_manifest}");
}
