//! `pinswitch simulate PLAN.toml --out DIR` and `pinswitch simulate --study`.

use std::path::PathBuf;

use clap::Args;
use pinswitch_model::inference::Levels;
use pinswitch_model::rig::PlateauTable;
use pinswitch_model::simulation::{Plan, Study, run_case, simulate, study_cases};

use super::{Failure, print};
use crate::output::{OutputFile, write_set};

/// Simulate a friction rig with known effects and noise, or study the calibrator on many of them.
///
/// Writes plateaus.csv, plateaus-fresh.csv (rows without noise, to judge predictions by) and plan.toml.
#[derive(Args, Debug)]
#[command(after_help = "Examples:
  pinswitch simulate plan.toml --out rig
  pinswitch simulate --study 20")]
pub(super) struct Arguments {
    /// The plan: layouts, loads, sweeps, speeds, dwells, effects with their sizes, noise, seed.
    #[arg(required_unless_present = "study")]
    plan: Option<PathBuf>,
    /// Folder for the tables.
    #[arg(long, value_name = "DIR", required_unless_present = "study")]
    out: Option<PathBuf>,
    /// Calibrate this many rigs of every kind and print what was said of them.
    #[arg(long, value_name = "SEEDS", conflicts_with_all = ["plan", "out"])]
    study: Option<u64>,
    /// In a study, only the kinds of rig whose name contains this.
    #[arg(long, value_name = "NAME", requires = "study")]
    only: Option<String>,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    if let Some(seeds) = arguments.study {
        return study(seeds, arguments.only.as_deref());
    }
    let (Some(plan), Some(out)) = (&arguments.plan, &arguments.out) else {
        return Err(Failure::bad_input("simulate needs a plan and --out, or --study"));
    };
    let name = plan.display().to_string();
    let text = std::fs::read_to_string(plan).map_err(|e| Failure::bad_input(format!("{name}: {e}")))?;
    let plan = Plan::parse(&text, &name).map_err(Failure::bad_input)?;
    let simulated = simulate(&plan);
    let file = |name: &str, text: String| OutputFile { name: name.to_owned(), bytes: text.into_bytes() };
    let files = [
        file("plan.toml", text),
        file("plateaus-fresh.csv", PlateauTable::write(&simulated.fresh)),
        file("plateaus.csv", PlateauTable::write(&simulated.rows)),
    ];
    write_set(out, &files).map_err(Failure::failed)
}

/// The confusion matrix over all kinds of rig.
fn study(seeds: u64, only: Option<&str>) -> Result<(), Failure> {
    let mut study = Study::default();
    for case in study_cases().iter().filter(|c| only.is_none_or(|o| c.name.contains(o))) {
        for seed in 1..=seeds {
            study.add(case, run_case(case, seed, Levels::default()));
        }
        log::info!("{:?} {}: {seeds} rigs", case.protocol, case.name);
    }
    print(study.table().as_bytes())
}
