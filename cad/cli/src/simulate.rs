//! `pinswitch simulate PLAN.toml --out DIR` and `pinswitch simulate --study`.

use std::io::Write;
use std::path::{Path, PathBuf};

use clap::Args;
use flate2::Compression;
use flate2::write::GzEncoder;
use pinswitch_calibration::experiment::{RigLimits, read_runs, rows_of};
use pinswitch_calibration::table::{PlateauRow, PlateauTable};
use pinswitch_diagnostic::{Diagnostic, Location, codes};
use pinswitch_simulation::{
    Case, ExperimentStudy, FormStudy, Group, Plan, RawRun, Study, experiment_cases, next_session, run_case,
    run_experiment_case, run_form_case, simulate, simulate_from_model, simulate_rows, study_cases,
};
use pinswitch_switch::output::OutputFile;
use rayon::prelude::*;

use super::calibrated_curve::read_model;
use super::power::noise_of;
use super::provenance::PROVENANCE;
use super::terminal::to_json;
use super::user_effects::UserEffects;
use super::{Failure, print_data, print_json, print_text};
use crate::input::read_text_file;
use crate::write::SetFolder;

/// Simulate a friction rig with known effects and noise.
///
/// --study tests the calibrator on many simulated rigs. Otherwise writes plateaus.csv, plateaus-fresh.csv (rows without noise, to check predictions against) and plan.toml.
#[derive(Args, Debug)]
#[command(after_help = "Examples:
  pinswitch simulate --effect coating_ploughing=0.02 --out rig
  pinswitch simulate --effects mine.toml --effect lubricant_dip=0.2 --out rig
  pinswitch simulate plan.toml --out rig
  pinswitch simulate plan.toml --out rig --raw
  pinswitch simulate --runs next/next-runs.csv --model calibration/model.toml --out rehearsal
  pinswitch simulate --study 20
  pinswitch simulate --study 20 --only nulls --only 'worn spot'
  pinswitch simulate --study 20 --json")]
// clap does not require an argument if a given argument conflicts with it. Arguments that require --study therefore
// conflict with --out themselves, and those that require --runs with everything that conflicts with --runs.
pub(super) struct Arguments {
    /// Plan: layouts, loads, sweeps, speeds, dwells, effects with their sizes, noise, seed [default: the paper's rig].
    plan: Option<PathBuf>,
    /// Add an effect to those of the plan: ID or ID=VALUE,VALUE, sizes before shapes. Values of a user-defined effect
    /// that are left out have their start values.
    #[arg(long = "effect", value_name = "ID=VALUES", conflicts_with = "study")]
    effects: Vec<String>,
    #[command(flatten)]
    vocabulary: UserEffects,
    /// Without a plan: loads up and down, several speeds and dwells, instead of the paper's protocol.
    #[arg(long, conflicts_with_all = ["plan", "study", "runs"])]
    randomised: bool,
    /// Folder for the tables.
    #[arg(long, value_name = "DIR", required_unless_present = "study")]
    out: Option<PathBuf>,
    /// Also write raw 200 Hz logs with spikes, lost samples and bad moves: run.toml for `segment`, truth.csv, faults.json.
    #[arg(long, conflicts_with = "study")]
    raw: bool,
    /// Also write plateaus-next.csv: a later session of the same rig, with its own noise and order.
    #[arg(long, conflicts_with = "study")]
    next: bool,
    /// Simulate the runs of this next-runs.csv, written by `experiment`, on the rig of the plan or of --model.
    #[arg(long, value_name = "CSV", conflicts_with_all = ["study", "raw", "next"])]
    runs: Option<PathBuf>,
    /// With --runs: model.toml whose constants, effects and noise make the rig.
    #[arg(long, value_name = "TOML", requires = "runs")]
    #[arg(conflicts_with_all = ["plan", "effects", "user_effects", "randomised", "study", "raw", "next"])]
    model: Option<PathBuf>,
    /// model.toml of a calibration; its noise replaces the plan's.
    #[arg(long, value_name = "TOML", conflicts_with_all = ["model", "study"])]
    noise: Option<PathBuf>,
    /// With --runs: limits of the rig for which the runs were planned [default: the paper's rig].
    #[arg(long, value_name = "TOML", requires = "runs", conflicts_with_all = ["study", "raw", "next"])]
    rig: Option<PathBuf>,
    /// Seed of the noise [default: 1, or that of the plan].
    #[arg(long, value_name = "SEED", conflicts_with = "study", value_parser = clap::value_parser!(u64).range(..=MAX_SEED))]
    seed: Option<u64>,
    /// Calibrate this many simulated rigs of every kind and print the verdicts.
    #[arg(long, value_name = "SEEDS", value_parser = clap::value_parser!(u64).range(1..=MAX_SEEDS))]
    #[arg(conflicts_with_all = ["plan", "out", "user_effects"])]
    study: Option<u64>,
    /// With --study: first seed. Seeds that were not used in the development of the calibrator give an unbiased result.
    #[arg(long, value_name = "SEED", default_value_t = 1, value_parser = clap::value_parser!(u64).range(..=MAX_FIRST_SEED))]
    #[arg(requires = "study", conflicts_with = "out")]
    first_seed: u64,
    /// With --study: give every rig all noise at once: variation between mounts and tendon seatings, drifting offsets,
    /// correlated readings, heavy tails, a load cell with steps, missing rows.
    #[arg(long, requires = "study", conflicts_with_all = ["out", "experiments"])]
    every_noise: bool,
    /// With --study: fit forms to unnamed structure, and confirm or refute them on other sessions.
    #[arg(long, requires = "study", conflicts_with = "out")]
    forms: bool,
    /// With --study: where the paper's protocol leaves a question open, plan a session, simulate it, and calibrate both
    /// together. A number scales the effects.
    #[arg(long, value_name = "TIMES", num_args = 0..=1, default_missing_value = "1", value_parser = scale)]
    #[arg(requires = "study", conflicts_with_all = ["out", "forms"])]
    experiments: Option<f64>,
    /// With --study: only these kinds of rig, by group (nulls, singles, scattered, pairs, masks, confounded, outside) or
    /// by a part of the name.
    #[arg(long, value_name = "GROUP|NAME", requires = "study", conflicts_with = "out")]
    only: Vec<String>,
    /// Print the folder's provenance.json; with --study, the outcome of every rig instead of tables.
    #[arg(long, conflicts_with_all = ["forms", "experiments"])]
    json: bool,
}

/// Name of this command in a manifest.
const COMMAND: &str = "simulate";

/// Parses the factor by which effects are scaled.
fn scale(text: &str) -> Result<f64, Diagnostic> {
    let factor = text
        .parse::<f64>()
        .map_err(|e| Diagnostic::new(codes::MALFORMED_VALUE, "not a number").with_source(e))?;
    if (0.1..=10.0).contains(&factor) {
        return Ok(factor);
    }
    Err(Diagnostic::new(codes::OUT_OF_RANGE, "the factor is outside 0.1 to 10"))
}

/// Largest seed that a plan can contain: integers of TOML are signed.
const MAX_SEED: u64 = i64::MAX as u64;
/// Distance between the first seeds of two kinds of rig in a study.
const SEEDS_PER_CASE: u64 = 1000;
/// Most seeds of a kind. Some kinds simulate two and a half rigs per seed, all within [`SEEDS_PER_CASE`].
const MAX_SEEDS: u64 = 400;
/// Largest first seed, which leaves room for the seeds of all kinds.
const MAX_FIRST_SEED: u64 = MAX_SEED - 1_000_000;

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    if let Some(seeds) = arguments.study {
        return study(arguments, seeds);
    }
    let Some(out) = &arguments.out else {
        return Err(Failure::bad_input(
            Diagnostic::new(codes::USAGE, "--out is missing").with_help("give --out DIR, or --study"),
        ));
    };
    let place = SetFolder::lock(out)?;
    if let Some(runs) = &arguments.runs {
        return rehearsal(arguments, runs, &place);
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
    finish(arguments, &place, &files)
}

/// Writes the files; with `--json`, prints the manifest that lists them.
fn finish(arguments: &Arguments, place: &SetFolder, files: &[OutputFile]) -> Result<(), Failure> {
    place.replace_listed(files, COMMAND, &[])?;
    match place.existing(PROVENANCE)? {
        Some(manifest) if arguments.json => print_data(&manifest),
        _ => Ok(()),
    }
}

/// Simulates planned runs on the rig of a model or of a plan, and writes their table.
fn rehearsal(arguments: &Arguments, runs: &Path, place: &SetFolder) -> Result<(), Failure> {
    let name = runs.display().to_string();
    let runs = read_runs(&read_text_file(runs)?, &name).map_err(Failure::bad_input)?;
    let rig = match &arguments.rig {
        None => RigLimits::default(),
        Some(path) => RigLimits::parse(&read_text_file(path)?, &path.display().to_string())
            .map_err(Failure::bad_input)?,
    };
    let rows = match &arguments.model {
        Some(path) => {
            let (model, name) = read_model(path)?;
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
    let files = [OutputFile { name: "plateaus.csv".to_owned(), bytes: table }];
    finish(arguments, place, &files)
}

/// Returns the plan with the effects of the command line, and its name for errors.
fn plan(arguments: &Arguments) -> Result<(Plan, String), Failure> {
    let vocabulary = arguments.vocabulary.vocabulary()?;
    let bad_input = Failure::bad_input;
    let (mut plan, name) = match &arguments.plan {
        Some(path) => {
            let name = path.display().to_string();
            let text = crate::input::read_text_file(path)?;
            (Plan::parse_among(&text, &name, &vocabulary).map_err(bad_input)?, name)
        }
        None if arguments.randomised => (Plan::randomised(), "the plan of --randomised".to_owned()),
        None => (Plan::default(), "the plan of the paper's rig".to_owned()),
    };
    plan.vocabulary = vocabulary;
    plan.seed = arguments.seed.unwrap_or(plan.seed);
    if let Some(model) = &arguments.noise {
        plan.noise = noise_of(model)?;
    }
    plan.check(&name).map_err(bad_input)?;
    for effect in &arguments.effects {
        let (id, values) = effect.split_once('=').unwrap_or((effect, ""));
        let values: Result<Vec<f64>, _> =
            values.split(',').filter(|v| !v.is_empty()).map(|v| v.trim().parse()).collect();
        let values = values.map_err(|e| {
            Failure::bad_input(
                Diagnostic::new(codes::MALFORMED_VALUE, "a value is not a number")
                    .with_location(Location::file(format!("--effect {effect}")))
                    .with_help("give ID=VALUE,VALUE, such as coating_ploughing=0.02")
                    .with_source(e),
            )
        })?;
        plan.add_effect(id, values);
        // The plan was valid before, so the option is at fault.
        plan.check(&format!("--effect {effect}")).map_err(bad_input)?;
    }
    Ok((plan, name))
}

/// Returns the description of a raw run, its logs, their true plateaus, and the faults that were added.
fn raw_files(plan: &Plan, rows: &[PlateauRow], name: &str) -> Result<Vec<OutputFile>, Failure> {
    let run = RawRun::new(plan, rows, name).map_err(Failure::bad_input)?;
    let failed_io = |e: std::io::Error| Failure::failed(Diagnostic::from_error(codes::INTERNAL_ERROR, e));
    let mut files = Vec::new();
    let mut truth = "file,direction,repetition,force_N\n".to_owned();
    let mut faults = serde_json::Map::new();
    for log in (0..run.logs()).filter_map(|i| run.log(i)) {
        let file = format!("{}.gz", log.file);
        for (direction, repetition, force_n) in &log.truth {
            let word = if direction.sign() > 0.0 { "concentric" } else { "eccentric" };
            truth.push_str(&format!("{file},{word},{repetition},{force_n:.4}\n"));
        }
        let log_faults = serde_json::to_value(&log.faults);
        faults.insert(
            file.clone(),
            log_faults.map_err(|e| Failure::failed(Diagnostic::from_error(codes::INTERNAL_ERROR, e)))?,
        );
        let mut packed = GzEncoder::new(Vec::new(), Compression::fast());
        packed.write_all(log.text.as_bytes()).map_err(failed_io)?;
        files.push(OutputFile { name: file, bytes: packed.finish().map_err(failed_io)? });
    }
    files.push(OutputFile { name: "faults.json".to_owned(), bytes: to_json(&faults)? });
    files.push(OutputFile { name: "truth.csv".to_owned(), bytes: truth.into_bytes() });
    files.push(OutputFile { name: "run.toml".to_owned(), bytes: run.description(".gz").into_bytes() });
    Ok(files)
}

/// Prints the confusion matrix of the requested kinds of rig with a row per group, or the table of another study.
fn study(arguments: &Arguments, seeds: u64) -> Result<(), Failure> {
    if let Some(factor) = arguments.experiments {
        let mut study = ExperimentStudy::default();
        let run = |case: &Case, seed| run_experiment_case(case, seed, factor);
        let cases = (0..).zip(experiment_cases()).collect();
        each_case(arguments, seeds, cases, run, |case, outcomes| study.add(case, outcomes))?;
        return print_text(&study.table());
    }
    let every_noise = arguments.every_noise;
    let numbered = (0..).zip(study_cases().into_iter().map(|case| Case { every_noise, ..case }));
    if arguments.forms {
        let mut study = FormStudy::default();
        let cases = numbered.filter(|(_, case)| case.group == Group::Outside).collect();
        each_case(arguments, seeds, cases, run_form_case, |case, outcomes| study.add(case, outcomes))?;
        return print_text(&study.table());
    }
    let mut study = Study::default();
    each_case(arguments, seeds, numbered.collect(), run_case, |case, outcomes| study.add(case, outcomes))?;
    if arguments.json {
        return print_json(&study.rigs());
    }
    let parts = [study.table(), study.groups(), study.summary(), study.reliability()];
    print_text(&parts.join("\n"))
}

/// Runs the rigs of the requested kinds and passes the outcomes of each kind to `add`. The number of a kind is its place
/// among all kinds.
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
            return Err(Failure::bad_input(
                Diagnostic::new(codes::UNKNOWN_WORD, "no kind of rig in this study has this group or name")
                    .with_location(Location::field("--only", word))
                    .with_help(format!("give one of the groups {}, or a part of a name", groups.join(", "))),
            ));
        }
    }
    let is_requested =
        |case: &Case| arguments.only.is_empty() || arguments.only.iter().any(|word| case.matches(word));
    for (place, case) in cases.into_iter().filter(|(_, case)| is_requested(case)) {
        // Each kind has its own seeds, so that no single draw of noise affects all of them.
        let first = arguments.first_seed + SEEDS_PER_CASE * place;
        let outcomes: Vec<T> =
            (first..first + case.rigs(seeds)).into_par_iter().filter_map(|seed| run(&case, seed)).collect();
        log::info!("{:?} {}: {} rigs", case.protocol, case.name, outcomes.len());
        add(case, outcomes);
    }
    Ok(())
}
