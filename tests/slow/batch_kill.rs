//! A batch that is killed (SIGKILL) at random moments and restarted has the same files as an
//! uninterrupted one.

use std::process::Stdio;
use std::time::{Duration, Instant};

use crate::harness::{differences, done, hashes, with_sweep};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Total number of kills.
const KILLS: usize = 20;
/// Consecutive kills of one batch before a run without a kill.
const IN_A_ROW: usize = 4;

const SWEEP: &str = r#"
[sweep]
name = "killed"
base = "three-double"
parts = ["shell", "mould-core", "support-left", "coupon"]
[axes]
"layout.pins" = [[5, 8, 11], [4, 8, 12], [3, 8, 13], [7, 8], [8]]
"shell.width_mm" = { from = 12, to = 15.5, step = 0.5 }
"tendon.length_mm" = [200, 300]
"#;

#[test]
fn killed_runs_resume_with_equal_files() {
    let folder = with_sweep(SWEEP);
    let start = Instant::now();
    done(folder.path(), &["batch", "sweep.toml", "--out", "whole"]);
    let whole_run = start.elapsed();
    let whole = hashes(&folder.path().join("whole"));
    let mut random = ChaCha8Rng::seed_from_u64(20);
    // Each attempt completes about a quarter of the batch, so that kills hit all stages.
    let mut longest_s = whole_run.as_secs_f64() * 1.5 / IN_A_ROW as f64;
    let (mut kills, mut round) = (0, 0);
    while kills < KILLS {
        let out = format!("killed-{round}");
        for _ in 0..IN_A_ROW {
            let mut child = crate::harness::binary()
                .args(["batch", "sweep.toml", "--out", &out])
                .current_dir(folder.path())
                .stderr(Stdio::null())
                .spawn()
                .unwrap();
            std::thread::sleep(Duration::from_secs_f64(longest_s * random.random_range(0.0..1.0)));
            if child.try_wait().unwrap().is_some() {
                // The run finished before the kill, so the next kills come earlier.
                longest_s *= 0.8;
                break;
            }
            child.kill().unwrap();
            child.wait().unwrap();
            kills += 1;
        }
        done(folder.path(), &["batch", "sweep.toml", "--out", &out]);
        let resumed = hashes(&folder.path().join(&out));
        assert_eq!(differences(&whole, &resumed), Vec::<String>::new(), "{out}");
        round += 1;
    }
    println!("{kills} kills of {round} batches of {:.2} s", whole_run.as_secs_f64());
}
