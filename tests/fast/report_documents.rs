//! Documents of every kind that the program writes: what the commands print with `--json`, and their JSON files.

#![cfg(unix)]

use std::io::Read;
use std::path::Path;
use std::sync::LazyLock;

use serde_json::Value;

use crate::harness::{SWEEP, binary, expect_code, repository};
use crate::slicing::substitute_slicer;

/// Kinds of the JSON files that the commands write, by name.
const FILES: &[(&str, &str)] = &[
    ("batch.json", "batch-record"),
    ("design.json", "design-report"),
    ("experiment.json", "experiment-report"),
    ("faults.json", "simulated-faults"),
    ("finger.json", "finger-report"),
    ("manifest.json", "manifest"),
    ("physics.json", "physics-report"),
    ("plateaus.json", "segmentation-report"),
    ("provenance.json", "provenance"),
    ("published.json", "published-report"),
    ("report.json", "calibration-report"),
    ("shard.json", "shard-record"),
    ("slicing.json", "slicing-report"),
    ("switch.json", "tension-table"),
    ("tolerances.json", "tolerances-report"),
];

/// Commands that print a report, with its kind and their exit code, in the order in which they run.
pub(crate) const PRINTED: &[(&str, i32, &str)] = &[
    ("layouts-report", 0, "layouts --json"),
    ("prediction-report", 0, "predict three-double --json"),
    ("prediction-report", 0, "predict proxy-three-double --law paper --json"),
    ("prediction-report", 0, "predict three-double --model joined/model.toml --json"),
    ("physics-report", 0, "physics --out physics --json"),
    ("finger-report", 0, "finger three-double silicone-only --out finger --json"),
    ("finger-report", 0, "finger joint.toml --joint 0..9 --json"),
    ("tolerances-report", 0, "tolerances three-double --draws 50 --out tolerances --json"),
    ("tolerances-report", 0, "tolerances three-double --draws 50 --scatter 20% --json"),
    ("tolerances-report", 1, "tolerances three-double --draws 50 --scatter 0.01 --json"),
    ("design-report", 0, "design --threshold 26 --pins 3 --vary none --starts 1 --draws 20 --best 2 --json"),
    ("design-report", 1, "design --request never.toml --starts 1 --draws 20 --best 1 --out design --json"),
    ("manifest", 0, "generate three-double --measured measured.toml --format stl,3mf --out set --json"),
    ("manifest", 0, "generate joint.toml --model joined/model.toml --format stl --out jointed --json"),
    ("manifest", 0, "generate proxy-three-double --format stl --out proxy --json"),
    ("manifest", 0, "generate three-double --set mount.kind=rig --format stl --out tested --json"),
    ("check-report", 0, "check set/shell.stl set/assembly.3mf --json"),
    ("check-report", 1, "check --strict --min-wall 50 --bodies 3 set/shell.stl set/assembly.3mf --json"),
    ("import-report", 0, "import units-row.csv --dry-run --json"),
    ("import-report", 2, "import uncertain.csv --dry-run --json"),
    ("power-report", 0, "power small.toml --runs 1 --json"),
    ("experiment-report", 0, "experiment calibration --minutes 20 --out next --json"),
    ("batch-estimate", 0, "batch sweep.toml --dry-run --json"),
    ("batch-tally", 0, "batch sweep.toml --out batch --shard 1/2 --json"),
    ("batch-tally", 0, "batch sweep.toml --out batch --shard 2/2 --json"),
    ("batch-tally", 0, "merge batch --json"),
    ("batch-tally", 0, "batch verify.toml --verify --out verified --json"),
    ("explain-report", 0, "explain grooves-overlap --json"),
    ("explain-report", 0, "explain --json"),
    ("effects-report", 0, "effects --effects trial.toml --json"),
    ("calibration-report", 0, "calibrate few-series.csv --out attributed --json"),
    ("published-report", 0, "calibrate --published --out published --json"),
    ("provenance", 0, "simulate small.toml --out simulated --json"),
    ("study-report", 0, "simulate --study 1 --only operators --json"),
    ("segmentation-report", 0, "segment rig/run.toml --no-plots --out table/plateaus.csv --json"),
    ("tension-table", 0, "export three-double --to csv --out tables --json"),
    ("failure", 2, "generate three-double --set segment.grooves=40 --json"),
    ("failure", 2, "check set/shell.stl --bogus --json"),
    ("failure", 2, "check set/shell.stl no-such.stl --json"),
    ("failure", 2, "power no-such.toml --json"),
    ("failure", 2, "power measured.toml --json"),
    ("failure", 2, "calibrate no-such.csv --out missing --json"),
    ("failure", 2, "segment no-such.toml --out missing.csv --json"),
    ("failure", 2, "effects --effects no-such.toml --json"),
    ("failure", 2, "simulate no-such.toml --out missing --json"),
    ("failure", 2, "export three-double --set segment.grooves=40 --to csv --out missing --json"),
];

/// Commands that run before these, write files, and print no JSON.
const WRITING: &[&str] = &[
    "simulate small.toml --raw --out rig",
    "segment rig/run.toml --no-plots --out table/plateaus.csv",
    "simulate faulty.toml --raw --out faulty",
    "segment faulty/run.toml --no-plots --out segmented/plateaus.csv",
    "calibrate table/plateaus.csv --out calibration",
    "experiment calibration --minutes 20 --out planned",
    "simulate small.toml --runs planned/next-runs.csv --out second",
    "calibrate table/plateaus.csv second/plateaus.csv --plan planned --out joined",
    "simulate other.toml --out other",
    "calibrate table/plateaus.csv other/plateaus.csv --out changed",
    "calibrate four-stops.csv --out four",
    "calibrate one-wrong-weight.csv --fit-below 70 --out wrong",
    "calibrate wrong-fourth-repetitions.csv --out bad",
    "calibrate trial.csv --effects trial.toml --out trial",
    "import units-row.csv --yes --out imported/table.csv",
];

/// A sweep of one small part.
const VERIFIED: &str = r#"
[sweep]
base = "three-double"
parts = ["support-left"]
[set]
"friction.points" = 11
[axes]
"shell.width_mm" = [13]
"#;
/// A request that no design meets.
const NEVER: &str = "[targets]
threshold_n = { about = 26, within = 0.1 }
max_friction_n = { at_least = 30 }
low_load_friction_n = { at_most = 9 }
stiffness = \"between 0.1 and 9\"
friction = [{ load_n = 15, at_least_n = 1 }]
[vary]
pattern = false
layer_mm = [1.5, 3.0]
[materials]
tendon = [{ rope_diameter_mm = 0.8, coating_mm = 0.1 }]
";

/// A document that the program wrote.
pub(crate) struct Document {
    pub(crate) kind: &'static str,
    /// The command, or the path of the file.
    pub(crate) origin: String,
    pub(crate) content: Value,
}

pub(crate) static DOCUMENTS: LazyLock<Vec<Document>> = LazyLock::new(documents);

/// Runs every command, and returns what each printed and wrote.
fn documents() -> Vec<Document> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    write_inputs(path);
    for command in WRITING {
        expect_code(0, path, &arguments(command));
    }
    let mut all: Vec<Document> = PRINTED
        .iter()
        .map(|(kind, code, command)| {
            let output = expect_code(*code, path, &arguments(command));
            let content = serde_json::from_slice(&output.stdout).unwrap();
            Document { kind, origin: (*command).to_owned(), content }
        })
        .collect();
    let mut slice = binary();
    slice.args(arguments("generate three-single --slice --format stl,3mf --out sliced")).current_dir(path);
    let output = slice.env("PINSWITCH_SLICER", substitute_slicer(path)).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let mut folders = vec![path.to_owned()];
    while let Some(next) = folders.pop() {
        for entry in std::fs::read_dir(next).unwrap() {
            let file = entry.unwrap().path();
            if file.is_dir() {
                folders.push(file);
            } else if file.extension().is_some_and(|extension| extension == "json") {
                let name = file.file_name().unwrap().to_str().unwrap();
                // Its schema is that of the standard.
                if name == "datapackage.json" {
                    continue;
                }
                let kind = FILES.iter().find(|known| known.0 == name);
                let kind = kind.unwrap_or_else(|| panic!("{}: a file without a schema", file.display())).1;
                let content = serde_json::from_slice(&std::fs::read(&file).unwrap()).unwrap();
                all.push(Document { kind, origin: file.display().to_string(), content });
            }
        }
    }
    all
}

/// Writes the inputs of the commands.
fn write_inputs(path: &Path) {
    let put = |name: &str, text: &str| std::fs::write(path.join(name), text).unwrap();
    let joint = "[switch]\nname = \"jointed\"\n[layout]\npins = [5, 8, 11]\n[mount]\nkind = \"joint\"\n";
    put("joint.toml", joint);
    put("measured.toml", "hardness_shore_a = [46, 47.5]\n");
    put("sweep.toml", SWEEP);
    put("verify.toml", VERIFIED);
    put("never.toml", NEVER);
    put("uncertain.csv", "load,direction,force [N]\n1,up,12.5\n1,down,8\n");
    let rig =
        "layouts = []\nweights_g = [1000, 2000, 3000, 5000]\nrepetitions = [4, 4]\nrepetitions_spread = 0\n";
    put("small.toml", rig);
    put("faulty.toml", &format!("{rig}[raw]\nodd_speed_share = 0.9\nmissing_share = 0.9\n"));
    put("other.toml", &format!("{rig}[constants]\nmu_s = 0.31\n"));
    let data = repository("tests/data");
    for (name, from) in [
        ("units-row.csv", "laboratories-files/units-row.csv"),
        ("four-stops.csv", "laboratories/four-stops.csv"),
        ("one-wrong-weight.csv", "laboratories/one-wrong-weight.csv"),
        ("wrong-fourth-repetitions.csv", "laboratories/wrong-fourth-repetitions.csv"),
        ("few-series.csv", "../corpus/plateaus/accepted-few-series.csv"),
        ("trial.toml", "trials/silicone-step.toml"),
    ] {
        std::fs::copy(data.join(from), path.join(name)).unwrap();
    }
    let packed = std::fs::File::open(data.join("trials/silicone-step.csv.gz")).unwrap();
    let mut table = String::new();
    flate2::read::MultiGzDecoder::new(packed).read_to_string(&mut table).unwrap();
    put("trial.csv", &table);
}

fn arguments(command: &str) -> Vec<&str> {
    ["-q"].into_iter().chain(command.split(' ')).collect()
}
