//! `pinswitch simulate PLAN.toml --out DIR` and `pinswitch simulate --study`.

use std::io::Write;
use std::path::{Path, PathBuf};

use clap::Args;
use flate2::Compression;
use flate2::write::GzEncoder;
use pinswitch_calibration::ModelFile;
use pinswitch_calibration::experiment::{RigLimits, read_runs, rows_of};
use pinswitch_calibration::inference::Levels;
use pinswitch_calibration::table::{PlateauRow, PlateauTable};
use pinswitch_simulation::{
    Case, ExperimentStudy, FormStudy, Group, Plan, RawRun, Study, experiment_cases, next_session, run_case,
    run_experiment_case, run_form_case, simulate, simulate_from_model, simulate_rows, study_cases,
};
use rayon::prelude::*;

use super::own_effects::OwnEffects;
use super::power::noise_of;
use super::{Failure, print};
use crate::input::read_text_file;
use crate::write::write_set;
use pinswitch_switch::output::OutputFile;

/// Simulate a friction rig with known effects and noise, or study the calibrator on many of them.
///
/// Writes plateaus.csv, plateaus-fresh.csv (rows without noise, to judge predictions by) and plan.toml.
#[derive(Args, Debug)]
#[command(after_help = "Examples:
  pinswitch simulate --effect coating_ploughing=0.02 --out rig
  pinswitch simulate --effects mine.toml --effect lubricant_dip=0.2 --out rig
  pinswitch simulate plan.toml --out rig
  pinswitch simulate plan.toml --out rig --raw
  pinswitch simulate --runs next/next-runs.csv --model calibration/model.toml --out rehearsal
  pinswitch simulate --study 20
  pinswitch simulate --study 20 --only nulls --only 'worn spot'")]
// clap does not ask for an argument that is required if another one that is given conflicts with it: those that need --study conflict
// with --out themselves, and those that need --runs with what --runs conflicts with.
pub(super) struct Arguments {
    /// The plan: layouts, loads, sweeps, speeds, dwells, effects with their sizes, noise, seed. Without one, the paper's rig.
    plan: Option<PathBuf>,
    /// Put an effect into the rig, beside those of the plan: ID or ID=VALUE,VALUE, sizes before shapes.
    /// Of an effect of your own, what is left out is at its start value.
    #[arg(long = "effect", value_name = "ID=VALUES", conflicts_with = "study")]
    effects: Vec<String>,
    #[command(flatten)]
    own: OwnEffects,
    /// Without a plan: loads up and down, several speeds and dwells, instead of the paper's protocol.
    #[arg(long, conflicts_with_all = ["plan", "study", "runs"])]
    randomised: bool,
    /// Folder for the tables.
    #[arg(long, value_name = "DIR", required_unless_present = "study")]
    out: Option<PathBuf>,
    /// Also write raw 200 Hz logs with spikes, lost samples and bad moves: run.toml for `segment`, truth.csv, faults.json.
    #[arg(long, conflicts_with = "study")]
    raw: bool,
    /// Also write plateaus-next.csv: a later session of the same rig, with noise and order of its own.
    #[arg(long, conflicts_with = "study")]
    next: bool,
    /// Make the runs of this next-runs.csv, as `experiment` writes it, on the rig of the plan, or of --model.
    #[arg(long, value_name = "CSV", conflicts_with_all = ["study", "raw", "next"])]
    runs: Option<PathBuf>,
    /// With --runs: a model.toml is the rig, with its constants, effects and noise.
    #[arg(long, value_name = "TOML", requires = "runs")]
    #[arg(conflicts_with_all = ["plan", "effects", "own_effects", "randomised", "study", "raw", "next"])]
    model: Option<PathBuf>,
    /// The model.toml of a calibration whose noise the rig has, instead of the plan's.
    #[arg(long, value_name = "TOML", conflicts_with_all = ["model", "study"])]
    noise: Option<PathBuf>,
    /// With --runs: the rig that they were planned for, if it is not the paper's.
    #[arg(long, value_name = "TOML", requires = "runs", conflicts_with_all = ["study", "raw", "next"])]
    rig: Option<PathBuf>,
    /// Seed of the noise [default: 1, or that of the plan].
    #[arg(long, value_name = "SEED", conflicts_with = "study", value_parser = clap::value_parser!(u64).range(..=MAX_SEED))]
    seed: Option<u64>,
    /// Calibrate this many rigs of every kind and print what was said of them.
    #[arg(long, value_name = "SEEDS", value_parser = clap::value_parser!(u64).range(1..=MOST_SEEDS))]
    #[arg(conflicts_with_all = ["plan", "out", "own_effects"])]
    study: Option<u64>,
    /// In a study, the first seed; others than those a level was tuned on give a fair figure.
    #[arg(long, value_name = "SEED", default_value_t = 1, value_parser = clap::value_parser!(u64).range(..=MAX_FIRST_SEED))]
    #[arg(requires = "study", conflicts_with = "out")]
    first_seed: u64,
    /// In a study, give every rig all noise at once: scatter of mounts and seatings, walking offsets, chains, heavy tails, a cell with
    /// steps, missing rows.
    #[arg(long, requires = "study", conflicts_with_all = ["out", "experiments"])]
    every_noise: bool,
    /// In a study, ask for the error promised for a new session, too: five times the time.
    #[arg(long, requires = "study", conflicts_with = "out")]
    promises: bool,
    /// In a study, draw the forms of what has no name, and let other sessions confirm or refute them.
    #[arg(long, requires = "study", conflicts_with_all = ["out", "promises"])]
    forms: bool,
    /// In a study, propose a session where the paper's protocol leaves something open, make it, and calibrate both; a number makes
    /// the effects so many times as large.
    #[arg(long, value_name = "TIMES", num_args = 0..=1, default_missing_value = "1", value_parser = times)]
    #[arg(requires = "study", conflicts_with_all = ["out", "promises", "forms"])]
    experiments: Option<f64>,
    /// In a study, only these kinds of rig: a group (nulls, singles, scattered, pairs, masks, confounded, outside) or a part of a name.
    #[arg(long, value_name = "GROUP|NAME", requires = "study", conflicts_with = "out")]
    only: Vec<String>,
}

/// How many times as large effects are put in.
fn times(text: &str) -> Result<f64, String> {
    let times = text.parse::<f64>().map_err(|_| "a number such as 2".to_owned())?;
    (0.1..=10.0).contains(&times).then_some(times).ok_or_else(|| "0.1 to 10".to_owned())
}

/// Largest seed that a plan can hold: TOML has integers with a sign.
const MAX_SEED: u64 = i64::MAX as u64;
/// Seeds from one kind of rig of a study to the next.
const SEEDS_PER_CASE: u64 = 1000;
/// Most seeds of a kind: the oldest kinds without effect take two and a half rigs for each, all from their own thousand.
const MOST_SEEDS: u64 = 400;
/// Largest first seed; the seeds of all kinds follow it.
const MAX_FIRST_SEED: u64 = MAX_SEED - 1_000_000;

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    if let Some(seeds) = arguments.study {
        return study(arguments, seeds);
    }
    let Some(out) = &arguments.out else {
        return Err(Failure::bad_input("simulate needs --out, or --study"));
    };
    if let Some(runs) = &arguments.runs {
        return rehearsed(arguments, runs, out);
    }
    let (plan, name) = plan(arguments)?;
    let text = plan.to_text().map_err(Failure::failed)?;
    let simulated = simulate(&plan);
    simulated.check(&name).map_err(Failure::bad_input)?;
    let file = |name: &str, text: String| OutputFile { name: name.to_owned(), bytes: text.into_bytes() };
    let mut files = if arguments.raw { raw_files(&plan, &simulated.rows, &name)? } else { Vec::new() };
    files.extend([
        file("plan.toml", text),
        file("plateaus-fresh.csv", simulated.fresh_table(&plan)),
        file("plateaus.csv", simulated.table(&plan)),
    ]);
    if arguments.next {
        files.push(file("plateaus-next.csv", next_session(&plan).table(&plan)));
    }
    write_set(out, &files).map_err(Failure::from)
}

/// The table that planned runs would give, on the rig of a model or of a plan.
fn rehearsed(arguments: &Arguments, runs: &Path, out: &Path) -> Result<(), Failure> {
    let name = runs.display().to_string();
    let runs = read_runs(&read_text_file(runs)?, &name).map_err(Failure::bad_input)?;
    let rig = match &arguments.rig {
        None => RigLimits::default(),
        Some(path) => RigLimits::parse(&read_text_file(path)?, &path.display().to_string())
            .map_err(Failure::bad_input)?,
    };
    let rows = match &arguments.model {
        Some(path) => {
            let name = path.display().to_string();
            let model = ModelFile::parse(&read_text_file(path)?, &name).map_err(Failure::bad_input)?;
            let rows = rows_of(&runs, &rig.wrapped_by(model.usual_wrap_deg()), "");
            simulate_from_model(&model, &name, rows, arguments.seed.unwrap_or(1))
                .map_err(Failure::bad_input)?
        }
        None => {
            let (mut plan, name) = plan(arguments)?;
            let rig = rig.wrapped_by(plan.wrap_angle_deg);
            plan.wrap_angle_deg = rig.wrap_angle_deg.unwrap_or(plan.wrap_angle_deg);
            let rows = rows_of(&runs, &rig, "");
            let simulated = simulate_rows(&plan, rows);
            simulated.check(&name).map_err(Failure::bad_input)?;
            simulated.rows
        }
    };
    let table = PlateauTable::write(&rows).into_bytes();
    write_set(out, &[OutputFile { name: "plateaus.csv".to_owned(), bytes: table }]).map_err(Failure::from)
}

/// The plan with the effects asked for, and its name in errors.
fn plan(arguments: &Arguments) -> Result<(Plan, String), Failure> {
    let vocabulary = arguments.own.vocabulary()?;
    let (mut plan, name) = match &arguments.plan {
        Some(path) => {
            let name = path.display().to_string();
            let text = crate::input::read_text_file(path)?;
            (Plan::parse_among(&text, &name, &vocabulary).map_err(Failure::bad_input)?, name)
        }
        None if arguments.randomised => (Plan::randomised(), "the plan of --randomised".to_owned()),
        None => (Plan::default(), "the plan of the paper's rig".to_owned()),
    };
    plan.vocabulary = vocabulary;
    plan.seed = arguments.seed.unwrap_or(plan.seed);
    if let Some(model) = &arguments.noise {
        plan.noise = noise_of(model)?;
    }
    plan.check(&name).map_err(Failure::bad_input)?;
    for effect in &arguments.effects {
        let (id, values) = effect.split_once('=').unwrap_or((effect, ""));
        let values: Result<Vec<f64>, _> =
            values.split(',').filter(|v| !v.is_empty()).map(|v| v.trim().parse()).collect();
        let values = values.map_err(|_| {
            Failure::bad_input(format!("--effect {effect}: values are numbers, like coating_ploughing=0.02"))
        })?;
        plan.add_effect(id, values);
        // The plan alone is sound: what is wrong now came by the flag.
        plan.check(&format!("--effect {effect}")).map_err(Failure::bad_input)?;
    }
    Ok((plan, name))
}

/// The run's description, its logs, their true plateaus, and what was put wrong into them.
fn raw_files(plan: &Plan, rows: &[PlateauRow], name: &str) -> Result<Vec<OutputFile>, Failure> {
    let run = RawRun::new(plan, rows, name).map_err(Failure::bad_input)?;
    let mut files = Vec::new();
    let mut truth = "file,direction,repetition,force_N\n".to_owned();
    let mut faults = serde_json::Map::new();
    for log in (0..run.logs()).filter_map(|i| run.log(i)) {
        let file = format!("{}.gz", log.file);
        for (direction, repetition, force_n) in &log.truth {
            let word = if direction.sign() > 0.0 { "concentric" } else { "eccentric" };
            truth.push_str(&format!("{file},{word},{repetition},{force_n:.4}\n"));
        }
        faults.insert(file.clone(), serde_json::to_value(&log.faults).map_err(Failure::failed)?);
        let mut packed = GzEncoder::new(Vec::new(), Compression::fast());
        packed.write_all(log.text.as_bytes()).map_err(Failure::failed)?;
        files.push(OutputFile { name: file, bytes: packed.finish().map_err(Failure::failed)? });
    }
    let mut json = serde_json::to_vec_pretty(&faults).map_err(Failure::failed)?;
    json.push(b'\n');
    files.push(OutputFile { name: "faults.json".to_owned(), bytes: json });
    files.push(OutputFile { name: "truth.csv".to_owned(), bytes: truth.into_bytes() });
    files.push(OutputFile { name: "run.toml".to_owned(), bytes: run.description(".gz").into_bytes() });
    Ok(files)
}

/// The confusion matrix over the kinds of rig asked for, and a row for each group of them; or another chapter's table.
fn study(arguments: &Arguments, seeds: u64) -> Result<(), Failure> {
    if let Some(factor) = arguments.experiments {
        let mut study = ExperimentStudy::default();
        let run = |case: &Case, seed| run_experiment_case(case, seed, factor, Levels::default());
        let cases = (0..).zip(experiment_cases()).collect();
        each_case(arguments, seeds, cases, run, |case, outcomes| study.add(case, outcomes))?;
        return print(study.table().as_bytes());
    }
    let every_noise = arguments.every_noise;
    let numbered = (0..).zip(study_cases().into_iter().map(|case| Case { every_noise, ..case }));
    if arguments.forms {
        let mut study = FormStudy::default();
        let cases = numbered.filter(|(_, case)| case.group == Group::Outside).collect();
        let run = |case: &Case, seed| run_form_case(case, seed, Levels::default());
        each_case(arguments, seeds, cases, run, |case, outcomes| study.add(case, outcomes))?;
        return print(study.table().as_bytes());
    }
    let mut study = Study::default();
    let run = |case: &Case, seed| run_case(case, seed, Levels::default(), arguments.promises);
    each_case(arguments, seeds, numbered.collect(), run, |case, outcomes| study.add(case, outcomes))?;
    print(format!("{}\n{}\n{}", study.table(), study.groups(), study.summary()).as_bytes())
}

/// Runs the rigs of the chapter's kinds that are asked for, each with its place among all, and hands on what became of them.
fn each_case<T: Send>(
    arguments: &Arguments,
    seeds: u64,
    cases: Vec<(u64, Case)>,
    run: impl Fn(&Case, u64) -> Option<T> + Sync,
    mut add: impl FnMut(Case, Vec<T>),
) -> Result<(), Failure> {
    for word in &arguments.only {
        if !cases.iter().any(|(_, case)| case.matches(word)) {
            let mut groups: Vec<&str> = cases.iter().map(|(_, case)| case.group.as_str()).collect();
            groups.sort_unstable();
            groups.dedup();
            return Err(Failure::bad_input(format!(
                "--only {word}: no kind of rig of this chapter has this in its name; its groups are {}",
                groups.join(", ")
            )));
        }
    }
    let is_asked_for =
        |case: &Case| arguments.only.is_empty() || arguments.only.iter().any(|word| case.matches(word));
    for (place, case) in cases.into_iter().filter(|(_, case)| is_asked_for(case)) {
        // One draw of noise must not decide of every kind of rig: each has seeds of its own.
        let own = arguments.first_seed + SEEDS_PER_CASE * place;
        let outcomes: Vec<T> =
            (own..own + case.rigs(seeds)).into_par_iter().filter_map(|seed| run(&case, seed)).collect();
        log::info!("{:?} {}: {} rigs", case.protocol, case.name, outcomes.len());
        add(case, outcomes);
    }
    Ok(())
}
