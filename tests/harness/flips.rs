//! A chain of commands from a log to a set, and single changed characters in the files between them.

use std::path::Path;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::{expect_code, pinswitch};

/// Two substrates, one speed and a step of the friction that no effect explains, so that a form is fitted.
const RIG: &str = "seed = 7
protocol = \"randomised\"
layouts = []
speeds_pct = [40.0, 60.0]
dwells_s = [3.0]
repetitions = [5, 5]
repetitions_spread = 0
[[disturbances]]
size = 0.15
target = \"friction\"
kind.step = { at = 0.45, over = 0.0 }
";

/// The commands of the chain, in order.
const CHAIN: [&str; 7] = [
    "simulate rig.toml --raw --out rig",
    "segment rig/run.toml --no-plots --out table/plateaus.csv",
    "calibrate table/plateaus.csv --out calibration",
    "experiment calibration --minutes 60 --out next",
    "simulate rig.toml --runs next/next-runs.csv --out second",
    "calibrate table/plateaus.csv second/plateaus.csv --plan next --out joined",
    "generate three-double --model joined/model.toml --format stl --out set",
];

/// Every file that a later command reads, and such a command.
const READERS: [(&str, &str); 29] = [
    ("rig/run.toml", "segment rig/run.toml --out x/plateaus.csv"),
    ("rig/000-silicone_0251g.csv.gz", "segment rig/run.toml --out x/plateaus.csv"),
    ("rig/provenance.json", "segment rig/run.toml --out x/plateaus.csv"),
    ("rig/plan.toml", "simulate rig/plan.toml --out x"),
    ("rig/plateaus.csv", "calibrate rig/plateaus.csv --out x"),
    ("rig/plateaus-fresh.csv", "predict --model calibration/model.toml --rows rig/plateaus-fresh.csv"),
    ("table/plateaus.csv", "calibrate table/plateaus.csv --out x"),
    ("table/plateaus.csv", "predict --model calibration/baseline.toml --rows table/plateaus.csv"),
    ("table/provenance.json", "calibrate table/plateaus.csv --out x"),
    ("calibration/report.json", "experiment calibration --out x"),
    ("calibration/residuals.csv", "experiment calibration --out x"),
    ("calibration/model.toml", "experiment calibration --out x"),
    ("calibration/discovered.toml", "experiment calibration --out x"),
    ("calibration/provenance.json", "experiment calibration --out x"),
    ("calibration/discovered.toml", "effects --effects calibration/discovered.toml"),
    (
        "calibration/discovered.toml",
        "calibrate table/plateaus.csv --effects calibration/discovered.toml --out x",
    ),
    ("calibration/baseline.toml", "predict three-double --model calibration/baseline.toml"),
    ("calibration/model.toml", "predict three-double --model calibration/model.toml"),
    ("calibration/model.toml", "power rig.toml --noise calibration/model.toml"),
    ("next/next-runs.csv", "simulate --runs next/next-runs.csv --out x"),
    ("next/next-runs.csv", "calibrate table/plateaus.csv second/plateaus.csv --plan next --out x"),
    ("next/experiment.json", "calibrate table/plateaus.csv second/plateaus.csv --plan next --out x"),
    ("next/discovered.toml", "calibrate table/plateaus.csv second/plateaus.csv --plan next --out x"),
    ("next/provenance.json", "calibrate table/plateaus.csv second/plateaus.csv --plan next --out x"),
    ("second/plateaus.csv", "calibrate table/plateaus.csv second/plateaus.csv --plan next --out x"),
    ("second/provenance.json", "calibrate table/plateaus.csv second/plateaus.csv --plan next --out x"),
    ("joined/model.toml", "generate three-double --model joined/model.toml --out x"),
    ("joined/model.toml", "design --threshold 20 --model joined/model.toml --out x"),
    ("joined/model.toml", "simulate --runs next/next-runs.csv --model joined/model.toml --out x"),
];

/// Runs the chain in `folder`.
pub(crate) fn make_chain(folder: &Path) {
    std::fs::write(folder.join("rig.toml"), RIG).unwrap();
    for command in CHAIN {
        expect_code(0, folder, &arguments(command));
    }
}

fn arguments(command: &str) -> Vec<&str> {
    ["-q"].into_iter().chain(command.split(' ')).collect()
}

/// Changes one character `count` times in total, in each file in turn, and asserts that the command refuses the file and
/// writes nothing.
pub(crate) fn assert_no_flip_is_believed(folder: &Path, count: usize, seed: u64) {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    for i in 0..count {
        let (file, command) = READERS[i % READERS.len()];
        let path = folder.join(file);
        let whole = std::fs::read(&path).unwrap();
        let (at, flipped) = flip(&mut random, &whole);
        std::fs::write(&path, &flipped).unwrap();
        let output = pinswitch(folder, &arguments(command));
        let text = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(
            output.status.code() == Some(2) && text.contains(&format!("error: {file}: was changed")),
            "{file}: byte {at} is {:?} instead of {:?}: `{command}` ended with {:?}: {text}",
            char::from(flipped[at]),
            char::from(whole[at]),
            output.status.code()
        );
        assert!(output.stdout.is_empty() && !folder.join("x").exists(), "{file}: `{command}`");
        std::fs::write(&path, &whole).unwrap();
    }
}

/// Replaces one byte: mostly a digit by another digit, otherwise any byte by another printable character.
fn flip(random: &mut ChaCha8Rng, bytes: &[u8]) -> (usize, Vec<u8>) {
    let mut below = |end: usize| random.random_range(0..end);
    let digits: Vec<usize> = (0..bytes.len()).filter(|at| bytes[*at].is_ascii_digit()).collect();
    let is_digit = !digits.is_empty() && below(4) > 0;
    let at = if is_digit { digits[below(digits.len())] } else { below(bytes.len()) };
    let (first, last) = if is_digit { (b'0', b'9') } else { (b' ', b'~') };
    let mut flipped = bytes.to_vec();
    while flipped[at] == bytes[at] {
        flipped[at] = first + below(usize::from(last - first) + 1) as u8;
    }
    (at, flipped)
}
