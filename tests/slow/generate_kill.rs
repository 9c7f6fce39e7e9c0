//! `generate`, killed (SIGKILL) at random moments and at every file that it renames or removes,
//! leaves the complete old set, the complete new set, or no manifest. The next run removes leftover
//! files. A unit test of `cad/cli/src/write/set_folder.rs` stops after every single step.

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
        if run % 5 == 0 {
            done(folder.path(), &out("killed", set));
            assert_eq!(differences(&whole[set], &hashes(&place)), Vec::<String>::new());
        }
        assert!(run < 20 * KILLS, "the runs end before they are killed");
    }
    println!("{kills} kills in {run} runs; {without_manifest} runs left no manifest");
}

/// Returns whether the folder has a manifest. Asserts that a folder with a manifest is one of the
/// complete sets.
fn has_complete_set(place: &Path, whole: &[std::collections::BTreeMap<String, String>]) -> bool {
    let mut there = hashes(place);
    there.retain(|name, _| !name.starts_with(".pinswitch-"));
    if !there.contains_key("manifest.json") {
        return false;
    }
    assert!(whole.contains(&there), "{:?}", there.keys());
    true
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
        done(folder.path(), &[SETS[1], &["--out", "killed"]].concat());
        assert_eq!(differences(&whole[1], &hashes(&place)), Vec::<String>::new(), "after kill {at}");
    }
    println!("{kills} kills; {without_manifest} left no manifest");
    // At least one kill for each file of the set.
    assert!(kills > whole[1].len() && without_manifest > 0, "{kills} {without_manifest}");
}
